//! Duration of a run, time integration, and solution of a time step.

/// Duration of the run and time integration.
#[derive(Debug, Clone, PartialEq)]
pub struct Time {
    /// End of the run, s.
    pub end: f64,
    /// Fixed time step Δt, s; `None`: controlled by the estimated error.
    pub step: Option<f64>,
    /// State of the body at t = 0.
    pub initial: Initial,
    /// Whether modal coordinates are used. They are exact for the linear part.
    pub modal: bool,
    /// Time integration scheme for other coordinates.
    pub scheme: Scheme,
}

/// State of the body at t = 0. It is at rest in both cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Initial {
    /// Undeformed.
    Rest,
    /// In static equilibrium under its loads.
    Equilibrium,
}

/// Time integration scheme.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scheme {
    /// Newmark (1959).
    Newmark {
        /// β, in (0, 1].
        beta: f64,
        /// γ, in [0, 1].
        gamma: f64,
    },
    /// Generalised-α (Chung & Hulbert 1993).
    GeneralizedAlpha {
        /// Spectral radius at infinite frequency ρ∞, in [0, 1].
        rho_inf: f64,
    },
    /// Midpoint rule with discrete gradients, energy-conserving (Gonzalez 2000).
    Energy,
    /// Explicit, with lumped mass.
    CentralDifference {
        /// Whether a step above the stability limit is accepted.
        allow_unstable: bool,
    },
}

/// Solution of a time step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solver {
    /// Variant of Newton's method.
    pub newton: Newton,
    /// Largest error of the energy balance over the initial energy and the work of the loads before the run stops; `None` for no limit.
    pub energy_gate: Option<f64>,
}

/// Variant of Newton's method for an implicit step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Newton {
    /// One linear solve and a scalar equation.
    Condensed,
    /// All unknowns, with the block aaᵀ, as in the paper.
    Full,
}
