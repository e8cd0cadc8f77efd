//! A box, and where it is hit.

use crate::contact::{Patch, Reason, limits, unit_compliance};
use crate::error::Result;
use crate::form::Spread;
use crate::scene::{Contact, Fault, Geometry, Scene, SupportKind, Symmetry, Vec3};

/// The shortest edge over the longest, at least: rounding goes with the fourth power of the ratio, and is 1e-3 of the deflection here.
const THINNEST: f64 = 1.0 / 2000.0;

/// A box, where it is hit, and which part of it is modelled.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Frame {
    /// Edge lengths of the whole, m.
    pub size: Vec3,
    /// Where it is hit, m.
    pub hit: Vec3,
    /// The axis across the face that is hit.
    pub struck: usize,
    /// Axes across planes of symmetry: where their coordinates are positive is the modelled part.
    pub mirrors: Vec<usize>,
}

/// Where the body is loaded and read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Site {
    /// The patch that is stood for.
    pub patch: Patch,
    /// Its pressure, spread over more.
    pub spread: Spread,
    /// Radius of the disc, m.
    pub disc: f64,
    /// c of the contact law for the whole body, m/N.
    pub compliance: f64,
}

impl Frame {
    /// Why the body is no such box.
    pub fn new(scene: &Scene) -> std::result::Result<Self, String> {
        let (Geometry::Box { size, .. }, Some(struck)) = (&scene.body.geometry, scene.struck_axis()) else {
            return Err("the body is from a mesh file, not a box".into());
        };
        if scene.contact == Contact::Point {
            return Err("a solid yields without limit under a force at a point".into());
        }
        let [shortest, longest] =
            [f64::min, f64::max].map(|pick: fn(f64, f64) -> f64| size.iter().fold(size[0], |a, b| pick(a, *b)));
        if shortest < THINNEST * longest {
            return Err(format!(
                "rounding would show in a box that is 1/{:.0} as thin as it is long",
                longest / shortest
            ));
        }
        let pad = |kind: &SupportKind| matches!(kind, SupportKind::Pad { .. });
        if let Some(number) = scene.supports.iter().position(|support| pad(&support.kind)) {
            return Err(format!("support.{number} on {:?} is a pad", scene.supports[number].surface));
        }
        let mirrors = match scene.body.symmetry {
            Symmetry::Quarter { axes } => axes.to_vec(),
            Symmetry::None { .. } => Vec::new(),
        };
        Ok(Self { size: *size, hit: scene.impactor.point, struck, mirrors })
    }

    /// How many of the modelled part make the whole.
    pub fn copies(&self) -> f64 {
        if self.mirrors.is_empty() { 1.0 } else { 4.0 }
    }

    /// The axes along the face that is hit.
    pub fn plane(&self) -> [usize; 2] {
        [[1, 2], [0, 2], [0, 1]][self.struck]
    }

    /// Ends of the modelled part along an axis.
    pub fn ends(&self, axis: usize) -> [f64; 2] {
        let half = 0.5 * self.size[axis];
        [if self.mirrors.contains(&axis) { 0.0 } else { -half }, half]
    }

    /// The patch, of the radius that the scene gives or that thickness, contact and face allow.
    ///
    /// # Errors
    /// A fault of the scene where there is none.
    pub fn site(&self, scene: &Scene) -> Result<Site> {
        let (body, impactor) = (&scene.body, &scene.impactor);
        let thickness = self.size[self.struck];
        let room = self.plane().map(|axis| 0.5 * self.size[axis] - self.hit[axis].abs());
        let room = room[0].min(room[1]);
        let mass = body.density * self.size.iter().product::<f64>();
        let half_space = unit_compliance(body, impactor.direction[self.struck]);
        // As wide as there is room, and no wider than the waves of the thickness do not mind.
        let spread = |radius: f64| Spread::new((room.min(thickness) / radius).max(1.0));
        let limits = |radius: f64| limits(body, impactor, mass, thickness, half_space * spread(radius).compliance());
        let fault = |message: String, help: &str| Fault::new("contact.patch_radius", message, help);
        let far = "a smaller radius, or an impact point farther from the edge of the surface";
        if room <= 1e-6 * thickness {
            return Err(fault("the edge of the surface leaves no room for a patch".into(), far).into());
        }
        let least = |radius: f64| {
            let (_, least) = limits(radius);
            if radius >= least {
                return Ok(());
            }
            let message = format!(
                "a patch of radius {radius:.3e} m is too small for this impact: below about {least:.3e} m the contact has \
                 negative stiffness"
            );
            Err(fault(message, "a larger radius, or an impact point farther from the edge of the surface"))
        };
        let patch = match scene.contact {
            Contact::Patch { radius: Some(radius) } => {
                let (limit, _) = limits(radius);
                if radius > room * (1.0 + 1e-9) {
                    let message = format!("a patch of radius {radius:.3e} m has no room at {room:.3e} m from an edge");
                    return Err(fault(message, far).into());
                }
                Patch { radius, reason: Reason::Scene, ..Patch::choose(thickness, 0.0, limit) }
            }
            _ => {
                let chosen = Patch::within(scene.tolerance, thickness, |radius| limits(radius).0);
                if chosen.radius > room { chosen.cut_to(room) } else { chosen }
            }
        };
        least(patch.radius)?;
        let spread = spread(patch.radius);
        let compliance = half_space * spread.compliance() / patch.radius;
        Ok(Site { patch, spread, disc: spread.widening() * patch.radius, compliance })
    }
}
