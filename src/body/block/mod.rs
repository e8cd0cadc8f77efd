//! A box of tensor-product splines, as an elastic body in three dimensions.
//!
//! The displacement along an axis lies in splines of one degree less along that axis than along the others, so that the strains of a
//! bent plate, ∂u_x/∂z and ∂u_z/∂x, are alike and cancel (as in Beirão da Veiga, Buffa, Lovadina, Martinelli & Sangalli, An
//! isogeometric method for the Reissner–Mindlin plate bending problem, Comput. Methods Appl. Mech. Eng. 209–212, 2012): fewer unknowns
//! with half of the error.

mod frame;
mod grid;
mod terms;

use super::System;
use crate::error::Result;
use crate::form::elastic::{elastic, mass};
use crate::form::tensor::Tensor;
use crate::form::{Material, Spline};
use crate::scene::{Fault, Scene};

use frame::{Frame, Site};
use terms::Terms;

/// Degree of the splines, with all derivatives continuous but one. Of 3 to 5 it takes the least time for an error of 0.1% to 0.5% of an
/// impact's history.
const DEGREE: usize = 4;

/// Choices that a scene does not make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Size of all cells over that for an error of about 0.15% of the acceleration in the first contact.
    pub fineness: f64,
}

impl Settings {
    /// For an error of less than half of a tolerance, as measured on plates.
    pub fn new(tolerance: f64) -> Self {
        Self { fineness: (1.5 * (tolerance / 1e-2).powf(0.28)).clamp(0.3, 2.0) }
    }
}

/// A box's system, and how it was made.
#[derive(Debug, Clone)]
pub struct Block {
    /// The body's side of M ü + C u̇ + K u = a F + f. The unknowns are coefficients of splines, m: component by component, the last
    /// axis fastest.
    pub system: System,
    /// Cells along each axis of the modelled part.
    pub cells: [usize; 3],
}

/// Why splines on a box do not stand for a scene's body: a clause.
///
/// # Errors
/// That clause.
pub fn admits(scene: &Scene) -> std::result::Result<(), String> {
    let frame = Frame::new(scene)?;
    match frame.site(scene) {
        Ok(site) => grid::lines(&frame, scene, site.disc, Settings::new(scene.tolerance).fineness).map(|_| ()),
        // What is wrong with the patch is wrong with any mesh.
        Err(_) => Ok(()),
    }
}

impl Block {
    /// Builds a scene's box.
    ///
    /// # Errors
    /// A fault of `body.model` where splines do not stand for the scene's body, of `contact.patch_radius` where there is no patch.
    pub fn new(scene: &Scene, settings: &Settings) -> Result<Self> {
        let fault = |reason: String| {
            let message = format!("splines on a box do not stand for this scene: {reason}");
            Fault::new("body.model", message, "body.cells, for a mesh")
        };
        let frame = Frame::new(scene).map_err(fault)?;
        let site = frame.site(scene)?;
        let lines = grid::lines(&frame, scene, site.disc, settings.fineness).map_err(fault)?;
        let body = &scene.body;
        let material = Material { young: body.young, poisson: body.poisson, density: body.density };
        let tensor = tensor(&lines);
        let terms = Terms { scene, frame: &frame, lines: &lines, tensor: &tensor };
        let (support_load, support_offset) = terms.support_load();
        let Site { patch, spread, disc, compliance } = site;
        let copies = frame.copies();
        let system = System {
            mass: tensor.matrix(&mass(&material)),
            elastic: tensor.matrix(&elastic(&material)),
            support: terms.support(),
            damping: terms.damping(),
            held: terms.held(),
            load: terms.load(),
            support_load,
            support_offset,
            localization: terms.localization(&spread, disc),
            compliance: copies * compliance,
            patch: Some(patch),
            translation: terms.translation(),
            copies,
        };
        let cells = lines.each_ref().map(|lines| lines.windows(2).filter(|pair| pair[0] < pair[1]).count());
        Ok(Self { system, cells })
    }
}

/// The three components between the lines.
fn tensor(lines: &[Vec<f64>; 3]) -> Tensor<3> {
    let spline = |component: usize, axis: usize| {
        let degree = if axis == component { DEGREE - 1 } else { DEGREE };
        Spline::new(&lines[axis], degree, degree - 1)
    };
    Tensor::new((0..3).map(|component| std::array::from_fn(|axis| spline(component, axis))).collect())
}
