//! What is kept of each body of a sweep. A hash finds it; the descriptions themselves are compared.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use crate::body::rates;
use crate::description::Description;
use crate::form;
use crate::material::Maxwell;
use crate::model::rate;
use crate::scene::{self, Contact, Impactor, Initial, Load, Scene, Support, Vec3};
use crate::space::OF_CONTACT;

/// All of a scene that its body depends on.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyOf {
    body: scene::Body,
    supports: Vec<Support>,
    point: Vec3,
    direction: Vec3,
    contact: Contact,
    load: Load,
    initial: Initial,
    stress: bool,
    /// Bulk moduli of the materials that relax, Pa, to some digits.
    bulk: Vec<String>,
    /// For each of these the first that relaxes alike: one chain has one D.
    alike: Vec<usize>,
    /// What the local field of the contact is made with: rounded, since it counts for little.
    local: Vec<String>,
    /// The rates at which vectors of a basis are made for the chains, in hundredths of the first: on a basis of fewer rates a body may lack shapes
    /// that the larger basis lacks, too, by which its error is estimated.
    rates: Vec<u32>,
}

/// The tolerance of a basis for members of different chains over theirs: estimates were seen to differ by a factor of two from 0 to 50 °C. (Chains
/// that share a local field hardly differ.)
const OF_RELAXING: f64 = 0.6;

/// The scene that a basis is made for which all its family shares: where members relax differently, with a margin for these.
pub(super) fn shared(scene: Scene) -> Scene {
    let differ = scene.body.composition.is_viscoelastic() && !has_local_field(&scene);
    let margin = if differ { OF_RELAXING } else { 1.0 };
    Scene { tolerance: margin * scene.tolerance, ..scene }
}

/// What a member's run follows of the relaxation of each part that has one.
pub(super) fn chains(scene: &Scene) -> Vec<Maxwell> {
    if !scene.body.composition.is_viscoelastic() {
        return Vec::new();
    }
    Description::new(scene).relaxations().into_iter().map(|(chain, _)| chain.clone()).collect()
}

/// What a modulus may differ by, over the tolerance, in bodies that share their local constants. Over a fall to a thirtieth a laminate's peak
/// force was seen to change by some 30% with them: 0.1 for each part of the modulus, half of which is left at the ends.
const OF_TOLERANCE: f64 = 4.0;

impl BodyOf {
    /// Of a scene. Of the chains of relaxing materials, and the temperature, there are those moduli alone by which the local field of the
    /// contact is made: each member gives the body its own chains ([`ModalBody::with_chains`](crate::body::ModalBody::with_chains)).
    pub fn new(scene: &Scene) -> Self {
        let time = OF_CONTACT * scene.impactor.contact_time();
        let materials = scene.body.composition.materials().into_iter().filter(|_| has_local_field(scene));
        let moduli = materials.filter_map(|material| Some(rounded(material.shear.as_ref()?.at(time), scene.tolerance)));
        Self { local: moduli.collect(), rates: rates_of(scene), ..Self::relaxing_anyhow(scene) }
    }

    /// The same for bodies that differ in the chains of relaxing materials, and are tested for each.
    pub fn of_relaxations(scene: &Scene) -> Self {
        let time = scene.body.composition.is_viscoelastic().then(|| scene.impactor.contact_time());
        Self {
            local: time.map(|time| rounded(time, scene.tolerance)).into_iter().collect(),
            ..Self::relaxing_anyhow(scene)
        }
    }

    fn relaxing_anyhow(scene: &Scene) -> Self {
        let Scene { mut body, supports, impactor, contact, load, time, output, .. } = scene.clone();
        let Impactor { point, direction, .. } = impactor;
        let (mut bulk, mut chains, mut alike) = (Vec::new(), Vec::new(), Vec::new());
        for material in body.composition.materials_mut() {
            if let Some(chain) = material.shear.take() {
                alike.push(chains.iter().position(|other| *other == chain).unwrap_or(chains.len()));
                chains.push(chain);
                // What a shear modulus leaves of its digits.
                bulk.push(format!("{:.8e}", material.bulk()));
                material.instantaneous = form::Material { young: 0.0, poisson: 0.0, ..material.instantaneous };
            }
        }
        body.temperature = None;
        let (initial, stress, local, rates) = (time.initial, output.stress, Vec::new(), Vec::new());
        Self { body, supports, point, direction, contact, load, initial, stress, bulk, alike, local, rates }
    }

