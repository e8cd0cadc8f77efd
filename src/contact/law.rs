//! The contact law in terms of the approach that the body shows, and of its rate.
//!
//! The approach δ = q − gap − aᵀu holds the body's own local dent c_l F, which the law of the contact contains already. Its
//! indentation is α = δ + c_l F with F = Φ(α), by default Hertz's: implicit in δ, with the potential ∫Φ dα − c_l F²/2. The
//! force rises with δ while Φ′ c_l < 1; beyond, the contact would have negative stiffness.
//!
//! Damping multiplies Φ by 1 + d α̇, never below zero (K. H. Hunt & F. R. E. Crossley, Coefficient of restitution interpreted as
//! damping in vibroimpact, J. Appl. Mech. 42, 1975). α̇ is that of the undamped law, δ̇/(1 − c_l Φ′): exact where c_l is 0, and
//! otherwise off by the part of the dent that damping adds, of second order in d.

use super::force_law::zero;
use super::{ForceLaw, Hertz};

/// Where the law is left for its tangent: where Φ′ c_l reaches this. Steps that end beyond are refused; the line is there for the
/// iterations.
const LIMIT: f64 = 0.99;

/// The contact's force in terms of the approach.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// Φ(α).
    pub force_law: ForceLaw,
    /// c_l, m/N; 0 for the paper's point. Negative where the law holds a part of the body that the approach does not show.
    pub compliance: f64,
    /// d, s/m; 0 for none.
    pub damping: f64,
}

/// A damped contact's force at an approach and its rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damped {
    /// F, N.
    pub force: f64,
    /// What it would be at rest, N: the slope of the potential.
    pub elastic: f64,
    /// ∂F/∂δ at a fixed factor 1 + d α̇, N/m: enough for Newton's method.
    pub stiffness: f64,
    /// ∂F/∂δ̇, N s/m.
    pub viscosity: f64,
}

impl Law {
    /// The approach (m) beyond which the law is not to be trusted: it softens, or its table ends. Infinite where it does not.
    pub fn limit(&self) -> f64 {
        let least = self.softening().min(self.force_law.end());
        if least.is_infinite() { least } else { self.approach(least) }
    }

    /// The indentation (m) at which [`LIMIT`] is reached.
    fn softening(&self) -> f64 {
        if self.compliance <= 0.0 {
            return f64::INFINITY;
        }
        self.force_law.indentation_of_tangent(LIMIT / self.compliance)
    }

    /// Whether it is the end of a table that limits the law, and not its stiffness.
    pub fn ends(&self) -> bool {
        self.force_law.end() < self.softening()
    }

    /// δ of an indentation α > 0.
    fn approach(&self, indentation: f64) -> f64 {
        if self.compliance == 0.0 {
            indentation
        } else {
            indentation - self.compliance * self.force_law.force(indentation)
        }
    }

    /// α at an approach up to the limit; δ itself while the bodies are apart.
    fn indentation_within(&self, approach: f64) -> f64 {
        if approach <= 0.0 || self.compliance == 0.0 || approach.is_nan() {
            return approach;
        }
        if let ForceLaw::Hertz(Hertz { stiffness }) = self.force_law {
            return hertz_indentation(approach, self.compliance * stiffness);
        }
        let off = |x: f64| (self.approach(x) - approach, 1.0 - self.compliance * self.force_law.tangent(x));
        let (mut low, mut high) = (0.0, approach);
        if self.compliance > 0.0 {
            (low, high) = (approach, 2.0 * approach);
            while off(high).0 < 0.0 && high < self.softening() {
                high *= 2.0;
            }
            high = high.min(self.softening());
        }
        zero(low, high, off)
    }

    /// F, dF/dδ and α at an approach.
    fn state(&self, approach: f64) -> State {
        let limit = self.limit();
        let within = self.indentation_within(approach.min(limit));
        let (force, slope) = (self.force_law.force(within), self.force_law.tangent(within));
        let growth = 1.0 / (1.0 - self.compliance * slope);
        // Clamping keeps NaN, for the step to be refused.
        let over = (approach - limit).clamp(0.0, f64::INFINITY);
        State { within, force, tangent: slope * growth, growth, over }
    }

    /// α (m) at an approach (m) with its force (N).
    pub fn indentation(&self, approach: f64, force: f64) -> f64 {
        approach + self.compliance * force
    }

    /// F at rest, N; 0 while the bodies are apart.
    pub fn force(&self, approach: f64) -> f64 {
        self.state(approach).extended()
    }

    /// dF/dδ at rest, N/m.
    pub fn tangent(&self, approach: f64) -> f64 {
        self.state(approach).tangent
    }

    /// F at rest and dF/dδ, N and N/m.
    pub fn force_and_tangent(&self, approach: f64) -> (f64, f64) {
        let state = self.state(approach);
        (state.extended(), state.tangent)
    }

