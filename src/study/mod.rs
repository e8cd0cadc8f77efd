//! Studies of many impacts of one scene: how the results depend on the scene, and on the numerical method.

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
