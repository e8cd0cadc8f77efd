//! Figures of results.

mod axis;
mod canvas;
pub mod history;
pub mod map;
mod scale;
mod shade;
mod stroke;
pub mod sweep;
