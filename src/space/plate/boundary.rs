//! Check whether a plate can carry the supports and loads of a scene.

use crate::scene::{Scene, SupportKind, Vec3, faces};

use super::PlateTheory;
use super::geometry::{NAMES, PlateGeometry};

/// Checks the supports and loads of a scene; the error is a clause that says why a plate cannot carry them. A plate
/// bends, but is neither stretched in its plane nor compressed across its thickness.
pub(super) fn check(scene: &Scene, geometry: &PlateGeometry, theory: PlateTheory) -> Result<(), String> {
    if geometry.in_plane(scene.load.force_on(scene.body.struck().density)) != [0.0; 2] {
        return Err("load.body_force has a part in the plate's plane".into());
    }
    for (number, traction) in scene.load.traction.iter().enumerate() {
        if geometry.in_plane(traction.value) != [0.0; 2] {
            return Err(format!("load.traction.{number} has a part in the plate's plane"));
        }
    }
    for (number, support) in scene.supports.iter().enumerate() {
        let clause = |reason: &str| format!("support.{number} on {:?} {reason}", support.surface);
        if geometry.in_plane(support.displacement) != [0.0; 2] {
            return Err(clause("has a displacement in the plate's plane"));
        }
        if let SupportKind::Pad { normal, .. } = support.kind
            && geometry.in_plane(normal) != [0.0; 2]
        {
            return Err(clause("is a pad that acts along the plate, which it would stretch"));
        }
        if support.couples_stretching(geometry.normal, geometry.thickness) {
            return Err(clause(
                "is on a part of a side that is not even across the thickness, and acts along the plate",
            ));
        }
        let is_on_face = faces(&support.surface).iter().any(|(axis, _)| *axis == geometry.normal);
        let along_plane = |value: Vec3| is_on_face && geometry.in_plane(value) != [0.0; 2];
        let held = match support.kind {
            SupportKind::Pad { .. } => false,
            SupportKind::Elastic { stiffness } => along_plane(stiffness),
            SupportKind::Clamped { .. } if is_on_face && support.within.is_none() => {
                return Err(clause("holds a face of the plate"));
            }
            SupportKind::Clamped { components } => along_plane(components.map(|held| f64::from(u8::from(held)))),
        };
        if held || along_plane(support.damping) {
            let across = NAMES[geometry.normal];
            return Err(clause(&format!("is on a face of the plate and acts not along {across} alone")));
        }
    }
    if theory == PlateTheory::Kirchhoff { check_slopes(scene, geometry) } else { Ok(()) }
}

/// Checks the clamped slopes of a Kirchhoff plate. The slope along a side follows from the deflection there, so it can
/// be constrained only together with the deflection.
fn check_slopes(scene: &Scene, geometry: &PlateGeometry) -> Result<(), String> {
    for i in 0..2 {
        let [axis, along] = [geometry.axes[i], geometry.axes[1 - i]];
        for face in [(axis, false), (axis, true)] {
            let any = |component: usize| scene.supports.iter().any(|support| support.clamps_face(face, component));
            if any(along) && !any(geometry.normal) {
                let [axis, along, across] = [axis, along, geometry.normal].map(|axis| NAMES[axis]);
                return Err(format!("a side across {axis} is held along {along} and not along {across}"));
            }
        }
    }
    Ok(())
}
