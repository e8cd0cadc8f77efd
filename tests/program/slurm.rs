//! Tests of the jobs in `scripts/slurm`, with replacements for the commands of the queue: `srun` starts one rank for
//! each task of the job, and `scontrol` records its arguments.

use crate::results;
use mpi_test::{PlainTest, tests};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::program::{BOX, LIMIT, Outcome, run, send, start};
use crate::results::{column, difference, folder, good, is_complete, long, number, words};
use crate::sweeps::{content, supported};
use tempfile::TempDir;

pub const TESTS: &[PlainTest] = tests![
    a_job_runs_on_its_tasks,
    an_array_computes_a_sweep_in_parts,
    a_run_beyond_the_limit_goes_on_in_the_next_job,
    a_run_without_a_checkpoint_is_not_queued_again,
    a_cancelled_job_stays_away,
    a_run_that_fails_is_not_queued_again
];
pub const SHELLCHECK: &[PlainTest] = tests![shellcheck_finds_nothing];

const SRUN: &str = "#!/usr/bin/env bash\nexec mpirun -n \"$SLURM_NTASKS\" \"$@\"\n";
const SCONTROL: &str = "#!/usr/bin/env bash\necho \"$*\" >>scontrol.log\n";

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A job of two tasks in a folder.
fn job(folder: &TempDir, name: &str, line: &str) -> Command {
    let stand_ins = folder.path().join("stand-ins");
    fs::create_dir_all(&stand_ins).unwrap();
    for (name, text) in [("srun", SRUN), ("scontrol", SCONTROL)] {
        fs::write(stand_ins.join(name), text).unwrap();
        fs::set_permissions(stand_ins.join(name), fs::Permissions::from_mode(0o755)).unwrap();
    }
    let program = Path::new(env!("CARGO_BIN_EXE_ricochet")).parent().unwrap().to_owned();
    let path = std::env::var_os("PATH").unwrap();
    let path = std::env::join_paths([stand_ins, program].into_iter().chain(std::env::split_paths(&path))).unwrap();
    let mut command = Command::new("bash");
    let of_mpi = mpi_test::mpirun(1);
    command.envs(of_mpi.get_envs().filter_map(|(name, value)| Some((name, value?))));
    // The job must set this variable.
    command.env_remove("OMP_NUM_THREADS").env("PATH", path).env("SLURM_JOB_ID", "4711").env("SLURM_NTASKS", "2");
    command.arg(repository().join("scripts/slurm").join(name)).args(words(line)).current_dir(folder.path());
    command
}

fn ended(outcome: &Outcome, status: i32) {
    assert_eq!(outcome.status, Some(status), "{outcome:#?}");
}