    /// The largest tangent at rest up to an indentation (m), N/m: as far as the law holds.
    pub fn steepest(&self, indentation: f64) -> f64 {
        let slope = self.force_law.steepest(indentation);
        let slope = if self.compliance > 0.0 { slope.min(LIMIT / self.compliance) } else { slope };
        slope / (1.0 - self.compliance * slope)
    }

    /// The law without damping whose force is the damped one's at an approach (m) and its rate (m/s).
    pub fn at_rate(&self, approach: f64, rate: f64) -> Self {
        if self.damping == 0.0 {
            return self.clone();
        }
        self.multiplied(self.factor(self.state(approach).growth, rate))
    }

    /// 1 + d α̇, from dα/dδ and δ̇; never below zero, and NaN where the rate is.
    fn factor(&self, growth: f64, rate: f64) -> f64 {
        if self.damping == 0.0 { 1.0 } else { (1.0 + self.damping * growth * rate).clamp(0.0, f64::INFINITY) }
    }

    fn multiplied(&self, factor: f64) -> Self {
        Self { force_law: self.force_law.scaled(factor), compliance: self.compliance, damping: 0.0 }
    }

    /// The force at an approach (m) and its rate (m/s).
    pub fn damped(&self, approach: f64, rate: f64) -> Damped {
        let at = self.state(approach);
        let elastic = at.extended();
        if self.damping == 0.0 || approach <= 0.0 {
            return Damped { force: elastic, elastic, stiffness: at.tangent, viscosity: 0.0 };
        }
        let factor = self.factor(at.growth, rate);
        if factor == 0.0 {
            // Nothing, but for NaN.
            return Damped { force: 0.0 * elastic, elastic, stiffness: 0.0, viscosity: 0.0 };
        }
        let now = self.multiplied(factor).state(approach);
        // δ = α − c f Φ(α) at a fixed δ: d(f Φ)/df = Φ/(1 − c f Φ′).
        let viscosity = now.force / factor * now.growth * self.damping * at.growth;
        Damped { force: now.extended(), elastic, stiffness: now.tangent, viscosity }
    }

    /// ∫ F dδ at rest, J.
    pub fn potential(&self, approach: f64) -> f64 {
        let at = self.state(approach);
        let within = self.force_law.potential(at.within) - 0.5 * self.compliance * at.force * at.force;
        within + at.over * (at.force + 0.5 * at.tangent * at.over)
    }

    /// The discrete gradient (V(δ1) − V(δ0)) / (δ1 − δ0), N: the mean force over a step that changes the potential V by
    /// just its work (O. Gonzalez, Exact energy and momentum conserving algorithms for general models in nonlinear elasticity,
    /// Comput. Methods Appl. Mech. Eng. 190, 2000). With its derivative in δ1, N/m.
    pub fn gradient(&self, from: f64, to: f64) -> (f64, f64) {
        let (a, b) = (self.state(from), self.state(to));
        let difference = to - from;
        // Differences of nearly the same approaches lose their digits: there the mean force is Φ at the middle.
        let far = difference.abs() > 1e-5 * from.abs().max(to.abs());
        let derivative =
            |mean: f64| if far { (b.extended() - mean) / difference } else { 0.5 * self.tangent(0.5 * (from + to)) };
        let both_within = a.over == 0.0 && b.over == 0.0;
        let mean = match (from > 0.0, to > 0.0, &self.force_law) {
            (false, false, _) => return (0.0 * (from + to).clamp(-1.0, 1.0), 0.0),
            // Divided differences of the polynomials V and δ in √α: no cancellation.
            (true, true, ForceLaw::Hertz(Hertz { stiffness })) if both_within => {
                let (x, y) = (a.within.sqrt(), b.within.sqrt());
                let c = self.compliance * stiffness;
                let divided = |n: i32| (0..n).map(|i| x.powi(i) * y.powi(n - 1 - i)).sum::<f64>();
                stiffness * (0.4 * divided(5) - 0.5 * c * divided(6)) / (divided(2) - c * divided(3))
            }
            (true, true, _) if !far => self.force(0.5 * (from + to)),
            _ => (self.potential(to) - self.potential(from)) / difference,
        };
        (mean, derivative(mean))
    }
}

/// α of Hertz's law at δ > 0, with c_l k0 in `part`: δ = α − c_l k0 α^{3/2} is a cubic in √α, solved by Viète's formula and refined by
/// Newton's method, which undoes the formula's cancellation at small δ.
fn hertz_indentation(approach: f64, part: f64) -> f64 {
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
    /// dα/dδ.
    growth: f64,
    /// How far the approach is beyond the limit.
    over: f64,
}

