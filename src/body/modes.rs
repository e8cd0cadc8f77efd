//! A linear body in modal coordinates: what the contact's force does to the surface under the impactor.

use nalgebra::{Complex, DMatrix, DVector};

use super::damped::{Damped, damped};
use super::eigen::{semidefinite_factor_times, symmetric_eigen};
use super::modal_relaxation::ModalRelaxation;
use super::real_parts::real_parts;
use super::relaxing_classes::relaxing;
use super::relaxing_directions::amplitudes;
use super::relaxing_modes::{Relaxing, at_rest_beyond};
use super::row_blocks::RowBlocks;
use super::shapes::{Forms, Shapes};
use super::short_waves::ShortWaves;
use super::{FoundationPoints, Projection};
use crate::error::{Error, Result};
use crate::scene::Fault;

/// A body's answer to the contact's force, u_hit = aᵀu, as a sum over first-order coordinates, one free motion, and a spring:
///
/// ż_i = λ_i z_i + b_i F + g_i,  Ẍ = F/m + g,  u_hit = Re Σ c_i z_i + X + r F.
///
/// A free vibration of frequency ω is one z = v + iωx with λ = iω; with dampers the z are the coordinates along the eigenvectors
/// of (x, v), of which one of each conjugate pair is kept. An infinite plate is one with λ = 0, and its short waves are some more
/// ([`InfinitePlate`](super::InfinitePlate)), which come last.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// The coordinates.
    pub modes: Vec<Mode>,
    /// 1/m of the free motions together, 1/kg; g, m/s²; and Σ f² of their loads, W.
    pub free: Free,
    /// r, m/N: the static answer of the modes that are left out.
    pub residual: f64,
    /// How far the loads move the surface in the modes that are left out, m: where the body starts in equilibrium.
    pub rest: f64,
    /// Where the energy is.
    pub(crate) forms: Forms,
    /// How all of the body moves.
    pub(crate) shapes: Shapes,
    /// The stresses under the hit on the other face, three forms, with what they lack for 1 N; or none.
    pub(crate) hit_stress: Option<(Shapes, [f64; 3])>,
    /// Unilateral foundations, whose springs the modes have.
    pub(crate) foundation: Option<ModalFoundation>,
}

/// Unilateral foundations on the real coordinates x of the vibrations. The modes that are left out do not move them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ModalFoundation {
    /// Their points; s ū is less what the modes that are left out move in equilibrium.
    pub points: FoundationPoints,
    /// b of forces on x, with dampers; without it is 1.
    pub inputs: Option<DMatrix<Complex<f64>>>,
}

/// One first-order coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// λ, 1/s.
    pub rate: Complex<f64>,
    /// b.
    pub input: Complex<f64>,
    /// g.
    pub load: Complex<f64>,
    /// c.
    pub output: Complex<f64>,
}

/// The motions that nothing resists, as one: with φ and f of each, u = Σ φ x, ẍ = φ F + f.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Free {
    /// Σ φ², 1/kg.
    pub mobility: f64,
    /// Σ φ f, m/s².
    pub load: f64,
    /// Σ f², W.
    pub square: f64,
}

/// A contact that is closed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Closed {
    /// Tangent of Hertz's law, N/m.
    pub tangent: f64,
    /// c_l of the contact law, m/N.
    pub compliance: f64,
    /// Mass of the impactor, kg.
    pub mass: f64,
    /// What the modes' relaxation may change of the force, over its peak.
    pub accuracy: f64,
    /// How long the run is, s.
    pub end: f64,
}

/// ω² below this part of the largest one is rounding.
const ROUNDING: f64 = 1e-14;

/// The part of the loads' squares on motions that nothing holds which rounding makes.
const UNHELD: f64 = 1e-16;

/// How far a mode moves the surface under its loads at most, m.
const DEEPEST: f64 = 1.0;

/// The part of a mode's stiffness that unilateral foundations may have where it is left out: where these let go, it is slower.
const OF_FOUNDATION: f64 = 0.01;

/// The part of a layer's modulus in the modes that may relax where modes are left out. (A laminate whose interlayer falls to a thousandth was
/// off by 2% of the peak with the modes left out that the steps do not resolve.)
const RELAXING: f64 = 0.1;

/// That loads move a body that nothing holds.
pub(crate) fn no_equilibrium() -> Error {
    let message = "there is no equilibrium: the loads move the body in a direction in which nothing holds it";
    Fault::new("time.initial", message, "supports that hold the loads, or `initial = \"rest\"`").into()
}

