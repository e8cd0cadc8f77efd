//! Checks the impactor: mass, radius, speed, impact point, direction and contact stiffness.

use std::ops::Bound;

use super::super::impactor::HEAVIEST;
use super::super::values::{Number, SurfacePoint, Three};
use super::super::{Composition, Impactor, STANDARD_GRAVITY, SceneError, Source, Vec3, faces, raw};
use super::body::Outline;
use super::contact;
use super::numbers::show;
use crate::contact::{ForceLaw, Hertz, LayerEffect, hertz};
use crate::form;

pub(super) fn check(
    source: &Source,
    (raw, contact): (&raw::Impactor, &raw::Contact),
    composition: &Composition,
    outline: &Outline,
    of_body: Vec3,
) -> Result<Impactor, SceneError> {
    let mass = source.positive("impactor.mass", raw.mass.0, "the mass m0 in kg")?;
    let radius = |Number(radius)| source.positive("impactor.radius", radius, "the radius R of the rounded end in m");
    let radius = raw.radius.map(radius).transpose()?;
    let Number(gap) = raw.gap.unwrap_or(Number(0.0));
    source.not_negative("impactor.gap", [gap; 3], "a distance in m, 0 or more")?;
    let direction = raw.direction.map_or([0.0, 0.0, -1.0], Three::numbers);
    let direction = source.unit("impactor.direction", direction)?;
    // Avoids −0 if the weight acts perpendicular to the direction.
    let gravity = if raw.gravity == Some(true) { 0.0 - STANDARD_GRAVITY * direction[2] } else { 0.0 };
    let of_body: f64 = of_body.iter().zip(direction).map(|(a, d)| a * d).sum();
    let closing = gravity - of_body;
    let speed = speed(source, raw, closing * gap > 0.0)?;
    elastic_constants(source, raw)?;
    let law = contact::law(source, contact, raw)?;
    let stiffness = if law.is_some() { 0.0 } else { stiffness(source, raw, &composition.struck, radius)? };
    let body_mass = match outline {
        Outline::Box(size) => {
            composition.density().map_or(f64::INFINITY, |density| density * size.iter().product::<f64>())
        }
        Outline::Gmsh(_) => f64::INFINITY,
    };
    let mut impactor = Impactor {
        mass,
        radius,
        stiffness,
        force_law: law.unwrap_or(ForceLaw::Hertz(Hertz { stiffness })),
        layer_effect: LayerEffect::Negligible,
        damping: 0.0,
        speed,
        point: point(source, raw, outline, direction)?,
        direction,
        gap,
        gravity,
        closing,
        timing_mass: mass.min(HEAVIEST * body_mass),
    };
    let hit = impactor.hit_speed();
    contact::check_capacity(source, &impactor.force_law, 0.5 * mass * hit * hit)?;
    impactor.damping = contact::damping(source, contact, hit)?;
    if !matches!(impactor.force_law, ForceLaw::Hertz(_)) {
        let (time, mass, speed) = (impactor.contact_time(), impactor.timing_mass, impactor.contact_speed());
        impactor.stiffness = hertz::stiffness_of_contact_time(time, mass, speed);
    }
    Ok(impactor)
}

/// Given speed, or the speed after a free fall from a height h: v² = 2 g h. In m/s.
/// An impactor that `falls` through a gap may start from rest.
fn speed(source: &Source, raw: &raw::Impactor, falls: bool) -> Result<f64, SceneError> {
    match (raw.speed, raw.drop_height) {
        (Some(Number(0.0)), None) if falls => Ok(0.0),
        (Some(Number(speed)), None) => {
            source.positive("impactor.speed", speed, "the speed in m/s at t = 0; `direction` says which way")
        }
        (None, Some(Number(height))) => {
            let height = source.positive("impactor.drop_height", height, "the height in m of a free fall from rest")?;
            Ok((2.0 * STANDARD_GRAVITY * height).sqrt())
        }
        (None, None) => Err(source.required("impactor.speed", "a speed in m/s, or `drop_height` in m")),
        (Some(_), Some(_)) => {
            let help = "take one of the two out; a sweep or --set can vary the one that the scene gives".into();
            let message = "the speed is given twice".into();
            Err(source.conflict("impactor.drop_height", "impactor.speed", message, help))
        }
    }
}

