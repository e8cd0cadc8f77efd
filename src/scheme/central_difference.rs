//! Central difference method, with velocities at whole steps (velocity Verlet; Newmark's method with β = 0, γ = 1/2).
//!
//! With v_{n+1/2} = u̇_n + Δt/2 ü_n,
//!
//! u_{n+1} = u_n + Δt v_{n+1/2},  (M + Δt/2 C) ü_{n+1} = f_{n+1} − K u_{n+1} − C v_{n+1/2},  u̇_{n+1} = v_{n+1/2} + Δt/2 ü_{n+1}:
//!
//! M ü + C u̇ + K u = f holds at the end of each step. With diagonal M and C no system of equations is solved. The
//! scheme is of second order and stable while Δt < 2/ω_max, with or without dampers
//! ([`critical_frequency`](super::critical_frequency)). Source: T. J. R. Hughes, The Finite Element Method, 2000,
//! section 9.1.
//!
//! The discrete energy
//!
//! E = ½ u̇ᵀM u̇ + ½ uᵀK u − (Δt²/8) üᵀM ü
//!
//! changes in a step with Δu = u_{n+1} − u_n by exactly ½ Δuᵀ(f_n + f_{n+1}) − ½ Δuᵀ C (u̇_n + u̇_{n+1}). Derivation:
//! let Δ and ⟨⟩ be the change and the mean over a step; insert Δu̇ = Δt ⟨ü⟩ and Δt ⟨u̇⟩ = Δu + Δt²/4 Δü into
//! ΔE = ⟨u̇⟩ᵀM Δu̇ + ⟨u⟩ᵀK Δu − (Δt²/4) ⟨ü⟩ᵀM Δü. Without C and f, E equals ½ u̇ᵀM u̇ + ½ uᵀ(K − Δt²/4 K M⁻¹ K) u. This
//! is positive for every motion if and only if Δt < 2/ω_max, which is the stability limit.

/// The central difference method at one step size. It acts on one unknown at a time: on the body's unknowns (M and C
/// are diagonal) and on the impactor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CentralDifference {
    /// Step size Δt, s.
    pub step: f64,
}

impl CentralDifference {
    /// Returns u_{n+1} and v_{n+1/2} from u_n, u̇_n and ü_n.
    pub fn predict(&self, u: f64, velocity: f64, acceleration: f64) -> (f64, f64) {
        let half = velocity + 0.5 * self.step * acceleration;
        (u + self.step * half, half)
    }

    /// Returns u̇_{n+1} and ü_{n+1} from v_{n+1/2} and the force f − K u at u_{n+1}; `mass` and `damping` belong to the
    /// unknown.
    pub fn correct(&self, half: f64, force: f64, mass: f64, damping: f64) -> (f64, f64) {
        let acceleration = (force - damping * half) / (mass + 0.5 * self.step * damping);
        (half + 0.5 * self.step * acceleration, acceleration)
    }

    /// Returns the term of the discrete energy in addition to the kinetic and elastic energies, −(Δt²/8) üᵀM ü, J. The
    /// argument is üᵀM ü.
    pub fn energy_correction(&self, acceleration_squared: f64) -> f64 {
        -0.125 * self.step * self.step * acceleration_squared
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MASS: f64 = 1.7;
    const STIFFNESS: f64 = 6.8;
    const OMEGA: f64 = 2.;

    /// u, u̇, ü.
    type State = [f64; 3];

    /// Takes a step of m ü + c u̇ + k u = f; `force` is f at the end of the step.
    fn step(scheme: CentralDifference, [u, v, a]: State, damping: f64, force: f64) -> State {
        let (u, half) = scheme.predict(u, v, a);
        let (v, a) = scheme.correct(half, force - STIFFNESS * u, MASS, damping);
        [u, v, a]
    }

    fn energy(scheme: CentralDifference, [u, v, a]: State) -> f64 {
        0.5 * MASS * v * v + 0.5 * STIFFNESS * u * u + scheme.energy_correction(MASS * a * a)
    }

    #[test]
    fn steps_are_the_classical_central_differences() {
        let scheme = CentralDifference { step: 0.1 };
        let damping = 0.4;
        let mut states = vec![[1.1, -0.7, (-damping * -0.7 - STIFFNESS * 1.1) / MASS]];
        for n in 0..3 {
            states.push(step(scheme, states[n], damping, 0.));
        }
        for three in states.windows(3) {
            let [before, now, after] = [three[0], three[1], three[2]];
            assert!((after[0] - before[0] - 2. * scheme.step * now[1]).abs() < 1e-14);
            assert!((after[0] - 2. * now[0] + before[0] - scheme.step.powi(2) * now[2]).abs() < 1e-14);
            assert!((MASS * now[2] + damping * now[1] + STIFFNESS * now[0]).abs() < 1e-13);
        }
    }

    /// Error at a fixed time of m ü + c u̇ + k u = 0, started from u = 1 at rest.
    fn error(damping: f64, steps: usize) -> f64 {
        let end = 3.;
        let scheme = CentralDifference { step: end / steps as f64 };
        let mut state = [1., 0., -STIFFNESS / MASS];
        for _ in 0..steps {
            state = step(scheme, state, damping, 0.);
        }
        let decay = damping / (2. * MASS);
        let damped = (OMEGA * OMEGA - decay * decay).sqrt();
        let exact = (-decay * end).exp() * ((damped * end).cos() + decay / damped * (damped * end).sin());
        (state[0] - exact).abs()
    }

    #[test]
    fn order_is_two_with_and_without_damping() {
        for damping in [0., 0.9] {
            let order = (error(damping, 400) / error(damping, 800)).log2();
            // The next term of the error changes the observed order by about Δt/T < 0.01 at these step sizes.
            assert!((order - 2.).abs() < 0.02, "damping {damping}: {order}");
        }
    }

    /// Below the stability limit, also close to it, the discrete energy changes only by the work of the force and the
    /// damper.
    #[test]
    fn energy_is_balanced_to_rounding() {
        for omega_step in [0.1, 1., 1.99] {
            for damping in [0., 0.9] {
                let scheme = CentralDifference { step: omega_step / OMEGA };
                let force = |n: usize| if damping > 0. { (0.3 * n as f64).sin() } else { 0. };
                let mut state = [1., 0.5, (force(0) - damping * 0.5 - STIFFNESS) / MASS];
                let (initial, scale) = (energy(scheme, state), 0.5 * STIFFNESS);
                let mut work = 0.;
                for n in 0..1000 {
                    let next = step(scheme, state, damping, force(n + 1));
                    let mean = 0.5 * (force(n) + force(n + 1)) - damping * 0.5 * (state[1] + next[1]);
                    work += mean * (next[0] - state[0]);
                    state = next;
                }
                // Near the limit the terms of E are about a hundred times their sum; the bound is a thousand roundings
                // of the terms.
                let left = energy(scheme, state) - initial - work;
                assert!(left.abs() < 1e-11 * scale, "Ω = {omega_step}, c = {damping}: {left:e} of {scale}");
            }
        }
    }
}
