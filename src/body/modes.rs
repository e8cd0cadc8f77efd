//! Modal form of a linear body: response of the surface at the impact point to the contact force.

use nalgebra::{Complex, DMatrix, DVector};

use super::coupled_classes::coupled_modes;
use super::coupled_modes::{CoupledModes, Forces, at_rest_beyond};
use super::eigen::{semidefinite_factor_times, symmetric_eigen};
use super::modal_foundation::ModalFoundation;
use super::modal_relaxation::ModalRelaxation;
use super::relaxing_directions::amplitudes;
use super::row_blocks::RowBlocks;
use super::shapes::{Forms, Shapes};
use super::short_waves::ShortWaves;
use super::{BlockMatrix, FoundationPoints, InternalForce, Projection};
use crate::error::{Error, Result};
use crate::scene::Fault;

/// Response of a body to the contact force, u_hit = aᵀu, as a sum over first-order coordinates, one free motion, and a
/// spring:
///
/// ż_i = λ_i z_i + b_i F + g_i,  Ẍ = F/m + g,  u_hit = Re Σ c_i z_i + X + r F.
///
/// A free vibration of frequency ω has one coordinate z = v + iωx with λ = iω. With dampers, the z are the coordinates
/// along the eigenvectors of (x, v), one for each conjugate pair. An infinite plate has one coordinate with λ = 0.
/// Short waves of a plate have additional coordinates ([`InfinitePlate`](super::InfinitePlate)), which come last.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// First-order coordinates.
    pub modes: Vec<Mode>,
    /// Combined free motions: mobility 1/m (1/kg), acceleration g (m/s²), and Σ f² of their loads (W/s).
    pub free: Free,
    /// Compliance r, m/N: the static response of the modes that are left out.
    pub residual: f64,
    /// Displacement of the surface due to the loads in the modes that are left out, m, if the motion starts from
    /// equilibrium.
    pub rest: f64,
    /// Quadratic forms of the energies.
    pub(crate) forms: Forms,
    /// Displacements of the whole body in the modes.
    pub(crate) shapes: Shapes,
    /// Three stress forms on the face opposite the impact point, and the local stresses that they lack for 1 N; `None`
    /// if stresses are not read.
    pub(crate) hit_stress: Option<(Shapes, [f64; 3])>,
    /// Unilateral foundations, whose springs are included in the modes.
    foundation: Option<ModalFoundation>,
    /// Inputs b of forces on x, with dampers or relaxation. `None` without them; the inputs are then 1.
    pub(crate) force_inputs: Option<BlockMatrix>,
}

/// One first-order coordinate of [`Modes`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// Complex rate λ, 1/s.
    pub rate: Complex<f64>,
    /// Input b of the contact force.
    pub input: Complex<f64>,
    /// Input g of the loads.
    pub load: Complex<f64>,
    /// Output c to the displacement u_hit.
    pub output: Complex<f64>,
}

/// Motions that nothing resists, combined into one: with φ and f of each, u = Σ φ x, ẍ = φ F + f.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Free {
    /// Mobility Σ φ², 1/kg.
    pub mobility: f64,
    /// Acceleration due to the loads, Σ φ f, m/s².
    pub load: f64,
    /// Sum of the squared modal loads, Σ f², W/s.
    pub square: f64,
}

/// Closed contact, for the choice of the modes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closed {
    /// Tangent stiffness of Hertz's law, N/m.
    pub tangent: f64,
    /// Local compliance c_l of the contact law, m/N.
    pub compliance: f64,
    /// Mass of the impactor, kg.
    pub mass: f64,
    /// Largest change of the force due to simplified relaxation of the modes, relative to the peak.
    pub accuracy: f64,
    /// Length of the run, s.
    pub end: f64,
}

/// Ratio to the largest ω² below which an ω² is rounding.
const ROUNDING: f64 = 1e-14;

/// Ratio of the squared loads on free motions to all squared loads below which the former are rounding.
const FREE_LOAD_ROUNDING: f64 = 1e-16;

