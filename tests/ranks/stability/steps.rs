//! Schemes that are not stable for every time step: they fail where theory predicts, and a remedy works with the same
//! time step.

use crate::bricks;
use mpi_test::{Test, tests};
use std::ops::ControlFlow;

use petsc_wrap::{Comm, Session, Vector};
use ricochet::body::{Body, Inertia, LinearContact, Lumped, largest_frequency};
use ricochet::contact::{Hertz, hertz};
use ricochet::description::Description;
use ricochet::element::Shape;
use ricochet::error::Error;
use ricochet::impact::step::Step;
use ricochet::impact::{State, SteppedImpact};
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;
use ricochet::scheme::critical_frequency;

/// On one rank: other tests show that limits and series are the same on several.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    limit_of_the_central_difference,
    contact_lowers_the_limit,
    limit_of_newmark,
    gamma_below_a_half,
    row_sums_of_quadratic_tetrahedra
];

/// Number of time steps of a run: at 1.001 of a limit a vibration's energy grows by e^0.18 in each.
const STEPS: usize = 300;

/// One kind of element, and the bricks into which the block is divided.
#[derive(Debug, Clone, Copy)]
struct Kind {
    shape: Shape,
    order: usize,
    cells: [usize; 3],
}

const KINDS: [Kind; 4] = [
    Kind { shape: Shape::Hexahedron, order: 1, cells: [3, 2, 2] },
    Kind { shape: Shape::Tetrahedron, order: 1, cells: [3, 2, 2] },
    Kind { shape: Shape::Hexahedron, order: 2, cells: [2, 2, 1] },
    Kind { shape: Shape::Tetrahedron, order: 2, cells: [2, 2, 1] },
];

/// Edges of the block, m.
const SIZE: [f64; 3] = [0.3, 0.2, 0.1];

/// A free glass block of one kind of element, with a distant mass, or with a mass in contact (`impactor`).
struct Block {
    kind: Kind,
    impactor: &'static str,
    gate: &'static str,
}

const AFAR: &str = "mass = 1.0\nspeed = 1.0\nstiffness = 1e10\ngap = 1e3";
/// A wide energy gate: just below the limit, the energy of a vibration appears to change a thousandfold within each
/// beat.
const WIDE: &str = "[solver]\nenergy_gate = 1e6\n";

impl Block {
    fn new(kind: Kind) -> Self {
        Self { kind, impactor: AFAR, gate: WIDE }
    }

    fn build(&self, comm: &Comm, step: f64, scheme: &str) -> (Scene, Mesh, Body) {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("body.msh");
        std::fs::write(&file, bricks::bricks(self.kind.shape, SIZE, self.kind.cells, 0.0)).unwrap();
        let text = format!(
            "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nmesh = {file:?}\norder = {}\n\
             [impactor]\nradius = 0.05\n{}\npoint = [0.01, 0.02, 0.05]\n[contact]\nlocalization = \"point\"\n{}\
             [time]\nend = {:e}\nstep = {step:e}\n{scheme}\n",
            self.kind.order,
            self.impactor,
            self.gate,
            STEPS as f64 * step
        );
        let (scene, _) = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}"));
        let mesh = Mesh::new(comm, &scene.body).unwrap();
        let body = Body::solid(&scene, &mesh).unwrap();
        (scene, mesh, body)
    }

    /// Stability limit 2/ω_max (s), or the corresponding limit of other schemes.
    fn limit(&self, comm: &Comm, consistent: bool, critical: f64) -> f64 {
        self.limit_with(comm, consistent, critical, None)
    }

    /// Same as `limit`, with a contact.
    fn limit_with(&self, comm: &Comm, consistent: bool, critical: f64, contact: Option<LinearContact>) -> f64 {
        let (scene, mesh, mut body) = self.build(comm, 1e-6, "");
        let lumped = Lumped::new(&Description::new(&scene), &mesh).unwrap();
        let inertia = if consistent { Inertia::Consistent } else { Inertia::Lumped(&lumped.mass) };
        critical / largest_frequency(&mut body, inertia, contact).unwrap().ritz
    }

    /// Runs the block from a start in which all its modes vibrate; returns its time steps and whether it was stopped.
    fn vibrate(&self, comm: &Comm, step: f64, scheme: &str) -> (Vec<Step>, Result<(), Error>) {
        let (scene, _, body) = self.build(comm, step, scheme);
        let mut impact = SteppedImpact::new(&scene, body).unwrap();
        let zeros = || impact.body().terms.load.duplicate().unwrap();
        let (mut u, v, mut a) = (zeros(), zeros(), zeros());
        shake(&mut u);
        // M ü = −K u. If M is not diagonal, the run starts with ü = 0, which serves as well.
        if let Some(lumped) = &impact.body().lumped {
            impact.body().apply_elastic(&u, &mut a).unwrap();
            let mass = lumped.mass.read().unwrap();
            a.write().unwrap().iter_mut().zip(mass.iter()).for_each(|(a, mass)| *a /= -mass);
        }
        let q = impact.state().q;
        impact.set_state(State { u, v, a, q }).unwrap();
        finish(impact)
    }

    /// The largest time step (s) at which [`Self::vibrate`] reaches its end, by bisection, from an estimate that is
    /// accurate to 5%.
    fn measured_limit(&self, comm: &Comm, estimate: f64, scheme: &str) -> f64 {
        let grows = |step: f64| self.vibrate(comm, step, scheme).1.is_err();
        let (mut holds, mut fails) = (0.95 * estimate, 1.05 * estimate);
        assert!(!grows(holds) && grows(fails), "{:?}", self.kind);
        while fails > holds * 1.002 {
            let middle = 0.5 * (holds + fails);
            if grows(middle) { fails = middle } else { holds = middle }
        }
        0.5 * (holds + fails)
    }
}

