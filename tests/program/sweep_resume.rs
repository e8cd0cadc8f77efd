//! Tests of sweeps that are ended early and continued.

use crate::program;
use crate::results;
use mpi_test::{PlainTest, tests};
use std::path::Path;
use std::time::{Duration, Instant};

use crate::program::{LIMIT, children, ricochet, run, send, start, wait_for_writes};
use crate::results::{folder, good, number, words};
use crate::sweeps::{content, members, numbers, supported};

pub const TESTS: &[PlainTest] = tests![
    what_is_missing_is_computed_and_nothing_else,
    a_signal_keeps_what_is_done,
    a_kill_spoils_nothing,
    a_full_disk_spoils_nothing,
    another_sweep_is_not_continued
];

const LINE: &str = "sweep scene.toml --vary support.0.stiffness=1e6..1e12:8 --log";

/// Removes members as if they had not been computed. Only their statuses are changed, as a kill within a flush may do.
fn forget(path: &Path, gone: &[usize]) {
    results::change(path, |file| {
        for &member in gone {
            file.dataset("members/status").unwrap().write_slice(&[0_u8], member..member + 1).unwrap();
        }
    });
}

fn what_is_missing_is_computed_and_nothing_else() {
    for series in ["", " --series"] {
        let folder = folder(&supported());
        let path = folder.path().join("s.h5");
        good(&folder, 0, &format!("{LINE}{series} -o s.h5"));
        let (whole, time) = (content(&path), members(&path, "wall_time"));
        forget(&path, &[2, 3, 7]);
        let said = good(&folder, 2, &format!("{LINE}{series} -o s.h5"));
        assert!(said.stdout.contains("8 of 8 members, 5 of them were there"), "{said:?}");
        assert_eq!(content(&path), whole);
        let again = members(&path, "wall_time");
        for n in 0..8 {
            assert_eq!(time[n] != again[n], [2, 3, 7].contains(&n), "member {n}");
        }
    }
}

/// Starts a sweep, and waits until its file is there and has been written to this number of times more.
fn begun(folder: &tempfile::TempDir, ranks: usize, line: &str, writes: usize) -> program::Started {
    let path = folder.path().join("s.h5");
    let started = start(ricochet(folder.path(), ranks).args(words(&format!("{line} -o s.h5"))));
    let begin = Instant::now();
    while !path.exists() {
        assert!(begin.elapsed() < LIMIT, "no file");
        std::thread::sleep(Duration::from_millis(2));
    }
    wait_for_writes(&path, writes);
    started
}

fn done(path: &Path) -> usize {
    members(path, "status").iter().filter(|status| **status == 1.0).count()
}

fn a_signal_keeps_what_is_done() {
    for ranks in [0, 2] {
        let folder = folder(&supported());
        let path = folder.path().join("s.h5");
        // Half a minute of work.
        let line = LINE.replace(":8", ":5000") + " --set time.end=0.05";
        let started = begun(&folder, ranks, &line, 1);
        // The signal goes to one rank, which is not rank 0 if there are two.
        let ranks = children(started.child.id());
        send("TERM", ranks.get(1).unwrap_or(&started.child.id().to_string()));
        let outcome = started.wait(Duration::from_secs(10));
        assert_eq!(outcome.status, Some(130), "{outcome:?}");
        assert_eq!(outcome.stderr.matches("interrupted: ").count(), 1, "{outcome:?}");
        let kept = done(&path);
        assert!(outcome.stderr.contains(&format!("{} members are missing", 5000 - kept)), "{kept}: {outcome:?}");
        assert!(0 < kept && kept < 5000 && !number::<bool>(&results::open(&path), "complete"));
    }
}

