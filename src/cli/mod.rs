//! What the user typed, and what to do about it.

pub mod plot;