/// Sets pseudo-random displacements of up to 1 μm.
fn shake(u: &mut Vector) {
    let mut seed = 1_u64;
    u.write().unwrap().iter_mut().for_each(|u| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *u = 1e-6 * ((seed >> 33) as f64 / f64::from(1_u32 << 30) - 1.0);
    });
}

fn finish(mut impact: SteppedImpact) -> (Vec<Step>, Result<(), Error>) {
    let mut steps = vec![];
    let flow = impact.run(|step| {
        steps.push(*step);
        Ok(ControlFlow::Continue(()))
    });
    (steps, flow.map(|_| ()))
}

const EXPLICIT: &str = "scheme = \"central-difference\"\nallow_unstable = true";

/// Limits of linear and quadratic elements: the quadratic ones have a separate limit because of their positive lumped
/// masses.
fn limit_of_the_central_difference(session: &Session) {
    let world = session.world();
    for kind in KINDS {
        let block = Block::new(kind);
        let limit = block.limit(&world, false, critical_frequency(0.0, 0.5));
        let measured = block.measured_limit(&world, limit, EXPLICIT);
        println!("{:?} {}: 2/ω_max = {limit:.4e} s, measured {:.4} of it", kind.shape, kind.order, measured / limit);
        assert!((measured / limit - 1.0).abs() < 0.02);
        for (part, scheme, fails) in
            [(1.02, EXPLICIT, true), (0.98, EXPLICIT, false), (1.02, "scheme = \"energy\"", false)]
        {
            let ended = block.vibrate(&world, part * limit, scheme).1;
            assert_eq!(ended.is_err(), fails, "{kind:?}, {part}, {scheme}: {ended:?}");
        }
        // A time step above the limit is refused, unless it is forced.
        let (scene, _, body) = block.build(&world, 1.02 * limit, "scheme = \"central-difference\"");
        let Err(Error::Fault(fault)) = SteppedImpact::new(&scene, body) else { panic!("accepted") };
        assert!(fault.key == "time.step" && fault.message.contains("2/ω_max"), "{fault}");
        world.collect_garbage().unwrap();
    }
}

/// A heavy mass on a stiff contact. With a time step between the limits with and without contact, the body gains energy
/// while it is touched, in the few steps until it is thrown off.
fn contact_lowers_the_limit(session: &Session) {
    let world = session.world();
    let (stiffness, mass) = (1e13, 100.0);
    let block = Block {
        impactor: "mass = 100.0\nspeed = 1.0\nstiffness = 1e13",
        gate: "[solver]\nenergy_gate = 1e30\n",
        ..Block::new(KINDS[0])
    };
    let tangent = Hertz { stiffness }.tangent(hertz::peak_indentation(stiffness, mass, 1.0));
    let critical = critical_frequency(0.0, 0.5);
    let apart = block.limit(&world, false, critical);
    let touching = block.limit_with(&world, false, critical, Some(LinearContact { tangent, mass }));
    println!("2/ω_max: {apart:.4e} s apart, {touching:.4e} s in contact");
    assert!(touching < 0.9 * apart);
    let (scene, _, body) = block.build(&world, 0.98 * apart, "scheme = \"central-difference\"");
    assert!(matches!(SteppedImpact::new(&scene, body), Err(Error::Fault(_))), "the limit in contact is the one told");
    // In a stable run the total energy, without the scheme's own term of Δt², oscillates by some 1e-3; for the energy
    // scheme only rounding remains.
    for (step, scheme, range) in [
        (0.98 * apart, EXPLICIT, 0.5..f64::INFINITY),
        (0.98 * touching, EXPLICIT, 0.0..5e-3),
        (0.98 * apart, "scheme = \"energy\"", 0.0..1e-9),
    ] {
        let (scene, _, body) = block.build(&world, step, scheme);
        let (steps, ended) = finish(SteppedImpact::new(&scene, body).unwrap());
        ended.unwrap();
        let touched = steps.iter().filter(|step| step.contact.force > 0.0).count();
        let off = largest_change(&steps);
        println!("{step:.3e} s, {}: {touched} steps in contact, energy off by {off:.2e}", scheme.replace('\n', ", "));
        assert!(touched > 5 && range.contains(&off), "{off:e}");
    }
}

