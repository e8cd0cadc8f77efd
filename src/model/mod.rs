//! Which theory stands for a scene's body, on what basis, and the impact that is run of it.

mod reduce;

pub use reduce::{Reduced, reduce};
