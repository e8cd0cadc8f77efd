//! The contact law in terms of the approach that the body shows.
//!
//! The approach δ = q − gap − aᵀu holds the body's own local dent c_l F, which Hertz's law contains already. The law's
//! indentation is α = δ + c_l F with F = k0 ⟨α⟩^{3/2}: implicit in δ, with the potential (2/5) k0 α^{5/2} − c_l F²/2. The
//! force rises with δ while (3/2) k0 c_l √α < 1; beyond, the contact would have negative stiffness.

use super::Hertz;

/// Where the law is left for its tangent: at this part of the √α at which the stiffness would turn negative. Steps that end
/// beyond are refused; the line is there for the iterations.
const LIMIT: f64 = 0.99;

/// F = Φ(δ).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// F(α).
    pub hertz: Hertz,
    /// c_l, m/N; 0 for the paper's point. Negative where the law holds a part of the body that the approach does not show.
    pub compliance: f64,
}

impl Law {
    /// The approach (m) beyond which the law is not to be trusted; infinite unless c_l is positive.
    pub fn limit(&self) -> f64 {
        if self.compliance <= 0.0 {
            return f64::INFINITY;
        }
        self.approach(LIMIT * LIMIT * self.hertz.critical_indentation(self.compliance))
    }

    /// δ of an indentation α > 0.
    fn approach(&self, indentation: f64) -> f64 {
        if self.compliance == 0.0 { indentation } else { indentation - self.compliance * self.hertz.force(indentation) }
    }

    /// α at an approach up to the limit; δ itself while the bodies are apart.
    ///
    /// δ = α − c_l k0 α^{3/2} is a cubic in √α, solved by Viète's formula and refined by Newton's method, which undoes
    /// the formula's cancellation at small δ.
    fn indentation_within(&self, approach: f64) -> f64 {
        if approach <= 0.0 || self.compliance == 0.0 {
            return approach;
        }
        let part = self.compliance * self.hertz.stiffness;
        if part < 0.0 {
            return root_of_sum(approach, -part).powi(2);
        }
        let scaled = (part * part * approach).min(4.0 / 27.0);
        // y = c_l k0 √α with y² (1 − y) = scaled.
        let angle = ((1.0 - 13.5 * scaled).acos() - std::f64::consts::TAU) / 3.0;
        // Below, the formula has no digits left, and y² = scaled (1 + y) is known to 1e-4.
        let mut y = if scaled < 1e-8 { scaled.sqrt() } else { 1.0 / 3.0 + 2.0 / 3.0 * angle.cos() };
        for _ in 0..4 {
            y -= (y * y * (1.0 - y) - scaled) / (y * (2.0 - 3.0 * y)).max(f64::MIN_POSITIVE);
        }
        (y / part).powi(2)
    }

    /// F, dF/dδ and α at an approach.
    fn state(&self, approach: f64) -> State {
        let limit = self.limit();
        let within = self.indentation_within(approach.min(limit));
        let (force, slope) = (self.hertz.force(within), self.hertz.tangent(within));
        let tangent = slope / (1.0 - self.compliance * slope);
        // Clamping keeps NaN, for the step to be refused.
        let over = (approach - limit).clamp(0.0, f64::INFINITY);
        State { within, force, tangent, over }
    }

    /// α, m.
    pub fn indentation(&self, approach: f64) -> f64 {
        approach + self.compliance * self.force(approach)
    }

    /// F, N; 0 while the bodies are apart.
    pub fn force(&self, approach: f64) -> f64 {
        let at = self.state(approach);
        at.force + at.tangent * at.over
    }

    /// dF/dδ, N/m.
    pub fn tangent(&self, approach: f64) -> f64 {
        self.state(approach).tangent
    }

    /// ∫ F dδ = (2/5) k0 ⟨α⟩^{5/2} − c_l F²/2, J.
    pub fn potential(&self, approach: f64) -> f64 {
        let at = self.state(approach);
        let within = self.hertz.potential(at.within) - 0.5 * self.compliance * at.force * at.force;
        within + at.over * (at.force + 0.5 * at.tangent * at.over)
    }

    /// The discrete gradient (V(δ1) − V(δ0)) / (δ1 − δ0), N: the mean force over a step that changes the potential V by
    /// just its work (O. Gonzalez, Exact energy and momentum conserving algorithms for general models in nonlinear elasticity,
    /// Comput. Methods Appl. Mech. Eng. 190, 2000). With its derivative in δ1, N/m.
    pub fn gradient(&self, from: f64, to: f64) -> (f64, f64) {
        let (a, b) = (self.state(from), self.state(to));
        let derivative = |mean: f64| {
            let difference = to - from;
            // Differences of nearly the same approaches lose their digits: there the mean force is Φ at the middle.
            let far = difference.abs() > 1e-5 * from.abs().max(to.abs());
            if far { (b.force + b.tangent * b.over - mean) / difference } else { 0.5 * self.tangent(0.5 * (from + to)) }
        };
        let both_within = a.over == 0.0 && b.over == 0.0;
        let mean = match (from > 0.0, to > 0.0) {
            (false, false) => return (0.0 * (from + to).clamp(-1.0, 1.0), 0.0),
            // Divided differences of the polynomials V and δ in √α: no cancellation.
            (true, true) if both_within => {
                let (x, y) = (a.within.sqrt(), b.within.sqrt());
                let c = self.compliance * self.hertz.stiffness;
                let divided = |n: i32| (0..n).map(|i| x.powi(i) * y.powi(n - 1 - i)).sum::<f64>();
                self.hertz.stiffness * (0.4 * divided(5) - 0.5 * c * divided(6)) / (divided(2) - c * divided(3))
            }
            _ => (self.potential(to) - self.potential(from)) / (to - from),
        };
        (mean, derivative(mean))
    }
}