impl State {
    /// F, along the tangent beyond the limit.
    fn extended(&self) -> f64 {
        self.force + self.tangent * self.over
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::contact::{Power, Table};

    /// The paper's impactor on a patch of 25 mm, without one, and on a spring; a power and a table in their places.
    fn laws() -> Vec<Law> {
        let hertz = ForceLaw::Hertz(Hertz { stiffness: 1.669e10 });
        let power = ForceLaw::Power(Power { stiffness: 6e9, exponent: 1.4 });
        let points: Vec<[f64; 2]> = (0..=30).map(|i| 1e-4 * f64::from(i)).map(|x| [x, 2e10 * x * x]).collect();
        let table = ForceLaw::Table(Table::new(&points).unwrap());
        let patch = 0.6 * 0.9471 / (70e9 * 0.025);
        let on =
            |(force_law, compliance): (&ForceLaw, f64)| Law { force_law: force_law.clone(), compliance, damping: 0.0 };
        let kinds = [(&hertz, patch), (&hertz, 0.0), (&hertz, -3e-10), (&power, patch), (&power, -3e-10)];
        kinds.into_iter().chain([(&table, 0.0), (&table, 1e-9), (&table, -3e-10)]).map(on).collect()
    }

    #[test]
    fn force_and_indentation_satisfy_the_implicit_law() {
        for law in laws() {
            for exponent in -40..-6 {
                let approach = 10_f64.powf(0.5 * f64::from(exponent));
                if approach >= law.limit() {
                    continue;
                }
                let force = law.force(approach);
                let indentation = law.indentation(approach, force);
                // Rounding, amplified by the law's slope near the limit.
                assert!((force / law.force_law.force(indentation) - 1.0).abs() < 1e-10, "{approach:e}");
                assert!((indentation - law.compliance * force - approach).abs() <= 1e-14 * indentation);
            }
            assert_eq!((law.force(-1e-3), law.tangent(-1e-3), law.potential(-1e-3)), (0.0, 0.0, 0.0));
            assert_eq!(law.indentation(-1e-3, 0.0), -1e-3);
            assert!(law.force(f64::NAN).is_nan());
        }
    }

    /// The force is the slope of the potential and the tangent that of the force, on both sides of the limit.
    #[test]
    fn derivatives_agree_with_differences() {
        for law in laws() {
            let limit = law.limit().min(1e-3);
            for approach in [1e-6, 3e-5, 0.33 * limit, 0.87 * limit, 1.47 * limit] {
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
        for law in laws() {
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

    /// Damping's force falls to nothing and not below, takes energy whichever way it goes, has the slopes of differences in δ̇, and
    /// is Φ's at a factor of 1 + d α̇ where δ is α.
    #[test]
    fn damping_takes_energy() {
        for law in laws() {
            let law = Law { damping: 0.3, ..law };
            for part in [1e-3, 0.1, 0.6, 0.9] {
                let approach = part * law.limit().min(1e-3);
                for rate in [-20.0, -1.0, -0.1, 0.0, 0.2, 1.0] {
                    let at = law.damped(approach, rate);
                    assert_eq!(at.elastic, law.force(approach));
                    assert!(at.force >= 0.0 && (at.force - at.elastic) * rate >= 0.0);
                    if law.compliance == 0.0 {
                        let factor = (1.0 + 0.3 * rate).max(0.0);
                        assert!((at.force - factor * at.elastic).abs() <= 1e-12 * at.elastic.max(at.force));
                    }
                    let within = approach < 0.9 * law.at_rate(approach, 1.001 * rate).limit();
                    if at.force > 0.0 && rate != 0.0 && within {
                        let step = 1e-5 * rate.abs();
                        let force = |rate| law.damped(approach, rate).force;
                        let slope = (force(rate + step) - force(rate - step)) / (2.0 * step);
                        // Rounding over the step, 1e-10 of the force, and the step's square.
                        assert!((slope / at.viscosity - 1.0).abs() < 1e-6, "{slope} {}", at.viscosity);
                    }
                }
            }
            assert_eq!(law.damped(-1e-3, 1.0).force, 0.0);
            assert!(law.damped(f64::NAN, 1.0).force.is_nan() && law.damped(1e-6, f64::NAN).force.is_nan());
        }
    }

    /// At the limit the tangent is large and positive; a law without c_l has none.
    #[test]
    fn the_limit_is_where_the_stiffness_would_turn_negative() {
        let [law, free, ..] = <[Law; 8]>::try_from(laws()).unwrap();
        let indentation = law.indentation(law.limit(), law.force(law.limit()));
        let slope = law.compliance * law.force_law.tangent(indentation);
        assert!((slope - LIMIT).abs() < 1e-9, "{slope}");
        assert_eq!(free.limit(), f64::INFINITY);
    }
}
