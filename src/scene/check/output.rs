//! Checks the output: how often results are written, and at which points of the body.

use super::super::values::{Number, Whole};
use super::super::{Output, Probe, SceneError, Source, Vec3, faces, is_name_of_result, raw};
use super::body::Outline;
use super::numbers::show;

/// Default wall time between two checkpoints, min.
const CHECKPOINT_MINUTES: f64 = 10.0;

pub(super) fn check(source: &Source, raw: &raw::Scene, outline: &Outline) -> Result<Output, SceneError> {
    let raw::Output { every, checkpoint_steps, checkpoint_minutes, fields, stress, probes } = &raw.output;
    let steps = |key: &str, Whole(n): Whole| source.whole(&format!("output.{key}"), n, 1..=1_000_000_000);
    let fields = fields.map(|n| steps("fields", n)).transpose()?;
    let theory = raw.body.model.as_deref().unwrap_or_default();
    let asked = [("output.fields", fields.is_some()), ("output.probes", !probes.0.is_empty())];
    if let (true, Some((key, _))) =
        (matches!(theory, "half-space" | "infinite-plate"), asked.into_iter().find(|(_, given)| *given))
    {
        let message =
            format!("the theory \"{theory}\" is a formula for the point that is hit, and has no other points");
        return Err(source.conflict(key, "body.model", message, "another `model`, or take it out".into()));
    }
    let mut checked: Vec<Probe> = Vec::new();
    for (number, probe) in probes.0.iter().enumerate() {
        let name = name(source, number, &probe.name, &checked)?;
        checked.push(Probe { name, point: point(source, number, probe.point.numbers(), outline)? });
    }
    let Number(minutes) = checkpoint_minutes.unwrap_or(Number(CHECKPOINT_MINUTES));
    if !(0.0..=1e6).contains(&minutes) {
        let help = "minutes, up to 1e6; 0 keeps none by the clock";
        return Err(source.error("output.checkpoint_minutes", format!("{} is out of range", show(minutes)), help));
    }
    Ok(Output {
        every: steps("every", every.unwrap_or(Whole(1)))?,
        checkpoint_steps: checkpoint_steps.map(|n| steps("checkpoint_steps", n)).transpose()?,
        checkpoint_minutes: (minutes > 0.0).then_some(minutes),
        fields,
        // Reading the stresses costs more than an explicit step.
        stress: stress.unwrap_or(raw.time.scheme.as_deref() != Some("central-difference")),
        probes: checked,
    })
}

/// Returns the name of a probe if it differs from all earlier ones and can be the name of a group in the results.
fn name(source: &Source, number: usize, name: &str, before: &[Probe]) -> Result<String, SceneError> {
    let path = format!("output.probes.{number}.name");
    let help = "a name of its own, without \"/\": results have it as /series/probe/<name>";
    if !is_name_of_result(name) {
        return Err(source.error(&path, format!("{name:?} cannot be the name of a probe"), help));
    }
    if before.iter().any(|probe| probe.name == name) {
        return Err(source.error(&path, format!("there are two probes {name:?}"), help));
    }
    Ok(name.to_owned())
}

/// Returns the point of a probe if it is in the box. Points in a mesh file are located after the mesh has been read.
fn point(source: &Source, number: usize, point: Vec3, outline: &Outline) -> Result<Vec3, SceneError> {
    let path = format!("output.probes.{number}.point");
    source.finite(&path, &point)?;
    let Outline::Box(size) = outline else { return Ok(point) };
    let point = faces::snap(*size, point);
    if (0..3).all(|axis| 2.0 * point[axis].abs() <= size[axis]) {
        return Ok(point);
    }
    let message = format!("the point is {:.2e} m outside of the body", faces::distance(*size, point));
    let [x, y, z] = size.map(|edge| show(edge / 2.0));
    Err(source.error(&path, message, format!("x from -{x} to {x}, y from -{y} to {y}, z from -{z} to {z}")))
}
