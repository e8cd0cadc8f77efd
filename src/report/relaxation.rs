//! How the materials of a body relax: a table for each Maxwell chain.

use crate::material::{Material, Maxwell, Term};
use crate::scene::{Body, Parts};

use super::number::{MODULUS, computed, digits, given, plain};
use super::page::{Column, Part, Table};

/// A chain, and the parts of the body that have it.
struct Relaxing<'a> {
    shear: &'a Maxwell,
    parts: Vec<String>,
}

/// A table for each chain that occurs; none where all is elastic.
pub fn tables(body: &Body) -> Vec<Part> {
    let mut chains: Vec<Relaxing> = Vec::new();
    for (part, material) in materials(body) {
        let Some(shear) = &material.shear else { continue };
        match chains.iter_mut().find(|chain| chain.shear == shear) {
            Some(chain) => chain.parts.push(part),
            None => chains.push(Relaxing { shear, parts: vec![part] }),
        }
    }
    chains.into_iter().map(|chain| table(&chain, body.temperature)).collect()
}

fn materials(body: &Body) -> Vec<(String, &Material)> {
    match &body.composition.parts {
        Parts::Whole(material) => vec![("the body".to_owned(), material)],
        Parts::Layers(layers) => {
            (1..).zip(layers).map(|(number, layer)| (format!("layer {number}"), &layer.material)).collect()
        }
        Parts::Volumes(volumes) => volumes.iter().map(|(name, material)| (name.clone(), material)).collect(),
    }
}

fn table(chain: &Relaxing, temperature: Option<f64>) -> Part {
    let Relaxing { shear, parts } = chain;
    let mut terms = shear.terms.clone();
    terms.sort_by(|a, b| a.time.total_cmp(&b.time));
    let row = |term: &Term| vec![digits(term.time, 4), digits(1e-6 * term.modulus, 4)];
    let when = temperature.map_or(String::new(), |temperature| format!(" at {} °C", plain(temperature)));
    Part::Table(Table {
        caption: format!(
            "Shear modulus of {}{when}: G(t) = G∞ + Σ Gᵢ exp(−t/τᵢ), {} at t → 0 and G∞ = {} after all relaxation",
            parts.join(", "),
            computed(shear.instantaneous(), MODULUS),
            given(shear.equilibrium, MODULUS)
        ),
        columns: vec![Column::number("Relaxation time τᵢ", "s"), Column::number("Modulus Gᵢ", "MPa")],
        rows: terms.iter().map(row).collect(),
    })
}
