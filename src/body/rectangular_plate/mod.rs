//! Modes of a rectangular plate in closed form, for waves that are short compared with its edges.
//!
//! Away from the edges, a mode of a rectangular plate is a product cos(k_x x − ψ_x) cos(k_y y − ψ_y). An edge reflects
//! such a wave with a phase that depends on its support. The wavenumbers are those with which the wave is in phase
//! again after its way to both edges and back (V. V. Bolotin, *The edge effect in the oscillations of elastic shells*,
//! J. Appl. Math. Mech. 24, 1960):
//!
//! k_x L_x = m π + ψ₀ + ψ₁,   and alike for y.
//!
//! A free edge also guides waves that decay slowly away from it (Y. K. Konenkov, Sov. Phys. Acoust. 6, 1960). Their
//! modes have k_x² < 0. With the standing waves w₀ and w₁ of both edges, which are functions of k_x² of either sign,
//! the condition is that their Wronskian W = w₀ w₁' − w₀' w₁ vanishes.
//!
//! The squared amplitude of a mode at the impact point is that of the infinite plate on average over the plate, so that
//! the sum over modes is the response of the infinite plate until the first echo (Poisson's summation formula). Waves
//! that corners scatter are neglected.

mod axis;
mod edge;
mod layered;
mod waves;

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::Mode;
use super::infinite_plate::InfinitePlate;
use crate::material::Maxwell;
use axis::Axis;

pub use edge::EdgeSprings;
pub use layered::{LaminateWave, LayeredWaves, Wavenumbers};
pub use waves::{BendingWaves, PlateWaves};

/// Largest number of iterations between both axes for the wavenumbers of a mode, which start from those of its
/// neighbour; and the change of a squared wavenumber, over that of the wave, at which they end.
const MAX_ITERATIONS: usize = 20;
const CHANGE: f64 = 1e-8;

/// Change of a squared wavenumber for derivatives, over the larger of it and that of the lowest mode.
const STEP: f64 = 1e-5;

/// Modes whose squared amplitude at the impact point is below this part of an average one do not move it.
const NEGLIGIBLE_SHAPE: f64 = 1e-6;

/// Modes with a smaller weight are left out.
const NEGLIGIBLE_WEIGHT: f64 = 1e-2;

/// Rectangular plate whose short waves are computed in closed form.
#[derive(Debug, Clone, PartialEq)]
pub struct RectangularPlate {
    /// Lengths of the edges, m.
    pub lengths: [f64; 2],
    /// Distances of the impact point from the lower edge across each axis, m.
    pub hit: [f64; 2],
    /// Whether only the motions symmetric across the middle of each axis are modelled.
    pub is_symmetric: [bool; 2],
    /// Lower and upper edge across each axis.
    pub edges: [[EdgeSprings; 2]; 2],
    /// Bending waves of the plate.
    pub waves: PlateWaves,
}

impl RectangularPlate {
    /// Applies `of` to the waves of the layers. `None` if `of` returns `None`.
    fn with_layered(self, of: impl Fn(&LayeredWaves) -> Option<LayeredWaves>) -> Option<Self> {
        match &self.waves {
            PlateWaves::Mindlin(_) => Some(self),
            PlateWaves::Layered(waves) => of(waves).map(|waves| Self { waves: PlateWaves::Layered(waves), ..self }),
        }
    }

    /// Returns the plate with other Prony series for its viscoelastic parts, in the same order, and with the moduli at a
    /// rate (1/s). `None` if these have no table of waves.
    pub fn with_chains(self, chains: &[&Maxwell], rate: f64) -> Option<Self> {
        self.with_layered(|waves| waves.with_chains(chains, rate))
    }

    /// Returns the plate with the moduli of viscoelastic parts at a rate (1/s). `None` if these have no table of waves.
    pub fn at_rate(self, rate: f64) -> Option<Self> {
        self.with_layered(|waves| waves.at_rate(rate))
    }

