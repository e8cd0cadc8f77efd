//! Contact law on a layer that does not behave like a half-space under the impactor: a soft layer on stiffer ones, or a stiff
//! layer that is thin compared with the contact.

use std::f64::consts::PI;
use std::sync::Arc;

use super::super::{
    CLEAR_OF_SUPPORTS, Composition, Contact, Impactor, Layer as Given, LayerEffect, LayeredContact, Parts, Support,
    Vec3, faces, leave_free,
};
use crate::contact::{ForceLaw, Hertz, LARGEST_PHASE, Table, zener};
use crate::stack::{ContactLaw, ContactPoint, Layer, Section, Sphere, SphereOnStack, Stack};

/// Largest Young's modulus of a soft impacted layer, as a fraction of the largest of all layers, if no other layer is softer.
const SOFT_OUTERMOST: f64 = 0.99;

/// The same if another layer is softer, as the interlayer of a laminate. A ply on an interlayer also bends separately, which a wide
/// disc does not show.
const SOFT_ON_SOFTER: f64 = 0.5;

/// Largest difference of Poisson's ratios of layers that are alike.
const ALIKE: f64 = 0.01;

/// Largest contact radius by Hertz's law, over the thickness of a stiff impacted layer, for which it counts as a half-space. At this
/// ratio the force was wrong by 0.3 to 0.4%; the error grows with the ratio: a factor of two on 10 µm of ceramic on glass, and of six on 1 µm.
const WIDEST_HERTZIAN: f64 = 0.3;

/// Upper limit of ξH where the integral over wavenumbers ξ begins, H the thickness of the stack. On larger bodies it begins at the longest wave on the body.
const LONGEST_WAVE: f64 = 0.05;

/// Radii of the disc that are tried under a soft layer, over the thickness of the stack. The first one is enough for layers such as
/// plastic on glass. Under a wider disc the law reaches larger forces, as on rubber. The soft layer does not bend separately, as a
/// ply does, so that the disc may be wider than under a ply.
const DISCS_UNDER_SOFT: [f64; 5] = [3.0, 4.5, 7.0, 10.0, 15.0];

/// First radius under a stiff layer, which may bend separately, over its thickness.
const DISC_OVER_STIFF: f64 = 2.0;

/// Least thickness of a stiff layer for that radius, over the thickness of the stack.
const LEAST_STIFF: f64 = 0.125;

/// Ratio of a radius under a stiff layer to the one tried before.
const DISC_GROWTH: f64 = 1.5;

/// Energy that a law should store, over the energy of the impact.
const ENOUGH_ENERGY: f64 = 2.0;

/// Force that the law of a soft layer should reach, over the force Z v at which an infinite plate of the impedance Z moves as fast
/// as the impactor. A run stops at the end of this law.
const ENOUGH_FORCE_ON_SOFT: f64 = 2.0;

/// The same for a stiff layer, whose law is continued. Until echoes from the edges return, the force remains below Z v. A larger
/// ratio needs a wider disc, where the static field neglects waves: on plies of 3 mm the force was 0.9 to 1.2% too large with 2, and
/// 0.4 to 0.7% with 1.25.
const ENOUGH_FORCE_ON_STIFF: f64 = 1.25;

/// Ratio by which the largest force of a law is raised for a stiff layer.
const CONTINUED: f64 = 100.0;

/// Least energy that a law must store, over the energy of the impact.
const LEAST_ENERGY: f64 = 1e-3;

/// Least wavenumber of the waves in the contact with one layer, times its thickness. Longer waves bend the body as a whole.
const LEAST_WAVENUMBER: f64 = 1e-3;

/// Thickness and Young's modulus of rigid ground under a layer, over those of the layer.
const GROUND: [f64; 2] = [2.0, 1e4];

