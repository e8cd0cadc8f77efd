//! A box hit on a face, as a thin plate: small linear systems of Kirchhoff's or of Reissner's and Mindlin's theory.

mod boundary;
mod cells;
mod clamps;
mod edges;
mod face;
mod geometry;
pub mod layer;
mod location;
mod points;
mod theory;
mod waves;

pub use cells::crossing;
pub(super) use cells::{contact_time, wavelength};
pub use points::Points;
pub use theory::PlateTheory;

use clamps::held;
use geometry::PlateGeometry;
use layer::Layer;

use nalgebra_sparse::CsrMatrix;

use super::SurfaceTerms;
use super::grid::GridSpace;
use super::parity::repeated;
use crate::body::System;
use crate::description::Description;
use crate::error::Result;
use crate::form::Spread;
use crate::form::plate::{DEFLECTION, Section};
use crate::scene::{Fault, Scene};

/// Choices that a scene does not make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Size of all cells over the default's.
    pub cell_size_factor: f64,
    /// κ of Mindlin's theory; left out, 5/(6 − ν).
    pub shear_factor: Option<f64>,
    /// Radius of Mindlin's disc over the thickness, where it has room.
    pub disc: f64,
}

/// κ = 5/(6 − ν), which gives the speed of long waves to one order more than Reissner's static 5/6 (Stephen, Mindlin plate theory: best
/// shear coefficient and higher spectra validity, J. Sound Vib. 202, 1997).
fn shear_factor(poisson: f64) -> f64 {
    5.0 / (6.0 - poisson)
}

impl Settings {
    /// Cells for an error of less than half of a tolerance, as measured on plates.
    pub fn new(tolerance: f64, theory: PlateTheory) -> Self {
        let parts = tolerance / 1e-2;
        let of_mindlin = 1.2 * if parts > 1.0 { parts.cbrt() } else { parts.powf(0.25) };
        // w alone is smoother than what presses it: no shear.
        let cell_size_factor = if theory == PlateTheory::Kirchhoff { 1.4 * of_mindlin } else { of_mindlin };
        Self { cell_size_factor: cell_size_factor.clamp(0.3, 2.4), ..Self::default() }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self { cell_size_factor: 1.0, shear_factor: None, disc: 2.0 }
    }
}

/// Radius of Mindlin's disc over the thickness, at least.
const LEAST_DISC: f64 = 0.5;

/// A plate's system, and how it was made.
///
/// The unknowns are coefficients of splines: of w along the impactor's direction (m), then of Mindlin's rotations θ along the two
/// axes of the plane, ascending (rad). At its ends Kirchhoff's w has slopes among its coefficients. The compliance is −c_M times the
/// copies, or 0 for Kirchhoff's theory.
#[derive(Debug, Clone)]
pub struct Plate {
    /// The body's side of M ü + C u̇ + K u = a F + f.
    pub system: System,
    /// Cells along both axes of the modelled part.
    pub cells: [usize; 2],
    /// How Mindlin's plate is hit.
    pub local: Option<Local>,
    /// What its points do.
    pub points: Points,
}

/// What stands for the local field on a Reissner–Mindlin plate; see [`layer`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Local {
    /// κ.
    pub shear_factor: f64,
    /// The pressure on the disc.
    pub spread: Spread,
    /// The disc's radius, m.
    pub radius: f64,
    /// s: the surface is read as w + s h² ∇·θ.
    pub reading: f64,
    /// c_M of the whole plate, m/N: α = δ − c_M F.
    pub compliance: f64,
}

/// Why a plate theory does not stand for a scene: one clause.
///
/// # Errors
/// That clause.
pub fn admits(scene: &Scene, theory: PlateTheory) -> std::result::Result<(), String> {
    geometry(scene, theory).map(|_| ())
}

fn geometry(scene: &Scene, theory: PlateTheory) -> std::result::Result<PlateGeometry, String> {
    let geometry = PlateGeometry::new(scene)?;
    boundary::check(scene, &geometry, theory)?;
    let least = LEAST_DISC * geometry.thickness;
    if theory == PlateTheory::Mindlin && least > geometry.room() * (1.0 + 1e-9) {
        return Err(format!(
            "the hit is {:.3e} m from an edge, and the disc that it spreads over has a radius of at least {least:.3e} m",
            geometry.room()
        ));
    }
    Ok(geometry)
}

