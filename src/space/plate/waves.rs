//! Waves of an infinite plate under the impactor, which describe a finite plate before its first echo.

use std::f64::consts::PI;

use crate::body::InfinitePlate;
use crate::contact::zener;
use crate::error::Result;
use crate::form::Material;
use crate::form::plate::Section;
use crate::scene::Scene;

use super::geometry::PlateGeometry;
use super::{Local, PlateTheory, Points};

/// Ratio of successive wavenumbers at which Mindlin's waves are evaluated.
const STEP: f64 = 1.05;

/// Largest wavenumber times the radius of the disc. Shorter waves hardly change the mean displacement over the disc.
const SHORTEST: f64 = 40.0;

/// Fraction of the largest modal density below which the density is neglected.
const NEGLECTED_DENSITY: f64 = 1e-4;

/// Response of the infinite plate with the scene's section, as a single layer, to a force at a point.
///
/// # Errors
/// A fault of `body.model` if the theory cannot model the scene.
pub fn infinite_plate(scene: &Scene, theory: PlateTheory) -> Result<InfinitePlate> {
    let geometry = super::geometry(scene, theory).map_err(|reason| super::fault(theory, &reason))?;
    Ok(of_section(&geometry, &Section::new(geometry.thickness, &scene.body.struck()), None))
}

/// Number of uncoupled symmetry classes of a scene's plate.
///
/// # Errors
/// A fault of `body.model` if the theory cannot model the scene.
pub fn classes_of_motions(scene: &Scene, theory: PlateTheory) -> Result<usize> {
    Ok(super::geometry(scene, theory).map_err(|reason| super::fault(theory, &reason))?.classes.len())
}

/// Response of the infinite plate for a discretised plate. `None` for several layers: if layers slide, the waves are
/// slower than this model assumes.
pub(super) fn of_points(points: &Points) -> Option<InfinitePlate> {
    let is_known = points.laminate.is_none();
    is_known.then(|| of_section(&points.geometry, &points.section, points.local.as_ref()))
}

/// Response of the infinite plate for the modelled part of a plate, with all its symmetry classes.
fn of_section(geometry: &PlateGeometry, section: &Section, local: Option<&Local>) -> InfinitePlate {
    let (edges, multiplicity) = (geometry.edges, geometry.multiplicity());
    let classes = geometry.classes.len() as f64;
    let material = Material { young: section.young, poisson: section.poisson, density: section.density };
    // ξ² = ω √(ρh/D) for long waves.
    let slowness = (section.density * section.thickness / section.rigidity()).sqrt();
    let thin = multiplicity * slowness / (4.0 * PI * section.density * section.thickness);
    let Spectrum { density, fast_wave_compliances } = match local {
        None => Spectrum { density: vec![(0.0, thin)], fast_wave_compliances: Vec::new() },
        Some(local) => of_mindlin(section, local, multiplicity, thin),
    };
    // An area A has A ξ²/4π modes with wavenumbers below ξ.
    InfinitePlate {
        density,
        fast_wave_compliances,
        modes: classes * edges[0] * edges[1] * slowness / (4.0 * PI * multiplicity),
        impedance: zener::impedance(&material, section.thickness),
        slowness,
        distance_to_edge: geometry.distance_to_edge(),
    }
}

/// A wave of Mindlin's plate.
struct Wave {
    /// Circular frequency ω, rad/s.
    frequency: f64,
    /// r² P², m²/kg: square of the displacement read on the disc for a unit amplitude of w, divided by the moving mass
    /// per unit of area.
    of_force: f64,
}

/// Bending wave and thickness-shear wave of a wavenumber ξ (1/m).
///
/// For w and θ = ∇ψ of a wave: M = diag(ρh, ρh³ξ²/12) and K = [[S, S], [S, Dξ⁴ + S]], S = κμhξ². The displacement read
/// is w − s h² ξ² ψ.
fn waves(section: &Section, local: &Local, wavenumber: f64) -> [Wave; 2] {
    let mass = section.density * section.thickness;
    let square = wavenumber * wavenumber;
    let shear = local.shear_factor * section.shear() * square;
    let (bending, rotary) = (section.rigidity() * square * square, section.density * section.inertia() * square);
    let half = 0.5 * (shear / mass + (bending + shear) / rotary);
    let product = shear * bending / (mass * rotary);
    let upper = half + (half * half - product).sqrt();
    let spread = local.spread.transform(wavenumber * local.radius);
    [product / upper, upper].map(|square_of_frequency| {
        // (S − ω² ρh) w + S ψ = 0.
        let turned = square_of_frequency * mass / shear - 1.0;
        let read = 1.0 - local.reading * section.thickness.powi(2) * square * turned;
        let of_force = (read * spread).powi(2) / (mass + rotary * turned * turned);
        Wave { frequency: square_of_frequency.sqrt(), of_force }
    })
}

/// Response of the waves of all wavenumbers, by frequency.
struct Spectrum {
    /// Pairs of ω (rad/s), ascending, and the modal density ν (s/kg).
    density: Vec<(f64, f64)>,
    /// Pairs of ω (rad/s) and the static compliance (m/N) of waves that are faster than any contact.
    fast_wave_compliances: Vec<(f64, f64)>,
}

/// Spectrum of a Mindlin plate. The bending waves have the density ν = (1/2π) ξ dξ/dω r² P². The thickness-shear waves,
/// and the bending waves beyond the last ω, are springs with the compliance (1/2π) r² P²/ω² ξ dξ. `longest` is ν of the
/// thin plate, s/kg; `multiplicity` is the number of modelled parts in the whole plate.
fn of_mindlin(section: &Section, local: &Local, multiplicity: f64, longest: f64) -> Spectrum {
    let first = 0.01 / section.thickness;
    let mut density = vec![(waves(section, local, first)[0].frequency, longest)];
    let (mut largest, mut is_complete, mut fast_wave_compliances) = (longest, false, Vec::new());
    for i in 1.. {
        let wavenumber = first * STEP.powi(i);
        if wavenumber * local.radius > SHORTEST {
            break;
        }
        let [bending, shear] = waves(section, local, wavenumber);
        // ξ dξ = ξ² d ln ξ.
        let part = multiplicity * wavenumber * wavenumber * STEP.ln() / (2.0 * PI);
        let spring = |wave: &Wave| (wave.frequency, part * wave.of_force / wave.frequency.powi(2));
        fast_wave_compliances.push(spring(&shear));
        if is_complete {
            fast_wave_compliances.push(spring(&bending));
            continue;
        }
        let ends = [1e-3, -1e-3].map(|part| wavenumber * (1.0 + part));
        let frequencies = ends.map(|end| waves(section, local, end)[0].frequency);
        let slope = (ends[0] - ends[1]) / (frequencies[0] - frequencies[1]);
        let value = multiplicity * wavenumber * slope * bending.of_force / (2.0 * PI);
        density.push((bending.frequency, value));
        largest = largest.max(value);
        is_complete = value < NEGLECTED_DENSITY * largest && wavenumber * local.radius > PI;
    }
    Spectrum { density, fast_wave_compliances }
}
