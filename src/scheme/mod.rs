//! Time integration: one scheme a file, each with its citation.

mod newmark;

pub use newmark::{Newmark, Update};
