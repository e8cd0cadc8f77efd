//! Decays of any rate as sums of decays of rates that all bodies share.
//!
//! Over times up to T, e^{−λt} is a smooth function of x = ln(1 + λT), also where λ is zero. It is interpolated by Lagrange's polynomials
//! between rates that lie at equal distances in x. So the motions by which some bodies creep, each with rates of its own, become sums of the
//! same few motions, of which only the sizes differ.

/// Distance of two common rates in ln(1 + λT).
const SPACING: f64 = 0.3;

/// Common rates between which one is interpolated.
const NEAR: usize = 6;

/// Common rates below zero, by which slow decays are between others.
const BELOW: usize = 2;

/// Common rates for times up to T.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommonRates {
    /// T, s.
    end: f64,
}

/// A decay as a sum of those of the common rates from a number on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decay {
    /// The number of the first.
    pub first: usize,
    /// Their weights.
    pub weights: [f64; NEAR],
}

impl CommonRates {
    /// Up to a time, s.
    pub fn new(end: f64) -> Self {
        Self { end }
    }

    /// The common rate of a number, 1/s.
    pub fn rate(&self, number: usize) -> f64 {
        (SPACING * (number as f64 - BELOW as f64)).exp_m1() / self.end
    }

    /// e^{−λt} of a rate λ ≥ 0, 1/s.
    pub fn decay(&self, rate: f64) -> Decay {
        let place = (rate * self.end).ln_1p() / SPACING + BELOW as f64;
        let first = (place as usize).saturating_sub(NEAR / 2 - 1);
        let weight = |own: usize| -> f64 {
            let others = (0..NEAR).filter(|other| *other != own);
            others.map(|other| (place - (first + other) as f64) / (own as f64 - other as f64)).product()
        };
        Decay { first, weights: std::array::from_fn(weight) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Decays of all rates are met at all times up to the end, to what the sixth derivative leaves at this distance.
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
