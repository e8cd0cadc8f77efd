//! Supports of the body, each on a named surface or a part of it.

use super::{Geometry, Vec3, faces};
use faces::Face;

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
    /// Whether the body may leave it: a pad.
    pub fn may_lift_off(&self) -> bool {
        matches!(self.kind, SupportKind::Pad { .. })
    }

    /// Whether it holds displacements exactly: a clamp.
    pub fn is_rigid(&self) -> bool {
        matches!(self.kind, SupportKind::Clamped { .. })
    }

    /// Stiffness per area along an axis, N/m³: infinite where it is rigid, and 0 along a pad.
    pub fn stiffness_along(&self, axis: usize) -> f64 {
        match self.kind {
            SupportKind::Elastic { stiffness } => stiffness[axis],
            SupportKind::Pad { stiffness, normal } if normal[axis] != 0.0 => stiffness[axis],
            SupportKind::Clamped { components } if components[axis] => f64::INFINITY,
            SupportKind::Pad { .. } | SupportKind::Clamped { .. } => 0.0,
        }
    }

    /// Whether it holds a component of the displacement exactly on a whole face of a box.
    pub fn clamps_face(&self, face: Face, component: usize) -> bool {
        let is_held = self.is_rigid() && self.stiffness_along(component) > 0.0;
        is_held && self.within.is_none() && faces::faces(&self.surface).contains(&face)
    }

    /// Whether it clamps displacements in the plane of a plate that is hit across axis `struck`. Then it constrains the
    /// cross-sections at the edges.
    pub fn clamps_sections(&self, struck: usize) -> bool {
        self.is_rigid() && (0..3).any(|axis| axis != struck && self.stiffness_along(axis) > 0.0)
    }

    /// Distance of the support (m), along the faces of a box across an axis, from the line through a point along that axis. It is
    /// infinite if the support is on other faces.
    pub fn distance_on_faces(&self, size: Vec3, point: Vec3, axis: usize) -> f64 {
        if faces::faces(&self.surface).iter().all(|(across, _)| *across != axis) {
            return f64::INFINITY;
        }
        let along = [(axis + 1) % 3, (axis + 2) % 3];
        let norm = |distance: &dyn Fn(usize) -> f64| along.map(distance).into_iter().fold(0.0, f64::hypot);
        match self.within {
            None => 0.0,
            Some(Within::Rim(width)) => {
                let edge = along.map(|i| 0.5 * size[i] - point[i].abs());
                (edge[0].min(edge[1]) - width).max(0.0)
            }
            Some(Within::Box([low, high])) => norm(&|i| (low[i] - point[i]).max(point[i] - high[i]).max(0.0)),
            Some(Within::Ball { centre, radius }) => (norm(&|i| centre[i] - point[i]) - radius).max(0.0),
        }
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

/// Distance of supports on the two faces from the impact point, in thicknesses, from which the static field of a contact is that of
/// a free layer.
pub const CLEAR_OF_SUPPORTS: f64 = 2.0;

/// Whether no support on the faces of a box across an axis is within a number of thicknesses (`clearance`) from a point on one of
/// these faces.
pub fn leave_free(supports: &[Support], (size, point, axis): (Vec3, Vec3, usize), clearance: f64) -> bool {
    supports.iter().all(|support| support.distance_on_faces(size, point, axis) >= clearance * size[axis])
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Distances in the plane of the faces, for each kind of part, from a point off the centre.
    #[test]
    fn distances_are_along_the_faces() {
        let of = |surface: &str, within: Option<Within>| {
            let kind = SupportKind::Elastic { stiffness: [1e9; 3] };
            let support = Support { surface: surface.into(), within, kind, damping: [0.0; 3], displacement: [0.0; 3] };
            support.distance_on_faces([1.0, 0.6, 0.02], [0.1, -0.1, 0.01], 2)
        };
        // Tolerance: rounding.
        let is = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        assert_eq!(of("side", None), f64::INFINITY);
        assert_eq!(of("bottom", None), 0.0);
        is(of("bottom", Some(Within::Rim(0.05))), 0.15);
        is(of("bottom", Some(Within::Rim(0.25))), 0.0);
        is(of("top", Some(Within::Box([[0.4, 0.3, -1.0], [0.5, 0.3, 1.0]]))), 0.5);
        is(of("bottom", Some(Within::Ball { centre: [-0.2, 0.3, -0.01], radius: 0.1 })), 0.4);
    }
}
