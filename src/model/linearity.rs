//! Checks whether a plate's deflection is within the range of a geometrically linear model.
//!
//! A plate that deflects by more than about half of its thickness is stretched in its plane, which makes it stiffer.
//! For a uniformly loaded circular plate the load for a given deflection grows by the factor 1 + c (w/h)². c is 0.146
//! and 0.262 for a clamped and a simply supported edge that may move in the plane, 0.471 and 1.852 if it may not (S.
//! Timoshenko & S. Woinowsky-Krieger, Theory of Plates and Shells, 1959, §100, Table 82).

use nalgebra::{Matrix3, Vector3};

use crate::contact::Patch;
use crate::impact::step::Step;
use crate::scene::{Geometry, Load, Model, Scene, Support, Vec3, faces};

/// Deflection over the thickness above which the membrane forces are no longer small.
const LARGE: f64 = 0.5;

/// The same if opposite edges are constrained in the plane. With the largest c this is 12% of the stiffness.
const LARGE_FOR_HELD_EDGES: f64 = 0.25;

/// Smallest and largest c.
pub const STIFFENING: [f64; 2] = [0.15, 1.9];

/// Computes the deflection of a plate in a run.
#[derive(Debug, Clone, Copy)]
pub struct Linearity {
    /// Thickness h, m.
    thickness: f64,
    /// Rigid-body displacement at the impact point per time integral of the impulse, 1/kg, for a body that is free or on
    /// springs alone.
    mobility: Option<f64>,
    has_supports: bool,
    mass: f64,
    speed: f64,
    gravity: f64,
    edges: Edges,
}

/// Motion of the edges of a plate in its plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edges {
    /// Clamps hold two opposite edges over their whole length, perpendicular to them.
    Held,
    /// The plate is free, or held at one edge alone.
    Movable,
    /// Springs or parts of edges may hold them.
    Unknown,
}

impl Linearity {
    /// For a box that is struck on a face, or a mesh with supports and a patch, by a theory with bending. `None` if the
    /// thickness or the rigid motion is not known. The latter is the case for a free body with loads, and if no support
    /// resists motion along the impact.
    pub fn new(scene: &Scene, theory: Model, patch: Option<&Patch>) -> Option<Self> {
        let impactor = &scene.impactor;
        let is_free = scene.supports.is_empty();
        let is_held = scene.supports.iter().any(|support| holds_along(support, impactor.direction));
        let is_loaded = scene.load != Load::default();
        let is_a_formula = matches!(theory, Model::HalfSpace | Model::InfinitePlate);
        if is_a_formula || is_free && is_loaded || !is_free && !is_held {
            return None;
        }
        let is_spring = |support: &Support| !support.is_rigid() && !support.may_lift_off();
        let can_fly = scene.supports.iter().all(is_spring) && !is_loaded;
        let (thickness, mobility) = match (&scene.body.geometry, scene.struck_axis(), patch) {
            (Geometry::Box { size, .. }, Some(axis), _) => (size[axis], mobility(scene, *size).filter(|_| can_fly)),
            (_, _, Some(patch)) if !is_free => (patch.thickness, None),
            _ => return None,
        };
        if is_free && mobility.is_none() {
            return None;
        }
        Some(Self {
            thickness,
            mobility,
            has_supports: !is_free,
            mass: impactor.mass,
            speed: impactor.speed,
            gravity: impactor.gravity,
            edges: edges(scene),
        })
    }

    /// Bending deflection of the body at the impact point, m: without its rigid motion, free or on its supports. On
    /// springs it is the smaller of two estimates: one for springs that are too soft to matter yet, one for a body that
    /// has come to rest on them.
    pub fn deflection(&self, step: &Step) -> f64 {
        let moved = step.contact.surface_displacement;
        let as_free = self.mobility.map(|mobility| {
            // The impulse so far equals the momentum lost by the impactor, so its integral is the mass times the lag
            // behind free flight.
            let flown = step.time * (self.speed + 0.5 * self.gravity * step.time);
            (moved - mobility * self.mass * (flown - step.impactor.position)).abs()
        });
        let on_supports = self.has_supports.then(|| {
            // Body and supports are springs in series: their shares of the displacement are their shares of the energy.
            let (body, supports) = (step.energy.elastic, step.energy.support);
            let part = if supports > 0.0 { body / (body + supports) } else { 1.0 };
            (part * moved).abs()
        });
        as_free.into_iter().chain(on_supports).fold(f64::INFINITY, f64::min)
    }

