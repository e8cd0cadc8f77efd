//! The contact of impactor and body: the local law.
//!
//! Hertz's law (8) gives the force from the indentation α; where the body's displacement is read, and what part of the
//! indentation it already holds, is the localisation's affair.

mod hertz;

pub use hertz::{Hertz, contact_time, peak_force, stiffness};
