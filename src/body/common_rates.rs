//! Approximation of exponential decays of any rate by sums of decays with common rates, shared by all bodies.
//!
//! For times up to T, e^{−λt} is a smooth function of x = ln(1 + λT), also at λ = 0. It is interpolated by Lagrange
//! polynomials between rates that are equally spaced in x. The creep motions of several bodies, each with individual
//! rates, thus become sums of the same few motions with different amplitudes.

/// Spacing of the common rates in ln(1 + λT).
const SPACING: f64 = 0.3;

/// Number of common rates that take part in one interpolation.
const RATES_PER_INTERPOLATION: usize = 6;

/// Number of negative common rates. With them, slow decays have interpolation points on both sides.
const NEGATIVE_RATES: usize = 2;

/// Set of common rates for times up to T.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommonRates {
    /// T, s.
    end: f64,
}

/// A decay as a weighted sum of decays with consecutive common rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decay {
    /// Number of the first common rate.
    pub first: usize,
    /// Weights of the common rates, starting with the first.
    pub weights: [f64; RATES_PER_INTERPOLATION],
}

impl CommonRates {
    /// Creates the common rates for times up to `end`, s.
    pub fn new(end: f64) -> Self {
        Self { end }
    }

    /// Returns the common rate with a number, 1/s.
    pub fn rate(&self, number: usize) -> f64 {
        (SPACING * (number as f64 - NEGATIVE_RATES as f64)).exp_m1() / self.end
    }

    /// Returns the weights that approximate e^{−λt} with the rate λ ≥ 0, 1/s.
    pub fn decay(&self, rate: f64) -> Decay {
        let place = (rate * self.end).ln_1p() / SPACING + NEGATIVE_RATES as f64;
        let first = (place as usize).saturating_sub(RATES_PER_INTERPOLATION / 2 - 1);
        let weight = |own: usize| -> f64 {
            let others = (0..RATES_PER_INTERPOLATION).filter(|other| *other != own);
            others.map(|other| (place - (first + other) as f64) / (own as f64 - other as f64)).product()
        };
        Decay { first, weights: std::array::from_fn(weight) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Decays of all rates are approximated at all times up to the end, within the sixth-derivative error at this
    /// spacing.
    #[test]
    fn decays_are_sums_of_common_ones() {
        let common = CommonRates::new(5e-3);
        let mut worst = 0.0_f64;
        for step in 0..400 {
            let rate = if step == 0 { 0.0 } else { 1e-2 * 10.0_f64.powf(0.025 * f64::from(step)) / 5e-3 };
            let Decay { first, weights } = common.decay(rate);
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            for time in (0..=500).map(|i| 1e-5 * f64::from(i)) {
                let all = weights.iter().zip(first..);
                let sum: f64 = all.map(|(weight, number)| weight * (-common.rate(number) * time).exp()).sum();
                worst = worst.max((sum - (-rate * time).exp()).abs());
            }
        }
        assert!(worst < 1e-4 && worst > 1e-6, "{worst:e}");
    }
}
