//! Local field under the contact, which the stresses of a discretised body lack near the impact point.

use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;
use std::rc::Rc;
use std::sync::Arc;

use crate::contact::LayeredContact;
use crate::form::Spread;
use crate::scene::{Contact, Geometry, Impactor, Scene, Vec3, faces};
use crate::space::plate::LEAST_LAYER;
use crate::stack::{
    Carrier, Cylindrical, LEAST_DEPTH_OVER_CONTACT, Layer, Layerwise, LocalField, PointField, Pressure, Sections, Stack,
};

/// Distance from the impact point, divided by the thickness, within which stresses are evaluated as means over a disc.
const SMOOTHED: f64 = 2.0;

/// Distance from the impact point within which the local field is added, divided by the thickness, or by the contact
/// radius if that is larger.
const REACH: f64 = 4.0;

/// Smallest ratio of the radius of the averaging disc to the cell size. With 3, the mean under a static force is
/// accurate to 0.1%, on the coarsest plates of a tolerance of 1e-2. With 4 and more the disc is so wide that the motion
/// of the plate within it matters.
const CELLS: f64 = 3.0;

/// Estimated relative error of a tension opposite the impact point due to such a mean. It is larger than under a static
/// force: it was fitted to impacts, and a smaller value was below the true error of one solid. With fewer cells in the
/// disc, for lack of room, the error grows with the power `ORDER_OF_MEAN` of the cell size. This power was measured
/// under a static force with a coarser quadrature (0.3% with three cells, 1.1% with two).
const MEAN_ERROR: f64 = 2.5e-3;
const ORDER_OF_MEAN: f64 = 3.2;

/// Estimated relative error due to the motion of the plate within the averaging disc, for a disc as wide as the loaded
/// disc of the body. It grows with the square of the ratio of the two radii. Fitted to plates whose averaging disc is 2
/// to 2.7 times as wide as their loaded disc.
const WIDE_MEAN_ERROR: f64 = 8e-4;

/// Estimated relative error of the tension opposite the impact point due to one edge of a plate at a distance of one
/// thickness of the impacted layer. The local field is that of a plate without edges. The error falls with the cube of
/// the distance. Fitted to a hit at the corner of two clamped edges: the tension differed from a solid's by 2.1% at one
/// thickness, by 0.7% at 1.5 and by 0.1% at 2. At one edge it differed by 0.6% at one thickness, for free, hinged and
/// clamped edges; nearer to a free edge, by 2.1% at 0.75 and by 3.1% at 0.55. The tension between the impact point and
/// that edge, which is not evaluated, was larger by 0.6% at one thickness and by 2.2% at most.
const EDGE_ERROR: f64 = 0.012;

/// Radius of the averaging disc, divided by the thickness of the loaded layer, from which the sum over waves of the
/// local field of a mean converges.
pub const LEAST_MEAN: f64 = 0.45;

/// Contact radius, divided by the thickness, up to which tables are computed at least. The members of a sweep share
/// these tables.
const LEAST_TABLE: f64 = 0.4;

/// Ratio of the largest contact radius to the contact radius of the same impact on a half-space.
const WIDEST: f64 = 1.2;

/// How a body carries the contact force.
#[derive(Debug, Clone, PartialEq)]
pub struct Hit {
    /// Pressure applied to the body.
    pub pressure: Pressure,
    /// Mechanical model of the body.
    pub body: HitBody,
    /// Longest edge of the cells at the impact point, m.
    pub cell: f64,
}

/// Mechanical model of the body that carries the contact force.
#[derive(Debug, Clone, PartialEq)]
pub enum HitBody {
    /// Body of one layer.
    OneLayer(Sections),
    /// Layerwise plate.
    Layerwise(Layerwise),
    /// Solid of several layers, which are resolved.
    Layers(Stack),
}

