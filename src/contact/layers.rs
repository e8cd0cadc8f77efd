//! Contact law on a layer that does not behave like a half-space under the impactor: a soft layer on stiffer ones, or a stiff
//! layer that is thin compared with the contact.

use std::f64::consts::PI;
use std::sync::Arc;

use super::{Blow, ForceLaw, Hertz, LARGEST_PHASE, Table, hertz, zener};
use crate::form;
use crate::material::Material;
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

/// Effect of the layers below the impacted one on the contact.
#[derive(Debug, Clone, PartialEq)]
pub enum LayerEffect {
    /// The impacted layer is like a half-space, or Hertz's law is not asked for.
    Negligible,
    /// The only layer is treated as a half-space, which gives the force an estimated relative error: the contact is not small
    /// compared with the thickness.
    Estimated(f64),
    /// Law on plates, and on spline solids without a patch of a given radius.
    Law(Arc<LayeredContact>),
    /// The layer is treated as a half-space, which is inaccurate. The reason is a clause.
    Untreated(&'static str),
}

/// Contact with a stack of layers.
#[derive(Debug, Clone, PartialEq)]
pub struct LayeredContact {
    /// Law in place of F(α). Its indentation is the approach minus the mean displacement of the loaded disc on an infinite
    /// plate.
    pub force_law: ForceLaw,
    /// Part of a body's local compliance c_l (m/N) that this law leaves out, because its indentation is not that of Hertz's
    /// law.
    pub compliance: f64,
    /// Forces (N) with the contact radius (m) at each.
    pub radii: Vec<[f64; 2]>,
    /// Radius of the disc on which bodies carry the force, m.
    pub disc: f64,
}

impl LayeredContact {
    /// Contact radius (m) at a force (N): a power of the force between the known ones.
    pub fn radius(&self, force: f64) -> f64 {
        let number = self.radii.partition_point(|[at, _]| *at < force).clamp(1, self.radii.len() - 1);
        let ([f0, r0], [f1, r1]) = (self.radii[number - 1], self.radii[number]);
        // From the first touch on the contact is Hertz's.
        let exponent = if f0 > 0.0 { (r1 / r0).ln() / (f1 / f0).ln() } else { 1.0 / 3.0 };
        r1 * (force.max(0.0) / f1).powf(exponent)
    }
}

/// Hit of an impactor with Hertz's law on a face of layers.
pub(crate) struct HitOnLayers {
    /// What the impactor brings to the contact.
    pub blow: Blow,
    /// Mass (kg) that determines how long contacts last.
    pub timing_mass: f64,
    /// Radius of the impactor, m.
    pub radius: Option<f64>,
    /// Whether no support is on this face or the one opposite near the impact point.
    pub is_free: bool,
    /// Longest edge of the face, m.
    pub longest_edge: f64,
    /// Distance of the impact point from the nearest edge, m.
    pub room: f64,
    /// Given radius of the disc on which the body carries the force, m.
    pub disc: Option<f64>,
}

impl HitOnLayers {
    /// Duration of a contact with a half-space, s.
    fn contact_time(&self) -> f64 {
        hertz::contact_time(self.blow.stiffness, self.timing_mass, self.blow.speed)
    }

    /// Effect of several layers, each with its thickness (m), from the one that is hit.
    pub fn on_layers(&self, given: &[(f64, Material)]) -> LayerEffect {
        let moduli = |time: f64| -> Vec<Layer> {
            let of_layer = |(thickness, material): &(f64, Material)| Layer::of(*thickness, &material.secant(time));
            given.iter().map(of_layer).collect()
        };
        // Half of the contact, as for static local fields.
        let layers = moduli(0.5 * self.contact_time());
        let struck = layers[0].young;
        let stiffest = layers.iter().map(|layer| layer.young).fold(0.0, f64::max);
        let is_on_softer = layers.iter().any(|layer| layer.young < struck);
        let is_soft = struck < if is_on_softer { SOFT_ON_SOFTER } else { SOFT_OUTERMOST } * stiffest;
        // Neither the choice of the law nor its disc depends on relaxation, so that all temperatures have the same cells.
        let areal_density = given.iter().map(|(thickness, material)| material.instantaneous.density * thickness).sum();
        let Some(plate) = Plate::new(&moduli(0.0), areal_density) else { return LayerEffect::Negligible };
        // Layers alike are one.
        let is_alike = |layer: &&Layer| {
            let is_as_stiff = layer.young >= SOFT_OUTERMOST * struck && SOFT_OUTERMOST * layer.young <= struck;
            is_as_stiff && (layer.poisson - layers[0].poisson).abs() <= ALIKE
        };
        let alike = layers.iter().take_while(is_alike).count();
        let thickness: f64 = layers[..alike].iter().map(|layer| layer.thickness).sum();
        let is_narrow_by = |indentation: fn(f64, f64, f64, f64) -> f64| {
            let Blow { stiffness, mass, speed } = self.blow;
            let indentation = indentation(stiffness, mass, speed, plate.impedance());
            (self.radius.unwrap_or_default() * indentation).sqrt() <= WIDEST_HERTZIAN * thickness
        };
        // The limit in closed form comes first: it is much quicker and usually suffices.
        let is_narrow = || is_narrow_by(zener::peak_indentation_limit) || is_narrow_by(zener::peak_indentation);
        if !is_soft && (alike == layers.len() || is_narrow()) {
            return LayerEffect::Negligible;
        }
        // Hertz's law has the instantaneous modulus of a viscoelastic layer.
        let law = match given[0].1.shear {
            None => self.law(&layers, is_soft, &plate),
            Some(_) => Err("the layer is viscoelastic"),
        };
        law.map_or_else(LayerEffect::Untreated, |contact| LayerEffect::Law(Arc::new(contact)))
    }

