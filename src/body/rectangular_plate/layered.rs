//! Bending waves of a plate of several layers, tabulated over the wavenumber.
//!
//! Plies on a soft interlayer bend together in long waves and separately in short ones, so that the bending stiffness
//! depends on the wavenumber. At an edge, a wave is reflected as by the Mindlin plate in which it has the same
//! frequency. The other waves of the layers, such as the sliding of plies on each other, are neglected there.
//!
//! A wave of viscoelastic layers decays. With the shape y and the frequency ω for the storage moduli G′(ω), its rate λ
//! satisfies λ² = −ω² − i G″(ω) yᵀDy, up to terms of the second order in the loss.

use std::rc::Rc;

use nalgebra::{Complex, DMatrix, RowDVector, SymmetricEigen};

use super::BendingWaves;
use crate::material::Maxwell;

/// Number of iterations for the frequency at which the moduli of a vibration are taken. Moduli change little over the
/// change of the frequency.
const ROUNDS: usize = 6;

/// Wave of a stack of layers with one wavenumber, in coordinates of unit mass.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveOfLayers {
    /// Stiffness after all relaxation, 1/s².
    pub stiffness: DMatrix<f64>,
    /// Stiffness of the viscoelastic parts for a unit shear modulus, 1/(Pa s²).
    pub distortions: Vec<DMatrix<f64>>,
    /// Linear form that reads the displacement under the impactor, 1/√(kg/m²).
    pub reading: RowDVector<f64>,
}

/// Bending waves of a plate of several layers.
#[derive(Debug, Clone, PartialEq)]
pub struct LayeredWaves {
    /// Waves whose wavenumbers grow in equal ratios.
    waves: Rc<[WaveOfLayers]>,
    /// Logarithms of the first wavenumber (1/m) and of the ratio.
    places: [f64; 2],
    /// The plies side by side, without a bond: their mass, shear stiffness and rotary inertia.
    plies: BendingWaves,
    /// G∞ (Pa) of each viscoelastic part that the stiffness contains.
    equilibria: Vec<f64>,
    /// Shift of the basis, 1/s.
    shift: f64,
    /// Logarithms of the frequencies (rad/s) with the moduli at the shift.
    frequencies: Vec<f64>,
    /// Decay rate and frequency of the vibrations, over that frequency.
    vibrations: Vec<Complex<f64>>,
    /// Squares of the displacements under the impactor, m²/kg.
    mobilities: Vec<f64>,
}

impl LayeredWaves {
    /// Tabulates the waves with wavenumbers in equal ratios: `first` (1/m), then times `ratio`. `chains` are the Prony
    /// series of the viscoelastic parts, and `shift` the rate (1/s) at which the basis has their moduli. `plies` has the
    /// mass, the shear stiffness and the rotary inertia of the plies.
    ///
    /// `None` if the wave that the impactor excites most does not become faster with its wavenumber: then it is not the
    /// same kind of wave everywhere.
    pub fn new(
        waves: Vec<WaveOfLayers>,
        [first, ratio]: [f64; 2],
        plies: BendingWaves,
        chains: &[&Maxwell],
        shift: f64,
    ) -> Option<Self> {
        let table = Self {
            waves: waves.into(),
            places: [first.ln(), ratio.ln()],
            plies,
            equilibria: chains.iter().map(|chain| chain.equilibrium).collect(),
            shift,
            frequencies: Vec::new(),
            vibrations: Vec::new(),
            mobilities: Vec::new(),
        };
        table.with_chains(chains)
    }

    /// Returns the waves with other Prony series, in the same order.
    pub fn with_chains(&self, chains: &[&Maxwell]) -> Option<Self> {
        let count = self.waves.len();
        let mut changed = Self {
            frequencies: Vec::with_capacity(count),
            vibrations: Vec::with_capacity(count),
            mobilities: Vec::with_capacity(count),
            ..self.clone()
        };
        for wave in self.waves.iter() {
            let beyond = |modulus: &dyn Fn(&Maxwell) -> f64| -> Vec<f64> {
                chains.iter().zip(&self.equilibria).map(|(chain, known)| modulus(chain) - known).collect()
            };
            let at_shift = wave.bending(&beyond(&|chain| chain.transformed(self.shift)));
            let (mut frequency, mut lost) = (at_shift.frequency, 0.0);
            if chains.iter().any(|chain| !chain.terms.is_empty()) {
                for _ in 0..ROUNDS {
                    let vibration = wave.bending(&beyond(&|chain| chain.storage(frequency)));
                    let losses = chains.iter().map(|chain| chain.loss(frequency));
                    lost = losses.zip(&vibration.stretches).map(|(loss, stretch)| loss * stretch).sum();
                    frequency = vibration.frequency;
                }
            }
            let root = Complex::new(frequency * frequency, lost).sqrt();
            changed.frequencies.push(at_shift.frequency.ln());
            changed.vibrations.push(Complex::new(-root.im, root.re) / at_shift.frequency);
            changed.mobilities.push(at_shift.mobility);
        }
        let is_ascending = changed.frequencies.windows(2).all(|pair| pair[1] > pair[0]);
        (is_ascending && changed.frequencies.iter().all(|of| of.is_finite())).then_some(changed)
    }

    /// The plies side by side: their mass, shear stiffness and rotary inertia.
    pub fn plies(&self) -> &BendingWaves {
        &self.plies
    }

    /// Returns the Mindlin plate whose bending wave of a wavenumber (1/m) has the same frequency.
    pub fn near(&self, wavenumber: f64) -> BendingWaves {
        self.plies.tuned(wavenumber, self.frequency(wavenumber))
    }

