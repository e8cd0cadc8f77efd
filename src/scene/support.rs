//! Supports of the body, each on a named surface or a part of it.

use super::{Geometry, Vec3, faces};

/// A support on one named surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// Name of the surface: of a box, or a physical name of the mesh file.
    pub surface: String,
    /// The part of the surface that is supported; `None` for the whole surface.
    pub within: Option<Within>,
    /// Kind of support.
    pub kind: SupportKind,
    /// Damping c of (13) by component, N s/m³.
    pub damping: Vec3,
    /// Prescribed displacement ū, m.
    pub displacement: Vec3,
}

impl Support {
    /// Whether it clamps displacements in the plane of a plate that is hit across axis `struck`. Then it constrains the
    /// cross-sections at the edges.
    pub fn clamps_sections(&self, struck: usize) -> bool {
        let SupportKind::Clamped { components } = self.kind else { return false };
        (0..3).any(|axis| components[axis] && axis != struck)
    }

    /// Whether the support couples bending and stretching. This is so if it covers a side unevenly across the thickness
    /// along an axis and acts in directions other than that axis. A pad that acts in such directions always does: it
    /// loses contact with one half of a bent side.
    pub fn couples_stretching(&self, axis: usize, thickness: f64) -> bool {
        let is_even = self.within.is_none_or(|within| within.is_even(axis, thickness));
        let acts = |values: Vec3| (0..3).any(|i| i != axis && values[i] != 0.0);
        let holds = match self.kind {
            SupportKind::Pad { normal, .. } if acts(normal) => return true,
            SupportKind::Pad { .. } => false,
            SupportKind::Elastic { stiffness } => acts(stiffness),
            SupportKind::Clamped { components } => (0..3).any(|i| i != axis && components[i]),
        };
        !is_even && (holds || acts(self.damping))
    }
}

/// Kind of support on a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum SupportKind {
    /// Bilateral springs, (11).
    Elastic {
        /// Stiffness k by component, N/m³.
        stiffness: Vec3,
    },
    /// Unilateral (one-sided) springs, (12).
    Pad {
        /// Stiffness k by component, N/m³.
        stiffness: Vec3,
        /// Unit vector into the pad. Each displacement component that points into the pad is resisted.
        normal: Vec3,
    },
    /// Constrained components, (2).
    Clamped {
        /// Which components are constrained.
        components: [bool; 3],
    },
}

/// A part of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Within {
    /// Strips of a width (m) along all edges of the faces of a box.
    Rim(f64),
    /// The part inside a box, given by its smallest and largest coordinates, m.
    Box([Vec3; 2]),
    /// The part inside a ball.
    Ball {
        /// Centre, m.
        centre: Vec3,
        /// Radius, m.
        radius: f64,
    },
}

impl Within {
    /// Smallest extent of the part, m. On a box: along its faces and cut off at their edges. On a mesh: as given.
    pub fn width(&self, geometry: &Geometry, surface: &str) -> f64 {
        let (size, along): (Vec3, Vec<usize>) = match geometry {
            Geometry::Box { size, .. } => {
                let along = |axis: &usize| faces::faces(surface).iter().any(|(across, _)| across != axis);
                (*size, (0..3).filter(along).collect())
            }
            Geometry::Gmsh(_) => ([f64::INFINITY; 3], vec![0, 1, 2]),
        };
        let shortest =
            |extent: &dyn Fn(usize) -> f64| along.iter().map(|axis| extent(*axis)).fold(f64::INFINITY, f64::min);
        match self {
            Self::Rim(width) => shortest(&|i| width.min(0.5 * size[i])),
            Self::Box([low, high]) => shortest(&|i| high[i].min(0.5 * size[i]) - low[i].max(-0.5 * size[i])),
            Self::Ball { radius, .. } => *radius,
        }
    }

    /// Whether the part covers both sides of the middle plane across an axis equally. `thickness` is the thickness of
    /// the body along the axis, m.
    pub fn is_even(&self, axis: usize, thickness: f64) -> bool {
        let half = 0.5 * thickness;
        match self {
            Self::Rim(_) => true,
            Self::Box([low, high]) => low[axis].max(-half) == -high[axis].min(half),
            Self::Ball { centre, .. } => centre[axis] == 0.0,
        }
    }
}
