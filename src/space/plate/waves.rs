//! The waves of an infinite plate under the impactor, by which a finite one is known before its first echo.

use std::f64::consts::PI;

use crate::body::InfinitePlate;
use crate::contact::zener;
use crate::error::Result;
use crate::form::Material;
use crate::form::plate::Section;
use crate::scene::Scene;

use super::geometry::PlateGeometry;
use super::{Local, PlateTheory, Points};

/// Wavenumbers of Mindlin's waves that are looked at, each over the one before.
const STEP: f64 = 1.05;

/// The last of them times the disc's radius: waves that are shorter hardly move what is read, the mean over the disc.
const SHORTEST: f64 = 40.0;

/// The part of the density of long waves below which nothing is left.
const LEAST: f64 = 1e-4;

/// What the infinite plate of a scene's section, one layer, does under a force at a point.
///
/// # Errors
/// A fault of `body.model` where the theory does not stand for the scene.
pub fn infinite_plate(scene: &Scene, theory: PlateTheory) -> Result<InfinitePlate> {
    let geometry = super::geometry(scene, theory).map_err(|reason| super::fault(theory, &reason))?;
    Ok(of_section(&geometry, &Section::new(geometry.thickness, &scene.body.struck()), None))
}

/// How many classes of motions a scene's plate has that do not couple.
///
/// # Errors
/// A fault of `body.model` where the theory does not stand for the scene.
pub fn classes_of_motions(scene: &Scene, theory: PlateTheory) -> Result<usize> {
    Ok(super::geometry(scene, theory).map_err(|reason| super::fault(theory, &reason))?.classes.len())
}

/// That of a plate. Waves of layers that slide are slower than those which its coordinates stand for.
pub(super) fn of_points(points: &Points) -> Option<InfinitePlate> {
    let is_known = points.laminate.is_none();
    is_known.then(|| of_section(&points.geometry, &points.section, points.local.as_ref()))
}

/// Of the modelled part of a plate, with all of its classes of motions.
fn of_section(geometry: &PlateGeometry, section: &Section, local: Option<&Local>) -> InfinitePlate {
    let (edges, copies) = (geometry.edges, geometry.copies());
    let classes = geometry.classes.len() as f64;
    let material = Material { young: section.young, poisson: section.poisson, density: section.density };
    // ξ² = ω √(ρh/D) of long waves.
    let slowness = (section.density * section.thickness / section.rigidity()).sqrt();
    let thin = copies * slowness / (4.0 * PI * section.density * section.thickness);
    let Spectrum { density, yielding } = match local {
        None => Spectrum { density: vec![(0.0, thin)], yielding: Vec::new() },
        Some(local) => of_mindlin(section, local, copies, thin),
    };
    // A wave of the wavenumber ξ fits an area A into A ξ²/4π modes below it.
    InfinitePlate {
        density,
        yielding,
        modes: classes * edges[0] * edges[1] * slowness / (4.0 * PI * copies),
        impedance: zener::impedance(&material, section.thickness),
        slowness,
        distance_to_edge: geometry.distance_to_edge(),
    }
}

/// A wave of Mindlin's plate.
struct Wave {
    /// ω, rad/s.
    frequency: f64,
    /// r² P²: the square of what is read on the disc over the moving mass of a unit of area, m²/kg.
    of_force: f64,
}

/// The waves of a wavenumber ξ (1/m), the bending one and that of thickness shear.
///
/// With w and θ = ∇ψ of a wave: M = diag(ρh, ρh³ξ²/12) and K = [[S, S], [S, Dξ⁴ + S]], S = κμhξ². What is read is w − s h² ξ² ψ.
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

/// What the waves of all wavenumbers do, by their frequency.
struct Spectrum {
    /// ω (rad/s), ascending, and ν there (s/kg).
    density: Vec<(f64, f64)>,
    /// ω (rad/s) of waves that are faster than any contact, with what they yield to a resting force, m/N.
    yielding: Vec<(f64, f64)>,
}

/// ν = (1/2π) ξ dξ/dω r² P² of the bending waves, and as springs, (1/2π) r² P²/ω² ξ dξ, the waves of thickness shear and the bending ones
/// beyond the last ω. `longest` is ν of the thin plate, s/kg, and `copies` how many modelled parts make the plate.
fn of_mindlin(section: &Section, local: &Local, copies: f64, longest: f64) -> Spectrum {
    let first = 0.01 / section.thickness;
    let mut density = vec![(waves(section, local, first)[0].frequency, longest)];
    let (mut largest, mut is_complete, mut yielding) = (longest, false, Vec::new());
    for i in 1.. {
        let wavenumber = first * STEP.powi(i);
        if wavenumber * local.radius > SHORTEST {
            break;
        }
        let [bending, shear] = waves(section, local, wavenumber);
        // ξ dξ = ξ² d ln ξ.
        let part = copies * wavenumber * wavenumber * STEP.ln() / (2.0 * PI);
        let spring = |wave: &Wave| (wave.frequency, part * wave.of_force / wave.frequency.powi(2));
        yielding.push(spring(&shear));
        if is_complete {
            yielding.push(spring(&bending));
            continue;
        }
        let ends = [1e-3, -1e-3].map(|part| wavenumber * (1.0 + part));
        let frequencies = ends.map(|end| waves(section, local, end)[0].frequency);
        let slope = (ends[0] - ends[1]) / (frequencies[0] - frequencies[1]);
        let value = copies * wavenumber * slope * bending.of_force / (2.0 * PI);
        density.push((bending.frequency, value));
        largest = largest.max(value);
        is_complete = value < LEAST * largest && wavenumber * local.radius > PI;
    }
    Spectrum { density, yielding }
}
