//! Checks the contact: where its force acts, and the force law.

use super::super::values::{FileOrPoints, Number};
use super::super::{
    CLEAR_OF_SUPPORTS, Composition, Contact, Impactor, Parts, SceneError, Source, Support, Vec3, faces, leave_free, raw,
};
use super::body::Outline;
use super::numbers::show;
use super::{table, word};
use crate::contact::{ForceLaw, HitOnLayers, LayerEffect, Power, Table};
use crate::form::{AreaShape, ContactArea};

/// Smallest part of the impactor's energy that a table must be able to absorb.
const LEAST_CAPACITY: f64 = 0.01;

/// Expected contents of a table file.
const HELP_OF_TABLE: &str = "lines of indentation in m and force in N, from 0, 0 on: neither may fall";

/// Largest damping d times impact speed. Beyond it the impactor would practically stick: at this value less than a
/// twentieth of its speed is left.
const LARGEST_DAMPING: f64 = 100.0;

/// Largest exponent of a power law. Laws with a larger one act like a rigid wall.
const LARGEST_EXPONENT: f64 = 10.0;

/// Localisation of the contact force: a patch, a given area or a point.
///
/// # Errors
/// If a radius is not positive, if a point force has one, or if an area is not wholly on the face of a box.
pub(super) fn localization(
    source: &Source,
    raw: &raw::Contact,
    at: (&Outline, &Impactor),
) -> Result<Contact, SceneError> {
    let kind = word(source, "contact.localization", &raw.localization, &raw::LOCALIZATIONS)?;
    let radii = [
        ("contact.patch_radius", raw.patch_radius, "the radius of the patch in m; left out, it is chosen"),
        ("contact.disc_radius", raw.disc_radius, "the radius of the disc in m; left out, it is chosen"),
    ];
    if let Some(given) = &raw.area {
        let other = radii.iter().find(|(_, radius, _)| radius.is_some()).map(|(path, ..)| *path);
        if let Some(path) = other.or((kind != "patch").then_some("contact.localization")) {
            let message = "a given area takes the place of a patch, its disc or a point".into();
            return Err(source.conflict(path, "contact.area", message, "take one of them out".into()));
        }
        return Ok(Contact::Area(area(source, given, raw, at)?));
    }
    if raw.pressure.is_some() {
        word(source, "contact.pressure", &raw.pressure, &raw::PRESSURES)?;
        let help = "`area = { square = 0.2 }` or `area = { radius = 0.1 }`, in m";
        return Err(source.error("contact.pressure", "it is the pressure on contact.area, which is missing", help));
    }
    if kind != "patch" {
        let Some((path, ..)) = radii.iter().find(|(_, radius, _)| radius.is_some()) else { return Ok(Contact::Point) };
        let help = "take it out, or `localization = \"patch\"`".into();
        return Err(source.conflict(path, "contact.localization", "a point has no radius".into(), help));
    }
    let mut given = [None; 2];
    for (given, (path, radius, help)) in given.iter_mut().zip(radii) {
        *given = radius.map(|Number(radius)| source.positive(path, radius, help)).transpose()?;
    }
    let [radius, disc] = given;
    Ok(Contact::Patch { radius, disc })
}

