//! What holds the body, and on which part of a surface.

use super::{Geometry, Vec3, faces};

/// A term on one named surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// Name of the surface: of a box, or a physical name of the mesh file.
    pub surface: String,
    /// The part of it that is held; all of it where this is left out.
    pub within: Option<Within>,
    /// What holds the body there.
    pub kind: SupportKind,
    /// Damping c of (13), N s/m³ by component.
    pub damping: Vec3,
    /// Prescribed displacement ū, m.
    pub displacement: Vec3,
}

impl Support {
    /// Whether it clamps displacements along a plate that is hit across an axis: it holds the sections of edges then.
    pub fn clamps_sections(&self, struck: usize) -> bool {
        let SupportKind::Clamped { components } = self.kind else { return false };
        (0..3).any(|axis| components[axis] && axis != struck)
    }

    /// Whether it acts on a part of a side that is not even across the thickness along an axis of a body, and in other directions than
    /// along that axis: then bending and stretching are coupled. A pad that acts in such directions lets go of one half of a bent side.
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

/// What holds the body on a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum SupportKind {
    /// Springs in both directions, (11).
    Elastic {
        /// k, N/m³ by component.
        stiffness: Vec3,
    },
    /// Springs that only push back, (12).
    Pad {
        /// k, N/m³ by component.
        stiffness: Vec3,
        /// Unit vector into the pad: each component of u that points into it is resisted.
        normal: Vec3,
    },
    /// Held components, (2).
    Clamped {
        /// Which components are held.
        components: [bool; 3],
    },
}

/// A part of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Within {
    /// Strips of a width (m) along all edges of the faces of a box.
    Rim(f64),
    /// What lies in a box, given by its least and largest coordinates, m.
    Box([Vec3; 2]),
    /// What lies in a ball.
    Ball {
        /// Its centre, m.
        centre: Vec3,
        /// Its radius, m.
        radius: f64,
    },
}

impl Within {
    /// The shortest extent of what it has of a surface, m: of a box's, along its faces and within these; of a mesh's, as it is given.
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

    /// Whether it has as much of a body of a thickness (m) on either side of the middle plane across an axis.
    pub fn is_even(&self, axis: usize, thickness: f64) -> bool {
        let half = 0.5 * thickness;
        match self {
            Self::Rim(_) => true,
            Self::Box([low, high]) => low[axis].max(-half) == -high[axis].min(half),
            Self::Ball { centre, .. } => centre[axis] == 0.0,
        }
    }
}
