//! Bending waves of a plate of several layers, tabulated over the wavenumber.
//!
//! Plies on a soft interlayer bend together in long waves and separately in short ones, so that the bending stiffness
//! depends on the wavenumber. An edge reflects a wave as it would in the Mindlin plate whose wave of this wavenumber has
//! the same frequency. The other waves of the layers, such as the sliding of plies on each other, are neglected there.
//!
//! A free vibration y exp(λt) of viscoelastic layers decays. With the frequency ω and the shape y (yᵀMy = 1) for the storage
//! moduli G′(ω), and the stiffness H of a part for a unit shear modulus, λ² = −ω² − i G″(ω) yᵀHy up to terms of the second
//! order in the loss.

use std::rc::Rc;

use nalgebra::{Complex, DMatrix, DVector, DVectorView, RowDVector, SymmetricEigen};

use super::BendingWaves;
use crate::material::Maxwell;

/// Largest number of iterations for the frequency at which the moduli of a vibration are taken, and the relative change
/// at which they end.
const MAX_ROUNDS: usize = 10;
const CHANGE: f64 = 1e-7;

/// Largest m ω²/(S ξ²) of a wave. In the equivalent Mindlin plate, waves are slower than the shear waves of the plies.
const FASTEST: f64 = 0.9;

/// Eigenvalues below this fraction of the largest one are rounding errors. If the eigenvalues
/// are 1/ω², these waves are left out; if they are ω², their frequency is 0.
const ROUNDING: f64 = 1e-14;

/// Number of entries of the table between which a cubic interpolates.
const ENTRIES: usize = 4;

/// Matrices of all waves of a stack of layers with one wavenumber, per unit of area. Their amplitudes have any units.
#[derive(Debug, Clone, PartialEq)]
pub struct LaminateWave {
    /// Mass matrix M.
    pub mass: DMatrix<f64>,
    /// Stiffness K after all relaxation.
    pub stiffness: DMatrix<f64>,
    /// Stiffness H of each viscoelastic part for a unit shear modulus.
    pub distortions: Vec<DMatrix<f64>>,
    /// Linear form that reads the displacement under the impactor, m.
    pub reading: RowDVector<f64>,
}

/// Wavenumbers in equal ratios.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wavenumbers {
    /// First wavenumber, 1/m.
    pub first: f64,
    /// Ratio of successive wavenumbers.
    pub ratio: f64,
}

impl Wavenumbers {
    /// Returns the wavenumber with a number, counted from zero, 1/m.
    pub fn at(self, number: usize) -> f64 {
        self.first * self.ratio.powi(number as i32)
    }

    /// Returns the number of a wavenumber (1/m) as a real number.
    fn number(self, wavenumber: f64) -> f64 {
        (wavenumber / self.first).ln() / self.ratio.ln()
    }
}

/// Bending waves of a plate of several layers.
#[derive(Debug, Clone, PartialEq)]
pub struct LayeredWaves {
    /// Matrices of the waves of each wavenumber.
    waves: Rc<[LaminateWave]>,
    wavenumbers: Wavenumbers,
    /// The plies as unbonded plates that deflect together. Their bending stiffness is not used.
    plies: BendingWaves,
    /// Prony series of the viscoelastic parts.
    chains: Vec<Maxwell>,
    /// G∞ (Pa) of each viscoelastic part that the stiffness contains.
    equilibria: Vec<f64>,
    /// Logarithms of the frequencies ω (rad/s) of the first waves, with the moduli of one rate.
    frequencies: Vec<f64>,
    /// λ/ω of the free vibrations.
    vibrations: Vec<Complex<f64>>,
    /// Squares of the displacements under the impactor for a unit amplitude, m²/kg.
    squared_displacements: Vec<f64>,
}

