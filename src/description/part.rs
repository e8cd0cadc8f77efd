//! Materials of a body, and the portions of the body that they fill.

use std::f64::consts::PI;

use crate::material::{Material, Maxwell, Pruned, Window};
use crate::scene::{Initial, Parts, Scene, Vec3};

/// Part of the body with one material.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Portion of the body.
    pub portion: Portion,
    /// Material used in the run: if the material is viscoelastic, with the reduced chain of `pruned`.
    pub material: Material,
    /// Generalised Maxwell chain of the shear modulus from the scene, at the temperature of the body; `None` if
    /// elastic.
    pub given: Option<Maxwell>,
    /// Chain with only the terms that have an effect within the run, and its error bound; `None` if elastic.
    pub pruned: Option<Pruned>,
    /// Force per volume, with the weight if gravity acts, N/m³.
    pub force: Vec3,
}

/// Portion of the body. Portions do not overlap, and together they fill the body.
#[derive(Debug, Clone, PartialEq)]
pub enum Portion {
    /// Whole body.
    All,
    /// Layer between two z coordinates, m.
    Layer([f64; 2]),
    /// Physical volume of a mesh file, by name.
    Volume(String),
}

/// Parts of the body of a scene, layers in ascending order of z. A body with identical layers has one part.
pub(super) fn parts(scene: &Scene) -> Vec<Part> {
    let composition = &scene.body.composition;
    let window = window(scene);
    let part = |portion: Portion, material: &Material| {
        let density = material.instantaneous.density;
        let pruned = material.shear.as_ref().map(|chain| Pruned::new(chain, &window));
        let followed = |pruned: &Pruned| Material::of_moduli(material.bulk(), pruned.chain.clone(), density);
        Part {
            portion,
            material: pruned.as_ref().map_or_else(|| material.clone(), followed),
            force: scene.load.force_on(density),
            given: material.shear.clone(),
            pruned,
        }
    };
    match &composition.parts {
        Parts::Whole(material) => vec![part(Portion::All, material)],
        Parts::Layers(layers) if composition.uniform().is_some() => vec![part(Portion::All, &layers[0].material)],
        Parts::Layers(layers) => {
            let heights = composition.interfaces();
            let ends = heights.windows(2).map(|ends| Portion::Layer([ends[0], ends[1]]));
            ends.zip(layers.iter().rev()).map(|(portion, layer)| part(portion, &layer.material)).collect()
        }
        Parts::Volumes(volumes) => {
            volumes.iter().map(|(name, material)| part(Portion::Volume(name.clone()), material)).collect()
        }
    }
}

/// Highest relevant angular frequency of the strain, times contact time over π. At this frequency the spectrum of a
/// half sine (the contact force) has fallen to 1% of its value at zero.
const STRAIN_FREQUENCY_FACTOR: f64 = 10.0;

/// Share of the scene's tolerance for the error from the omitted relaxation terms.
const UNFOLLOWED_SHARE: f64 = 0.1;

/// Time scales of the impact and tolerance, which decide which relaxation terms are omitted.
fn window(scene: &Scene) -> Window {
    Window {
        end: scene.time.end,
        frequency: STRAIN_FREQUENCY_FACTOR * PI / scene.impactor.contact_time(),
        tolerance: UNFOLLOWED_SHARE * scene.tolerance,
        begins_relaxed: scene.time.initial == Initial::Equilibrium,
    }
}

impl super::Description {
    /// Different relaxations of the body: each reduced chain with the numbers of the parts that have it. Parts are
    /// grouped by the chain of the scene. A reduced chain may have no terms; it is listed all the same, so that its
    /// parts are known to be viscoelastic.
    pub fn relaxations(&self) -> Vec<(&Maxwell, Vec<usize>)> {
        let mut found: Vec<(&Part, Vec<usize>)> = Vec::new();
        for (number, part) in self.parts.iter().enumerate().filter(|(_, part)| part.pruned.is_some()) {
            match found.iter_mut().find(|(other, _)| other.given == part.given) {
                Some((_, numbers)) => numbers.push(number),
                None => found.push((part, vec![number])),
            }
        }
        found.into_iter().filter_map(|(part, numbers)| Some((&part.pruned.as_ref()?.chain, numbers))).collect()
    }
}
