//! Time integration: one scheme a file, each with its citation; how large a step each bears.

mod central_difference;
mod limit;
mod newmark;

pub use central_difference::CentralDifference;
pub use limit::critical_frequency;
pub use newmark::{Newmark, Update};
