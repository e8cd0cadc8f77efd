//! Checks the materials that have names: moduli, relaxation, temperature shift.

use std::collections::BTreeMap;
use std::ops::Bound;

use super::super::raw::{self, Term};
use super::super::values::{FileOrTerms, Number};
use super::super::{SceneError, Source};
use super::numbers::show;
use super::table;
use crate::form;
use crate::material::{self, Material, Maxwell, Wlf};

/// Most terms of a relaxation; the work grows with their cube.
const MOST_TERMS: usize = 100;

/// Expected contents of a file of relaxation terms.
const HELP_OF_FILE: &str = "a file with lines of time (s) and modulus (Pa), the times ascending";

/// Highest plausible temperature of a body whose relaxation depends on it, °C. Interlayers of glass are laminated at 140.
pub(crate) const HOT: f64 = 150.0;

/// 0 °C, K.
const ZERO_CELSIUS: f64 = 273.15;

/// A checked material.
pub(super) struct Named {
    pub material: Material,
    /// Key of the stiffness of the material.
    pub key: String,
}

/// All `[material.NAME]` tables. Relaxation times are shifted to the temperature of the body.
pub(super) fn all(source: &Source, raw: &raw::Scene) -> Result<BTreeMap<String, Named>, SceneError> {
    let temperature = temperature(source, raw)?;
    let named = |(name, given): (&String, &raw::Material)| {
        if name.is_empty() || name.contains('.') {
            let help = "a name without dots, as [material.glass]";
            return Err(source.error("material", format!("{name:?} cannot be the name of a material"), help));
        }
        let path = format!("material.{name}");
        let material = one(source, &path, given, temperature)?;
        let stiffness = if given.young.is_some() { "young" } else { "shear" };
        Ok((name.clone(), Named { material, key: format!("{path}.{stiffness}") }))
    };
    raw.material.iter().map(named).collect()
}

/// `body.temperature`, °C. `None` if not given.
pub(super) fn temperature(source: &Source, raw: &raw::Scene) -> Result<Option<f64>, SceneError> {
    let path = "body.temperature";
    let Some(Number(temperature)) = raw.body.temperature else { return Ok(None) };
    source.finite(path, &[temperature])?;
    if raw.material.values().all(|material| material.wlf.is_none()) {
        let help = "take it out, or give a material `wlf = { c1 = …, c2 = …, reference = … }`";
        return Err(source.error(path, "no material's relaxation depends on the temperature", help));
    }
    Ok(Some(temperature))
}

fn one(source: &Source, path: &str, raw: &raw::Material, temperature: Option<f64>) -> Result<Material, SceneError> {
    let key = |name: &str| format!("{path}.{name}");
    let density = source.positive(&key("density"), raw.density.0, "the density in kg/m3, as 2500 for glass")?;
    let poisson = raw.poisson.map(|Number(value)| poisson(source, &key("poisson"), value)).transpose()?;
    let required = |name: &str, help: &str| source.required(&key(name), help);
    let doubled = |name: &str, with: &str| {
        let message = format!("the moduli are given twice: by `{with}` and by `{name}`");
        let help = "`young` and `poisson`, or `shear` and one of `bulk` and `poisson`".to_owned();
        source.conflict(&key(name), &key(with), message, help)
    };
    if let Some(Number(young)) = raw.young {
        let others = [("shear", raw.shear.is_some()), ("bulk", raw.bulk.is_some()), ("prony", raw.prony.is_some())];
        if let Some((name, _)) = others.into_iter().find(|(_, is_given)| *is_given) {
            return Err(doubled(name, "young"));
        }
        let young = source.positive(&key("young"), young, "Young's modulus in Pa, as 70e9 for glass")?;
        let poisson = poisson.ok_or_else(|| required("poisson", "Poisson's ratio, as 0.23 for glass"))?;
        refuse_idle_shift(source, path, raw)?;
        return Ok(Material::elastic(form::Material { young, poisson, density }));
    }
    let help = "`young` and `poisson` of an elastic material, or the shear modulus as `shear`";
    let Number(equilibrium) =
        raw.shear.ok_or_else(|| required(if raw.prony.is_some() { "shear" } else { "young" }, help))?;
    let help = "the shear modulus in Pa that is left after all relaxation";
    match raw.prony {
        Some(_) => source.not_negative(&key("shear"), [equilibrium; 3], help).map(drop)?,
        None => source.positive(&key("shear"), equilibrium, help).map(drop)?,
    }
    refuse_idle_shift(source, path, raw)?;
    let shear = Maxwell { equilibrium, terms: terms(source, &key("prony"), &raw.prony)? };
    let wlf = wlf(source, path, raw)?;
    let shift = shift(source, path, wlf, temperature)?;
    let g = shear.instantaneous();
    let shear = shear.shifted(shift);
    if shear.terms.iter().any(|term| !(term.time > 0.0 && term.time.is_finite())) {
        let message = format!("all times are shifted by a factor of 1e{shift:.0}, which leaves no number of them");
        return Err(source.error("body.temperature", message, "a temperature in °C for which `wlf` holds"));
    }
    let bulk = match (raw.bulk, poisson) {
        (Some(_), Some(_)) => return Err(doubled("poisson", "bulk")),
        (Some(Number(bulk)), None) => source.positive(&key("bulk"), bulk, "the bulk modulus in Pa, as 2e9")?,
        (None, Some(poisson)) => 2.0 * g * (1.0 + poisson) / (3.0 * (1.0 - 2.0 * poisson)),
        (None, None) => return Err(required("bulk", "the bulk modulus in Pa, or `poisson` at once")),
    };
    let material = Material { shift: wlf, ..Material::of_moduli(bulk, shear, density) };
    let poisson = material.instantaneous.poisson;
    if poisson > -1.0 && poisson < 0.5 {
        return Ok(material);
    }
    let message = format!("with a shear modulus of {} Pa at once the material is incompressible", show(g));
    Err(source.error(&key("bulk"), message, "a bulk modulus in Pa below 1e15 times that"))
}

