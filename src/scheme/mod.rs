//! Time integration schemes: one module for each scheme, with its citation.
//!
//! The implicit schemes form one family, [`Implicit`], and differ only in its parameters. With D = u_{n+1} − u_n and
//! the step Δt,
//!
//! u_{n+1} = u_n + Δt u̇_n + Δt² ((1/2 − β) ü_n + β ü_{n+1}),  u̇_{n+1} = u̇_n + Δt ((1 − γ) ü_n + γ ü_{n+1}),
//!
//! M ü_m + C u̇_f + K u_f + p = a F + f. This equation holds at a stage between the two times:
//! ü_m = (1 − α_m) ü_{n+1} + α_m ü_n, and u_f, u̇_f likewise with α_f. The forces F and p are evaluated at the stage,
//! or are discrete gradients over the step.

mod central_difference;
mod energy;
mod generalized_alpha;
mod limit;
pub mod modal;
mod newmark;

pub use central_difference::CentralDifference;
pub use energy::energy;
pub use generalized_alpha::generalized_alpha;
pub use limit::critical_frequency;
pub use newmark::newmark;

use crate::contact::Law;
use crate::scene::Scheme;

/// Parameters of an implicit one-step scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Implicit {
    /// α_m: weight of the old acceleration at the stage.
    pub alpha_m: f64,
    /// α_f: weight of the old displacement and velocity at the stage.
    pub alpha_f: f64,
    /// β > 0 of Newmark's formulas.
    pub beta: f64,
    /// γ of Newmark's formulas.
    pub gamma: f64,
    /// Whether forces are discrete gradients over the step instead of values at the stage.
    pub gradient: bool,
}

impl Implicit {
    /// Returns the implicit scheme of a scene; `None` if the scheme is explicit.
    pub fn new(scheme: Scheme) -> Option<Self> {
        match scheme {
            Scheme::Newmark { beta, gamma } => Some(newmark(beta, gamma)),
            Scheme::GeneralizedAlpha { rho_inf } => Some(generalized_alpha(rho_inf)),
            Scheme::Energy => Some(energy()),
            Scheme::CentralDifference { .. } => None,
        }
    }

    /// Order of accuracy in time: 2 if γ = 1/2 − α_m + α_f, otherwise 1.
    pub fn order(&self) -> usize {
        let off = self.gamma - (0.5 - self.alpha_m + self.alpha_f);
        if off.abs() < 1e-12 { 2 } else { 1 }
    }

    /// θ = 1 − α_f: ratio of the stage's increment E to the step's increment D.
    pub fn theta(&self) -> f64 {
        1.0 - self.alpha_f
    }

    /// Velocity and acceleration at the end of a step (s), as functions of D.
    pub fn end(&self, step: f64) -> Affine {
        let Self { beta, gamma, .. } = *self;
        Affine {
            c1: gamma / (beta * step),
            c2: 1.0 / (beta * step * step),
            v: [1.0 - gamma / beta, step * (1.0 - gamma / (2.0 * beta))],
            a: [-1.0 / (beta * step), 1.0 - 1.0 / (2.0 * beta)],
        }
    }

    /// Velocity and acceleration at the stage, u̇_f and ü_m, as functions of the stage's increment E = θ D = u_f − u_n.
    pub fn stage(&self, step: f64) -> Affine {
        let (end, theta, alpha_m) = (self.end(step), self.theta(), self.alpha_m);
        Affine {
            c1: end.c1,
            c2: (1.0 - alpha_m) / theta * end.c2,
            v: [theta * end.v[0] + self.alpha_f, theta * end.v[1]],
            a: [(1.0 - alpha_m) * end.a[0], (1.0 - alpha_m) * end.a[1] + alpha_m],
        }
    }
}

/// Velocity and acceleration as affine functions of an increment D: v = c1 D + v\[0\] u̇_n + v\[1\] ü_n,
/// a = c2 D + a\[0\] u̇_n + a\[1\] ü_n.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Affine {
    /// Factor of the increment in the velocity, 1/s.
    pub c1: f64,
    /// Factor of the increment in the acceleration, 1/s².
    pub c2: f64,
    /// Factors of the old velocity (dimensionless) and acceleration (s) in the velocity.
    pub v: [f64; 2],
    /// Factors of the old velocity (1/s) and acceleration (dimensionless) in the acceleration.
    pub a: [f64; 2],
}

impl Affine {
    /// Returns velocity and acceleration of a single unknown after its increment.
    pub fn apply(&self, increment: f64, velocity: f64, acceleration: f64) -> (f64, f64) {
        (
            self.c1 * increment + self.v[0] * velocity + self.v[1] * acceleration,
            self.c2 * increment + self.a[0] * velocity + self.a[1] * acceleration,
        )
    }
}

