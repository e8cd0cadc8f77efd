//! Checks the materials of the body: one material by the keys of `body`, layers, or the physical volumes of a mesh.

use std::collections::BTreeMap;

use super::super::values::Number;
use super::super::{Composition, Layer, Parts, SceneError, Source, raw, suggest};
use super::body::Outline;
use super::impactor;
use super::material::{self, Named};
use crate::form;
use crate::material::Material;

/// Keys of `body` that give a single material.
const SINGLE_MATERIAL_KEYS: [&str; 3] = ["young", "poisson", "density"];

/// Materials of a body, before the impacted one is known.
pub(super) struct Materials {
    /// Materials and where they are.
    pub parts: Parts,
    /// Names of the materials of the parts, in the order of the parts; empty for a single material.
    names: Vec<String>,
    /// Key of the stiffness of each material, by the material's name.
    keys: BTreeMap<String, String>,
}

/// Composition of the body, and the keys of the stiffness and the density of the impacted material.
pub(super) struct Struck {
    pub composition: Composition,
    pub stiffness_key: String,
    pub density_key: String,
}

/// Sum of the thicknesses of all layers, m; `None` without layers.
pub(super) fn thickness(source: &Source, raw: &raw::Body) -> Result<Option<f64>, SceneError> {
    let mut sum = None;
    for (number, layer) in raw.layer.0.iter().enumerate() {
        let path = format!("body.layer.{number}.thickness");
        let thickness = source.positive(&path, layer.thickness.0, "the layer's thickness in m")?;
        *sum.get_or_insert(0.0) += thickness;
    }
    Ok(sum)
}

pub(super) fn materials(source: &Source, raw: &raw::Scene) -> Result<Materials, SceneError> {
    let named = material::all(source, raw)?;
    let given = [raw.body.young, raw.body.poisson, raw.body.density];
    let short = SINGLE_MATERIAL_KEYS.iter().zip(given).find(|(_, given)| given.is_some());
    let is_mesh = raw.body.mesh.is_some();
    if let (Some((key, _)), Some(name)) = (short, raw.material.keys().next()) {
        let (path, with) = (format!("body.{key}"), format!("material.{name}"));
        let help = if is_mesh {
            "take `young`, `poisson` and `density` out of [body], or all [material.…]"
        } else {
            "take `young`, `poisson` and `density` out of [body], or all [[body.layer]] and [material.…]"
        };
        let message = "a body of materials has no `young`, `poisson` and `density` of its own".to_owned();
        return Err(source.conflict(&path, &with, message, help.into()));
    }
    if !raw.body.layer.0.is_empty() {
        return layers(source, raw, named, short.map(|(key, _)| *key));
    }
    if raw.material.is_empty() {
        let parts = Parts::Whole(Material::elastic(single(source, &raw.body)?));
        return Ok(Materials { parts, names: Vec::new(), keys: BTreeMap::new() });
    }
    if !is_mesh {
        let name = raw.material.keys().next().map_or("", String::as_str);
        let help = format!("add [[body.layer]] with `thickness` and `material = \"{name}\"`");
        return Err(source.error(&format!("material.{name}"), "nothing is made of it: the box has no layers", help));
    }
    let keys = keys(&named);
    let names = named.keys().cloned().collect();
    let volumes = named.into_iter().map(|(name, Named { material, .. })| (name, material)).collect();
    Ok(Materials { parts: Parts::Volumes(volumes), names, keys })
}

/// Material given by the keys of `body`.
fn single(source: &Source, raw: &raw::Body) -> Result<form::Material, SceneError> {
    let required = |key: &str, given: Option<Number>| {
        let help = format!("add `{key} = …` to the table `body`; docs/scene.md has all keys");
        given.ok_or_else(|| source.missing(&format!("body.{key}"), help))
    };
    let (young, poisson, density) =
        (required("young", raw.young)?, required("poisson", raw.poisson)?, required("density", raw.density)?);
    Ok(form::Material {
        young: source.positive("body.young", young.0, "Young's modulus in Pa, as 70e9 for glass")?,
        density: source.positive("body.density", density.0, "the density in kg/m3, as 2500 for glass")?,
        poisson: material::poisson(source, "body.poisson", poisson.0)?,
    })
}

fn keys(named: &BTreeMap<String, Named>) -> BTreeMap<String, String> {
    named.iter().map(|(name, named)| (name.clone(), named.key.clone())).collect()
}

