//! Tests of runs that end early: by a kill, a signal, a failure of the solver, or a full disk.

use crate::results;
use mpi_test::{PlainTest, tests};
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::program::{BOX, LIMIT, Outcome, Started, children, ricochet, run, send, start, wait_for_writes};
use crate::results::{column, folder, good, is_complete, long, words};
use tempfile::TempDir;

pub const TESTS: &[PlainTest] = tests![
    a_killed_run_leaves_a_readable_prefix,
    sigterm_ends_a_run_in_order,
    sigint_ends_a_run_in_order_and_progress_is_sparse,
    sigterm_ends_a_run_in_modal_coordinates,
    a_signal_ends_the_making_of_a_model,
    a_signal_to_one_rank_interrupts_all,
    a_killed_rank_ends_all,
    a_solver_that_fails_says_where_and_the_rows_so_far_are_kept,
    a_removed_folder_ends_a_run,
    a_checkpoint_without_room_costs_nothing,
    a_full_disk_costs_no_older_result,
    a_full_disk_is_told_in_one_line
];

/// Starts a long run and waits for its first row.
fn begun(folder: &TempDir, ranks: usize) -> Started {
    let started = start(ricochet(folder.path(), ranks).args(words("run scene.toml -o out.h5")));
    let begin = Instant::now();
    while !folder.path().join("out.h5").exists() {
        assert!(begin.elapsed() < LIMIT, "no first row");
        std::thread::sleep(Duration::from_millis(5));
    }
    started
}

/// Checks that the rows of a run that was ended are the first rows of the whole run.
fn check_prefix(path: &Path) -> usize {
    assert!(!is_complete(path));
    let time = column(path, "time");
    for (n, t) in time.iter().enumerate() {
        assert!((t - 2e-5 * n as f64).abs() <= 1e-12 * t, "row {n} is at {t}");
    }
    let whole = folder(&long().replace("end = 10", "end = 2e-3"));
    good(&whole, 0, "run scene.toml");
    let (part, whole) = (column(path, "contact/force"), column(&whole.path().join("scene.h5"), "contact/force"));
    let rows = time.len().min(part.len()).min(whole.len());
    // Equal except for rounding, which differs with the number of ranks.
    let largest = whole.iter().fold(0.0, |m, x| f64::max(m, *x));
    assert!((0..rows).all(|n| (part[n] - whole[n]).abs() <= 1e-9 * largest));
    time.len()
}

fn a_killed_run_leaves_a_readable_prefix() {
    let mut most = 0;
    for flushes in [0, 0, 1] {
        let folder = folder(&long());
        let mut started = begun(&folder, 0);
        wait_for_writes(&folder.path().join("out.h5"), flushes);
        std::thread::sleep(Duration::from_millis(40));
        started.child.kill().unwrap();
        let outcome = started.wait(LIMIT);
        assert_eq!(outcome.signal, Some(9));
        let rows = check_prefix(&folder.path().join("out.h5"));
        assert!(rows >= 1);
        most = most.max(rows);
        // The next run is not hindered.
        good(&folder, 0, "run scene.toml -o out.h5 --set time.end=1e-4");
    }
    assert!(most > 1, "no run came far: {most} rows");
}

/// Checks for status 130, a file that is complete up to the interruption, and one line of output about it.
fn check_interrupted(folder: &TempDir, outcome: &Outcome) {
    assert_eq!(outcome.status, Some(130), "{outcome:#?}");
    let path = folder.path().join("out.h5");
    let rows = check_prefix(&path);
    let last = 2e-5 * (rows - 1) as f64;
    let lines: Vec<&str> = outcome.stderr.lines().filter(|line| line.starts_with("interrupted: ")).collect();
    assert_eq!(lines.len(), 1, "{outcome:#?}");
    let told: f64 = lines[0].rsplit("t = ").next().unwrap().trim_end_matches(" s").parse().unwrap();
    assert!((told - last).abs() < 1e-12, "{told} and {last}");
    assert_eq!(column(&path, "energy/total").len(), rows);
}

fn sigterm_ends_a_run_in_order() {
    let folder = folder(&long());
    let started = begun(&folder, 0);
    std::thread::sleep(Duration::from_millis(300));
    send("TERM", &started.child.id().to_string());
    check_interrupted(&folder, &started.wait(LIMIT));
}

/// SIGINT is sent after the first line of progress, which appears after a second; the next one would appear two seconds
/// later.
fn sigint_ends_a_run_in_order_and_progress_is_sparse() {
    let folder = folder(&long());
    let started = begun(&folder, 0);
    let begin = Instant::now();
    while !started.said().contains("step ") {
        assert!(begin.elapsed() < LIMIT, "no line of progress");
        std::thread::sleep(Duration::from_millis(5));
    }
    send("INT", &started.child.id().to_string());
    let outcome = started.wait(LIMIT);
    check_interrupted(&folder, &outcome);
    let lines: Vec<&str> = outcome.stderr.lines().filter(|line| line.starts_with("step ")).collect();
    assert_eq!(lines.len(), 1, "{outcome:#?}");
    assert!(lines[0].contains(", t = ") && lines[0].contains(" of 10000.000 ms, F = "), "{lines:?}");
    // By then an idle machine has done a thousand time steps. The remaining time is estimated after twenty.
    let number = lines[0].trim_start_matches("step ").split(',').next().and_then(|number| number.parse::<usize>().ok());
    assert!(number.is_some_and(|number| number < 20 || lines[0].ends_with(" s left")), "{lines:?}");
    assert!(!outcome.stderr.contains('\r') && !outcome.stderr.contains('\u{1b}'));
}

