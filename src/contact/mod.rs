//! The contact of impactor and body: the local law, and where the body is loaded and read.
//!
//! [`Hertz`] gives the force from the indentation α (8), [`Law`] from the approach; [`Localization`] is the vector a by which the body takes the
//! force and shows its displacement (14).

pub mod hertz;
mod law;
mod localization;
mod radius;
pub mod zener;

pub use hertz::Hertz;
pub use law::Law;
pub use localization::Localization;
pub use radius::{Patch, Reason};
pub(crate) use radius::{limits, unit_compliance};
