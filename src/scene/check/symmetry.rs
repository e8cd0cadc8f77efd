//! Finds planes of symmetry of a scene. With two of them, a quarter of the body is enough. Otherwise the body may still
//! have planes of symmetry that the impact does not share.

use super::super::faces::{Face, along, faces, struck_axis};
use super::super::{
    Composition, Geometry, Impactor, Load, SceneError, Source, Support, SupportKind, Symmetry, Traction, Vec3, Within,
    raw,
};
use super::word;

/// Parts of a scene that must be symmetric.
pub(super) struct Parts<'a> {
    pub composition: &'a Composition,
    pub geometry: &'a Geometry,
    pub impactor: &'a Impactor,
    pub supports: &'a [Support],
    pub load: &'a Load,
}

/// Part of the body that is solved.
pub(super) fn check(source: &Source, raw: &raw::Body, parts: &Parts) -> Result<Symmetry, SceneError> {
    let path = "body.symmetry";
    let asked = word(source, path, &raw.symmetry, &raw::SYMMETRIES)?;
    if asked == "none" {
        return Ok(Symmetry::None { reason: None });
    }
    match planes(parts) {
        Ok(axes) => Ok(Symmetry::Quarter { axes }),
        Err(reason) if asked == "auto" => match symmetric_axes(parts) {
            axes if axes.is_empty() => Ok(Symmetry::None { reason: Some(reason) }),
            axes => Ok(Symmetry::Parts { axes, reason }),
        },
        Err(reason) => {
            let message = format!("the scene does not have two planes of symmetry: {reason}");
            Err(source.error(path, message, "\"auto\" or \"none\", or a scene that is its own mirror image"))
        }
    }
}

const NAMES: [&str; 3] = ["x", "y", "z"];

/// Axes normal to the two planes of symmetry through the impact point, or the reason why there is no symmetry.
fn planes(parts: &Parts) -> Result<[usize; 2], String> {
    let Parts { geometry, composition, impactor, supports, load } = parts;
    let Geometry::Box { size, planes, .. } = geometry else {
        return Err("the body is from a mesh file".into());
    };
    let struck = struck_axis(*size, impactor.point, impactor.direction);
    let axes = along(struck);
    if axes.contains(&2) && !composition.interfaces().is_empty() {
        return Err("a side of its layers is hit".into());
    }
    for axis in axes {
        let name = NAMES[axis];
        if impactor.point[axis] != 0.0 {
            return Err(format!(
                "the impact point is not in the centre of the face: {name} = {}",
                impactor.point[axis]
            ));
        }
        if impactor.direction[axis] != 0.0 {
            return Err("the impactor does not move along the normal of the face".into());
        }
        let cells = planes[axis].len() - 1;
        if cells % 2 == 1 {
            return Err(format!("the number of cells along {name}, {cells}, is odd"));
        }
        mirrored_body(supports, load, axis)?;
    }
    Ok(axes)
}

/// Axes across which the body with its supports and loads is its own mirror image. Empty unless the impactor moves
/// along the normal of a face. Also empty on pads: with lift-off, the motion is not a sum of symmetric and
/// antisymmetric motions.
fn symmetric_axes(parts: &Parts) -> Vec<usize> {
    let Parts { geometry, impactor, supports, load, .. } = parts;
    let Geometry::Box { size, .. } = geometry else { return Vec::new() };
    let axes = along(struck_axis(*size, impactor.point, impactor.direction));
    let is_on_pad = supports.iter().any(Support::may_lift_off);
    if is_on_pad || axes.iter().any(|&axis| impactor.direction[axis] != 0.0) {
        return Vec::new();
    }
    axes.into_iter().filter(|&axis| mirrored_body(supports, load, axis).is_ok()).collect()
}

/// Checks that each support and each load has its mirror image across an axis. The error names the first one without.
fn mirrored_body(supports: &[Support], load: &Load, axis: usize) -> Result<(), String> {
    let name = NAMES[axis];
    let without = |number: usize| {
        let surface = &supports[number].surface;
        format!("support.{number} on {surface:?} has no mirror image across {name} = 0")
    };
    if let Some(number) = unmatched(&springs(supports), |spring| spring.mirrored(axis)) {
        return Err(without(number));
    }
    if let Some(number) = uneven_clamp(supports, axis) {
        return Err(without(number));
    }
    if load.acts_along(axis) {
        return Err(format!("load.body_force has a component along {name}"));
    }
    if let Some(number) = unmatched(&tractions(load), |traction| traction.mirrored(axis)) {
        let surface = &load.traction[number].surface;
        return Err(format!("load.traction.{number} on {surface:?} has no mirror image across {name} = 0"));
    }
    Ok(())
}

