//! Waves of an infinite plate under the impactor, which describe a finite plate before its first echo.

use std::f64::consts::PI;

use crate::body::{InfinitePlate, ModeCount, VECTORS_PER_MODE};
use crate::contact::zener;
use crate::description::Description;
use crate::error::Result;
use crate::form::Material;
use crate::form::plate::Section;
use crate::material::Maxwell;
use crate::scene::Scene;

use super::geometry::PlateGeometry;
use super::layers::LayerwiseWaves;
use super::{Layers, PlateTheory, Points, Settings};

/// Ratio of successive wavenumbers at which waves are evaluated.
const STEP: f64 = 1.05;

/// Largest wavenumber times the radius of the disc. Shorter waves hardly change the mean displacement over the disc.
const SHORTEST: f64 = 40.0;

/// Fraction of the largest modal density below which the density is neglected.
const NEGLECTED_DENSITY: f64 = 1e-4;

/// Rate at which the moduli of viscoelastic layers are taken for short waves, times the contact time on a half-space: the
/// shift of a basis for a tolerance of 1e-2.
const RATE_TIMES_CONTACT: f64 = 15.0;

/// First estimate of the infinite plate's response to a force at a point, by thin-plate theory. A laminate is replaced
/// by a single layer of its mass, and of its rigidity at the wavelength of the contact.
///
/// # Errors
/// A fault of `body.model` if the theory cannot model the scene.
pub fn infinite_plate(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<InfinitePlate> {
    let geometry = super::geometry(scene, theory).map_err(super::fault)?;
    let parts = Description::new(scene).parts;
    let layers = Layers::without_local(scene, &geometry, &parts, theory, settings).map_err(super::fault)?;
    Ok(of_section(&geometry, &layers.section(scene), None))
}

/// Number of uncoupled symmetry classes of a scene's plate.
///
/// # Errors
/// A fault of `body.model` if the theory cannot model the scene.
pub fn classes_of_motions(scene: &Scene, theory: PlateTheory) -> Result<usize> {
    Ok(super::geometry(scene, theory).map_err(super::fault)?.classes.len())
}

/// Response of the infinite plate for a discretised plate. The moduli of viscoelastic layers are those at `rate` (1/s).
pub(super) fn of_points(points: &Points, relaxations: &[(&Maxwell, Vec<usize>)], rate: f64) -> InfinitePlate {
    let Points { geometry, section, layers, .. } = points;
    let waves = LayerwiseWaves::new(layers, geometry, relaxations, rate);
    let mut plate = of_section(geometry, section, waves.as_ref());
    // The number of vectors per mode was measured with the modes of thin plates on one layer, whose shear adds few modes.
    if let Some(waves) = waves.filter(|_| !layers.is_one()) {
        plate.modes.dispersion = dispersion(section, &waves);
    }
    plate
}

/// The rate at which viscoelastic layers have their moduli in a scene's waves, 1/s.
pub(super) fn rate(scene: &Scene) -> f64 {
    RATE_TIMES_CONTACT / scene.impactor.contact_time()
}

/// Response of the infinite plate for the modelled part of a plate, with all its symmetry classes. Without `waves` it is a
/// thin plate loaded at a point.
fn of_section(geometry: &PlateGeometry, section: &Section, waves: Option<&LayerwiseWaves>) -> InfinitePlate {
    let (edges, multiplicity) = (geometry.edges, geometry.multiplicity());
    let classes = geometry.classes.len() as f64;
    let material = Material { young: section.young, poisson: section.poisson, density: section.density };
    // ξ² = ω √(ρh/D) for long waves.
    let slowness = (section.density * section.thickness / section.rigidity()).sqrt();
    let thin = multiplicity * slowness / (4.0 * PI * section.density * section.thickness);
    let over_square = classes * edges[0] * edges[1] / (4.0 * PI * multiplicity);
    let modes = ModeCount::of_thin_plate(over_square, slowness);
    let Spectrum { density, fast_wave_compliances } = match waves {
        None => Spectrum { density: vec![(0.0, thin)], fast_wave_compliances: Vec::new() },
        Some(waves) => spectrum(section, waves, multiplicity),
    };
    InfinitePlate {
        density,
        fast_wave_compliances,
        modes,
        impedance: zener::impedance(&material, section.thickness),
        distance_to_edge: geometry.distance_to_edge(),
        vectors_per_mode: VECTORS_PER_MODE,
    }
}

/// A wave of a plate with one wavenumber.
pub(super) struct Wave {
    /// Circular frequency ω, rad/s.
    pub frequency: f64,
    /// r² P², m²/kg: square of the displacement read on the disc for a unit amplitude of w, divided by the moving mass
    /// per unit of area.
    pub of_force: f64,
}

/// Response of the waves of all wavenumbers, by frequency.
struct Spectrum {
    /// Pairs of ω (rad/s), ascending, and the modal density ν (s/kg).
    density: Vec<(f64, f64)>,
    /// Pairs of ω (rad/s) and the static compliance (m/N) of waves that are faster than any contact.
    fast_wave_compliances: Vec<(f64, f64)>,
}

/// Spectrum of a plate. The bending waves have the density ν = (1/2π) ξ dξ/dω r² P². The other waves, and the bending
/// waves beyond the last ω, are springs with the compliance (1/2π) r² P²/ω² ξ dξ. `multiplicity` is the number of modelled
/// parts in the whole plate.
fn spectrum(section: &Section, waves: &LayerwiseWaves, multiplicity: f64) -> Spectrum {
    let first = first_wavenumber(section);
    // ν of a bending wave.
    let density_of = |wavenumber: f64, wave: &Wave| {
        let ends = [1e-3, -1e-3].map(|part| wavenumber * (1.0 + part));
        let frequencies = ends.map(|end| waves.at(end)[0].frequency);
        let slope = (ends[0] - ends[1]) / (frequencies[0] - frequencies[1]);
        multiplicity * wavenumber * slope * wave.of_force / (2.0 * PI)
    };
    let bending = &waves.at(first)[0];
    let longest = density_of(first, bending);
    let mut density = vec![(bending.frequency, longest)];
    let (mut largest, mut is_complete, mut fast_wave_compliances) = (longest, false, Vec::new());
    for wavenumber in (1..).map(|i| first * STEP.powi(i)) {
        if wavenumber * waves.radius() > SHORTEST {
            break;
        }
        let all = waves.at(wavenumber);
        let (bending, faster) = (&all[0], &all[1..]);
        // ξ dξ = ξ² d ln ξ.
        let part = multiplicity * wavenumber * wavenumber * STEP.ln() / (2.0 * PI);
        let spring = |wave: &Wave| (wave.frequency, part * wave.of_force / wave.frequency.powi(2));
        fast_wave_compliances.extend(faster.iter().map(spring));
        if is_complete {
            fast_wave_compliances.push(spring(bending));
            continue;
        }
        let value = density_of(wavenumber, bending);
        density.push((bending.frequency, value));
        largest = largest.max(value);
        is_complete = value < NEGLECTED_DENSITY * largest && wavenumber * waves.radius() > PI;
    }
    Spectrum { density, fast_wave_compliances }
}

/// Pairs of ω (rad/s) and ξ² (1/m²) of bending waves, from the longest to the shortest that the disc excites.
fn dispersion(section: &Section, waves: &LayerwiseWaves) -> Vec<(f64, f64)> {
    let wavenumbers = (0..).map(|i| first_wavenumber(section) * STEP.powi(i));
    let excited = wavenumbers.take_while(|wavenumber| wavenumber * waves.radius() <= SHORTEST);
    let of_waves = excited.map(|wavenumber| (waves.at(wavenumber)[0].frequency, wavenumber * wavenumber));
    std::iter::once((0.0, 0.0)).chain(of_waves).collect()
}

/// Wavenumber (1/m) of the longest waves that are evaluated.
fn first_wavenumber(section: &Section) -> f64 {
    0.01 / section.thickness
}
