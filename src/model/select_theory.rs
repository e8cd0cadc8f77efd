//! Selects the cheapest theory whose error the tolerance of a scene allows. Bodies of several layers are treated in
//! [`super::layers`].
//!
//! Theories are tried from the cheapest that the scene admits. The error of a half-space is estimated from the scene
//! alone. The error of Mindlin's theory is estimated from its difference from Kirchhoff's in the acceleration of the
//! first contact ([`super::mindlin_error`]). The first theory with a small enough estimated error is taken.

use std::cell::LazyCell;
use std::f64::consts::PI;

use crate::contact::zener;
use crate::error::{Error, Result};
use crate::impact::{Cause, Errors, Trace, beside};
use crate::scene::{Contact, Geometry, Load, Measure, Model as Theory, Newton, Scene, Scheme, Support, faces};
use crate::space::parts::{Part, parts};
use crate::space::spline;

use super::layers::layered;
use super::making::Making;
use super::mindlin_error::mindlin_error_over_difference;
use super::watch::Watch;
use super::{Built, Model, Reduced, admits, build, reduce, refine, unrefined};

/// Share of the tolerance for the estimated error of Mindlin's theory.
pub(super) const THEORY_SHARE: f64 = 0.75;

/// The same share if Kirchhoff's plate is not computed and the difference is taken to be the whole peak. That estimate
/// is so high that a larger share would raise the sum of all estimates above the tolerance.
const UNCOMPARED_THEORY_SHARE: f64 = 0.2;

/// Largest estimated error with which a plate theory replaces a solid that would need a mesh. On the window pane of
/// docs/performance.md quadratic hexahedra had an error of 10% after half an hour, and the error of a mesh is not
/// estimated.
pub(super) const LARGEST_ERROR_INSTEAD_OF_MESH: f64 = 0.1;

/// Tolerance of Kirchhoff's plate, which is computed for that difference only, relative to the scene's tolerance; and
/// its largest value.
const ROUGH_TOLERANCE_FACTOR: f64 = 10.0;
const LARGEST_ROUGH_TOLERANCE: f64 = 0.1;