/// Largest displacement of the surface by a mode under its loads, m. A larger one indicates an unsupported motion.
const LARGEST_MODE_DISPLACEMENT: f64 = 1.0;

/// Largest part of a mode's stiffness that may come from unilateral foundations if the mode is left out. Such a mode
/// becomes slower where the body lifts off.
const LARGEST_FOUNDATION_SHARE: f64 = 0.01;

/// Largest viscoelastic part of a layer's modulus, at the rate of the modes, for which the cutoff of the modes is not
/// raised. (For a laminate with an interlayer that relaxes to a thousandth, leaving out the modes that the time steps
/// do not resolve caused an error of 2% of the peak.)
const LARGEST_VISCOELASTIC_PART: f64 = 0.1;

/// Returns the error for loads that move an unsupported body.
pub(crate) fn no_equilibrium() -> Error {
    let message = "there is no equilibrium: the loads move the body in a direction in which nothing holds it";
    Fault::new("time.initial", message, "supports that hold the loads, or `initial = \"rest\"`").into()
}

impl Modes {
    /// Returns the modes of a body that does not move: a half-space, whose indentation is part of Hertz's law.
    pub fn none() -> Self {
        let shapes = Shapes::none();
        Self {
            modes: Vec::new(),
            free: Free::default(),
            residual: 0.0,
            rest: 0.0,
            forms: Forms::none(),
            shapes,
            hit_stress: None,
            foundation: None,
            force_inputs: None,
        }
    }

    /// Returns the modes of a surface with the velocity F/Z: an infinite plate of the impedance Z, N s/m.
    pub fn dashpot(impedance: f64) -> Self {
        let [zero, one] = [Complex::new(0.0, 0.0), Complex::new(1.0, 0.0)];
        let mode = Mode { rate: zero, input: one / impedance, load: zero, output: one };
        // The energy of outgoing waves counts as dissipated.
        let forms = Forms { is_open: true, ..Forms::none() };
        Self { modes: vec![mode], forms, ..Self::none() }
    }

    /// Checks that the loads do not set the body in motion.
    ///
    /// # Errors
    /// A fault of `time.initial` if they do.
    pub fn require_equilibrium(&self) -> Result<()> {
        let held: f64 = self.modes.iter().map(|mode| mode.load.norm_sqr()).sum();
        let is_held = self.free.square <= FREE_LOAD_ROUNDING * (held + self.free.square);
        // Rounding may give a free motion a nonzero frequency.
        let sinks = |mode: &Mode| (mode.output * mode.load).norm() > LARGEST_MODE_DISPLACEMENT * mode.rate.norm();
        if is_held && !self.modes.iter().any(sinks) { Ok(()) } else { Err(no_equilibrium()) }
    }

    /// The force that the linear stiffness of the modes does not contain, if there is one.
    pub(crate) fn internal_force(&self) -> Option<&dyn InternalForce> {
        self.foundation.as_ref().map(|foundation| foundation as &dyn InternalForce)
    }

    /// Returns the displacements x of the vibrations from z.
    pub(crate) fn places(&self, z: &[Complex<f64>]) -> DVector<f64> {
        if let Some([places, _]) = &self.forms.damped {
            return places.real_parts(z);
        }
        let frequencies = &self.forms.frequencies;
        DVector::from_iterator(frequencies.len(), z.iter().zip(frequencies).map(|(z, frequency)| z.im / frequency))
    }

    /// Returns the largest |λ| of the coordinates, 1/s.
    pub fn fastest(&self) -> f64 {
        self.modes.iter().map(|mode| mode.rate.norm()).fold(0.0, f64::max)
    }
}

