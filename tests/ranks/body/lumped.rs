//! Lumped mass: its sums, the frequencies of the body with it, and the stable time step of the central difference
//! method.

use crate::parts::{DENSITY, FREE, HELD, KINDS, Kind, MASS, ON_PAD, POISSON, Parts, SIDEWAYS, SIZE, YOUNG};
use crate::parts::{largest, parts, peak_contact};
use mpi_test::{Test, tests};
use petsc_wrap::{Session, Vector};
use ricochet::body::{LinearContact, Lumped};
use ricochet::scheme::{CentralDifference, critical_frequency};
use ricochet::solve::linear::{Method, solver};

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![lumped_sums, lowest_frequency_converges];
/// Tests on one rank: the time step is the same on every number of ranks.
pub const ALONE: &[Test<Session>] = tests![measured_limit];

/// Lumped masses are positive, and each component sums to ρV; the dampers sum to c times the area.
fn lumped_sums(session: &Session) {
    for kind in KINDS {
        let Parts { lumped, .. } = parts(&session.world(), kind, SIZE, 0.15, ON_PAD);
        let damping = lumped.damping.as_ref().unwrap();
        assert!(lumped.mass.read().unwrap().iter().all(|mass| *mass > 0.0), "{kind:?}");
        assert!(damping.read().unwrap().iter().all(|damping| *damping >= 0.0), "{kind:?}");
        let volume: f64 = SIZE.iter().product();
        let side = 2.0 * (SIZE[0] + SIZE[1]) * SIZE[2];
        let mut ones = lumped.mass.duplicate().unwrap();
        for (component, c) in [1e5, 0.0, 2e6].into_iter().enumerate() {
            let first = ones.range().start as usize;
            for (i, value) in ones.write().unwrap().iter_mut().enumerate() {
                *value = f64::from(u8::from((first + i) % 3 == component));
            }
            // Rounding of some hundred terms.
            let mass = lumped.mass.dot(&ones).unwrap() / (DENSITY * volume);
            assert!((mass - 1.0).abs() < 1e-13, "{kind:?}: {mass}");
            let all = damping.dot(&ones).unwrap();
            assert!((all - c * side).abs() <= 1e-13 * c * side, "{kind:?}: {all}");
        }
    }
}

/// Finds by bisection the largest Δt at which the central difference method does not grow from a random start.
fn measured_limit(session: &Session) {
    for kind in KINDS {
        for (supports, touching) in [(HELD, false), (ON_PAD, false), (FREE, true)] {
            let mut parts = parts(&session.alone(), kind, SIZE, 0.15, supports);
            let contact =
                touching.then(|| LinearContact { tangent: 1e3 * peak_contact(&parts.scene).tangent, mass: MASS });
            let found = largest(&mut parts, false, contact);
            let critical = critical_frequency(0.0, 0.5);
            let (mut holds, mut fails) = (0.9 * critical / found.ritz, 1.1 * critical / found.ritz);
            let mut vibration = Vibration::new(&mut parts, contact);
            assert!(!vibration.grows(holds) && vibration.grows(fails), "{kind:?}, {supports:?}");
            while fails > holds * (1.0 + 1e-4) {
                let middle = 0.5 * (holds + fails);
                if vibration.grows(middle) { fails = middle } else { holds = middle }
            }
            let limit = 0.5 * (holds + fails);
            println!(
                "{:?} {}, {}: limit {limit:.5e} s, {:.5} of 2/Ritz, {:.5} of 2/bound",
                kind.shape,
                kind.order,
                if touching {
                    "in contact"
                } else if supports == HELD {
                    "held"
                } else {
                    "on a pad, damped"
                },
                limit * found.ritz / critical,
                limit * found.bound / critical
            );
            // The width of the bisection, and the Ritz value, which is too low by less than 1e-3.
            assert!(limit > critical / found.bound * (1.0 - 1e-4));
            assert!((limit * found.ritz / critical - 1.0).abs() < 1e-3);
            if touching {
                let apart = largest(&mut parts, false, None);
                assert!(limit < 0.99 * critical / apart.bound, "the limit in contact is below that without");
            }
        }
    }
}

/// A body on one rank that vibrates freely, with pads pressed and the impactor attached by a linear spring.
struct Vibration<'a> {
    parts: &'a mut Parts,
    contact: Option<LinearContact>,
    u: Vector,
    force: Vector,
    product: Vector,
}

impl<'a> Vibration<'a> {
    const STEPS: usize = 2000;

    fn new(parts: &'a mut Parts, contact: Option<LinearContact>) -> Self {
        let [u, force, product] = [(); 3].map(|()| parts.body.terms.load.duplicate().unwrap());
        Self { parts, contact, u, force, product }
    }

    /// Computes −K u, and returns the impactor's force.
    fn forces(&mut self, q: f64) -> f64 {
        let body = &mut self.parts.body;
        body.terms.elastic.mult(&self.u, &mut self.force).unwrap();
        if let Some(support) = &body.terms.support {
            support.mult(&self.u, &mut self.product).unwrap();
            self.force.axpy(1.0, &self.product).unwrap();
        }
        if let Some(pads) = &mut body.pads {
            pads.add_pressed(&self.u, &mut self.force).unwrap();
        }
        let a = &body.terms.contact.force;
        let contact = self.contact.map_or(0.0, |contact| contact.tangent * (q - a.dot(&self.u).unwrap()));
        self.force.axpy(-contact, a).unwrap();
        self.force.scale(-1.0).unwrap();
        body.clamps.zero(&mut self.force).unwrap();
        -contact
    }

