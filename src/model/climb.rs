//! The least theory that a scene's tolerance allows. Bodies of several layers climb in [`super::layers`].
//!
//! Theories are tried from the cheapest that the scene admits. The error of a half-space is estimated from the scene alone, that of
//! Mindlin's theory from its difference to Kirchhoff's in the acceleration of the first contact ([`super::mindlin_error`]). The first
//! theory whose estimated error the tolerance allows is taken.

use std::f64::consts::PI;

use petsc_wrap::Comm;

use crate::contact::{hertz, zener};
use crate::error::{Error, Result};
use crate::form::Lame;
use crate::impact::{Cause, Errors};
use crate::material::Material;
use crate::scene::{
    Contact, Geometry, Impactor, Load, Model as Theory, Newton, Scene, Scheme, Support, SupportKind, faces,
};
use crate::space::spline;

use super::layers::layered;
use super::mindlin_error::mindlin_error_over_difference;
use super::watch::Watch;
use super::{Built, Model, Reduced, admits, build, reduce, refine, unrefined};

/// Part of the tolerance that the estimated error of Mindlin's theory may take.
pub(super) const OF_THEORY: f64 = 0.75;

/// The same where Kirchhoff's plate is not computed, and the difference taken to be the whole peak: that estimate is so high that a
/// larger part would lift the sum of all estimates above the tolerance.
const OF_UNCOMPARED: f64 = 0.2;

/// Estimated error up to which a plate theory stands for a solid that would be a mesh: on the window pane of docs/performance.md quadratic
/// hexahedra were off by 10%, in half an hour, and nothing estimates what a mesh leaves.
pub(super) const IN_PLACE_OF_MESH: f64 = 0.1;

/// The tolerance of Kirchhoff's plate, which is computed for that difference alone, over the scene's, and at most.
const ROUGHER: f64 = 10.0;
const ROUGHEST: f64 = 0.1;

/// What the two plates differ by in the force at least, where Mindlin's is to be ruled out by rougher ones first; an estimate: thick plates were
/// seen to differ by 0.08 to 0.15. And its estimated error on these over the theory's part from which on it is.
const LEAST_DIFFERENCE: f64 = 0.03;
const RULED_OUT_FACTOR: f64 = 1.5;

/// Edges over thickness below which a box is no plate.
const SLENDER: f64 = 4.0;

/// Part of the tolerance by which each support may press the thickness of a plate together.
const OF_PRESSING: f64 = 0.1;

/// By what part of λ Zener's plate changes the force of a half-space, over its peak; from his equation, for small λ.
const OF_LAMBDA: f64 = 1.13;

/// Climbs. Collective.
pub(super) fn climb(comm: &Comm, scene: &Scene, watch: &dyn Watch) -> Result<Model> {
    let mut passed: Vec<String> = Vec::new();
    if let Some((model, reason)) = formula(comm, scene, watch)? {
        return Ok(Model { reason: Some(reason), ..model });
    }
    let is_layered = scene.body.composition.uniform().is_none();
    let least = if is_layered { Theory::Layerwise } else { Theory::Kirchhoff };
    let plates = slender(scene).and_then(|()| admits(scene, least)).and_then(|()| unpressed(scene));
    match plates {
        Err(reason) => passed.push(format!("no plate theory stands for it: {reason}")),
        Ok(()) if !scene.time.modal && scene.solver.newton == Newton::Full => {
            passed.push("the full Newton's method is asked for, which is the solid's".to_owned());
        }
        Ok(()) if !scene.time.modal && matches!(scene.time.scheme, Scheme::CentralDifference { .. }) => {
            passed.push("the explicit scheme is asked for, and the solid alone has a lumped mass".to_owned());
        }
        Ok(()) if scene.supports.iter().any(is_held_away) => {
            passed.push(
                "it is held at a displacement, and has no modal coordinates in which plates are compared".to_owned(),
            );
        }
        Ok(()) if matches!(scene.body.geometry, Geometry::Box { is_given: true, .. }) => {
            passed.push("cells or their order are given, which are the solid's".to_owned());
        }
        Ok(()) if matches!(scene.contact, Contact::Patch { radius: Some(_), .. }) => {
            passed.push("a patch is given, which is the solid's".to_owned());
        }
        Ok(()) if is_layered && scene.body.composition.is_of_one_material() => {
            passed.push(
                "it is of one material that relaxes, and the error of a plate is not estimated for that; body.model = \"layerwise\" computes it as a plate".to_owned(),
            );
        }
        Ok(()) => match if is_layered { layered } else { plate }(comm, scene, &mut passed, watch) {
            Ok(Some(model)) => return Ok(Model { reason: Some(passed.join("; ")), ..model }),
            Ok(None) => {}
            // What a plate cannot, the solid may.
            Err(error @ (Error::Fault(_) | Error::Solve(_))) => passed.push(format!("no plate was computed: {error}")),
            Err(error) => return Err(error),
        },
    }
    let model = Model::of(comm, scene, Theory::Solid, watch)?;
    Ok(Model { reason: Some(passed.join("; ")), ..model })
}