    /// One of both axes.
    fn axis(&self, axis: usize) -> Axis<'_> {
        Axis { length: self.lengths[axis], edges: &self.edges[axis], waves: &self.waves }
    }

    /// Whether the waves scattered by all corners meet at the impact point. Corners of edges that can deflect scatter
    /// most.
    pub fn do_corner_waves_meet(&self) -> bool {
        self.is_symmetric == [true; 2] && self.edges.as_flattened().iter().any(|edge| edge.deflection.is_finite())
    }

    /// Squared wavenumbers (1/m²) along both axes of the mode with the given numbers, from a first guess; `None` if
    /// there is no such mode.
    fn squares(&self, numbers: [usize; 2], guess: [f64; 2]) -> Option<[f64; 2]> {
        let mut squares = guess;
        for _ in 0..MAX_ITERATIONS {
            let before = squares;
            for axis in 0..2 {
                squares[axis] = self.axis(axis).square(numbers[axis], squares[axis], squares[1 - axis])?;
            }
            let size = squares[0] + squares[1];
            if (0..2).all(|axis| (squares[axis] - before[axis]).abs() <= CHANGE * size) {
                break;
            }
        }
        Some(squares)
    }

    /// w² of a mode at the impact point over its integral over the plate, 1/m².
    ///
    /// The integral of w² is |c ∂W/∂k²| along one axis with fixed wavenumbers along the other, with c = w₀/w₁, and for
    /// both axes |c_x c_y det ∂(W_x, W_y)/∂(k_x², k_y²)|.
    fn shape(&self, squares: [f64; 2]) -> f64 {
        let pair_at = |axis: usize, squares: [f64; 2]| self.axis(axis).pair(squares[axis], squares[1 - axis]);
        let derivative = |of: usize, by: usize| {
            let step = STEP * squares[by].abs().max((PI / self.lengths[by]).powi(2));
            let at = |sign: f64| {
                let mut squares = squares;
                squares[by] += sign * step;
                pair_at(of, squares).wronskian()
            };
            (at(1.0) - at(-1.0)) / (2.0 * step)
        };
        let determinant = derivative(0, 0) * derivative(1, 1) - derivative(0, 1) * derivative(1, 0);
        let [x, y] = [0, 1].map(|axis| {
            let pair = pair_at(axis, squares);
            pair.lower.at(self.hit[axis]).powi(2) / pair.ratio()
        });
        x * y / determinant.abs()
    }

    /// Calls `visit` with the frequency (rad/s) and the squared wavenumbers (1/m²) of each mode with a frequency up to
    /// `end` (rad/s). Where only symmetric motions are modelled, the others are left out.
    fn each_mode(&self, end: f64, mut visit: impl FnMut(f64, [f64; 2])) {
        let steps = self.is_symmetric.map(|is_symmetric| if is_symmetric { 2 } else { 1 });
        let spacing = [0, 1].map(|axis| PI / self.lengths[axis]);
        let next = |square: f64, axis: usize| (square.max(0.0).sqrt() + steps[axis] as f64 * spacing[axis]).powi(2);
        for m in (0..).step_by(steps[0]) {
            let mut guess = [((m as f64 + 0.5) * spacing[0]).powi(2), (0.5 * spacing[1]).powi(2)];
            let mut are_above = m > 0;
            for n in (0..).step_by(steps[1]) {
                let Some(squares) = self.squares([m, n], guess) else {
                    guess[1] = next(guess[1], 1);
                    if self.waves.frequency(guess[1].sqrt()) > end {
                        break;
                    }
                    continue;
                };
                guess = [squares[0], next(squares[1], 1)];
                let frequency = self.waves.frequency((squares[0] + squares[1]).sqrt());
                if frequency > end || frequency.is_nan() {
                    break;
                }
                are_above = false;
                visit(frequency, squares);
            }
            if are_above {
                break;
            }
        }
    }

    /// Returns the frequencies of all modes up to `end` (rad/s), ascending, without those of motions that
    /// are not modelled.
    pub fn frequencies(&self, end: f64) -> Vec<f64> {
        let mut frequencies = Vec::new();
        self.each_mode(end, |frequency, _| frequencies.push(frequency));
        frequencies.sort_by(f64::total_cmp);
        frequencies
    }

    /// Returns the modes that move the impact point, as first-order coordinates.
    ///
    /// `plate` has the density of modes. `weight` returns the weight of a mode of a frequency (rad/s) in its squared
    /// amplitude. Modes above the frequency `end` (rad/s) have no weight.
    pub fn modes(&self, plate: &InfinitePlate, end: f64, weight: impl Fn(f64) -> f64) -> Vec<Mode> {
        let area = self.lengths[0] * self.lengths[1];
        let mut modes = Vec::new();
        self.each_mode(end, |frequency, squares| {
            let weight = weight(frequency);
            if weight < NEGLIGIBLE_WEIGHT {
                return;
            }
            // Squared displacement on average over the plate.
            let wavenumber = (squares[0] + squares[1]).sqrt();
            let average = match &self.waves {
                PlateWaves::Mindlin(waves) => {
                    // There are area ξ dξ/2π modes in dξ.
                    let modes_per_frequency = area * wavenumber / (TAU * waves.group_velocity(wavenumber));
                    plate.density_at(frequency) / modes_per_frequency
                }
                PlateWaves::Layered(waves) => waves.squared_displacement(wavenumber) / area,
            };
            let shape = area * self.shape(squares);
            if shape >= NEGLIGIBLE_SHAPE {
                modes.push(vibration(self.waves.eigenvalue(wavenumber), (weight * average * shape).sqrt()));
            }
        });
        modes
    }
}

