//! What an impact needs of a body: operators, loads, and where it is hit.

mod assembly;
mod clamps;
mod lumped;
mod pads;
pub mod plate;
mod solid;
mod spectrum;

pub use assembly::{Stopped, assemble, into_matrix, into_vector, zeros};
pub use clamps::Clamps;
pub use lumped::Lumped;
pub use pads::{PadPoints, Pads};
pub use solid::Solid;
pub use spectrum::{Inertia, LargestFrequency, LinearContact, largest_frequency};
