//! Infinite-plate model for the shortest waves of a plate: the response of an infinite plate of the same section at the
//! impact point, valid until the first echo.
//!
//! Short waves disperse on their way to the edges and back, so that neglecting their echoes causes little error. A long
//! basis therefore keeps only the modes below a frequency ω_c. Each mode is weighted by √g on its input and on its
//! output, with Butterworth's g(ω) = 1/(1 + (ω/ω_c)^{2n}). The continuous spectrum of the infinite plate takes the part
//! 1 − g.
//!
//! The mobility of an infinite plate is a sum over waves: Σ φ² over the modes within dω tends to ν(ω) dω, with
//! ν = (2/π) Re Y(iω). For a thin plate, ν is constant, ν = 2/(π Z) with Zener's impedance Z. With
//! B(s) = −(1/n) Σ λ/(s − λ) over the n poles λ of g with Re λ < 0, Re B(iω) = g(ω) and B(0) = 1. The remaining
//! mobility (1 − B)/Z therefore has no pole at zero: the surface moves by
//!
//! u = Re Σ c z,  ż = λ z + F,  c = 2/(n Z)
//!
//! over the poles with Im λ > 0. If ν decreases with the frequency, as for a plate that is loaded on a disc, it is
//! approximated by bands: Σ_k Y_k (B_{k+1} − B_k). The terms at each band edge are again coordinates of this kind. The
//! sum of all bands has no negative density. These coordinates together therefore only absorb energy, which counts as
//! dissipated.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::Complex;

use super::Mode;
use super::shift::vectors_over_one_shift;

/// Order n of g: its number of poles with Re λ < 0.
const POLES: usize = 8;

/// Ratio of the two edges of a band.
const BAND: f64 = 1.25;

/// Modes with a smaller g do not move the impact point.
const SMALLEST_WEIGHT: f64 = 1e-3;

/// Number of basis vectors for each mode below ω_c, at a shift of [`SHIFT_OVER_CUTOFF`]. Measured on a pane: a value of
/// 1 leaves an error of 1e-3 of the peak in the first contact and 4e-3 over three times this period; 0.9 leaves 5e-3
/// and 1.4e-2. With free edges, several hundred modes are up to a tenth more than the area gives.
pub const VECTORS_PER_MODE: f64 = 1.1;

/// Ratio of the shift to ω_c. Larger shifts suit a short contact better, but the basis lacks the slow motions that
/// influence later contacts.
pub const SHIFT_OVER_CUTOFF: f64 = 0.5;

/// Response of the infinite plate at the impact point, for the modelled part of the plate.
#[derive(Debug, Clone, PartialEq)]
pub struct InfinitePlate {
    /// Pairs of the frequency ω (rad/s), ascending, and the modal density ν (s/kg). ν is constant below the first
    /// frequency. Beyond the last, it is zero, or constant if there is only one pair.
    pub density: Vec<(f64, f64)>,
    /// Waves not contained in ν, which are faster than any contact: pairs of the frequency ω (rad/s) and the compliance
    /// as a spring, m/N.
    pub fast_wave_compliances: Vec<(f64, f64)>,
    /// Number of modes of the modelled part up to a frequency.
    pub modes: ModeCount,
    /// Impedance Z of the whole plate by thin-plate theory, N s/m.
    pub impedance: f64,
    /// Distance of the impact point from the nearest edge, m.
    pub distance_to_edge: f64,
    /// Number of basis vectors for each mode below ω_c.
    pub vectors_per_mode: f64,
}

/// Number of bending modes of a plate up to a frequency, estimated from its area A (Weyl's law): A ξ²/4π modes have
/// wavenumbers below ξ.
#[derive(Debug, Clone, PartialEq)]
pub struct ModeCount {
    /// Number of modes of the modelled part over ξ², m².
    pub over_square: f64,
    /// Pairs of the frequency ω (rad/s) and the square ξ² of its wavenumber (1/m²), both ascending; at least two. ξ² is
    /// linear in ω between two pairs, and beyond them.
    pub dispersion: Vec<(f64, f64)>,
}

impl ModeCount {
    /// Modes of a thin plate, with √(ρh/D) = ξ²/ω in s/m².
    pub fn of_thin_plate(over_square: f64, slowness: f64) -> Self {
        Self { over_square, dispersion: vec![(0.0, 0.0), (1.0, slowness)] }
    }

    /// Returns ξ² at a frequency (rad/s), 1/m².
    fn square(&self, frequency: f64) -> f64 {
        linear(&self.dispersion, frequency, |pair| *pair)
    }

