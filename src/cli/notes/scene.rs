//! Remarks on a scene: contact, time steps, and keys without effect.

use crate::contact::{Footprint, ForceLaw, LARGEST_PHASE, LayerEffect, Patch, Reason};
use crate::impact::Plan;
use crate::model;
use crate::scene::{Contact, Geometry, Load, Model as Theory, Scene, Scheme, face_names, one_digit};
use crate::scheme::critical_frequency;
use crate::space::plate::phase;

use super::super::short;
use super::Remark;

/// Warning for a body of layers whose stresses are read on its outer faces only, although the largest tension may be on
/// others.
pub fn missing_faces(scene: &Scene, faces: &[String]) -> Option<Remark> {
    let layers = scene.hit_layers().len().saturating_sub(1);
    let (read, all) = (faces.len(), face_names(layers).len());
    (layers > 1 && read > 0 && read < all).then(|| {
        let text = format!(
            "stresses are read on the faces {} alone, since the model is a mesh of finite elements: the largest tension may be on a face \
             between layers; body.model = \"layerwise\" reads all faces",
            faces.join(" and ")
        );
        Remark::new("faces", all as f64, text)
    })
}

/// Tension lost under a patch, times h²/F, from which there is a note. The whole tension there is about 2 F/h² in panes.
const LOST_TENSION: f64 = 0.1;

/// Temperature outside the usual range of a shift from which there is a note, K. The limits of the range are not sharp.
const NEAR_RANGE: f64 = 10.0;

/// Temperature from which it may be meant in K, °C.
const LEAST_OF_KELVIN: f64 = 200.0;

/// Advice for a smaller patch; empty if nothing makes it smaller.
fn smaller_patch(scene: &Scene, patch: &Patch) -> &'static str {
    match (patch.reason, &scene.body.geometry) {
        (Reason::Cells, Geometry::Box { .. }) => {
            "; smaller cells at the impact point give a smaller patch: body.grading makes them"
        }
        (Reason::Cells, Geometry::Gmsh(_)) => {
            "; smaller cells at the impact point give a smaller patch: make the mesh finer there"
        }
        (Reason::Scene, _) => "; a smaller contact.patch_radius lowers it",
        (Reason::Area | Reason::Thickness | Reason::Contact | Reason::Surface, _) => "",
    }
}

