//! The layers of a plate whose materials differ: how the layerwise theory has them, and how they are hit.

mod local;

use std::f64::consts::TAU;

use super::geometry::{NAMES, PlateGeometry};
use super::{Settings, cells};
use crate::description::{Description, Part, Portion};
use crate::form::layerwise::{LayerModuli, Profile, rotation};
use crate::form::plate::Section;
use crate::form::tensor::{Part as Derivative, Square};
use crate::form::{Material, Spread};
use crate::scene::Scene;
use crate::stack::{self, Layerwise, Stack};

/// The disc is at least as wide as for a layer of this part of the stack's thickness.
const LEAST_LAYER: f64 = 0.125;

/// Part of the time of a contact with a half-space at which layers that relax have the modulus by which the plate's local constants are made.
pub const OF_CONTACT: f64 = 0.5;

/// κ of layers that do not shear.
const RIGID: f64 = 1e3;

/// Part of the stiffest layer's stiffness along the plate from which on a layer counts as one that bends.
const STIFF: f64 = 0.1;

/// Rounds in which the length of the contact's waves settles.
const ROUNDS: usize = 30;

/// A plate's layers, from the face that is hit.
#[derive(Debug, Clone)]
pub struct Laminate {
    /// How displacements run through them.
    pub(super) profile: Profile,
    parts: Vec<Part>,
    shear_factors: Vec<f64>,
    /// The theory of the infinite stack, as it is loaded and read; layers that relax have the shear modulus of the contact's time.
    pub(super) theory: Layerwise,
    /// Its pressure.
    pub(super) spread: Spread,
    /// The disc's radius, m.
    pub radius: f64,
    /// β of the reading w + β M, m/N.
    pub reading: f64,
    /// c of the whole plate, m/N: α = δ − c F.
    pub compliance: f64,
    /// Mass over an area, kg/m².
    mass: f64,
    /// All of the stack as a thin plate.
    section: stack::Section,
}

impl Laminate {
    /// Of a scene that is a plate, with its parts.
    ///
    /// # Errors
    /// Why its layers are none of a plate: a clause.
    pub(super) fn new(
        scene: &Scene,
        geometry: &PlateGeometry,
        parts: &[Part],
        settings: &Settings,
    ) -> Result<Self, String> {
        let mut parts = parts.to_vec();
        let ends = |part: &Part| match part.portion {
            Portion::Layer(ends) => Ok(ends),
            Portion::All | Portion::Volume(_) => Err("it has one material".to_owned()),
        };
        if geometry.normal != 2 {
            return Err(format!("its layers are across z, and it is hit along {}", NAMES[geometry.normal]));
        }
        // From the face that is hit.
        if geometry.sign < 0.0 {
            parts.reverse();
        }
        let thicknesses: Vec<f64> =
            parts.iter().map(|part| ends(part).map(|[low, high]| high - low)).collect::<Result<_, _>>()?;
        let count = parts.len();
        let is_mirrored = (0..count).all(|i| {
            let image = count - 1 - i;
            let is_alike = parts[i].material == parts[image].material;
            is_alike && (thicknesses[i] - thicknesses[image]).abs() <= 1e-9 * geometry.thickness
        });
        let time = OF_CONTACT * scene.impactor.contact_time();
        let layer = |(part, thickness): (&Part, &f64)| {
            let Material { young, poisson, .. } = part.material.at(time);
            stack::Layer { thickness: *thickness, young, poisson }
        };
        let layers: Vec<stack::Layer> = parts.iter().zip(&thicknesses).map(layer).collect();
        let stack = Stack::new(&layers).ok_or("a layer is no stable elastic solid")?;
        let section = stack::Section::new(&stack);
        let mut shear_factors = section.shear_factors(&stack);
        if settings.is_thin {
            let stiffest = layers.iter().map(|layer| layer.young).fold(0.0, f64::max);
            let of_stiff = shear_factors.iter_mut().zip(&layers).filter(|(_, layer)| layer.young >= STIFF * stiffest);
            of_stiff.for_each(|(factor, _)| *factor = RIGID);
        }
        let theory = Layerwise::new(&stack, &shear_factors).ok_or("a layer has no shear factor")?;
        let (spread, radius) = (Spread::new(0.0), disc(&thicknesses, geometry, settings));
        let edge = geometry.edges[0].max(geometry.edges[1]);
        let (reading, compliance) =
            if settings.is_thin { (0.0, 0.0) } else { local::constants(&theory, (&spread, radius), edge) };
        let density = |part: &Part| part.material.instantaneous.density;
        let mass = parts.iter().zip(&thicknesses).map(|(part, h)| density(part) * h).sum();
        let profile = Profile::new(&thicknesses, is_mirrored);
        let theory = theory.with_reading(reading);
        Ok(Self { profile, parts, shear_factors, theory, spread, radius, reading, compliance, mass, section })
    }

