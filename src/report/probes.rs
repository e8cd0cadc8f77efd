//! Section of a report with the largest values at the probes, and their stresses and displacements over time.

use crate::error::Result;
use crate::record::extremes::ProbeExtremes;

use super::data::Data;
use super::figures::Curves;
use super::number::{LENGTH, STRESS, TIME, Units, digits, place, unit_for};
use super::page::{Block, Column, Section, Table};

/// Largest number of drawn probes; the probes with the largest values are drawn.
const DRAWN: usize = 6;

/// Makes the section.
///
/// # Errors
/// If a probe cannot be read or a figure cannot be drawn.
pub fn section(data: &Data) -> Result<Section> {
    let probes = data.extremes.as_ref().map_or(&[][..], |extremes| &extremes.probes);
    let mut parts = Vec::new();
    if probes.is_empty() {
        parts.push(Block::Text("The scene has no probes.".to_owned()));
    } else {
        parts.push(Block::Table(table(data, probes)));
        let length = |row: &[f64]| row.iter().map(|x| x * x).sum::<f64>().sqrt();
        let largest = |row: &[f64]| row.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        parts.push(figure(data, "principal_stress", ("largest principal stress", STRESS), largest, |of| {
            of.tension.value
        })?);
        parts.push(figure(data, "displacement", ("length of the displacement", LENGTH), length, |of| {
            of.displacement.value
        })?);
    }
    Ok(Section { id: "probes", title: "Probes", parts })
}

fn table(data: &Data, probes: &[ProbeExtremes]) -> Table {
    let unit = |of: fn(&ProbeExtremes) -> f64, units: Units| {
        unit_for(probes.iter().map(|probe| of(probe).abs()).fold(0.0, f64::max), units)
    };
    let (stress, length) = (unit(|of| of.tension.value, STRESS), unit(|of| of.displacement.value, LENGTH));
    let time = unit_for(data.end(), TIME);
    let point = |name: &str| {
        let scene = data.scene.as_ref().ok()?;
        scene.output.probes.iter().find(|probe| probe.name == name).map(|probe| place(probe.point))
    };
    let row = |probe: &ProbeExtremes| {
        let mut row = vec![probe.name.clone(), point(&probe.name).unwrap_or_default()];
        for (extreme, unit) in [(probe.tension, stress), (probe.displacement, length)] {
            row.extend([digits(extreme.value / unit.size, 4), digits(extreme.time / time.size, 4)]);
        }
        row
    };
    Table {
        caption: "Largest values at the probes".to_owned(),
        columns: vec![
            Column::text("Probe"),
            Column::text("Place"),
            Column::number("Tension", stress.name),
            Column::number("at", time.name),
            Column::number("Deflection", length.name),
            Column::number("at", time.name),
        ],
        rows: probes.iter().map(row).collect(),
    }
}

/// Draws a scalar over time for the probes with the largest values. `of_row` computes it from the components of a row;
/// the probes are ranked by `size`.
fn figure(
    data: &Data,
    dataset: &str,
    (quantity, units): (&str, Units),
    of_row: impl Fn(&[f64]) -> f64,
    size: fn(&ProbeExtremes) -> f64,
) -> Result<Block> {
    let all = data.extremes.as_ref().map_or(&[][..], |extremes| &extremes.probes);
    let mut drawn: Vec<&ProbeExtremes> = all.iter().collect();
    drawn.sort_by(|one, other| size(other).total_cmp(&size(one)));
    drawn.truncate(DRAWN);
    let (mut time, mut curves) = (Vec::new(), Vec::new());
    for probe in &drawn {
        let read = data.probe(&probe.name, dataset)?;
        let rows = (0..read.time.len()).map(|n| read.parts.iter().map(|part| part.values[n]).collect::<Vec<f64>>());
        // A single curve needs no name.
        let name = if drawn.len() == 1 { String::new() } else { probe.name.clone() };
        curves.push((name, rows.map(|row| of_row(&row)).collect::<Vec<f64>>()));
        time = read.time;
    }
    let of =
        if drawn.len() == 1 { format!("at the probe “{}”", drawn[0].name) } else { "at the probes".to_owned() };
    let which = if all.len() > DRAWN {
        format!(" ({DRAWN} of {}, those with the largest values)", all.len())
    } else {
        String::new()
    };
    let words = quantity[..1].to_uppercase() + &quantity[1..];
    let drawing = Curves {
        quantity,
        units,
        time: &time,
        curves: curves.iter().map(|(name, values)| (name.clone(), values.as_slice())).collect(),
        limits: Vec::new(),
        caption: format!("{words} {of}{which}."),
    };
    drawing.draw(data).map(Block::Figure)
}
