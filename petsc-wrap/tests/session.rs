//! Session, options and errors, on one and two ranks.

use std::process::ExitCode;

use petsc_wrap::{Comm, Error, Session, Vector, options};

fn start() -> Session {
    let words = ["-session_test", "7"].map(String::from);
    Session::start(&words).expect("the first session").expect("PETSc starts")
}

fn main() -> ExitCode {
    mpi_test::run(
        &[1, 2],
        start,
        &[
            ("there_is_one_session", there_is_one_session),
            ("options_reach_the_database", options_reach_the_database),
            ("options_are_set_and_cleared", options_are_set_and_cleared),
            ("errors_carry_message_frames_and_place", errors_carry_message_frames_and_place),
            ("a_handle_dropped_on_one_rank_blocks_nobody", a_handle_dropped_on_one_rank_blocks_nobody),
        ],
    )
}

fn there_is_one_session(session: &Session) {
    assert!(Session::start(&[]).is_none());
    let world = session.world();
    assert_eq!(world.is_root(), world.rank() == 0);
    assert_eq!(session.alone().size(), 1);
}

fn options_reach_the_database(session: &Session) {
    assert!(options::all(session).unwrap().contains("-session_test 7"));
    assert!(options::unused(session).unwrap().contains(&"session_test".to_owned()));
}

fn options_are_set_and_cleared(session: &Session) {
    assert!(!options::is_set(session, "-session_other").unwrap());
    options::set(session, "-session_other", "8").unwrap();
    options::set(session, "-session_other", "9").unwrap();
    assert!(options::is_set(session, "-session_other").unwrap());
    assert!(options::all(session).unwrap().contains("-session_other 9"));
    options::clear(session, "-session_other").unwrap();
    assert!(!options::is_set(session, "-session_other").unwrap());
}

fn errors_carry_message_frames_and_place(session: &Session) {
    let world = session.world();
    let two = Vector::new(&world, 2).unwrap();
    let mut three = Vector::new(&world, 3).unwrap();
    let error = three.axpy(1.0, &two).unwrap_err();
    assert!(error.to_string().contains("vector.rs"), "{error}");
    let Error::Petsc { code, message, frames, .. } = error else { panic!("{error:?}") };
    assert_ne!(code, 0);
    assert!(message.contains(&three.len().to_string()), "{message}");
    assert!(frames.iter().any(|frame| frame.function.starts_with("VecAXPY")), "{frames:?}");
    assert!(frames.iter().all(|frame| frame.line > 0));
    // The next error does not inherit the frames of this one.
    let Error::Petsc { frames: again, .. } = three.copy_from(&two).unwrap_err() else { panic!() };
    assert!(again.iter().all(|frame| !frame.function.starts_with("VecAXPY")), "{again:?}");
}

fn a_handle_dropped_on_one_rank_blocks_nobody(session: &Session) {
    let world: Comm = session.world();
    let mut kept = Some(Vector::new(&world, 3).unwrap());
    if world.is_root() {
        kept = None;
    }
    // Collective work goes on while rank 0's handle is queued.
    assert_eq!(Vector::new(&world, 1).unwrap().len(), world.size());
    drop(kept);
    world.collect_garbage().unwrap();
}
