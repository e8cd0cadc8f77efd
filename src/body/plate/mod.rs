//! A box hit on a face, as a thin plate: small linear systems of Kirchhoff's or of Reissner's and Mindlin's theory.

mod boundary;
mod frame;
mod grid;
pub mod layer;
mod points;
mod site;
mod theory;

pub use grid::crossing;
pub(super) use grid::{contact_time, wavelength};
pub use points::Points;
pub use theory::Theory;

use boundary::Boundary;
use frame::Frame;
use layer::Layer;
use site::Site;

use super::System;
use crate::error::Result;
use crate::form::Spread;
use crate::form::plate::{DEFLECTION, Section};
use crate::scene::{Fault, Scene};

/// Choices that a scene does not make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Size of all cells over the default's.
    pub fineness: f64,
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
    pub fn new(tolerance: f64, theory: Theory) -> Self {
        let parts = tolerance / 1e-2;
        let of_mindlin = 1.2 * if parts > 1.0 { parts.cbrt() } else { parts.powf(0.25) };
        // w alone is smoother than what presses it: no shear.
        let fineness = if theory == Theory::Kirchhoff { 1.4 * of_mindlin } else { of_mindlin };
        Self { fineness: fineness.clamp(0.3, 2.4), ..Self::default() }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self { fineness: 1.0, shear_factor: None, disc: 2.0 }
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
pub fn admits(scene: &Scene, theory: Theory) -> std::result::Result<(), String> {
    parts(scene, theory).map(|_| ())
}

fn parts(scene: &Scene, theory: Theory) -> std::result::Result<(Frame, Boundary), String> {
    let frame = Frame::new(scene)?;
    let boundary = Boundary::new(scene, &frame, theory)?;
    let least = LEAST_DISC * frame.thickness;
    if theory == Theory::Mindlin && least > frame.room() * (1.0 + 1e-9) {
        return Err(format!(
            "the hit is {:.3e} m from an edge, and the disc that it spreads over has a radius of at least {least:.3e} m",
            frame.room()
        ));
    }
    Ok((frame, boundary))
}

impl Plate {
    /// Builds a scene's plate.
    ///
    /// # Errors
    /// A fault of `body.model` where the theory does not stand for the scene, or where the plate would take very many cells.
    pub fn new(scene: &Scene, theory: Theory, settings: &Settings) -> Result<Self> {
        let fault = |reason: String| {
            let message = format!("{}'s plate cannot model this scene: {reason}", theory.name());
            Fault::new("body.model", message, "model = \"solid\"")
        };
        let (frame, boundary) = parts(scene, theory).map_err(fault)?;
        let body = &scene.body;
        let section =
            Section { thickness: frame.thickness, young: body.young, poisson: body.poisson, density: body.density };
        let local = (theory == Theory::Mindlin).then(|| Local::new(&section, settings, frame.room()));
        let disc = local.map(|local| local.radius);
        let lines = grid::lines(&frame, &section, &scene.impactor, disc, settings.fineness)
            .map_err(|cells| fault(format!("it would take {cells:.0} cells along an edge")))?;
        let tensor = theory.tensor(&lines);
        let copies = if frame.quarter { 4.0 } else { 1.0 };
        let site = Site { frame: &frame, section: &section, lines: &lines, tensor: &tensor, theory };
        let (support_load, support_offset) = site.support_load(&boundary.springs);
        let shear_factor = local.map_or(0.0, |local| local.shear_factor);
        let mut elastic = theory.elastic(&section, shear_factor);
        if theory == Theory::Mindlin {
            elastic.extend(site.edges(shear_factor, &boundary.clamps));
        }
        let system = System {
            mass: tensor.matrix(&theory.mass(&section)),
            elastic: tensor.matrix(&elastic),
            support: site.springs(&boundary.springs),
            damping: site.springs(&boundary.dampers),
            held: site.held(&boundary.clamps),
            load: site.load(&boundary),
            support_load,
            support_offset,
            localization: site.localization(local.as_ref(), copies),
            compliance: local.map_or(0.0, |local| -local.compliance * copies),
            patch: None,
            translation: tensor.one(DEFLECTION),
            copies,
        };
        let cells = lines.each_ref().map(|lines| lines.len() - 1);
        Ok(Self { system, cells, local, points: Points { frame, section, lines, tensor, theory, local } })
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
