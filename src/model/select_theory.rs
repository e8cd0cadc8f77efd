//! Selects the cheapest theory whose error the tolerance of a scene allows: a half-space, whose error is estimated from the
//! scene alone, a plate ([`super::select_plate`]), or the solid.

use std::f64::consts::PI;

use crate::contact::zener;
use crate::error::{Error, Result};
use crate::impact::{Cause, Errors, Trace};
use crate::scene::{Contact, Geometry, Load, Measure, Model as Theory, Newton, Scene, Scheme, Support, faces};
use crate::space::parts::{FacePart, parts};
use crate::space::spline;

use super::context::ModelContext;
use super::select_plate::select_plate;
use super::{Model, admits};

/// Share of the tolerance for the estimated error of a plate theory.
pub(super) const THEORY_SHARE: f64 = 0.75;

/// Largest estimated error with which a plate theory replaces a solid that would need a mesh. On the window pane of
/// docs/performance.md quadratic hexahedra had an error of 10% after half an hour, and the error of a mesh is not
/// estimated.
pub(super) const LARGEST_ERROR_INSTEAD_OF_MESH: f64 = 0.1;

/// Least ratio of the edges to the thickness of a box that counts as a plate.
const LEAST_SLENDERNESS: f64 = 4.0;

/// Error of the compression of the thickness by a support, over its relative effect. A plate has this compression in series
/// with the support ([`on_plate`](crate::description::Description::on_plate)), with half of the thickness for each face.
const COMPRESSION_ERROR: f64 = 0.5;

/// Error of the stress at a bedded part of a face, over the square of the thickness of a ply divided by its bedding length.
/// Plates neglect the stresses of the bedding's own pressure. An estimate: the errors of converged plates against solids of
/// another program (the three panes of tests/ranks/model/supports.rs) are 0.11, 0.11 and, on each of both faces, 0.16 of it.
const BEDDING_STRESS_ERROR: f64 = 0.16;

/// Relative change of the half-space's peak force in Zener's plate, per λ; from Zener's equation for small λ.
const ERROR_PER_LAMBDA: f64 = 1.13;

/// Selects the theory and makes its model. Collective.
pub(super) fn select_theory(context: &ModelContext, scene: &Scene) -> Result<Model> {
    let mut passed: Vec<String> = Vec::new();
    if let Some((model, reason)) = formula(context, scene)? {
        return Ok(Model { reason: Some(reason), ..model });
    }
    let is_layered = scene.body.composition.uniform().is_none();
    let plate = if is_layered { Theory::Layerwise } else { Theory::Mindlin };
    let thin = if is_layered { Theory::Layerwise } else { Theory::Kirchhoff };
    let plates = slender(scene)
        .and_then(|()| admits(scene, plate))
        .and_then(|()| admits(scene, thin))
        .and_then(|()| check_uncompressed(scene));
    match plates {
        Err(reason) => passed.push(format!("no plate theory applies: {reason}")),
        Ok(()) if !scene.time.modal && scene.solver.newton == Newton::Full => {
            passed.push("solver.newton = \"full\" is for solids only".to_owned());
        }
        Ok(()) if !scene.time.modal && matches!(scene.time.scheme, Scheme::CentralDifference { .. }) => {
            passed.push("the explicit scheme needs a lumped mass, which only the solid has".to_owned());
        }
        Ok(()) if scene.supports.iter().any(is_held_away) => {
            passed.push(
                "a clamp has a displacement, and such a body has no modal coordinates in which plates could be compared".to_owned(),
            );
        }
        Ok(()) if matches!(scene.body.geometry, Geometry::Box { is_given: true, .. }) => {
            passed.push("cells or their order are given, which are settings of the solid".to_owned());
        }
        Ok(()) if matches!(scene.contact, Contact::Patch { radius: Some(_), .. }) => {
            passed.push(
                "contact.patch_radius is given, and of all theories only the solid has a force that depends on it"
                    .to_owned(),
            );
        }
        Ok(()) if is_layered && scene.body.composition.is_of_one_material() => {
            passed.push(
                "its only material is viscoelastic, and the error of a plate theory is not estimated for that; body.model = \"layerwise\" computes it as a plate".to_owned(),
            );
        }
        Ok(()) => match select_plate(context, scene, plate, &mut passed) {
            Ok(Some(model)) => return Ok(Model { reason: Some(passed.join("; ")), ..model }),
            Ok(None) => {}
            // The solid may succeed where a plate fails.
            Err(error @ (Error::Fault(_) | Error::Solve(_))) => passed.push(format!("no plate was computed: {error}")),
            Err(error) => return Err(error),
        },
    }
    let model = Model::of(context, scene, Theory::Solid)?;
    Ok(Model { reason: Some(passed.join("; ")), ..model })
}

/// Whether a support is a clamp with a prescribed displacement.
fn is_held_away(support: &Support) -> bool {
    support.is_rigid() && support.displacement != [0.0; 3]
}

