//! One impact: body, impactor and contact law in time.
//!
//! M ü + C u̇ + K u + p(u) = a F(δ) + f,  m0 q̈ = −F(δ),  δ = q − gap − aᵀu  (10), (14), from rest at t = 0, undeformed or in
//! equilibrium.

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

pub use estimate::{Cause, ErrorEstimate, Errors, joined, rest};
pub use modal::{ModalImpact, OF_STEPS, Steps, Trace};
pub use observer::{Observer, Until};
pub use parameters::ImpactParameters;
pub use reading::{Probe, ProbeForms, Reading, Readout};
pub use stepped::{Impactor, Method, Plan, State, SteppedImpact, settle, stable_step, steps};
pub use time_integration::{Count, TimeIntegration};