/// Free vibration with the eigenvalue `rate` (1/s) and an amplitude at the impact point (1/√kg).
fn vibration(rate: Complex<f64>, amplitude: f64) -> Mode {
    Mode {
        rate,
        input: Complex::new(amplitude, 0.0),
        load: Complex::new(0.0, 0.0),
        output: Complex::new(0.0, -amplitude / rate.im),
    }
}

#[cfg(test)]
mod tests {
    use super::edge::StandingWave;
    use super::layered::tests::of_mindlin;
    use super::*;

    const THICKNESS: f64 = 0.008;

    fn bending_waves() -> BendingWaves {
        let (young, poisson, density, h) = (70e9, 0.23, 2500.0, THICKNESS);
        BendingWaves {
            poisson,
            mass: density * h,
            rigidity: young * h * h * h / (12.0 * (1.0 - poisson * poisson)),
            shear: 0.8666 * 0.5 * young / (1.0 + poisson) * h,
            rotary: density * h * h * h / 12.0,
        }
    }

    fn plate(edges: [[EdgeSprings; 2]; 2]) -> RectangularPlate {
        let waves = PlateWaves::Mindlin(bending_waves());
        RectangularPlate { lengths: [1.0, 1.5], hit: [0.5, 0.75], is_symmetric: [true; 2], edges, waves }
    }

    /// Phase at an edge for the wavenumbers across and along it.
    fn phase(edge: &EdgeSprings, wavenumbers: [f64; 2]) -> f64 {
        let [across, along] = wavenumbers.map(|wavenumber| wavenumber * wavenumber);
        StandingWave::at_edge(edge, &bending_waves(), edge::SquaredWavenumbers { across, along }).phase()
    }

    const FREE: EdgeSprings = EdgeSprings { deflection: 0.0, rotation: 0.0, twist: 0.0 };
    const CLAMPED: EdgeSprings =
        EdgeSprings { deflection: f64::INFINITY, rotation: f64::INFINITY, twist: f64::INFINITY };
    /// Simply supported, with the rotation along the edge held, as for Navier's solution.
    const SIMPLY_SUPPORTED: EdgeSprings =
        EdgeSprings { deflection: f64::INFINITY, rotation: 0.0, twist: f64::INFINITY };

    /// Long waves at right angles to an edge have the phases of a beam: −π/4 at a free, π/2 at a simply supported and
    /// 3π/4 at a clamped edge, up to terms (kh)².
    #[test]
    fn phases_at_right_angles_are_those_of_beams() {
        let at = |edge: EdgeSprings, across: f64| phase(&edge, [across, 0.0]) / PI;
        for across in [5.0, 50.0] {
            let short = (across * THICKNESS).powi(2);
            for (edge, exact) in [(FREE, -0.25), (SIMPLY_SUPPORTED, 0.5), (CLAMPED, 0.75)] {
                let found = at(edge, across);
                assert!((found - exact).abs() < 0.5 * short, "{edge:?}: {found} for {exact}");
            }
        }
    }