/// Free vibrations of a reduced body.
pub struct Spectrum {
    /// Squared frequencies ω², 1/s², ascending.
    pub(super) squares: DVector<f64>,
    /// Vᵀa, Vᵀf and Vᵀ∫kū in the modes. If short waves are separated, Vᵀa is multiplied by the weights.
    force: DVector<f64>,
    load: DVector<f64>,
    support_load: DVector<f64>,
    /// Factor F of the support stiffness K = FᵀF, in the modes.
    support: DMatrix<f64>,
    damping: Option<DMatrix<f64>>,
    relaxations: Vec<ModalRelaxation>,
    /// Shift at which the basis was made, 1/s.
    rate: f64,
    /// Whether a modulus decreases so much that the modes that are left out would be other springs later.
    pub(super) relaxes: bool,
    support_offset: f64,
    /// Vibrations in coordinates of the basis, as columns.
    vectors: DMatrix<f64>,
    /// Shapes from which results are read in place of `vectors`, if they differ.
    acceleration: Option<ModeAcceleration>,
    /// Stress forms on the face opposite the impact point, in coordinates of the basis, one in each row.
    hit_stress: DMatrix<f64>,
    local_stress_per_newton: [f64; 3],
    /// Unilateral foundations in the modes.
    foundation: Option<FoundationPoints>,
    /// Number of lowest modes that include all modes stiffened by foundations.
    stiffened: usize,
    /// Coordinates of the waves that the modes leave out, and the weights √g of the modes, if short waves are
    /// separated.
    short_waves: Option<ShortWaves>,
}

impl Spectrum {
    /// Solves K y = ω² y on the basis. Viscoelastic parts have their moduli at the shift of the basis.
    pub fn new(projection: &Projection) -> Self {
        let (squares, vectors, acceleration) = match projection.mode_acceleration {
            Some(shift) if projection.vectors() > 2 => ModeAcceleration::vibrations(projection, shift),
            _ => {
                let (squares, vectors) = symmetric_eigen(projection.stiffness_at_rate());
                (squares, vectors, None)
            }
        };
        let along = |v: &DVector<f64>| vectors.tr_mul(v);
        let on = |m: &DMatrix<f64>| vectors.transpose() * (m * &vectors);
        let of_relaxations = projection.terms.relaxations.iter().filter(|part| !part.chain.terms.is_empty());
        let of_relaxations = of_relaxations.map(|part| ModalRelaxation::new(part, &vectors, projection.rate));
        let mut force = along(&projection.terms.contact.force);
        let short_waves = ShortWaves::new(projection, &squares, &force);
        if let Some(ShortWaves { weights, .. }) = &short_waves {
            force.component_mul_assign(weights);
        }
        let foundation = projection.foundation.as_ref().map(|points| points.on(&vectors));
        let is_stiffened = |i: &usize| {
            let stiffness = foundation.as_ref().map_or(0.0, |points: &FoundationPoints| points.square(*i));
            stiffness > LARGEST_FOUNDATION_SHARE * squares[*i].max(0.0)
        };
        Self {
            stiffened: (0..squares.len()).rev().find(is_stiffened).map_or(0, |last| last + 1),
            squares,
            force,
            load: along(&projection.terms.load),
            support_load: along(&projection.terms.support_load),
            support: match &projection.terms.support {
                Some(support) => semidefinite_factor_times(support, &vectors),
                None => DMatrix::zeros(0, vectors.ncols()),
            },
            damping: projection.terms.damping.as_ref().map(on),
            relaxations: of_relaxations.collect(),
            rate: projection.rate,
            relaxes: projection.terms.relaxations.iter().any(|part| {
                let chain = &part.chain;
                chain.transformed_terms(projection.rate)
                    > LARGEST_VISCOELASTIC_PART * chain.transformed(projection.rate)
            }),
            support_offset: projection.terms.support_offset,
            foundation,
            vectors,
            acceleration,
            hit_stress: {
                let forms = &projection.terms.readings.forms;
                DMatrix::from_fn(forms.len(), projection.vectors(), |form, vector| forms[form][vector])
            },
            local_stress_per_newton: projection.terms.readings.local_per_newton,
            short_waves,
        }
    }

