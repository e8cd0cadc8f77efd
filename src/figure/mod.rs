//! Figures of results.

mod axis;
mod canvas;
mod frame;
pub mod history;
mod letters;
pub mod map;
pub mod precision;
mod scale;
mod shade;
mod stroke;
pub mod sweep;
