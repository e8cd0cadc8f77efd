//! Description of a body, its supports and its loads as data: terms on regions of its surface, independent of the
//! discretisation.
//!
//! A space ([`crate::space`]) integrates the terms.

mod part;
mod region;

use part::parts;

pub use part::{Part, Portion};
pub use region::{Extent, Place, Region, region};

use crate::form::Foundation;
use crate::scene::{Scene, SupportKind, Vec3, faces};

/// Dimensionless stiffness k·w/E of the springs that replace a clamp on a part of a surface; w is the width of the part
/// (the radius of a ball), k is per area. A rigid disc of radius r on a half-space has the compliance (1 − ν²)/(2 E r),
/// the springs have 1/(k π r²). With this factor and w = r, the springs have less than 1e-4 of the compliance of the
/// half-space; with w = 2r, less than 2e-4.
const CLAMP_STIFFNESS_FACTOR: f64 = 1e4;

/// Content of a scene about the body, except for its geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Materials of the parts of the body, each with the force on its volume.
    pub parts: Vec<Part>,
    /// Elastic supports, equation (11).
    pub springs: Vec<Spring>,
    /// Dampers, equation (13).
    pub dampers: Vec<Damper>,
    /// Unilateral elastic supports (pads), equation (12).
    pub pads: Vec<Pad>,
    /// Prescribed displacements, equation (2). If two clamps prescribe the same component at the same point, the later
    /// one applies.
    pub clamps: Vec<Clamp>,
    /// Tractions, equation (3).
    pub tractions: Vec<Traction>,
    /// Unit vector along which the impactor moves.
    pub direction: Vec3,
}

/// Elastic support on a region.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    /// Region of the surface.
    pub region: Region,
    /// Stiffness k per area of each component, N/m³.
    pub stiffness: Vec3,
    /// Displacement ū at which the spring is unstressed, m.
    pub displacement: Vec3,
}

/// Damper on a region.
#[derive(Debug, Clone, PartialEq)]
pub struct Damper {
    /// Region of the surface.
    pub region: Region,
    /// Damping coefficient c per area of each component, N s/m³.
    pub coefficient: Vec3,
}

/// Unilateral elastic support (pad) on a region.
#[derive(Debug, Clone, PartialEq)]
pub struct Pad {
    /// Region of the surface.
    pub region: Region,
    /// Stiffness, direction and displacement of the foundation.
    pub foundation: Foundation,
}

/// Prescribed displacement of a whole surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Clamp {
    /// Name of the surface.
    pub surface: String,
    /// Whether each component is constrained.
    pub components: [bool; 3],
    /// Prescribed displacement ū, m.
    pub displacement: Vec3,
}

/// Traction on a region.
#[derive(Debug, Clone, PartialEq)]
pub struct Traction {
    /// Region of the surface.
    pub region: Region,
    /// Traction vector f, N/m².
    pub value: Vec3,
}

impl Description {
    /// The description of a plate across an axis, which is not compressed: the compliance (m³/N) of its thickness up to the
    /// middle plane is in series with supports on its faces, 1/k' = 1/k + compliance.
    #[must_use]
    pub fn on_plate(mut self, axis: usize, compliance: f64) -> Self {
        let is_on_face = |region: &Region| {
            region.iter().any(|place| faces(&place.surface).iter().any(|(across, _)| *across == axis))
        };
        let springs = self.springs.iter_mut().map(|spring| (&spring.region, &mut spring.stiffness));
        let pads = self.pads.iter_mut().map(|pad| (&pad.region, &mut pad.foundation.stiffness));
        for (_, stiffness) in springs.chain(pads).filter(|(region, _)| is_on_face(region)) {
            stiffness[axis] /= 1.0 + compliance * stiffness[axis];
        }
        self
    }

    /// Description of the body, the supports and the loads of a scene.
    pub fn new(scene: &Scene) -> Self {
        let body = &scene.body;
        let mut description = Self {
            parts: parts(scene),
            springs: Vec::new(),
            dampers: Vec::new(),
            pads: Vec::new(),
            clamps: Vec::new(),
            tractions: Vec::new(),
            direction: scene.impactor.direction,
        };
        for support in &scene.supports {
            let region = region(scene, &support.surface, support.within);
            let displacement = support.displacement;
            if support.damping != [0.0; 3] {
                description.dampers.push(Damper { region: region.clone(), coefficient: support.damping });
            }
            match support.kind {
                SupportKind::Elastic { stiffness } => {
                    description.springs.push(Spring { region, stiffness, displacement });
                }
                SupportKind::Pad { stiffness, normal } => {
                    let foundation = Foundation { stiffness, normal, displacement };
                    description.pads.push(Pad { region, foundation });
                }
                SupportKind::Clamped { components } => match support.within {
                    None => {
                        let surface = support.surface.clone();
                        description.clamps.push(Clamp { surface, components, displacement });
                    }
                    // The boundary of a part of a surface cuts cells, and an unknown of a cut cell cannot be
                    // constrained on a part of the cell only.
                    Some(within) => {
                        let stiff =
                            CLAMP_STIFFNESS_FACTOR * body.stiffest() / within.width(&body.geometry, &support.surface);
                        let stiffness = components.map(|held| if held { stiff } else { 0.0 });
                        description.springs.push(Spring { region, stiffness, displacement });
                    }
                },
            }
        }
        for traction in &scene.load.traction {
            let region = region(scene, &traction.surface, traction.within);
            description.tractions.push(Traction { region, value: traction.value });
        }
        description
    }
}
