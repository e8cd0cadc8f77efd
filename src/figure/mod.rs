//! Figures of results.

mod axis;
mod canvas;
pub mod history;
pub mod map;
mod stroke;
