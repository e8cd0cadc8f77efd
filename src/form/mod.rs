//! Integrals over one cell or facet, returned as small dense matrices and vectors, without reference to a mesh or a
//! solver.
//!
//! Unknowns of a cell are numbered by node: 3·node + component, with the nodes in the order of
//! [`crate::element::Element`]. For a part of a surface, [`SurfaceElement`] defines the unknowns. With n nodes a matrix
//! is a row-major slice of (3n)² values and a vector a slice of 3n values; both are overwritten. The vertex coordinates
//! `x` are in the order of the shape's reference vertices. Nothing is allocated after construction.
//!
//! Numbers in parentheses, such as (4), are equations of the paper cited in docs/scene.md.

mod area;
mod disc;
pub mod elastic;
mod lumping;
mod pad;
pub mod plate;
pub(crate) mod polygon;
mod pressure;
mod projection;
mod solid;
pub(crate) mod spline;
mod spread;
pub mod stress;
mod surface;
pub mod tensor;

pub use area::{AreaShape, ContactArea};
pub use disc::{hertz_terms, hertz_wave, pressure_rule};
pub use lumping::lump;
pub use pad::{Foundation, PadElement, PadPoint, pressed_depth};
pub use pressure::PressureForms;
pub use projection::Projection;
pub use solid::{Lame, Material, SolidForms, Tangled};
pub use spline::{Parity, Spline};
pub use spread::Spread;
pub use surface::{SurfaceElement, SurfacePoint};
