//! What a body's own stresses lack near the hit: the local field under the contact, wherever stresses are read.

use std::cell::{OnceCell, RefCell};
use std::collections::HashMap;
use std::rc::Rc;

use crate::form::{Material, Spread};
use crate::scene::{Contact, Geometry, Impactor, Scene, Vec3, faces};
use crate::stack::{Carrier, Cylindrical, Layer, Layerwise, LocalField, PointField, Pressure, Sections, Stack};

/// Part of the thickness about the hit within which stresses are read as means over a disc.
const SMOOTHED: f64 = 2.0;

/// Thicknesses about the hit within which the local field is added, or contact radii where the contact is wider than the body is thick.
const REACH: f64 = 4.0;

/// Thicknesses between the hit and the nearest edge from which a box is a layer about it.
const LEAST_ROOM: f64 = 1.0;

/// Cells in the radius of the disc of means at least: with as many the mean under a force at rest is good to 0.1%, on the coarsest plates of
/// a tolerance of 1e-2. With four and more the disc is so wide that the plate's own motion within it counts.
const CELLS: f64 = 3.0;

/// Estimated error of a tension under the hit by such a mean: larger than it is at rest, fitted to impacts in which less was below the true
/// error of one solid. With fewer cells, where there is no room for more, it grows by the power of their size that was measured at rest with a
/// coarser quadrature (0.3% with three cells, 1.1% with two).
const OF_MEAN: f64 = 2.5e-3;
const ORDER_OF_MEAN: f64 = 3.2;

/// The same over the square of the disc's radius over that of the body's own disc: the plate's own motion within it. Fitted to plates of
/// which the disc of means is 2 to 2.7 times as wide as their own.
const OF_WIDE_MEAN: f64 = 8e-4;

/// Contact radii over the thickness for which tables are made at least: members of a sweep share them.
const LEAST_TABLE: f64 = 0.4;

/// Largest contact radius over that of the same impact on a half-space.
const WIDEST: f64 = 1.2;

/// How a body carries the contact's force.
#[derive(Debug, Clone, PartialEq)]
pub struct Hit {
    /// The pressure that the body is under.
    pub pressure: Pressure,
    /// What carries it.
    pub body: HitBody,
    /// The longest edge of the cells about the hit, m.
    pub cell: f64,
}

/// What carries the contact's force.
#[derive(Debug, Clone, PartialEq)]
pub enum HitBody {
    /// A body of one layer.
    OneLayer(Sections),
    /// A layerwise plate.
    Layerwise(Layerwise),
    /// A solid of several layers, which resolves them.
    Layers(Stack),
}

impl Hit {
    /// The longest of the cells that hold a point, along the axes of a face, m; `lines` are the ends of the cells along each axis.
    pub fn cell(lines: &[Vec<f64>; 3], struck: usize, point: Vec3) -> f64 {
        let of_axis = |axis: usize| {
            let holds = |ends: &&[f64]| ends[0] <= point[axis] && point[axis] <= ends[1];
            lines[axis].windows(2).filter(holds).map(|ends| ends[1] - ends[0]).fold(0.0, f64::max)
        };
        (0..3).filter(|axis| *axis != struck).map(of_axis).fold(0.0, f64::max)
    }
}

/// How wide the contact is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactSize {
    /// R of Hertz's contact, m: its radius is √(Rα).
    pub curvature: Option<f64>,
    /// A given radius, m.
    pub given: f64,
}

/// The contact at one time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactNow {
    /// F of the whole body, N.
    pub force: f64,
    /// Radius of the contact, m.
    pub radius: f64,
}

/// Distance from the line of the force and depth, by their bits, and whether stresses are read as means.
type Reading = ([u64; 2], bool);

