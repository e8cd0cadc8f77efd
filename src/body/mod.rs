//! What an impact needs of a body: operators, loads, and where it is hit.

mod clamps;
pub(crate) mod deviates;
mod direct;
mod direct_sum;
mod eigen;
mod gram;
mod infinite_plate;
mod krylov;
mod lumped;
mod merged;
mod modal;
mod modes;
mod operators;
mod pads;
mod projection;
mod relaxation;
mod spectrum;
mod system;
mod unilateral;

pub use clamps::Clamps;
pub use direct_sum::DirectSum;
pub use infinite_plate::{InfinitePlate, OF_CUTOFF};
pub use krylov::{Krylov, Start};
pub use lumped::Lumped;
pub use merged::{Merged, snapshots};
pub use modal::ModalBody;
pub(crate) use modes::no_equilibrium;
pub use modes::{Closed, Free, Mode, Modes, Spectrum};
pub(crate) use modes::{ModalFoundation, Shapes, real_parts};
pub use operators::Body;
pub use pads::{PadOnSurface, PadPoints, Pads};
pub use projection::Projection;
pub use relaxation::Relaxation;
pub use spectrum::{Inertia, LargestFrequency, LinearContact, largest_frequency};
pub use system::System;
pub use unilateral::{FoundationPoints, Unilateral};
