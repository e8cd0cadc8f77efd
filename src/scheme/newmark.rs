//! Newmark's family (N. M. Newmark, A method of computation for structural dynamics, J. Eng. Mech. Div. ASCE 85, 1959).
//!
//! With D = u_{n+1} − u_n and the step Δt,
//!
//! u_{n+1} = u_n + Δt u̇_n + Δt² ((1/2 − β) ü_n + β ü_{n+1}),  u̇_{n+1} = u̇_n + Δt ((1 − γ) ü_n + γ ü_{n+1}),
//!
//! solved for the new velocity and acceleration as affine functions of D. Second order for γ = 1/2; unconditionally
//! stable for 2β ≥ γ ≥ 1/2; β = 1/4, γ = 1/2 is the average acceleration, which conserves the energy of a linear system.

/// The scheme's two parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Newmark {
    /// β > 0.
    pub beta: f64,
    /// γ.
    pub gamma: f64,
}

/// New velocity and acceleration from the increment D: v = c1 D + v\[0\] u̇_n + v\[1\] ü_n, a = c2 D + a\[0\] u̇_n + a\[1\] ü_n.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Update {
    /// 1/s.
    pub c1: f64,
    /// 1/s².
    pub c2: f64,
    /// Factors of the old velocity (1) and acceleration (s).
    pub v: [f64; 2],
    /// Factors of the old velocity (1/s) and acceleration (1).
    pub a: [f64; 2],
}

impl Newmark {
    /// The update of a step, s.
    pub fn update(&self, step: f64) -> Update {
        let Self { beta, gamma } = *self;
        Update {
            c1: gamma / (beta * step),
            c2: 1.0 / (beta * step * step),
            v: [1.0 - gamma / beta, step * (1.0 - gamma / (2.0 * beta))],
            a: [-1.0 / (beta * step), 1.0 - 1.0 / (2.0 * beta)],
        }
    }
}

impl Update {
    /// Velocity and acceleration of a single unknown after its increment.
    pub fn apply(&self, increment: f64, velocity: f64, acceleration: f64) -> (f64, f64) {
        (
            self.c1 * increment + self.v[0] * velocity + self.v[1] * acceleration,
            self.c2 * increment + self.a[0] * velocity + self.a[1] * acceleration,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The update is Newmark's two formulas solved for the new values.
    #[test]
    fn update_satisfies_newmarks_formulas() {
        for (beta, gamma) in [(0.25, 0.5), (0.3025, 0.6), (1.0 / 6.0, 0.5)] {
            let (step, u, v, a) = (0.3, 1.1, -0.7, 2.3);
            let increment = 0.4;
            let (v1, a1) = Newmark { beta, gamma }.update(step).apply(increment, v, a);
            let u1 = u + step * v + step * step * ((0.5 - beta) * a + beta * a1);
            assert!((u1 - (u + increment)).abs() < 1e-14);
            assert!((v1 - (v + step * ((1.0 - gamma) * a + gamma * a1))).abs() < 1e-13);
        }
    }

    /// ü = −ω² u from u = 1: error at a fixed time, for halved steps.
    fn error(scheme: Newmark, steps: usize) -> f64 {
        let (omega, end) = (2.0_f64, 3.0);
        let step = end / steps as f64;
        let update = scheme.update(step);
        let (mut u, mut v, mut a) = (1.0, 0.0, -omega * omega);
        for _ in 0..steps {
            // c2 D + a* = −ω² (u + D)
            let (_, known) = update.apply(0.0, v, a);
            let increment = -(known + omega * omega * u) / (update.c2 + omega * omega);
            (v, a) = update.apply(increment, v, a);
            u += increment;
        }
        (u - (omega * end).cos()).abs()
    }

    #[test]
    fn order_is_two_for_gamma_one_half_and_one_otherwise() {
        let order = |scheme| (error(scheme, 400) / error(scheme, 800)).log2();
        // The next term of the error changes the observed order by about Δt/T < 0.01 at these steps.
        assert!((order(Newmark { beta: 0.25, gamma: 0.5 }) - 2.0).abs() < 0.02);
        assert!((order(Newmark { beta: 1.0 / 6.0, gamma: 0.5 }) - 2.0).abs() < 0.02);
        assert!((order(Newmark { beta: 0.3025, gamma: 0.6 }) - 1.0).abs() < 0.02);
    }
}