/// A half-space, if its estimated error is small enough.
///
/// Three effects of the body are missing in a half-space. They are waves (λ), the body's rigid motion (at most the
/// ratio of the masses) and the different indentation of a layer of thickness h (about F/(E h)). The exact last term is
/// 0.84 to 1.1 of that, and half of it appears in the force.
fn formula(context: &ModelContext, scene: &Scene) -> Result<Option<(Model, String)>> {
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else { return Ok(None) };
    let is_patch_given = matches!(scene.contact, Contact::Patch { radius: Some(_), .. });
    // A half-space has no face on which a tension could reach a strength, and no deflection but the indentation.
    let needs_body = scene.strength.is_given() || scene.measure != Measure::Acceleration;
    if !scene.time.modal || is_patch_given || needs_body || admits(scene, Theory::InfinitePlate).is_err() {
        return Ok(None);
    }
    let (struck, impactor) = (scene.body.struck(), &scene.impactor);
    // Near an edge, within the thickness, the body is softer. A half-space also has no loads and no moving supports.
    let is_near_edge = scene.distance_to_edge().is_some_and(|distance| distance < size[axis]);
    let is_moved =
        scene.load != Load::default() || scene.supports.iter().any(|support| support.displacement != [0.0; 3]);
    if is_near_edge || is_moved {
        return Ok(None);
    }
    let impedance = zener::impedance(&struck, size[axis]);
    let lambda =
        impactor.stiffness.powf(0.4) * impactor.contact_speed().powf(0.2) * impactor.mass.powf(0.6) / impedance;
    let ratio = impactor.mass / (struck.density * size.iter().product::<f64>());
    let peak = impactor.peak_force();
    let indentation = impactor.peak_indentation();
    let local = peak / (struck.young * size[axis] * indentation);
    let error = ERROR_PER_LAMBDA * lambda + ratio + local;
    // The rest of the tolerance is for the time steps.
    if error > 0.7 * scene.tolerance {
        return Ok(None);
    }
    // (A half-space has no deflection but the indentation.)
    let errors = Errors { deflection: f64::NAN, ..Errors::throughout(error) };
    let model = Model::of(context, scene, Theory::HalfSpace)?;
    let reason = format!(
        "estimated error of a half-space: {error:.1e}, the sum of Zener's λ = {lambda:.1e}, ratio of the masses {ratio:.1e}, dent of a layer {local:.1e}"
    );
    Ok(Some((model.with_error(Cause::Theory, errors), reason)))
}

/// Whether a box is slender enough for a plate theory.
fn slender(scene: &Scene) -> std::result::Result<(), String> {
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else {
        return Err("the body is a mesh file".into());
    };
    let least = (0..3).filter(|i| *i != axis).map(|i| size[i]).fold(f64::INFINITY, f64::min);
    if least < LEAST_SLENDERNESS * size[axis] {
        return Err(format!("its edges are less than {LEAST_SLENDERNESS} times its thickness"));
    }
    Ok(())
}

/// Relative effect of supports that compress the thickness, for a support on the struck face or on the opposite face:
/// the compression p h/E over the support's displacement p/k, at most k h/E. For layers the sum of their compliances
/// replaces h/E. For a damper k is c π/T, with T the contact time on a half-space.
pub fn thickness_compression(scene: &Scene, support: &Support) -> f64 {
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else { return 0.0 };
    if faces(&support.surface).iter().all(|(across, _)| *across != axis) {
        return 0.0;
    }
    if support.is_rigid() {
        return f64::INFINITY;
    }
    let damping = support.damping[axis] * PI / scene.impactor.contact_time();
    (support.stiffness_along(axis) + damping) * scene.body.composition.compliance_across(axis, size[axis])
}

/// Whether the error of the compression of the thickness by each support is within the theory's share of the tolerance, or
/// within [`LARGEST_ERROR_INSTEAD_OF_MESH`] if splines cannot model the solid.
fn check_uncompressed(scene: &Scene) -> std::result::Result<(), String> {
    let share = THEORY_SHARE * scene.tolerance;
    let error = |support: &Support| COMPRESSION_ERROR * thickness_compression(scene, support);
    let is_instead_of_mesh = || scene.is_reduced() && spline::admits(scene).is_err();
    let presses = |support: &Support| {
        let error = error(support);
        error > share && !(error <= LARGEST_ERROR_INSTEAD_OF_MESH && is_instead_of_mesh())
    };
    match scene.supports.iter().position(presses) {
        Some(number) => Err(format!(
            "support.{number} is on the face that is hit, or on the one opposite, and presses the thickness together"
        )),
        None => Ok(()),
    }
}

/// Estimated error of plates due to supports on their faces: of the compression of the thickness, and of the stresses that
/// the bedding's pressure causes in the ply itself, as far as the stress there is the largest one in the `force`.
pub(super) fn bedding_error(scene: &Scene, force: &Trace) -> Errors {
    let compression: f64 = scene.supports.iter().map(|support| thickness_compression(scene, support)).sum();
    let errors = Errors::throughout(COMPRESSION_ERROR * compression);
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else { return errors };
    let layers = scene.body.composition.across(axis, size[axis]);
    let ply = layers.iter().map(|(thickness, _)| *thickness).fold(0.0, f64::max);
    let of_part = |part: &FacePart| BEDDING_STRESS_ERROR * (ply / part.bedding_length).powi(2);
    let on_faces: Vec<FacePart> = parts(scene).into_iter().filter(|part| part.across == axis).collect();
    // Parts of the same extent are on both faces, or on one face twice.
    let of_extent = |extent| on_faces.iter().filter(|part| part.extent == extent).map(of_part).sum();
    let of_stress = on_faces.iter().map(|part| of_extent(part.extent)).fold(0.0, f64::max);
    errors.joined(force.errors_of_largest_stress(0.0, of_stress))
}