    /// A deflection (m) over the thickness.
    pub fn over_thickness(&self, deflection: f64) -> f64 {
        deflection / self.thickness
    }

    /// A deflection (m) over the thickness, if that ratio is large.
    pub fn excess(&self, deflection: f64) -> Option<f64> {
        Some(self.over_thickness(deflection)).filter(|ratio| *ratio > largest_linear(self.edges))
    }

    /// Motion of the edges of the plate in its plane.
    pub fn edges(&self) -> Edges {
        self.edges
    }
}

/// Whether a support resists the motion along the impact in both senses.
fn holds_along(support: &Support, direction: Vec3) -> bool {
    let holds = |axis: usize| support.stiffness_along(axis) > 0.0 && direction[axis] != 0.0;
    !support.may_lift_off() && (0..3).any(holds)
}

/// Largest deflection over the thickness for which a geometrically linear model serves.
pub fn largest_linear(edges: Edges) -> f64 {
    if edges == Edges::Held { LARGE_FOR_HELD_EDGES } else { LARGE }
}

/// Motion of the edges of a scene's plate in its plane.
pub fn edges(scene: &Scene) -> Edges {
    let Some(struck) = scene.struck_axis() else { return Edges::Unknown };
    let is_held = |face: (usize, bool)| scene.supports.iter().any(|support| support.clamps_face(face, face.0));
    let mut supported = scene.supports.iter().flat_map(|support| faces(&support.surface));
    let first = supported.next();
    if (0..3).any(|axis| axis != struck && is_held((axis, false)) && is_held((axis, true))) {
        Edges::Held
    } else if first.is_none_or(|first| first.0 != struck && supported.all(|face| face == first)) {
        Edges::Movable
    } else {
        Edges::Unknown
    }
}

/// Mobility of a rigid box, aᵀ(M⁻¹)a = 1/m + (r × d)·I⁻¹(r × d), 1/kg.
fn mobility(scene: &Scene, size: [f64; 3]) -> Option<f64> {
    let mass = scene.body.mass()?;
    let [a, b, c] = size.map(|edge| edge * edge);
    let inertia = Matrix3::from_diagonal(&(Vector3::new(b + c, a + c, a + b) * (mass / 12.0)));
    let moment = Vector3::from(scene.impactor.point).cross(&Vector3::from(scene.impactor.direction));
    Some(1.0 / mass + moment.dot(&(inertia.try_inverse()? * moment)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Edges that are clamped in the plane stiffen the plate from a quarter of its thickness on: all edges, or two
    /// opposite ones perpendicular to themselves.
    #[test]
    fn edges_that_are_held_stiffen_sooner() {
        let held = |supports: &str| {
            let text = format!(
                "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.4, 0.3, 0.01]\n{supports}\n\
                 [impactor]\nmass = 1.0\nradius = 0.03\nyoung = 3e9\npoisson = 0.3\nspeed = 3.0\n[time]\nend = 0.008\n"
            );
            let scene = Scene::parse("scene", &text, &[]).expect("a scene").0;
            let linearity = Linearity::new(&scene, Model::Mindlin, None).expect("a plate");
            assert!(linearity.excess(0.24 * 0.01).is_none() && linearity.excess(0.51 * 0.01).is_some());
            assert_eq!(linearity.excess(0.3 * 0.01).is_some(), linearity.edges() == Edges::Held);
            linearity.edges()
        };
        let clamp = |surface: &str, components: &str| {
            format!("[[support]]\nsurface = \"{surface}\"\nkind = \"clamped\"\n{components}\n")
        };
        let both = |components: &str| clamp("x-min", components) + &clamp("x-max", components);
        for supports in [clamp("side", ""), both("components = [\"x\", \"z\"]")] {
            assert_eq!(held(&supports), Edges::Held);
        }
        for supports in [clamp("side", "components = [\"z\"]"), both("components = [\"y\", \"z\"]")] {
            assert_eq!(held(&supports), Edges::Unknown);
        }
        assert_eq!(held(&clamp("x-min", "")), Edges::Movable);
    }
}
