//! Layers of a plate, one or several: their model in the layerwise theory, and their local contact model.

mod frequency_ratios;
mod local;
pub mod profile;
mod waves;

pub use frequency_ratios::FrequencyRatios;
pub use waves::LayerwiseWaves;

use std::f64::consts::TAU;

use profile::{LayerModuli, Profile};

use super::geometry::{NAMES, PlateGeometry};
use super::{PlateTheory, Settings, cells};
use crate::contact::dent;
use crate::description::{Description, Part, Portion};
use crate::form::plate::Section;
use crate::form::tensor::{Derivative, Square};
use crate::form::{Material, Spread};
use crate::scene::Scene;
use crate::stack::{self, Layerwise, Stack};

/// Smallest thickness of the impacted layer used for the radius of the disc and for the error near edges, as a fraction
/// of the thickness of the stack.
pub const LEAST_LAYER: f64 = 0.125;

/// Smallest Young's modulus of a layer that counts as bending, as a fraction of the largest Young's modulus.
const STIFF: f64 = 0.1;

/// Number of iterations for the length of the waves of the contact.
const ROUNDS: usize = 30;

/// Layers of a plate, from the impacted face on.
#[derive(Debug, Clone)]
pub struct Layers {
    /// Variation of the displacements through the layers.
    pub(super) profile: Profile,
    parts: Vec<Part>,
    /// Layerwise theory of the infinite stack. Viscoelastic layers have their secant moduli at
    /// [`Impactor::moduli_time`](crate::scene::Impactor::moduli_time).
    pub(super) theory: Layerwise,
    /// Disc on which the plate is loaded and its displacement averaged; `None` for Kirchhoff's theory.
    pub disc: Option<Disc>,
    /// Local compliance c of the whole plate, m/N: α = δ − c F.
    pub compliance: f64,
    /// Mass per unit of area, kg/m².
    mass: f64,
    /// Section of the whole stack as a thin plate.
    section: stack::Section,
}

/// Disc under the impactor on a plate with transverse shear.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    /// Pressure on the disc.
    pub spread: Spread,
    /// Radius of the disc, m.
    pub radius: f64,
}

impl Layers {
    /// Layers of a plate-like scene with these parts, and their local contact model.
    ///
    /// # Errors
    /// The reason why the layers do not make a plate: a clause.
    pub(super) fn new(
        scene: &Scene,
        geometry: &PlateGeometry,
        parts: &[Part],
        theory: PlateTheory,
        settings: &Settings,
    ) -> Result<Self, String> {
        let layers = Self::without_local(scene, geometry, parts, theory, settings)?;
        let Some(disc) = layers.disc.filter(|_| !settings.is_thin) else { return Ok(layers) };
        let edge = geometry.edges[0].max(geometry.edges[1]);
        let compliance = local::compliance(&layers.theory, &disc, edge);
        let stack::Layer { young, poisson, .. } = layers.theory.stack().layers()[0];
        let struck = Material { young, poisson, density: 0.0 };
        // Under Hertz's law the dent of a half-space is part of the law; on a given area it is part of the surface's
        // displacement.
        let dent = geometry.area.as_ref().map_or(0.0, |area| dent(area, &struck, 1.0));
        Ok(Self { compliance: compliance + dent, ..layers })
    }

