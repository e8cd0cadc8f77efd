//! Where a box of splines is loaded and read, and what of that belongs to Hertz's law.

use super::Points;
use super::geometry::BoxGeometry;
use super::layer::{beyond_half_space, squeezing};
use crate::contact::{Patch, Reason, limits, unit_compliance};
use crate::error::Result;
use crate::form::Spread;
use crate::form::elastic::displacement;
use crate::scene::{Contact, Fault, Scene, Vec3, faces};
use crate::space::plate::crossing;

/// Radius of the disc over the thickness, where the body is a plate around it and where it is not.
const OF_THICKNESS: [f64; 2] = [2.0, 1.0];

/// How far the disc is kept from the radius at which the contact law has no stiffness left.
const MARGIN: f64 = 1.25;

/// Where the body is loaded and read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PatchModel {
    /// The patch that is stood for; `None` for the limit of a small one.
    pub patch: Option<Patch>,
    /// Its pressure, spread over a disc.
    pub spread: Spread,
    /// Radius of the disc, m.
    pub disc: f64,
    /// c of the contact law for the whole body, m/N.
    pub compliance: f64,
    /// Whether the body bends alone: displacements along the face are odd across the thickness, those across it even. What else there is,
    /// squeezing, is then a constant of the contact law, as on an infinite layer at rest.
    pub bends: bool,
    /// Whether stresses near the hit lack the local field of a layer. (Nearer than a thickness to an edge they have none.)
    pub is_layer: bool,
    /// The same of several layers together.
    pub is_stack: bool,
}

impl PatchModel {
    /// The patch of the scene, or the limit of a small one, on a disc for which the face has room.
    ///
    /// # Errors
    /// A fault of the scene where there is none.
    pub fn new(geometry: &BoxGeometry, scene: &Scene) -> Result<Self> {
        let (struck, impactor) = (scene.body.struck(), &scene.impactor);
        let thickness = scene.body.struck_thickness(geometry.size[geometry.struck]);
        let room = geometry.plane().map(|axis| 0.5 * geometry.size[axis] - geometry.hit[axis].abs());
        let room = room[0].min(room[1]);
        let key = if matches!(scene.contact, Contact::Patch { radius: Some(_), .. }) {
            "contact.patch_radius"
        } else {
            "impactor.point"
        };
        let fault = |message: String, help: &str| Fault::new(key, message, help);
        let far = "an impact point farther from the edge of the surface, or a smaller patch where one is given";
        if room <= 1e-6 * thickness {
            return Err(fault("the edge of the surface leaves no room for a patch".into(), far).into());
        }
        let (given, given_disc) = match scene.contact {
            Contact::Patch { radius, disc } => (radius, disc),
            Contact::Point => (None, None),
        };
        let radius = given.unwrap_or(0.0);
        if radius > room * (1.0 + 1e-9) {
            let message = format!("a patch of radius {radius:.3e} m has no room at {room:.3e} m from an edge");
            return Err(fault(message, far).into());
        }
        let is_stack = is_layer(geometry, scene);
        let is_layer = geometry.interfaces.is_empty() && is_stack;
        let is_plate = is_layer && room >= OF_THICKNESS[0] * thickness;
        let bends = is_plate && is_bent(geometry, scene);
        let half_space = unit_compliance(&struck, impactor.direction[geometry.struck]);
        let compliance = |disc: f64| {
            let spread = Spread::new((radius / disc).min(1.0));
            let of_layer = if is_plate { beyond_half_space(&spread, struck.poisson, disc / thickness) } else { 0.0 };
            let of_squeezing = if bends { squeezing(&spread, struck.poisson, disc / thickness) } else { 0.0 };
            half_space * spread.compliance() / disc + (of_layer - of_squeezing) / (struck.young * thickness)
        };
        let mass = scene.body.mass().unwrap_or_default();
        // Discs on which the contact law has no stiffness left: on a half-space, and at least.
        let limits = |disc: f64| limits(&struck, impactor, mass, thickness, disc * compliance(disc));
        let by_rule = OF_THICKNESS[usize::from(!is_plate)] * thickness;
        let mut disc = given_disc.unwrap_or(by_rule).min(room).max(radius);
        let (mut wanted, mut least) = limits(disc);
        for _ in 0..20 {
            let next = disc.max(MARGIN * wanted).min(room.max(radius));
            if next == disc {
                break;
            }
            disc = next;
            (wanted, least) = limits(disc);
        }
        if disc < least {
            let message = format!(
                "the contact has negative stiffness on {disc:.3e} m around the impact point: for this impact it takes about {least:.3e} m"
            );
            return Err(fault(message, "an impact point farther from the edge of the surface, or another face").into());
        }
        let patch =
            given.map(|radius| Patch { radius, reason: Reason::Scene, thickness, cell: 0.0, limit_radius: 0.0 });
        let spread = Spread::new((radius / disc).min(1.0));
        Ok(Self { patch, spread, disc, compliance: compliance(disc), bends, is_layer, is_stack })
    }

    /// a: the spread pressure on the disc of the struck face, with total 1, times the direction.
    pub fn localization(&self, geometry: &BoxGeometry, points: &Points, direction: Vec3) -> Vec<f64> {
        let plane = geometry.plane();
        let centre = plane.map(|axis| geometry.hit[axis]);
        let mut a = vec![0.0; points.tensor.unknowns()];
        for (x, line) in self.spread.strips(centre, self.disc, plane.map(|axis| &points.lines[axis][..])) {
            let mut place = geometry.hit;
            place[plane[0]] = x;
            for (component, d) in direction.into_iter().enumerate().filter(|(_, d)| *d != 0.0) {
                let part = (displacement(component), geometry.copies() * d);
                points.tensor.add_line(part, (place, plane[1]), &line, &mut a);
            }
        }
        a
    }
}

/// Whether the body is a layer around the point, for a force along its normal: free below. How wide it is there is not asked.
fn is_layer(geometry: &BoxGeometry, scene: &Scene) -> bool {
    let is_free = |surface: &str| faces(surface).iter().all(|(axis, _)| *axis != geometry.struck);
    let is_normal = (scene.impactor.direction[geometry.struck].abs() - 1.0).abs() < 1e-9;
    is_normal && scene.supports.iter().all(|support| is_free(&support.surface))
}

/// [`crossing`] up to which squeezing is as good as at rest; up to 0.024 it was measured to be.
const SLOW: f64 = 0.03;

/// Whether nothing but the hit squeezes or stretches a plate, and that slowly: no load along its face or on one of its sides, no
/// displacement of a support along it.
fn is_bent(geometry: &BoxGeometry, scene: &Scene) -> bool {
    let across = |v: Vec3| (0..3).all(|axis| axis == geometry.struck || v[axis] == 0.0);
    crossing(scene) <= SLOW
        && scene.load.traction.is_empty()
        && across(scene.load.body_force)
        && across(scene.load.gravity)
        && scene.supports.iter().all(|support| {
            across(support.displacement) && !support.couples_stretching(geometry.struck, geometry.size[geometry.struck])
        })
}
