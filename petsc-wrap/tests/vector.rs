//! Tests of vectors, on one to three ranks.

use std::process::ExitCode;

use petsc_wrap::{Error, Insert, Session, Vector};

fn start() -> Session {
    Session::start(&[]).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2, 3],
        start,
        &[
            ("algebra_is_that_of_slices", algebra_is_that_of_slices),
            ("products_and_quotients_by_entry", products_and_quotients_by_entry),
            ("many_vectors_at_once", many_vectors_at_once),
            ("entries_reach_their_rank", entries_reach_their_rank),
            ("uneven_and_empty_parts", uneven_and_empty_parts),
            ("an_index_out_of_range_is_an_error", an_index_out_of_range_is_an_error),
            ("layouts_must_agree", layouts_must_agree),
            ("sizes_that_do_not_fit_are_errors", sizes_that_do_not_fit_are_errors),
            ("guards_may_be_forgotten", guards_may_be_forgotten),
        ],
    )
}

/// A vector whose entry i is f(i).
fn filled(session: &Session, local: usize, f: impl Fn(f64) -> f64) -> Vector {
    let mut vector = Vector::new(&session.world(), local).unwrap();
    let begin = vector.range().start;
    for (i, value) in vector.write().unwrap().iter_mut().enumerate() {
        *value = f((begin as usize + i) as f64);
    }
    vector
}

fn algebra_is_that_of_slices(session: &Session) {
    let mut x = filled(session, 4, |i| i);
    let y = filled(session, 4, |i| 1.0 + i);
    let n = x.len() as f64;
    // Small integers: sums are exact.
    let squares = (n - 1.0) * n * (2.0 * n - 1.0) / 6.0;
    assert_eq!(x.dot(&x).unwrap(), squares);
    assert_eq!(x.norm().unwrap(), squares.sqrt());
    assert_eq!(x.norm_max().unwrap(), n - 1.0);
    x.axpy(2.0, &y).unwrap();
    x.aypx(-1.0, &y).unwrap();
    x.scale(3.0).unwrap();
    // 3 (y − (i + 2 y)) with y = i + 1
    let begin = x.range().start;
    for (i, value) in x.read().unwrap().iter().enumerate() {
        let i = (begin as usize + i) as f64;
        assert_eq!(*value, 3.0 * ((i + 1.0) - (i + 2.0 * (i + 1.0))));
    }
    let mut z = x.duplicate().unwrap();
    assert_eq!(z.norm().unwrap(), 0.0);
    z.copy_from(&x).unwrap();
    z.axpy(-1.0, &x).unwrap();
    assert_eq!(z.norm_max().unwrap(), 0.0);
    x.destroy().unwrap();
}

fn products_and_quotients_by_entry(session: &Session) {
    let mut x = filled(session, 4, |i| i);
    let y = filled(session, 4, |i| 8.0 - i);
    let n = x.len() as f64;
    x.pointwise_mult(&y).unwrap();
    let begin = x.range().start;
    let entry = |place: usize| (begin as usize + place) as f64;
    for (place, value) in x.read().unwrap().iter().enumerate() {
        assert_eq!(*value, entry(place) * (8.0 - entry(place)));
    }
    // Products of small integers are divided exactly; entry 8, on three ranks, is 0/0.
    x.pointwise_divide(&y).unwrap();
    for (place, value) in x.read().unwrap().iter().enumerate() {
        assert_eq!(*value, if entry(place) == 8.0 { 0.0 } else { entry(place) });
    }
    assert_eq!(x.norm_max().unwrap(), n - 1.0);
}

fn many_vectors_at_once(session: &Session) {
    let mut x = filled(session, 3, |i| 2.0 - i);
    let others = [filled(session, 3, |i| i), filled(session, 3, |_| 1.0)];
    let expected: Vec<f64> = others.iter().map(|other| x.dot(other).unwrap()).collect();
    let [first, second] = others.each_ref();
    // Small integers: sums are exact.
    assert_eq!(x.dots(&[first, second]).unwrap(), expected);
    assert!(x.dots(&[]).unwrap().is_empty());
    // 2 − i + i − 2
    x.add_combination(&[(1.0, first), (-2.0, second)]).unwrap();
    assert_eq!(x.norm_max().unwrap(), 0.0);
    x.add_combination(&[]).unwrap();
    assert_eq!(x.norm_max().unwrap(), 0.0);
    // What the vector held does not matter, not even infinity.
    for factor in [0.0, 1.0, 3.0] {
        x.fill(f64::INFINITY).unwrap();
        x.set_combination(&[(factor, second), (-1.0, first)]).unwrap();
        x.add_combination(&[(1.0, first)]).unwrap();
        assert!(x.read().unwrap().iter().all(|value| *value == factor));
    }
    x.set_combination(&[]).unwrap();
    assert_eq!(x.norm_max().unwrap(), 0.0);
}

