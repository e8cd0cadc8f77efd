//! A box as its impact sees it.

use crate::body::plate::wavelength;
use crate::contact::{Patch, limits, unit_compliance};
use crate::error::Result;
use crate::form::plate::Section;
use crate::scene::{Contact, Fault, Geometry, Scene, SupportKind, Symmetry, Vec3};

const KEY: &str = "contact.patch_radius";

/// A box and where it is hit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Frame {
    /// Edge lengths of the whole, m.
    pub size: Vec3,
    /// Where it is hit, m.
    pub hit: Vec3,
    /// The axis across the face that is hit.
    pub struck: usize,
    /// Axes across planes of symmetry: of those only positive coordinates are modelled.
    pub mirrors: Vec<usize>,
}

impl Frame {
    /// Why the body is no such box.
    pub fn new(scene: &Scene) -> std::result::Result<Self, String> {
        let Geometry::Box { size, .. } = scene.body.geometry else {
            return Err("the body is from a mesh file, not a box".into());
        };
        if scene.contact == Contact::Point {
            return Err("it is hit at a point, under which an elastic solid yields without limit".into());
        }
        for (number, support) in scene.supports.iter().enumerate() {
            if let SupportKind::Pad { .. } = support.kind {
                return Err(format!("support.{number} on {:?} is a pad", support.surface));
            }
        }
        let impactor = &scene.impactor;
        let mirrors = match scene.body.symmetry {
            Symmetry::Quarter { axes } => axes.to_vec(),
            Symmetry::None { .. } => Vec::new(),
        };
        let struck = scene.struck_axis().unwrap_or(2);
        Ok(Self { size, hit: impactor.point, struck, mirrors })
    }

    /// How many of the modelled parts make the whole.
    pub fn copies(&self) -> f64 {
        f64::from(1 << self.mirrors.len())
    }

    /// Ends of the modelled part along an axis.
    pub fn ends(&self, axis: usize) -> [f64; 2] {
        let half = 0.5 * self.size[axis];
        [if self.mirrors.contains(&axis) { 0.0 } else { -half }, half]
    }

    fn section(&self, scene: &Scene) -> Section {
        let body = &scene.body;
        Section { thickness: self.size[self.struck], young: body.young, poisson: body.poisson, density: body.density }
    }

    /// Length of the waves of the contact, m.
    pub fn wavelength(&self, scene: &Scene) -> f64 {
        wavelength(&self.section(scene), &scene.impactor)
    }

    /// The patch, and c_l r_p.
    pub fn patch(&self, scene: &Scene) -> Result<(Patch, f64)> {
        let (body, impactor) = (&scene.body, &scene.impactor);
        let thickness = self.size[self.struck];
        let cosine = impactor.direction[self.struck];
        let unit = unit_compliance(body, cosine);
        let mass = body.density * self.size.iter().product::<f64>();
        let (limit_radius, least) = limits(body, impactor, mass, thickness, unit);
        let room = (0..3)
            .filter(|i| *i != self.struck)
            .map(|i| 0.5 * self.size[i] - self.hit[i].abs())
            .fold(f64::INFINITY, f64::min);
        let _ = (room, least);
        let mut patch = Patch::choose(thickness, 0.0, limit_radius);
        if let Contact::Patch { radius: Some(radius) } = scene.contact {
            patch.radius = radius;
        }
        let _ = Fault::new(KEY, "", "");
        Ok((patch, unit))
    }
}