impl Modes {
    /// A body that does not move: a half-space, whose dent Hertz's law holds.
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
        }
    }

    /// A surface that moves at F/Z: an infinite plate of the impedance Z, N s/m.
    pub fn dashpot(impedance: f64) -> Self {
        let [zero, one] = [Complex::new(0.0, 0.0), Complex::new(1.0, 0.0)];
        let mode = Mode { rate: zero, input: one / impedance, load: zero, output: one };
        // What goes off in its waves counts as dissipated.
        let forms = Forms { is_open: true, ..Forms::none() };
        Self { modes: vec![mode], forms, ..Self::none() }
    }

    /// Refuses a body that its loads set in motion.
    ///
    /// # Errors
    /// A fault of `time.initial`.
    pub fn require_equilibrium(&self) -> Result<()> {
        let held: f64 = self.modes.iter().map(|mode| mode.load.norm_sqr()).sum();
        let is_held = self.free.square <= UNHELD * (held + self.free.square);
        // A motion that nothing holds may have a frequency, of rounding.
        let sinks = |mode: &Mode| (mode.output * mode.load).norm() > DEEPEST * mode.rate.norm();
        if is_held && !self.modes.iter().any(sinks) { Ok(()) } else { Err(no_equilibrium()) }
    }

    /// x of the vibrations from z.
    pub(crate) fn places(&self, z: &[Complex<f64>]) -> DVector<f64> {
        if let Some([places, _]) = &self.forms.damped {
            return real_parts(places, z);
        }
        let frequencies = &self.forms.frequencies;
        DVector::from_iterator(frequencies.len(), z.iter().zip(frequencies).map(|(z, frequency)| z.im / frequency))
    }

    /// The fastest of the rates |λ|, 1/s.
    pub fn fastest(&self) -> f64 {
        self.modes.iter().map(|mode| mode.rate.norm()).fold(0.0, f64::max)
    }
}

/// The free vibrations of a body on a basis.
pub struct Spectrum {
    /// ω², 1/s², ascending.
    pub(super) squares: DVector<f64>,
    /// Vᵀa, Vᵀf and Vᵀ∫kū along them; where short waves are kept apart, Vᵀa by the weights.
    force: DVector<f64>,
    load: DVector<f64>,
    support_load: DVector<f64>,
    /// F of the supports' K = FᵀF along them.
    support: DMatrix<f64>,
    damping: Option<DMatrix<f64>>,
    relaxations: Vec<ModalRelaxation>,
    /// The rate at which the basis was made, 1/s.
    rate: f64,
    /// Whether a modulus falls by so much that modes which are left out would be other springs later.
    pub(super) relaxes: bool,
    support_offset: f64,
    /// The vibrations on the basis, by columns.
    vectors: DMatrix<f64>,
    /// Stresses under the hit on the basis, a row each.
    hit_stress: DMatrix<f64>,
    hit_local: [f64; 3],
    /// Unilateral foundations along them.
    foundation: Option<FoundationPoints>,
    /// How many of the modes, the lowest first, have those that foundations stiffen.
    stiffened: usize,
    /// The coordinates of waves that the modes leave out, and √g of the modes, where these are kept apart.
    short_waves: Option<ShortWaves>,
}

impl Spectrum {
    /// Solves K y = ω² y on the basis, where parts relax with their moduli at its rate.
    pub fn new(projection: &Projection) -> Self {
        let (squares, vectors) = symmetric_eigen(projection.stiffness_at_rate());
        let along = |v: &DVector<f64>| vectors.tr_mul(v);
        let on = |m: &DMatrix<f64>| vectors.transpose() * (m * &vectors);
        let of_relaxations = projection.relaxations.iter().filter(|part| !part.chain.terms.is_empty());
        let of_relaxations = of_relaxations.map(|part| ModalRelaxation::new(part, &vectors, projection.rate));
        let mut force = along(&projection.force);
        let short_waves = ShortWaves::new(projection, &squares, &force);
        if let Some(ShortWaves { weights, .. }) = &short_waves {
            force.component_mul_assign(weights);
        }
        let foundation = projection.foundation.as_ref().map(|points| points.on(&vectors));
        let is_stiffened = |i: &usize| {
            let stiffness = foundation.as_ref().map_or(0.0, |points: &FoundationPoints| points.square(*i));
            stiffness > OF_FOUNDATION * squares[*i].max(0.0)
        };
        Self {
            stiffened: (0..squares.len()).rev().find(is_stiffened).map_or(0, |last| last + 1),
            squares,
            force,
            load: along(&projection.load),
            support_load: along(&projection.support_load),
            support: semidefinite_factor_times(&projection.support, &vectors),
            damping: projection.damping.as_ref().map(on),
            relaxations: of_relaxations.collect(),
            rate: projection.rate,
            relaxes: projection.relaxations.iter().any(|part| {
                let chain = &part.chain;
                chain.transformed_terms(projection.rate) > RELAXING * chain.transformed(projection.rate)
            }),
            support_offset: projection.support_offset,
            foundation,
            vectors,
            hit_stress: projection.hit_stress.clone(),
            hit_local: projection.hit_local,
            short_waves,
        }
    }