    /// Same as [`Self::new`] without the local contact model, whose integrals take most of the time.
    pub(super) fn without_local(
        scene: &Scene,
        geometry: &PlateGeometry,
        parts: &[Part],
        theory: PlateTheory,
        settings: &Settings,
    ) -> Result<Self, String> {
        let mut parts = parts.to_vec();
        // Order the parts from the impacted face.
        if geometry.sign < 0.0 {
            parts.reverse();
        }
        let thickness = |part: &Part| match part.portion {
            Portion::All | Portion::Volume(_) => Ok(geometry.thickness),
            Portion::Layer([low, high]) if geometry.normal == 2 => Ok(high - low),
            Portion::Layer(_) => {
                Err(format!("its layers are across z, and it is hit along {}", NAMES[geometry.normal]))
            }
        };
        let thicknesses: Vec<f64> = parts.iter().map(thickness).collect::<Result<_, _>>()?;
        let count = parts.len();
        let is_mirrored = (0..count).all(|i| {
            let image = count - 1 - i;
            let is_alike = parts[i].material == parts[image].material;
            is_alike && (thicknesses[i] - thicknesses[image]).abs() <= 1e-9 * geometry.thickness
        });
        let time = scene.impactor.moduli_time();
        let layer = |(part, thickness): (&Part, &f64)| stack::Layer::of(*thickness, &part.material.secant(time));
        let layers: Vec<stack::Layer> = parts.iter().zip(&thicknesses).map(layer).collect();
        let stack = Stack::new(&layers).ok_or("a layer is no stable elastic solid")?;
        let section = stack::Section::new(&stack);
        let is_kirchhoffs = theory == PlateTheory::Kirchhoff;
        let theory = if settings.is_thin || is_kirchhoffs {
            let stiffest = layers.iter().map(|layer| layer.young).fold(0.0, f64::max);
            Layerwise::thin(&stack, |layer| layer.young >= STIFF * stiffest)
        } else {
            Layerwise::new(&stack)
        };
        let disc = (!is_kirchhoffs).then(|| {
            let radius = disc_radius(scene, &thicknesses, geometry, settings);
            let (spread, radius) =
                geometry.area.as_ref().map_or((Spread::new(0.0), radius), |area| Spread::of_area(area, radius));
            Disc { spread, radius }
        });
        let density = |part: &Part| part.material.instantaneous.density;
        let mass = parts.iter().zip(&thicknesses).map(|(part, h)| density(part) * h).sum();
        let profile = match is_kirchhoffs {
            true => Profile::thin(geometry.thickness),
            false => Profile::new(&thicknesses, is_mirrored),
        };
        Ok(Self { profile, parts, theory, disc, compliance: 0.0, mass, section })
    }

    /// Whether there is a single layer.
    pub(super) fn is_one(&self) -> bool {
        self.parts.len() == 1
    }

    /// Layerwise theory of the infinite stack, as it is loaded and evaluated.
    pub fn theory(&self) -> &Layerwise {
        &self.theory
    }

    /// Forms of twice the elastic energy after all relaxation.
    pub(super) fn elastic(&self) -> Vec<Square<2>> {
        let of = |part: &Part| LayerModuli::new(part.material.relaxed());
        self.profile.elastic(&self.parts.iter().map(of).collect::<Vec<_>>(), self.theory.transverse())
    }

    /// Forms of twice the energy of viscoelastic layers for a unit shear modulus. `relaxing` holds the numbers of their
    /// parts, counted from below.
    pub(super) fn distortion(&self, geometry: &PlateGeometry, relaxing: &[usize]) -> Vec<Square<2>> {
        let count = self.parts.len();
        let is_relaxing =
            |layer: usize| relaxing.contains(&if geometry.sign < 0.0 { count - 1 - layer } else { layer });
        // The chord is taken between the ends of the whole Prony series, so that it is the same at all temperatures.
        let of = |(layer, part): (usize, &Part)| match &part.given {
            Some(chain) if is_relaxing(layer) => {
                LayerModuli::of_distortion(part.material.bulk(), [chain.equilibrium, chain.instantaneous()])
            }
            _ => LayerModuli::default(),
        };
        self.profile.elastic(&self.parts.iter().enumerate().map(of).collect::<Vec<_>>(), self.theory.transverse())
    }

    /// Forms of twice the kinetic energy.
    pub(super) fn inertia(&self) -> Vec<Square<2>> {
        let densities: Vec<f64> = self.parts.iter().map(|part| part.material.instantaneous.density).collect();
        self.profile.mass(&densities, self.theory.transverse())
    }

    /// Sum of the body forces of the layers along an axis of the scene, integrated over the thickness, N/m².
    pub(super) fn force(&self, axis: usize) -> f64 {
        let heights = self.profile.heights.windows(2);
        heights.zip(&self.parts).map(|(ends, part)| part.force[axis] * (ends[1] - ends[0])).sum()
    }

    /// Deflection of the loaded face minus the mean deflection w, as derivatives of rotations with their factors.
    pub(super) fn face_deflection(&self) -> Vec<(f64, Derivative<2>)> {
        self.profile.dilatation(&self.theory.transverse().face_deflection, [0, 0])
    }

    /// Instantaneous elastic constants of a layer.
    pub(super) fn material(&self, layer: usize) -> Material {
        self.parts[layer].material.instantaneous
    }

