//! Many impacts of one scene, to see how the answer depends on how it is computed.

mod history;
mod plan;
mod schemes;
pub mod stability;
pub mod table;
mod verdict;

pub use history::Measured;
pub use schemes::{label, name};
pub use verdict::Verdict;