impl LayeredWaves {
    /// Tabulates the slowest of the waves of each wavenumber. `chains` are the Prony series of the viscoelastic parts. Frequencies
    /// have their moduli at `rate` (1/s). `plies` has the mass, the shear stiffness and the rotary inertia of the plies.
    ///
    /// The table ends before the first wavenumber at which the slowest wave is not the one that the impactor excites most, is
    /// no faster than at the wavenumber before, or is nearly as fast as the shear waves of the plies. `None` if it has too few entries.
    pub fn new(
        waves: Vec<LaminateWave>,
        wavenumbers: Wavenumbers,
        plies: BendingWaves,
        chains: &[&Maxwell],
        rate: f64,
    ) -> Option<Self> {
        let table = Self {
            waves: waves.into(),
            wavenumbers,
            plies,
            chains: chains.iter().map(|chain| (*chain).clone()).collect(),
            equilibria: chains.iter().map(|chain| chain.equilibrium).collect(),
            frequencies: Vec::new(),
            vibrations: Vec::new(),
            squared_displacements: Vec::new(),
        };
        table.at_rate(rate)
    }

    /// Returns the waves with other Prony series, in the same order, and with the moduli at `rate` (1/s).
    pub fn with_chains(&self, chains: &[&Maxwell], rate: f64) -> Option<Self> {
        let chains = chains.iter().map(|chain| (*chain).clone()).collect();
        Self { chains, ..self.clone() }.at_rate(rate)
    }

    /// Returns the waves with the moduli at another rate (1/s). `None` as for [`Self::new`].
    pub fn at_rate(&self, rate: f64) -> Option<Self> {
        let beyond = |modulus: &dyn Fn(&Maxwell) -> f64| -> Vec<f64> {
            self.chains.iter().zip(&self.equilibria).map(|(chain, known)| modulus(chain) - known).collect()
        };
        let relaxes = self.chains.iter().any(|chain| !chain.terms.is_empty());
        let at_rate = beyond(&|chain| chain.transformed(rate));
        let mut entries: Vec<Bending> = Vec::new();
        for (number, wave) in self.waves.iter().enumerate() {
            let Some(bending) = wave.bending(&at_rate) else { break };
            let square = self.wavenumbers.at(number).powi(2);
            let is_slow = self.plies.mass * bending.frequency.powi(2) <= FASTEST * self.plies.shear * square;
            let is_faster = entries.last().is_none_or(|before| bending.frequency > before.frequency);
            if !(bending.is_most_excited && is_slow && is_faster) {
                break;
            }
            entries.push(bending);
        }
        if entries.len() < ENTRIES {
            return None;
        }
        let vibration = |(wave, at_rate): (&LaminateWave, &Bending)| {
            let (mut frequency, mut lost) = (at_rate.frequency, 0.0);
            for _ in 0..if relaxes { MAX_ROUNDS } else { 0 } {
                let before = frequency;
                let Some(found) = wave.bending(&beyond(&|chain| chain.storage(before))) else { break };
                let losses = self.chains.iter().map(|chain| chain.loss(before));
                lost = losses.zip(&found.strains).map(|(loss, strain)| loss * strain).sum();
                frequency = found.frequency;
                if (frequency / before - 1.0).abs() < CHANGE {
                    break;
                }
            }
            let root = Complex::new(frequency * frequency, lost).sqrt();
            Complex::new(-root.im, root.re) / at_rate.frequency
        };
        Some(Self {
            frequencies: entries.iter().map(|wave| wave.frequency.ln()).collect(),
            vibrations: self.waves.iter().zip(&entries).map(vibration).collect(),
            squared_displacements: entries.iter().map(|wave| wave.squared_displacement).collect(),
            ..self.clone()
        })
    }

    /// Returns the frequency up to which the table reaches and the plies have no other waves, rad/s.
    pub fn largest(&self) -> f64 {
        self.plies.thickness_shear().min(self.frequencies[self.frequencies.len() - 1].exp())
    }

    /// Returns the Mindlin plate whose bending wave of a wavenumber (1/m) has the same frequency.
    pub fn equivalent_mindlin(&self, wavenumber: f64) -> BendingWaves {
        self.plies.with_frequency(wavenumber, self.frequency(wavenumber))
    }