    /// Multiplies the frequency ω (rad/s) of each vibration by `ratio` of it.
    pub fn retuned(mut self, ratio: impl Fn(f64) -> f64) -> Self {
        self.squares.apply(|square| *square *= ratio(square.max(0.0).sqrt()).powi(2));
        self
    }

    /// Highest frequency of the modes that unilateral foundations stiffen, rad/s. None of these modes is left out.
    pub fn stiffened(&self) -> f64 {
        self.stiffened.checked_sub(1).map_or(0.0, |last| self.squares[last].max(0.0).sqrt())
    }

    /// Whether loads act on the body.
    pub fn is_loaded(&self) -> bool {
        self.load.amax() > 0.0 || self.support_load.amax() > 0.0
    }

    /// Returns the number of all modes that can take part.
    pub fn count_of_all(&self) -> usize {
        self.short_waves.as_ref().map_or(self.squares.len(), |waves| waves.kept)
    }

    /// Returns the number of lowest modes that vibrate no faster than a frequency (rad/s) while the contact is closed.
    ///
    /// A spring k between the body and a mass raises ω² of the highest of n modes by at most k (1/m0 + Σ φ²). The
    /// spring is the tangent of Hertz's law at a force, in series with the compliance of the modes that are left out,
    /// minus the compliance that the contact law already contains. It becomes stiffer as more modes are kept.
    fn slower_than(&self, cutoff: f64, closed: &Closed) -> usize {
        let (mut mobility, mut left) = (1.0 / closed.mass + self.force.norm_squared(), 0.0);
        for (count, (force, square)) in self.force.iter().zip(&self.squares).enumerate().rev() {
            let compliance = 1.0 / closed.tangent - closed.compliance + left;
            if compliance > 0.0 && square + mobility / compliance <= cutoff * cutoff {
                return count + 1;
            }
            mobility -= force * force;
            left += force * force / square.max(f64::MIN_POSITIVE);
        }
        0
    }

    /// Returns the number of lowest modes that take part for a cutoff frequency (rad/s) during contact.
    pub fn count(&self, cutoff: f64, closed: &Closed) -> usize {
        // Free motions have no static response.
        let free = self.squares.iter().filter(|square| **square <= ROUNDING * self.squares.max()).count();
        self.slower_than(cutoff, closed).min(self.count_of_all()).max(free).max(self.stiffened)
    }