    /// Returns the frequency of the wave with a wavenumber (1/m) and the moduli at the shift, rad/s.
    pub fn frequency(&self, wavenumber: f64) -> f64 {
        let (place, weights) = self.place(wavenumber);
        weights.iter().zip(&self.frequencies[place..]).map(|(weight, value)| weight * value).sum::<f64>().exp()
    }

    /// Returns the rate of the free vibration with a wavenumber (1/m), 1/s.
    pub fn rate(&self, wavenumber: f64) -> Complex<f64> {
        let (place, weights) = self.place(wavenumber);
        let ratio: Complex<f64> =
            weights.iter().zip(&self.vibrations[place..]).map(|(weight, value)| value * *weight).sum();
        ratio * self.frequency(wavenumber)
    }

    /// Returns the square of the displacement under the impactor for a unit amplitude of a wave, m²/kg.
    pub fn mobility(&self, wavenumber: f64) -> f64 {
        let (place, weights) = self.place(wavenumber);
        weights.iter().zip(&self.mobilities[place..]).map(|(weight, value)| weight * value).sum::<f64>().max(0.0)
    }

    /// Returns the first of four entries of the table, and the weights with which they interpolate at a wavenumber (1/m):
    /// cubic between the entries, linear beyond them.
    fn place(&self, wavenumber: f64) -> (usize, [f64; 4]) {
        let [first, ratio] = self.places;
        let at = (wavenumber.ln() - first) / ratio;
        let last = self.waves.len() - 4;
        let start = (at - 1.0).floor().clamp(0.0, last as f64);
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
    /// Square of the displacement under the impactor, m²/kg.
    mobility: f64,
    /// yᵀDy of each viscoelastic part, 1/(Pa s²).
    stretches: Vec<f64>,
}

impl WaveOfLayers {
    /// The wave that the impactor excites most, with moduli (Pa) beyond those of the stiffness.
    fn bending(&self, moduli: &[f64]) -> Bending {
        let parts = moduli.iter().zip(&self.distortions);
        let stiffness = parts.fold(self.stiffness.clone(), |sum, (modulus, part)| sum + part * *modulus);
        let SymmetricEigen { eigenvalues, eigenvectors } = SymmetricEigen::new(stiffness);
        let read = &self.reading * &eigenvectors;
        let squares = read.component_mul(&read);
        let most = squares.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(at, _)| at);
        let shape = eigenvectors.column(most);
        Bending {
            frequency: eigenvalues[most].max(0.0).sqrt(),
            mobility: squares[most],
            stretches: self.distortions.iter().map(|part| shape.dot(&(part * shape))).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::dmatrix;

    use super::*;
    use crate::material::Term;

    const RATIO: f64 = 1.05;

    /// Waves of Mindlin's plate with the deflection and the rotation as amplitudes.
    fn of_mindlin(waves: BendingWaves, wavenumber: f64) -> WaveOfLayers {
        let BendingWaves { mass, rigidity, shear, rotary, .. } = waves;
        let coupled = shear * wavenumber / (mass * rotary).sqrt();
        let square = wavenumber * wavenumber;
        WaveOfLayers {
            stiffness: dmatrix![shear * square / mass, coupled; coupled, (rigidity * square + shear) / rotary],
            distortions: Vec::new(),
            reading: RowDVector::from_row_slice(&[mass.sqrt().recip(), 0.0]),
        }
    }

    /// Between and beyond the entries of the table, the waves are those of the plate that it was made from: to 2e-6 in the
    /// range of the table, whose cubics have an error of (ln 1.05)⁴, and to 1e-3 for longer waves, which are no powers exactly.
    #[test]
    fn a_table_has_the_waves_of_its_plate() {
        let waves = BendingWaves { mass: 20.0, rigidity: 3150.0, shear: 2e8, rotary: 1e-4, poisson: 0.23 };
        let first = 1.0;
        let all = (0..140).map(|i| of_mindlin(waves, first * RATIO.powi(i))).collect();
        let table = LayeredWaves::new(all, [first, RATIO], waves, &[], 1e4).expect("bending waves");
        for (wavenumber, tolerance) in [(0.3, 1e-3), (1.01, 2e-6), (7.7, 2e-6), (63.0, 2e-6), (400.0, 2e-6)] {
            let off = |found: f64, exact: f64| (found / exact - 1.0).abs();
            assert!(off(table.frequency(wavenumber), waves.frequency(wavenumber)) < tolerance, "{wavenumber}");
            assert_eq!(table.rate(wavenumber).re, 0.0);
            let near = table.near(wavenumber);
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
        let wave = |wavenumber: f64| WaveOfLayers {
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
        let table =
            LayeredWaves::new((0..20).map(|i| wave(RATIO.powi(i))).collect(), [1.0, RATIO], plies, &[&known], 3.0);
        let table = table.expect("waves");
        let wavenumber = RATIO.powi(8);
        let [stiffness, distortion] = [1.0, 0.3].map(|factor| factor * wavenumber.powi(4));
        let error = |modulus: f64| {
            let chain = chain(modulus);
            let found = table.with_chains(&[&chain]).expect("waves").rate(wavenumber);
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

    /// A wave that becomes slower with its wavenumber has no table.
    #[test]
    fn other_kinds_of_waves_are_refused() {
        let wave = |i: i32| WaveOfLayers {
            stiffness: dmatrix![f64::from(30 - i)],
            distortions: Vec::new(),
            reading: RowDVector::from_row_slice(&[1.0]),
        };
        let plies = BendingWaves { mass: 1.0, rigidity: 1.0, shear: 1e9, rotary: 1e-9, poisson: 0.2 };
        assert!(LayeredWaves::new((0..20).map(wave).collect(), [1.0, RATIO], plies, &[], 1.0).is_none());
    }
}