fn entries_reach_their_rank(session: &Session) {
    let world = session.world();
    let mut x = Vector::new(&world, 2).unwrap();
    let n = x.len() as petsc_wrap::Int;
    // Every rank adds 1 to every entry.
    let indices: Vec<petsc_wrap::Int> = (0..n).collect();
    x.set_values(&indices, &vec![1.0; indices.len()], Insert::Add).unwrap();
    x.assemble().unwrap();
    assert!(x.read().unwrap().iter().all(|&value| value == world.size() as f64));
}

fn uneven_and_empty_parts(session: &Session) {
    let world = session.world();
    let x = filled(session, world.rank(), |_| 2.0);
    let total = world.size() * (world.size() - 1) / 2;
    assert_eq!(x.len(), total);
    assert_eq!(x.is_empty(), total == 0);
    assert_eq!(x.read().unwrap().len(), world.rank());
    assert_eq!(x.dot(&x).unwrap(), 4.0 * total as f64);
}

fn layouts_must_agree(session: &Session) {
    let world = session.world();
    let mut y = filled(session, 3, |i| i);
    // Other sizes; on several ranks, the same total size with another distribution; and the same size on this rank
    // alone.
    let moved = if world.is_root() { 3 * world.size() } else { 0 };
    let others = [filled(session, 2, |i| i), filled(session, moved, |i| i), Vector::new(&session.alone(), 3).unwrap()];
    for x in others.iter().filter(|x| world.size() > 1 || x.len() != 3) {
        let outcomes = [
            y.copy_from(x),
            y.axpy(1.0, x),
            y.aypx(1.0, x),
            y.pointwise_mult(x),
            y.pointwise_divide(x),
            y.dot(x).map(drop),
        ];
        assert!(outcomes.iter().all(|outcome| matches!(outcome, Err(Error::Invalid { .. }))), "{outcomes:?}");
    }
    // All vectors of the list are checked, not only the first.
    let fitting = filled(session, 3, |i| i);
    for x in others.into_iter().filter(|x| world.size() > 1 || x.len() != 3) {
        let pair = [fitting.duplicate().unwrap(), x];
        let [first, second] = pair.each_ref();
        let terms = [(1.0, &**first), (1.0, &**second)];
        assert!(matches!(y.dots(&[first, second]), Err(Error::Invalid { .. })));
        assert!(matches!(y.add_combination(&terms), Err(Error::Invalid { .. })));
        assert!(matches!(y.set_combination(&[terms[1], terms[0]]), Err(Error::Invalid { .. })));
    }
    // The refused calls have not changed the vector.
    y.axpy(-1.0, &fitting).unwrap();
    assert_eq!(y.norm_max().unwrap(), 0.0);
}

/// Sizes that do not fit are errors. As a 32-bit PETSc integer, the first would be −1, PETSc's mark for a size that it
/// shall choose.
fn sizes_that_do_not_fit_are_errors(session: &Session) {
    for local in [u32::MAX as usize, usize::MAX] {
        let outcome = Vector::new(&session.alone(), local).map(|vector| vector.len());
        // With 64-bit indices the first size fits, but there is not that much memory.
        assert!(outcome.is_err(), "{outcome:?}");
    }
    let error = Vector::new(&session.alone(), usize::MAX).err().unwrap();
    assert!(matches!(error, Error::TooLarge { number: usize::MAX }), "{error}");
}

/// The vector is unchanged by a guard that is never dropped, and by one that is leaked while another lives. Its norm is
/// the one of what was written through a leaked guard.
fn guards_may_be_forgotten(session: &Session) {
    let mut x = filled(session, 3, |_| 1.0);
    std::mem::forget(x.read().unwrap());
    let (first, second) = (x.read().unwrap(), x.read().unwrap());
    drop(first);
    assert_eq!(second[2], 1.0);
    drop(second);
    assert_eq!(x.norm_max().unwrap(), 1.0);
    Box::leak(Box::new(x.write().unwrap()))[0] = 3.0;
    assert_eq!(x.norm_max().unwrap(), 3.0);
    x.scale(2.0).unwrap();
    assert_eq!(x.norm_max().unwrap(), 6.0);
}

fn an_index_out_of_range_is_an_error(session: &Session) {
    let mut x = filled(session, 2, |i| i);
    for index in [x.len() as petsc_wrap::Int, -1] {
        let error = x.set_values(&[index], &[1.0], Insert::Replace).unwrap_err();
        assert!(error.to_string().contains(&format!("index {index}")), "{error}");
    }
}
