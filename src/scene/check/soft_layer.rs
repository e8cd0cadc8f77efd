//! Contact law on a layer that is softer than other layers of the body.

use std::f64::consts::PI;
use std::sync::Arc;

use super::super::{
    Composition, Contact, Impactor, Layer as Given, Parts, SoftContact, SoftLayer, Support, Vec3, faces,
};
use crate::contact::{ForceLaw, Hertz, Table};
use crate::stack::{ContactLaw, Layer, Sphere, Stack};

/// Largest Young's modulus of an impacted layer that counts as soft, as a fraction of the largest of all layers: if no other
/// layer is softer, and if one is, as in a laminate. (There an impacted ply also bends separately on its interlayer, which a wide
/// disc does not show.) Harder layers have Hertz's law of a half-space, as bodies of one material.
const SOFT: [f64; 2] = [0.99, 0.5];

/// Largest ξH of the longest wave, H the thickness of the stack. It is otherwise the longest wave on the body.
const LONGEST_WAVE: f64 = 0.05;

/// Law of the contact with the layers of a box, if the impacted one is soft and the impact is normal to it.
pub(super) fn law(
    size: Vec3,
    composition: &Composition,
    supports: &[Support],
    impactor: &Impactor,
    contact: Contact,
) -> SoftLayer {
    let Parts::Layers(given) = &composition.parts else { return SoftLayer::None };
    let ForceLaw::Hertz(Hertz { stiffness }) = impactor.force_law else { return SoftLayer::None };
    let is_normal = (impactor.direction[2].abs() - 1.0).abs() < 1e-9;
    if !is_normal || contact == Contact::Point {
        return SoftLayer::None;
    }
    let time = impactor.moduli_time();
    let of_layer = |layer: &Given| {
        let material = layer.material.at(time);
        Layer { thickness: layer.thickness, young: material.young, poisson: material.poisson }
    };
    let mut layers: Vec<Layer> = given.iter().map(of_layer).collect();
    if impactor.direction[2] > 0.0 {
        layers.reverse();
    }
    let struck = layers[0].young;
    let stiffest = layers.iter().map(|layer| layer.young).fold(0.0, f64::max);
    let is_on_softer = layers.iter().any(|layer| layer.young < struck);
    if struck >= SOFT[usize::from(is_on_softer)] * stiffest {
        return SoftLayer::None;
    }
    // Hertz's law has the instantaneous modulus of a viscoelastic layer. The stack has free faces.
    let is_elastic = given[composition.struck_layer].material.shear.is_none();
    let is_free = supports.iter().all(|support| faces(&support.surface).iter().all(|(axis, _)| *axis != 2));
    let room = [0, 1].map(|axis| 0.5 * size[axis] - impactor.point[axis].abs());
    let law = || {
        let (stack, radius) = (Stack::new(&layers).filter(|_| is_elastic && is_free)?, impactor.radius?);
        let sphere = Sphere { radius, modulus: 0.75 * stiffness / radius.sqrt() };
        let longest = (PI / size[0].max(size[1])).min(LONGEST_WAVE / stack.thickness());
        let energy = 0.5 * impactor.mass * impactor.speed.powi(2);
        let disc = SoftLayer::disc(stack.thickness()).min(room[0]).min(room[1]);
        let ContactLaw { points, compliance } = stack.contact_law(&sphere, longest, disc, energy)?;
        let of_law: Vec<[f64; 2]> = points.iter().map(|point| [point.indentation, point.force]).collect();
        let force_law = ForceLaw::Table(Table::new(&of_law).ok()?);
        Some(SoftContact {
            force_law,
            compliance,
            radii: points.iter().map(|point| [point.force, point.radius]).collect(),
        })
    };
    law().map_or(SoftLayer::Untreated, |contact| SoftLayer::Law(Arc::new(contact)))
}
