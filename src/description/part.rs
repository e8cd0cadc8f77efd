//! What a body is made of, and where.

use std::f64::consts::PI;

use crate::material::{Material, Maxwell, Pruned, Window};
use crate::scene::{Parts, Scene, Vec3};

/// A part of the body of one material.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Where.
    pub portion: Portion,
    /// What it is made of.
    pub material: Material,
    /// Its relaxation as the scene has it, at the body's temperature.
    pub given: Option<Maxwell>,
    /// How its relaxation was shortened to what the run can tell, where it relaxes: `material` has what is followed.
    pub pruned: Option<Pruned>,
    /// Force on its volume, its weight included where that acts, N/m³.
    pub force: Vec3,
}

/// Where a part of the body is. Portions do not overlap, and are all of the body.
#[derive(Debug, Clone, PartialEq)]
pub enum Portion {
    /// Everywhere.
    All,
    /// Between two heights, m.
    Layer([f64; 2]),
    /// A physical volume of a mesh file.
    Volume(String),
}

/// The parts of a scene's body: one where its layers are alike. Layers ascend along z.
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

/// Half periods in a contact of the fastest strain that matters: of the spectrum of half a sine, 1% is left there.
const FASTEST: f64 = 10.0;

/// Part of the scene's tolerance that the terms of a relaxation may take which are not followed.
const OF_TOLERANCE: f64 = 0.1;

/// What a scene's run can tell of a relaxation.
fn window(scene: &Scene) -> Window {
    Window {
        end: scene.time.end,
        frequency: FASTEST * PI / scene.impactor.contact_time(),
        tolerance: OF_TOLERANCE * scene.tolerance,
    }
}

impl super::Description {
    /// The relaxations that differ as they are given, each as it is followed, with the numbers of the parts that have it. None of their terms
    /// may be left to follow: what of a body goes with a chain is known all the same.
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
