//! What an impact needs of a body: operators, loads, and where it is hit.

mod assembly;
pub mod block;
mod clamps;
mod deviates;
pub mod gauge;
mod gram;
mod krylov;
mod lumped;
mod merged;
mod modal;
mod modes;
mod operators;
mod pads;
pub mod plate;
mod projection;
mod solid;
mod spectrum;
mod system;

pub use assembly::{Stopped, assemble, into_matrix, into_vector, zeros};
pub use clamps::Clamps;
pub use krylov::Krylov;
pub use lumped::Lumped;
pub use merged::{Merged, snapshots};
pub use modal::ModalBody;
pub(crate) use modes::Shapes;
pub use modes::{Closed, Free, Mode, Modes, Spectrum};
pub use operators::Body;
pub use pads::{PadPoints, Pads};
pub use projection::Projection;
pub use solid::by_iterations;
pub use spectrum::{Inertia, LargestFrequency, LinearContact, largest_frequency};
pub use system::System;
