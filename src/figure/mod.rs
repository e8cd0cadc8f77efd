//! Figures of results.

mod axis;
mod canvas;
pub mod history;
mod stroke;