/// x > 0 of x² + part x³ = approach, by Newton's method from above, where the sum is convex: it falls to the root and stays there.
fn root_of_sum(approach: f64, part: f64) -> f64 {
    // x² = approach/(1 + part x) from an x that is too large gives one that is too small, and from that one that is too large.
    let closer = |x: f64| (approach / (1.0 + part * x)).sqrt();
    let mut x = closer(closer(approach.sqrt()));
    loop {
        let next = x - (x * x * (1.0 + part * x) - approach) / (x * (2.0 + 3.0 * part * x));
        if next >= x * (1.0 - 4.0 * f64::EPSILON) || next.is_nan() {
            return next;
        }
        x = next;
    }
}

/// The law at an approach.
struct State {
    /// α at the approach, or at the limit.
    within: f64,
    force: f64,
    tangent: f64,
    /// How far the approach is beyond the limit.
    over: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The paper's impactor on a patch of 25 mm, without one, and on a spring.
    const LAWS: [Law; 3] = [
        Law { hertz: Hertz { stiffness: 1.669e10 }, compliance: 0.6 * 0.9471 / (70e9 * 0.025) },
        Law { hertz: Hertz { stiffness: 1.669e10 }, compliance: 0.0 },
        Law { hertz: Hertz { stiffness: 1.669e10 }, compliance: -3e-10 },
    ];

    #[test]
    fn force_and_indentation_satisfy_the_implicit_law() {
        for law in LAWS {
            for exponent in -40..-6 {
                let approach = 10_f64.powf(0.5 * f64::from(exponent));
                if approach >= law.limit() {
                    continue;
                }
                let indentation = law.indentation(approach);
                let force = law.force(approach);
                // Rounding, amplified by the law's slope near the limit.
                assert!((force / law.hertz.force(indentation) - 1.0).abs() < 1e-10, "{approach:e}");
                assert!((indentation - law.compliance * force - approach).abs() <= 1e-14 * indentation);
            }
            assert_eq!((law.force(-1e-3), law.tangent(-1e-3), law.potential(-1e-3)), (0.0, 0.0, 0.0));
            assert_eq!(law.indentation(-1e-3), -1e-3);
            assert!(law.force(f64::NAN).is_nan());
        }
    }

    /// The force is the slope of the potential and the tangent that of the force, on both sides of the limit.
    #[test]
    fn derivatives_agree_with_differences() {
        for law in LAWS {
            let limit = law.limit().min(1e-3);
            for approach in [1e-6, 3e-5, 0.3 * limit, 0.9 * limit, 1.5 * limit] {
                // (step/δ)² and rounding over step/δ: 1e-8 together.
                let step = 1e-5 * approach;
                let slope =
                    |f: fn(&Law, f64) -> f64| (f(&law, approach + step) - f(&law, approach - step)) / (2.0 * step);
                assert!((slope(Law::potential) / law.force(approach) - 1.0).abs() < 1e-8);
                assert!((slope(Law::force) / law.tangent(approach) - 1.0).abs() < 1e-8);
            }
        }
    }

    /// The mean force times the way is the change of the potential, however small the way; its derivative is that of differences.
    #[test]
    fn the_gradient_does_the_potentials_work() {
        for law in LAWS {
            let limit = law.limit().min(1e-3);
            for (from, to) in
                [(-1e-5, 3e-5), (1e-5, 0.8 * limit), (0.8 * limit, -2e-5), (1e-5, 1.2 * limit), (-1e-5, -2e-5)]
            {
                let (mean, derivative) = law.gradient(from, to);
                let work = law.potential(to) - law.potential(from);
                assert!((mean * (to - from) - work).abs() <= 1e-13 * work.abs().max(1e-300));
                let step = 1e-6 * to.abs();
                let slope = (law.gradient(from, to + step).0 - law.gradient(from, to - step).0) / (2.0 * step);
                // Rounding of the differences: 1e-16/1e-6 of the mean force over the step.
                assert!(
                    (slope - derivative).abs() <= 1e-6 * derivative.abs().max(mean.abs() / to.abs()),
                    "{from:e} {to:e}"
                );
            }
            for part in [1e-3, 1e-6, 1e-9, 1e-12] {
                let (from, to) = (1e-5, 1e-5 * (1.0 + part));
                // The mean of a force with bounded curvature is that at the middle up to part²/24.
                let (mean, _) = law.gradient(from, to);
                assert!((mean / law.force(0.5 * (from + to)) - 1.0).abs() < 0.1 * part * part + 1e-14);
            }
        }
    }

    /// At the limit the tangent is large and positive; a law without c_l has none.
    #[test]
    fn the_limit_is_where_the_stiffness_would_turn_negative() {
        let [law, free, _] = LAWS;
        let indentation = law.indentation(law.limit());
        let slope = law.compliance * law.hertz.tangent(indentation);
        assert!((slope - LIMIT).abs() < 1e-9, "{slope}");
        assert_eq!(free.limit(), f64::INFINITY);
    }
}
