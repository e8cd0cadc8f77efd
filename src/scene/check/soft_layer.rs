//! Contact law on a layer that is softer than other layers of the body.

use std::f64::consts::PI;
use std::sync::Arc;

use super::super::{
    CLEAR_OF_SUPPORTS, Composition, Contact, Impactor, Layer as Given, Parts, SoftContact, SoftLayer, Support, Vec3,
    leave_free,
};
use crate::contact::{ForceLaw, Hertz, Table};
use crate::stack::{ContactLaw, Layer, Section, Sphere, Stack};

/// Largest Young's modulus of a soft impacted layer, as a fraction of the largest of all layers, if no other layer is softer.
const SOFT_OUTERMOST: f64 = 0.99;

/// The same if another layer is softer, as the interlayer of a laminate. A ply on an interlayer also bends separately, which a wide
/// disc does not show.
const SOFT_ON_SOFTER: f64 = 0.5;

/// Largest ξH of the longest wave, H the thickness of the stack. It is otherwise the longest wave on the body.
const LONGEST_WAVE: f64 = 0.05;

/// Radii of the disc that are tried, over the thickness of the stack. The first one is enough for layers such as plastic on glass.
/// Under a wider disc the law reaches larger forces, as on rubber. The soft layer does not bend separately, as a ply does, so that
/// the disc may be wider than under a ply.
const DISCS: [f64; 5] = [3.0, 4.5, 7.0, 10.0, 15.0];

/// Largest product of the disc's radius and the wavenumber of flexural waves at the frequency π/T, T the duration of a contact with
/// this law. The disc is treated as static; on plastic and polyurethane the force was wrong by 0.3% at 2, and by 6% at 3.2.
const LARGEST_PHASE: f64 = 2.0;

/// Energy that a law should store, over the energy of the impact.
const ENOUGH_ENERGY: f64 = 2.0;

/// Force that a law should reach, over the force Z v at which an infinite plate of the impedance Z moves as fast as the impactor.
const ENOUGH_FORCE: f64 = 2.0;

/// Least energy that a law must store, over the energy of the impact.
const LEAST_ENERGY: f64 = 1e-3;

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
    // From the layer that is hit on.
    let moduli = |time: f64| -> Vec<Layer> {
        let of_layer = |layer: &Given| {
            let material = layer.material.at(time);
            Layer { thickness: layer.thickness, young: material.young, poisson: material.poisson }
        };
        let mut layers: Vec<Layer> = given.iter().map(of_layer).collect();
        if impactor.direction[2] > 0.0 {
            layers.reverse();
        }
        layers
    };
    let layers = moduli(impactor.moduli_time());
    let struck = layers[0].young;
    let stiffest = layers.iter().map(|layer| layer.young).fold(0.0, f64::max);
    let is_on_softer = layers.iter().any(|layer| layer.young < struck);
    if struck >= if is_on_softer { SOFT_ON_SOFTER } else { SOFT_OUTERMOST } * stiffest {
        return SoftLayer::None;
    }
    // Hertz's law has the instantaneous modulus of a viscoelastic layer. The stack has free faces.
    let is_elastic = given[composition.struck_layer].material.shear.is_none();
    let is_free = leave_free(supports, (size, impactor.point, 2), CLEAR_OF_SUPPORTS);
    let room = [0, 1].map(|axis| 0.5 * size[axis] - impactor.point[axis].abs());
    let law = || {
        let (stack, radius) = (Stack::new(&layers).filter(|_| is_elastic && is_free)?, impactor.radius?);
        let sphere = Sphere { radius, modulus: 0.75 * stiffness / radius.sqrt() };
        let longest = (PI / size[0].max(size[1])).min(LONGEST_WAVE / stack.thickness());
        let energy = 0.5 * impactor.mass * impactor.speed.powi(2);
        let room = room[0].min(room[1]);
        let law = |stack: &Stack, disc: f64| stack.contact_law(&sphere, longest, disc, energy);
        let disc = match contact {
            Contact::Patch { disc: Some(given), .. } => given.min(room),
            _ => {
                // The disc does not depend on relaxation, so that all temperatures have the same cells.
                let stack = Stack::new(&moduli(0.0))?;
                let rigidity = Section::new(&stack).rigidity;
                let areal_density: f64 =
                    given.iter().map(|layer| layer.material.instantaneous.density * layer.thickness).sum();
                let impedance = 8.0 * (rigidity * areal_density).sqrt();
                let mut chosen = DISCS[0] * stack.thickness();
                for disc in DISCS.map(|factor| (factor * stack.thickness()).min(room)) {
                    let law = law(&stack, disc);
                    let Some(force_law) = table(&law) else { continue };
                    let duration = force_law.contact_time(impactor.mass, impactor.speed);
                    let wavenumber = (PI / duration).sqrt() * (areal_density / rigidity).powf(0.25);
                    if disc > chosen && disc * wavenumber > LARGEST_PHASE {
                        break;
                    }
                    chosen = disc;
                    let is_strong = law.largest_force() >= ENOUGH_FORCE * impedance * impactor.speed;
                    if is_strong || law.capacity() >= ENOUGH_ENERGY * energy {
                        break;
                    }
                }
                chosen
            }
        };
        let law = law(&stack, disc);
        let force_law = table(&law)?;
        let radii = law.points.iter().map(|point| [point.force, point.radius]).collect();
        let contact = SoftContact { force_law, compliance: law.compliance, radii, disc };
        (law.capacity() >= LEAST_ENERGY * energy).then_some(contact)
    };
    law().map_or(SoftLayer::Untreated, |contact| SoftLayer::Law(Arc::new(contact)))
}

/// Force law through the points of a contact; `None` if there are too few.
fn table(law: &ContactLaw) -> Option<ForceLaw> {
    let points: Vec<[f64; 2]> = law.points.iter().map(|point| [point.indentation, point.force]).collect();
    Table::new(&points).ok().map(ForceLaw::Table)
}