/// The neighbourhood of the hit on a layer.
pub struct NearHit {
    hit: Hit,
    stack: Stack,
    /// The axis across the face that is hit.
    pub struck: usize,
    point: Vec3,
    /// Distance of the hit from the nearest edge, m.
    room: f64,
    largest: f64,
    by_sections: OnceCell<LocalField>,
    as_it_is: OnceCell<LocalField>,
    /// What a mesh has of the field of its patch beyond a wide disc's on a plate: what recovery loses of it.
    patch: OnceCell<LocalField>,
    /// The fields so far: points on both sides of a diagonal have the same.
    fields: RefCell<HashMap<Reading, Rc<PointField>>>,
    /// That of the patch by distance and depth: samples of a mesh are read from several nodes, and have images.
    of_patch: RefCell<HashMap<[u64; 2], Cylindrical>>,
}

/// The local field at one point.
#[derive(Debug, Clone)]
pub struct LocalPoint {
    field: Rc<PointField>,
    /// Unit vectors away from the line of the force, and into the body.
    radial: Vec3,
    inward: Vec3,
    /// Whether Hertz's own field, with its ring of tension, is part of it.
    has_ring: bool,
    /// What recovery loses of the field that the body has, for 1 N, Pa.
    lost: [f64; 6],
}

/// Estimated errors of the tension under the hit by its mean over a disc, over the peak.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ErrorOfMean {
    /// By the cells within the disc.
    pub of_cells: f64,
    /// By its width.
    pub of_width: f64,
}

impl ContactSize {
    /// Of a scene: the patch where one is given, otherwise Hertz's contact of a round impactor, otherwise a point.
    pub fn new(scene: &Scene) -> Self {
        match scene.contact {
            Contact::Patch { radius: Some(given), .. } => Self { curvature: None, given },
            _ => Self { curvature: scene.impactor.radius, given: 0.0 },
        }
    }

    /// The radius at an indentation, m.
    pub fn radius(&self, indentation: f64) -> f64 {
        self.curvature.map_or(self.given, |curvature| (curvature * indentation.max(0.0)).sqrt())
    }

    /// The contact under a force (N) with an indentation, m.
    pub fn now(&self, force: f64, indentation: f64) -> ContactNow {
        ContactNow { force, radius: self.radius(indentation) }
    }

    /// A radius that the contact hardly exceeds, m.
    fn largest(&self, impactor: &Impactor) -> f64 {
        WIDEST * self.radius(impactor.peak_indentation())
    }
}

impl NearHit {
    /// Of a box of one material or of layers that is hit on a face, as on an infinite stack; `None` nearer than its thickness to
    /// an edge.
    pub fn new(scene: &Scene, hit: Hit) -> Option<Self> {
        let struck = scene.struck_axis()?;
        let Geometry::Box { size, .. } = &scene.body.geometry else { return None };
        let stack = match &hit.body {
            HitBody::Layerwise(theory) => theory.stack().clone(),
            HitBody::Layers(stack) => stack.clone(),
            HitBody::OneLayer(_) => {
                let Material { young, poisson, .. } = *scene.body.composition.uniform()?;
                Stack::new(&[Layer { thickness: size[struck], young, poisson }])?
            }
        };
        let point = scene.impactor.point;
        let room = (0..3).filter(|axis| *axis != struck).map(|axis| 0.5 * size[axis] - point[axis].abs());
        let room = room.fold(f64::INFINITY, f64::min);
        if room < LEAST_ROOM * size[struck] * (1.0 - 1e-9) {
            return None;
        }
        Some(Self {
            hit,
            stack,
            struck,
            point,
            room,
            largest: ContactSize::new(scene).largest(&scene.impactor).max(LEAST_TABLE * size[struck]),
            by_sections: OnceCell::new(),
            as_it_is: OnceCell::new(),
            patch: OnceCell::new(),
            fields: RefCell::default(),
            of_patch: RefCell::default(),
        })
    }

    /// Of a mesh of a box under a patch of a radius, m: where the box is a layer about the hit, free below.
    pub fn of_patch_on_mesh(scene: &Scene, radius: f64) -> Option<Self> {
        let body = HitBody::OneLayer(Sections::Solid);
        let near = Self::new(scene, Hit { pressure: Pressure::Hertz { radius }, body, cell: 0.0 })?;
        let is_free = |surface: &str| faces(surface).iter().all(|(axis, _)| *axis != near.struck);
        let is_normal = (scene.impactor.direction[near.struck].abs() - 1.0).abs() < 1e-9;
        (is_normal && scene.supports.iter().all(|support| is_free(&support.surface))).then_some(near)
    }

