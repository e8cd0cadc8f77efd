//! Contact of impactor and body: the local force law, and the part of the body's surface on which it acts.
//!
//! [`ForceLaw`] gives the force from the indentation α, by default [`Hertz`]'s law (8). [`Law`] gives it from the
//! approach and its rate. [`Localization`] is the vector a (14): the body is loaded along it, and its displacement is
//! measured along it.

mod force_law;
pub mod hertz;
mod law;
mod layers;
mod localization;
mod radius;
mod table;
pub mod zener;

pub use force_law::{ForceLaw, Power};
pub use hertz::Hertz;
pub use law::{Damped, Law};
pub(crate) use layers::HitOnLayers;
pub use layers::{LayerEffect, LayeredContact};
pub use localization::{Footprint, LARGEST_PHASE, Localization};
pub(crate) use radius::{Blow, dent, limits, unit_compliance};
pub use radius::{Patch, Reason};
pub use table::Table;
