//! The contact law as a function of the approach, which the body's displacement gives, and of its rate.
//!
//! The approach δ = q − gap − aᵀu contains the body's own local indentation c_l F, which the contact law already
//! contains. The indentation is α = δ + c_l F with F = Φ(α), by default Hertz's law. It is implicit in δ, with the
//! potential ∫Φ dα − c_l F²/2. The force increases with δ while Φ′ c_l < 1. Beyond that the contact would have negative
//! stiffness.
//!
//! Damping multiplies Φ by 1 + d α̇, at least zero (K. H. Hunt & F. R. E. Crossley, Coefficient of restitution
//! interpreted as damping in vibroimpact, J. Appl. Mech. 42, 1975). α̇ is the rate of the undamped law,
//! δ̇/(1 − c_l Φ′). It is exact if c_l is 0. Otherwise it neglects the part of the local indentation that damping adds,
//! of second order in d.

use super::force_law::zero;
use super::{ForceLaw, Hertz};

/// Value of Φ′ c_l at which the law is replaced by its tangent. Steps that end beyond are refused; the tangent serves
/// the iterations only.
const LIMIT: f64 = 0.99;

/// Contact force as a function of the approach.
#[derive(Debug, Clone, PartialEq)]
pub struct Law {
    /// Force law Φ(α).
    pub force_law: ForceLaw,
    /// Local compliance c_l, m/N; 0 for the paper's point force. Negative if the law contains a part of the body's
    /// compliance that the approach does not show.
    pub compliance: f64,
    /// Damping d, s/m; 0 for none.
    pub damping: f64,
}

/// Force of a damped contact at an approach and its rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damped {
    /// Contact force F, N.
    pub force: f64,
    /// Force without damping, N: the derivative of the potential.
    pub elastic: f64,
    /// ∂F/∂δ with a fixed factor 1 + d α̇, N/m: accurate enough for Newton's method.
    pub stiffness: f64,
    /// ∂F/∂δ̇, N s/m.
    pub viscosity: f64,
}

impl Law {
    /// Approach (m) beyond which the law is not valid, because it softens or its table ends; infinite if it is always
    /// valid.
    pub fn limit(&self) -> f64 {
        let least = self.largest_indentation();
        if least.is_infinite() { least } else { self.approach(least) }
    }

    /// Indentation (m) at [`Self::limit`].
    fn largest_indentation(&self) -> f64 {
        self.softening().min(self.force_law.end())
    }

    /// Whether the law is valid at an indentation (m), apart from rounding.
    pub fn admits(&self, indentation: f64) -> bool {
        indentation <= (1.0 + 1e-9) * self.largest_indentation()
    }

    /// Indentation (m) at which Φ′ c_l reaches [`LIMIT`].
    fn softening(&self) -> f64 {
        if self.compliance <= 0.0 {
            return f64::INFINITY;
        }
        self.force_law.indentation_of_tangent(LIMIT / self.compliance)
    }

    /// Whether the end of a table limits the law, not its stiffness.
    pub fn ends(&self) -> bool {
        self.force_law.end() < self.softening()
    }

    /// Approach δ at an indentation α > 0.
    fn approach(&self, indentation: f64) -> f64 {
        if self.compliance == 0.0 {
            indentation
        } else {
            indentation - self.compliance * self.force_law.force(indentation)
        }
    }