impl Hit {
    /// Longest edge, along the axes of a face, of the cells that contain a point, m. `lines` holds the ends of the
    /// cells along each axis.
    pub fn cell(lines: &[Vec<f64>; 3], struck: usize, point: Vec3) -> f64 {
        let of_axis = |axis: usize| {
            let holds = |ends: &&[f64]| ends[0] <= point[axis] && point[axis] <= ends[1];
            lines[axis].windows(2).filter(holds).map(|ends| ends[1] - ends[0]).fold(0.0, f64::max)
        };
        (0..3).filter(|axis| *axis != struck).map(of_axis).fold(0.0, f64::max)
    }
}

/// Size of the contact area.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ContactSize {
    /// Radius of curvature R of Hertz's contact, m; the contact radius is √(Rα).
    pub curvature: Option<f64>,
    /// Prescribed contact radius (m), or the equivalent one of a prescribed area.
    pub given: f64,
    /// Contact with a stack of layers, whose radius is not Hertz's.
    pub layered: Option<Arc<LayeredContact>>,
}

/// State of the contact at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactNow {
    /// Force F on the whole body, N.
    pub force: f64,
    /// Contact radius, m.
    pub radius: f64,
}

/// Bits of the distance from the line of the force and of the depth, and whether stresses are evaluated as means.
type Reading = ([u64; 2], bool);

/// Neighbourhood of the impact point of a body, modelled as an infinite stack of layers.
pub struct NearHit {
    hit: Hit,
    stack: Stack,
    /// The stack with the secant moduli at the contact time T on a half-space, in place of T/2; `None` if all layers are
    /// elastic.
    stack_at_end: Option<Stack>,
    /// Axis normal to the impacted face.
    pub struck: usize,
    point: Vec3,
    /// Distances of the impact point from the edges, m.
    edges: [f64; 4],
    largest: f64,
    /// Contact radius at the peak of an impact on a body that does not deflect, m.
    contact_radius: f64,
    of_relaxation: OnceCell<f64>,
    /// Whether the contact has the law of a sphere on the layers.
    has_layered_contact: bool,
    by_sections: OnceCell<LocalField>,
    as_it_is: OnceCell<LocalField>,
    /// Field of the patch load of a mesh minus the field of a wide disc on a plate. Stress recovery cannot reproduce
    /// it.
    patch: OnceCell<LocalField>,
    /// Fields evaluated so far. Points that mirror each other across a diagonal have the same field.
    fields: RefCell<HashMap<Reading, Rc<PointField>>>,
    /// Field `patch` by distance and depth. Samples of a mesh are used by several nodes and have mirror images.
    of_patch: RefCell<HashMap<[u64; 2], Cylindrical>>,
}

/// Local field at one point.
#[derive(Debug, Clone)]
pub struct LocalPoint {
    field: Rc<PointField>,
    /// Unit vectors radially away from the line of the force, and into the body.
    radial: Vec3,
    inward: Vec3,
    /// Whether Hertz's own field, with its ring of tension, is included.
    has_ring: bool,
    /// Part of the body's field that is lost by stress recovery, for 1 N, Pa.
    lost: [f64; 6],
}

/// Estimated errors of the tension under the impact point, relative to its peak.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TensionErrors {
    /// Error of averaging over a disc, due to the cells within it.
    pub of_cells: f64,
    /// Error of averaging over a disc, due to its width.
    pub of_width: f64,
    /// Error of a plate's local field, which is that of a plate without edges.
    pub of_edges: f64,
    /// Error of the local field because relaxing layers have one secant modulus in it.
    pub of_relaxation: f64,
}

impl ContactSize {
    /// Contact size of a scene: the prescribed patch radius, otherwise Hertz's contact of a round impactor, otherwise a
    /// point.
    pub fn new(scene: &Scene) -> Self {
        match scene.contact {
            Contact::Patch { radius: Some(given), .. } => Self { curvature: None, given, layered: None },
            Contact::Area(area) => Self { curvature: None, given: area.equivalent_radius(), layered: None },
            _ => Self {
                curvature: scene.impactor.radius,
                given: 0.0,
                layered: scene.impactor.layered_contact().cloned(),
            },
        }
    }

