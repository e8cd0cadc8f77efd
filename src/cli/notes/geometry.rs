//! Warnings about the geometry of a body, its supports, its surface at the impact point, and the law of its contact.

use crate::contact::ForceLaw;
use crate::mesh::Measures;
use crate::record::stress::contact_beyond_edge;
use crate::scene::{Contact, Geometry, Impactor, Model as Theory, STANDARD_GRAVITY, Scene};

use super::Remark;

/// Smallest part of a table that an impact is expected to use. A smaller part suggests units that differ by a factor of
/// a thousand.
const LEAST_OF_TABLE: f64 = 0.01;

/// Peak force of the impactor on a rigid wall over its weight, below which the contact law is doubtful.
const LEAST_OVER_WEIGHT: f64 = 0.1;

/// Sine of the angle between the direction of the impactor and the face that is hit, below which the direction is doubtful.
const LEAST_STEEPNESS: f64 = 0.1;

/// Curvature of the surface times the radius of the impactor, above which it is told: the peak force on a rigid body changes by
/// a fifth of this product.
const CURVED: f64 = 0.02;

/// Part of the boundary that named surfaces must have where a strength is given; the rest is rounding of sums.
const LEAST_NAMED: f64 = 0.999;

/// Diagonal of a body above which its lengths look like millimetres, m; the next limit must be exceeded too.
const LONG_DIAGONAL: f64 = 20.0;

/// Diagonal of a body over the radius of the impactor above which its lengths look like millimetres.
const LONG_FOR_RADIUS: f64 = 200.0;

/// Warning for a hit at a distance (divided by the thickness) from a clamped edge at which the tension there may govern.
fn near_clamped_edge(distance: f64) -> String {
    format!(
        "the hit is {distance:.2} thicknesses from a clamped edge, and the tension at that edge may be the largest: a plate's tension there is as \
         little as half of a solid's, which grows as cells get smaller; the error of the largest tension is therefore not estimated"
    )
}

/// Warning for a box whose tensions under the hit are those of a point force, because the scene does not give the size of
/// the contact.
fn tension_of_point_force(scene: &Scene) -> Option<String> {
    let is_box = matches!(scene.body.geometry, Geometry::Box { .. });
    let has_faces = !matches!(scene.body.model, Theory::HalfSpace | Theory::InfinitePlate);
    let has_radius = scene.impactor.radius.is_some() || matches!(scene.contact, Contact::Patch { radius: Some(_), .. });
    let is_spread = matches!(scene.contact, Contact::Patch { .. });
    (is_box && has_faces && scene.output.stress && is_spread && !has_radius).then(|| {
        "the impactor has no radius: tensions under it are computed for a point force. For a soft or wide impactor they are too large, and the \
         estimated error does not include this; give impactor.radius"
            .to_owned()
    })
}

/// Sine of the angle between the impactor's direction and the face that is hit; `None` for a mesh that is not read.
fn steepness(scene: &Scene, measures: Option<&Measures>) -> Option<f64> {
    let Geometry::Box { size, .. } = scene.body.geometry else { return measures.map(|measures| measures.steepness) };
    let Impactor { point, direction, .. } = &scene.impactor;
    // On an edge of the box, the face that is hit at the larger angle.
    let is_on_face = |axis: &usize| point[*axis].abs() > 0.5 * (1.0 - 1e-9) * size[*axis];
    (0..3).filter(is_on_face).map(|axis| -direction[axis] * point[axis].signum()).reduce(f64::max)
}