    fn hash(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        format!("{self:?}").hash(&mut hasher);
        hasher.finish()
    }
}

/// Whether a body is made with moduli of the contact's time: a solid's field under the hit is its own, but for stresses.
pub(super) fn has_local_field(scene: &Scene) -> bool {
    scene.body.model != scene::Model::Solid || scene.output.stress
}

/// As [`BodyOf::rates`]; none of a body that does not relax.
fn rates_of(scene: &Scene) -> Vec<u32> {
    let chains = chains(scene);
    if chains.is_empty() {
        return Vec::new();
    }
    let first = rate(&shared(scene.clone()));
    let all = rates(&chains.iter().collect::<Vec<_>>(), first, scene.time.end);
    all.into_iter().map(|rate| (100.0 * rate / first).round() as u32).collect()
}

/// A value, as far as [`OF_TOLERANCE`] asks for it.
fn rounded(value: f64, tolerance: f64) -> String {
    let width = OF_TOLERANCE * tolerance;
    format!("{:.3e}", ((value.ln() / width).round() * width).exp())
}

/// A map from bodies.
#[derive(Debug)]
pub struct ByBody<T>(HashMap<u64, Vec<(BodyOf, T)>>);

impl<T> Default for ByBody<T> {
    fn default() -> Self {
        Self(HashMap::new())
    }
}

impl<T> ByBody<T> {
    /// What is kept of a body.
    pub fn get(&self, body: &BodyOf) -> Option<&T> {
        let alike = self.0.get(&body.hash())?;
        alike.iter().find(|(other, _)| other == body).map(|(_, kept)| kept)
    }

    /// What is kept of a body, made where it is missing.
    pub fn get_or_insert_with(&mut self, body: BodyOf, make: impl FnOnce() -> T) -> &mut T {
        let alike = self.0.entry(body.hash()).or_default();
        let place = alike.iter().position(|(other, _)| *other == body).unwrap_or_else(|| {
            alike.push((body, make()));
            alike.len() - 1
        });
        &mut alike[place].1
    }

    /// All that is kept.
    pub fn values(&self) -> impl Iterator<Item = &T> {
        self.0.values().flatten().map(|(_, kept)| kept)
    }

    /// How many bodies there are.
    pub fn len(&self) -> usize {
        self.0.values().map(Vec::len).sum()
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pane as a solid, whose members share a basis whatever their moduli, with a chain of its interlayer.
    fn pane(prony: &str) -> BodyOf {
        let glass = "[[body.layer]]\nthickness = 0.005\nmaterial = \"glass\"\n";
        let text = format!(
            "[body]\nsize = [0.3, 0.3]\nmodel = \"solid\"\n{glass}\
             [[body.layer]]\nthickness = 0.00076\nmaterial = \"interlayer\"\n{glass}\
             [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
             [material.interlayer]\nbulk = 2e9\ndensity = 1100.0\nshear = 3e6\nprony = [{prony}]\n\
             [impactor]\nmass = 2.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
             [time]\nend = 6e-4\n[output]\nstress = false\n"
        );
        BodyOf::new(&Scene::parse("test", &text, &[]).expect("a scene").0)
    }

    /// A basis for one rate is none for a body that falls to a small part of its modulus.
    #[test]
    fn bodies_of_other_rates_have_other_bases() {
        let little = pane("{ modulus = 1e6, time = 1e-4 }");
        assert_eq!(little.rates, [100]);
        assert_eq!(little, pane("{ modulus = 1.1e6, time = 9e-5 }"));
        let much = pane("{ modulus = 1e9, time = 1e-4 }");
        assert!(much.rates.len() > 1, "{:?}", much.rates);
        assert_ne!(little, much);
    }
}
