//! Many impacts of one scene: how the answer depends on the scene, and on how it is computed.

pub mod chart;
pub mod history;
pub mod limit;
mod plan;
mod schemes;
pub mod stability;
pub mod sweep;
pub mod table;
mod verdict;

pub use history::Measured;
pub use schemes::{label, name};
pub use verdict::Verdict;
