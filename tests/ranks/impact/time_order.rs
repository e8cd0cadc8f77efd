//! Order of the time integration scheme.

use crate::body::spectrum::dense;
use crate::start::{run, start};
use mpi_test::{Test, tests};
use nalgebra::DVector;
use petsc_wrap::{Session, Vector};
use ricochet::impact::step::Step;
use ricochet::impact::{State, SteppedImpact, TimeIntegration as _};

/// On one rank: the first test needs whole matrices, and other tests show that the series are the same on several
/// ranks.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![free_vibration, order_in_contact];

/// A scene with further lines of `body`, of `impactor` and of `time`, and further tables `rest` (supports and loads).
fn scene(body: &str, rest: &str, impactor: &str, time: &str) -> String {
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsymmetry = \"none\"\n{body}\n{rest}\n\
         [impactor]\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\n{impactor}\n[time]\n{time}\n\
         [contact]\nlocalization = \"point\"\n[solver]\nnewton = \"full\"\n"
    )
}

/// Shape (uᵀMu = 1) and angular frequency of the free body's lowest elastic mode.
fn first_elastic_mode(impact: &SteppedImpact) -> (DVector<f64>, f64) {
    let (mass, stiffness) = (dense(&impact.body().mass), dense(&impact.body().terms.elastic));
    let factor = mass.cholesky().expect("M is positive definite");
    let half = factor.l().solve_lower_triangular(&stiffness).unwrap();
    let reduced = factor.l().solve_lower_triangular(&half.transpose()).unwrap();
    let modes = reduced.symmetric_eigen();
    let mut by_frequency: Vec<usize> = (0..modes.eigenvalues.len()).collect();
    by_frequency.sort_by(|&i, &j| modes.eigenvalues[i].total_cmp(&modes.eigenvalues[j]));
    // The first six are rigid motions.
    let mode = by_frequency[6];
    assert!(modes.eigenvalues[by_frequency[5]].abs() < 1e-9 * modes.eigenvalues[mode]);
    let shape = modes.eigenvectors.column(mode).into_owned();
    let shape = factor.l().transpose().solve_upper_triangular(&shape).unwrap();
    (shape, modes.eigenvalues[mode].sqrt())
}

/// A body that vibrates in its first mode has the displacement cos ωt times its start; the average acceleration method
/// conserves its energy.
fn free_vibration(session: &Session) {
    let comm = session.world();
    let impactor = "mass = 1.0\nspeed = 1.0\ngap = 1e3";
    let text = |time: &str| scene("size = [0.5, 0.4, 0.1]\ncells = [3, 2, 1]\norder = 1", "", impactor, time);
    let (shape, omega) = first_elastic_mode(&start(&comm, &text("end = 1e-3")).1);
    let amplitude = 1e-4 / shape.amax();
    // One and a third periods: neither cos nor its slope is zero.
    let end = 4.0 / 3.0 * std::f64::consts::TAU / omega;
    let error = |steps: u32| {
        let (_, mut impact) = start(&comm, &text(&format!("end = {end:e}\nstep = {:e}", end / f64::from(steps))));
        assert_eq!(impact.steps(), Some(steps as usize));
        let with = |factor: f64| -> Vector {
            let mut vector = impact.body().terms.load.duplicate().unwrap();
            vector.write().unwrap().copy_from_slice((&shape * factor).as_slice());
            vector
        };
        let (u, v, a) = (with(amplitude), with(0.0), with(-omega * omega * amplitude));
        let q = impact.state().q;
        impact.set_state(State { u, v, a, q }).unwrap();
        let series = run(&mut impact);
        let energy = |step: &Step| step.energy.kinetic + step.energy.elastic;
        let initial = energy(&series[0]);
        let drift = series.iter().map(|step| (energy(step) / initial - 1.0).abs()).fold(0.0, f64::max);
        // Newton's residual is below 1e-10 of a force; a linear step has only rounding.
        assert!(drift < 1e-10, "energy changes by {drift:e} in {steps} steps");
        let exact = &shape * (amplitude * (omega * end).cos());
        let u = DVector::from_column_slice(&impact.state().u.read().unwrap());
        (u - exact).amax() / (amplitude * shape.amax())
    };
    let errors = [60, 120, 240].map(error);
    let order = (errors[1] / errors[2]).log2();
    println!("free vibration, {:.0} Hz: errors {errors:?}, order {order:.3}", omega / std::f64::consts::TAU);
    assert!(order >= 1.95, "{errors:?}");
}

/// The impactor's velocity in the middle of a contact is compared with a run whose time step is 16 times smaller.
///
/// F ~ t^{3/2} at the first touch causes an error term Δt^{5/2} in addition to the scheme's Δt². So the order is two,
/// and for a scheme of any order it would stay below 5/2.
fn order_in_contact(session: &Session) {
    let world = session.world();
    let side = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\ndamping = 1e5";
    let impactor = "mass = 5.0\nspeed = 1.0";
    let end = 2e-4;
    let velocity = |steps: u32| {
        let time = format!("end = {end:e}\nstep = {:e}", end / f64::from(steps));
        let (_, mut impact) = start(&world, &scene("size = [0.4, 0.4, 0.1]\ncells = [2, 2, 1]", side, impactor, &time));
        let series = run(&mut impact);
        assert!(series[1..].iter().all(|step| step.contact.force > 0.0), "in contact from the first step on");
        series.last().unwrap().impactor.velocity
    };
    let reference = velocity(3200);
    let errors = [50, 100, 200].map(|steps| (velocity(steps) - reference).abs());
    // The reference's own error, 1/256 of the last one at order two, reduces the observed order by 0.004.
    let order = (errors[1] / errors[2]).log2();
    println!("in contact: velocity {reference:.6}, errors {errors:?}, order {order:.3}");
    assert!(order >= 1.9, "{errors:?}");
}
