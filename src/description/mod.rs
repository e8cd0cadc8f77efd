//! A body, what holds it and what loads it, as data: terms on regions of its surface. Knows no discretisation.
//!
//! A space ([`crate::space`]) integrates it.

mod part;
mod region;

use part::parts;

pub use part::{Part, Portion};
pub use region::{Extent, Place, Region, region};

use crate::form::Foundation;
use crate::scene::{Scene, SupportKind, Vec3};

/// k of the springs that hold a clamped part of a surface, times its width over E. A rigid disc of the radius r on a half-space yields
/// by P (1 − ν²)/(2 E r), springs by P/(k π r²): with this factor less than 1e-4 of it.
const STIFF_AS_A_CLAMP: f64 = 1e4;

/// All that a scene says of its body but for the geometry.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// What it is made of, and the force on the volume of each part.
    pub parts: Vec<Part>,
    /// Elastic supports (11).
    pub springs: Vec<Spring>,
    /// Dampers (13).
    pub dampers: Vec<Damper>,
    /// One-sided elastic supports (12).
    pub pads: Vec<Pad>,
    /// Held displacements (2): where two hold the same, the later one's stands.
    pub clamps: Vec<Clamp>,
    /// Tractions (3).
    pub tractions: Vec<Traction>,
    /// Unit vector along which the impactor moves.
    pub direction: Vec3,
}

/// An elastic support.
#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    /// Where.
    pub region: Region,
    /// k, N/m³ by component.
    pub stiffness: Vec3,
    /// ū, m.
    pub displacement: Vec3,
}

/// A damper.
#[derive(Debug, Clone, PartialEq)]
pub struct Damper {
    /// Where.
    pub region: Region,
    /// c, N s/m³ by component.
    pub coefficient: Vec3,
}

/// A one-sided elastic support.
#[derive(Debug, Clone, PartialEq)]
pub struct Pad {
    /// Where.
    pub region: Region,
    /// What pushes back.
    pub foundation: Foundation,
}

/// A held displacement of a whole surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Clamp {
    /// Name of the surface.
    pub surface: String,
    /// Which components are held.
    pub components: [bool; 3],
    /// ū, m.
    pub displacement: Vec3,
}

/// A traction.
#[derive(Debug, Clone, PartialEq)]
pub struct Traction {
    /// Where.
    pub region: Region,
    /// f, N/m².
    pub value: Vec3,
}

impl Description {
    /// Of a scene.
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
                    // The edge of a part cuts cells, whose unknowns cannot be held in part.
                    Some(within) => {
                        let stiff = STIFF_AS_A_CLAMP * body.stiffest() / within.width(&body.geometry, &support.surface);
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
