//! What is kept of each body of a sweep. A hash finds it; the descriptions themselves are compared.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use crate::form;
use crate::scene::{self, Contact, Impactor, Initial, Load, Scene, Support, Vec3};

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
}

impl BodyOf {
    /// Of a scene. The shear moduli of relaxing materials, and the temperature, are left out: each member gives the body its own
    /// ([`ModalBody::with_chains`](crate::body::ModalBody::with_chains)).
    pub fn new(scene: &Scene) -> Self {
        let Scene { mut body, supports, impactor, contact, load, time, output, .. } = scene.clone();
        let Impactor { point, direction, .. } = impactor;
        let mut bulk = Vec::new();
        for material in body.composition.materials_mut() {
            if material.shear.take().is_some() {
                // What a shear modulus leaves of its digits.
                bulk.push(format!("{:.8e}", material.bulk()));
                material.instantaneous = form::Material { young: 0.0, poisson: 0.0, ..material.instantaneous };
            }
        }
        body.temperature = None;
        Self { body, supports, point, direction, contact, load, initial: time.initial, stress: output.stress, bulk }
    }

    fn hash(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        format!("{self:?}").hash(&mut hasher);
        hasher.finish()
    }
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