/// Whether a support is a clamp with a displacement.
fn is_held_away(support: &Support) -> bool {
    matches!(support.kind, SupportKind::Clamped { .. }) && support.displacement != [0.0; 3]
}

/// A half-space, where its estimated error is small enough.
///
/// To a half-space a body adds waves (λ), its own motion (no more than by the ratio of the masses) and, as a layer of the thickness h, a
/// dent that differs by about F/(E h): exact is 0.84 to 1.1 of that, and half of it is seen in the force.
fn formula(comm: &Comm, scene: &Scene, watch: &dyn Watch) -> Result<Option<(Model, String)>> {
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else { return Ok(None) };
    let is_patch_given = matches!(scene.contact, Contact::Patch { radius: Some(_), .. });
    if !scene.time.modal || is_patch_given || admits(scene, Theory::InfinitePlate).is_err() {
        return Ok(None);
    }
    let (struck, impactor) = (scene.body.struck(), &scene.impactor);
    // Nearer to an edge than its thickness the body is softer; and what else moves it, a half-space does not know.
    let is_near_edge = scene.distance_to_edge().is_some_and(|distance| distance < size[axis]);
    let is_moved =
        scene.load != Load::default() || scene.supports.iter().any(|support| support.displacement != [0.0; 3]);
    if is_near_edge || is_moved {
        return Ok(None);
    }
    let impedance = zener::impedance(&struck, size[axis]);
    let lambda = impactor.stiffness.powf(0.4) * impactor.speed.powf(0.2) * impactor.mass.powf(0.6) / impedance;
    let ratio = impactor.mass / (struck.density * size.iter().product::<f64>());
    let peak = impactor.peak_force();
    let indentation = impactor.peak_indentation();
    let local = peak / (struck.young * size[axis] * indentation);
    let error = OF_LAMBDA * lambda + ratio + local;
    // What is left is the steps'.
    if error > 0.7 * scene.tolerance {
        return Ok(None);
    }
    let model = Model::of(comm, scene, Theory::HalfSpace, watch)?;
    let reason = format!(
        "estimated error of a half-space: {error:.1e}, the sum of Zener's λ = {lambda:.1e}, ratio of the masses {ratio:.1e}, dent of a layer {local:.1e}"
    );
    Ok(Some((model.with_error(Cause::Theory, Errors::throughout(error)), reason)))
}

/// Whether a box is a plate.
fn slender(scene: &Scene) -> std::result::Result<(), String> {
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else {
        return Err("the body is a mesh file".into());
    };
    let least = (0..3).filter(|i| *i != axis).map(|i| size[i]).fold(f64::INFINITY, f64::min);
    if least < SLENDER * size[axis] {
        return Err(format!("its edges are less than {SLENDER} times its thickness"));
    }
    Ok(())
}

/// How much supports of the face that is hit, or of the one opposite, press the thickness together: by the part p h/E of what a support
/// yields by, p/k, or k h/E, at most; of layers by the sum of what each gives way. Both plate theories leave that out, so that their difference does not tell. Of a damper k is
/// c π/T, T the contact time on a half-space.
fn pressing(scene: &Scene, support: &Support) -> f64 {
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else { return 0.0 };
    if faces(&support.surface).iter().all(|(across, _)| *across != axis) {
        return 0.0;
    }
    let stiffness = match support.kind {
        SupportKind::Elastic { stiffness } | SupportKind::Pad { stiffness, .. } => stiffness[axis],
        SupportKind::Clamped { .. } => return f64::INFINITY,
    };
    let Impactor { stiffness: of_contact, mass, speed, .. } = scene.impactor;
    let damping = support.damping[axis] * PI / hertz::contact_time(of_contact, mass, speed);
    let composition = &scene.body.composition;
    let compliance = match composition.uniform() {
        Some(material) => size[axis] / material.young,
        None => composition.across(axis, size[axis]).into_iter().map(confined).sum(),
    };
    (stiffness + damping) * compliance
}

/// What a layer that is held along its faces gives way across them, h/(K + 4G/3), G after all relaxation, m³/N.
fn confined((thickness, material): (f64, Material)) -> f64 {
    let Lame { lambda, mu } = material.relaxed();
    thickness / (lambda + 2.0 * mu)
}

/// Whether no support presses the thickness together by more than a part of the tolerance.
fn unpressed(scene: &Scene) -> std::result::Result<(), String> {
    let presses = |support: &Support| pressing(scene, support) > OF_PRESSING * scene.tolerance;
    match scene.supports.iter().position(presses) {
        Some(number) => Err(format!(
            "support.{number} is on the face that is hit, or on the one opposite, and presses the thickness together"
        )),
        None => Ok(()),
    }
}