    /// Contact radius (m) under a force (N) with an indentation (m).
    fn radius(&self, force: f64, indentation: f64) -> f64 {
        match (&self.layered, self.curvature) {
            (Some(layered), _) => layered.radius(force),
            (None, Some(curvature)) => (curvature * indentation.max(0.0)).sqrt(),
            (None, None) => self.given,
        }
    }

    /// Contact under a force (N) with an indentation (m).
    pub fn now(&self, force: f64, indentation: f64) -> ContactNow {
        ContactNow { force, radius: self.radius(force, indentation) }
    }

    /// Contact radius (m) at the peak of an impact on a body that does not deflect.
    pub fn at_peak(&self, impactor: &Impactor) -> f64 {
        let force_law = self.layered.as_ref().map_or(&impactor.force_law, |layered| &layered.force_law);
        self.radius(force_law.peak_force(impactor.mass, impactor.contact_speed()), impactor.peak_indentation())
    }
}

impl NearHit {
    /// Neighbourhood in a box of one material or of layers that is impacted on a face. It is modelled as an infinite
    /// stack, however near an edge is: the field that is added changes continuously with the place of the impact.
    pub fn new(scene: &Scene, hit: Hit) -> Option<Self> {
        let struck = scene.struck_axis()?;
        let Geometry::Box { size, .. } = &scene.body.geometry else { return None };
        let stack = match &hit.body {
            HitBody::Layerwise(theory) => theory.stack().clone(),
            HitBody::Layers(stack) => stack.clone(),
            HitBody::OneLayer(_) => Stack::new(&[Layer::of(size[struck], scene.body.composition.uniform()?)])?,
        };
        let (point, contact) = (scene.impactor.point, ContactSize::new(scene));
        let [one, other] = [(struck + 1) % 3, (struck + 2) % 3];
        let edges = [(one, 1.0), (one, -1.0), (other, 1.0), (other, -1.0)];
        let edges = edges.map(|(axis, sign)| 0.5 * size[axis] + sign * point[axis]);
        let contact_radius = contact.at_peak(&scene.impactor);
        Some(Self {
            hit,
            stack,
            stack_at_end: stack_at_end(scene, (struck, size[struck])),
            struck,
            point,
            edges,
            largest: (WIDEST * contact_radius).max(LEAST_TABLE * size[struck]),
            contact_radius,
            of_relaxation: OnceCell::new(),
            has_layered_contact: contact.layered.is_some(),
            by_sections: OnceCell::new(),
            as_it_is: OnceCell::new(),
            patch: OnceCell::new(),
            fields: RefCell::default(),
            of_patch: RefCell::default(),
        })
    }

    /// Neighbourhood in a mesh of a box under a patch of a radius, m. `None` unless the impact is normal and both faces
    /// are free of supports.
    pub fn of_patch_on_mesh(scene: &Scene, radius: f64) -> Option<Self> {
        let body = HitBody::OneLayer(Sections::Solid);
        let near = Self::new(scene, Hit { pressure: Pressure::Hertz { radius }, body, cell: 0.0 })?;
        let is_free = |surface: &str| faces(surface).iter().all(|(axis, _)| *axis != near.struck);
        let is_normal = (scene.impactor.direction[near.struck].abs() - 1.0).abs() < 1e-9;
        (is_normal && scene.supports.iter().all(|support| is_free(&support.surface))).then_some(near)
    }

    /// Thickness h, m.
    pub fn thickness(&self) -> f64 {
        self.stack.thickness()
    }

    /// Length to which the extent of the local field is proportional, m: the thickness or, if larger, the largest
    /// contact radius.
    pub fn width(&self) -> f64 {
        self.thickness().max(self.largest)
    }

    /// Radius of the averaging disc, m: the radius of the loaded disc, less on a wide area, or more if cells are coarse, at most the
    /// distance to the edge.
    pub fn smoothing(&self) -> f64 {
        let disc = match self.hit.pressure {
            Pressure::Spread { radius, .. } => radius,
            // The motion of a plate within a wide area matters where the contact is short.
            Pressure::Hertz { radius } => radius.min(2.0 * self.thickness()),
            Pressure::Point => 2.0 * self.thickness(),
        };
        disc.max(CELLS * self.hit.cell).min(nearest(&self.edges))
    }

