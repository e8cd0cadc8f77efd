//! Reasons why a largest stress has no estimate of its error, and the verdict on the strength.

use crate::scene::{CLEAR_OF_SUPPORTS, Geometry, Impactor, Model, Scene, Vec3};
use crate::space::evaluate::{ContactSize, LEAST_MEAN};

/// Verdict on the strength of a body, with its number in the file of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StrengthVerdict {
    /// The largest stress with its estimated error is below the strength.
    NotExceeded = 0,
    /// The largest stress reaches the strength.
    Exceeded = 1,
    /// The largest stress is below the strength, but its error has no estimate or may make up the difference.
    Undecided = 2,
}

impl StrengthVerdict {
    /// Verdict on a stress and a strength in the same unit. `error_estimate` is the estimated error of the stress divided
    /// by the stress; NaN without an estimate.
    pub fn of(stress: f64, strength: f64, error_estimate: f64) -> Self {
        if stress >= strength {
            Self::Exceeded
        } else if stress + error_estimate * stress.abs() < strength {
            Self::NotExceeded
        } else {
            // NaN is neither.
            Self::Undecided
        }
    }

    /// Number in the file of a sweep.
    pub fn number(self) -> f64 {
        f64::from(self as u8)
    }

    /// Text for files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exceeded => "exceeded",
            Self::NotExceeded => "not exceeded",
            Self::Undecided => "undecided",
        }
    }
}

/// Reason why a largest stress at a place (m) has no estimate of its error, as a clause; `None` if `error` is one.
pub(super) fn why_without_estimate(scene: &Scene, point: Vec3, error: f64, has_contact: bool) -> Option<String> {
    if scene.is_at_clamped_edge(point) {
        return Some("it is at a clamped edge, where the tension of a solid grows as cells get smaller".to_owned());
    }
    if !has_contact {
        return Some("there was no contact, and errors of tensions are estimated only for runs with one".to_owned());
    }
    why_hit_without_estimate(scene).or_else(|| error.is_nan().then(|| why_body_without_estimate(scene)))
}

/// Reason why the place of the hit leaves no estimate, whatever the model.
fn why_hit_without_estimate(scene: &Scene) -> Option<String> {
    if let Some(distance) = scene.hit_near_clamped_edge() {
        return Some(format!(
            "the hit is {distance:.2} thicknesses from a clamped edge, where a tension may be larger"
        ));
    }
    let [radius, distance] = contact_beyond_edge(scene)?;
    Some(format!(
        "the contact has a radius of up to {:.2} mm, and an edge cuts it at {:.2} mm",
        1e3 * radius,
        1e3 * distance
    ))
}

/// Radius of the contact (m) at the peak of an impact on a body that does not deflect, and the distance of the impact
/// point from the nearest edge (m), if the edge cuts the contact.
pub fn contact_beyond_edge(scene: &Scene) -> Option<[f64; 2]> {
    if scene.contact.area().is_some() {
        // A given area is within the face.
        return None;
    }
    let Impactor { radius: curvature, .. } = scene.impactor;
    let layered = scene.impactor.layered_contact().cloned();
    let radius = ContactSize { curvature, given: 0.0, layered }.at_peak(&scene.impactor);
    scene.distance_to_edge().filter(|distance| *distance < radius).map(|distance| [radius, distance])
}

/// Reason why stresses of the body have no estimate.
fn why_body_without_estimate(scene: &Scene) -> String {
    let Geometry::Box { size, is_given, .. } = &scene.body.geometry else {
        return "the body is a mesh from a file, and the local stresses under the contact, up to 30% of the tension there, are not added"
            .to_owned();
    };
    let thickness = scene.struck_axis().map_or(f64::NAN, |struck| scene.body.struck_thickness(size[struck]));
    let distance = scene.distance_to_edge().unwrap_or(f64::NAN) / thickness;
    // Plates have the local field whatever supports them.
    let may_be_solid = scene.body.model == Model::Solid || scene.body.model == Model::Auto && scene.time.modal;
    let is_free = if *is_given { !scene.has_support_across() } else { scene.is_free_layer(CLEAR_OF_SUPPORTS) };
    if !scene.is_free_layer(0.0) {
        "the hit is oblique, and the local stresses under the contact are not added then".to_owned()
    } else if may_be_solid && !is_free {
        "a support is on the face that is hit or on the one opposite, and the local stresses under the contact are not added then"
            .to_owned()
    } else if distance < LEAST_MEAN {
        format!("the hit is {distance:.2} thicknesses of the impacted layer from an edge, too near for an estimate")
    } else if *is_given {
        "the error of the stresses of a mesh is not estimated".to_owned()
    } else {
        "only plates and spline solids in modal coordinates have an estimate; meshes have none, and in a sweep neither have members \
         whose basis was made for other supports or another temperature"
            .to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::StrengthVerdict::{self, Exceeded, NotExceeded, Undecided};

    #[test]
    fn a_strength_is_not_exceeded_only_with_an_estimate_that_leaves_room() {
        for (stress, error, verdict) in [
            (0.9, 0.1, NotExceeded),
            (0.9, 0.12, Undecided),
            (0.9, f64::NAN, Undecided),
            (0.9, f64::INFINITY, Undecided),
            (f64::NAN, 0.1, Undecided),
            (1.0, f64::NAN, Exceeded),
            (1.1, 0.5, Exceeded),
            (-0.5, 0.1, NotExceeded),
            // The error of a compression is a part of its magnitude.
            (-0.5, 3.0, Undecided),
        ] {
            assert_eq!(StrengthVerdict::of(stress, 1.0, error), verdict, "{stress} {error}");
        }
    }
}
