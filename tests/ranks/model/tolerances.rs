//! Checks that theories, bases and `auto` meet their tolerances, on the paper's plates with four stiffnesses of their
//! supports.

use crate::glass::{plate, sides};
use crate::modelled::{Ran, run};
use mpi_test::{Test, tests};
use petsc_wrap::{Comm, Session};

/// On one rank: the computation is the same on all ranks.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![first_contacts_are_within_their_tolerance];
pub const LONG: &[Test<Session>] = tests![first_contacts_on_more_supports];

/// Runs a plate until shortly after its first contact.
fn of(comm: &Comm, (size, stiffness, end): (&str, f64, f64), model: &str, tolerance: f64) -> Ran {
    let body = format!("model = \"{model}\"\nsize = {size}");
    let rest = format!("[accuracy]\ntolerance = {tolerance:e}\n{}", sides(stiffness, 0.0));
    run(comm, &plate(&body, &format!("end = {end:e}"), &rest))
}

fn first_contacts_are_within_their_tolerance(session: &Session) {
    check_tolerances(session, &[1e9]);
}

fn first_contacts_on_more_supports(session: &Session) {
    check_tolerances(session, &[0.0, 1e8, 1e10]);
}

/// The reference is a solid whose own error is within 2e-3 (docs/costs.md), a fraction of the errors checked here.
fn check_tolerances(session: &Session, stiffnesses: &[f64]) {
    let comm = session.world();
    for (size, end) in [("[1.5, 1.5, 0.1]", 2e-3), ("[1.5, 1.5, 0.04]", 3.2e-3), ("[0.5, 0.5, 0.02]", 6e-3)] {
        for &stiffness in stiffnesses {
            let scene = (size, stiffness, end);
            let reference = of(&comm, scene, "solid", 2e-3);
            assert!(!reference.contacts.is_empty() && reference.contacts[0].end < end);
            // The comparison is at the time steps of the other run: between large time steps, linear interpolation has
            // a larger error than the steps.
            let off = |model: &str, tolerance: f64| {
                let ran = of(&comm, scene, model, tolerance);
                let (error, _) = ran.difference(&reference);
                println!("  {size} k = {stiffness:e}: {model} {tolerance:e}: {error:.1e}, {} unknowns", ran.unknowns);
                assert!(error < tolerance, "{size} {stiffness:e} {model} {tolerance:e}: {error:e}");
                error
            };
            off("solid", 1e-2);
            let mindlin = off("mindlin", 1e-2);
            // Mindlin's theory itself has an error of one or two per cent in other codes; half of the tolerance is for
            // the cells.
            assert!(mindlin < 0.6e-2, "{mindlin:e}");
            off("auto", 1e-1);
            off("auto", 1e-2);
            comm.collect_garbage().unwrap();
        }
    }
}