    /// The highest frequency of the modes that unilateral foundations stiffen, rad/s: none of these is left out.
    pub fn stiffened(&self) -> f64 {
        self.stiffened.checked_sub(1).map_or(0.0, |last| self.squares[last].max(0.0).sqrt())
    }

    /// How many of the modes, the lowest first, vibrate no faster than a frequency (rad/s) while the contact is closed.
    ///
    /// A spring k between the body and a mass lifts ω² of the highest of n modes by no more than k (1/m0 + Σ φ²). The spring is the
    /// tangent of Hertz's law at a force, in series with what the modes left out give way, less what the law holds of the body already:
    /// the more modes are kept, the stiffer it is.
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

    /// How many of the modes, the lowest first, take part where those up to a frequency (rad/s) in contact do.
    pub fn count(&self, cutoff: f64, closed: &Closed) -> usize {
        // What nothing holds has no static answer.
        let free = self.squares.iter().filter(|square| **square <= ROUNDING * self.squares.max()).count();
        let kept = self.short_waves.as_ref().map_or(self.squares.len(), |waves| waves.kept);
        self.slower_than(cutoff, closed).min(kept).max(free).max(self.stiffened)
    }

    /// The first modes; the others are left out but for their static answer. The modes' relaxation may change the force by an accuracy, over
    /// its peak, in a run of a length (s).
    ///
    /// # Errors
    /// [`Error::Solve`] where dampers leave the body without independent modes.
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
            // Where the foundations are left in equilibrium, their springs pull less than they would.
            loads -= points.rows.tr_mul(&points.resting);
        }
        // Short waves that the modes leave out do not take the modes' part of what is read.
        let reach = self.short_waves.as_ref().map_or(&self.force, |waves| &waves.force);
        if let Some(ShortWaves { weights, .. }) = &self.short_waves {
            shapes.moving.column_iter_mut().zip(&moving).for_each(|(mut shape, &i)| shape.unscale_mut(weights[i]));
        }
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
            // What relaxes couples the modes that are left out with the others.
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
        // (Under loads the body creeps to the equilibrium of all directions.)
        if loads.amax() == 0.0 {
            let amplitudes = amplitudes(&squares, &force, self.rate);
            relaxations =
                relaxations.into_iter().filter_map(|part| part.in_few_directions(&amplitudes, end, accuracy)).collect();
        }
        let mut of_relaxing = None;
        let (mut modes, mut damped, inputs) = match &self.damping {
            damping if !relaxations.is_empty() => {
                let damping = damping.as_ref().map(block);
                let Relaxing { damped, forms } = relaxing(&squares, damping.as_ref(), &relaxations, [&force, &load])?;
                of_relaxing = Some(forms);
                (damped.modes, Some(damped.shapes), Some(damped.inputs))
            }
            None => (vibrations(&squares, &force, &load), None, None),
            Some(damping) => {
                let Damped { modes, shapes, inputs } = damped(&squares, &block(damping), &force, &load)?;
                (modes, Some(shapes), Some(inputs))
            }
        };
        if let Some(ShortWaves { coordinates, .. }) = &self.short_waves {
            modes.extend(coordinates);
            // They are no part of x and v.
            damped =
                damped.map(|shapes| shapes.map(|shape| shape.resize_horizontally(modes.len(), Complex::new(0.0, 0.0))));
        }
        let foundation = self.foundation.as_ref().map(|all| {
            let mut points = all.select(&moving);
            if points.is_settled {
                points.offsets.gemv(-1.0, &all.rows, &at_rest, 1.0);
            }
            ModalFoundation { points, inputs }
        });
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
        let hit_stress = (self.hit_stress.nrows() > 0).then(|| (shapes.mapped(&self.hit_stress), self.hit_local));
        Ok(Modes { modes, free, residual, rest, forms, shapes, hit_stress, foundation })
    }
}

/// z = v + iωx: ż = iω z + φF + f, x = Im z/ω.
fn vibrations(squares: &DVector<f64>, force: &DVector<f64>, load: &DVector<f64>) -> Vec<Mode> {
    let real = |x: f64| Complex::new(x, 0.0);
    let mode = |i: usize| {
        // A frequency of nothing but rounding is not divided by.
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
