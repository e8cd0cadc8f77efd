//! Checks the strength of the material, and the quantity for which the accuracy is given.

use super::super::strength::{Strength, face_names};
use super::super::values::Number;
use super::super::{Composition, Impactor, Measure, SceneError, Source, faces, raw, suggest};
use super::body::Outline;
use super::word;

pub(super) fn check(
    source: &Source,
    raw: &raw::Scene,
    outline: &Outline,
    (composition, impactor): (&Composition, &Impactor),
) -> Result<Strength, SceneError> {
    // The faces of the layers if the box is hit across them.
    let names = match outline {
        Outline::Box(size) if faces::struck_axis(*size, impactor.point, impactor.direction) == 2 => {
            face_names(composition.interfaces().len().saturating_sub(1))
        }
        _ => face_names(1),
    };
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let raw::Strength { tension, face } = &raw.strength;
    let help = "a tension in Pa: 45e6 for annealed float glass";
    let checked = |path: String, Number(tension): Number| source.positive(&path, tension, help);
    let mut by_face = std::collections::BTreeMap::new();
    for (name, given) in face {
        let path = format!("strength.face.{name}");
        if matches!(outline, Outline::Box(_)) && !names.contains(&name.as_str()) {
            let message = format!("a box that is hit has no face \"{name}\"");
            return Err(source.error(&path, message, suggest::help(name, &names, '"')));
        }
        by_face.insert(name.clone(), checked(path, *given)?);
    }
    let tension = tension.map(|given| checked("strength.tension".to_owned(), given)).transpose()?;
    let strength = Strength { tension, by_face };
    let is_off = raw.output.stress == Some(false);
    if strength.is_given() && is_off {
        let help = "take one of both out".into();
        let message = "a strength is held against stresses, which are not read".into();
        return Err(source.conflict("output.stress", "strength", message, help));
    }
    Ok(strength)
}

/// Quantity to which `accuracy.tolerance` applies.
pub(super) fn measure(source: &Source, raw: &raw::Scene) -> Result<Measure, SceneError> {
    let key = "accuracy.quantity";
    match word(source, key, &raw.accuracy.quantity, &raw::QUANTITIES)? {
        "acceleration" => Ok(Measure::Acceleration),
        "deflection" => Ok(Measure::Deflection),
        _ if raw.output.stress == Some(false) => {
            let help = "\"acceleration\", or `output.stress = true`".into();
            Err(source.conflict(key, "output.stress", "stresses are not read".into(), help))
        }
        _ => Ok(Measure::Stress),
    }
}