/// Least relative difference assumed between the forces of the two plate theories. If even this difference is too large
/// for Mindlin's theory, rough plates are computed first, to rule it out. An estimate: thick plates were measured to
/// differ by 0.08 to 0.15. The next constant is the error on rough plates, over the theory's share of the tolerance,
/// that rules it out.
const LEAST_DIFFERENCE: f64 = 0.03;
const RULED_OUT_FACTOR: f64 = 1.5;

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
pub(super) fn select_theory(making: &Making, scene: &Scene) -> Result<Model> {
    let mut passed: Vec<String> = Vec::new();
    if let Some((model, reason)) = formula(making, scene)? {
        return Ok(Model { reason: Some(reason), ..model });
    }
    let is_layered = scene.body.composition.uniform().is_none();
    let least = if is_layered { Theory::Layerwise } else { Theory::Kirchhoff };
    let plates = slender(scene).and_then(|()| admits(scene, least)).and_then(|()| check_uncompressed(scene));
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
        Ok(()) => match if is_layered { layered } else { plate }(making, scene, &mut passed) {
            Ok(Some(model)) => return Ok(Model { reason: Some(passed.join("; ")), ..model }),
            Ok(None) => {}
            // The solid may succeed where a plate fails.
            Err(error @ (Error::Fault(_) | Error::Solve(_))) => passed.push(format!("no plate was computed: {error}")),
            Err(error) => return Err(error),
        },
    }
    let model = Model::of(making, scene, Theory::Solid)?;
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
fn formula(making: &Making, scene: &Scene) -> Result<Option<(Model, String)>> {
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
    let model = Model::of(making, scene, Theory::HalfSpace)?;
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

/// Tries Kirchhoff's and Mindlin's plates; `None` if the solid is needed.
fn plate(making: &Making, scene: &Scene, passed: &mut Vec<String>) -> Result<Option<Model>> {
    let tolerance = scene.tolerance;
    let modal = Scene { time: crate::scene::Time { modal: true, ..scene.time.clone() }, ..scene.clone() };
    let operators = |scene: &Scene, theory| match build(making, scene, theory, 1.0)? {
        Built::Operators(operators) => Ok(operators),
        Built::Given(_) => Err(Error::Solve("a plate has unknowns".into())),
    };
    if let Err(reason) = admits(scene, Theory::Mindlin) {
        passed.push(format!(
            "the error of Kirchhoff's theory cannot be estimated, since Mindlin's does not apply: {reason}"
        ));
        return Ok(None);
    }
    let part = mindlin_error_over_difference(scene);
    let rough = rougher(&modal);
    let on_rough = |theory| reduce(making, operators(&rough, theory)?.body.linear(), &rough);
    // Reason why splines cannot model the solid, evaluated only where the theory's error is above its share. With a
    // given scheme and no basis, the solid is a mesh in any case.
    let no_splines = LazyCell::new(|| if scene.is_reduced() { spline::admits(scene).err() } else { None });
    let is_too_large = |error_over_tolerance: f64, factor: f64| {
        let instead_of_mesh = || THEORY_SHARE.max(LARGEST_ERROR_INSTEAD_OF_MESH / tolerance);
        error_over_tolerance > factor * THEORY_SHARE
            && (no_splines.is_none() || error_over_tolerance > factor * instead_of_mesh())
    };
    let mut thin = None;
    // If rough plates clearly rule out the theory, no fine plate is computed.
    if is_too_large(part * LEAST_DIFFERENCE / tolerance, 1.0) {
        let kirchhoff = on_rough(Theory::Kirchhoff)?;
        let compared = Compared::new(scene, part, &on_rough(Theory::Mindlin)?, &kirchhoff, making.watch);
        if is_too_large(compared.error_over_tolerance, RULED_OUT_FACTOR) {
            passed.push(compared.ruled_out(scene));
            return Ok(None);
        }
        thin = Some(kirchhoff);
    }
    // Cells and basis are not checked yet. Their part of the difference is small, and so is their effect on the
    // estimate.
    let thick = unrefined(making, &modal, operators(&modal, Theory::Mindlin)?)?;
    let of_theory = if part <= UNCOMPARED_THEORY_SHARE * tolerance {
        passed.push(format!(
            "estimated error of mindlin relative to solid: {part:.1e}, even if kirchhoff differed from it by the whole peak"
        ));
        Errors::throughout(part)
    } else {
        let thin = thin.map_or_else(|| on_rough(Theory::Kirchhoff), Ok)?;
        let compared = Compared::new(scene, part, &thick.reduced, &thin, making.watch);
        if is_too_large(compared.error_over_tolerance, 1.0) {
            passed.push(compared.ruled_out(scene));
            return Ok(None);
        }
        let is_above_its_part = compared.error_over_tolerance > THEORY_SHARE;
        passed.push(match is_above_its_part.then(|| no_splines.as_ref()).flatten() {
            Some(reason) => compared.in_place_of_mesh(scene, reason),
            None => compared.judged,
        });
        compared.errors
    };
    let of_theory = of_theory.joined(bedding_error(scene, &thick.reduced.force.0));
    let model = match scene.time.modal {
        true => {
            let fitted = refine(making, &modal, Theory::Mindlin, thick, of_theory)?;
            Model::on_basis(making, scene, Theory::Mindlin, fitted)?
        }
        false => Model::of(making, scene, Theory::Mindlin)?,
    };
    Ok(Some(model.with_error(Cause::Theory, of_theory)))
}

/// Comparison of Mindlin's plate with Kirchhoff's.
struct Compared {
    /// Estimated errors of Mindlin's theory.
    errors: Errors,
    /// The error in the quantity that the tolerance applies to, over the tolerance.
    error_over_tolerance: f64,
    /// Reason in words, for the results.
    judged: String,
}

impl Compared {
    /// Compares the forces; `part` is the estimated error of Mindlin's theory over the difference. Collective.
    fn new(scene: &Scene, part: f64, thick: &Reduced, thin: &Reduced, watch: &dyn Watch) -> Self {
        let difference = thick.force.0.difference(&thin.force.0);
        let errors = part * difference;
        let (differ, error) = (difference.of(scene.measure), errors.of(scene.measure));
        let (of_what, part) = (scene.of_measure(), scene.in_measured_part());
        let judged = format!(
            "kirchhoff and mindlin differ by {differ:.1e}{of_what}{part}; estimated error of mindlin relative to solid: {}",
            beside(error, THEORY_SHARE * scene.tolerance)
        );
        Self { errors, error_over_tolerance: watch.agreed(error / scene.tolerance), judged }
    }

    /// Reason for taking the solid.
    fn ruled_out(&self, scene: &Scene) -> String {
        format!("{}, so the solid is used", self.above_its_part(scene))
    }

    /// Reason for taking the plate although its error is above its share: splines do not admit the solid, for `reason`.
    fn in_place_of_mesh(&self, scene: &Scene, reason: &str) -> String {
        let above = self.above_its_part(scene);
        format!(
            "{above}, but used: splines cannot model its solid ({reason}), and the error of a mesh is not estimated"
        )
    }

    fn above_its_part(&self, scene: &Scene) -> String {
        let share = THEORY_SHARE * scene.tolerance;
        format!("{}, above {share:.1e}, the theory's share of the tolerance", self.judged)
    }
}

/// The scene with a larger tolerance, for bodies that are computed for a difference only.
pub(super) fn rougher(scene: &Scene) -> Scene {
    let tolerance = scene.tolerance.max((ROUGH_TOLERANCE_FACTOR * scene.tolerance).min(LARGEST_ROUGH_TOLERANCE));
    Scene { tolerance, ..scene.clone() }
}

/// Estimated error of plates due to supports on their faces: of the compression of the thickness, and of the stresses that
/// the bedding's pressure causes in the ply itself, as far as the stress there is the largest one in the `force`.
pub(super) fn bedding_error(scene: &Scene, force: &Trace) -> Errors {
    let compression: f64 = scene.supports.iter().map(|support| thickness_compression(scene, support)).sum();
    let errors = Errors::throughout(COMPRESSION_ERROR * compression);
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else { return errors };
    let layers = scene.body.composition.across(axis, size[axis]);
    let ply = layers.iter().map(|(thickness, _)| *thickness).fold(0.0, f64::max);
    let of_part = |part: &Part| BEDDING_STRESS_ERROR * (ply / part.bedding_length).powi(2);
    let on_faces: Vec<Part> = parts(scene).into_iter().filter(|part| part.across == axis).collect();
    // Parts of the same extent are on both faces, or on one face twice.
    let of_extent = |extent| on_faces.iter().filter(|part| part.extent == extent).map(of_part).sum();
    let of_stress = on_faces.iter().map(|part| of_extent(part.extent)).fold(0.0, f64::max);
    errors.joined(force.errors_of_largest_stress(0.0, of_stress))
}