fn shellcheck_finds_nothing() {
    let line = "shellcheck scripts/slurm/*.sbatch";
    let output = Command::new("bash").args(["-ec", line]).current_dir(repository()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}

fn a_job_runs_on_its_tasks() {
    let folder = folder(BOX);
    ended(&run(&mut job(&folder, "job.sbatch", "run scene.toml -o out.h5")), 0);
    let path = folder.path().join("out.h5");
    assert!(is_complete(&path));
    assert_eq!(number::<u64>(&results::open(&path), "ranks"), 2);
    // The queue gets the exit status of ricochet.
    ended(&run(&mut job(&folder, "job.sbatch", "run missing.toml -o out.h5")), 4);
}

fn an_array_computes_a_sweep_in_parts() {
    let folder = folder(&supported());
    let line = "scene.toml --vary support.0.stiffness=1e7..1e11:5 --log -o k.h5";
    let task = |id: &str, count: &str| {
        let mut job = job(&folder, "array.sbatch", line);
        run(job.env("SLURM_ARRAY_TASK_ID", id).env("SLURM_ARRAY_TASK_COUNT", count))
    };
    for id in ["1", "2", "3"] {
        ended(&task(id, "3"), 0);
        assert!(folder.path().join(format!("k.{id}-of-3.h5")).exists());
    }
    // An incomplete array, or one that starts at 0, is refused, because its parts would be other parts.
    for (id, count) in [("0", "3"), ("2", "1")] {
        ended(&task(id, count), 2);
    }
    let joined = run(&mut job(&folder, "job.sbatch", &format!("sweep {line}")));
    ended(&joined, 0);
    assert!(joined.stdout.contains("k.h5: 5 of 5 members"), "{joined:#?}");
    good(&folder, 0, &format!("sweep {}", line.replace("k.h5", "whole.h5")));
    assert_eq!(content(&folder.path().join("k.h5")), content(&folder.path().join("whole.h5")));
}

/// A run of a few seconds.
fn some_seconds() -> String {
    long().replace("end = 10", "end = 0.015")
}

const REQUEUE: &str = "out.h5 scene.toml";

/// Sends a signal to a job during its run.
fn signalled(folder: &TempDir, signal: &str) -> Outcome {
    let started = start(&mut job(folder, "requeue.sbatch", REQUEUE));
    let begin = Instant::now();
    while !folder.path().join("out.h5").exists() {
        assert!(begin.elapsed() < LIMIT, "no first row");
        std::thread::sleep(Duration::from_millis(5));
    }
    send(signal, &started.child.id().to_string());
    started.wait(LIMIT)
}

/// At the time limit the job is queued again, and its next start continues: the result equals an uninterrupted run's.
fn a_run_beyond_the_limit_goes_on_in_the_next_job() {
    let folder = folder(&some_seconds());
    ended(&signalled(&folder, "USR1"), 130);
    let (path, told) = (folder.path().join("out.h5"), folder.path().join("scontrol.log"));
    assert_eq!(fs::read_to_string(&told).unwrap(), "requeue 4711\n");
    let rows = column(&path, "time").len();
    assert!(!is_complete(&path) && rows > 1);
    ended(&run(&mut job(&folder, "requeue.sbatch", REQUEUE)), 0);
    assert!(is_complete(&path) && column(&path, "time").len() > rows);
    assert_eq!(fs::read_to_string(&told).unwrap(), "requeue 4711\n");

    ended(&run(&mut job(&folder, "job.sbatch", "run scene.toml -o whole.h5")), 0);
    let force = |name: &str| column(&folder.path().join(name), "contact/force");
    // A new factorisation of the same matrix: equal except for rounding.
    assert!(difference(&force("out.h5"), &force("whole.h5")) < 1e-9);
}

/// A run that ends in order without a checkpoint, as in modal coordinates, would begin anew in every job. So it is not
/// queued again, even next to an older checkpoint.
fn a_run_without_a_checkpoint_is_not_queued_again() {
    let folder = folder(BOX);
    let path = |name: &str| folder.path().join(name);
    for has_older in [false, true] {
        if has_older {
            fs::write(path("out.checkpoint.h5"), "older").unwrap();
        }
        let mut job = job(&folder, "requeue.sbatch", REQUEUE);
        let run = "#!/usr/bin/env bash\ntrap 'exit 130' USR1\ntouch begun\nwhile :; do sleep 0.01; done\n";
        fs::write(path("stand-ins/srun"), run).unwrap();
        let started = start(&mut job);
        let begin = Instant::now();
        while !path("begun").exists() {
            assert!(begin.elapsed() < LIMIT, "no run");
            std::thread::sleep(Duration::from_millis(5));
        }
        send("USR1", &started.child.id().to_string());
        let outcome = started.wait(LIMIT);
        ended(&outcome, 130);
        assert!(outcome.stderr.contains("no new out.checkpoint.h5"), "{outcome:#?}");
        assert!(!path("scontrol.log").exists());
        fs::remove_file(path("begun")).unwrap();
    }
}

/// A cancelled job writes its checkpoint and is not queued again.
fn a_cancelled_job_stays_away() {
    let folder = folder(&some_seconds());
    ended(&signalled(&folder, "TERM"), 130);
    assert!(!folder.path().join("scontrol.log").exists());
    ended(&run(&mut job(&folder, "requeue.sbatch", REQUEUE)), 0);
    assert!(is_complete(&folder.path().join("out.h5")));
}

/// A run that the solver refuses would be refused again.
fn a_run_that_fails_is_not_queued_again() {
    let folder = folder(BOX);
    let line = format!("{REQUEUE} --set impactor.gap=1e-4 -- -snes_max_it 1");
    ended(&run(&mut job(&folder, "requeue.sbatch", &line)), 3);
    assert!(!folder.path().join("scontrol.log").exists());
}
