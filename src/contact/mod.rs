//! The contact: Hertz's law.

pub mod hertz;