fn layers(
    source: &Source,
    raw: &raw::Scene,
    named: BTreeMap<String, Named>,
    short: Option<&str>,
) -> Result<Materials, SceneError> {
    if raw.body.mesh.is_some() {
        let help = "[material.NAME] with the names of the mesh's physical volumes".to_owned();
        return Err(source.conflict("body.layer", "body.mesh", "a mesh file has its own layers".to_owned(), help));
    }
    if let Some(key) = short {
        let help = "take it out: each layer has its material".to_owned();
        let message = format!("a body of layers has no `{key}` of its own");
        return Err(source.conflict(&format!("body.{key}"), "body.layer", message, help));
    }
    let known: Vec<&str> = named.keys().map(String::as_str).collect();
    let mut layers = Vec::new();
    for (number, layer) in raw.body.layer.0.iter().enumerate() {
        let Some(Named { material, .. }) = named.get(&layer.material) else {
            let path = format!("body.layer.{number}.material");
            let help = match known.as_slice() {
                [] => format!("add a table [material.{}]", layer.material),
                known => suggest::help(&layer.material, known, '"'),
            };
            return Err(source.error(&path, format!("there is no material \"{}\"", layer.material), help));
        };
        let (name, material) = (layer.material.clone(), material.clone());
        layers.push(Layer { thickness: layer.thickness.0, name, material });
    }
    let names: Vec<String> = raw.body.layer.0.iter().map(|layer| layer.material.clone()).collect();
    if let Some(unused) = known.iter().find(|name| names.iter().all(|used| used != *name)) {
        let help = "remove the table, or name the material in a layer";
        // An override of a layer's material may be the cause.
        let keys: Vec<String> = (0..names.len()).map(|number| format!("body.layer.{number}.material")).collect();
        let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
        let message = "no layer is made of it".to_owned();
        return Err(source.error_with(&format!("material.{unused}"), &keys, message, help));
    }
    Ok(Materials { parts: Parts::Layers(layers), keys: keys(&named), names })
}

impl Materials {
    /// Determines the impacted material. In a box: the layer at the impact point. In a mesh: the material named by the
    /// scene.
    pub(super) fn struck(self, source: &Source, raw: &raw::Scene, outline: &Outline) -> Result<Struck, SceneError> {
        let Self { parts, names, keys } = self;
        let number = match (&parts, outline) {
            (Parts::Layers(layers), Outline::Box(size)) => struck_layer(raw, *size, layers),
            (Parts::Volumes(_), _) => struck_volume(source, raw, &names)?,
            _ => 0,
        };
        if let (Some(name), false) = (&raw.contact.material, matches!(parts, Parts::Volumes(_))) {
            let message = format!("\"{name}\" is not needed: the layer that is hit follows from the impact point");
            return Err(source.error("contact.material", message, "take it out: it is for mesh files"));
        }
        let struck = match &parts {
            Parts::Whole(material) => material.instantaneous,
            Parts::Layers(layers) => layers[number].material.instantaneous,
            Parts::Volumes(volumes) => volumes[&names[number]].instantaneous,
        };
        let name = names.get(number);
        let stiffness_key = name.map_or("body.young".to_owned(), |name| keys[name].clone());
        let density_key = name.map_or("body.density".to_owned(), |name| format!("material.{name}.density"));
        Ok(Struck { composition: Composition { parts, struck, struck_layer: number }, stiffness_key, density_key })
    }
}

/// Index of the impacted layer: the first or the last one if the impact is across the layers, otherwise the one at the
/// point.
fn struck_layer(raw: &raw::Scene, size: [f64; 3], layers: &[Layer]) -> usize {
    let direction = raw.impactor.direction.map_or([0.0, 0.0, -1.0], |direction| direction.numbers());
    let [_, _, height] = impactor::point_of_box(&raw.impactor, size, direction);
    let mut bottom = 0.5 * size[2];
    // On an interface, the layer above counts. A point that is outside the body by rounding is in the last layer.
    let is_above = |layer: &Layer| {
        bottom -= layer.thickness;
        height >= bottom - 1e-9 * size[2]
    };
    layers.iter().position(is_above).unwrap_or(layers.len() - 1)
}

fn struck_volume(source: &Source, raw: &raw::Scene, names: &[String]) -> Result<usize, SceneError> {
    let path = "contact.material";
    let known: Vec<&str> = names.iter().map(String::as_str).collect();
    match &raw.contact.material {
        None if names.len() == 1 => Ok(0),
        None => {
            let help =
                format!("one of {}", known.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", "));
            Err(source.error(path, "a mesh file of several materials needs the name of the one that is hit", help))
        }
        Some(given) => names.iter().position(|name| name == given).ok_or_else(|| {
            source.error(path, format!("there is no material \"{given}\""), suggest::help(given, &known, '"'))
        }),
    }
}