    /// Estimated errors of the tension opposite the impact point due to averaging and to the local field.
    pub fn tension_errors(&self) -> TensionErrors {
        let (own, disc) = (self.hit.pressure.radius(), self.smoothing());
        let is_plate = matches!(self.hit.body, HitBody::OneLayer(Sections::Plate) | HitBody::Layerwise(_));
        let layer = self.stack.layers()[0].thickness.max(LEAST_LAYER * self.thickness());
        let of_edge = |distance: f64| EDGE_ERROR * (layer / distance).powi(3);
        TensionErrors {
            of_cells: MEAN_ERROR * (CELLS * self.hit.cell / disc).powf(ORDER_OF_MEAN),
            of_width: if own > 0.0 { WIDE_MEAN_ERROR * (disc / own).powi(2) } else { 0.0 },
            of_edges: if is_plate { self.edges.into_iter().map(of_edge).sum() } else { 0.0 },
            of_relaxation: *self.of_relaxation.get_or_init(|| self.relaxation_error()),
        }
    }

    /// |σ(T) − σ(T/2)| h₁²/F. σ(t) is the local radial stress under the force F on the lower face of the layers above the
    /// first one that relaxes, with the secant moduli at t; T is the contact time on a half-space. The total tension there
    /// is about F/h₁², with the thickness h₁ of these layers. 0 if the impacted layer itself relaxes.
    fn relaxation_error(&self) -> f64 {
        let Some(at_end) = &self.stack_at_end else { return 0.0 };
        let layers = self.stack.layers().iter().zip(at_end.layers());
        let depth: f64 = layers.take_while(|(now, end)| now.young == end.young).map(|(layer, _)| layer.thickness).sum();
        if depth == 0.0 {
            return 0.0;
        }
        let tension = |stack: &Stack| {
            let field = LocalField::on_axis(stack.clone(), self.carrier_of_means(stack), self.contact_radius);
            field.at(0.0, depth).stress(self.contact_radius).rr
        };
        (tension(at_end) - tension(&self.stack)).abs() * depth * depth
    }

    /// Point on the other face opposite the impact point, m.
    pub fn under_hit(&self) -> Vec3 {
        let mut x = self.point;
        x[self.struck] = -x[self.struck];
        x
    }

    /// Distance of a point from the line of the force, m.
    pub fn distance(&self, x: Vec3) -> f64 {
        (0..3).filter(|&axis| axis != self.struck).map(|axis| (x[axis] - self.point[axis]).powi(2)).sum::<f64>().sqrt()
    }

    /// Whether a point is the impact point of a contact with the law of the layers, or below it at a depth that the local field does not
    /// resolve. Hertz's field is reported separately; the rest of the stress there is a spurious tension.
    pub fn is_under_layered_contact(&self, x: Vec3) -> bool {
        let depth = (x[self.struck] - self.point[self.struck]).abs();
        let is_resolved = depth > (LEAST_DEPTH_OVER_CONTACT * self.largest).max(1e-6 * self.thickness());
        self.has_layered_contact && !is_resolved && self.distance(x) <= 1e-6 * self.thickness()
    }

    /// Whether stresses at a point are evaluated as means; the averaging disc must lie within the body.
    pub fn is_smoothed(&self, x: Vec3, half: Vec3) -> bool {
        let disc = self.smoothing() * (1.0 - 1e-9);
        let fits = (0..3).filter(|&axis| axis != self.struck).all(|axis| x[axis].abs() + disc <= half[axis]);
        let is_wide = disc >= LEAST_MEAN * self.stack.layers()[0].thickness;
        fits && is_wide && self.distance(x) <= SMOOTHED * self.thickness()
    }