/// Kirchhoff and Mindlin; `None` where the solid is needed.
fn plate(comm: &Comm, scene: &Scene, passed: &mut Vec<String>, watch: &dyn Watch) -> Result<Option<Model>> {
    let tolerance = scene.tolerance;
    let modal = Scene { time: crate::scene::Time { modal: true, ..scene.time.clone() }, ..scene.clone() };
    let operators = |scene: &Scene, theory| match build(comm, scene, theory, 1.0, watch)? {
        Built::Operators(operators) => Ok(operators),
        Built::Given(_) => Err(Error::Solve("a plate has unknowns".into())),
    };
    if let Err(reason) = admits(scene, Theory::Mindlin) {
        passed.push(format!("Kirchhoff's theory has no neighbour to be judged by: {reason}"));
        return Ok(None);
    }
    let part = mindlin_error_over_difference(scene);
    let rough = rougher(&modal);
    let on_rough = |theory| reduce(comm, operators(&rough, theory)?.body.linear(), &rough, watch);
    // Given schemes without a basis step a mesh in any case.
    let no_splines = if scene.is_reduced() { spline::admits(scene).err() } else { None };
    let most = if no_splines.is_some() { OF_THEORY.max(IN_PLACE_OF_MESH / tolerance) } else { OF_THEORY };
    let mut thin = None;
    // What rougher plates rule out by far needs no fine one.
    if part * LEAST_DIFFERENCE > most * tolerance {
        let kirchhoff = on_rough(Theory::Kirchhoff)?;
        let compared = Compared::new(scene, part, &on_rough(Theory::Mindlin)?, &kirchhoff, watch);
        if compared.error_over_tolerance > RULED_OUT_FACTOR * most {
            passed.push(compared.ruled_out(scene));
            return Ok(None);
        }
        thin = Some(kirchhoff);
    }
    // Cells and basis are not judged yet: their part of the difference is small, and so is what it changes in the estimate.
    let thick = unrefined(comm, &modal, operators(&modal, Theory::Mindlin)?, watch)?;
    let of_theory = if part <= OF_UNCOMPARED * tolerance {
        passed.push(format!(
            "estimated error of mindlin relative to solid: {part:.1e}, even if kirchhoff differed from it by the whole peak"
        ));
        Errors::throughout(part)
    } else {
        let thin = thin.map_or_else(|| on_rough(Theory::Kirchhoff), Ok)?;
        let compared = Compared::new(scene, part, &thick.reduced, &thin, watch);
        if compared.error_over_tolerance > most {
            passed.push(compared.ruled_out(scene));
            return Ok(None);
        }
        let is_above_its_part = compared.error_over_tolerance > OF_THEORY;
        passed.push(match no_splines.filter(|_| is_above_its_part) {
            Some(reason) => compared.in_place_of_mesh(scene, &reason),
            None => compared.judged,
        });
        compared.errors
    };
    let of_theory = of_theory.joined(pressed(scene));
    let model = match scene.time.modal {
        true => {
            let fitted = refine(comm, &modal, Theory::Mindlin, thick, of_theory, watch)?;
            Model::on_basis(comm, scene, Theory::Mindlin, fitted)?
        }
        false => Model::of(comm, scene, Theory::Mindlin, watch)?,
    };
    Ok(Some(model.with_error(Cause::Theory, of_theory)))
}

/// Mindlin's plate beside Kirchhoff's.
struct Compared {
    /// Estimated errors of Mindlin's theory.
    errors: Errors,
    /// The one that counts, over the tolerance.
    error_over_tolerance: f64,
    /// A clause.
    judged: String,
}

impl Compared {
    /// Collective.
    fn new(scene: &Scene, part: f64, thick: &Reduced, thin: &Reduced, watch: &dyn Watch) -> Self {
        let difference = thick.force.0.difference(&thin.force.0);
        let errors = part * difference;
        let (differ, error) = (difference.of(scene.measure), errors.of(scene.measure));
        let of_what = scene.measure.of_what();
        let judged = format!(
            "kirchhoff and mindlin differ by {differ:.1e}{of_what} in the first contact; estimated error of mindlin relative to solid: {error:.1e}"
        );
        Self { errors, error_over_tolerance: watch.agreed(error / scene.tolerance), judged }
    }

    /// Why the solid is taken.
    fn ruled_out(&self, scene: &Scene) -> String {
        format!("{}, so the solid is taken", self.above_its_part(scene))
    }

    /// Why it is not, where splines do not stand for it: `reason`.
    fn in_place_of_mesh(&self, scene: &Scene, reason: &str) -> String {
        let above = self.above_its_part(scene);
        format!(
            "{above}, and yet taken: splines do not stand for its solid ({reason}), and a mesh would have errors that nothing estimates"
        )
    }

    fn above_its_part(&self, scene: &Scene) -> String {
        let share = OF_THEORY * scene.tolerance;
        format!("{}, above {share:.1e}, the theory's part of the tolerance", self.judged)
    }
}

/// The same scene with the tolerance of what is computed for a difference alone.
pub(super) fn rougher(scene: &Scene) -> Scene {
    let tolerance = scene.tolerance.max((ROUGHER * scene.tolerance).min(ROUGHEST));
    Scene { tolerance, ..scene.clone() }
}

/// What supports leave of error that press the thickness together.
pub(super) fn pressed(scene: &Scene) -> Errors {
    Errors::throughout(scene.supports.iter().map(|support| pressing(scene, support)).sum())
}