/// After a kill the file can be read and continued, and ends as if nothing had happened.
fn a_kill_spoils_nothing() {
    let folder = folder(&supported());
    let path = folder.path().join("s.h5");
    // A kill before the first members may come in any sweep.
    good(&folder, 0, &format!("{LINE} -o few.h5"));
    let few = content(&folder.path().join("few.h5"));
    let mut started = begun(&folder, 0, LINE, 0);
    let _ = started.child.kill();
    started.wait(LIMIT);
    done(&path);
    good(&folder, 0, &format!("{LINE} -o s.h5"));
    assert_eq!(content(&path), few);
    // The sweep takes longer than two flushes, one second apart.
    let many = "sweep scene.toml --vary support.0.stiffness=1e6..1e12:400 --log --set time.end=0.05";
    good(&folder, 0, &format!("{many} -o whole.h5"));
    let whole = content(&folder.path().join("whole.h5"));
    // Kills come later and later until there are members. The number of earlier writes depends on the machine.
    for writes in 1.. {
        let _ = std::fs::remove_file(&path);
        let mut started = begun(&folder, 0, many, writes);
        let _ = started.child.kill();
        started.wait(LIMIT);
        let kept = done(&path);
        good(&folder, 0, &format!("{many} -o s.h5"));
        assert_eq!(content(&path), whole);
        if kept > 0 {
            break;
        }
        assert!(writes < 10, "what was written is there");
    }
}

/// A full disk does not damage the sweep. Limits on the size of files stand for a disk that is full at some moment of a
/// sweep.
fn a_full_disk_spoils_nothing() {
    let folder = folder(&supported());
    let path = folder.path().join("s.h5");
    let line = format!("{LINE} --series -o").replace(":8", ":19");
    good(&folder, 0, &format!("{line} whole.h5"));
    let whole = folder.path().join("whole.h5");
    let size = whole.metadata().unwrap().len() / 512;
    let mut interrupted = 0;
    for part in [size / 2, size - 100] {
        let _ = std::fs::remove_file(&path);
        let limited = format!("ulimit -f {}; exec '{}' {line} s.h5", part / 2, env!("CARGO_BIN_EXE_ricochet"));
        let mut command = std::process::Command::new("bash");
        let outcome = run(command.args(["-c", &limited]).current_dir(folder.path()).env("OMP_NUM_THREADS", "1"));
        assert_eq!(outcome.status, Some(4), "{outcome:#?}");
        assert_eq!(outcome.stderr.matches("s.h5: cannot be written: File too large").count(), 1, "{outcome:#?}");
        assert!(!outcome.stderr.contains("MPI_ABORT"), "{outcome:#?}");
        interrupted += usize::from(done(&path) > 0);
        good(&folder, 0, &format!("{line} s.h5"));
        assert_eq!(content(&path), content(&whole));
    }
    assert!(interrupted > 0, "what was written before is kept");
}

fn another_sweep_is_not_continued() {
    let folder = folder(&supported());
    let path = folder.path().join("s.h5");
    good(&folder, 0, &format!("{LINE} -o s.h5"));
    good(&folder, 0, "run scene.toml -o run.h5");
    let before = std::fs::read(&path).unwrap();
    for (line, why) in [
        (format!("{LINE} --set impactor.speed=2 -o s.h5"), "holds a sweep of another scene"),
        (LINE.replace(":8", ":9") + " -o s.h5", "holds a sweep over other values of support.0.stiffness"),
        (
            LINE.replace("support.0.stiffness", "body.young") + " -o s.h5",
            "holds a sweep over support.0.stiffness, not over body.young",
        ),
        (format!("{LINE} --series -o s.h5"), "holds a sweep without --series"),
        (format!("{LINE} -o run.h5"), "is the result of a run, so it is not replaced by a sweep"),
    ] {
        for ranks in [0, 2] {
            let outcome = run(ricochet(folder.path(), ranks).args(words(&line)));
            assert_eq!(outcome.status, Some(4), "{outcome:?}");
            assert!(outcome.stderr.contains(why), "{why}: {outcome:?}");
            assert_eq!(outcome.stderr.matches("error: ").count(), 1, "{outcome:?}");
        }
    }
    assert!(std::fs::read(&path).unwrap() == before);
    assert!(numbers(&folder.path().join("run.h5"), "series/time").len() > 10);
}