/// Area of the surface on which a contact presses.
fn area(
    source: &Source,
    given: &raw::Area,
    raw: &raw::Contact,
    (outline, impactor): (&Outline, &Impactor),
) -> Result<ContactArea, SceneError> {
    if matches!(impactor.force_law, ForceLaw::Hertz(_)) {
        let message = "Hertz's law has an area of its own, which grows with the force".into();
        let help = "take it out, or give a law: \"power\" or \"table\"".into();
        return Err(source.conflict("contact.area", "contact.law", message, help));
    }
    let key = "contact.pressure";
    let is_even = word(source, key, &raw.pressure, &raw::PRESSURES)? == "even";
    let (path, width, shape) = match (given.square, given.radius) {
        (Some(_), None) if !is_even => {
            return Err(source.error(
                key,
                "Hertz's pressure is on a disc",
                "`radius` in place of `square`, or \"even\"",
            ));
        }
        (Some(Number(side)), None) => ("contact.area.square", 0.5 * side, AreaShape::EvenSquare),
        (None, Some(Number(radius))) if is_even => ("contact.area.radius", radius, AreaShape::EvenDisc),
        (None, Some(Number(radius))) => ("contact.area.radius", radius, AreaShape::HertzDisc),
        _ => return Err(source.error("contact.area", "an area is given in one way", "one of `square` and `radius`")),
    };
    let half_width = source.positive(path, width, "the side of a square, or the radius of a disc, in m")?;
    if let Outline::Box(size) = outline {
        let struck = faces::struck_axis(*size, impactor.point, impactor.direction);
        let room = (0..3).filter(|axis| *axis != struck).map(|axis| 0.5 * size[axis] - impactor.point[axis].abs());
        let room = room.fold(f64::INFINITY, f64::min);
        if half_width > room * (1.0 + 1e-9) {
            let message = format!(
                "the area reaches {} m from the impact point, and the edge of the surface is {} m away",
                show(half_width),
                show(room)
            );
            return Err(source.error(path, message, "a smaller area, or an impact point farther from the edge"));
        }
    }
    Ok(ContactArea { shape, half_width })
}

/// Force law other than Hertz's; `None` for Hertz's law.
///
/// # Errors
/// If keys of another law are given, a number is out of range, or the table is not valid.
pub(super) fn law(
    source: &Source,
    raw: &raw::Contact,
    impactor: &raw::Impactor,
) -> Result<Option<ForceLaw>, SceneError> {
    let kind = word(source, "contact.law", &raw.law, &raw::LAWS)?;
    let given = [
        ("stiffness", "power", raw.stiffness.is_some()),
        ("exponent", "power", raw.exponent.is_some()),
        ("table", "table", raw.table.is_some()),
    ];
    if let Some((key, of, _)) = given.iter().find(|(_, of, is_given)| *is_given && *of != kind) {
        let hint = if *key == "stiffness" { "; Hertz's k0 is `impactor.stiffness`" } else { "" };
        let help = format!("take it out, or `law = \"{of}\"`{hint}");
        let message = format!("the law \"{kind}\" has no {key}");
        return Err(source.conflict(&format!("contact.{key}"), "contact.law", message, help));
    }
    if kind != "hertz" && impactor.stiffness.is_some() {
        let help = "take it out: `contact` has the law's numbers".into();
        let message = format!("this is Hertz's k0, and the law is \"{kind}\"");
        return Err(source.conflict("impactor.stiffness", "contact.law", message, help));
    }
    match kind {
        "hertz" => Ok(None),
        "power" => power(source, raw).map(Some),
        _ => Ok(Some(ForceLaw::Table(points(source, raw)?))),
    }
}

fn power(source: &Source, raw: &raw::Contact) -> Result<ForceLaw, SceneError> {
    let required = |key: &str, help: &str| source.required(&format!("contact.{key}"), help);
    let help = "the exponent of the indentation, 1 or more";
    let Number(exponent) = raw.exponent.ok_or_else(|| required("exponent", help))?;
    if !(1.0..=LARGEST_EXPONENT).contains(&exponent) {
        let message = format!("{} is out of range", show(exponent));
        return Err(source.error("contact.exponent", message, format!("from 1 to {LARGEST_EXPONENT}")));
    }
    let help = "the force in N at an indentation of 1 m";
    let Number(stiffness) = raw.stiffness.ok_or_else(|| required("stiffness", help))?;
    let stiffness = source.positive("contact.stiffness", stiffness, help)?;
    Ok(ForceLaw::Power(Power { stiffness, exponent }))
}