    /// Transverse shear stress along an axis at a height, as derivatives of fields with their factors. As for all
    /// stresses, a viscoelastic layer has its instantaneous moduli. In an elastic layer, the stress is computed with
    /// the secant moduli of its viscoelastic neighbours. Kirchhoff's theory has no shear stress.
    pub(super) fn shear_stress(&self, axis: usize, height: f64) -> Vec<(f64, Derivative<2>)> {
        if self.profile.is_thin() {
            return Vec::new();
        }
        let layer = self.profile.layer_at(height);
        let ends = &self.profile.heights[layer..layer + 2];
        let part = ((height - ends[0]) / (ends[1] - ends[0])).clamp(0.0, 1.0);
        let instantaneous = |part: &Part| part.material.instantaneous.lame().mu;
        let moduli: Vec<f64> = match &self.parts[layer].given {
            Some(_) => self.parts.iter().map(instantaneous).collect(),
            None => self.theory.stack().layers().iter().map(stack::Layer::shear).collect(),
        };
        let transverse = self.theory.transverse();
        let strains = transverse.stress(layer, part, &moduli).into_iter().zip(&transverse.shear);
        let of_strain = |(factor, strain): (f64, &stack::ShearStrain)| {
            let parts = self.profile.shear_strain(strain, axis).into_iter();
            parts.map(move |(of_part, part)| (factor * of_part, part))
        };
        strains.filter(|(factor, _)| *factor != 0.0).flat_map(of_strain).collect()
    }

    /// Single-layer plate with the mass of the stack and with its rigidity for the waves of the contact. The cell sizes
    /// are based on it.
    pub(super) fn section(&self, scene: &Scene) -> Section {
        let stack = self.theory.stack();
        let struck = scene.body.struck();
        let thickness = stack.thickness();
        let of_rigidity = |rigidity: f64| {
            let young = rigidity * 12.0 * (1.0 - struck.poisson.powi(2)) / thickness.powi(3);
            Section { thickness, young, poisson: struck.poisson, density: self.mass / thickness }
        };
        let mut section = of_rigidity(self.section.rigidity);
        // A single layer bends as a whole in all waves of the contact.
        let rounds = if self.is_one() { 0 } else { ROUNDS };
        for _ in 0..rounds {
            let wavenumber = TAU / cells::wavelength(&section, cells::contact_time(&section, &scene.impactor));
            let deflection = self.theory.face_deflection(&self.theory.wave(wavenumber));
            // Take the geometric mean of the old and the new rigidity, since the wavelength increases with the
            // rigidity.
            let rigidity = (section.rigidity() / (deflection * wavenumber.powi(4))).sqrt();
            section = of_rigidity(rigidity);
        }
        section
    }

    /// Copy of the layers with the shear strains and the deflections of another.
    #[cfg(test)]
    pub(super) fn with_theory_of(self, other: &Self) -> Self {
        Self { theory: other.theory.clone(), ..self }
    }
}

/// Exact frequencies of the flexural waves of a scene's stack, over those of the layerwise theory. Viscoelastic layers
/// must have been replaced by elastic ones.
///
/// # Errors
/// A fault of `body.model` if the theory cannot model the scene.
pub fn frequency_ratios(scene: &Scene) -> crate::error::Result<FrequencyRatios> {
    let (layers, geometry) = of_scene(scene)?;
    Ok(FrequencyRatios::new(&layers, &geometry))
}

/// Section of all layers together as a thin plate.
///
/// # Errors
/// Same as [`frequency_ratios()`].
pub(super) fn whole_section(scene: &Scene) -> crate::error::Result<Section> {
    Ok(of_scene(scene)?.0.section(scene))
}

/// Layers of a scene's plate without their local contact model, and the plate's geometry.
fn of_scene(scene: &Scene) -> crate::error::Result<(Layers, PlateGeometry)> {
    let theory = PlateTheory::Layerwise;
    let geometry = super::geometry(scene, theory).map_err(super::fault)?;
    let parts = Description::new(scene).parts;
    let layers = Layers::without_local(scene, &geometry, &parts, theory, &Settings::default()).map_err(super::fault)?;
    Ok((layers, geometry))
}

/// Radius of the loaded disc, m. It is as for a plate made of the impacted layer alone, which may bend separately on a
/// soft layer, and at most the distance to the edge. With the contact law of the layers it may be wider.
fn disc_radius(scene: &Scene, thicknesses: &[f64], geometry: &PlateGeometry, settings: &Settings) -> f64 {
    let layer = thicknesses[0].max(LEAST_LAYER * geometry.thickness);
    let radius = match scene.impactor.layered_contact() {
        Some(layered) if settings.disc_radius.is_none() => layered.disc,
        _ => settings.disc_over(layer) * layer,
    };
    radius.min(geometry.distance_to_edge())
}

/// Thickness (m) with which the distance from the impact point to the edge is compared: the thickness of the impacted
/// layer.
pub(super) fn struck_thickness(scene: &Scene, thickness: f64) -> f64 {
    scene.body.struck_thickness(thickness).max(LEAST_LAYER * thickness)
}
