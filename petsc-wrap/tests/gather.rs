//! Fetching entries of distributed vectors, and lists of other ranks, on one to three ranks.

use std::process::ExitCode;

use petsc_wrap::{Gather, Int, Session, Vector};

fn start() -> Session {
    Session::start(&[]).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2, 3],
        start,
        &[
            ("entries_of_any_rank_in_any_order", entries_of_any_rank_in_any_order),
            ("nothing_and_too_much", nothing_and_too_much),
            ("lists_of_all_ranks", lists_of_all_ranks),
        ],
    )
}

/// Entry i is 10 i.
fn tens(session: &Session) -> Vector {
    let mut vector = Vector::new(&session.world(), 3).unwrap();
    let begin = vector.range().start;
    for (value, i) in vector.write().unwrap().iter_mut().zip(begin..) {
        *value = 10.0 * i as f64;
    }
    vector
}

fn entries_of_any_rank_in_any_order(session: &Session) {
    let mut vector = tens(session);
    let last = vector.len() as Int - 1;
    let wanted = [last, 0, last, 1];
    let mut gather = Gather::new(&vector, &wanted).unwrap();
    for factor in [1.0, 2.0] {
        let expected = wanted.map(|i| factor * 10.0 * i as f64);
        assert_eq!(*gather.fetch(&vector).unwrap(), expected);
        vector.scale(2.0).unwrap();
    }
}

fn nothing_and_too_much(session: &Session) {
    let vector = tens(session);
    // Only one rank wants something.
    let wanted: &[Int] = if session.world().is_root() { &[2] } else { &[] };
    assert_eq!(Gather::new(&vector, wanted).unwrap().fetch(&vector).unwrap().len(), wanted.len());
    assert!(Gather::new(&vector, &[vector.len() as Int]).is_err());
}

/// Rank r has r numbers.
fn lists_of_all_ranks(session: &Session) {
    let comm = session.world();
    let list = |rank: usize| (0..rank).map(move |i| (10 * rank + i) as f64);
    let mine: Vec<f64> = list(comm.rank()).collect();
    let all: Vec<f64> = (0..comm.size()).flat_map(list).collect();
    assert_eq!(comm.all_gather(&mine), all);
    assert!(comm.all_gather::<Int>(&[]).is_empty());
}
