//! Draws figures of results.

mod axis;
mod canvas;
pub mod face;
mod frame;
pub mod history;
mod legend;
mod letters;
pub mod map;
mod output;
pub mod precision;
mod scale;
mod shade;
mod stroke;
pub mod sweep;

pub(crate) use axis::exponential;
pub use canvas::Sheet;
