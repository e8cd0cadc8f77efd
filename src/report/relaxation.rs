//! Tables of a report with the viscoelastic materials of a body, one for each generalised Maxwell chain.

use crate::material::{Material, Maxwell, Term, Wlf};
use crate::scene::{Body, Parts};

use super::number::{MODULUS, computed, digits, given, plain, with_unit};
use super::page::{Block, Column, Table};

/// A generalised Maxwell chain, and the names of the parts of the body with this chain.
struct Relaxing<'a> {
    shear: &'a Maxwell,
    shift: Option<Wlf>,
    parts: Vec<String>,
}

/// Makes a table for each chain, with a text on the effect of temperature. An elastic body has no tables.
pub fn tables(body: &Body) -> Vec<Block> {
    let mut chains: Vec<Relaxing> = Vec::new();
    for (part, material) in materials(body) {
        let Some(shear) = &material.shear else { continue };
        match chains.iter_mut().find(|chain| chain.shear == shear && chain.shift == material.shift) {
            Some(chain) => chain.parts.push(part),
            None => chains.push(Relaxing { shear, shift: material.shift, parts: vec![part] }),
        }
    }
    let parts = chains.into_iter().flat_map(|chain| {
        let shift = chain.shift.map(|shift| Block::Text(shifted(&shift, body.temperature)));
        std::iter::once(table(&chain, body.temperature)).chain(shift)
    });
    parts.collect()
}

/// Describes how the temperature shifts the relaxation times.
fn shifted(wlf: &Wlf, temperature: Option<f64>) -> String {
    let Wlf { c1, c2, reference } = *wlf;
    let celsius = |temperature: f64| with_unit(plain(temperature), "°C");
    let constants = format!("C₁ = {}, C₂ = {} and T₀ = {}", plain(c1), with_unit(plain(c2), "K"), celsius(reference));
    let law = "log₁₀ a_T = −C₁ (T − T₀)/(C₂ + T − T₀), Williams, Landel & Ferry (1955)";
    match temperature.and_then(|at| Some((at, wlf.log_shift(at)?))) {
        Some((at, log_shift)) => format!(
            "The times above are those at {}: the given ones, which hold at T₀, times a_T = {} ({law}), with {constants}.",
            celsius(at),
            digits(10.0_f64.powf(log_shift), 4)
        ),
        None => format!(
            "The scene gives no temperature: the times above hold at T₀ = {}, and others would follow from {law}, with {constants}.",
            celsius(reference)
        ),
    }
}

fn materials(body: &Body) -> Vec<(String, &Material)> {
    match &body.composition.parts {
        Parts::Whole(material) => vec![("the body".to_owned(), material)],
        Parts::Layers(layers) => (1..)
            .zip(layers)
            .map(|(number, layer)| (format!("layer {number} ({})", layer.name), &layer.material))
            .collect(),
        Parts::Volumes(volumes) => volumes.iter().map(|(name, material)| (name.clone(), material)).collect(),
    }
}

fn table(chain: &Relaxing, temperature: Option<f64>) -> Block {
    let Relaxing { shear, parts, .. } = chain;
    let mut terms = shear.terms.clone();
    terms.sort_by(|a, b| a.time.total_cmp(&b.time));
    let row = |term: &Term| vec![digits(term.time, 4), digits(1e-6 * term.modulus, 4)];
    let when = temperature.map_or(String::new(), |temperature| format!(" at {} °C", plain(temperature)));
    Block::Table(Table {
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
