//! Conserved quantities of the motion: momentum, and energy without contact.

use crate::bricks;
use crate::field;
use mpi_test::{Test, tests};

use crate::start::{run, start};
use nalgebra::Vector3;
use petsc_wrap::{Session, Vector};
use ricochet::element::Shape;
use ricochet::impact::SteppedImpact;
use ricochet::impact::step::Step;

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![momentum, balance_of_energy];

/// A scene with further lines of `body`, of `impactor` and of `time`, and further tables `rest` (supports and loads).
fn scene(body: &str, rest: &str, impactor: &str, time: &str) -> String {
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsymmetry = \"none\"\n{body}\n{rest}\n\
         [impactor]\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\n{impactor}\n[time]\n{time}\n\
         [contact]\nlocalization = \"point\"\n[solver]\nnewton = \"full\"\n"
    )
}

/// Linear and angular momentum of body and impactor, along and about the axes. `rigid` are the six rigid motions;
/// `along` is the impactor's part, d and x × d.
fn momenta(impact: &SteppedImpact, rigid: &[Vector], mass: f64, along: [f64; 6]) -> [f64; 6] {
    let state = impact.state();
    let mut product = state.v.duplicate().unwrap();
    impact.body().mass.mult(&state.v, &mut product).unwrap();
    std::array::from_fn(|i| rigid[i].dot(&product).unwrap() + mass * state.q.velocity * along[i])
}

/// On a free body the impact exchanges momentum and conserves its sum, also about a fixed point: K has no energy for
/// rigid motions, and the localisation vector a is the same for force and displacement.
fn momentum(session: &Session) {
    let world = session.world();
    let folder = tempfile::tempdir().unwrap();
    for (shape, order) in
        [(Shape::Hexahedron, 1), (Shape::Hexahedron, 2), (Shape::Tetrahedron, 1), (Shape::Tetrahedron, 2)]
    {
        let path = folder.path().join("body.msh");
        std::fs::write(&path, bricks::bricks(shape, [0.4, 0.3, 0.1], [4, 3, 2], 0.15)).unwrap();
        let body = format!("mesh = {path:?}\norder = {order}");
        // Off the centre, between nodes and oblique, so that nothing is zero because of symmetry.
        let (point, direction) = ([0.063, 0.041, 0.05], [0.48, -0.36, -0.8]);
        let impactor = format!("mass = 2.0\nspeed = 1.0\npoint = {point:?}\ndirection = {direction:?}");
        let (mesh, mut impact) = start(&world, &scene(&body, "", &impactor, "end = 1e-3\nstep = 5e-6"));
        let rigid: Vec<Vector> = (0..6)
            .map(|i| {
                let axis = Vector3::ith(i % 3, 1.0);
                let mut field = impact.state().u.duplicate().unwrap();
                field::interpolate(&mesh, &mut field, |x| {
                    if i < 3 { axis.into() } else { axis.cross(&Vector3::from(x)).into() }
                });
                field
            })
            .collect();
        let d = Vector3::from(direction);
        let arm = Vector3::from(point).cross(&d);
        let along = [d.x, d.y, d.z, arm.x, arm.y, arm.z];
        let before = momenta(&impact, &rigid, 2.0, along);
        let series = run(&mut impact);
        let after = momenta(&impact, &rigid, 2.0, along);
        let scale = before.iter().fold(0.0, |max: f64, value| max.max(value.abs()));
        let error = before.iter().zip(after).fold(0.0, |max: f64, (b, a)| max.max((b - a).abs())) / scale;
        let last = series.last().unwrap();
        if world.is_root() {
            println!(
                "{shape:?} of order {order}: momentum changes by {error:.1e}, velocity from 1 to {:.3}",
                last.impactor.velocity
            );
        }
        assert!(last.contact.force == 0.0 && last.impactor.velocity < 0.5, "there was an impact, and it is over");
        // Rounding of K u in 200 time steps. A residual of 1e-10 of the peak force in each step would have as small an
        // effect.
        assert!(error < 1e-11, "{shape:?} of order {order}: {before:?} {after:?}");
    }
}

/// Without contact the average acceleration method balances energy to rounding: total + dissipated − external is
/// constant for all supports and loads.
fn balance_of_energy(session: &Session) {
    let world = session.world();
    let elastic = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [1e9, 2e9, 3e9]\n\
                   damping = [3e4, 2e4, 1e4]\ndisplacement = [1e-4, -2e-4, 3e-4]\n";
    let clamped = "[[support]]\nsurface = \"x-min\"\nkind = \"clamped\"\ndisplacement = [2e-5, 0.0, -1e-5]\n";
    let loads =
        "[load]\nbody_force = [4e6, -8e6, 1e7]\n[[load.traction]]\nsurface = \"top\"\nvalue = [4e5, 2e5, -8e5]\n";
    let dampers = "[[support]]\nsurface = \"bottom\"\nkind = \"elastic\"\nstiffness = 0.0\ndamping = 2e4\n";
    for (name, rest) in [
        ("elastic support with damper, loads", format!("{elastic}{loads}")),
        ("clamped, damper, loads", format!("{clamped}{dampers}{loads}")),
        ("elastic and clamped, dampers, loads", format!("{elastic}{clamped}{dampers}{loads}")),
    ] {
        for order in [1, 2] {
            let body = format!("size = [0.4, 0.4, 0.1]\ncells = [3, 3, 2]\norder = {order}");
            // A speed that adds almost nothing to the energy.
            let impactor = "mass = 1.0\nspeed = 1e-3\ngap = 1.0";
            let (_, mut impact) = start(&world, &scene(&body, &rest, impactor, "end = 2e-3\nstep = 1e-5"));
            let series = run(&mut impact);
            let balance = |step: &Step| step.energy.total + step.energy.dissipated - step.energy.external;
            let first = &series[0];
            let drift = series.iter().map(|step| (balance(step) - balance(first)).abs()).fold(0.0, f64::max);
            let drift = drift / first.energy.total;
            let external = series.iter().map(|step| step.energy.external.abs()).fold(0.0, f64::max);
            let last = series.last().unwrap().energy;
            if world.is_root() {
                println!(
                    "{name}, order {order}: balance {drift:.1e}; initial {:.3e} J, dissipated {:.3e} J, external {:.3e} J",
                    first.energy.total, last.dissipated, external
                );
            }
            assert!(series.iter().all(|step| step.contact.force == 0.0), "{name}");
            let least = 1e-2 * first.energy.total;
            assert!(last.dissipated > least && external > least, "{name}: all terms count");
            // Rounding in 200 time steps of sums whose parts are some ten times the total.
            assert!(drift < 1e-10, "{name}, order {order}: {drift:e}");
        }
    }
}
