//! Section of a report with the energies and their balance.

use crate::error::Result;
use crate::record::quantity::Quantity;

use super::data::Data;
use super::figures::{Curves, TOTAL};
use super::number::{ENERGY, SMALLEST_PERCENT, Unit, digits, percent, unit_for, with_unit};
use super::page::{Block, Column, Section, Table};

/// Energies whose maximum is below this fraction of the largest energy are not drawn.
const SMALLEST_DRAWN_FRACTION: f64 = 1e-3;

/// An imbalance below this fraction of the initial energy is regarded as rounding.
const ROUNDING: f64 = 1e-9;

/// Names of the datasets and of the energies in the report.
const NAMES: [(&str, &str); 9] = [
    ("impactor", "impactor"),
    ("contact", "contact"),
    ("kinetic", "body, kinetic"),
    ("elastic", "body, strain"),
    ("support", "supports"),
    ("total", TOTAL),
    ("dissipated", "dissipated"),
    ("external", "work of loads"),
    ("numerical", "integration"),
];

/// Makes the section.
///
/// # Errors
/// If the figure cannot be drawn.
pub fn section(data: &Data) -> Result<Section> {
    let Quantity { time, parts, .. } = &data.energies;
    let named: Vec<(&str, &[f64])> = NAMES
        .iter()
        .filter_map(|(name, words)| Some((*words, parts.iter().find(|part| part.name == *name)?.values.as_slice())))
        .collect();
    let size = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let largest = named.iter().map(|(_, values)| size(values)).fold(0.0, f64::max);
    let curves = named.iter().filter(|(_, values)| size(values) > SMALLEST_DRAWN_FRACTION * largest);
    let figure = Curves {
        quantity: "energy",
        units: ENERGY,
        time,
        curves: curves.map(|(name, values)| ((*name).to_owned(), *values)).collect(),
        limits: Vec::new(),
        caption: "Energies of impactor (kinetic), contact (indentation), body and supports, and their total. Those below a thousandth of the largest are left out.".to_owned(),
    };
    let mut sections = Vec::new();
    if largest > 0.0 {
        sections.push(Block::Figure(figure.draw(data)?));
    }
    sections.push(Block::Table(table(&named, unit_for(largest, ENERGY))));
    sections.extend(balance(&data.energies).map(Block::Text));
    Ok(Section { id: "energy", title: "Energies", parts: sections })
}

fn table(named: &[(&str, &[f64])], unit: Unit) -> Table {
    let number = |value: f64| digits(value / unit.size, 4);
    let row = |(name, values): &(&str, &[f64])| {
        let by_size = values.iter().copied().max_by(|one, other| one.abs().total_cmp(&other.abs()));
        let [first, last] = [values.first(), values.last()].map(|value| value.copied().unwrap_or(f64::NAN));
        vec![(*name).to_owned(), number(first), number(by_size.unwrap_or(f64::NAN)), number(last)]
    };
    Table {
        caption: "Energies at the start, at their largest and at the end".to_owned(),
        columns: vec![
            Column::text("Energy"),
            Column::number("Start", unit.name),
            Column::number("Largest", unit.name),
            Column::number("End", unit.name),
        ],
        rows: named.iter().map(row).collect(),
    }
}

/// Formats an upper limit in per cent; fractions below [`SMALLEST_PERCENT`] are written as 0.001 %.
fn limit(part: f64) -> String {
    if part < SMALLEST_PERCENT { with_unit("0.001".to_owned(), "%") } else { percent(part) }
}

/// Describes the error of the energy balance in a sentence; `None` without an initial energy.
fn balance(energies: &Quantity) -> Option<String> {
    let of = |name: &str| Some(&energies.parts.iter().find(|part| part.name == name)?.values);
    let (total, dissipated, external, numerical) = (of("total")?, of("dissipated")?, of("external")?, of("numerical")?);
    let kept = |n: usize| total[n] + dissipated[n] - external[n] - numerical[n];
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let (initial, work) = (total.first()?, largest(external));
    let available = Some(initial + work).filter(|available| *available > 0.0)?;
    let name = if work > 0.0 { "the initial energy plus the largest work" } else { "the initial energy" };
    let off = (0..total.len()).map(|n| (kept(n) - kept(0)).abs()).fold(0.0, f64::max);
    let constant = match off / available {
        off if off < ROUNDING => "constant, but for rounding".to_owned(),
        off => format!("constant to within {} of {name}", limit(off)),
    };
    let made = match largest(numerical) / available {
        made if made < SMALLEST_PERCENT => format!("less than {}", limit(made)),
        made => format!("at most {}", limit(made)),
    };
    Some(format!(
        "Balance: the total plus the dissipated energy, less the work of the loads and less the energy that the time integration has added, is \
         {constant}. The time integration adds or takes {made} of {name}."
    ))
}