/// Warnings about the geometry of a body, its supports, the size of the contact, or the table of the contact law.
pub fn of_geometry(scene: &Scene, measures: Option<&Measures>) -> Vec<Remark> {
    let mut warnings = Vec::new();
    let mut add = |kind: &str, size: f64, text: String| warnings.push(Remark::new(kind, size, text));
    let edges = match (&scene.body.geometry, measures) {
        (Geometry::Box { size, .. }, _) => *size,
        (_, Some(Measures { bounds: [least, largest], .. })) => [0, 1, 2].map(|i| largest[i] - least[i]),
        _ => [0.0; 3],
    };
    let diagonal = edges.iter().map(|edge| edge * edge).sum::<f64>().sqrt();
    if diagonal > LONG_DIAGONAL && diagonal > LONG_FOR_RADIUS * scene.impactor.radius.unwrap_or_default() {
        let text = format!(
            "the body has a diagonal of {diagonal:.4} m: lengths are in metres, and these look like millimetres"
        );
        add("long body", diagonal, text);
    }
    let indentation = scene.impactor.peak_indentation();
    if let ForceLaw::Table(table) = &scene.impactor.force_law
        && indentation < LEAST_OF_TABLE * table.end()
    {
        let end = table.end();
        let text = format!(
            "a rigid wall would stop the impactor at an indentation of {indentation:.3e} m, and contact.table goes to {end} m: is the \
             table in m and N?"
        );
        add("units of a table", end / indentation, text);
    }
    let (impactor, weight) = (&scene.impactor, STANDARD_GRAVITY * scene.impactor.mass);
    let force = impactor.force_law.force(indentation);
    if matches!(impactor.force_law, ForceLaw::Table(_) | ForceLaw::Power(_)) && force < LEAST_OVER_WEIGHT * weight {
        let text = format!(
            "a rigid wall would stop the impactor with a force of {force:.2e} N, which is far below its weight of {weight:.2e} N: is the \
             contact law in m and N?"
        );
        add("units of a law", weight / force, text);
    }
    if scene.output.stress
        && let Some(distance) = scene.hit_near_clamped_edge()
    {
        add("near clamped edge", 1.0 / distance.max(f64::MIN_POSITIVE), near_clamped_edge(distance));
    }
    if let Some([radius, distance]) = contact_beyond_edge(scene) {
        let text = format!(
            "on a body that does not deflect, the contact would have a radius of {radius:.2e} m, and the nearest edge of the face that is hit is \
             {distance:.2e} m away: the contact law holds for contacts that no edge cuts off"
        );
        add("contact at an edge", radius / distance, text);
    }
    if let Some(text) = tension_of_point_force(scene) {
        add("no radius", 1.0, text);
    }
    if let Some(steepness) = steepness(scene, measures).filter(|steepness| *steepness < LEAST_STEEPNESS) {
        let angle = steepness.clamp(-1.0, 1.0).asin().to_degrees();
        let text = format!(
            "impactor.direction is {angle:.1} degrees from the plane of the face that is hit. The force acts along this direction, but without \
             friction it acts along the normal: give the normal as the direction, and the speed along it"
        );
        add("grazing direction", 1.0 / steepness.max(f64::MIN_POSITIVE), text);
    }
    let Some(measures) = measures else { return warnings };
    if let Some(radius) = scene.impactor.radius
        && matches!(scene.impactor.force_law, ForceLaw::Hertz(_))
        && (radius * measures.curvature).abs() > CURVED
    {
        let (mean, both) = (1.0 / measures.curvature, 1.0 / (1.0 / radius + measures.curvature));
        let what = if mean > 0.0 { "convex" } else { "concave" };
        let advice = match both > 0.0 {
            true => format!(
                "if impactor.radius is that of the impactor alone, give the effective radius {both:.4} = 1/(1/{radius} + 1/{mean:.4})"
            ),
            false => "the impactor does not fit into it, and Hertz's law does not hold".to_owned(),
        };
        let text = format!(
            "the surface is {what} at the impact point, with a mean radius of curvature of about {:.4} m, and Hertz's law assumes a plane: \
             {advice}",
            mean.abs()
        );
        add("curved surface", (radius * measures.curvature).abs(), text);
    }
    for (name, reason) in &measures.unusable {
        add("unusable surface", 1.0, format!("the surface {name:?} {reason}: no stresses are read on it"));
    }
    let named: f64 = measures.surfaces.iter().map(|surface| surface.area).sum();
    if scene.strength.is_given() && named < LEAST_NAMED * measures.area {
        let text = format!(
            "stresses are read on the named surfaces alone, which have {named:.4} m2 of {:.4} m2: a larger tension elsewhere is not judged",
            measures.area
        );
        add("unnamed boundary", measures.area / named.max(f64::MIN_POSITIVE), text);
    }
    if measures.parts > 1 {
        let text = format!(
            "the mesh has {} parts that share no node: only the one that is hit feels the impact, and parts without supports float freely; \
             make them one in Gmsh (Coherence)",
            measures.parts
        );
        add("parts", measures.parts as f64, text);
    }
    if measures.open_faces > 0 {
        let text = format!(
            "{} faces of the mesh lie on others without sharing their nodes, so that the body is open there: merge the nodes in Gmsh (Coherence \
             Mesh), unless a crack is meant",
            2 * measures.open_faces
        );
        add("open faces", measures.open_faces as f64, text);
    }
    let of_whole_surfaces = scene.supports.iter().enumerate().filter(|(_, support)| support.within.is_none());
    for (number, support) in of_whole_surfaces {
        let covered = measures.surfaces.iter().find(|surface| surface.name == support.surface);
        // Tolerance: rounding of sums.
        if covered.is_some_and(|surface| surface.area > 0.999_999 * measures.area) {
            let text = format!(
                "support.{number} holds the whole boundary, the impact point included: is {:?} the surface that was meant?",
                support.surface
            );
            add("whole boundary", 1.0, text);
        }
    }
    warnings
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A pane that is hit by an impactor without a radius.
    const PANE: &str = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.8, 0.5, 0.012]\n\
         [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\n\
         [impactor]\nmass = 1.0\nspeed = 3.0\n[contact]\nlaw = \"power\"\nstiffness = 1e6\nexponent = 1\n[time]\nend = 0.008\n";

    /// The scene [`PANE`] with overrides.
    pub fn pane(overrides: &[&str]) -> Scene {
        let overrides: Vec<String> = overrides.iter().map(|text| (*text).to_owned()).collect();
        Scene::parse("scene", PANE, &overrides).expect("a scene").0
    }

    fn is_noted(kind: &str, overrides: &[&str]) -> bool {
        of_geometry(&pane(overrides), None).iter().any(|warning| warning.kind == kind)
    }

    /// A contact radius larger than the distance to the nearest edge gives a warning. With F = k α, the indentation at a wall
    /// is v √(m/k) = 3 mm, and √(R α) = 9.5 mm.
    #[test]
    fn a_contact_that_an_edge_cuts_off_is_noted() {
        let is_cut = |x: f64| {
            let point = format!("impactor.point=[{x},0.1,0.006]");
            is_noted("contact at an edge", &["impactor.radius=0.03", &point])
        };
        assert!(is_cut(0.391) && !is_cut(0.39));
    }

    /// A table in mm and kN has forces far below the weight of the impactor; a direction along the face is no impact.
    #[test]
    fn units_of_a_law_and_a_grazing_direction_are_noted() {
        let table = |points: &str| {
            let table = format!("contact.table={points}");
            is_noted("units of a law", &["contact={}", "contact.law=table", &table])
        };
        assert!(table("[[0,0],[100,4]]") && !table("[[0,0],[0.1,4000]]"));
        let along = |direction: &str| {
            let direction = format!("impactor.direction={direction}");
            is_noted("grazing direction", &["impactor.point=[0,0,0.006]", &direction])
        };
        assert!(along("[1,0,-0.05]") && !along("[1,0,-0.2]") && !along("[0,0,-1]"));
    }

    /// Without the size of the contact, tensions are those of a force at one point. Either radius gives the size.
    #[test]
    fn a_contact_without_size_is_warned_of() {
        assert!(is_noted("no radius", &[]));
        for key in ["impactor.radius=0.05", "contact.patch_radius=0.01", "output.stress=false"] {
            assert!(!is_noted("no radius", &[key]), "{key}");
        }
    }
}
