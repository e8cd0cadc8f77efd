//! Shape functions and quadrature on reference cells, without reference to a mesh or a material.
//!
//! The geometry of a cell is always of degree 1 (straight-sided simplices, bilinear quadrilaterals, trilinear
//! hexahedra), for any order of the element on it.

mod adaptive;
mod inverse;
mod lagrange;
mod project;
mod quadrature;
mod table;
mod within;

pub use adaptive::adaptive;
pub use inverse::Inverse;
pub use lagrange::Element;
pub use project::{closest, normal};
pub use quadrature::{Quadrature, gauss_legendre};
pub use table::Table;
pub use within::within;

/// Shape of a cell or facet, with its reference cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shape {
    /// Vertices 0, e1, e2, e3.
    Tetrahedron,
    /// Cube \[−1, 1\]³; vertices 0–3 at the bottom, counter-clockwise seen from above, and 4–7 above them (VTK's
    /// order).
    Hexahedron,
    /// Vertices 0, e1, e2.
    Triangle,
    /// Square \[−1, 1\]²; vertices counter-clockwise.
    Quadrilateral,
}

impl Shape {
    /// Dimension of the reference cell.
    pub fn dimension(self) -> usize {
        match self {
            Self::Tetrahedron | Self::Hexahedron => 3,
            Self::Triangle | Self::Quadrilateral => 2,
        }
    }

    /// Coordinates of the vertices of the reference cell; on a facet ζ = 0.
    pub fn reference_vertices(self) -> &'static [[f64; 3]] {
        match self {
            Self::Tetrahedron => &[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]],
            Self::Triangle => &[[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]],
            Self::Hexahedron => &[
                [-1., -1., -1.],
                [1., -1., -1.],
                [1., 1., -1.],
                [-1., 1., -1.],
                [-1., -1., 1.],
                [1., -1., 1.],
                [1., 1., 1.],
                [-1., 1., 1.],
            ],
            Self::Quadrilateral => &[[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]],
        }
    }

    /// Shape of the facets of a cell.
    ///
    /// # Panics
    /// If this is a facet shape.
    pub fn facet(self) -> Self {
        match self {
            Self::Tetrahedron => Self::Triangle,
            Self::Hexahedron => Self::Quadrilateral,
            _ => panic!("{self:?} is no cell"),
        }
    }

    /// Vertices of each facet of a cell, in right-handed order about the outward normal.
    ///
    /// # Panics
    /// If this is a facet shape.
    pub fn facets(self) -> &'static [&'static [usize]] {
        match self {
            Self::Tetrahedron => &[&[1, 2, 3], &[0, 3, 2], &[0, 1, 3], &[0, 2, 1]],
            Self::Hexahedron => {
                &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
            }
            _ => panic!("{self:?} is no cell"),
        }
    }
}