/// In modal coordinates the steps are written only when all are computed. After a signal, those computed so far are
/// written; the whole run would take minutes.
fn sigterm_ends_a_run_in_modal_coordinates() {
    let scene = results::folder(&BOX.replace("reduction = \"none\"\n", "").replace("newton = \"full\"", ""));
    let line = "run scene.toml -o out.h5 --set time.end=20 --set time.step=1e-5";
    let started = start(ricochet(scene.path(), 0).args(words(line)));
    let begin = Instant::now();
    while !started.said().contains("reduced to") {
        assert!(begin.elapsed() < LIMIT, "no model: {}", started.said());
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(300));
    send("TERM", &started.child.id().to_string());
    let outcome = started.wait(LIMIT);
    assert_eq!(outcome.status, Some(130), "{outcome:#?}");
    let path = scene.path().join("out.h5");
    let (time, force) = (column(&path, "time"), column(&path, "contact/force"));
    let last = time[time.len() - 1];
    assert!(time.len() > 1000 && last < 19.0 && !is_complete(&path), "{} rows up to {last} s", time.len());
    let told = format!("interrupted: out.h5 holds the run up to t = {last:.6e} s");
    assert!(outcome.stderr.lines().any(|line| line == told), "{outcome:#?}");
    assert!(force.iter().any(|force| *force > 0.0) && time.windows(2).all(|pair| pair[1] > pair[0]));
}

/// While the model of a thin pane is made, progress is shown from the first second, and a signal ends the run in order.
fn a_signal_ends_the_making_of_a_model() {
    let pane = results::pane();
    for (command, signal) in [("run", "TERM"), ("run", "INT"), ("run", "USR1"), ("check --full", "TERM")] {
        let folder = folder(&pane);
        let output = if command == "run" { "-o out.h5" } else { "" };
        // Making the model takes some seconds; nothing is shown in the first one.
        let given = format!("{command} scene.toml {output} --set accuracy.tolerance=2e-3");
        let started = start(ricochet(folder.path(), 0).args(words(&given)));
        let begin = Instant::now();
        while !started.said().contains(" s so far)") {
            assert!(begin.elapsed() < LIMIT, "nothing is said: {}", started.said());
            std::thread::sleep(Duration::from_millis(5));
        }
        send(signal, &started.child.id().to_string());
        let outcome = started.wait(LIMIT);
        assert_eq!(outcome.status, Some(130), "{command} {signal}: {outcome:#?}");
        assert!(outcome.stderr.contains("interrupted: no result was written"), "{outcome:#?}");
        let left: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(left, ["scene.toml"], "{command} {signal}");
    }
}

fn a_signal_to_one_rank_interrupts_all() {
    let folder = folder(&long());
    let started = begun(&folder, 2);
    let ranks = children(started.child.id());
    assert_eq!(ranks.len(), 2);
    send("TERM", &ranks[1]);
    check_interrupted(&folder, &started.wait(LIMIT));
}

