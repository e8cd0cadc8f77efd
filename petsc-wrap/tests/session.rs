//! Tests of the session, options and errors, on one and two ranks.

use std::process::ExitCode;

use std::sync::atomic::{AtomicBool, Ordering};

use petsc_wrap::{Comm, Error, Ksp, Session, Tolerances, Vector, options, set_default_environment};

/// An environment variable that is set beforehand, and one that is set by default.
const GIVEN: &str = "PETSC_WRAP_TEST_GIVEN";
const DEFAULT: &str = "PETSC_WRAP_TEST_DEFAULT";
static SET_ALONE: AtomicBool = AtomicBool::new(false);

fn start() -> Session {
    set_default_environment(&[(GIVEN, "by the user")]);
    let is_set = set_default_environment(&[(GIVEN, "by the program"), (DEFAULT, "by the program"), ("a=b", "")]);
    SET_ALONE.store(is_set, Ordering::Relaxed);
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
            (
                "the_environment_is_set_where_nobody_else_can_read_it",
                the_environment_is_set_where_nobody_else_can_read_it,
            ),
            ("the_command_line_outlives_the_start", the_command_line_outlives_the_start),
            ("a_session_with_handles_does_not_end", a_session_with_handles_does_not_end),
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
    assert_eq!(options::get(session, "-session_other").unwrap().as_deref(), Some("9"));
    options::clear(session, "-session_other").unwrap();
    assert!(!options::is_set(session, "-session_other").unwrap());
    // PETSc stores the positions of the numbers in a name in an array of sixteen.
    let name = format!("-a{}_", "_1".repeat(40));
    assert!(matches!(options::get(session, &name), Err(Error::Invalid { .. })));
    assert!(matches!(options::is_set(session, &"-a".repeat(1000)), Err(Error::Invalid { .. })));
    let mut solver = Ksp::new(&session.alone()).unwrap();
    assert!(matches!(solver.set_options_prefix(&name[1..]), Err(Error::Invalid { .. })));
}

fn errors_carry_message_frames_and_place(session: &Session) {
    let mut solver = Ksp::new(&session.world()).unwrap();
    let error = solver.set_tolerances(Tolerances { relative: Some(-0.5), ..Default::default() }).unwrap_err();
    assert!(error.to_string().contains("ksp.rs"), "{error}");
    let Error::Petsc { code, message, frames, .. } = error else { panic!("{error:?}") };
    assert_ne!(code, 0);
    assert!(message.contains("-0.5"), "{message}");
    assert!(frames.iter().any(|frame| frame.function.starts_with("KSPSetTolerances")), "{frames:?}");
    assert!(frames.iter().all(|frame| frame.line > 0));
    // The next error does not contain the frames of this one.
    let error = solver.set_options_prefix("-x_").unwrap_err();
    let Error::Petsc { frames: again, .. } = error else { panic!() };
    assert!(again.iter().all(|frame| !frame.function.starts_with("KSPSetTolerances")), "{again:?}");
}

/// Before MPI and PETSc start, this process has one thread and the environment is set. With a second thread it is left
/// unchanged.
fn the_environment_is_set_where_nobody_else_can_read_it(session: &Session) {
    assert!(session.world().size() > 0);
    assert!(SET_ALONE.load(Ordering::Relaxed), "one thread, before the session");
    assert_eq!(std::env::var(GIVEN).as_deref(), Ok("by the user"));
    assert_eq!(std::env::var(DEFAULT).as_deref(), Ok("by the program"));
    let other = std::thread::spawn(std::thread::park);
    assert!(!set_default_environment(&[("PETSC_WRAP_TEST_LATE", "1")]));
    assert!(std::env::var_os("PETSC_WRAP_TEST_LATE").is_none());
    other.thread().unpark();
    other.join().unwrap();
}

/// PETSc keeps the strings of its command line, and reads them again when it is asked for the command line.
fn the_command_line_outlives_the_start(session: &Session) {
    assert!(session.world().size() > 0);
    let (mut count, mut words) = (0, std::ptr::null_mut());
    // SAFETY: PETSc is initialised, and the session keeps the strings.
    unsafe { petsc_wrap::sys::PetscGetArgs(&raw mut count, &raw mut words) };
    // SAFETY: there are `count` strings.
    let words = (0..count as usize).map(|i| unsafe { std::ffi::CStr::from_ptr(*words.add(i)) });
    let words: Vec<&str> = words.map(|word| word.to_str().unwrap()).collect();
    assert_eq!(words[3..], ["-session_test", "7"]);
    assert_eq!(words[0], std::env::args().next().unwrap());
}

fn a_session_with_handles_does_not_end(session: &Session) {
    let vector = Vector::new(&session.world(), 1).unwrap();
    let error = session.clone().finish().unwrap_err();
    assert!(error.to_string().contains("outlive"), "{error}");
    assert_eq!(vector.len(), session.world().size());
}

fn a_handle_dropped_on_one_rank_blocks_nobody(session: &Session) {
    let world: Comm = session.world();
    let mut kept = Some(Vector::new(&world, 3).unwrap());
    if world.is_root() {
        kept = None;
    }
    // Collective calls work while rank 0's handle is queued.
    assert_eq!(Vector::new(&world, 1).unwrap().len(), world.size());
    drop(kept);
    world.collect_garbage().unwrap();
}