/// Notes on a scene, with the distribution of its force and its time steps, if these are known. They are not errors, but
/// they may affect the results.
pub fn notes(scene: &Scene, footprint: Option<Footprint>, plan: Option<&Plan>) -> Vec<Remark> {
    let of_disc =
        |note: fn(&Scene, Footprint) -> Option<Remark>| footprint.and_then(|footprint| note(scene, footprint));
    let mut notes: Vec<Remark> = [changed_disc, wide_disc].into_iter().filter_map(of_disc).collect();
    let patch = footprint.and_then(Footprint::patch);
    let mut add = |kind: &str, size: f64, text: String| notes.push(Remark::new(kind, size, text));
    let impactor = &scene.impactor;
    let finer = match scene.body.geometry {
        Geometry::Box { .. } => "body.grading makes cells finer there",
        Geometry::Gmsh(_) => "make the mesh finer there",
    };
    if let Some(patch) = &patch {
        if patch.is_coarse() {
            let text = format!(
                "cells of {:.4} m do not resolve the patch: they should be {:.4} m or smaller at the impact point; {finer}",
                patch.cell,
                0.5 * patch.radius
            );
            add("coarse cells", patch.cell / patch.radius, text);
        }
        if let Some(error) = patch.error().filter(|error| *error > 0.5 * scene.tolerance) {
            let text = format!(
                "the patch is large for a thickness of {:.4} m, which may change the force by about {error:.1e} of its peak{}",
                patch.thickness,
                smaller_patch(scene, patch)
            );
            add("large patch", error, text);
        }
        let lost = patch.tension_lost();
        let is_chosen = patch.reason != Reason::Area;
        if scene.output.stress && is_chosen && matches!(scene.body.geometry, Geometry::Gmsh(_)) && lost > LOST_TENSION {
            let per_newton = lost / patch.thickness.powi(2);
            let text = format!(
                "the tension under the hit is computed for a force spread over a patch of radius {:.4} m. On the opposite face, a small contact causes \
                 up to {per_newton:.1e} Pa per newton more; the estimated error does not include this{}",
                patch.radius,
                smaller_patch(scene, patch)
            );
            add("tension of patch", lost, text);
        }
        if patch.is_critical() {
            let text = format!(
                "on a half-space the contact would outgrow the patch, which takes {:.4e} m: the run stops if it does; a larger \
                 contact.patch_radius avoids that",
                patch.limit_radius
            );
            add("critical patch", 1.0 / patch.limit_radius, text);
        }
    }
    if let Scheme::Newmark { beta, gamma } = scene.time.scheme
        && critical_frequency(beta, gamma) == 0.0
    {
        add("time.gamma", -gamma, "with γ below 1/2 every vibration grows: take time.gamma = 0.5".to_owned());
    }
    let contact = impactor.contact_time();
    if let Some(step) = plan.map(Plan::step).filter(|step| contact < 20.0 * step && *step <= contact) {
        let text = format!(
            "fewer than 20 steps in a contact: its force depends on the step; take a time.step of at most {} s",
            one_digit(0.05 * contact)
        );
        add("few steps", step / contact, text);
    }
    let indentation = impactor.peak_indentation();
    match &impactor.force_law {
        ForceLaw::Hertz(_) => {
            let reason = match impactor.layer_effect {
                LayerEffect::Negligible | LayerEffect::Estimated(_) => None,
                LayerEffect::Untreated(reason) => Some(reason),
                LayerEffect::Law(_) if patch.is_some() => Some("contact.patch_radius is given, or the body is a mesh"),
                LayerEffect::Law(_) if scene.body.model == Theory::HalfSpace => Some("the half-space has no layers"),
                LayerEffect::Law(_) => None,
            };
            if let Some(reason) = reason {
                let text = format!(
                    "the layer that is hit is softer than another, or thin compared with the contact, and Hertz's law of a half-space is \
                     used, with an error that is not estimated: {reason}"
                );
                // Each reason is a kind of its own in a sweep.
                add(reason, 1.0, text);
            }
            if let error @ 1e-3.. = impactor.error_of_law()
                && scene.body.model != Theory::HalfSpace
            {
                let text = format!(
                    "the contact is not small compared with the thickness, and Hertz's law of a half-space is used: estimated error of the \
                     force {error:.1e}"
                );
                add("wide contact", error, text);
            }
            // A free body takes a part of the energy with it.
            let indentation = impactor.force_law.peak_indentation(impactor.timing_mass, impactor.contact_speed());
            if let Some(radius) = impactor.radius.filter(|radius| indentation > 0.1 * radius) {
                let text = format!(
                    "on a half-space the impactor would sink in by {indentation:.2e} m, and Hertz's law holds while that is small against its \
                     radius of {radius} m: check impactor.radius, the moduli, and the speed"
                );
                add("deep indentation", indentation / radius, text);
            }
        }
        ForceLaw::Table(table) if indentation > table.end() => {
            let text = format!(
                "contact.table ends at an indentation of {} m, and a rigid wall would stop the impactor at about {indentation:.3e} m: the run \
                 stops where the table does, so give it more points",
                table.end()
            );
            add("short table", indentation / table.end(), text);
        }
        _ => {}
    }
    let flight = impactor.flight_time();
    if flight > scene.time.end {
        let text = "the impactor does not cross its gap up to time.end: make time.end later, or impactor.gap smaller"
            .to_owned();
        add("wide gap", (flight / scene.time.end).min(f64::MAX), text);
    }
    if let Some((beyond, text)) = scene.body.temperature.and_then(|temperature| extrapolated(scene, temperature)) {
        add("temperature", beyond, text);
    }
    let shifts = scene.body.composition.materials().into_iter().filter_map(|material| material.shift);
    let mut references: Vec<f64> = shifts.map(|shift| shift.reference).collect();
    references.sort_unstable_by(f64::total_cmp);
    references.dedup();
    let references: Vec<String> = references.iter().map(f64::to_string).collect();
    if !references.is_empty() && scene.body.temperature.is_none() {
        let text = format!(
            "body.temperature is not given: relaxation times are those at the reference temperature of wlf, {} °C",
            references.join(" and ")
        );
        add("no temperature", 1.0, text);
    }
    // Bodies that are not reduced have no estimated error of the force.
    if scene.contact == Contact::Point && scene.is_reduced() && scene.body.model != Theory::Kirchhoff {
        let text = "under a point force the displacement of a solid grows without limit as cells get smaller, so that force and stresses depend on the \
                    cells, and the estimated error does not include this; contact.localization = \"patch\" avoids it"
            .to_owned();
        add("point force", 1.0, text);
    }
    if matches!(scene.body.model, Theory::HalfSpace | Theory::InfinitePlate) {
        let name = model::name(scene.body.model);
        if !scene.supports.is_empty() {
            let text = format!(
                "model \"{name}\" has no edges: supports have no effect, and the force lacks the waves that edges reflect"
            );
            add("unused supports", 1.0, text);
        }
        if scene.load != Load::default() {
            add("unused loads", 1.0, format!("model \"{name}\" carries no loads: [load] has no effect on the body"));
        }
    }
    if let Some(key) = unused(scene) {
        let name = model::name(scene.body.model);
        let text = format!("{key} has no effect with model = \"{name}\", which chooses its own; it is for \"solid\"");
        add("unused key", 1.0, text);
    }
    notes
}