/// Largest change of the total energy, as a fraction of it.
fn largest_change(steps: &[Step]) -> f64 {
    steps.iter().map(|step| (step.energy.total / steps[0].energy.total - 1.0).abs()).fold(0.0, f64::max)
}

/// γ = 1/2 with β = 1/6, and γ = 0.6 with β = 0.2, have a stability limit; β ≥ γ/2 has none.
fn limit_of_newmark(session: &Session) {
    let world = session.world();
    let block = Block::new(KINDS[0]);
    for (beta, gamma, cure) in [(1.0 / 6.0, 0.5, 0.25), (0.2, 0.6, 0.3025)] {
        let scheme = |beta: f64| format!("scheme = \"newmark\"\nbeta = {beta}\ngamma = {gamma}");
        let limit = block.limit(&world, true, critical_frequency(beta, gamma));
        let measured = block.measured_limit(&world, limit, &scheme(beta));
        println!("β = {beta:.4}, γ = {gamma}: Ω_crit/ω_max = {limit:.4e} s, measured {:.4} of it", measured / limit);
        assert!((measured / limit - 1.0).abs() < 0.02);
        for (part, beta, fails) in [(1.02, beta, true), (0.98, beta, false), (1.02, cure, false), (20.0, cure, false)] {
            let ended = block.vibrate(&world, part * limit, &scheme(beta)).1;
            assert_eq!(ended.is_err(), fails, "{beta}, {gamma}, {part}: {ended:?}");
        }
    }
}

/// With γ < 1/2 vibrations grow at every time step, and the energy gate of every run stops it.
fn gamma_below_a_half(session: &Session) {
    let world = session.world();
    let block = Block { gate: "", ..Block::new(KINDS[0]) };
    let period = block.limit(&world, true, 1.0);
    for part in [0.5, 1.0, 4.0] {
        let scheme = |gamma: f64| format!("scheme = \"newmark\"\ngamma = {gamma}");
        let (steps, ended) = block.vibrate(&world, part * period, &scheme(0.45));
        let error = ended.expect_err("γ < 1/2 grows");
        println!("γ = 0.45, ω_max Δt = {part}: {error}");
        assert!(matches!(error, Error::Unstable(_)) && error.status() == 3, "{error:?}");
        let message = error.to_string();
        assert!(message.contains(&format!("step {}, t = ", steps.len())) && message.contains("unstable"), "{message}");
        assert!(steps.len() > 1 && steps.iter().all(|step| step.energy.total.is_finite()));
        let (steps, ended) = block.vibrate(&world, part * period, &scheme(0.5));
        ended.unwrap();
        let off = largest_change(&steps);
        println!("γ = 0.5, ω_max Δt = {part}: energy off by {off:.1e}");
        // The start with ü = 0 is not balanced, which is the only change of energy.
        assert!(off < 0.2, "{off}");
    }
}

/// The row sums of a quadratic tetrahedron's mass matrix are −1/20 of the mass at the vertices and 1/5 at the edges: a
/// mesh lumped like this grows at every time step.
fn row_sums_of_quadratic_tetrahedra(session: &Session) {
    let world = session.world();
    let block = Block::new(KINDS[3]);
    let limit = block.limit(&world, false, critical_frequency(0.0, 0.5));
    for part in [0.95, 0.1] {
        let (scene, _, mut body) = block.build(&world, part * limit, EXPLICIT);
        let mut ones = body.terms.load.duplicate().unwrap();
        ones.fill(1.0).unwrap();
        let mut sums = ones.duplicate().unwrap();
        body.mass.mult(&ones, &mut sums).unwrap();
        let negative = sums.read().unwrap().iter().filter(|mass| **mass < 0.0).count();
        let lumped = body.lumped.as_mut().unwrap();
        assert!(lumped.mass.read().unwrap().iter().all(|mass| *mass > 0.0));
        // The vertices of the mesh have negative row sums.
        let vertices: usize = block.kind.cells.iter().map(|n| n + 1).product();
        println!("{part}: {negative} of {} row sums are negative", sums.len());
        assert_eq!(negative, 3 * vertices);
        lumped.mass.copy_from(&sums).unwrap();
        let mut impact = SteppedImpact::new(&scene, body).unwrap();
        let zeros = || impact.body().terms.load.duplicate().unwrap();
        let (mut u, v, a) = (zeros(), zeros(), zeros());
        shake(&mut u);
        let q = impact.state().q;
        impact.set_state(State { u, v, a, q }).unwrap();
        let (steps, ended) = finish(impact);
        println!("{part}: stopped after {} steps: {ended:?}", steps.len());
        assert!(ended.is_err() && steps.len() < 200, "negative masses");
        block.vibrate(&world, part * limit, EXPLICIT).1.unwrap_or_else(|error| panic!("{error}"));
    }
}