fn a_killed_rank_ends_all() {
    let folder = folder(&long());
    let started = begun(&folder, 2);
    let ranks = children(started.child.id());
    assert_eq!(ranks.len(), 2);
    send("KILL", &ranks[1]);
    let begin = Instant::now();
    let outcome = started.wait(Duration::from_secs(20));
    assert!(outcome.status != Some(0), "{outcome:#?}");
    let gone = |rank: &String| !Path::new("/proc").join(rank).exists();
    while !ranks.iter().all(gone) {
        assert!(begin.elapsed() < Duration::from_secs(10), "a rank lives on");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(begin.elapsed() < Duration::from_secs(10));
    assert!(check_prefix(&folder.path().join("out.h5")) >= 1);
}

/// Before the contact, which comes after five time steps through a gap of 0.1 mm, each step is linear and one iteration
/// is enough.
fn a_solver_that_fails_says_where_and_the_rows_so_far_are_kept() {
    for ranks in [0, 2] {
        let folder = folder(BOX);
        let line = "run scene.toml -o out.h5 --set impactor.gap=1e-4 -- -snes_max_it 1";
        let outcome = run(ricochet(folder.path(), ranks).args(words(line)));
        assert_eq!(outcome.status, Some(3), "{outcome:#?}");
        let messages: Vec<&str> = outcome.stderr.lines().filter(|line| line.starts_with("error: ")).collect();
        assert_eq!(messages.len(), 1, "{outcome:#?}");
        for part in ["step 6, t = 1.2", "e-4 s: ", "did not converge", "residual ", " N (wanted: "] {
            assert!(messages[0].contains(part), "{part}: {}", messages[0]);
        }
        assert!(!outcome.stderr.contains("PETSC ERROR") && !outcome.stderr.contains("panicked"));
        let path = folder.path().join("out.h5");
        assert_eq!(column(&path, "time").len(), 6);
        assert!(!is_complete(&path));
    }
}

/// If the folder is removed during a run, the run ends with a message.
fn a_removed_folder_ends_a_run() {
    for ranks in [0, 2] {
        let folder = folder(&long());
        let inner = folder.path().join("inner");
        std::fs::create_dir(&inner).unwrap();
        let started = start(ricochet(folder.path(), ranks).args(words("run scene.toml -o inner/out.h5")));
        let begin = Instant::now();
        while !inner.join("out.h5").exists() {
            assert!(begin.elapsed() < LIMIT, "no first row");
            std::thread::sleep(Duration::from_millis(5));
        }
        std::fs::remove_dir_all(&inner).unwrap();
        let outcome = started.wait(LIMIT);
        assert_eq!(outcome.status, Some(4), "{outcome:#?}");
        let errors: Vec<&str> = outcome.stderr.lines().filter(|line| line.contains("error: ")).collect();
        assert_eq!(errors, ["error: inner/out.h5: has been removed while the run was writing it"], "{outcome:#?}");
    }
}

/// A checkpoint that does not fit on the disk gives a message, and the run continues. The test limits the size of
/// files; the series stay below the limit.
fn a_checkpoint_without_room_costs_nothing() {
    let scene = BOX.replace("[4, 4, 1]", "[12, 12, 2]").replace("order = 1", "order = 2");
    let folder = folder(&scene.replace("newton = \"full\"", "newton = \"condensed\""));
    let mut command = Command::new("bash");
    let limited = format!(
        "trap '' XFSZ; ulimit -f 512; exec '{}' run scene.toml -o out.h5 --set output.checkpoint_steps=20",
        env!("CARGO_BIN_EXE_ricochet")
    );
    let outcome = run(command.args(["-c", &limited]).current_dir(folder.path()).env("OMP_NUM_THREADS", "1"));
    assert_eq!(outcome.status, Some(0), "{outcome:#?}");
    let told = "note: no checkpoint was kept: out.checkpoint.h5: cannot be written: File too large";
    assert_eq!(outcome.stderr.matches(told).count(), 2, "{outcome:#?}");
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(is_complete(&folder.path().join("out.h5")) && left.len() == 2, "{left:?}");
}

/// A full disk does not destroy an older result. A run in modal coordinates writes its first step only when all are
/// computed; the old result is replaced when the new one is complete.
fn a_full_disk_costs_no_older_result() {
    let folder = folder(&BOX.replace("reduction = \"none\"\n", "").replace("newton = \"full\"", ""));
    good(&folder, 0, "run scene.toml -o out.h5");
    let before = std::fs::read(folder.path().join("out.h5")).unwrap();
    // The signal of the size limit ends programs that do not handle it; the program must handle it.
    let program = env!("CARGO_BIN_EXE_ricochet");
    let limited = format!("ulimit -f 512; exec '{program}' run scene.toml -o out.h5 --set time.end=0.2");
    let outcome =
        run(Command::new("bash").args(["-c", &limited]).current_dir(folder.path()).env("OMP_NUM_THREADS", "1"));
    assert_eq!(outcome.status, Some(4), "{outcome:#?}");
    assert!(outcome.stderr.contains("out.h5: cannot be written: File too large"), "{outcome:#?}");
    assert!(std::fs::read(folder.path().join("out.h5")).unwrap() == before);
    let left: Vec<_> = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left.len(), 2, "{left:?}");
}

/// A full disk is reported in one line. A limit on the size of files stands for it: 32 MiB, where the planned rows need
/// more.
fn a_full_disk_is_told_in_one_line() {
    let folder = folder(&BOX.replace("end = 1e-3", "end = 20"));
    let program = env!("CARGO_BIN_EXE_ricochet");
    let limited = format!("trap '' XFSZ; ulimit -f 32768; exec '{program}' run scene.toml -o out.h5");
    let alone = run(Command::new("bash").args(["-c", &limited]).current_dir(folder.path()).env("OMP_NUM_THREADS", "1"));
    // The files of mpirun are not limited.
    let two = run(mpi_test::mpirun(2).args(["bash", "-c", &limited]).current_dir(folder.path()));
    for outcome in [alone, two] {
        assert_eq!(outcome.status, Some(4), "{outcome:#?}");
        let told = outcome.stderr.lines().filter(|line| line.starts_with("error: ")).collect::<Vec<_>>();
        assert_eq!(told, ["error: out.h5: cannot be written: File too large"], "{outcome:#?}");
        assert!(!outcome.stderr.contains("MPI_ABORT"), "{outcome:#?}");
    }
}