    /// h, m.
    pub fn thickness(&self) -> f64 {
        self.stack.thickness()
    }

    /// What the extent of the local field goes with: the thickness or, if that is larger, the largest contact radius, m.
    pub fn width(&self) -> f64 {
        self.thickness().max(self.largest)
    }

    /// Radius of the disc of means, m: that of the body's own disc or more where cells are coarse, as far as there is room about the hit.
    pub fn smoothing(&self) -> f64 {
        let disc = self.hit.pressure.radius();
        let disc = if disc > 0.0 { disc } else { 2.0 * self.thickness() };
        disc.max(CELLS * self.hit.cell).min(self.room)
    }

    /// Estimated error of the tension under the hit by how it is read.
    pub fn error_of_mean(&self) -> ErrorOfMean {
        let (own, disc) = (self.hit.pressure.radius(), self.smoothing());
        ErrorOfMean {
            of_cells: OF_MEAN * (CELLS * self.hit.cell / disc).powf(ORDER_OF_MEAN),
            of_width: if own > 0.0 { OF_WIDE_MEAN * (disc / own).powi(2) } else { 0.0 },
        }
    }

    /// The point under the hit on the other face, m.
    pub fn under_hit(&self) -> Vec3 {
        let mut x = self.point;
        x[self.struck] = -x[self.struck];
        x
    }

    /// Distance of a point from the line of the force, m.
    pub fn distance(&self, x: Vec3) -> f64 {
        (0..3).filter(|&axis| axis != self.struck).map(|axis| (x[axis] - self.point[axis]).powi(2)).sum::<f64>().sqrt()
    }

    /// Whether stresses at a point are read as means, for which the disc is within the body.
    pub fn is_smoothed(&self, x: Vec3, half: Vec3) -> bool {
        let disc = self.smoothing() * (1.0 - 1e-9);
        let fits = (0..3).filter(|&axis| axis != self.struck).all(|axis| x[axis].abs() + disc <= half[axis]);
        // (The sum over waves goes as far as those of the loaded layer.)
        let is_wide = disc >= 0.45 * self.stack.layers()[0].thickness;
        fits && is_wide && self.distance(x) <= SMOOTHED * self.thickness()
    }