    /// Returns the frequency of the wave with a wavenumber (1/m) and the moduli at the rate of the table, rad/s.
    pub fn frequency(&self, wavenumber: f64) -> f64 {
        let (start, weights) = self.interpolation(wavenumber);
        weights.iter().zip(&self.frequencies[start..]).map(|(weight, value)| weight * value).sum::<f64>().exp()
    }

    /// Returns the eigenvalue λ of the free vibration with a wavenumber (1/m), 1/s.
    pub fn eigenvalue(&self, wavenumber: f64) -> Complex<f64> {
        let (start, weights) = self.interpolation(wavenumber);
        let ratio: Complex<f64> =
            weights.iter().zip(&self.vibrations[start..]).map(|(weight, value)| value * *weight).sum();
        Complex::new(ratio.re.min(0.0), ratio.im) * self.frequency(wavenumber)
    }

    /// Returns the square of the displacement under the impactor for a unit amplitude of a wave, m²/kg.
    pub fn squared_displacement(&self, wavenumber: f64) -> f64 {
        let (start, weights) = self.interpolation(wavenumber);
        weights
            .iter()
            .zip(&self.squared_displacements[start..])
            .map(|(weight, value)| weight * value)
            .sum::<f64>()
            .max(0.0)
    }

    /// Returns the first of four entries of the table, and the weights with which they interpolate at a wavenumber (1/m):
    /// cubic between the entries, linear beyond them.
    fn interpolation(&self, wavenumber: f64) -> (usize, [f64; ENTRIES]) {
        let at = self.wavenumbers.number(wavenumber);
        let start = (at - 1.0).floor().clamp(0.0, (self.frequencies.len() - ENTRIES) as f64);
        let x = at - start;
        let weights = match x {
            _ if x < 0.0 => [1.0 - x, x, 0.0, 0.0],
            _ if x > 3.0 => [0.0, 0.0, 3.0 - x, x - 2.0],
            _ => [
                -(x - 1.0) * (x - 2.0) * (x - 3.0) / 6.0,
                x * (x - 2.0) * (x - 3.0) / 2.0,
                -x * (x - 1.0) * (x - 3.0) / 2.0,
                x * (x - 1.0) * (x - 2.0) / 6.0,
            ],
        };
        (start as usize, weights)
    }
}

/// Bending wave of one wavenumber for given moduli.
struct Bending {
    /// Frequency, rad/s.
    frequency: f64,
    /// Square of the displacement under the impactor for a unit amplitude, m²/kg.
    squared_displacement: f64,
    /// Whether no other wave of the wavenumber has a larger squared displacement.
    is_most_excited: bool,
    /// yᵀHy of each viscoelastic part, 1/(Pa s²).
    strains: Vec<f64>,
}

/// One of the waves of a wavenumber.
#[derive(Debug, Clone, PartialEq)]
pub struct LaminateMode {
    /// Frequency, rad/s.
    pub frequency: f64,
    /// Square of the displacement under the impactor for a unit amplitude, m²/kg.
    pub squared_displacement: f64,
    /// Amplitudes y with yᵀMy = 1.
    shape: DVector<f64>,
}