    /// A simply supported edge reflects waves of every direction with the phase π/2, so that all modes are Navier's.
    #[test]
    fn modes_of_a_simply_supported_plate_are_those_of_navier() {
        let plate = plate([[SIMPLY_SUPPORTED; 2]; 2]);
        for (m, n) in [(0, 0), (3, 0), (7, 12), (40, 3)] {
            let [x, y] = [0, 1].map(|axis| ([m, n][axis] as f64 + 1.0) * PI / plate.lengths[axis]);
            let found = plate.squares([m, n], [1.1 * x * x, 0.9 * y * y]).expect("a mode");
            assert!((found[0] / (x * x) - 1.0).abs() < 1e-9 && (found[1] / (y * y) - 1.0).abs() < 1e-9, "{found:?}");
            let at_hit = [0, 1].map(|axis| (found[axis].sqrt() * plate.hit[axis]).sin().powi(2));
            let exact = 4.0 / (plate.lengths[0] * plate.lengths[1]) * at_hit[0] * at_hit[1];
            assert!((plate.shape(found) - exact).abs() < 1e-7 * exact.max(1.0), "{} {exact}", plate.shape(found));
        }
        // A centred impact moves the modes with an odd number of half waves along both axes.
        let end = 1e5;
        let is_below = |m: usize, n: usize| {
            let wavenumber = (m as f64 * PI / plate.lengths[0]).hypot(n as f64 * PI / plate.lengths[1]);
            plate.waves.frequency(wavenumber) <= end
        };
        let count = |m: usize| (1..).step_by(2).take_while(|n| is_below(m, *n)).count();
        let exact: usize = (1..).step_by(2).map(count).take_while(|count| *count > 0).sum();
        assert_eq!(plate.frequencies(end).len(), exact);
    }

    /// The lowest mode between two free edges far apart is a wave that one of them guides. On a thin plate its
    /// wavenumber k satisfies (k/ξ)⁻⁴ = (1 − ν) (3ν − 1 + 2 √(2ν² − 2ν + 1)) with ξ that of free waves (Konenkov).
    /// Tolerance: terms (kh)² = 1.6e-5, over the decay k² − ξ² = 5.6e-4 ξ², are some percent of the decay.
    #[test]
    fn free_edges_guide_waves() {
        let mut plate = plate([[FREE; 2]; 2]);
        plate.lengths[0] = 1000.0;
        let along = 0.5_f64.powi(2);
        let across = plate.axis(0).square(0, 0.0, along).expect("a wave along the edge");
        let nu = bending_waves().poisson;
        let ratio = ((1.0 - nu) * (3.0 * nu - 1.0 + 2.0 * (2.0 * nu * nu - 2.0 * nu + 1.0).sqrt())).powf(0.5);
        let exact = -(1.0 - ratio) * along;
        assert!((across / exact - 1.0).abs() < 0.05, "{across} {exact}");
    }

    /// The phase changes continuously as an edge turns from free through simply supported to clamped, for all
    /// directions. A jump would add or remove modes.
    #[test]
    fn phases_are_continuous() {
        for (across, along) in [(50.0, 1.0), (50.0, 50.0), (5.0, 80.0)] {
            let mut before: Option<f64> = None;
            let springs = (0..600).map(|i| {
                let strength = 10_f64.powf(0.05 * f64::from(i % 300) - 5.0);
                match i < 300 {
                    true => EdgeSprings { deflection: strength * 3e8, ..FREE },
                    false => EdgeSprings { deflection: 3e18, rotation: strength * 3e3, twist: strength * 3e3 },
                }
            });
            for edge in springs {
                let found = phase(&edge, [across, along]);
                assert!(before.is_none_or(|before| (found - before).abs() < 0.3), "{edge:?}: {found} after {before:?}");
                before = Some(found);
            }
        }
    }

