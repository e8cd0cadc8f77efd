//! Generalised Maxwell chain (Prony series).

use std::f64::consts::LN_10;

/// Generalised Maxwell chain with the relaxation modulus G(t) = G∞ + Σ G_i exp(−t/τ_i).
#[derive(Debug, Clone, PartialEq)]
pub struct Maxwell {
    /// Equilibrium modulus G∞, Pa: the modulus after all relaxation.
    pub equilibrium: f64,
    /// Maxwell terms, in any order.
    pub terms: Vec<Term>,
}

/// Maxwell term: a spring in series with a dashpot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Term {
    /// Modulus G_i of the spring, Pa.
    pub modulus: f64,
    /// Relaxation time τ_i, s.
    pub time: f64,
}

impl Maxwell {
    /// Instantaneous modulus G(0) = G∞ + Σ G_i, Pa.
    pub fn instantaneous(&self) -> f64 {
        self.equilibrium + self.terms.iter().map(|term| term.modulus).sum::<f64>()
    }

    /// Relaxation modulus G at a time (s) after a step of the strain, Pa.
    pub fn at(&self, time: f64) -> f64 {
        self.equilibrium + self.terms.iter().map(|term| term.modulus * (-time / term.time).exp()).sum::<f64>()
    }

    /// Secant modulus (1/t) ∫₀ᵗ G dt at a time (s), Pa: the ratio of stress to strain for a constant strain rate since
    /// t = 0.
    pub fn secant(&self, time: f64) -> f64 {
        let part = |term: &Term| match time / term.time {
            0.0 => term.modulus,
            x => term.modulus * -(-x).exp_m1() / x,
        };
        self.equilibrium + self.terms.iter().map(part).sum::<f64>()
    }

    /// G̃(s) = G∞ + Σ G_i sτ_i/(1 + sτ_i) for a real s (1/s), Pa: s times the Laplace transform of G.
    pub fn transformed(&self, s: f64) -> f64 {
        self.equilibrium + self.transformed_terms(s)
    }

    /// Contribution of the terms to [`Self::transformed`], Σ G_i sτ_i/(1 + sτ_i), Pa.
    pub fn transformed_terms(&self, s: f64) -> f64 {
        // The form 1/(1 + 1/(sτ)) does not overflow.
        self.terms.iter().map(|term| term.modulus / (1.0 + 1.0 / (s * term.time))).sum()
    }

    /// Storage modulus G′ at the angular frequency ω (1/s), Pa: the stress in phase with the strain.
    pub fn storage(&self, frequency: f64) -> f64 {
        let part = |term: &Term| term.modulus / (1.0 + (frequency * term.time).powi(-2));
        self.equilibrium + self.terms.iter().map(part).sum::<f64>()
    }

    /// Loss modulus G″ at the angular frequency ω (1/s), Pa: the stress a quarter of a period ahead of the strain.
    pub fn loss(&self, frequency: f64) -> f64 {
        let part = |term: &Term| {
            let x = frequency * term.time;
            term.modulus / (x + 1.0 / x)
        };
        self.terms.iter().map(part).sum()
    }

    /// Returns the chain with all times multiplied by a_T, given by its decimal logarithm.
    pub fn shifted(&self, log_factor: f64) -> Self {
        let factor = (LN_10 * log_factor).exp();
        let terms = self.terms.iter().map(|term| Term { time: factor * term.time, ..*term }).collect();
        Self { equilibrium: self.equilibrium, terms }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain() -> Maxwell {
        let terms = [(2.0, 1e-3), (5.0, 0.1), (0.5, 30.0)].map(|(modulus, time)| Term { modulus, time });
        Maxwell { equilibrium: 0.3, terms: terms.to_vec() }
    }

    #[test]
    fn limits_of_the_moduli() {
        let chain = chain();
        assert_eq!((chain.at(0.0), chain.instantaneous()), (7.8, 7.8));
        for of in [Maxwell::transformed, Maxwell::storage] {
            // Deviations of sτ of the last term at small s, and of 1/(sτ) of the first term at large s.
            assert!((of(&chain, 1e-12) - 0.3).abs() < 1e-10 && (of(&chain, 1e12) - 7.8).abs() < 1e-8);
        }
        assert!(chain.loss(1e-12) < 1e-10 && chain.loss(1e12) < 1e-8);
        assert_eq!(chain.at(1e9), 0.3);
    }

    /// G̃(s) = s ∫ G e^{−st} dt, by quadrature in u = st, and G′ + iG″ = G̃(iω).
    #[test]
    fn transforms_are_those_of_the_relaxation() {
        let chain = chain();
        for s in [0.01, 1.0, 70.0, 1e4] {
            // Simpson's rule. The times span five decades, which a logarithmic variable resolves.
            let (from, to, steps) = (-30.0_f64, 4.0_f64, 40_000);
            let width = (to - from) / f64::from(steps);
            let value = |i: i32| {
                let u = (from + f64::from(i) * width).exp();
                chain.at(u / s) * (-u).exp() * u
            };
            let weight = |i: i32| if i == 0 || i == steps { 1.0 } else { [2.0, 4.0][i as usize % 2] };
            let sum: f64 = (0..=steps).map(|i| weight(i) * value(i)).sum::<f64>() * width / 3.0;
            // The part of the integral for u below e^{−30}.
            assert!((sum / chain.transformed(s) - 1.0).abs() < 1e-11, "{s}");
            let mut complex = nalgebra::Complex::new(chain.equilibrium, 0.0);
            for term in &chain.terms {
                let x = nalgebra::Complex::new(0.0, s * term.time);
                complex += x / (x + 1.0) * term.modulus;
            }
            assert!((complex.re / chain.storage(s) - 1.0).abs() < 1e-14);
            assert!((complex.im / chain.loss(s) - 1.0).abs() < 1e-14);
        }
    }

    /// d(t·secant)/dt = G, by central differences.
    #[test]
    fn secant_moduli_are_means_of_the_relaxation() {
        let chain = chain();
        for time in [1e-4, 0.03, 1.0, 50.0] {
            let step = 1e-4 * time;
            let integral = |time: f64| time * chain.secant(time);
            let slope = (integral(time + step) - integral(time - step)) / (2.0 * step);
            // The third derivative of the integral times step²/6 is at most 1e-8 of G here; rounding is below 1e-11.
            assert!((slope / chain.at(time) - 1.0).abs() < 1e-7, "{time}");
        }
        assert_eq!(chain.secant(0.0), chain.instantaneous());
        assert!((chain.secant(1e12) - 0.3).abs() < 1e-9);
    }

    #[test]
    fn a_shift_scales_all_times() {
        let chain = chain();
        let shifted = chain.shifted(2.0);
        for time in [1e-4, 0.3, 20.0] {
            // Rounding of the exponential of ln 100.
            assert!((shifted.at(100.0 * time) / chain.at(time) - 1.0).abs() < 1e-12);
        }
    }
}