    /// Returns the first `count` modes. The others are replaced by their static response. Simplified relaxation of the
    /// modes may change the force by `accuracy` relative to its peak, in a run of length `end` (s).
    ///
    /// # Errors
    /// [`Error::Solve`] if dampers leave the body without independent modes.
    pub fn modes(&self, count: usize, accuracy: f64, end: f64) -> Result<Modes> {
        let left = self.force.iter().zip(&self.squares).skip(count);
        let of_short_waves = self.short_waves.as_ref().map_or(0.0, |waves| waves.static_compliance);
        let residual = of_short_waves + left.map(|(force, square)| force * force / square).sum::<f64>();
        let most_damped = self.damping.as_ref().map_or(0.0, |d| d.amax());
        let is_free = |&i: &usize| {
            let held = self.damping.as_ref().is_some_and(|d| d.column(i).amax() > 1e-12 * most_damped);
            self.squares[i] <= ROUNDING * self.squares.max() && !held
        };
        let (rigid, moving): (Vec<usize>, Vec<usize>) = (0..count).partition(is_free);
        let mut free = Free::default();
        let mut shapes = Shapes::zero(self.vectors.nrows());
        shapes.moving = self.vectors.select_columns(&moving);
        let mut loads = &self.load + &self.support_load;
        if let Some(points) = &self.foundation {
            // Where the body has lifted off its foundations in equilibrium, the pull of their springs is removed.
            loads -= points.rows.tr_mul(&points.resting);
        }
        // Short waves contribute to the motion of the impact point only. All other results are read without the
        // weights.
        let reach = self.short_waves.as_ref().map_or(&self.force, |waves| &waves.force);
        let (mut rest, mut rest_energy) = (0.0, 0.0);
        let mut at_rest = DVector::zeros(loads.len());
        for (i, e) in self.vectors.column_iter().enumerate().skip(count) {
            shapes.residual.axpy(reach[i] / self.squares[i], &e, 1.0);
            at_rest[i] = loads[i] / self.squares[i];
            shapes.rest.axpy(at_rest[i], &e, 1.0);
            rest += self.force[i] * at_rest[i];
            rest_energy += 0.5 * loads[i] * at_rest[i];
        }
        if !self.relaxations.is_empty() && loads.amax() > 0.0 {
            // Relaxation couples the modes that are left out with the others.
            (at_rest, rest_energy) = at_rest_beyond(&self.squares, &self.relaxations, &loads, &moving)?;
            shapes.rest = &self.vectors * &at_rest;
            rest = self.force.dot(&at_rest);
        }
        for i in rigid {
            let (force, load) = (self.force[i], loads[i]);
            shapes.free[0].axpy(force, &self.vectors.column(i), 1.0);
            shapes.free[1].axpy(load, &self.vectors.column(i), 1.0);
            free.mobility += force * force;
            free.load += force * load;
            free.square += load * load;
        }
        let of_moving = |v: &DVector<f64>| v.select_rows(&moving);
        let block = |m: &DMatrix<f64>| m.select_rows(&moving).select_columns(&moving);
        let squares = of_moving(&self.squares).map(|square| square.max(0.0));
        let (force, load) = (of_moving(&self.force), of_moving(&loads));
        let mut relaxations: Vec<_> = self.relaxations.iter().map(|part| part.select(&moving)).collect();
        // (Under loads, the body creeps to the equilibrium of all directions, so that none is dropped.)
        if loads.amax() == 0.0 {
            let amplitudes = amplitudes(&squares, &force, self.rate);
            relaxations =
                relaxations.into_iter().filter_map(|part| part.in_few_directions(&amplitudes, end, accuracy)).collect();
        }
        let mut of_relaxing = None;
        let is_coupled = self.damping.is_some() || !relaxations.is_empty();
        let (mut modes, mut damped, inputs) = if is_coupled {
            let damping = self.damping.as_ref().map(block);
            // Coupled modes move each other, so that scaling a shape would not remove a weight √g. They have the weight g
            // on their input alone. Their static response to the remaining share 1 − g of the force is added to the
            // shape of the modes that are left out.
            let mut input = force.clone();
            if let Some(ShortWaves { weights, .. }) = &self.short_waves {
                input.component_mul_assign(&of_moving(weights));
                for &i in &moving {
                    let amplitude = (1.0 - weights[i] * weights[i]) * reach[i] / self.squares[i];
                    shapes.residual.axpy(amplitude, &self.vectors.column(i), 1.0);
                }
            }
            let output = of_moving(reach);
            let forces = Forces { input: &input, load: &load, output: &output };
            let CoupledModes { modes, shapes, inputs, forms } =
                coupled_modes(&squares, damping.as_ref(), &relaxations, forces)?;
            of_relaxing = (!relaxations.is_empty()).then_some(forms);
            (modes, Some(shapes), Some(inputs))
        } else {
            let mut modes = vibrations(&squares, &force, &load);
            if let Some(waves) = &self.short_waves {
                let of_moving = shapes.moving.column_iter_mut().zip(&moving);
                of_moving.for_each(|(mut shape, &i)| shape.unscale_mut(waves.weights[i]));
                waves.damp(&mut modes, &moving);
            }
            (modes, None, None)
        };
        if let Some(waves) = &self.short_waves {
            modes.extend(&waves.coordinates);
            // The short-wave coordinates are not part of x and v.
            damped = damped.map(|shapes| shapes.map(|shape| shape.with_columns(modes.len())));
        }
        let foundation = self.foundation.as_ref().map(|all| {
            let mut points = all.select(&moving);
            if points.is_settled {
                points.offsets.gemv(-1.0, &all.rows, &at_rest, 1.0);
            }
            ModalFoundation::new(points)
        });
        if let Some(ModeAcceleration { shapes: accelerated, at_rest }) = &self.acceleration {
            shapes.moving = accelerated.select_columns(&moving);
            shapes.residual = at_rest - &shapes.moving * force.component_div(&squares);
        }
        let forms = Forms {
            support: RowBlocks::new(&self.support, &moving),
            support_load: of_moving(&self.support_load),
            support_offset: self.support_offset,
            load: of_moving(&self.load),
            frequencies: squares.map(|square| square.max(f64::MIN_POSITIVE).sqrt()),
            squares,
            rest: rest_energy,
            damped,
            relaxing: of_relaxing,
            is_open: self.short_waves.is_some(),
        };
        let hit_stress =
            (self.hit_stress.nrows() > 0).then(|| (shapes.mapped(&self.hit_stress), self.local_stress_per_newton));
        Ok(Modes {
            modes,
            free,
            residual,
            rest,
            forms,
            shapes,
            hit_stress,
            foundation,
            force_inputs: inputs.filter(|_| self.foundation.is_some()),
        })
    }
}