impl LaminateWave {
    /// The waves with moduli (Pa) beyond those of the stiffness, the slowest first. If the stiffness K is
    /// positive definite, waves with more than 10⁷ times the lowest frequency are left out. Otherwise waves with less than 10⁻⁷
    /// of the highest frequency have the frequency 0.
    ///
    /// With K = L Lᵀ and y = L⁻ᵀ x, the matrix L⁻¹ M L⁻ᵀ has the eigenvalues 1/ω². Its largest ones belong to the slowest waves, which are therefore
    /// accurate also beside the shear waves of a layer of some µm, 10⁸ times as fast. If K is numerically singular, M is factorised.
    ///
    /// # Panics
    /// If the mass is not positive definite where the stiffness is not.
    pub fn modes(&self, moduli: &[f64]) -> Vec<LaminateMode> {
        let parts = moduli.iter().zip(&self.distortions);
        let stiffness = parts.fold(self.stiffness.clone(), |sum, (modulus, part)| sum + part * *modulus);
        let (is_stiffness_factorised, factor, other) = match stiffness.clone().cholesky() {
            Some(factor) => (true, factor, &self.mass),
            None => (false, self.mass.clone().cholesky().expect("all layers have mass"), &stiffness),
        };
        let lower = factor.unpack();
        let reduced = |rows: &DMatrix<f64>| lower.solve_lower_triangular(rows).expect("a factor has no zeros");
        let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(reduced(&reduced(other).transpose()));
        let shapes = lower.tr_solve_lower_triangular(&eigenvectors).expect("a factor has no zeros");
        let least = ROUNDING * eigenvalues.amax();
        let mode = |(&value, shape): (&f64, DVectorView<f64>)| {
            let (frequency, shape) = match is_stiffness_factorised {
                true if value <= least => return None,
                true => (value.sqrt().recip(), shape / value.sqrt()),
                false if value <= least => (0.0, shape.into_owned()),
                false => (value.sqrt(), shape.into_owned()),
            };
            Some(LaminateMode { frequency, squared_displacement: (&self.reading * &shape)[0].powi(2), shape })
        };
        let mut modes: Vec<LaminateMode> = eigenvalues.iter().zip(shapes.column_iter()).filter_map(mode).collect();
        modes.sort_by(|one, other| one.frequency.total_cmp(&other.frequency));
        modes
    }

    /// The slowest wave, with moduli (Pa) beyond those of the stiffness; `None` if the stiffness does not resist it.
    fn bending(&self, moduli: &[f64]) -> Option<Bending> {
        let modes = self.modes(moduli);
        let LaminateMode { frequency, squared_displacement, shape } =
            modes.first().filter(|slowest| slowest.frequency > 0.0)?;
        Some(Bending {
            frequency: *frequency,
            squared_displacement: *squared_displacement,
            is_most_excited: modes.iter().all(|mode| mode.squared_displacement <= *squared_displacement),
            strains: self.distortions.iter().map(|part| shape.dot(&(part * shape))).collect(),
        })
    }
}

#[cfg(test)]
pub(super) mod tests {
    use nalgebra::dmatrix;

    use super::*;
    use crate::material::Term;

    const FROM_ONE: Wavenumbers = Wavenumbers { first: 1.0, ratio: 1.05 };

    /// Waves of Mindlin's plate with the deflection and the rotation as amplitudes.
    pub fn of_mindlin(waves: BendingWaves, wavenumber: f64) -> LaminateWave {
        let BendingWaves { mass, rigidity, shear, rotary, .. } = waves;
        let coupled = shear * wavenumber;
        let square = wavenumber * wavenumber;
        LaminateWave {
            mass: dmatrix![mass, 0.0; 0.0, rotary],
            stiffness: dmatrix![shear * square, coupled; coupled, rigidity * square + shear],
            distortions: Vec::new(),
            reading: RowDVector::from_row_slice(&[1.0, 0.0]),
        }
    }