/// Note that the radius of the disc differs from `contact.disc_radius`.
fn changed_disc(scene: &Scene, footprint: Footprint) -> Option<Remark> {
    let Contact::Patch { disc: Some(given), radius: patch } = scene.contact else { return None };
    let radius = footprint.disc().filter(|radius| (radius / given - 1.0).abs() > 1e-3)?;
    let why = match patch {
        _ if radius < given => "reaches beyond the nearest edge",
        Some(patch) if radius == patch => "is smaller than contact.patch_radius",
        _ => "would give the contact a negative stiffness",
    };
    let text = format!("contact.disc_radius = {} m {why}; {} m is used instead", short(given), short(radius));
    Some(Remark::new("changed disc", (radius / given - 1.0).abs(), text))
}

/// Note that the disc by `contact.disc_radius` is wide compared with the flexural waves of the contact.
fn wide_disc(scene: &Scene, footprint: Footprint) -> Option<Remark> {
    let Contact::Patch { disc: Some(_), .. } = scene.contact else { return None };
    let radius = footprint.disc()?;
    let phase = phase(scene, radius).filter(|phase| *phase > LARGEST_PHASE)?;
    let text = format!(
        "the disc of contact.disc_radius, {} m, is wide compared with the flexural waves of the contact, and waves under the disc are \
         neglected: the error of the force may be several per cent, and the estimated error does not include this. Up to {} m it is \
         small",
        short(radius),
        short(radius * LARGEST_PHASE / phase)
    );
    Some(Remark::new("wide disc", phase, text))
}

