//! The contact of impactor and body: the local law, and where the body is loaded and read.
//!
//! [`ForceLaw`] gives the force from the indentation α, by default as [`Hertz`] does (8), [`Law`] from the approach and its rate;
//! [`Localization`] is the vector a by which the body takes the force and shows its displacement (14).

mod force_law;
pub mod hertz;
mod law;
mod localization;
mod radius;
mod table;
pub mod zener;

pub use force_law::{ForceLaw, Power};
pub use hertz::Hertz;
pub use law::{Damped, Law};
pub use localization::Localization;
pub use radius::{Patch, Reason};
pub(crate) use radius::{limits, unit_compliance};
pub use table::Table;