    /// The theory of the infinite stack as it is loaded and read, and the pressure.
    pub fn infinite(&self) -> (&Layerwise, &Spread) {
        (&self.theory, &self.spread)
    }

    /// Twice the elastic energy after all relaxation.
    pub(super) fn elastic(&self) -> Vec<Square<2>> {
        let of = |(part, kappa): (&Part, &f64)| LayerModuli::new(part.material.relaxed(), *kappa);
        self.profile.elastic(&self.with_factors().map(of).collect::<Vec<_>>())
    }

    /// Twice the energy of those layers which relax, for a unit of their shear modulus: of the parts with these numbers from below.
    pub(super) fn distortion(&self, geometry: &PlateGeometry, relaxing: &[usize]) -> Vec<Square<2>> {
        let count = self.parts.len();
        let is_relaxing =
            |layer: usize| relaxing.contains(&if geometry.sign < 0.0 { count - 1 - layer } else { layer });
        // Between the ends of the whole chain, so that it is the same at all temperatures.
        let of = |(layer, (part, kappa)): (usize, (&Part, &f64))| match &part.given {
            Some(chain) if is_relaxing(layer) => {
                LayerModuli::of_distortion(part.material.bulk(), [chain.equilibrium, chain.instantaneous()], *kappa)
            }
            _ => LayerModuli::default(),
        };
        self.profile.elastic(&self.with_factors().enumerate().map(of).collect::<Vec<_>>())
    }

    /// Twice the kinetic energy.
    pub(super) fn inertia(&self) -> Vec<Square<2>> {
        let densities: Vec<f64> = self.parts.iter().map(|part| part.material.instantaneous.density).collect();
        self.profile.mass(&densities)
    }

    /// The sum of forces on the layers' volumes along an axis of the scene, N/m².
    pub(super) fn force(&self, axis: usize) -> f64 {
        let heights = self.profile.heights.windows(2);
        heights.zip(&self.parts).map(|(ends, part)| part.force[axis] * (ends[1] - ends[0])).sum()
    }

    /// What is loaded and read beside w: derivatives of rotations, with their factors. M = Σ E′_i ∫ ζ φ_k dζ ∇·θ_k.
    pub(super) fn moments(&self) -> Vec<(f64, Derivative<2>)> {
        let layers = self.theory.stack().layers();
        let of_shape = |k: usize| -> f64 {
            let plane = |layer: &stack::Layer| layer.young / (1.0 - layer.poisson.powi(2));
            layers.iter().enumerate().map(|(i, layer)| plane(layer) * self.profile.moment(k, i)).sum()
        };
        let of = |k: usize| {
            let factor = self.reading * of_shape(k);
            [(factor, rotation(k, 0, [1, 0])), (factor, rotation(k, 1, [0, 1]))]
        };
        (0..self.profile.len()).flat_map(of).collect()
    }

    /// E and ν at once of the layer at a height, with κ of it.
    pub(super) fn law(&self, layer: usize) -> (Material, f64) {
        (self.parts[layer].material.instantaneous, self.shear_factors[layer])
    }

