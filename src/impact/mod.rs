//! Simulation of one impact: motion of body, impactor and contact in time.
//!
//! M ü + C u̇ + K u + p(u) = a F(δ) + f,  m0 q̈ = −F(δ),  δ = q − gap − aᵀu (equations (10) and (14) of the paper). At
//! t = 0 the body is at rest, either undeformed or in equilibrium with its loads.

pub mod checkpoint;
mod estimate;
mod gate;
mod modal;
mod observer;
mod parameters;
mod reading;
pub mod step;
mod stepped;
mod time_integration;

pub use estimate::{Cause, ErrorEstimate, ErrorRule, Errors, beside, estimated, joined, rest};
pub use modal::{KnownForce, ModalImpact, Steps, TIME_STEP_SHARE, Trace};
pub use observer::{Observer, Until};
pub use parameters::ImpactParameters;
pub use reading::{Probe, ProbeForms, Reading, Readout};
pub use stepped::{Impactor, Method, Plan, State, SteppedImpact, settle, stable_step, steps};
pub use time_integration::{Count, TimeIntegration};