/// Index of the first term that does not occur as often as its mirror image.
fn unmatched<T: PartialEq>(terms: &[(usize, T)], image: impl Fn(&T) -> T) -> Option<usize> {
    let count = |of: &T| terms.iter().filter(|(_, term)| term == of).count();
    terms.iter().find(|(_, term)| count(term) != count(&image(term))).map(|(number, _)| *number)
}

/// An elastic support, a pad, or a clamp on a part of a face. The terms of several supports add up, so their order does
/// not matter.
#[derive(PartialEq)]
struct Spring {
    face: Face,
    within: Option<Within>,
    stiffness: Vec3,
    /// Components that a clamp constrains.
    components: [bool; 3],
    /// Direction into a pad.
    normal: Option<Vec3>,
    damping: Vec3,
    displacement: Vec3,
}

impl Spring {
    fn mirrored(&self, axis: usize) -> Self {
        Self {
            face: mirrored_face(self.face, axis),
            within: self.within.map(|within| mirrored_part(within, axis)),
            normal: self.normal.map(|normal| mirrored(normal, axis)),
            displacement: mirrored(self.displacement, axis),
            ..*self
        }
    }
}

/// Springs on each face, with the index of their support.
fn springs(supports: &[Support]) -> Vec<(usize, Spring)> {
    let mut springs = Vec::new();
    for (number, support) in supports.iter().enumerate() {
        let (stiffness, normal, components) = match support.kind {
            SupportKind::Elastic { stiffness } => (stiffness, None, [false; 3]),
            SupportKind::Pad { stiffness, normal } => (stiffness, Some(normal), [false; 3]),
            SupportKind::Clamped { components } if support.within.is_some() => ([0.0; 3], None, components),
            SupportKind::Clamped { .. } => continue,
        };
        let Support { within, damping, displacement, .. } = *support;
        springs.extend(
            faces(&support.surface)
                .iter()
                .map(|&face| (number, Spring { face, within, stiffness, components, normal, damping, displacement })),
        );
    }
    springs
}

/// A traction on one face.
#[derive(PartialEq)]
struct Pull {
    face: Face,
    within: Option<Within>,
    value: Vec3,
}

impl Pull {
    fn mirrored(&self, axis: usize) -> Self {
        Self {
            face: mirrored_face(self.face, axis),
            within: self.within.map(|within| mirrored_part(within, axis)),
            value: mirrored(self.value, axis),
        }
    }
}

/// Tractions on each face, with their index.
fn tractions(load: &Load) -> Vec<(usize, Pull)> {
    let entries = load.traction.iter().enumerate();
    let on_faces = |(number, entry): (usize, &Traction)| {
        let Traction { within, value, .. } = *entry;
        faces(&entry.surface).iter().map(move |&face| (number, Pull { face, within, value }))
    };
    entries.flat_map(on_faces).collect()
}

fn mirrored_face((normal, upper): Face, axis: usize) -> Face {
    (normal, upper != (normal == axis))
}

fn mirrored(mut vector: Vec3, axis: usize) -> Vec3 {
    vector[axis] = -vector[axis];
    vector
}

fn mirrored_part(within: Within, axis: usize) -> Within {
    match within {
        Within::Rim(width) => Within::Rim(width),
        Within::Box([mut low, mut high]) => {
            (low[axis], high[axis]) = (-high[axis], -low[axis]);
            Within::Box([low, high])
        }
        Within::Ball { centre, radius } => Within::Ball { centre: mirrored(centre, axis), radius },
    }
}

/// First clamp of whole surfaces with constraints that differ from their mirror image. On an edge or a corner the last
/// clamp counts, so each face, edge and corner of the box is checked. A place is −1, 0 or 1 along each axis.
fn uneven_clamp(supports: &[Support], axis: usize) -> Option<usize> {
    for mut place in (0..27i8).map(|n| [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1]) {
        for component in 0..3 {
            let here = held(supports, place, component);
            place[axis] = -place[axis];
            let there = held(supports, place, component);
            place[axis] = -place[axis];
            let sign = if component == axis { -1.0 } else { 1.0 };
            if here.map(|(_, u)| u) != there.map(|(_, u)| sign * u) {
                return here.or(there).map(|(number, _)| number);
            }
        }
    }
    None
}

/// Index of the clamp that constrains a component at a place of the surface, and the prescribed displacement ū there,
/// m.
fn held(supports: &[Support], place: [i8; 3], component: usize) -> Option<(usize, f64)> {
    let touches = |&(axis, upper): &Face| place[axis] == if upper { 1 } else { -1 };
    supports.iter().enumerate().rev().find_map(|(number, support)| match support.kind {
        SupportKind::Clamped { components }
            if support.within.is_none() && components[component] && faces(&support.surface).iter().any(touches) =>
        {
            Some((number, support.displacement[component]))
        }
        _ => None,
    })
}