    /// A centred impact moves the symmetric modes only, and they are found without the others.
    #[test]
    fn symmetric_modes_are_those_that_move_the_centre() {
        for edge in [
            SIMPLY_SUPPORTED,
            EdgeSprings { twist: 0.0, ..SIMPLY_SUPPORTED },
            EdgeSprings { rotation: 3e4, ..SIMPLY_SUPPORTED },
            CLAMPED,
        ] {
            let centred = plate([[edge; 2]; 2]);
            // Off the centre by little, all modes are searched.
            let beside =
                RectangularPlate { hit: [0.5 + 1e-6, 0.75 + 1e-6], is_symmetric: [false; 2], ..centred.clone() };
            let infinite = InfinitePlate::of(vec![(0.0, 1e-4)]);
            let [one, other] = [centred, beside].map(|plate| {
                let modes = plate.modes(&infinite, 8e4, |_| 1.0);
                // Off the centre, modes with a node near it move it by little.
                let moving = modes.iter().filter(|mode| mode.input.re > 0.05);
                let mut rates: Vec<(f64, f64)> = moving.map(|mode| (mode.rate.im, mode.input.re)).collect();
                rates.sort_by(|a, b| a.0.total_cmp(&b.0));
                rates
            });
            for (a, b) in one.iter().zip(&other) {
                assert!((a.0 / b.0 - 1.0).abs() < 1e-6, "{edge:?} {a:?} {b:?}");
            }
            assert_eq!(one.len(), other.len(), "{edge:?}");
        }
    }

    /// Far below the frequency `end`, the sum of the squared amplitudes is that of the infinite plate (2/(π Z) for each
    /// rad/s), for all edges. Tolerance: two hundred modes fluctuate by some percent.
    #[test]
    fn modes_have_the_density_of_an_infinite_plate() {
        for edge in [FREE, SIMPLY_SUPPORTED, CLAMPED] {
            let rectangle = plate([[edge; 2]; 2]);
            let BendingWaves { mass, rigidity, .. } = bending_waves();
            let density = 2.0 / (PI * 8.0 * (mass * rigidity).sqrt());
            let infinite = InfinitePlate::of(vec![(0.0, density)]);
            let end = 8e4;
            let modes = rectangle.modes(&infinite, end, |_| 1.0);
            let sum: f64 = modes.iter().map(|mode| mode.input.re.powi(2)).sum();
            assert!(modes.len() > 150 && (sum / (density * end) - 1.0).abs() < 0.04, "{} {sum}", modes.len());
        }
    }

    /// A table made of the waves of Mindlin's plate has the modes of this plate. Tolerances: the cubics of the table have an
    /// error of 2e-6, and the amplitude depends on the squared displacement, whose density over ω is interpolated linearly.
    #[test]
    fn a_table_has_the_modes_of_its_plate() {
        let springs = EdgeSprings { deflection: 1e7, rotation: 50.0, twist: 50.0 };
        let mut mindlin = plate([[CLAMPED; 2], [springs; 2]]);
        (mindlin.hit, mindlin.is_symmetric) = ([0.4, 0.7], [false; 2]);
        let waves = bending_waves();
        let wavenumbers = Wavenumbers { first: 1.0, ratio: 1.05 };
        let all = (0..140).map(|i| of_mindlin(waves, wavenumbers.at(i))).collect();
        let table = LayeredWaves::new(all, wavenumbers, waves, &[], 1e4).expect("bending waves");
        // ν = ξ r²/(2π dω/dξ).
        let density = (0..4000).map(|i| {
            let wavenumber = 1.0 + 0.1 * f64::from(i);
            let of_wave = table.squared_displacement(wavenumber) / waves.group_velocity(wavenumber);
            (waves.frequency(wavenumber), wavenumber * of_wave / TAU)
        });
        let infinite = InfinitePlate::of(density.collect());
        let layered = RectangularPlate { waves: PlateWaves::Layered(table), ..mindlin.clone() };
        let [expected, found] = [&mindlin, &layered].map(|plate| plate.modes(&infinite, 4e4, |_| 1.0));
        assert!(found.len() == expected.len() && found.len() > 100, "{} {}", found.len(), expected.len());
        for (mode, same) in found.iter().zip(&expected) {
            assert!((mode.rate / same.rate - 1.0).norm() < 1e-5, "{} {}", mode.rate, same.rate);
            assert!((mode.input.re / same.input.re - 1.0).abs() < 1e-3, "{}: {} {}", mode.rate, mode.input, same.input);
        }
    }
}
