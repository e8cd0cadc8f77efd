//! A box of tensor-product splines, as a body in three dimensions.

mod frame;
pub mod grid;
mod site;

use crate::body::System;
use crate::contact::Patch;
use crate::error::Result;
use crate::form::elastic;
use crate::form::tensor::Tensor;
use crate::form::{Material, Spline};
use crate::scene::{Fault, Scene};

use frame::Frame;
use site::Site;

/// Choices that a scene does not make.
#[derive(Debug, Clone, PartialEq)]
#[allow(missing_docs)]
pub struct Settings {
    /// Size of all cells over the default's.
    pub fineness: f64,
    pub plane: usize,
    pub across: usize,
    pub variant: usize,
    pub of_patch: f64,
    pub of_wave: f64,
    pub growth: f64,
    pub end: f64,
    pub layers: Vec<f64>,
    pub spread: f64,
    pub power: usize,
}

/// A box's system, and how it was made.
#[derive(Debug, Clone)]
pub struct Block {
    /// The body's side of M ü + C u̇ + K u = a F + f; the unknowns are coefficients of splines, m.
    pub system: System,
    /// Cells along each axis of the modelled part.
    pub cells: [usize; 3],
}

/// Why splines on a box do not stand for a scene's body: one clause.
///
/// # Errors
/// That clause.
pub fn admits(scene: &Scene) -> std::result::Result<(), String> {
    Frame::new(scene).map(|_| ())
}

impl Block {
    /// Builds a scene's box.
    ///
    /// # Errors
    pub fn new(scene: &Scene, settings: &Settings) -> Result<Self> {
        let fault = |reason: String| {
            let message = format!("splines on a box do not stand for this scene: {reason}");
            Fault::new("body.model", message, "")
        };
        let frame = Frame::new(scene).map_err(fault)?;
        let (patch, unit) = frame.patch(scene)?;
        let body = &scene.body;
        let material = Material { young: body.young, poisson: body.poisson, density: body.density };
        let wave = frame.wavelength(scene);
        let lines: [Vec<f64>; 3] = std::array::from_fn(|axis| {
            if axis == frame.struck && !settings.layers.is_empty() {
                let mut lines: Vec<f64> = settings
                    .layers
                    .iter()
                    .map(|d| {
                        0.5 * frame.size[axis] * frame.hit[axis].signum()
                            - frame.hit[axis].signum() * d * frame.size[axis]
                    })
                    .collect();
                lines.sort_by(f64::total_cmp);
                return lines;
            }
            let f = settings.fineness;
            let sizes = grid::Sizes {
                hit: f * settings.of_patch * patch.radius,
                end: f * settings.end * frame.size[frame.struck],
                largest: f * settings.of_wave * wave,
                growth: f * settings.growth,
            };
            let mut lines = grid::lines(frame.size[axis], frame.hit[axis], sizes);
            if frame.mirrors.contains(&axis) {
                lines.retain(|x| *x >= 0.0);
            }
            lines
        });
        let field = |component: usize| -> [Spline; 3] {
            std::array::from_fn(|axis| {
                let degree = if axis == frame.struck { settings.across } else { settings.plane };
                let less = match settings.variant {
                    0 => 0,
                    1 => usize::from(axis == component && axis != frame.struck),
                    2 => usize::from(axis == component),
                    _ => usize::from(axis == component && axis == frame.struck),
                };
                Spline::new(&lines[axis], degree - less, degree - less - 1)
            })
        };
        let tensor = Tensor::new((0..3).map(field).collect());
        let site = Site { scene, frame: &frame, lines: &lines, tensor: &tensor };
        let (support_load, support_offset) = site.support_load();
        let copies = frame.copies();
        let direction = scene.impactor.direction;
        let system = System {
            mass: tensor.matrix(&elastic::mass(&material)),
            elastic: tensor.matrix(&elastic::elastic(&material)),
            support: site.stiffness(),
            damping: site.damping(),
            held: site.held(),
            load: site.load(),
            support_load,
            support_offset,
            localization: site.localization(patch.radius, settings),
            compliance: copies * unit / patch.radius * site::ratio(settings),
            patch: Some(patch),
            translation: site.translation(direction),
            copies,
        };
        Ok(Self { system, cells: lines.each_ref().map(|lines| lines.len() - 1) })
    }
}
