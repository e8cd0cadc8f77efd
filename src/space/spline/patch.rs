//! Loaded disc of a box of splines, and the compliance that remains for the contact law.

use super::Points;
use super::geometry::BoxGeometry;
use super::layer::{beyond_half_space, squeezing, stack_beyond_half_space};
use super::points::stack;
use crate::contact::{Footprint, ForceLaw, Patch, Reason, dent, limits, unit_compliance};
use crate::description::Description;
use crate::error::Result;
use crate::form::Spread;
use crate::form::elastic::displacement;
use crate::scene::{CLEAR_OF_SUPPORTS, Contact, Fault, Scene, Vec3};
use crate::space::plate::crossing;

/// Radius of the disc divided by the thickness: where the body is a plate around the impact point, and where it is not.
const DISC_OVER_THICKNESS: [f64; 2] = [2.0, 1.0];

/// Safety factor on the radius at which the contact stiffness vanishes.
const MARGIN: f64 = 1.25;

/// Model of the loaded disc, over which the displacement is averaged too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PatchModel {
    /// Patch that the disc represents, or the disc for the limit of a small patch.
    pub footprint: Footprint,
    /// Pressure of the patch, spread over the disc.
    pub spread: Spread,
    /// Radius of the disc, m.
    pub disc: f64,
    /// Compliance c of the contact law for the whole body, m/N.
    pub compliance: f64,
    /// Whether the body is modelled in pure bending: in-plane displacements are odd across the thickness, normal
    /// displacements even. The remaining deformation, squeezing, is then a constant of the contact law, as for an
    /// infinite layer under a static load.
    pub bends: bool,
    /// Whether the body is a single layer, so that its local field is added to the stresses near the impact point.
    pub is_layer: bool,
    /// The same for a body of one or several layers.
    pub is_stack: bool,
}

impl PatchModel {
    /// Model of the scene's patch, or of the limit of a small patch, on a disc that fits on the face.
    ///
    /// # Errors
    /// A fault of the scene, if there is no such disc.
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
            Contact::Area(_) | Contact::Point => (None, None),
        };
        let area = scene.contact.area();
        let radius = given.unwrap_or(0.0);
        if radius > room * (1.0 + 1e-9) {
            let message = format!("a patch of radius {radius:.3e} m has no room at {room:.3e} m from an edge");
            return Err(fault(message, far).into());
        }
        let is_stack = scene.is_free_layer(CLEAR_OF_SUPPORTS);
        let is_layer = geometry.interfaces.is_empty() && is_stack;
        let is_plate = is_layer && room >= DISC_OVER_THICKNESS[0] * thickness;
        let bends = is_plate && scene.is_free_layer(f64::INFINITY) && is_bent(geometry, scene);
        let cosine = impactor.direction[geometry.struck];
        let half_space = unit_compliance(&struck, cosine);
        // On a given area the dent of a half-space is no part of the law, but of the surface's displacement.
        let dent = area.map_or(0.0, |area| dent(area, &struck, cosine));
        let spread_over = |disc: f64| match area {
            Some(area) => Spread::of_area(area, disc),
            None => (Spread::new((radius / disc).min(1.0)), disc),
        };
        let compliance = |disc: f64| {
            let (spread, disc) = spread_over(disc);
            let of_layer = if is_plate { beyond_half_space(&spread, struck.poisson, disc / thickness) } else { 0.0 };
            let of_squeezing = if bends { squeezing(&spread, struck.poisson, disc / thickness) } else { 0.0 };
            half_space * spread.compliance() / disc - dent + (of_layer - of_squeezing) / (struck.young * thickness)
        };
        let mass = scene.body.mass().unwrap_or_default();
        // Radii of the disc at which the contact stiffness vanishes: on a half-space, and the smallest for any body.
        let limits = |disc: f64, compliance: f64| match area {
            Some(_) => (0.0, 0.0),
            None => limits(&struck, impactor.blow(), mass, thickness, disc * compliance),
        };
        let by_rule = DISC_OVER_THICKNESS[usize::from(!is_plate)] * thickness;
        let mut disc = given_disc.unwrap_or(by_rule).min(room).max(radius);
        let (mut wanted, mut least) = limits(disc, compliance(disc));
        for _ in 0..20 {
            let next = disc.max(MARGIN * wanted).min(room.max(radius));
            if next == disc {
                break;
            }
            disc = next;
            (wanted, least) = limits(disc, compliance(disc));
        }
        if disc < least {
            let message = format!(
                "the contact has negative stiffness on {disc:.3e} m around the impact point: for this impact it takes about {least:.3e} m"
            );
            return Err(fault(message, "an impact point farther from the edge of the surface, or another face").into());
        }
        // The moduli of a viscoelastic stack are those of one temperature. The disc does not depend on them, so that all
        // temperatures have the same cells.
        let is_wide_stack = is_stack && !is_layer && room >= DISC_OVER_THICKNESS[0] * thickness;
        let layered = impactor.layered_contact().filter(|_| given.is_none());
        let has_law_of_layers = layered.is_some();
        if let Some(layered) = layered {
            disc = layered.disc.min(room);
        }
        let own = compliance(disc);
        let (spread, disc) = spread_over(disc);
        let parts = Description::new(scene).parts;
        let stack = stack(&parts, geometry, impactor.moduli_time()).filter(|_| is_wide_stack || has_law_of_layers);
        let of_stack = stack.map_or(0.0, |stack| stack_beyond_half_space(&stack, &spread, disc));
        // On layers without a law of their own, Hertz's law with this part may have negative stiffness on any disc. The layer
        // is then treated as a half-space.
        let (wanted, _) = limits(disc, own + of_stack);
        let is_kept = has_law_of_layers || of_stack <= 0.0 || MARGIN * wanted <= disc;
        let of_stack = if is_kept { of_stack } else { 0.0 };
        let footprint = match given {
            Some(radius) => Footprint::Patch(Patch {
                radius,
                disc,
                reason: Reason::Scene,
                thickness,
                cell: 0.0,
                limit_radius: 0.0,
                has_hertz_law: matches!(impactor.force_law, ForceLaw::Hertz(_)),
            }),
            None if area.is_some() => Footprint::Area { radius: disc },
            None => Footprint::Disc { radius: disc },
        };
        Ok(Self { footprint, spread, disc, compliance: own + of_stack, bends, is_layer, is_stack })
    }

    /// Localisation vector a: the spread pressure on the disc of the impacted face, with total 1, times the direction.
    pub fn localization(&self, geometry: &BoxGeometry, points: &Points, direction: Vec3) -> Vec<f64> {
        let plane = geometry.plane();
        let centre = plane.map(|axis| geometry.hit[axis]);
        let mut a = vec![0.0; points.tensor.unknowns()];
        for (x, line) in self.spread.strips(centre, self.disc, plane.map(|axis| &points.lines[axis][..])) {
            let mut place = geometry.hit;
            place[plane[0]] = x;
            for (component, d) in direction.into_iter().enumerate().filter(|(_, d)| *d != 0.0) {
                let part = (displacement(component), geometry.multiplicity() * d);
                points.tensor.add_line(part, (place, plane[1]), &line, &mut a);
            }
        }
        a
    }
}

/// Largest [`crossing`] for which squeezing is treated as quasi-static. This was verified up to 0.024.
const SLOW: f64 = 0.03;

/// Whether a plate is squeezed or stretched only by the impact, and slowly: there is no traction, no body force along
/// the face, and no support that displaces or stretches the plate along it.
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
