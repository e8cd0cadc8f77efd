//! Whether theories, bases and auto are as good as they promise, on the paper's plates and four stiffnesses of their supports.

use crate::glass::{plate, sides};
use crate::modelled::{Ran, run};
use mpi_test::{Test, tests};
use petsc_wrap::{Comm, Session};

/// On one rank: all have the same of what is here.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![first_contacts_are_within_their_tolerance];
pub const LONG: &[Test<Session>] = tests![first_contacts_on_more_supports];

/// A plate a little beyond its first contact.
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

/// The reference is a solid that is itself within 2e-3 (docs/costs.md), a part of what is found here.
fn check_tolerances(session: &Session, stiffnesses: &[f64]) {
    let comm = session.world();
    for (size, end) in [("[1.5, 1.5, 0.1]", 2e-3), ("[1.5, 1.5, 0.04]", 3.2e-3), ("[0.5, 0.5, 0.02]", 6e-3)] {
        for &stiffness in stiffnesses {
            let scene = (size, stiffness, end);
            let reference = of(&comm, scene, "solid", 2e-3);
            assert!(!reference.contacts.is_empty() && reference.contacts[0].end < end);
            // At the steps of the other: between large ones a straight line is off by more than they are.
            let off = |model: &str, tolerance: f64| {
                let ran = of(&comm, scene, model, tolerance);
                let (error, _) = ran.difference(&reference);
                println!("  {size} k = {stiffness:e}: {model} {tolerance:e}: {error:.1e}, {} unknowns", ran.unknowns);
                assert!(error < tolerance, "{size} {stiffness:e} {model} {tolerance:e}: {error:e}");
                error
            };
            off("solid", 1e-2);
            let mindlin = off("mindlin", 1e-2);
            // Mindlin's plates of other makers are off by one or two per cent; half of the tolerance is the cells'.
            assert!(mindlin < 0.6e-2, "{mindlin:e}");
            off("auto", 1e-1);
            off("auto", 1e-2);
            comm.collect_garbage().unwrap();
        }
    }
}