    /// Local field at a point (m) that is to be added to its stresses, which are means of the section stresses or point
    /// values; `None` far away.
    pub fn at(&self, x: Vec3, is_smoothed: bool) -> Option<LocalPoint> {
        let radius = self.distance(x);
        if radius > REACH * self.width() {
            return None;
        }
        let Hit { pressure, body, .. } = &self.hit;
        let pressure = *pressure;
        // Under a point force the moments of a plate are unbounded.
        if pressure == Pressure::Point && !is_smoothed && radius < 0.5 * self.thickness() {
            return None;
        }
        let field = if is_smoothed {
            let reach = SMOOTHED * self.thickness();
            let made =
                || LocalField::within(reach, self.stack.clone(), self.carrier_of_means(&self.stack), self.largest);
            self.by_sections.get_or_init(made)
        } else {
            self.as_it_is.get_or_init(|| {
                let carrier = match body {
                    HitBody::OneLayer(Sections::Plate) => Carrier::Plate { pressure },
                    HitBody::OneLayer(Sections::Solid) | HitBody::Layers(_) => Carrier::Solid { pressure },
                    HitBody::OneLayer(Sections::BentSolid) => Carrier::BentSolid { pressure },
                    HitBody::Layerwise(theory) => {
                        Carrier::Layerwise { pressure, theory: theory.clone(), smoothing: None }
                    }
                };
                LocalField::within(REACH * self.width(), self.stack.clone(), carrier, self.largest)
            })
        };
        let depth = self.depth(x);
        let place = ([radius, depth].map(f64::to_bits), is_smoothed);
        let field = self.fields.borrow_mut().entry(place).or_insert_with(|| Rc::new(field.at(radius, depth))).clone();
        let [radial, inward] = self.directions(x);
        Some(LocalPoint { field, radial, inward, has_ring: true, lost: [0.0; 6] })
    }

    /// Local stresses for 1 N that are to be added to the mean stresses at the point opposite the impact point, for a
    /// contact radius (m), Pa.
    pub fn lack_under_hit(&self, contact_radius: f64) -> [f64; 6] {
        let field = LocalField::on_axis(self.stack.clone(), self.carrier_of_means(&self.stack), contact_radius);
        let [radial, inward] = self.directions(self.under_hit());
        field.at(0.0, self.thickness()).stress(contact_radius).cartesian(radial, inward)
    }

    /// Model of the body that corresponds to stresses evaluated as means, on its stack or one with other moduli.
    fn carrier_of_means(&self, stack: &Stack) -> Carrier {
        let pressure = self.hit.pressure;
        let smoothing = Pressure::Spread { spread: Spread::new(0.0), radius: self.smoothing() };
        match &self.hit.body {
            HitBody::OneLayer(body) => Carrier::Sections { pressure, smoothing, body: *body },
            HitBody::Layerwise(theory) => {
                let theory = if *stack == self.stack { theory.clone() } else { Layerwise::new(stack) };
                Carrier::Layerwise { pressure, theory, smoothing: Some(smoothing) }
            }
            HitBody::Layers(_) => Carrier::Sections { pressure, smoothing, body: Sections::Solid },
        }
    }

    /// Local field at a point of a mesh whose stresses are recovered from samples at some positions, with their
    /// weights. The polynomials of the recovery cannot follow the field of the patch; the lost part is included.
    pub fn recovered(&self, x: Vec3, samples: impl Iterator<Item = (Vec3, f64)>) -> Option<LocalPoint> {
        let point = self.at(x, false)?;
        let mut lost = self.of_patch(x);
        for (place, weight) in samples {
            lost.iter_mut().zip(self.of_patch(place)).for_each(|(lost, stress)| *lost -= weight * stress);
        }
        Some(LocalPoint { lost, ..point })
    }

