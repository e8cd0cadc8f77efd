//! How long the impact is followed, in which steps, and how a step is solved.

/// How long, and in which steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Time {
    /// End of the run, s.
    pub end: f64,
    /// Step Δt, s; controlled by the error where it is left out.
    pub step: Option<f64>,
    /// How the body is at t = 0.
    pub initial: Initial,
    /// Whether the body moves in modal coordinates, exactly in its linear part.
    pub modal: bool,
    /// How a step is taken otherwise.
    pub scheme: Scheme,
}

/// How the body is at t = 0: at rest in either case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Initial {
    /// Undeformed.
    Rest,
    /// Deformed by its loads.
    Equilibrium,
}

/// How a step is taken.
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
        /// Whether a step above the stable one is taken all the same.
        allow_unstable: bool,
    },
}

/// How a step is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solver {
    /// Which Newton's method.
    pub newton: Newton,
    /// The part of the initial energy that the balance may be off by before the run is stopped.
    pub energy_gate: Option<f64>,
}

/// Which Newton's method solves an implicit step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Newton {
    /// One linear solve and a scalar equation.
    Condensed,
    /// All unknowns and the block aaᵀ, as in the paper.
    Full,
}
