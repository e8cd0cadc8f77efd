//! Tests of fetching entries of distributed vectors, and of lists of other ranks, on one to three ranks.

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

/// A vector whose entry i is 10 i.
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
    // Only one rank fetches an entry.
    let wanted: &[Int] = if session.world().is_root() { &[2] } else { &[] };
    assert_eq!(Gather::new(&vector, wanted).unwrap().fetch(&vector).unwrap().len(), wanted.len());
    assert!(Gather::new(&vector, &[vector.len() as Int]).is_err());
    // All ranks learn of an index that is too large on one.
    let wanted: &[Int] = if session.world().is_root() { &[-1] } else { &[0] };
    assert!(Gather::new(&vector, wanted).is_err());
    assert!(Gather::new(&vector, &[0]).is_ok());
}

/// A vector of another layout is refused on all ranks. PETSc does not check the layout, and would read beyond the end
/// of the vector.
fn another_layout_is_refused_on_all_ranks(session: &Session) {
    let vector = tens(session);
    let last = vector.len() as Int - 1;
    let mut gather = Gather::new(&vector, &[last]).unwrap();
    let world = session.world();
    // The same number of entries in all but another number on each rank; fewer entries on rank 0 only; fewer on all
    // ranks.
    let others = [if world.is_root() { 3 * world.size() } else { 0 }, if world.is_root() { 2 } else { 3 }, 1];
    for local in others {
        let other = Vector::new(&world, local).unwrap();
        let is_same = world.size() == 1 && local == 3;
        let error = gather.fetch(&other).err();
        assert_eq!(error.is_none(), is_same, "{local}: {error:?}");
        assert!(is_same || matches!(error, Some(Error::Invalid { .. })));
    }
    // The ranks of the communicators are compared too.
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