    /// Between and beyond the entries of the table, the waves are those of the plate that it was made from: to 2e-6 in the
    /// range of the table, whose cubics have errors of the order of 0.1 (ln 1.05)⁴, and to 1e-3 for longer waves, whose frequency is not exactly a power of the wavenumber.
    #[test]
    fn a_table_has_the_waves_of_its_plate() {
        let waves = BendingWaves { mass: 20.0, rigidity: 3150.0, shear: 2e8, rotary: 1e-4, poisson: 0.23 };
        let all = (0..140).map(|i| of_mindlin(waves, FROM_ONE.at(i))).collect();
        let table = LayeredWaves::new(all, FROM_ONE, waves, &[], 1e4).expect("bending waves");
        // w² over yᵀMy, from the equation of w with θ = t w.
        let of_deflection = |wavenumber: f64| {
            let BendingWaves { mass, shear, rotary, .. } = waves;
            let turned = (mass * waves.frequency(wavenumber).powi(2) / shear - wavenumber * wavenumber) / wavenumber;
            1.0 / (mass + rotary * turned * turned)
        };
        for (wavenumber, tolerance) in [(0.3, 1e-3), (1.01, 2e-6), (7.7, 2e-6), (63.0, 2e-6), (400.0, 2e-6)] {
            let off = |found: f64, exact: f64| (found / exact - 1.0).abs();
            assert!(off(table.frequency(wavenumber), waves.frequency(wavenumber)) < tolerance, "{wavenumber}");
            assert_eq!(table.eigenvalue(wavenumber).re, 0.0);
            assert!(off(table.squared_displacement(wavenumber), of_deflection(wavenumber)) < tolerance, "{wavenumber}");
            let near = table.equivalent_mindlin(wavenumber);
            assert!(off(near.frequency(wavenumber), table.frequency(wavenumber)) < 1e-9, "{wavenumber}");
            // The frequency depends little on the bending stiffness where shear dominates.
            let share = waves.frequency(wavenumber) / (waves.rigidity / waves.mass).sqrt() / wavenumber.powi(2);
            assert!(off(near.rigidity, waves.rigidity) < 3.0 * tolerance / share.powi(2), "{wavenumber}: {near:?}");
        }
    }

    /// The rate of one amplitude is a root of λ² + k + g(λ) d up to the second order in the loss: with half of the modulus
    /// that relaxes, the error is a quarter. With another series, it is the rate of this series.
    #[test]
    fn a_lossy_wave_decays() {
        let wave = |wavenumber: f64| LaminateWave {
            mass: dmatrix![1.0],
            stiffness: dmatrix![wavenumber.powi(4)],
            distortions: vec![dmatrix![0.3 * wavenumber.powi(4)]],
            reading: RowDVector::from_row_slice(&[1.0]),
        };
        let plies = BendingWaves { mass: 1.0, rigidity: 1.0, shear: 1e9, rotary: 1e-9, poisson: 0.2 };
        let chain = |modulus: f64| Maxwell {
            equilibrium: 0.5,
            terms: vec![Term { modulus, time: 0.1 }, Term { modulus: 0.5 * modulus, time: 1.0 }],
        };
        let known = chain(0.0);
        let all = (0..20).map(|i| wave(FROM_ONE.at(i))).collect();
        let table = LayeredWaves::new(all, FROM_ONE, plies, &[&known], 3.0).expect("waves");
        let wavenumber = FROM_ONE.at(8);
        let [stiffness, distortion] = [1.0, 0.3].map(|factor| factor * wavenumber.powi(4));
        let error = |modulus: f64| {
            let chain = chain(modulus);
            let found = table.with_chains(&[&chain], 3.0).expect("waves").eigenvalue(wavenumber);
            let mut rate = found;
            for _ in 0..20 {
                let [mut value, mut slope] = [rate * rate + stiffness, rate * 2.0];
                for Term { modulus, time } in &chain.terms {
                    let inverse = (rate * *time + 1.0).inv();
                    value += rate * inverse * (modulus * time * distortion);
                    slope += inverse * inverse * (modulus * time * distortion);
                }
                rate -= value / slope;
            }
            assert!(found.re < 0.0 && rate.im > 0.0);
            (found - rate).norm() / rate.norm()
        };
        let order = (error(0.4) / error(0.2)).log2();
        assert!((1.9..2.2).contains(&order) && error(0.4) < 1e-2, "{order} {:e}", error(0.4));
    }

