//! Fetching entries of distributed vectors, and lists of other ranks, on one to three ranks.

use std::process::ExitCode;

use petsc_wrap::{Error, Gather, Int, Session, Vector};

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
            ("another_layout_is_refused_on_all_ranks", another_layout_is_refused_on_all_ranks),
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

/// PETSc would read beyond the end: it does not look at the vector's layout.
fn another_layout_is_refused_on_all_ranks(session: &Session) {
    let vector = tens(session);
    let last = vector.len() as Int - 1;
    let mut gather = Gather::new(&vector, &[last]).unwrap();
    let world = session.world();
    // As many entries in all, but not on each rank; and fewer on rank 0 alone.
    let others = [if world.is_root() { 3 * world.size() } else { 0 }, if world.is_root() { 2 } else { 3 }, 1];
    for local in others {
        let other = Vector::new(&world, local).unwrap();
        let is_same = world.size() == 1 && local == 3;
        let error = gather.fetch(&other).err();
        assert_eq!(error.is_none(), is_same, "{local}: {error:?}");
        assert!(is_same || matches!(error, Some(Error::Invalid { .. })));
    }
    // The ranks of the communicator matter too.
    let alone = Vector::new(&session.alone(), vector.len()).unwrap();
    assert_eq!(gather.fetch(&alone).is_ok(), world.size() == 1);
    assert_eq!(*gather.fetch(&vector).unwrap(), [10.0 * last as f64]);
}

/// Rank r has r numbers.
fn lists_of_all_ranks(session: &Session) {
    let comm = session.world();
    let list = |rank: usize| (0..rank).map(move |i| (10 * rank + i) as f64);
    let mine: Vec<f64> = list(comm.rank()).collect();
    let all: Vec<f64> = (0..comm.size()).flat_map(list).collect();
    assert_eq!(comm.all_gather(&mine), all);
    assert_eq!(comm.gather_to_root(&mine), if comm.is_root() { all } else { Vec::new() });
    for comm in [comm, session.alone()] {
        assert!(comm.all_gather::<Int>(&[]).is_empty() && comm.all_gather::<u8>(&[]).is_empty());
        assert!(comm.gather_to_root::<Int>(&[]).is_empty());
    }
}
