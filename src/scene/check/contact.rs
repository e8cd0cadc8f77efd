//! Checks the contact: where its force acts, and the force law.

use super::super::values::{FileOrPoints, Number};
use super::super::{Contact, SceneError, Source, raw};
use super::numbers::show;
use super::{table, word};
use crate::contact::{ForceLaw, Power, Table};

/// Smallest part of the impactor's energy that a table must be able to absorb.
const LEAST_CAPACITY: f64 = 0.01;

/// Expected contents of a table file.
const HELP_OF_TABLE: &str = "lines of indentation in m and force in N, from 0, 0 on: neither may fall";

/// Largest damping d times impact speed. Beyond it the impactor would practically stick: at this value less than a
/// twentieth of its speed is left.
const LARGEST_DAMPING: f64 = 100.0;

/// Largest exponent of a power law. Laws with a larger one act like a rigid wall.
const LARGEST_EXPONENT: f64 = 10.0;

/// Localisation of the contact force: a patch or a point.
///
/// # Errors
/// If a radius is not positive, or if a point force has one.
pub(super) fn localization(source: &Source, raw: &raw::Contact) -> Result<Contact, SceneError> {
    let kind = word(source, "contact.localization", &raw.localization, &raw::LOCALIZATIONS)?;
    let radii = [
        ("contact.patch_radius", raw.patch_radius, "the radius of the patch in m; left out, it is chosen"),
        ("contact.disc_radius", raw.disc_radius, "the radius of the disc in m; left out, it is chosen"),
    ];
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
    let required = |key: &str, help: &str| source.error(&format!("contact.{key}"), "this key is required", help);
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
        None => {
            return Err(source.error(
                path,
                "this key is required",
                "a file with columns indentation (m) and force (N)",
            ));
        }
        Some(FileOrPoints::Points(points)) => points.clone(),
        Some(FileOrPoints::File(name)) => table::read(&source.folder().join(name)).map_err(wrong)?,
    };
    Table::new(&points).map_err(wrong)
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
