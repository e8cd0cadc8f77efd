//! ricochet: low-velocity impact on elastic plates and bodies.
//!
//! The data's way: [`scene`] → `mesh` → `form` → `body` → [`impact`] → steps → `record`.

pub mod cli;
pub mod error;
pub mod figure;
pub mod impact;
pub mod record;
pub mod scene;