/// Distance of a temperature (°C) from the usual range of a material's shift, K, with the text of a note. `None` in or
/// near the range.
fn extrapolated(scene: &Scene, temperature: f64) -> Option<(f64, String)> {
    let ranges =
        scene.body.composition.materials().into_iter().filter_map(|material| Some(material.shift?.usual_range()));
    let beyond = ranges.map(|[low, high]| ((low - temperature).max(temperature - high), [low, high]));
    let (beyond, [low, high]) =
        beyond.max_by(|one, other| one.0.total_cmp(&other.0)).filter(|(beyond, _)| *beyond > NEAR_RANGE)?;
    let unit = if temperature >= LEAST_OF_KELVIN { "; body.temperature is in °C, not in K" } else { "" };
    let text = format!(
        "WLF's formula usually holds from the glass transition to 100 K above, with the constants given from about {low:.0} to {high:.0} °C: at \
         {temperature} °C the shear modulus is extrapolated; check it against measurements{unit}"
    );
    Some((beyond, text))
}

/// Key that is given for the solid although another theory is named. (The stresses of plates depend on the radius of the
/// patch.)
fn unused(scene: &Scene) -> Option<&'static str> {
    if matches!(scene.body.model, Theory::Auto | Theory::Solid) {
        return None;
    }
    match (&scene.body.geometry, scene.contact) {
        (Geometry::Box { is_given: true, .. }, _) => {
            Some("what is given of cells (body.cells, body.grading or body.order)")
        }
        (_, Contact::Patch { radius: Some(_), .. }) if !scene.output.stress => Some("contact.patch_radius"),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::geometry::tests::pane;
    use super::*;

    /// There is no note if the radius of the disc is as given, or if none is given.
    #[test]
    fn a_changed_radius_of_the_disc_is_noted() {
        let noted = |given: &str, radius: f64| {
            let notes = notes(&pane(&[given]), Some(Footprint::Disc { radius }), None);
            notes.into_iter().find(|note| note.kind == "changed disc").map(|note| note.text)
        };
        let wider = noted("contact.disc_radius=0.01", 0.02).expect("a note");
        assert!(wider.contains("negative stiffness") && wider.contains("0.0200 m is used"), "{wider}");
        let narrower = noted("contact.disc_radius=0.3", 0.25).expect("a note");
        assert!(narrower.contains("nearest edge") && narrower.contains("0.2500 m is used"), "{narrower}");
        assert_eq!(noted("contact.disc_radius=0.01", 0.01), None);
        assert_eq!(noted("output.stress=true", 0.02), None);
    }

    /// A given disc is noted if it is wide compared with the flexural waves; one that is chosen is not.
    #[test]
    fn a_disc_as_wide_as_the_waves_is_noted() {
        let noted = |given: &str, radius: f64| {
            let scene = pane(&[given, "impactor.mass=0.1"]);
            notes(&scene, Some(Footprint::Disc { radius }), None).iter().any(|note| note.kind == "wide disc")
        };
        assert!(noted("contact.disc_radius=0.2", 0.2) && !noted("contact.disc_radius=0.02", 0.02));
        assert!(!noted("output.stress=true", 0.2));
    }

    /// Keys that a theory does not use are noted, and forces at one point in a solid. The radius of the patch changes the
    /// stresses of a plate.
    #[test]
    fn keys_that_a_theory_does_not_use_are_noted() {
        let noted = |overrides: &[&str]| {
            let known = ["unused key", "unused supports", "point force"];
            let all = notes(&pane(overrides), None, None);
            all.into_iter().map(|note| note.kind).filter(|kind| known.contains(&kind.as_str())).collect::<Vec<_>>()
        };
        let patch = "contact.patch_radius=0.01";
        assert!(noted(&[]).is_empty() && noted(&[patch, "body.model=mindlin"]).is_empty());
        assert_eq!(noted(&[patch, "body.model=mindlin", "output.stress=false"]), ["unused key"]);
        assert_eq!(noted(&["body.model=infinite-plate"]), ["unused supports"]);
        assert_eq!(noted(&["contact.localization=point"]), ["point force"]);
        for other in ["body.model=kirchhoff", "time.scheme=newmark"] {
            assert!(noted(&["contact.localization=point", other]).is_empty(), "{other}");
        }
    }
}