/// The contact force of a step as a function of the approach at its stage.
#[derive(Debug, Clone)]
pub struct StageForce {
    /// Contact law Φ(δ).
    pub law: Law,
    /// Approach δ_n at the start of the step, m.
    pub from: f64,
    /// θ = 1 − α_f of the scheme.
    pub theta: f64,
    /// Whether the force is the discrete gradient over the step.
    pub gradient: bool,
    /// Rate δ̇ at the stage as an affine function of the approach: its value if δ has not moved (m/s) and its slope
    /// with δ (1/s). Used only if the law has damping.
    pub rate: [f64; 2],
}

impl StageForce {
    /// Returns δ_{n+1} (m) for an approach at the stage (m).
    pub fn end(&self, stage: f64) -> f64 {
        self.from + (stage - self.from) / self.theta
    }

    /// Returns F, N, and dF/dδ, N/m, at the stage's approach (m).
    pub fn at(&self, stage: f64) -> (f64, f64) {
        let elastic = self.elastic(stage);
        if self.law.damping == 0.0 {
            return elastic;
        }
        let [known, slope] = self.rate;
        let damped = self.law.damped(stage, known + slope * (stage - self.from));
        if !self.gradient {
            return (damped.force, damped.stiffness + slope * damped.viscosity);
        }
        // Mean force plus the damping force at the stage. It is never negative; the clamp keeps NaN.
        let force = (elastic.0 + damped.force - damped.elastic).clamp(0.0, f64::INFINITY);
        let stiffness = elastic.1 + damped.stiffness - self.law.tangent(stage) + slope * damped.viscosity;
        (force, if force == 0.0 { 0.0 } else { stiffness })
    }

    /// Same as [`Self::at`] without damping: only the force of the potential.
    pub fn elastic(&self, stage: f64) -> (f64, f64) {
        if self.gradient {
            let (force, tangent) = self.law.gradient(self.from, self.end(stage));
            (force, tangent / self.theta)
        } else {
            (self.law.force(stage), self.law.tangent(stage))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Error of ü + 2ζω u̇ + ω² u = 0, started from u = 1, at a fixed time after `steps` steps.
    fn error(scheme: Implicit, damping: f64, steps: usize) -> f64 {
        let (omega, end) = (2.0_f64, 3.0);
        let step = end / steps as f64;
        let (stage, last, theta) = (scheme.stage(step), scheme.end(step), scheme.theta());
        let (mut u, mut v) = (1.0, 0.0);
        let mut a = -omega * omega;
        for _ in 0..steps {
            let (free_v, free_a) = stage.apply(0.0, v, a);
            let known = -(free_a + 2.0 * damping * omega * free_v + omega * omega * u);
            let increment = known / (stage.c2 + 2.0 * damping * omega * stage.c1 + omega * omega) / theta;
            (v, a) = last.apply(increment, v, a);
            u += increment;
        }
        let damped = omega * (1.0 - damping * damping).sqrt();
        let phase = damped * end;
        let exact = (-damping * omega * end).exp() * (phase.cos() + damping * omega / damped * phase.sin());
        (u - exact).abs()
    }

    #[test]
    fn orders_in_time() {
        let order = |scheme, damping| (error(scheme, damping, 800) / error(scheme, damping, 1600)).log2();
        for damping in [0.0, 0.05] {
            // The next term of the error changes the observed order by about Δt/T < 0.01 at these step sizes.
            for scheme in [newmark(0.25, 0.5), newmark(1.0 / 6.0, 0.5), energy()] {
                assert!((order(scheme, damping) - 2.0).abs() < 0.02);
            }
            for rho_inf in [0.0, 0.5, 0.8, 1.0] {
                // ρ∞ = 0 has the largest error term of third order.
                assert!((order(generalized_alpha(rho_inf), damping) - 2.0).abs() < 0.04);
            }
            assert!((order(newmark(0.3025, 0.6), damping) - 1.0).abs() < 0.03);
        }
    }

    /// The two forms of a step, stage and end, satisfy Newmark's formulas and the definition of the stage.
    #[test]
    fn stage_and_end_agree() {
        for scheme in [newmark(0.3025, 0.6), generalized_alpha(0.3), energy()] {
            let (step, u, v, a) = (0.3, 1.1, -0.7, 2.3);
            let increment = 0.4;
            let (v1, a1) = scheme.end(step).apply(increment, v, a);
            let Implicit { alpha_m, alpha_f, beta, gamma, .. } = scheme;
            let u1 = u + step * v + step * step * ((0.5 - beta) * a + beta * a1);
            assert!((u1 - (u + increment)).abs() < 1e-14);
            assert!((v1 - (v + step * ((1.0 - gamma) * a + gamma * a1))).abs() < 1e-13);
            let (stage_v, stage_a) = scheme.stage(step).apply(scheme.theta() * increment, v, a);
            assert!((stage_v - ((1.0 - alpha_f) * v1 + alpha_f * v)).abs() < 1e-13);
            assert!((stage_a - ((1.0 - alpha_m) * a1 + alpha_m * a)).abs() < 1e-12);
        }
    }
}
