//! What an impact needs of a body: operators, loads, and where it is hit.

mod assembly;
mod clamps;
mod pads;
mod solid;

pub use assembly::{Stopped, assemble, into_matrix, into_vector, zeros};
pub use clamps::Clamps;
pub use pads::{PadPoints, Pads};
pub use solid::Solid;
