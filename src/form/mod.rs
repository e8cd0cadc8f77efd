//! Integrals over one cell or facet: numbers in, small dense matrices out. Pure: no mesh, no solver.
//!
//! Over a part of a surface, unknowns are those of its [`SurfaceElement`]. Unknowns of a cell are numbered node-major: 3·node + component, nodes in the order of [`crate::element::Element`].
//! With n nodes a matrix is a row-major slice of (3n)² and a vector a slice of 3n; both are overwritten. The vertex
//! coordinates `x` come in the order of the shape's reference vertices. Nothing is allocated after construction.

mod disc;
pub mod elastic;
pub mod layerwise;
mod lumping;
mod pad;
pub mod plate;
pub(crate) mod polygon;
mod pressure;
mod solid;
pub(crate) mod spline;
mod spread;
pub mod stress;
mod surface;
pub mod tensor;

pub use disc::{hertz_terms, hertz_wave, pressure_rule};
pub use lumping::lump;
pub use pad::{Foundation, PadElement, PadPoint, pressed_depth};
pub use pressure::PressureForms;
pub use solid::{Lame, Material, SolidForms, Tangled};
pub use spline::{Parity, Spline};
pub use spread::Spread;
pub use surface::{SurfaceElement, SurfacePoint};
