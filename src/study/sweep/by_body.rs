//! What is kept of each body of a sweep. A hash finds it; the descriptions themselves are compared.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use crate::form;
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
        Self { local: moduli.collect(), ..Self::relaxing_anyhow(scene) }
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
        let (initial, stress, local) = (time.initial, output.stress, Vec::new());
        Self { body, supports, point, direction, contact, load, initial, stress, bulk, alike, local }
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
