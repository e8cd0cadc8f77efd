//! Newton's method at the beginning of contact: without a guard it overshoots the first touch, with a bracket it does
//! not.

use mpi_test::{Test, tests};
use std::ops::ControlFlow;

use crate::start::start;
use petsc_wrap::{Comm, Session, options};
use ricochet::error::Error;
use ricochet::impact::step::Step;

pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![overshoot_across_the_touch];

const SEARCH: &str = "-snes_linesearch_type";

/// Number of time steps of a run.
const STEPS: usize = 4;

/// A stiff contact (N/m^1.5) at 1 m/s, with a time step (s) and a gap (m).
fn scene(newton: &str, stiffness: f64, step: f64, gap: f64) -> String {
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.5, 0.5, 0.02]\ncells = [4, 4, 1]\norder = 1\n\
         symmetry = \"none\"\n[impactor]\nmass = 52.0\nradius = 0.05\nspeed = 1.0\nstiffness = {stiffness:e}\ngap = {gap:e}\n\
         [time]\nend = {:e}\nstep = {step:e}\n[contact]\nlocalization = \"point\"\n\
         [solver]\nnewton = \"{newton}\"\nenergy_gate = 1e9\n",
        STEPS as f64 * step
    )
}

/// The time steps and the iterations of a run, or the error that ended it.
fn solve(comm: &Comm, text: &str) -> (Vec<Step>, usize, Result<(), Error>) {
    let (_, mut impact) = start(comm, text);
    let mut steps = vec![];
    let flow = impact.run(|step| {
        steps.push(*step);
        Ok(ControlFlow::Continue(()))
    });
    let iterations = impact.count.iterations;
    drop(impact);
    comm.collect_garbage().unwrap();
    (steps, iterations, flow.map(|_| ()))
}

/// Close to the first touch the contact's tangent is almost zero, so an unguarded Newton step goes on as if there were
/// no contact. For a contact this stiff, the residual is then so large that PETSc declares divergence (1e4 times the
/// first one).
fn overshoot_across_the_touch(session: &Session) {
    let world = session.world();
    let step = 1e-4;
    for (part, fails) in [(0.5, 2), (1.5, 3)] {
        let text = |newton| scene(newton, 1e16, step, part * step);
        options::set(session, SEARCH, "basic").unwrap();
        let (seen, _, ended) = solve(&world, &text("full"));
        options::clear(session, SEARCH).unwrap();
        let error = ended.expect_err("an unguarded Newton overshoots");
        assert!(matches!(error, Error::Solve(_)) && error.status() == 3, "{error:?}");
        assert_eq!(seen.len(), fails, "the step after the touch");
        assert!(seen[fails - 1].contact.force > 0.0 && error.to_string().contains("DIVERGED_DTOL"), "{error}");
        let (full, guarded, held) = solve(&world, &text("full"));
        held.unwrap_or_else(|error| panic!("{error}"));
        let (condensed, scalar, held) = solve(&world, &text("condensed"));
        held.unwrap_or_else(|error| panic!("{error}"));
        let scale = full.iter().map(|step| step.contact.force).fold(0.0, f64::max);
        let pairs = full.iter().zip(&condensed);
        let difference = pairs.map(|(a, b)| (a.contact.force - b.contact.force).abs() / scale).fold(0.0, f64::max);
        if world.is_root() {
            println!("gap of {part} steps: {error}");
            println!("guarded {guarded} and condensed {scalar} iterations in {STEPS} steps, {difference:.1e} apart");
        }
        // Each time step is solved to 1e-10 of the force on a half-space.
        assert!(full.len() == STEPS + 1 && condensed.len() == STEPS + 1 && difference < 1e-7, "{difference:e}");
        // Some bisections for each of the time steps in contact.
        assert!(guarded <= 15 * STEPS && scalar <= 15 * STEPS, "{guarded}, {scalar}");
    }
}