impl Plate {
    /// Builds a scene's plate.
    ///
    /// # Errors
    /// A fault of `body.model` where the theory does not stand for the scene, or where the plate would take very many cells.
    pub fn new(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<Self> {
        let fault = |reason: String| {
            let message = format!("{}'s plate cannot model this scene: {reason}", theory.name());
            Fault::new("body.model", message, "model = \"solid\"")
        };
        let geometry = geometry(scene, theory).map_err(fault)?;
        let description = Description::new(scene);
        let section = Section::new(geometry.thickness, &scene.body.struck());
        let local = (theory == PlateTheory::Mindlin).then(|| Local::new(&section, settings, geometry.room()));
        let disc = local.map(|local| local.radius);
        let in_plane = cells::lines(&geometry, &section, &scene.impactor, disc, settings.cell_size_factor)
            .map_err(|cells| fault(format!("it would take {cells:.0} cells along an edge")))?;
        let cells = in_plane.each_ref().map(|lines| lines.len() - 1);
        let tensor = theory.tensor(&in_plane);
        let half = 0.5 * geometry.thickness;
        let mut lines: [Vec<f64>; 3] = std::array::from_fn(|_| vec![-half, half]);
        geometry.axes.into_iter().zip(in_plane).for_each(|(axis, of_axis)| lines[axis] = of_axis);
        let points = Points { geometry, section, lines, tensor, theory, local };
        let mirrors = points.geometry.mirrors();
        let terms = SurfaceTerms::new(&GridSpace { field: &points, mirrors: &mirrors }, &description)?;
        let (copies, classes) = (points.geometry.copies(), points.geometry.classes.len());
        let mut elastic = theory.elastic(&section, local.map_or(0.0, |local| local.shear_factor));
        if let Some(local) = &local {
            elastic.extend(edges::forms(&points, local.shear_factor, &description.clamps));
        }
        // Loads, and a motion of the whole along the impact, are even.
        let even = |mut vector: Vec<f64>| {
            vector.resize(points.all_unknowns(), 0.0);
            vector
        };
        let of_classes = |matrix: &CsrMatrix<f64>| repeated(matrix, classes);
        let system = System {
            mass: of_classes(&points.tensor.matrix(&theory.mass(&section))),
            elastic: of_classes(&points.tensor.matrix(&elastic)),
            relaxations: Vec::new(),
            support: terms.support.as_ref().map(of_classes),
            damping: terms.damping.as_ref().map(of_classes),
            pads: terms.pads,
            held: held(&points.tensor, &points.geometry, theory, &description.clamps),
            load: even(terms.load),
            support_load: even(terms.support_load),
            support_offset: terms.support_offset,
            localization: location::localization(&points),
            compliance: local.map_or(0.0, |local| -local.compliance * copies),
            patch: None,
            hit_stress: Vec::new(),
            hit_local: [0.0; 3],
            infinite_plate: Some(waves::infinite_plate(&points, copies)),
            translation: even(points.tensor.one(DEFLECTION)),
            copies,
            classes,
        };
        Ok(Self { system, cells, local, points })
    }
}

impl Local {
    fn new(section: &Section, settings: &Settings, room: f64) -> Self {
        let h = section.thickness;
        let disc = settings.disc.min(room / h);
        let spread = Spread::new(0.0);
        let shear_factor = settings.shear_factor.unwrap_or(shear_factor(section.poisson));
        let layer = Layer { poisson: section.poisson, shear_factor, spread, disc };
        let compliance = layer.compliance() / (section.young * h);
        Self { shear_factor, spread, radius: disc * h, reading: layer.reading(), compliance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::plate::rotation;

    /// Springs along the sides against a rotation of all of Mindlin's plate along one axis: k h³/12 a unit of length.
    #[test]
    fn springs_resist_rotations() {
        let text = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.6, 0.4, 0.03]\nsymmetry = \"none\"\n\
                    [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\n[time]\nend = 1e-3\n\
                    [[support]]\nsurface = \"x-min\"\nkind = \"elastic\"\nstiffness = [2e9, 3e9, 0]\n\
                    [[support]]\nsurface = \"y-max\"\nkind = \"elastic\"\nstiffness = [2e9, 3e9, 0]\n";
        let scene = Scene::parse("test", text, &[]).expect("a scene").0;
        let plate = Plate::new(&scene, PlateTheory::Mindlin, &Settings::default()).expect("a plate");
        let support = plate.system.support.expect("springs");
        for (axis, k) in [2e9, 3e9].into_iter().enumerate() {
            let one = plate.points.tensor.one(rotation(axis, [0, 0]).field);
            let sum: f64 = support.triplet_iter().map(|(i, j, value)| one[i] * value * one[j]).sum();
            let exact = k * 0.03_f64.powi(3) / 12.0 * (0.4 + 0.6);
            // Rounding of some hundred points.
            assert!((sum / exact - 1.0).abs() < 1e-12, "{sum} {exact}");
        }
    }
}
