//! Localisation by a patch, on which the contact force is Hertz's pressure over a disc of the surface, or by a given area.
//!
//! The disc lies in the tangent plane of the surface at the impact point, and the surface is projected onto it. The
//! same vector a applies the load and defines the displacement, so that energy and momentum balances are exact. The
//! compliance of an elastic half-space under the patch is already contained in Hertz's law, and is subtracted by c_l.
//! Nothing is subtracted on a given area.

use std::collections::BTreeMap;

use nalgebra::Vector3;
use petsc_wrap::Int;

use super::location::site;
use crate::contact::{Footprint, ForceLaw, Localization, Patch, Reason, limits, unit_compliance};
use crate::error::Result;
use crate::form::{AreaShape, ContactArea, PressureForms};
use crate::mesh::{Mesh, Site};
use crate::scene::{Fault, Scene, Vec3};

/// Key of the radius in a scene.
const KEY: &str = "contact.patch_radius";

/// Tolerated deviation of the total of a patch from 1, far above the quadrature error.
const MISSING: f64 = 1e-10;

/// Factor by which a patch is repeatedly reduced until it fits on the surface.
const SMALLER: f64 = 0.8;

impl Localization {
    /// Consistent load vector of Hertz's pressure with total 1 over a disc around the impact point, times the direction
    /// of travel. Without a given radius (m), a radius is chosen from the thickness, the cells and the contact, and
    /// reduced until the disc fits on the surface. Collective.
    ///
    /// # Errors
    /// A fault of the scene, if the point is off the surface, if the direction leads out of the body, if the patch
    /// extends beyond the surface, or if the contact stiffness would vanish even on a thin plate. If a PETSc call
    /// fails.
    pub fn patch(mesh: &Mesh, scene: &Scene, radius: Option<f64>) -> Result<Self> {
        let (struck, impactor) = (scene.body.struck(), &scene.impactor);
        let site = site(mesh, impactor)?;
        let thickness = scene.body.struck_thickness(mesh.thickness(&site));
        let cosine = Vector3::from(site.normal).dot(&Vector3::from(impactor.direction));
        let unit_compliance = unit_compliance(&struck, cosine);
        let multiplicity = mesh.multiplicity as f64;
        let density = scene.body.composition.density().unwrap_or(struck.density);
        let mass = multiplicity * density * mesh.volume();
        let (limit_radius, least) = limits(&struck, impactor.blow(), mass, thickness, unit_compliance);
        let has_hertz_law = matches!(impactor.force_law, ForceLaw::Hertz(_));
        let chosen = Patch::choose(thickness, site.cell, limit_radius, has_hertz_law);
        let axes = Axes::new(&site);
        let (patch, weights) = match radius {
            Some(radius) => (
                Patch { radius, disc: radius, reason: Reason::Scene, ..chosen },
                weights_of_given(mesh, &axes, radius, least)?,
            ),
            None => fit(mesh, &axes, chosen, least)?,
        };
        let compliance = multiplicity * unit_compliance / patch.radius;
        Ok(Self {
            compliance,
            footprint: Footprint::Patch(patch),
            ..Self::of_nodes(mesh, &weights, impactor.direction)?
        })
    }

    /// Consistent load vector of the pressure on a given area around the impact point, times the direction of travel. The sides
    /// of a square are along the axes in the face, where it is normal to an axis. Collective.
    ///
    /// # Errors
    /// A fault of the scene, if the point is off the surface, if the direction leads out of the body, or if the area extends
    /// beyond the surface. If a PETSc call fails.
    pub fn area(mesh: &Mesh, scene: &Scene, area: &ContactArea) -> Result<Self> {
        let site = site(mesh, &scene.impactor)?;
        let (weights, share) = weights(mesh, &Axes::new(&site), area);
        check_whole(share, "contact.area", "the area on which the contact presses")?;
        let radius = area.equivalent_radius();
        let footprint = Footprint::Patch(Patch {
            radius,
            disc: radius,
            reason: Reason::Area,
            thickness: scene.body.struck_thickness(mesh.thickness(&site)),
            cell: site.cell,
            limit_radius: 0.0,
            has_hertz_law: false,
        });
        Ok(Self { footprint, ..Self::of_nodes(mesh, &weights, scene.impactor.direction)? })
    }
}

/// Weights of a patch whose radius the scene prescribes. Collective.
fn weights_of_given(mesh: &Mesh, axes: &Axes, radius: f64, least: f64) -> Result<Vec<(Int, f64)>> {
    if radius < least {
        let message = format!(
            "a patch of radius {radius:.3e} m is too small for this impact: below about {least:.3e} m the contact has \
             negative stiffness"
        );
        return Err(Fault::new(KEY, message, "a larger radius, or `localization = \"point\"`").into());
    }
    let (weights, share) = weights(mesh, axes, &hertz_disc(radius));
    check_whole(share, KEY, &format!("a patch of radius {radius:.3e} m"))?;
    Ok(weights)
}