    /// Shear stress along the normal at a height over its mean in the layer, as long waves have it.
    pub(super) fn shear_over_mean(&self, height: f64) -> f64 {
        let stack = self.theory.stack();
        let layer = self.profile.layer_at(height);
        let mean = self.section.mean_shear(stack, layer);
        self.section.shear(stack, (height + 0.5 * stack.thickness()).clamp(0.0, stack.thickness())) / mean
    }

    /// By what part the static response of the infinite plate is off at the length of the contact's waves.
    pub fn mismatch(&self, scene: &Scene) -> f64 {
        let section = self.section(scene);
        let wavenumber = TAU / cells::wavelength(&section, cells::contact_time(&section, &scene.impactor));
        let stack = self.theory.stack();
        let exact = stack.wave(wavenumber).response(stack, 0.0).u_z;
        (self.theory.read(&self.theory.wave(wavenumber)) / exact - 1.0).abs()
    }

    /// A plate of one layer with the mass, and with the rigidity that the layers have for the waves of a contact: cells are made for these.
    pub(super) fn section(&self, scene: &Scene) -> Section {
        let stack = self.theory.stack();
        let struck = scene.body.struck();
        let thickness = stack.thickness();
        let unread = self.theory.clone().with_reading(0.0);
        let of_rigidity = |rigidity: f64| {
            let young = rigidity * 12.0 * (1.0 - struck.poisson.powi(2)) / thickness.powi(3);
            Section { thickness, young, poisson: struck.poisson, density: self.mass / thickness }
        };
        let mut section = of_rigidity(self.section.rigidity);
        for _ in 0..ROUNDS {
            let wavenumber = TAU / cells::wavelength(&section, cells::contact_time(&section, &scene.impactor));
            let deflection = unread.read(&unread.wave(wavenumber));
            // Half of each step, since a longer wave is that of a stiffer plate.
            let rigidity = (section.rigidity() / (deflection * wavenumber.powi(4))).sqrt();
            section = of_rigidity(rigidity);
        }
        section
    }

    /// The same, with the shear factors of another.
    #[cfg(test)]
    pub(super) fn with_shear_factors_of(self, other: &Self) -> Self {
        Self { shear_factors: other.shear_factors.clone(), ..self }
    }

    fn with_factors(&self) -> impl Iterator<Item = (&Part, &f64)> {
        self.parts.iter().zip(&self.shear_factors)
    }
}

/// By what part the layerwise theory's static response is off at the length of the contact's waves ([`Laminate::mismatch`]).
///
/// # Errors
/// A fault of `body.model` where the theory does not stand for the scene.
pub fn mismatch(scene: &Scene) -> crate::error::Result<f64> {
    Ok(of_scene(scene)?.mismatch(scene))
}

/// Length of the flexural waves of the contact with a layerwise plate, m, for which its cells are made.
///
/// # Errors
/// As [`mismatch`].
pub fn contact_wavelength(scene: &Scene) -> crate::error::Result<f64> {
    let section = of_scene(scene)?.section(scene);
    Ok(cells::wavelength(&section, cells::contact_time(&section, &scene.impactor)))
}

fn of_scene(scene: &Scene) -> crate::error::Result<Laminate> {
    let theory = super::PlateTheory::Layerwise;
    let laminate = super::geometry(scene, theory)
        .and_then(|plate| Laminate::new(scene, &plate, &Description::new(scene).parts, &Settings::default()));
    Ok(laminate.map_err(|reason| super::fault(theory, &reason))?)
}

/// Radius of the disc that is pressed, m: as wide as for a plate of the layer that is hit, which may bend by itself on a soft one, where
/// there is room.
fn disc(thicknesses: &[f64], geometry: &PlateGeometry, settings: &Settings) -> f64 {
    let layer = thicknesses[0].max(LEAST_LAYER * geometry.thickness);
    (settings.disc_over(layer) * layer).min(geometry.distance_to_edge())
}

/// The thickness (m) by which the distance from the hit to the edge is judged: a layer's that is hit.
pub(super) fn struck_thickness(scene: &Scene, thickness: f64) -> f64 {
    scene.body.struck_thickness(thickness).max(LEAST_LAYER * thickness)
}