/// Poisson's ratio, checked to be in its range.
pub(super) fn poisson(source: &Source, path: &str, value: f64) -> Result<f64, SceneError> {
    let help = "between -1 and 0.5, both excluded: at 0.5 the material is incompressible and λ of (5) infinite";
    source.in_range(path, value, (Bound::Excluded(-1.0), Bound::Excluded(0.5)), help)
}

/// Refuses a temperature shift if there are no relaxation times.
fn refuse_idle_shift(source: &Source, path: &str, raw: &raw::Material) -> Result<(), SceneError> {
    if raw.wlf.is_none() || raw.prony.is_some() {
        return Ok(());
    }
    let help = "take it out, or give the terms as `prony`";
    Err(source.error(&format!("{path}.wlf"), "there are no relaxation times to shift", help))
}

/// Temperature dependence of relaxation times; `None` if not given.
fn wlf(source: &Source, path: &str, raw: &raw::Material) -> Result<Option<Wlf>, SceneError> {
    let Some(raw::Wlf { c1, c2, reference }) = raw.wlf else { return Ok(None) };
    let key = |name: &str| format!("{path}.wlf.{name}");
    let wlf = Wlf {
        c1: source.positive(&key("c1"), c1.0, "C1, positive: log10 of the shift is -C1 (T - T0)/(C2 + T - T0)")?,
        c2: source.positive(&key("c2"), c2.0, "C2 in K, positive")?,
        reference: reference.0,
    };
    source.finite(&key("reference"), &[wlf.reference])?;
    Ok(Some(wlf))
}

/// Advice for a temperature that may be meant in K.
pub(crate) fn in_celsius(kelvin: f64) -> String {
    let celsius = (1e6 * (kelvin - ZERO_CELSIUS)).round() / 1e6;
    format!("temperatures are in °C: {} K are {} °C", show(kelvin), show(celsius))
}

/// Decimal logarithm of the shift factor a_T; 0 without a shift or a temperature.
fn shift(source: &Source, path: &str, wlf: Option<Wlf>, temperature: Option<f64>) -> Result<f64, SceneError> {
    let (Some(wlf), Some(temperature)) = (wlf, temperature) else { return Ok(0.0) };
    wlf.log_shift(temperature).ok_or_else(|| {
        let message =
            format!("at {} °C and below, `{path}.wlf` has no value: its pole is reference - c2", show(wlf.pole()));
        match wlf.reference > HOT {
            true => source.error(&format!("{path}.wlf.reference"), message, in_celsius(wlf.reference)),
            false => source.error("body.temperature", message, "a temperature in °C well above that"),
        }
    })
}

/// Relaxation terms as given in the scene or in a file, not shifted.
fn terms(source: &Source, path: &str, given: &Option<FileOrTerms>) -> Result<Vec<material::Term>, SceneError> {
    let Some(given) = given else { return Ok(Vec::new()) };
    let (pairs, is_file) = match given {
        FileOrTerms::Terms(terms) => {
            (terms.iter().map(|Term { modulus, time }| [time.0, modulus.0]).collect::<Vec<_>>(), false)
        }
        FileOrTerms::File(name) => (in_file(source, path, name)?, true),
    };
    if pairs.is_empty() {
        return Err(source.error(path, "there is no term", "terms, or take it out for an elastic material"));
    }
    if pairs.len() > MOST_TERMS {
        let help = format!("at most {MOST_TERMS} terms: one or two per decade of time follow any measured relaxation");
        return Err(source.error(path, format!("there are {} terms", pairs.len()), help));
    }
    for (number, [time, modulus]) in pairs.iter().enumerate() {
        let key = |name: &str| if is_file { path.to_owned() } else { format!("{path}.{number}.{name}") };
        source.positive(&key("time"), *time, "the relaxation time in s")?;
        source.positive(&key("modulus"), *modulus, "the modulus in Pa that relaxes in that time")?;
        let before = &pairs[..number];
        if before.iter().any(|[other, _]| other == time) {
            let message = format!("the time of {} s is there twice", show(*time));
            return Err(source.error(&key("time"), message, "one term with the sum of both moduli"));
        }
        if is_file && before.last().is_some_and(|[last, _]| last > time) {
            let message = format!("the times do not ascend: {} s follows a longer one", show(*time));
            return Err(source.error(path, message, HELP_OF_FILE));
        }
    }
    Ok(pairs.into_iter().map(|[time, modulus]| material::Term { modulus, time }).collect())
}

/// Pairs of time (s) and modulus (Pa) of a file.
fn in_file(source: &Source, path: &str, name: &str) -> Result<Vec<[f64; 2]>, SceneError> {
    table::read(&source.folder().join(name)).map_err(|message| source.error(path, message, HELP_OF_FILE))
}

/// Replaces the files of relaxation terms in a source by the terms themselves.
///
/// # Errors
/// If a file cannot be read.
pub(in crate::scene) fn with_series(source: Source) -> Result<Source, SceneError> {
    let raw = super::decode(&source)?;
    let mut found = Vec::new();
    for (name, material) in &raw.material {
        if let Some(FileOrTerms::File(file)) = &material.prony {
            found.push((name.clone(), in_file(&source, &format!("material.{name}.prony"), file)?));
        }
    }
    Ok(found.into_iter().fold(source, |source, (name, pairs)| source.with_terms(&name, &pairs)))
}