    /// A table ends before waves that become slower with their wavenumber, that are as fast as the shear waves of the plies, or
    /// beside which the impactor excites another wave more. Without four waves before them there is no table.
    #[test]
    fn other_kinds_of_waves_are_left_out() {
        let slow = BendingWaves { mass: 1.0, rigidity: 1.0, shear: 1e9, rotary: 1e-9, poisson: 0.2 };
        // Of the two waves, the second one is faster. Its part of the displacement is `other`.
        let wave = |square: f64, other: f64| LaminateWave {
            mass: DMatrix::identity(2, 2),
            stiffness: dmatrix![square, 0.0; 0.0, 1e6],
            distortions: Vec::new(),
            reading: RowDVector::from_row_slice(&[1.0, other]),
        };
        let reaches = |first_odd: usize, odd: LaminateWave, plies: BendingWaves| {
            let rising = |i: usize| if i < first_odd { wave(FROM_ONE.at(i).powi(4), 0.5) } else { odd.clone() };
            let table = LayeredWaves::new((0..20).map(rising).collect(), FROM_ONE, plies, &[], 1.0);
            table.map(|table| (table.largest() - FROM_ONE.at(first_odd - 1).powi(2)).abs() < 1e-9)
        };
        let odd = || [wave(0.9, 0.5), wave(1e3, 2.0)];
        for odd in odd() {
            assert_eq!(reaches(8, odd, slow), Some(true));
        }
        for odd in odd() {
            assert_eq!(reaches(3, odd, slow), None);
        }
        // ω² = ξ⁴ is 0.9 S ξ² at ξ = √(0.9 S).
        let fast = BendingWaves { shear: FROM_ONE.at(7).powi(2) * 1.02 / FASTEST, ..slow };
        assert_eq!(reaches(8, wave(FROM_ONE.at(8).powi(4), 0.5), fast), Some(true));
    }

    /// A free translation, with a stiffness that is singular, has the frequency 0, and the wave beside it the same as with
    /// a stiffness that is not.
    #[test]
    fn a_free_translation_has_no_frequency() {
        let modes = |stiffness: DMatrix<f64>| {
            let wave = LaminateWave {
                mass: dmatrix![2.0, 0.0; 0.0, 2.0],
                stiffness,
                distortions: Vec::new(),
                reading: RowDVector::from_row_slice(&[1.0, 0.0]),
            };
            wave.modes(&[]).iter().map(|mode| [mode.frequency, mode.squared_displacement]).collect::<Vec<_>>()
        };
        // The amplitudes (1, 1)/2 and (1, −1)/2 have unit modal mass. The frequencies are 0 and √(6/2), then √(2/2) and √(6/2).
        let near = |found: &[[f64; 2]], exact: [[f64; 2]; 2]| {
            found.iter().flatten().zip(exact.as_flattened()).all(|(found, exact)| (found - exact).abs() < 1e-7)
        };
        let free = modes(dmatrix![3.0, -3.0; -3.0, 3.0]);
        assert!(near(&free, [[0.0, 0.25], [3.0_f64.sqrt(), 0.25]]), "{free:?}");
        assert_eq!(free[0][0], 0.0);
        let held = modes(dmatrix![4.0, -2.0; -2.0, 4.0]);
        assert!(near(&held, [[1.0, 0.25], [3.0_f64.sqrt(), 0.25]]), "{held:?}");
    }

    /// The slowest wave is accurate beside waves that are 10⁷ times as fast. With the inverse of the mass, rounding would be 1e-16 of the
    /// larger ω².
    #[test]
    fn a_wave_beside_a_very_fast_one_is_accurate() {
        let waves = BendingWaves { mass: 20.0, rigidity: 3150.0, shear: 2e8, rotary: 1e-10, poisson: 0.23 };
        let [exact, fast] = waves.frequencies(4.0);
        assert!(fast > 5e6 * exact);
        let mut of_two = of_mindlin(waves, 4.0);
        // A third amplitude, of a layer of 1 µm.
        of_two.mass = of_two.mass.insert_column(2, 0.0).insert_row(2, 0.0);
        of_two.stiffness = of_two.stiffness.insert_column(2, 0.0).insert_row(2, 0.0);
        of_two.reading = of_two.reading.insert_column(2, 1e-9);
        (of_two.mass[(2, 2)], of_two.stiffness[(2, 2)]) = (1e-16, 1e3);
        let found = of_two.bending(&[]).expect("a wave");
        assert!((found.frequency / exact - 1.0).abs() < 1e-9, "{} {exact}", found.frequency);
        assert!(found.is_most_excited);
    }
}
