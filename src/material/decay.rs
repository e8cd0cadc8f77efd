//! One Maxwell term over one time step, exact for a strain that is linear in time over the step.
//!
//! The spring of the term is stretched by w = u − z, and ẇ = u̇ − w/τ. With θ = Δt/τ and E = exp(−θ),
//!
//! w⁺ = E w + φ Δu,   φ = (1 − E)/θ,   Δu = u⁺ − u,
//!
//! so that a step has the stiffness φ G for Δu and the known stress G E w. The dashpot dissipates the energy
//! G (a w² + 2 b w Δu + c Δu²),
//!
//! a = (1 − E²)/2,   b = (1 − E)²/(2θ),   c = (θ − 2(1 − E) + (1 − E²)/2)/θ²,
//!
//! the integral of w²/τ over the step. All factors are computed without cancellation from θ → 0 (a spring) to θ → ∞ (a
//! dashpot).

/// Factors of a Maxwell term for one time step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decay {
    /// Factor E of w over a step without change of the strain.
    pub left: f64,
    /// Lost part 1 − E.
    pub lost: f64,
    /// Factor φ of the strain increment in w at the end of the step.
    pub taken: f64,
    /// Factors a, b and c of the energy dissipated by the dashpot.
    pub dissipated: [f64; 3],
}

/// Value of θ below which c is summed as a series. Above it, at most one digit is lost.
const SERIES: f64 = 0.5;

impl Decay {
    /// Factors for a time step Δt and a relaxation time τ, both positive, s.
    pub fn new(step: f64, time: f64) -> Self {
        let ratio = step / time;
        let lost = -(-ratio).exp_m1();
        // If the ratio is zero (a very long relaxation time) or infinite (a very short one), the limits result.
        let taken = if ratio > 0.0 { lost / ratio } else { 1.0 };
        let square = -0.5 * (-2.0 * ratio).exp_m1();
        let both = 0.5 * lost * taken;
        Self { left: (-ratio).exp(), lost, taken, dissipated: [square, both, self::square_of_strain(ratio, lost)] }
    }

    /// Energy dissipated in a step by a dashpot of unit modulus, from w², w Δu and Δu², with w at the start of the
    /// step.
    pub fn loss(&self, [square, mixed, of_strain]: [f64; 3]) -> f64 {
        let [a, b, c] = self.dissipated;
        a * square + 2.0 * b * mixed + c * of_strain
    }
}

/// Computes c = Σ_{n ≥ 3} (−1)ⁿ (2 − 2ⁿ⁻¹) θⁿ⁻²/n!, which begins with θ/3.
fn square_of_strain(ratio: f64, lost: f64) -> f64 {
    if ratio > SERIES {
        // Each part is finite for any large θ.
        return (1.0 - (2.0 * lost - 0.5 * lost * (2.0 - lost)) / ratio) / ratio;
    }
    let (mut sum, mut power, mut two) = (0.0, ratio / 6.0, 4.0);
    for n in 3..25 {
        let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
        sum += sign * (2.0 - two) * power;
        power *= ratio / f64::from(n + 1);
        two *= 2.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::gauss_legendre;

    /// The step agrees with w(t) from the formula in time, and the energy with the integral of its square.
    #[test]
    fn a_step_is_the_integral_over_it() {
        let rule = gauss_legendre(20);
        for ratio in [1e-6, 0.01, 0.3, 0.49, 0.51, 2.0, 30.0] {
            let decay = Decay::new(ratio, 1.0);
            for (w, du) in [(1.0, 0.0), (0.0, 1.0), (0.7, -1.3)] {
                let rate = du / ratio;
                let at = |t: f64| w * (-t).exp() - rate * (-t).exp_m1();
                let end = decay.left * w + decay.taken * du;
                assert!((end - at(ratio)).abs() < 1e-12 * (w.abs() + du.abs()), "{ratio}");
                // Panels shorter than the relaxation time.
                let panels = (4.0 * ratio).ceil();
                let width = ratio / panels;
                let of_panel = |k: i32| {
                    let middle = (f64::from(k) + 0.5) * width;
                    rule.iter().map(|(x, p)| 0.5 * width * p * at(middle + 0.5 * width * x).powi(2)).sum::<f64>()
                };
                let exact: f64 = (0..panels as i32).map(of_panel).sum();
                let found = decay.loss([w * w, w * du, du * du]);
                // Rounding of some hundred points.
                assert!((found - exact).abs() < 1e-11 * exact.max(1e-3 * ratio), "{ratio} {w} {du}: {found} {exact}");
            }
        }
    }

    /// E, φ and the energies in the limits of a spring and of a dashpot; all factors stay between 0 and 1 for extreme
    /// arguments.
    #[test]
    fn limits() {
        let spring = Decay::new(1e-9, 1.0);
        assert!((spring.taken - (1.0 - 0.5e-9)).abs() < 1e-16 && (spring.lost / 1e-9 - 1.0).abs() < 1e-8);
        assert!((spring.dissipated[2] / (1e-9 / 3.0) - 1.0).abs() < 1e-8);
        let dashpot = Decay::new(1.0, 1e-9);
        assert_eq!((dashpot.left, dashpot.lost), (0.0, 1.0));
        // Dissipated energy of a dashpot, η u̇ Δu = τ/Δt Δu².
        assert!((dashpot.taken / 1e-9 - 1.0).abs() < 1e-15 && (dashpot.dissipated[2] / 1e-9 - 1.0).abs() < 1e-8);
        for (step, time) in [(1e-300, 1e300), (1e300, 1e-300), (1e-5, f64::INFINITY), (f64::MIN_POSITIVE, 1.0)] {
            let Decay { left, lost, taken, dissipated: [a, b, c] } = Decay::new(step, time);
            for factor in [left, lost, taken, a, b, c] {
                assert!((0.0..=1.0).contains(&factor), "{step} {time}: {factor}");
            }
        }
    }

    /// Work is stored or dissipated: ½ w⁺² − ½ w² + loss is the work of the stress, ∫ w du, which for a small step is
    /// (w + w⁺)/2 Δu.
    #[test]
    fn work_is_stored_or_dissipated() {
        for ratio in [1e-4, 0.2, 0.5, 3.0, 50.0] {
            let decay = Decay::new(ratio, 1.0);
            let (w, du) = (0.4, 0.9);
            let end = decay.left * w + decay.taken * du;
            let gone = 0.5 * (end * end - w * w) + decay.loss([w * w, w * du, du * du]);
            // ∫ w dt over the step is w − w⁺ + Δu, since ẇ = u̇ − w.
            let work = du / ratio * (w - end + du);
            assert!((gone - work).abs() < 1e-11 / ratio.min(1.0), "{ratio}: {gone} {work}");
        }
    }
}