    /// Indentation α at an approach up to the limit; the approach itself while the bodies are apart.
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
        // Clamping keeps NaN, so that the step is refused.
        let over = (approach - limit).clamp(0.0, f64::INFINITY);
        State { within, force, tangent: slope * growth, growth, over }
    }

    /// Indentation α (m) at an approach (m) with its force (N).
    pub fn indentation(&self, approach: f64, force: f64) -> f64 {
        approach + self.compliance * force
    }

    /// Whether a step is better solved for the indentation than for the approach: Φ(α) is explicit and F(δ) is not, and
    /// the law is valid for all indentations.
    pub fn is_explicit_in_indentation(&self) -> bool {
        self.compliance < 0.0 && self.force_law.end().is_infinite()
    }

    /// Force without damping, N; 0 while the bodies are apart.
    pub fn force(&self, approach: f64) -> f64 {
        self.state(approach).extended()
    }

    /// Force without damping (N) at an approach (m) for which a similar force (N) is known: one step of Newton's method,
    /// with an error of second order in the difference of the two forces. Φ′ c_l must be negative, or well below 1.
    pub fn force_near(&self, approach: f64, force: f64) -> f64 {
        let indentation = self.indentation(approach, force);
        let difference = self.force_law.force(indentation) - force;
        force + difference / (1.0 - self.compliance * self.force_law.tangent(indentation))
    }

    /// Tangent dF/dδ without damping, N/m.
    pub fn tangent(&self, approach: f64) -> f64 {
        self.state(approach).tangent
    }

    /// Tangent dF/dδ without damping (N/m) at an indentation (m) within the validity of the law.
    pub fn tangent_at(&self, indentation: f64) -> f64 {
        let slope = self.force_law.tangent(indentation);
        slope / (1.0 - self.compliance * slope)
    }

    /// Force (N) and tangent dF/dδ (N/m) without damping.
    pub fn force_and_tangent(&self, approach: f64) -> (f64, f64) {
        let state = self.state(approach);
        (state.extended(), state.tangent)
    }

    /// Largest undamped tangent up to an indentation (m), N/m, within the validity of the law.
    pub fn steepest(&self, indentation: f64) -> f64 {
        let slope = self.force_law.steepest(indentation);
        let slope = if self.compliance > 0.0 { slope.min(LIMIT / self.compliance) } else { slope };
        slope / (1.0 - self.compliance * slope)
    }

    /// The undamped law whose force equals the damped one at an approach (m) and its rate (m/s).
    pub fn at_rate(&self, approach: f64, rate: f64) -> Self {
        if self.damping == 0.0 {
            return self.clone();
        }
        self.multiplied(self.factor(self.state(approach).growth, rate))
    }

    /// The damping factor 1 + d α̇ from `growth` = dα/dδ and `rate` = δ̇. It is never below zero, and NaN if the rate
    /// is.
    fn factor(&self, growth: f64, rate: f64) -> f64 {
        if self.damping == 0.0 { 1.0 } else { (1.0 + self.damping * growth * rate).clamp(0.0, f64::INFINITY) }
    }

    fn multiplied(&self, factor: f64) -> Self {
        Self { force_law: self.force_law.scaled(factor), compliance: self.compliance, damping: 0.0 }
    }

    /// Force and its derivatives at an approach (m) and its rate (m/s).
    pub fn damped(&self, approach: f64, rate: f64) -> Damped {
        let at = self.state(approach);
        let elastic = at.extended();
        if self.damping == 0.0 || approach <= 0.0 {
            return Damped { force: elastic, elastic, stiffness: at.tangent, viscosity: 0.0 };
        }
        let factor = self.factor(at.growth, rate);
        if factor == 0.0 {
            // The force is zero, or NaN if the elastic force is NaN.
            return Damped { force: 0.0 * elastic, elastic, stiffness: 0.0, viscosity: 0.0 };
        }
        let now = self.multiplied(factor).state(approach);
        // From δ = α − c f Φ(α) at a fixed δ, with f the damping factor: d(f Φ)/df = Φ/(1 − c f Φ′).
        let viscosity = now.force / factor * now.growth * self.damping * at.growth;
        Damped { force: now.extended(), elastic, stiffness: now.tangent, viscosity }
    }

    /// Potential ∫ F dδ without damping, J.
    pub fn potential(&self, approach: f64) -> f64 {
        let at = self.state(approach);
        let within = self.force_law.potential(at.within) - 0.5 * self.compliance * at.force * at.force;
        within + at.over * (at.force + 0.5 * at.tangent * at.over)
    }

    /// The discrete gradient (V(δ1) − V(δ0)) / (δ1 − δ0), N, and its derivative in δ1, N/m. It is the mean force whose
    /// work over a step equals the change of the potential V (O. Gonzalez, Exact energy and momentum conserving
    /// algorithms for general models in nonlinear elasticity, Comput. Methods Appl. Mech. Eng. 190, 2000).
    pub fn gradient(&self, from: f64, to: f64) -> (f64, f64) {
        let (a, b) = (self.state(from), self.state(to));
        let difference = to - from;
        // For nearly equal approaches the difference loses its digits. The mean force is then the force at the
        // midpoint.
        let far = difference.abs() > 1e-5 * from.abs().max(to.abs());
        let derivative =
            |mean: f64| if far { (b.extended() - mean) / difference } else { 0.5 * self.tangent(0.5 * (from + to)) };
        let both_within = a.over == 0.0 && b.over == 0.0;
        let mean = match (from > 0.0, to > 0.0, &self.force_law) {
            (false, false, _) => return (0.0 * (from + to).clamp(-1.0, 1.0), 0.0),
            // Divided differences of V and δ as polynomials in √α have no cancellation.
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

/// Value of y² (1 − y) below which a series for y is accurate enough as a first value.
const SERIES_BELOW: f64 = 0.06;

/// Indentation α of Hertz's law at δ > 0, with `part` = c_l k0. δ = α − c_l k0 α^{3/2} is a cubic in √α. It is solved
/// by Newton's method.
fn hertz_indentation(approach: f64, part: f64) -> f64 {
    if part < 0.0 {
        return root_of_sum(approach, -part).powi(2);
    }
    // y = c_l k0 √α solves y² (1 − y) = scaled.
    let scaled = (part * part * approach).min(4.0 / 27.0);
    let mut y = if scaled < SERIES_BELOW {
        // Lagrange's inversion in t = √scaled, y = t + t²/2 + 5t³/8 + t⁴ + …, with an error of about 1% of y at most. (Viète's
        // formula has no correct digits for small values.)
        let t = scaled.sqrt();
        t * (1.0 + t * (0.5 + t * (0.625 + t)))
    } else {
        // Viète's formula.
        let angle = ((1.0 - 13.5 * scaled).acos() - std::f64::consts::TAU) / 3.0;
        1.0 / 3.0 + 2.0 / 3.0 * angle.cos()
    };
    for _ in 0..3 {
        y -= (y * y * (1.0 - y) - scaled) / (y * (2.0 - 3.0 * y)).max(f64::MIN_POSITIVE);
    }
    (y / part).powi(2)
}

/// Root x > 0 of x² + part x³ = approach, by Newton's method from above: the function is convex, so the iterates
/// decrease to the root.
fn root_of_sum(approach: f64, part: f64) -> f64 {
    // The iteration x² = approach/(1 + part x) maps a value above the root to one below, and the latter to one above.
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

/// State of the law at an approach.
struct State {
    /// Indentation α at the approach, at most at the limit.
    within: f64,
    force: f64,
    tangent: f64,
    /// dα/dδ.
    growth: f64,
    /// Excess of the approach over the limit, m.
    over: f64,
}

impl State {
    /// Force F, continued along the tangent beyond the limit.
    fn extended(&self) -> f64 {
        self.force + self.tangent * self.over
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crate::contact::{Power, Table};

    /// The paper's impactor on a patch of 25 mm, without a patch, and with additional compliance; the same with a power
    /// law and a table.
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
                // Rounding errors, amplified by the law's slope near the limit.
                assert!((force / law.force_law.force(indentation) - 1.0).abs() < 1e-10, "{approach:e}");
                assert!((indentation - law.compliance * force - approach).abs() <= 1e-14 * indentation);
            }
            assert_eq!((law.force(-1e-3), law.tangent(-1e-3), law.potential(-1e-3)), (0.0, 0.0, 0.0));
            assert_eq!(law.indentation(-1e-3, 0.0), -1e-3);
            assert!(law.force(f64::NAN).is_nan());
        }
    }

    /// The force is the derivative of the potential and the tangent the derivative of the force, on both sides of the
    /// limit.
    #[test]
    fn derivatives_agree_with_differences() {
        for law in laws() {
            let limit = law.limit().min(1e-3);
            for approach in [1e-6, 3e-5, 0.33 * limit, 0.87 * limit, 1.47 * limit] {
                // Error (step/δ)² and rounding over step/δ: 1e-8 together.
                let step = 1e-5 * approach;
                let slope =
                    |f: fn(&Law, f64) -> f64| (f(&law, approach + step) - f(&law, approach - step)) / (2.0 * step);
                assert!((slope(Law::potential) / law.force(approach) - 1.0).abs() < 1e-8);
                assert!((slope(Law::force) / law.tangent(approach) - 1.0).abs() < 1e-8);
            }
        }
    }

    /// A force calculated from a similar one has an error of second order in their difference. The tangent at the
    /// indentation is that at the approach.
    #[test]
    fn a_similar_force_gives_the_force() {
        for law in laws().into_iter().filter(Law::is_explicit_in_indentation) {
            for approach in [1e-6, 3e-5, 1e-3] {
                let force = law.force(approach);
                let off = |part: f64| (law.force_near(approach, (1.0 + part) * force) / force - 1.0).abs();
                assert!(off(0.0) < 1e-14 && off(1e-3) > 0.0);
                // Ten times the difference, a hundred times the error; the third order adds about its tenth.
                let ratio = off(1e-2) / off(1e-3);
                assert!((85.0..115.0).contains(&ratio), "{ratio}");
                let tangent = law.tangent_at(law.indentation(approach, force));
                assert!((tangent / law.tangent(approach) - 1.0).abs() < 1e-14);
            }
        }
    }

    /// The mean force times the step of the approach is the change of the potential, for steps of any size. Its
    /// derivative agrees with differences.
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
                // The mean of a force with bounded curvature equals the value at the midpoint up to part²/24.
                let (mean, _) = law.gradient(from, to);
                assert!((mean / law.force(0.5 * (from + to)) - 1.0).abs() < 0.1 * part * part + 1e-14);
            }
        }
    }

    /// The damped force never falls below zero, dissipates energy for either sign of the rate, and its derivative in δ̇
    /// agrees with differences. Where δ is α, it is Φ times 1 + d α̇.
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
                        // Rounding over the step, 1e-10 of the force, and the square of the step.
                        assert!((slope / at.viscosity - 1.0).abs() < 1e-6, "{slope} {}", at.viscosity);
                    }
                }
            }
            assert_eq!(law.damped(-1e-3, 1.0).force, 0.0);
            assert!(law.damped(f64::NAN, 1.0).force.is_nan() && law.damped(1e-6, f64::NAN).force.is_nan());
        }
    }

    /// At the limit Φ′ c_l equals [`LIMIT`], so the tangent is large and positive. A law without c_l has no limit.
    #[test]
    fn the_limit_is_where_the_stiffness_would_turn_negative() {
        let [law, free, ..] = <[Law; 8]>::try_from(laws()).unwrap();
        let indentation = law.indentation(law.limit(), law.force(law.limit()));
        let slope = law.compliance * law.force_law.tangent(indentation);
        assert!((slope - LIMIT).abs() < 1e-9, "{slope}");
        assert_eq!(free.limit(), f64::INFINITY);
    }
}