/// Points of a table file, written as a TOML array.
///
/// # Errors
/// If the file cannot be read.
pub fn table_in_file(source: &Source, file: &str) -> Result<String, SceneError> {
    let points = table::read(&source.folder().join(file))
        .map_err(|message| source.error("contact.table", message, HELP_OF_TABLE))?;
    let each: Vec<String> = points.iter().map(|[x, y]| format!("[{x:?}, {y:?}]")).collect();
    Ok(format!("[{}]", each.join(", ")))
}

fn points(source: &Source, raw: &raw::Contact) -> Result<Table, SceneError> {
    let path = "contact.table";
    let wrong = |message: String| source.error(path, message, HELP_OF_TABLE);
    let points = match &raw.table {
        None => return Err(source.required(path, "a file with columns indentation (m) and force (N)")),
        Some(FileOrPoints::Points(points)) => points.clone(),
        Some(FileOrPoints::File(name)) => table::read(&source.folder().join(name)).map_err(wrong)?,
    };
    Table::new(&points).map_err(wrong)
}

/// Effect of the layers of a box on the contact.
pub(super) fn layer_effect(
    size: Vec3,
    composition: &Composition,
    supports: &[Support],
    impactor: &Impactor,
    contact: Contact,
) -> LayerEffect {
    let Impactor { point, direction, radius, timing_mass, .. } = *impactor;
    if contact == Contact::Point || !matches!(impactor.force_law, ForceLaw::Hertz(_)) {
        return LayerEffect::Negligible;
    }
    let axis = faces::struck_axis(size, point, direction);
    let room = [0, 1].map(|axis| 0.5 * size[axis] - point[axis].abs());
    let hit = HitOnLayers {
        blow: impactor.blow(),
        timing_mass,
        radius,
        is_free: leave_free(supports, (size, point, axis), CLEAR_OF_SUPPORTS),
        longest_edge: size[0].max(size[1]),
        room: room[0].min(room[1]),
        disc: if let Contact::Patch { disc, .. } = contact { disc } else { None },
    };
    if composition.uniform().is_some() {
        let error = hit.error_on_layer(size[axis], &composition.struck);
        return error.map_or(LayerEffect::Negligible, LayerEffect::Estimated);
    }
    let is_normal = (direction[2].abs() - 1.0).abs() < 1e-9;
    if !is_normal || !matches!(composition.parts, Parts::Layers(_)) {
        return LayerEffect::Negligible;
    }
    let mut layers = composition.across(2, size[2]);
    if direction[2] > 0.0 {
        layers.reverse();
    }
    hit.on_layers(&layers)
}

/// Damping d of Hunt and Crossley's factor, s/m.
///
/// # Errors
/// If the number is out of range.
pub(super) fn damping(source: &Source, raw: &raw::Contact, speed: f64) -> Result<f64, SceneError> {
    let Number(damping) = raw.damping.unwrap_or(Number(0.0));
    let help = "a number in s/m, 0 or more: about 1.5 times the part of the speed that is lost, over the speed";
    source.not_negative("contact.damping", [damping; 3], help)?;
    if damping * speed > LARGEST_DAMPING {
        let message = format!(
            "at {} m/s the first touch would take {} times the law's force",
            show(speed),
            show(damping * speed)
        );
        return Err(source.error("contact.damping", message, help));
    }
    Ok(damping)
}

/// Refuses a table that cannot absorb the energy (J) of the impactor: its units are probably wrong.
///
/// # Errors
/// If the capacity of the table is below [`LEAST_CAPACITY`] times the energy.
pub(super) fn check_capacity(source: &Source, law: &ForceLaw, energy: f64) -> Result<(), SceneError> {
    let ForceLaw::Table(table) = law else { return Ok(()) };
    if table.capacity() >= LEAST_CAPACITY * energy {
        return Ok(());
    }
    let message =
        format!("the table takes {:.3e} J up to its end, and the impactor has {energy:.3e} J", table.capacity());
    Err(source.error(
        "contact.table",
        message,
        "indentation in m and force in N, up to the largest that the impact reaches",
    ))
}