    /// Returns the number of modes up to a frequency (rad/s).
    pub fn up_to(&self, frequency: f64) -> f64 {
        self.over_square * self.square(frequency)
    }

    /// Returns the frequency (rad/s) up to which there are this many modes.
    pub fn frequency(&self, modes: f64) -> f64 {
        linear(&self.dispersion, modes / self.over_square, |(frequency, square)| (*square, *frequency))
    }
}

/// Interpolates linearly between pairs and extrapolates beyond them; `of` returns argument and value of a pair.
fn linear(pairs: &[(f64, f64)], at: f64, of: impl Fn(&(f64, f64)) -> (f64, f64)) -> f64 {
    let after = pairs.partition_point(|pair| of(pair).0 < at).clamp(1, pairs.len() - 1);
    let [(a, from), (b, to)] = [&pairs[after - 1], &pairs[after]].map(of);
    from + (to - from) * (at - a) / (b - a)
}

impl InfinitePlate {
    /// Returns the plate for a basis with a number of shifts. Only the vectors at the first shift count as resolving
    /// modes.
    pub fn with_shifts(self, shifts: usize) -> Self {
        Self { vectors_per_mode: vectors_over_one_shift(shifts) * self.vectors_per_mode, ..self }
    }

    /// Returns ω_c of a basis with this number of vectors: the frequency up to which it contains the modes, rad/s.
    pub fn cutoff(&self, vectors: usize) -> f64 {
        self.modes.frequency((vectors as f64 / self.vectors_per_mode).max(1.0))
    }

    /// Returns the number of basis vectors that contain the modes up to a frequency (rad/s).
    pub fn vectors(&self, frequency: f64) -> usize {
        (self.vectors_per_mode * self.modes.up_to(frequency)).ceil() as usize
    }

    /// Returns the rise time t of the contact force, s, for a contact stiffness k (N/m^1.5) and an impact speed v
    /// (m/s). It is the time at which the force k (v t)^1.5 on a half-space reaches Z v, the force due to the impedance
    /// of the plate.
    pub fn rise(&self, stiffness: f64, speed: f64) -> f64 {
        (self.impedance / stiffness).powf(2.0 / 3.0) / speed.cbrt()
    }

    /// Whether the distance to the nearest edge is shorter than the wavelength at a frequency (rad/s).
    pub fn is_near_edge(&self, frequency: f64) -> bool {
        self.distance_to_edge < TAU / self.modes.square(frequency).sqrt()
    }

    /// Returns ν at a frequency (rad/s), s/kg.
    pub fn density_at(&self, frequency: f64) -> f64 {
        let after = self.density.partition_point(|(at, _)| *at < frequency);
        match (after.checked_sub(1).and_then(|before| self.density.get(before)), self.density.get(after)) {
            (None, Some((_, value))) => *value,
            (Some((a, from)), Some((b, to))) => from + (to - from) * (frequency - a) / (b - a),
            (Some((_, value)), None) if self.density.len() == 1 => *value,
            _ => 0.0,
        }
    }

    /// Returns the static compliance of the waves that are faster than the contact, m/N, to be added to modes weighted
    /// up to ω_c (rad/s).
    pub fn static_compliance(&self, cutoff: f64) -> f64 {
        self.fast_wave_compliances.iter().map(|(frequency, part)| (1.0 - weight(*frequency, cutoff)) * part).sum()
    }

    /// Whether ν is equal at all frequencies, as for a thin plate.
    fn is_thin(&self) -> bool {
        self.density.len() == 1
    }

    /// Returns the coordinates that represent the part 1 − g above ω_c (rad/s).
    pub fn short_waves(&self, cutoff: f64) -> Vec<Mode> {
        let last = self.density.last().map_or(0.0, |(at, _)| *at);
        let mut edges = vec![cutoff];
        while !self.is_thin() && edges[edges.len() - 1] < last {
            edges.push(BAND * edges[edges.len() - 1]);
        }
        // Y between an edge and the next one. Beyond the last edge: the constant of a thin plate, or zero.
        let within = |k: usize| FRAC_PI_2 * self.density_at(edges[k] * BAND.sqrt());
        let mut modes = Vec::with_capacity(edges.len() * POLES / 2);
        let mut below = 0.0;
        for (k, edge) in edges.iter().enumerate() {
            let above = if k + 1 < edges.len() || self.is_thin() { within(k) } else { 0.0 };
            modes.extend(poles(*edge).map(|rate| Mode {
                rate,
                input: Complex::new(1.0, 0.0),
                load: Complex::new(0.0, 0.0),
                output: Complex::new(2.0 * (above - below) / POLES as f64, 0.0),
            }));
            below = above;
        }
        modes
    }
}

