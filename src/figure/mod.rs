//! Figures of results.

mod axis;
mod canvas;
mod frame;
pub mod history;
pub mod map;
pub mod precision;
mod scale;
mod shade;
mod stroke;
pub mod sweep;