    /// Field of the patch minus the field of a wide disc on a plate, which polynomials can follow, for 1 N, Pa.
    fn of_patch(&self, x: Vec3) -> [f64; 6] {
        let field = self.patch.get_or_init(|| {
            let pressure = Pressure::Spread { spread: Spread::new(0.0), radius: 2.0 * self.thickness() };
            LocalField::new(self.stack.clone(), Carrier::Plate { pressure }, self.hit.pressure.radius())
        });
        let place = [self.distance(x), self.depth(x)];
        let mut known = self.of_patch.borrow_mut();
        let stress = known
            .entry(place.map(f64::to_bits))
            .or_insert_with(|| field.at(place[0], place[1]).stress(self.hit.pressure.radius()));
        let [radial, inward] = self.directions(x);
        stress.cartesian(radial, inward)
    }

    /// Depth below the impacted face, m.
    fn depth(&self, x: Vec3) -> f64 {
        0.5 * self.thickness() - self.point[self.struck].signum() * x[self.struck]
    }

    /// Unit vectors radially away from the line of the force, and into the body.
    fn directions(&self, x: Vec3) -> [Vec3; 2] {
        let mut inward = [0.0; 3];
        inward[self.struck] = -self.point[self.struck].signum();
        let radius = self.distance(x);
        let mut radial = [0, 1, 2].map(|axis| (x[axis] - self.point[axis]) / radius);
        radial[self.struck] = 0.0;
        if radius <= 1e-9 * self.thickness() {
            radial = [0.0; 3];
            radial[(self.struck + 1) % 3] = 1.0;
        }
        [radial, inward]
    }
}

/// Layers across an axis, from the impacted face, with the secant moduli at the contact time on a half-space; `None` if all
/// are elastic. `thickness` is their total, m.
fn stack_at_end(scene: &Scene, (axis, thickness): (usize, f64)) -> Option<Stack> {
    let mut layers = scene.body.composition.across(axis, thickness);
    if layers.iter().all(|(_, material)| material.shear.is_none()) {
        return None;
    }
    if scene.impactor.point[axis] < 0.0 {
        layers.reverse();
    }
    let time = scene.impactor.contact_time();
    let layer = |(thickness, material): (f64, crate::material::Material)| Layer::of(thickness, &material.secant(time));
    Stack::new(&layers.into_iter().map(layer).collect::<Vec<_>>())
}

/// Distance from the nearest of the edges, m.
fn nearest(edges: &[f64; 4]) -> f64 {
    edges.iter().copied().fold(f64::INFINITY, f64::min)
}

impl LocalPoint {
    /// Local field of a point, with unit vectors radially away from the line of the force and into the body.
    pub fn new(field: PointField, radial: Vec3, inward: Vec3) -> Self {
        Self { field: Rc::new(field), radial, inward, has_ring: true, lost: [0.0; 6] }
    }

    /// The same without Hertz's own field, whose ring of tension is reported separately.
    #[must_use]
    pub fn without_ring(self) -> Self {
        Self { has_ring: false, ..self }
    }

    /// Coefficients for 1 N of Chebyshev's polynomials of 2 (r_c/largest)² − 1, Pa, up to the largest contact radius
    /// (m) of the field, which is returned first. `None` with the ring, which is not a polynomial.
    pub(super) fn polynomial(&self) -> Option<(f64, Vec<[f64; 6]>)> {
        let coefficients = self.field.smooth_coefficients().map(|field| field.cartesian(self.radial, self.inward));
        let mut coefficients: Vec<[f64; 6]> = coefficients.collect();
        if coefficients.is_empty() {
            coefficients.push([0.0; 6]);
        }
        coefficients[0].iter_mut().zip(self.lost).for_each(|(sum, lost)| *sum += lost);
        (!self.has_ring).then(|| (self.field.largest(), coefficients))
    }

    /// Stresses added by the contact, Pa.
    pub fn stress(&self, contact: &ContactNow) -> [f64; 6] {
        let field = match self.has_ring {
            true => self.field.stress(contact.radius),
            false => self.field.smooth_stress(contact.radius),
        };
        let stress = field.cartesian(self.radial, self.inward);
        std::array::from_fn(|i| contact.force * (stress[i] + self.lost[i]))
    }
}