/// Returns g at a frequency for a cutoff ω_c (both rad/s). Negligible values are replaced by zero.
pub fn weight(frequency: f64, cutoff: f64) -> f64 {
    let weight = 1.0 / (1.0 + (frequency / cutoff).powi(2 * POLES as i32));
    if weight < SMALLEST_WEIGHT { 0.0 } else { weight }
}

/// Returns the poles λ of g with Re λ < 0 < Im λ, 1/s.
fn poles(cutoff: f64) -> impl Iterator<Item = Complex<f64>> {
    (0..POLES / 2).map(move |k| {
        let angle = PI * (2 * k + 1) as f64 / (2 * POLES) as f64;
        Complex::new(-cutoff * angle.sin(), cutoff * angle.cos())
    })
}

#[cfg(test)]
impl InfinitePlate {
    /// A plate with a modal density, for tests.
    pub(super) fn of(density: Vec<(f64, f64)>) -> Self {
        Self {
            density,
            fast_wave_compliances: Vec::new(),
            modes: ModeCount::of_thin_plate(1e-2, 0.1),
            impedance: 2000.0,
            distance_to_edge: 1.0,
            vectors_per_mode: VECTORS_PER_MODE,
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::body::{BodyTerms, Closed, ContactPort, Projection, Spectrum, StressReadings};

    /// Returns Re Y(iω) of coordinates: Y = s Σ c/(s − λ), with half of each conjugate pair.
    fn mobility(modes: &[Mode], frequency: f64) -> f64 {
        let s = Complex::new(0.0, frequency);
        let of = |mode: &Mode| {
            let pair = mode.output / (s - mode.rate) + mode.output.conj() / (s - mode.rate.conj());
            (s * pair * 0.5).re
        };
        modes.iter().map(of).sum()
    }

    /// The short waves of a thin plate have the mobility (1 − g)/Z at any frequency.
    #[test]
    fn short_waves_of_a_thin_plate_are_what_g_leaves() {
        let (impedance, cutoff): (f64, f64) = (2000.0, 1e5);
        let plate = InfinitePlate::of(vec![(0.0, 2.0 / (PI * impedance))]);
        let modes = plate.short_waves(cutoff);
        for frequency in [1e3, 5e4, 9e4, 1e5, 1.1e5, 3e5, 1e7] {
            let exact = (1.0 - 1.0 / (1.0 + (frequency / cutoff).powi(16))) / impedance;
            // Rounding of eight terms, each of the size of the largest.
            assert!((mobility(&modes, frequency) - exact).abs() < 1e-14 / impedance * (frequency / cutoff).max(1.0));
        }
    }

    /// A decreasing density is approximated within its change over a band, is nowhere negative, and vanishes where g is
    /// one.
    #[test]
    fn bands_follow_a_density() {
        let falling = |frequency: f64| 1e-3 / (1.0 + (frequency / 4e5).powi(2));
        let mut density: Vec<(f64, f64)> =
            (0..400).map(|i| (1e4 * f64::from(i), falling(1e4 * f64::from(i)))).collect();
        density.push((4.1e6, 0.0));
        let plate = InfinitePlate::of(density);
        let modes = plate.short_waves(1e5);
        for frequency in [1.5e5, 2e5, 4e5, 8e5, 1.6e6] {
            let exact = FRAC_PI_2 * falling(frequency);
            let band = FRAC_PI_2 * (falling(frequency / BAND) - falling(frequency * BAND));
            assert!((mobility(&modes, frequency) - exact).abs() < band, "{frequency:e}");
        }
        for frequency in [1e3, 1e4, 5e4, 9e4, 2e6, 1e7] {
            assert!(mobility(&modes, frequency) > -1e-14, "{frequency:e}");
        }
        assert!(mobility(&modes, 4e4).abs() < 1e-6 * FRAC_PI_2 * 1e-3);
    }

    /// A body defined by its modes: ω² and φ.
    fn body(modes: &[(f64, f64)], infinite_plate: InfinitePlate) -> Projection {
        let (count, none) = (modes.len(), DVector::zeros(modes.len()));
        Projection {
            terms: BodyTerms {
                elastic: DMatrix::from_diagonal(&DVector::from_fn(count, |i, _| modes[i].0)),
                relaxations: Vec::new(),
                support: None,
                damping: None,
                load: none.clone(),
                support_load: none.clone(),
                support_offset: 0.0,
                contact: ContactPort {
                    force: DVector::from_fn(count, |i, _| modes[i].1),
                    compliance: 0.0,
                    footprint: crate::contact::Footprint::Point,
                },
                translation: none,
                readings: StressReadings::default(),
                infinite_plate: Some(infinite_plate),
                multiplicity: 1.0,
            },
            rate: 0.0,
            mode_acceleration: None,
            foundation: None,
        }
    }

    /// Displacement of the surface at some times, m/N, under a force sin²(πt/T) of duration T.
    fn moved(modes: &[Mode], period: f64, times: &[f64]) -> Vec<f64> {
        // sin² = (1 − cos 2πt/T)/2: each part is an exponential with a rate μ.
        let rates = [0.0, TAU / period, -TAU / period].map(|rate| Complex::new(0.0, rate));
        let parts = [0.5, -0.25, -0.25];
        let at = |time: f64| {
            let until = time.min(period);
            let of = |mode: &Mode| {
                let driven = |(rate, part): (&Complex<f64>, f64)| {
                    ((rate * until).exp() - (mode.rate * until).exp()) / (rate - mode.rate) * part
                };
                let z: Complex<f64> = rates.iter().zip(parts).map(driven).sum();
                (mode.output * mode.input * z * (mode.rate * (time - until)).exp()).re
            };
            modes.iter().map(of).sum::<f64>()
        };
        times.iter().map(|time| at(*time)).collect()
    }

    /// A vibration with the given ω² and φ.
    fn vibration((square, reach): &(f64, f64)) -> Mode {
        let frequency = square.sqrt();
        Mode {
            rate: Complex::new(0.0, frequency),
            input: Complex::new(*reach, 0.0),
            load: Complex::new(0.0, 0.0),
            output: Complex::new(0.0, -reach / frequency),
        }
    }

    /// Centre of a simply supported plate, by Navier's modes, under a short pulse. With the short waves of the infinite
    /// plate, 400 modes move like thirty times as many. Without the short waves, they do not.
    #[test]
    fn a_plate_of_few_modes_moves_as_one_of_many() {
        let (edges, mass, slowness): ([f64; 2], f64, f64) = ([1.0, 1.5], 20.0, 0.08);
        let mut all = Vec::new();
        for (m, n) in (1..600).step_by(2).flat_map(|m| (1..900).step_by(2).map(move |n| (m, n))) {
            let wave = (PI * f64::from(m) / edges[0]).powi(2) + (PI * f64::from(n) / edges[1]).powi(2);
            all.push(((wave / slowness).powi(2), (4.0 / (mass * edges[0] * edges[1])).sqrt()));
        }
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let few = &all[..400];
        let plate = InfinitePlate {
            density: vec![(0.0, slowness / (4.0 * PI * mass))],
            fast_wave_compliances: Vec::new(),
            // A quarter of the modes moves the centre. The weight of the 400th mode is negligible.
            modes: ModeCount::of_thin_plate(edges[0] * edges[1] / (16.0 * PI) * 1.6 / VECTORS_PER_MODE, slowness),
            impedance: 8.0 * mass / slowness,
            distance_to_edge: 0.5,
            vectors_per_mode: VECTORS_PER_MODE,
        };
        let closed = Closed { tangent: 1.0, compliance: 0.0, mass: 1e9, accuracy: 1e-3, end: 1.0 };
        let period = 5e-5;
        let times: Vec<f64> = (1..200).map(|i| 1e-5 * f64::from(i)).collect();
        let exact = moved(&all[..12_000].iter().map(vibration).collect::<Vec<_>>(), period, &times);
        let most = exact.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let off = |found: &[f64]| {
            exact.iter().zip(found).map(|(exact, found)| (exact - found).abs()).fold(0.0, f64::max) / most
        };
        let open = Spectrum::new(&body(few, plate.clone()));
        let open = open.modes(open.count(1e9, &closed), closed.accuracy, closed.end).expect("modes without dampers");
        let apart = off(&moved(&open.modes, period, &times));
        let cut = few.iter().filter(|(square, _)| square.sqrt() < plate.cutoff(few.len())).count();
        let alone = off(&moved(&few[..cut].iter().map(vibration).collect::<Vec<_>>(), period, &times));
        println!("{cut} modes: {apart:.1e} with short waves, {alone:.1e} without");
        assert!(apart < 0.02 && alone > 3.0 * apart, "{apart} {alone}");
        // The energy of the short waves is not part of the modal energy.
        assert!(open.forms.is_open && open.modes.len() > open.forms.squares.len());
    }
}