    /// What a point (m) lacks whose stresses are read as means of the sections', or as they are; `None` far away.
    pub fn at(&self, x: Vec3, is_smoothed: bool) -> Option<LocalPoint> {
        let radius = self.distance(x);
        if radius > REACH * self.width() {
            return None;
        }
        let Hit { pressure, body, .. } = &self.hit;
        let pressure = *pressure;
        // Under a point force the plate's moments have no limit.
        if pressure == Pressure::Point && !is_smoothed && radius < 0.5 * self.thickness() {
            return None;
        }
        let field = if is_smoothed {
            let reach = SMOOTHED * self.thickness();
            let made = || LocalField::within(reach, self.stack.clone(), self.carrier_of_means(), self.largest);
            self.by_sections.get_or_init(made)
        } else {
            self.as_it_is.get_or_init(|| {
                let carrier = match body {
                    HitBody::OneLayer(Sections::Plate { reading }) => Carrier::Plate { pressure, reading: *reading },
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

    /// What the point under the hit on the other face lacks for 1 N at a contact's radius (m) whose stresses are read as means, Pa.
    pub fn lack_under_hit(&self, contact_radius: f64) -> [f64; 6] {
        let field = LocalField::on_axis(self.stack.clone(), self.carrier_of_means(), contact_radius);
        let [radial, inward] = self.directions(self.under_hit());
        field.at(0.0, self.thickness()).stress(contact_radius).cartesian(radial, inward)
    }

    /// How the body carries the force whose stresses are read as means.
    fn carrier_of_means(&self) -> Carrier {
        let pressure = self.hit.pressure;
        let smoothing = Pressure::Spread { spread: Spread::new(0.0), radius: self.smoothing() };
        match &self.hit.body {
            HitBody::OneLayer(body) => Carrier::Sections { pressure, smoothing, body: *body },
            HitBody::Layerwise(theory) => {
                Carrier::Layerwise { pressure, theory: theory.clone(), smoothing: Some(smoothing) }
            }
            HitBody::Layers(_) => Carrier::Sections { pressure, smoothing, body: Sections::Solid },
        }
    }

    /// What a point of a mesh lacks whose stresses are recovered from samples at some places, with their weights: polynomials do not follow
    /// the field of the patch.
    pub fn recovered(&self, x: Vec3, samples: impl Iterator<Item = (Vec3, f64)>) -> Option<LocalPoint> {
        let point = self.at(x, false)?;
        let mut lost = self.of_patch(x);
        for (place, weight) in samples {
            lost.iter_mut().zip(self.of_patch(place)).for_each(|(lost, stress)| *lost -= weight * stress);
        }
        Some(LocalPoint { lost, ..point })
    }

    /// The field of the patch for 1 N less that of a wide disc on a plate, which polynomials follow, Pa.
    fn of_patch(&self, x: Vec3) -> [f64; 6] {
        let field = self.patch.get_or_init(|| {
            let pressure = Pressure::Spread { spread: Spread::new(0.0), radius: 2.0 * self.thickness() };
            let carrier = Carrier::Plate { pressure, reading: 0.0 };
            LocalField::new(self.stack.clone(), carrier, self.hit.pressure.radius())
        });
        let place = [self.distance(x), self.depth(x)];
        let mut known = self.of_patch.borrow_mut();
        let stress = known
            .entry(place.map(f64::to_bits))
            .or_insert_with(|| field.at(place[0], place[1]).stress(self.hit.pressure.radius()));
        let [radial, inward] = self.directions(x);
        stress.cartesian(radial, inward)
    }

    /// Depth below the face that is hit, m.
    fn depth(&self, x: Vec3) -> f64 {
        0.5 * self.thickness() - self.point[self.struck].signum() * x[self.struck]
    }

    /// Unit vectors away from the line of the force, and into the body.
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

impl LocalPoint {
    /// A field along unit vectors away from the line of the force and into the body.
    pub fn new(field: PointField, radial: Vec3, inward: Vec3) -> Self {
        Self { field: Rc::new(field), radial, inward, has_ring: true, lost: [0.0; 6] }
    }

    /// The same without Hertz's own field, whose ring of tension is told by itself.
    #[must_use]
    pub fn without_ring(self) -> Self {
        Self { has_ring: false, ..self }
    }

    /// Without the ring: for 1 N the coefficients of Chebyshev's polynomials of 2 (r_c/largest)² − 1, Pa, up to the largest contact
    /// radius (m) of the field. `None` with the ring, which is no polynomial.
    pub(super) fn polynomial(&self) -> Option<(f64, Vec<[f64; 6]>)> {
        let coefficients = self.field.smooth_coefficients().map(|field| field.cartesian(self.radial, self.inward));
        let mut coefficients: Vec<[f64; 6]> = coefficients.collect();
        if coefficients.is_empty() {
            coefficients.push([0.0; 6]);
        }
        coefficients[0].iter_mut().zip(self.lost).for_each(|(sum, lost)| *sum += lost);
        (!self.has_ring).then(|| (self.field.largest(), coefficients))
    }

    /// The stresses that the contact adds, Pa.
    pub fn stress(&self, contact: &ContactNow) -> [f64; 6] {
        let field = match self.has_ring {
            true => self.field.stress(contact.radius),
            false => self.field.smooth_stress(contact.radius),
        };
        let stress = field.cartesian(self.radial, self.inward);
        std::array::from_fn(|i| contact.force * (stress[i] + self.lost[i]))
    }
}