/// Displacements as the static response to the contact force and to the inertia of the vibrations (D. Williams, Displacements
/// of a linear elastic system under a given transient load, Aeronaut. Q. 1, 1949; "mode acceleration").
///
/// The pressure in an incompressible body follows the force without delay, although the body does not move at once. On a
/// basis that lacks the fastest vibrations, slower ones would share this pressure, with large parts of both signs.
struct ModeAcceleration {
    /// Static response to the inertia of each vibration of unit amplitude, in coordinates of the basis.
    shapes: DMatrix<f64>,
    /// Static response to a force of 1 N, m/N, without that of free motions.
    at_rest: DVector<f64>,
}

impl ModeAcceleration {
    /// Returns ω², the vibrations y and their shapes (ω² + s²) S⁻¹ M y, S = K + s²M. These are in the space of the basis
    /// if the last vector does not take part in the vibrations.
    fn vibrations(projection: &Projection, shift: f64) -> (DVector<f64>, DMatrix<f64>, Option<Self>) {
        let count = projection.vectors();
        let stiffness = projection.stiffness_at_rate();
        let (squares, vectors) = symmetric_eigen(stiffness.view((0, 0), (count - 1, count - 1)).into_owned());
        let vectors = vectors.resize_vertically(count, 0.0);
        let shifted = &stiffness + DMatrix::from_diagonal_element(count, count, shift * shift);
        let Some(factor) = shifted.cholesky() else { return (squares, vectors, None) };
        let mut shapes = factor.solve(&vectors);
        shapes.column_iter_mut().zip(&squares).for_each(|(mut shape, square)| shape *= square + shift * shift);
        let (all, of_all) = symmetric_eigen(stiffness);
        let mut at_rest = DVector::zeros(count);
        for (shape, square) in of_all.column_iter().zip(&all).filter(|(_, square)| **square > ROUNDING * all.max()) {
            at_rest.axpy(shape.dot(&projection.terms.contact.force) / square, &shape, 1.0);
        }
        (squares, vectors, Some(Self { shapes, at_rest }))
    }
}

/// Returns the modes of undamped vibrations, z = v + iωx: ż = iω z + φF + f, x = Im z/ω.
fn vibrations(squares: &DVector<f64>, force: &DVector<f64>, load: &DVector<f64>) -> Vec<Mode> {
    let real = |x: f64| Complex::new(x, 0.0);
    let mode = |i: usize| {
        // Avoids division by a zero frequency.
        let frequency = squares[i].max(f64::MIN_POSITIVE).sqrt();
        Mode {
            rate: Complex::new(0.0, frequency),
            input: real(force[i]),
            load: real(load[i]),
            output: Complex::new(0.0, -force[i] / frequency),
        }
    };
    (0..squares.len()).map(mode).collect()
}