/// Law of the contact with the layers of a box, if the impacted one is soft or thin and the impact is normal to it.
pub(super) fn law(
    size: Vec3,
    composition: &Composition,
    supports: &[Support],
    impactor: &Impactor,
    contact: Contact,
) -> LayerEffect {
    let ForceLaw::Hertz(Hertz { stiffness }) = impactor.force_law else { return LayerEffect::Negligible };
    if composition.uniform().is_some() && contact != Contact::Point {
        let error = error_on_one_layer(size, composition, supports, impactor);
        return error.map_or(LayerEffect::Negligible, LayerEffect::Estimated);
    }
    let Parts::Layers(given) = &composition.parts else { return LayerEffect::Negligible };
    let is_normal = (impactor.direction[2].abs() - 1.0).abs() < 1e-9;
    if !is_normal || contact == Contact::Point {
        return LayerEffect::Negligible;
    }
    // Ordered from the layer that is hit.
    let moduli = |time: f64| -> Vec<Layer> {
        let of_layer = |layer: &Given| {
            let material = layer.material.secant(time);
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
    let is_soft = struck < if is_on_softer { SOFT_ON_SOFTER } else { SOFT_OUTERMOST } * stiffest;
    // Neither the choice of the law nor its disc depends on relaxation, so that all temperatures have the same cells.
    let Some(plate) = Plate::new(&moduli(0.0), given) else { return LayerEffect::Negligible };
    // Layers alike are one.
    let is_alike = |layer: &&Layer| {
        let is_as_stiff = layer.young >= SOFT_OUTERMOST * struck && SOFT_OUTERMOST * layer.young <= struck;
        is_as_stiff && (layer.poisson - layers[0].poisson).abs() <= ALIKE
    };
    let alike = layers.iter().take_while(is_alike).count();
    let thickness: f64 = layers[..alike].iter().map(|layer| layer.thickness).sum();
    let is_narrow = || {
        let is_narrow_by = |indentation: IndentationFormula| {
            plate.contact_radius(impactor, indentation) <= WIDEST_HERTZIAN * thickness
        };
        // The limit in closed form comes first: it is much quicker and usually suffices.
        is_narrow_by(zener::peak_indentation_limit) || is_narrow_by(zener::peak_indentation)
    };
    if !is_soft && (alike == layers.len() || is_narrow()) {
        return LayerEffect::Negligible;
    }
    // Hertz's law has the instantaneous modulus of a viscoelastic layer. The stack has free faces.
    let is_elastic = given[composition.struck_layer].material.shear.is_none();
    let is_free = leave_free(supports, (size, impactor.point, 2), CLEAR_OF_SUPPORTS);
    let given_disc = if let Contact::Patch { disc, .. } = contact { disc } else { None };
    let room = [0, 1].map(|axis| 0.5 * size[axis] - impactor.point[axis].abs());
    let law = || -> Result<LayeredContact, &'static str> {
        if !is_elastic {
            return Err("the layer is viscoelastic");
        }
        if !is_free {
            return Err("a support on the upper or the lower face is less than two thicknesses from the hit");
        }
        let radius = impactor.radius.ok_or("impactor.radius is not given")?;
        let stack = Stack::new(&layers).ok_or("a layer is no stable elastic solid")?;
        let sphere = Sphere { radius, modulus: 0.75 * stiffness / radius.sqrt() };
        let longest = (PI / size[0].max(size[1])).min(LONGEST_WAVE / stack.thickness());
        let speed = impactor.contact_speed();
        let energy = 0.5 * impactor.mass * speed.powi(2);
        let room = room[0].min(room[1]);
        let mut contact = SphereOnStack::new(&plate.stack, sphere, longest, energy);
        let enough_force = if is_soft { ENOUGH_FORCE_ON_SOFT } else { ENOUGH_FORCE_ON_STIFF };
        let is_enough = |law: &ContactLaw| {
            law.largest_force() >= enough_force * plate.impedance() * speed || law.capacity() >= ENOUGH_ENERGY * energy
        };
        let candidates = given_disc.map_or_else(|| plate.discs(is_soft), |disc| vec![disc]);
        let mut disc = candidates[0].min(room);
        for wider in candidates.into_iter().map(|disc| disc.min(room)) {
            let law = contact.on_disc(wider);
            let Some(force_law) = table(&law) else { continue };
            let duration = match is_soft {
                true => force_law.contact_time(impactor.timing_mass, speed),
                false => plate.rise_time(impactor),
            };
            if wider > disc && wider * plate.wavenumber(duration) > LARGEST_PHASE {
                break;
            }
            disc = wider;
            if is_enough(&law) {
                break;
            }
        }
        // A stiff layer has Hertz's law rather than one that ends before the first peak.
        if !is_soft && !is_enough(&contact.on_disc(disc)) {
            return Err(match given_disc {
                Some(_) => {
                    "with this contact.disc_radius, the law of a sphere on the layers ends before the force that it should reach (increase \
                     contact.disc_radius, or leave it out and a radius is chosen)"
                }
                None => {
                    "with each admissible radius of the disc, the law of a sphere on the layers ends before the force that it should reach \
                     (the disc must be small compared with the waves, and must not reach an edge; contact.disc_radius gives another radius)"
                }
            });
        }
        let mut contact = SphereOnStack::new(&stack, sphere, longest, energy);
        let law = contact.on_disc(disc);
        let ends_at_once = "the law of a sphere on the layers ends almost at once, as it does near an edge";
        let law = if is_soft { law } else { continued(law) };
        let force_law = table(&law).filter(|_| law.capacity() >= LEAST_ENERGY * energy).ok_or(ends_at_once)?;
        let radii = contact.radii(law.largest_force());
        Ok(LayeredContact { force_law, compliance: law.compliance, radii, disc })
    };
    law().map_or_else(LayerEffect::Untreated, |contact| LayerEffect::Law(Arc::new(contact)))
}

/// Estimated relative error of the force by Hertz's law on a box of one material; `None` if the contact is small compared with the
/// thickness. The local contact with the layer, free or on rigid ground, stores the same energy at another force. The estimate is
/// larger than the error, since the rest of the body is in series with the contact.
fn error_on_one_layer(size: Vec3, composition: &Composition, supports: &[Support], impactor: &Impactor) -> Option<f64> {
    let Impactor { stiffness, point, .. } = *impactor;
    let axis = faces::struck_axis(size, point, impactor.direction);
    let (material, thickness, radius) = (composition.struck, size[axis], impactor.radius?);
    let layer = Layer { thickness, young: material.young, poisson: material.poisson };
    let is_free = leave_free(supports, (size, point, axis), CLEAR_OF_SUPPORTS);
    let stack = Stack::new(&[layer])?;
    let areal_density = material.density * thickness;
    let mut plate = Plate { rigidity: Section::new(&stack).rigidity, areal_density, stack };
    let speed = impactor.contact_speed();
    let impedance = if is_free { plate.impedance() } else { f64::INFINITY };
    let indentation = zener::peak_indentation_limit(stiffness, impactor.timing_mass, speed, impedance);
    if (radius * indentation).sqrt() <= WIDEST_HERTZIAN * thickness {
        return None;
    }
    if !is_free {
        let ground = Layer { thickness: GROUND[0] * thickness, young: GROUND[1] * material.young, ..layer };
        plate.stack = Stack::new(&[layer, ground])?;
    }
    let hertz = ForceLaw::Hertz(Hertz { stiffness });
    let energy = hertz.potential(indentation);
    let sphere = Sphere { radius, modulus: 0.75 * stiffness / radius.sqrt() };
    let longest = plate.wavenumber(plate.rise_time(impactor)).min(1.0 / thickness).max(LEAST_WAVENUMBER / thickness);
    let law = SphereOnStack::new(&plate.stack, sphere, longest, energy).at_point();
    let table = table(&law).filter(|_| law.capacity() >= energy);
    Some(table.map_or(1.0, |law| (law.peak_force(2.0 * energy, 1.0) / hertz.force(indentation) - 1.0).abs()))
}

/// Formula of an indentation (m) from the stiffness of Hertz's law, the mass (kg), the speed (m/s) and the impedance (N s/m).
type IndentationFormula = fn(f64, f64, f64, f64) -> f64;

/// All layers together as a thin plate, before any relaxation.
struct Plate {
    stack: Stack,
    /// Flexural rigidity, N m.
    rigidity: f64,
    /// Mass per unit of area, kg/m².
    areal_density: f64,
}

impl Plate {
    /// Plate of `layers`, from the struck one on; `None` if a layer is no stable elastic solid.
    fn new(layers: &[Layer], given: &[Given]) -> Option<Self> {
        let stack = Stack::new(layers)?;
        let rigidity = Section::new(&stack).rigidity;
        let areal_density = given.iter().map(|layer| layer.material.instantaneous.density * layer.thickness).sum();
        Some(Self { stack, rigidity, areal_density })
    }

    /// Zener's impedance, N s/m.
    fn impedance(&self) -> f64 {
        8.0 * (self.rigidity * self.areal_density).sqrt()
    }

    /// Wavenumber (1/m) of flexural waves at the frequency π/T of a contact of the duration T (s).
    fn wavenumber(&self, duration: f64) -> f64 {
        (PI / duration).sqrt() * (self.areal_density / self.rigidity).powf(0.25)
    }

    /// Twice the time (s) in which Hertz's force on a half-space that does not slow the impactor down reaches the force that
    /// this plate's impedance allows: about the duration of the rise of the force.
    fn rise_time(&self, impactor: &Impactor) -> f64 {
        let rise = (self.impedance() / impactor.stiffness).powf(2.0 / 3.0) / impactor.contact_speed().cbrt();
        impactor.contact_time().min(2.0 * rise)
    }

    /// Contact radius by Hertz's law at the largest indentation without echoes, m; 0 for an impactor without a radius.
    fn contact_radius(&self, impactor: &Impactor, indentation: IndentationFormula) -> f64 {
        let Impactor { stiffness, mass, radius, .. } = *impactor;
        (radius.unwrap_or_default() * indentation(stiffness, mass, impactor.contact_speed(), self.impedance())).sqrt()
    }

    /// Radii of the disc to try, m, ascending.
    fn discs(&self, is_soft: bool) -> Vec<f64> {
        let thickness = self.stack.thickness();
        if is_soft {
            return DISCS_UNDER_SOFT.map(|factor| factor * thickness).to_vec();
        }
        let first = DISC_OVER_STIFF * self.stack.layers()[0].thickness.max(LEAST_STIFF * thickness);
        let last = DISCS_UNDER_SOFT[DISCS_UNDER_SOFT.len() - 1] * thickness;
        std::iter::successors(Some(first), |disc| Some(DISC_GROWTH * disc)).take_while(|disc| *disc <= last).collect()
    }
}

/// The law of a stiff layer, continued along its last chord. On a supported body a heavy impactor presses far longer than the first
/// peak lasts; the indentation is then small compared with the deflection of the body, which determines the force.
fn continued(mut law: ContactLaw) -> ContactLaw {
    if let [.., before, last] = law.points[..] {
        let slope = (last.force - before.force) / (last.indentation - before.indentation);
        let force = CONTINUED * last.force;
        let indentation = last.indentation + (force - last.force) / slope;
        law.points.push(ContactPoint { indentation, force });
    }
    law
}

/// Force law through the points of a contact; `None` if there are too few.
fn table(law: &ContactLaw) -> Option<ForceLaw> {
    let points: Vec<[f64; 2]> = law.points.iter().map(|point| [point.indentation, point.force]).collect();
    Table::new(&points).ok().map(ForceLaw::Table)
}