/// Checks the elastic constants that are given, also if they are not used.
fn elastic_constants(source: &Source, raw: &raw::Impactor) -> Result<(), SceneError> {
    if let Some(Number(young)) = raw.young {
        source.positive("impactor.young", young, "Young's modulus in Pa")?;
    }
    if let Some(Number(poisson)) = raw.poisson {
        let range = (Bound::Excluded(-1.0), Bound::Included(0.5));
        source.in_range("impactor.poisson", poisson, range, "above -1 and at most 0.5")?;
    }
    Ok(())
}

/// Contact stiffness of Hertz's law: given, or computed by (15). In N/m^1.5.
fn stiffness(
    source: &Source,
    raw: &raw::Impactor,
    struck: &form::Material,
    radius: Option<f64>,
) -> Result<f64, SceneError> {
    let Some(radius) = radius else {
        let help = "the radius R of the rounded end in m";
        return Err(source.required("impactor.radius", help));
    };
    if let Some(Number(stiffness)) = raw.stiffness {
        let help = "the contact stiffness k0 in N/m^1.5; left out, it follows from (15)";
        return source.positive("impactor.stiffness", stiffness, help);
    }
    let required = |key: &str| {
        let help = "give `young` and `poisson` for (15), or the contact stiffness itself as `stiffness`";
        source.required(&format!("impactor.{key}"), help)
    };
    let Number(young) = raw.young.ok_or_else(|| required("young"))?;
    let Number(poisson) = raw.poisson.ok_or_else(|| required("poisson"))?;
    let value = hertz::stiffness(radius, (struck.young, struck.poisson), (young, poisson));
    if value.is_finite() && value > 0.0 {
        return Ok(value);
    }
    Err(source.error(
        "impactor.young",
        format!("the contact stiffness (15) comes out as {value}"),
        "see that young and radius are in Pa and m, or give `stiffness` itself",
    ))
}

/// Impact point of a box, m. Two given numbers are the coordinates along the face that is hit, axes ascending; without a
/// point it is the centre of that face. The direction need not be a unit vector.
pub(super) fn point_of_box(raw: &raw::Impactor, size: Vec3, direction: Vec3) -> Vec3 {
    let mut centre = faces::struck_centre(size, direction);
    match raw.point {
        Some(SurfacePoint::All(point)) => point,
        Some(SurfacePoint::AlongFace(along)) => {
            for (axis, x) in faces::along(faces::across(direction)).into_iter().zip(along) {
                centre[axis] = x;
            }
            centre
        }
        None => centre,
    }
}

fn point(source: &Source, raw: &raw::Impactor, outline: &Outline, direction: Vec3) -> Result<Vec3, SceneError> {
    let path = "impactor.point";
    match &raw.point {
        Some(SurfacePoint::All(point)) => source.finite(path, point)?,
        Some(SurfacePoint::AlongFace(point)) => source.finite(path, point)?,
        None => {}
    }
    let size = match (outline, raw.point) {
        (Outline::Box(size), Some(_)) => *size,
        (Outline::Box(size), None) => return Ok(faces::struck_centre(*size, direction)),
        (Outline::Gmsh(_), Some(SurfacePoint::All(point))) => return Ok(point),
        (Outline::Gmsh(_), given) => {
            let message = match given {
                Some(_) => "two numbers are a point on a face of a box, and the body is a mesh file",
                None => "a body from a mesh file needs this key",
            };
            return Err(source.error(path, message, "`point = [x, y, z]` in m on the surface of the mesh"));
        }
    };
    let point = point_of_box(raw, size, direction);
    let off = faces::distance(size, point);
    if off > faces::tolerance(size) {
        let [x, y, z] = size.map(|edge| show(edge / 2.0));
        let message = format!("the impact point is {off:.2e} m away from the body's surface");
        let help = format!("the faces of the box are at x = ±{x}, y = ±{y} and z = ±{z}");
        return Err(source.error(path, message, help));
    }
    if !faces::leads_inside(size, point, direction) {
        let key = if raw.direction.is_some() { "impactor.direction" } else { path };
        let [x, y, z] = direction.map(show);
        let message = format!("the impactor moves along [{x}, {y}, {z}], which does not lead into the body here");
        let help = "a direction against the outward normal of the face at the impact point, 1° or more from the face";
        return Err(source.error(key, message, help));
    }
    Ok(faces::snap(size, point))
}
