//! Contact law on a layer that is much softer than other layers of the body.

use std::f64::consts::PI;

use super::super::{Composition, Contact, Impactor, Layer as Given, Parts, Vec3};
use crate::contact::{ForceLaw, Hertz, Table};
use crate::stack::{Layer, Sphere, Stack};

/// Largest Young's modulus of an impacted layer that counts as soft, as a fraction of the largest of all layers. Harder
/// layers have Hertz's law of a half-space, as bodies of one material.
const SOFT: f64 = 0.5;

/// Energy up to which the law is needed, over the energy of the impactor: repeated contacts and the weight add some.
const ENERGY: f64 = 2.0;

/// Largest ξH of the longest wave, H the thickness of the stack. It is otherwise the longest wave on the body.
const LONGEST_WAVE: f64 = 0.05;

/// Law of the contact with the layers of a box, if the impacted one is soft and the impact is normal to it; otherwise
/// `None`. Also `None` where the deflection of the stack under the contact disc exceeds the indentation: then the disc
/// matters little.
pub(super) fn law(size: Vec3, composition: &Composition, impactor: &Impactor, contact: Contact) -> Option<ForceLaw> {
    let Parts::Layers(layers) = &composition.parts else { return None };
    let ForceLaw::Hertz(Hertz { stiffness }) = impactor.force_law else { return None };
    let is_normal = (impactor.direction[2].abs() - 1.0).abs() < 1e-9;
    if !is_normal || contact == Contact::Point {
        return None;
    }
    let time = impactor.moduli_time();
    let of_layer = |layer: &Given| {
        let material = layer.material.at(time);
        Layer { thickness: layer.thickness, young: material.young, poisson: material.poisson }
    };
    let mut layers: Vec<Layer> = layers.iter().map(of_layer).collect();
    if impactor.direction[2] > 0.0 {
        layers.reverse();
    }
    let stiffest = layers.iter().map(|layer| layer.young).fold(0.0, f64::max);
    if layers[0].young >= SOFT * stiffest {
        return None;
    }
    let (stack, radius) = (Stack::new(&layers)?, impactor.radius?);
    let sphere = Sphere { radius, modulus: 0.75 * stiffness / radius.sqrt() };
    let longest = (PI / size[0].max(size[1])).min(LONGEST_WAVE / stack.thickness());
    let energy = ENERGY * 0.5 * impactor.mass * impactor.speed.powi(2);
    Table::new(&stack.contact_law(&sphere, longest, energy)?).ok().map(ForceLaw::Table)
}