fn hertz_disc(radius: f64) -> ContactArea {
    ContactArea { shape: AreaShape::HertzDisc, half_width: radius }
}

/// Checks that the whole load lies on the surface, once.
fn check_whole(share: f64, key: &str, what: &str) -> Result<()> {
    if is_whole(share) {
        return Ok(());
    }
    let message = if share < 1.0 {
        format!("only {:.2}% of {what} is on the surface", 100.0 * share)
    } else {
        format!("the surface lies {share:.2} times within {what}")
    };
    let help = "a smaller radius or side, or an impact point farther from the edge of the surface";
    Err(Fault::new(key, message, help).into())
}

/// The patch, or the first smaller one that fits on the surface, and its weights. Collective.
fn fit(mesh: &Mesh, axes: &Axes, mut patch: Patch, least: f64) -> Result<(Patch, Vec<(Int, f64)>)> {
    // No patch is wider than the body.
    if patch.radius > mesh.diameter {
        patch = patch.cut_to(mesh.diameter);
    }
    // If no radius is too small, this bound ends the loop for an impact on the very edge of the surface.
    while patch.radius >= least.max(1e-6 * mesh.diameter) {
        let (weights, share) = weights(mesh, axes, &hertz_disc(patch.radius));
        if is_whole(share) {
            return Ok((patch, weights));
        }
        patch = patch.cut_to(SMALLER * patch.radius);
    }
    let message = format!(
        "the surface around the impact point has no room for a patch of radius {:.3e} m, and below about {least:.3e} m the \
         contact has negative stiffness",
        patch.radius / SMALLER
    );
    let help = "an impact point farther from the edge of the surface, or `localization = \"point\"`";
    Err(Fault::new(KEY, message, help).into())
}

fn is_whole(share: f64) -> bool {
    (share - 1.0).abs() < MISSING
}

/// Coordinate axes at the impact point: two in the plane of the patch, and the outward normal.
struct Axes {
    origin: Vector3<f64>,
    axes: [Vector3<f64>; 3],
}

impl Axes {
    fn new(site: &Site) -> Self {
        let normal = Vector3::from(site.normal);
        let mut least = Vector3::zeros();
        least[normal.iamin()] = 1.0;
        let first = normal.cross(&least).normalize();
        Self { origin: site.x.into(), axes: [first, normal.cross(&first), normal] }
    }

    fn coordinates(&self, x: Vec3) -> [f64; 3] {
        let from = Vector3::from(x) - self.origin;
        self.axes.map(|axis| axis.dot(&from))
    }
}

/// Non-zero weights ∫ p φ dA by ascending node, divided by their sum; and the ratio of this sum to its value for a
/// patch that lies entirely on the surface. The same on all ranks. Collective.
///
/// Facets farther from the plane than the radius of the patch belong to another part of the surface. On a quarter of
/// the body, a quarter of the patch carries a quarter of the force; the weights still sum to 1.
fn weights(mesh: &Mesh, axes: &Axes, area: &ContactArea) -> (Vec<(Int, f64)>, f64) {
    let facets = &mesh.facets;
    let forms = PressureForms::new(facets.shape, facets.order, area.shape);
    let radius = area.half_width;
    let mut load = vec![0.0; facets.nodes_each()];
    let (mut nodes, mut values) = (Vec::new(), Vec::new());
    for facet in 0..facets.len() {
        let x: Vec<Vec3> = facets.x(facet).iter().map(|x| axes.coordinates(*x).map(|c| c / radius)).collect();
        if x.iter().all(|x| x[2] > 1.0) || x.iter().all(|x| x[2] < -1.0) {
            continue;
        }
        let plane: Vec<[f64; 2]> = x.iter().map(|x| [x[0], x[1]]).collect();
        forms.load(&plane, &mut load);
        let met = facets.nodes(facet).iter().zip(&load).filter(|(_, value)| **value != 0.0);
        for (node, value) in met {
            nodes.push(*node);
            values.push(*value);
        }
    }
    let mut sum = BTreeMap::new();
    for (node, value) in mesh.comm.all_gather(&nodes).into_iter().zip(mesh.comm.all_gather(&values)) {
        *sum.entry(node).or_insert(0.0) += value;
    }
    let total: f64 = sum.values().sum();
    let weights = sum.into_iter().map(|(node, value)| (node, value / total)).collect();
    (weights, total * mesh.multiplicity as f64)
}
