//! Checks one support on one surface.

use super::super::values::{ByComponent, List};
use super::super::{SceneError, Source, Support, SupportKind, Vec3, raw};
use super::body::Outline;
use super::{surface, within, word};

pub(super) fn check(
    source: &Source,
    number: usize,
    raw: &raw::Support,
    outline: &Outline,
) -> Result<Support, SceneError> {
    let at = |key: &str| format!("support.{number}.{key}");
    surface(source, &at("surface"), &raw.surface, outline)?;
    let within = within::check(source, &at("within"), &raw.within, &raw.surface, outline)?;
    let kind = match word(source, &at("kind"), &Some(raw.kind.clone()), &raw::KINDS)? {
        "elastic" => {
            refuse(source, raw, number, "elastic", &["components", "normal"])?;
            let stiffness = stiffness(source, raw, &at("stiffness"))?;
            SupportKind::Elastic { stiffness }
        }
        "pad" => {
            refuse(source, raw, number, "pad", &["components"])?;
            pad(source, raw, number)?
        }
        _ => {
            let others = ["stiffness", "damping", "normal"];
            refuse(source, raw, number, "clamped", &others)?;
            if within.is_some() && raw.displacement.is_some() {
                let help = "take `displacement` out, or hold the whole surface".into();
                let message = "a part of a surface is clamped where it is, without a displacement".into();
                return Err(source.conflict(&at("displacement"), &at("within"), message, help));
            }
            let components = components(source, &raw.components, &at("components"))?;
            let moved = raw.displacement.map_or([0.0; 3], |value| value.numbers());
            if let Some(axis) = (0..3).find(|&i| moved[i] != 0.0 && !components[i]) {
                let message = format!("component \"{}\" is displaced and not held", ["x", "y", "z"][axis]);
                let help = "0 there, or the component among `components`".into();
                return Err(source.conflict(&at("displacement"), &at("components"), message, help));
            }
            SupportKind::Clamped { components }
        }
    };
    let ByComponent(damping) = raw.damping.unwrap_or(ByComponent([0.0; 3]));
    let displacement = raw.displacement.map_or([0.0; 3], |value| value.numbers());
    source.finite(&at("displacement"), &displacement)?;
    Ok(Support {
        surface: raw.surface.clone(),
        within,
        kind,
        damping: source.not_negative(&at("damping"), damping, "a damping c in N s/m3, 0 or more")?,
        displacement,
    })
}

/// Refuses those of `keys` that are given but not used by a support of this kind.
fn refuse(source: &Source, raw: &raw::Support, number: usize, kind: &str, keys: &[&str]) -> Result<(), SceneError> {
    for key in keys {
        let (given, owner) = match *key {
            "stiffness" => (raw.stiffness.is_some(), "an elastic support or a pad"),
            "damping" => (raw.damping.is_some(), "an elastic support or a pad"),
            "components" => (raw.components.is_some(), "a clamped support"),
            _ => (raw.normal.is_some(), "a pad"),
        };
        if given {
            return Err(source.conflict(
                &format!("support.{number}.{key}"),
                &format!("support.{number}.kind"),
                format!("a support of kind \"{kind}\" has no `{key}`"),
                format!("take `{key}` out: it belongs to {owner}"),
            ));
        }
    }
    Ok(())
}

fn stiffness(source: &Source, raw: &raw::Support, path: &str) -> Result<Vec3, SceneError> {
    let help = "a stiffness k in N/m3, 0 or more: one number, or three [kx, ky, kz]";
    match raw.stiffness {
        Some(ByComponent(value)) => source.not_negative(path, value, help),
        None => Err(source.required(path, help)),
    }
}

fn pad(source: &Source, raw: &raw::Support, number: usize) -> Result<SupportKind, SceneError> {
    let path = format!("support.{number}.normal");
    let Some(normal) = raw.normal else {
        let help = "the direction into the pad, as [0, 0, -1] for a plate that lies on it";
        return Err(source.error(&path, "a pad needs this key", help));
    };
    let normal = source.unit(&path, normal.numbers())?;
    let path = format!("support.{number}.stiffness");
    let stiffness = stiffness(source, raw, &path)?;
    if (0..3).any(|i| normal[i] != 0.0 && stiffness[i] == 0.0) {
        let help = "positive in each component of `normal` that is not zero";
        return Err(source.error(&path, "a pad without stiffness does not push back", help));
    }
    Ok(SupportKind::Pad { stiffness, normal })
}

fn components(source: &Source, given: &Option<List<String>>, path: &str) -> Result<[bool; 3], SceneError> {
    let Some(List(given)) = given else {
        return Ok([true; 3]);
    };
    let help = "some of \"x\", \"y\", \"z\", each once; leave the key out to hold all";
    let mut held = [false; 3];
    for (number, name) in given.iter().enumerate() {
        let path = format!("{path}.{number}");
        let Some(axis) = ["x", "y", "z"].iter().position(|axis| axis == name) else {
            return Err(source.error(&path, format!("there is no component \"{name}\""), help));
        };
        if held[axis] {
            return Err(source.error(&path, format!("component \"{name}\" stands twice"), help));
        }
        held[axis] = true;
    }
    if given.is_empty() {
        return Err(source.error(path, "a clamped support that holds nothing", help));
    }
    Ok(held)
}