    /// Law of the contact with `layers`, which make a `plate`.
    ///
    /// # Errors
    /// The reason why there is none, as a clause.
    fn law(&self, layers: &[Layer], is_soft: bool, plate: &Plate) -> Result<LayeredContact, &'static str> {
        // The stack has free faces.
        if !self.is_free {
            return Err("a support on the upper or the lower face is less than two thicknesses from the hit");
        }
        let Blow { mass, speed, .. } = self.blow;
        let sphere = self.sphere().ok_or("impactor.radius is not given")?;
        let stack = Stack::new(layers).ok_or("a layer is no stable elastic solid")?;
        let longest = (PI / self.longest_edge).min(LONGEST_WAVE / stack.thickness());
        let energy = 0.5 * mass * speed.powi(2);
        let mut contact = SphereOnStack::new(&plate.stack, sphere, longest, energy);
        let enough_force = if is_soft { ENOUGH_FORCE_ON_SOFT } else { ENOUGH_FORCE_ON_STIFF };
        let is_enough = |law: &ContactLaw| {
            law.largest_force() >= enough_force * plate.impedance() * speed || law.capacity() >= ENOUGH_ENERGY * energy
        };
        let candidates = self.disc.map_or_else(|| plate.discs(is_soft), |disc| vec![disc]);
        let mut disc = candidates[0].min(self.room);
        for wider in candidates.into_iter().map(|disc| disc.min(self.room)) {
            let law = contact.on_disc(wider);
            let Some(force_law) = table(&law) else { continue };
            let duration = match is_soft {
                true => force_law.contact_time(self.timing_mass, speed),
                false => self.rise_time(plate),
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
            return Err(match self.disc {
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
    }

    /// Estimated relative error of the force by Hertz's law on one layer; `None` if the contact is small compared with its
    /// thickness (m). The local contact with the layer, free or on rigid ground, stores the same energy at another force. The
    /// estimate is larger than the error, since the rest of the body is in series with the contact.
    pub fn error_on_layer(&self, thickness: f64, material: &form::Material) -> Option<f64> {
        let (Blow { stiffness, speed, .. }, sphere) = (self.blow, self.sphere()?);
        let layer = Layer::of(thickness, material);
        let mut plate = Plate::new(&[layer], material.density * thickness)?;
        let impedance = if self.is_free { plate.impedance() } else { f64::INFINITY };
        let indentation = zener::peak_indentation_limit(stiffness, self.timing_mass, speed, impedance);
        if (sphere.radius * indentation).sqrt() <= WIDEST_HERTZIAN * thickness {
            return None;
        }
        if !self.is_free {
            let ground = Layer { thickness: GROUND[0] * thickness, young: GROUND[1] * material.young, ..layer };
            plate.stack = Stack::new(&[layer, ground])?;
        }
        let hertz = ForceLaw::Hertz(Hertz { stiffness });
        let energy = hertz.potential(indentation);
        let longest = plate.wavenumber(self.rise_time(&plate)).min(1.0 / thickness).max(LEAST_WAVENUMBER / thickness);
        let law = SphereOnStack::new(&plate.stack, sphere, longest, energy).at_point();
        let table = table(&law).filter(|_| law.capacity() >= energy);
        Some(table.map_or(1.0, |law| (law.peak_force(2.0 * energy, 1.0) / hertz.force(indentation) - 1.0).abs()))
    }

    /// The impactor's end, with the modulus by which it has its Hertz's law.
    fn sphere(&self) -> Option<Sphere> {
        self.radius.map(|radius| Sphere { radius, modulus: 0.75 * self.blow.stiffness / radius.sqrt() })
    }

    /// Twice the time (s) in which Hertz's force on a half-space that does not slow the impactor down reaches the force that
    /// the plate's impedance allows: about the duration of the rise of the force.
    fn rise_time(&self, plate: &Plate) -> f64 {
        let rise = (plate.impedance() / self.blow.stiffness).powf(2.0 / 3.0) / self.blow.speed.cbrt();
        self.contact_time().min(2.0 * rise)
    }
}

/// All layers together as a thin plate, before any relaxation.
struct Plate {
    stack: Stack,
    /// Flexural rigidity, N m.
    rigidity: f64,
    /// Mass per unit of area, kg/m².
    areal_density: f64,
}

impl Plate {
    /// Plate of `layers`, from the struck one; `None` if a layer is no stable elastic solid.
    fn new(layers: &[Layer], areal_density: f64) -> Option<Self> {
        let stack = Stack::new(layers)?;
        Some(Self { rigidity: Section::new(&stack).rigidity, areal_density, stack })
    }

    /// Zener's impedance, N s/m.
    fn impedance(&self) -> f64 {
        8.0 * (self.rigidity * self.areal_density).sqrt()
    }

    /// Wavenumber (1/m) of flexural waves at the frequency π/T of a contact of the duration T (s).
    fn wavenumber(&self, duration: f64) -> f64 {
        (PI / duration).sqrt() * (self.areal_density / self.rigidity).powf(0.25)
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