    /// Whether |u| grows to a million times its initial value. The body starts at rest with random u. Just below the
    /// limit |u| grows at most to a hundred times, and 1e-5 above the limit to e^18.
    fn grows(&mut self, step: f64) -> bool {
        let scheme = CentralDifference { step };
        let n = self.u.len();
        let (mut v, mut a) = (vec![0.0; n], vec![0.0; n]);
        let (mut q, mut q_v, mut q_a) = (0.0, 0.0, 0.0);
        let mut seed = 1_u64;
        self.u.write().unwrap().iter_mut().for_each(|u| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *u = (seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0;
        });
        self.parts.body.clamps.zero(&mut self.u).unwrap();
        let initial = self.u.norm().unwrap();
        for number in 0..=Self::STEPS {
            // The first pass computes the initial accelerations.
            if number > 0 {
                for ((u, v), a) in self.u.write().unwrap().iter_mut().zip(&mut v).zip(&a) {
                    (*u, *v) = scheme.predict(*u, *v, *a);
                }
                (q, q_v) = scheme.predict(q, q_v, q_a);
            }
            let on_impactor = self.forces(q);
            let scheme = CentralDifference { step: if number > 0 { step } else { 0.0 } };
            let Lumped { mass, damping } = &self.parts.lumped;
            let (force, mass) = (self.force.read().unwrap(), mass.read().unwrap());
            let damping = damping.as_ref().map(|damping| damping.read().unwrap());
            for i in 0..n {
                let c = damping.as_ref().map_or(0.0, |damping| damping[i]);
                (v[i], a[i]) = scheme.correct(v[i], force[i], mass[i], c);
            }
            if let Some(contact) = self.contact {
                (q_v, q_a) = scheme.correct(q_v, on_impactor, contact.mass, 0.0);
            }
            drop(force);
            if self.u.norm().unwrap() > 1e6 * initial {
                return true;
            }
        }
        false
    }
}

/// A column that moves along its length only: its sides are clamped sideways, the bottom along the length, and the top
/// is free. Its lowest frequency is c_p π/(2L), c_p² = (λ + 2μ)/ρ.
///
/// With lumped mass it converges with order two, and on hexahedra of order 2 with order four, distorted or not.
fn lowest_frequency_converges(session: &Session) {
    let supports =
        SIDEWAYS.to_owned() + "[[support]]\nsurface = \"bottom\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n";
    let size = [0.1, 0.1, 0.3];
    let modulus = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    let exact = (modulus / DENSITY).sqrt() * std::f64::consts::PI / (2.0 * size[2]);
    for (kind, expected) in KINDS.into_iter().zip([2.0, 4.0, 2.0, 2.0]) {
        for distortion in [0.0, 0.15] {
            let errors = [2, 4].map(|n| {
                let n = if kind.order == 1 { 2 * n } else { n };
                let parts = parts(&session.world(), Kind { cells: [n, n, 3 * n], ..kind }, size, distortion, &supports);
                let found = lowest_frequency(&parts);
                drop(parts);
                session.world().collect_garbage().unwrap();
                (found / exact - 1.0).abs()
            });
            let order = (errors[0] / errors[1]).log2();
            if session.world().is_root() {
                let [one, two] = errors;
                println!("{:?} {}, moved {distortion}: {one:.2e}, {two:.2e}, order {order:.2}", kind.shape, kind.order);
            }
            // Undistorted meshes are so fine that the next term changes the order by 0.05 or less. Distorted meshes are
            // not refinements of each other, so their cells differ at random.
            let least = expected - if distortion == 0.0 { 0.05 } else { 0.1 };
            assert!(order > least && errors[1] < 6e-4, "{kind:?}, {distortion}: {errors:?}");
        }
    }
}

/// ω_min of K x = ω² M x with lumped mass, by inverse iteration. Collective.
fn lowest_frequency(Parts { body, lumped, .. }: &Parts) -> f64 {
    let mut stiffness = body.combination(0.0, 0.0).unwrap();
    stiffness.zero_rows_columns(&body.clamps.rows, 1.0).unwrap();
    stiffness.declare_positive_definite().unwrap();
    let mut solver = solver(body.comm(), "", &stiffness, Method::Cholesky).unwrap();
    let mut x = body.clamps.free.duplicate().unwrap();
    x.copy_from(&body.clamps.free).unwrap();
    let mut momentum = x.duplicate().unwrap();
    let mut square = 0.0;
    // The next such mode has nine times the eigenvalue: its part decreases by a factor of 9⁻¹².
    for _ in 0..12 {
        momentum.copy_from(&x).unwrap();
        momentum.pointwise_mult(&lumped.mass).unwrap();
        solver.solve(&momentum, &mut x).unwrap();
        let work = x.dot(&momentum).unwrap();
        momentum.copy_from(&x).unwrap();
        momentum.pointwise_mult(&lumped.mass).unwrap();
        let length = x.dot(&momentum).unwrap();
        square = work / length;
        x.scale(1.0 / length.sqrt()).unwrap();
    }
    square.sqrt()
}
