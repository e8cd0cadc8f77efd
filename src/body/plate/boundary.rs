//! Supports and loads of a scene, as a plate takes them.

use crate::form::tensor::Along;
use crate::scene::{Scene, SupportKind, Vec3, faces};

use super::Theory;
use super::frame::{Frame, NAMES};

/// Where on the plate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    /// Top or bottom.
    Face,
    /// The side face across an axis of the plane.
    Side {
        /// 0 or 1.
        axis: usize,
        /// Whether it is the one at the larger coordinate.
        upper: bool,
    },
}

impl Place {
    /// Of the area or the edge; `ends` are the modelled part's along both axes.
    pub fn along(self, ends: [[f64; 2]; 2]) -> [Along; 2] {
        let mut along = [Along::All; 2];
        if let Self::Side { axis, upper } = self {
            along[axis] = Along::At(ends[axis][usize::from(upper)]);
        }
        along
    }
}

/// Springs or dampers.
pub(super) struct Spring {
    pub place: Place,
    /// A unit of area, along both axes of the plane.
    pub in_plane: [f64; 2],
    /// A unit of area, along the deflection.
    pub across: f64,
    /// ū along the deflection, m.
    pub displacement: f64,
}

/// A held side.
pub(super) struct Clamp {
    pub axis: usize,
    pub upper: bool,
    /// Which in-plane components are held.
    pub in_plane: [bool; 2],
    /// ū along the deflection, where that is held, m.
    pub across: Option<f64>,
}

/// All that holds and loads a plate, on the part that is modelled.
#[derive(Default)]
pub(super) struct Boundary {
    pub springs: Vec<Spring>,
    pub dampers: Vec<Spring>,
    /// In the scene's order: where two hold the same, the later one's ū stands.
    pub clamps: Vec<Clamp>,
    /// Tractions along the deflection, N/m².
    pub tractions: Vec<(Place, f64)>,
    /// Body force along the deflection, N/m³.
    pub body_force: f64,
}

impl Boundary {
    /// Why a plate cannot take the scene's supports and loads.
    pub fn new(scene: &Scene, frame: &Frame, theory: Theory) -> Result<Self, String> {
        let across = NAMES[frame.normal];
        let mut boundary = Self { body_force: frame.across(scene.load.body_force), ..Self::default() };
        if frame.in_plane(scene.load.body_force) != [0.0; 2] {
            return Err("load.body_force has a part in the plate's plane".into());
        }
        for (number, traction) in scene.load.traction.iter().enumerate() {
            if frame.in_plane(traction.value) != [0.0; 2] {
                return Err(format!("load.traction.{number} has a part in the plate's plane"));
            }
            let value = frame.across(traction.value);
            boundary.tractions.extend(places(frame, &traction.surface).map(|place| (place, value)));
        }
        for (number, support) in scene.supports.iter().enumerate() {
            let name = format!("support.{number} on {:?}", support.surface);
            if frame.in_plane(support.displacement) != [0.0; 2] {
                return Err(format!("{name} has a displacement in the plate's plane"));
            }
            let displacement = frame.across(support.displacement);
            let spring = |place: Place, value: Vec3, displacement: f64| {
                let in_plane = frame.in_plane(value);
                if place == Place::Face && in_plane != [0.0; 2] {
                    return Err(format!("{name} is on a face of the plate and acts not along {across} alone"));
                }
                let across = value[frame.normal];
                Ok(Spring { place, in_plane, across, displacement })
            };
            for place in places(frame, &support.surface) {
                boundary.dampers.push(spring(place, support.damping, 0.0)?);
                match (support.kind.clone(), place) {
                    (SupportKind::Pad { .. }, _) => return Err(format!("{name} is a pad")),
                    (SupportKind::Elastic { stiffness }, _) => {
                        boundary.springs.push(spring(place, stiffness, displacement)?);
                    }
                    (SupportKind::Clamped { .. }, Place::Face) => {
                        return Err(format!("{name} holds a face of the plate"));
                    }
                    (SupportKind::Clamped { components }, Place::Side { axis, upper }) => {
                        let in_plane = frame.axes.map(|axis| components[axis]);
                        let across = components[frame.normal].then_some(displacement);
                        boundary.clamps.push(Clamp { axis, upper, in_plane, across });
                    }
                }
            }
        }
        if theory == Theory::Kirchhoff {
            boundary.check_slopes(frame)?;
        }
        Ok(boundary)
    }

    /// Kirchhoff's slope along a side is that of the deflection there: it is held with it or not at all.
    fn check_slopes(&self, frame: &Frame) -> Result<(), String> {
        for clamp in self.clamps.iter().filter(|clamp| clamp.in_plane[1 - clamp.axis]) {
            let same = |other: &&Clamp| (other.axis, other.upper) == (clamp.axis, clamp.upper);
            if !self.clamps.iter().filter(same).any(|other| other.across.is_some()) {
                let [axis, along, across] =
                    [frame.axes[clamp.axis], frame.axes[1 - clamp.axis], frame.normal].map(|axis| NAMES[axis]);
                return Err(format!("a side across {axis} is held along {along} and not along {across}"));
            }
        }
        Ok(())
    }
}

/// The plate's places that a surface stands for, those on the other side of a plane of symmetry left out. A quarter has no part
/// of a side at a smaller coordinate.
fn places(frame: &Frame, surface: &str) -> impl Iterator<Item = Place> {
    faces(surface).iter().filter_map(|&(normal, upper)| match frame.axes.iter().position(|&axis| axis == normal) {
        None => Some(Place::Face),
        Some(axis) => (upper || !frame.quarter).then_some(Place::Side { axis, upper }),
    })
}
