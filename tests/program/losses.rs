//! Tests that no data are lost: files of other programs, runs that can be continued, figures, and output to a pipe.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;

use hdf5_metno as hdf5;
use mpi_test::{PlainTest, tests};
use tempfile::TempDir;

use crate::glass;
use crate::program::{BOX, Outcome, ricochet, run};
use crate::restarts::{interrupted, refused, scene};
use crate::results::{folder, good, is_complete, words};
use crate::sweeps::supported;

pub const TESTS: &[PlainTest] = tests![
    only_runs_are_replaced,
    files_beside_a_result_are_replaced_by_their_kind_alone,
    a_run_without_a_checkpoint_is_begun_anew_as_itself,
    an_interrupted_run_is_replaced_by_force_alone,
    a_dangling_link_is_followed,
    a_figure_is_whole_or_not_there,
    a_full_disk_ends_a_run_with_probes,
    scenes_come_through_pipes,
    a_scene_that_cannot_be_read_is_an_error_of_input,
    a_name_that_is_no_text_is_told_at_once,
    what_cannot_be_said_is_an_error_of_output,
    a_rank_without_petsc_ends_all,
    plates_need_no_petsc,
];

/// Runs a line of bash in a folder, in which `ricochet` is the program.
fn bash(folder: &Path, line: &str) -> Outcome {
    let program = env!("CARGO_BIN_EXE_ricochet");
    let line = format!("ricochet() {{ '{program}' \"$@\"; }}; {line}");
    run(Command::new("bash")
        .args(["-c", &line])
        .current_dir(folder)
        .envs(mpi_test::mpirun(1).get_envs().filter_map(|(name, value)| Some((name, value?)))))
}

fn only_runs_are_replaced() {
    let folder = folder(&supported());
    let path = |name: &str| folder.path().join(name);
    hdf5::File::create(path("theirs.h5")).unwrap().create_group("series").unwrap();
    good(&folder, 0, "sweep scene.toml --vary support.0.stiffness=1e8,1e9 -o sweep.h5");
    for (name, why) in [
        ("theirs.h5", "theirs.h5: is an HDF5 file of another program, so it is not replaced"),
        ("sweep.h5", "sweep.h5: is a sweep, so it is not replaced by the result of a run"),
    ] {
        let before = fs::read(path(name)).unwrap();
        refused(&folder, &format!("run scene.toml -o {name}"), 4, &[why]);
        refused(&folder, &format!("run scene.toml -o {name} --force"), 4, &[why]);
        assert!(fs::read(path(name)).unwrap() == before, "{name} has changed");
    }
    good(&folder, 0, "run scene.toml -o run.h5");
    let before = fs::read(path("run.h5")).unwrap();
    let why = "run.h5: is the result of a run, so it is not replaced by a sweep";
    refused(&folder, "sweep scene.toml --vary support.0.stiffness=1e8,1e9 -o run.h5", 4, &[why]);
    assert!(fs::read(path("run.h5")).unwrap() == before);
    good(&folder, 0, "run scene.toml -o run.h5");
}

/// A file with the name of a run's checkpoint, of its fields or of a figure is replaced only if it is of that kind.
fn files_beside_a_result_are_replaced_by_their_kind_alone() {
    let folder = folder(&supported());
    let path = |name: &str| folder.path().join(name);
    good(&folder, 0, "run scene.toml -o other.h5");
    fs::copy(path("other.h5"), path("a.checkpoint.h5")).unwrap();
    fs::write(path("b.checkpoint.h5"), "notes").unwrap();
    fs::write(path("c.xdmf"), "notes").unwrap();
    for (name, line, why) in [
        ("a.checkpoint.h5", "run scene.toml -o a.h5", "is no checkpoint of a run, so it is not replaced"),
        ("b.checkpoint.h5", "run scene.toml -o b.h5", "is no checkpoint of a run, so it is not replaced"),
        (
            "c.xdmf",
            "run scene.toml -o c.h5 --set output.fields=5",
            "is no XDMF of a run's fields, so it is not replaced",
        ),
        ("other.h5", "plot other.h5 -o other.h5", "is an HDF5 file, so no figure replaces it"),
    ] {
        let before = fs::read(path(name)).unwrap();
        refused(&folder, line, 4, &[name, why]);
        assert!(fs::read(path(name)).unwrap() == before, "{name} has changed");
    }
    // The files of an earlier run are replaced.
    good(&folder, 0, "run scene.toml -o d.h5 --set output.fields=5");
    good(&folder, 0, "run scene.toml -o d.h5 --set output.fields=5");
}

fn a_run_without_a_checkpoint_is_begun_anew_as_itself() {
    let folder = folder(&scene(""));
    let line = "run scene.toml -o out.h5 --set output.checkpoint_steps=100";
    interrupted(&folder, 0, line, "TERM");
    fs::remove_file(folder.path().join("out.checkpoint.h5")).unwrap();
    let before = fs::read(folder.path().join("out.h5")).unwrap();
    let why = "`ricochet info out.h5 --scene` shows it), and has no checkpoint";
    refused(&folder, "run scene.toml --restart out.h5 --set impactor.mass=3", 2, &[why]);
    assert!(fs::read(folder.path().join("out.h5")).unwrap() == before);
    good(&folder, 0, "run scene.toml --restart out.h5 --set time.end=1e-3");
}

fn an_interrupted_run_is_replaced_by_force_alone() {
    let folder = folder(&scene(""));
    let line = "run scene.toml -o out.h5 --set output.checkpoint_steps=100";
    interrupted(&folder, 0, line, "TERM");
    let path = folder.path().join("out.h5");
    let before = fs::read(&path).unwrap();
    refused(
        &folder,
        line,
        4,
        &["out.h5: holds an interrupted run", "--restart out.h5 continues it", "--force replaces it"],
    );
    assert!(fs::read(&path).unwrap() == before && !is_complete(&path));
    good(&folder, 0, &format!("{line} --force --set time.end=1e-4"));
    assert!(is_complete(&path) && !folder.path().join("out.checkpoint.h5").exists());
}

fn a_dangling_link_is_followed() {
    let folder = folder(BOX);
    fs::create_dir(folder.path().join("results")).unwrap();
    symlink("results/there.h5", folder.path().join("out.h5")).unwrap();
    good(&folder, 0, "run scene.toml -o out.h5");
    assert!(fs::symlink_metadata(folder.path().join("out.h5")).unwrap().is_symlink());
    assert!(is_complete(&folder.path().join("results/there.h5")));
}

/// A figure is complete or not there. A limit on the size of files stands for a full disk.
fn a_figure_is_whole_or_not_there() {
    let folder = folder(BOX);
    good(&folder, 0, "run scene.toml -o out.h5");
    for name in ["new.png", "new.svg"] {
        let outcome = bash(folder.path(), &format!("trap '' XFSZ; ulimit -f 1; ricochet plot out.h5 -o {name}"));
        assert_eq!(outcome.status, Some(4), "{outcome:#?}");
        assert_eq!(outcome.told().trim_end(), format!("error: {name}: File too large (os error 27)"), "{outcome:#?}");
    }
    let mut left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    left.sort();
    assert_eq!(left, ["out.h5", "scene.toml"]);
    good(&folder, 0, "plot out.h5 -o new.png");
    let before = fs::read(folder.path().join("new.png")).unwrap();
    bash(folder.path(), "trap '' XFSZ; ulimit -f 1; ricochet plot out.h5 -o new.png");
    assert!(fs::read(folder.path().join("new.png")).unwrap() == before);
}

/// A run that meets a full disk while it writes its last rows ends with one message, also if it has probes. The limits
/// are just below the size of the complete file.
fn a_full_disk_ends_a_run_with_probes() {
    let scene = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/pane.toml")).unwrap();
    let folder = folder(&scene);
    let line = "run scene.toml -o out.h5 --force --set time.scheme=newmark --set time.step=1e-5 --set output.checkpoint_steps=20";
    good(&folder, 0, line);
    let blocks = fs::metadata(folder.path().join("out.h5")).unwrap().len() / 1024;
    for less in [2, 5, 8] {
        let limited = format!("trap '' XFSZ; ulimit -f {}; ricochet {line}", blocks - less);
        let outcome = bash(folder.path(), &limited);
        assert_eq!(outcome.status, Some(4), "{less} blocks less: {outcome:#?}");
        assert!(outcome.stderr.contains("error: out.h5: cannot be written: File too large"), "{outcome:#?}");
        assert!(!outcome.stderr.contains("panicked"), "{outcome:#?}");
    }
}

fn scenes_come_through_pipes() {
    let folder = folder(BOX);
    let whole = good(&folder, 0, "check scene.toml").stdout;
    for line in
        ["ricochet check <(cat scene.toml)", "cat scene.toml | ricochet check -", "ricochet check - <scene.toml"]
    {
        let outcome = bash(folder.path(), line);
        assert_eq!((outcome.status, &outcome.stdout), (Some(0), &whole), "{line}: {outcome:#?}");
    }
    let outcome = bash(folder.path(), "mkfifo pipe; cat scene.toml >pipe & ricochet run pipe -o piped.h5");
    assert_eq!(outcome.status, Some(0), "{outcome:#?}");
    let outcome = bash(folder.path(), "ricochet run - <scene.toml");
    assert_eq!(outcome.status, Some(2), "{outcome:#?}");
    assert!(
        outcome.stderr.contains("a scene from standard input needs a name for its result: -o OUT.h5"),
        "{outcome:#?}"
    );
    let outcome = bash(folder.path(), "sed 's/young = 70e9/young = -1/' scene.toml | ricochet run - -o out.h5");
    assert_eq!(outcome.status, Some(2), "{outcome:#?}");
    assert!(outcome.stderr.contains("standard input:5: body.young: "), "{outcome:#?}");
}

fn a_scene_that_cannot_be_read_is_an_error_of_input() {
    let folder = folder(BOX);
    refused(&folder, "run missing.toml", 4, &["missing.toml: the scene cannot be read: No such file"]);
    refused(&folder, "check .", 4, &["the scene cannot be read"]);
}

/// A file name that is not valid text is reported before the work begins, because HDF5 takes file names as text.
fn a_name_that_is_no_text_is_told_at_once() {
    let folder = folder(BOX);
    for line in ["run scene.toml", "sweep scene.toml --vary impactor.speed=1,2"] {
        let outcome = bash(folder.path(), &format!("ricochet {line} -o $'a\\xff.h5'"));
        assert_eq!(outcome.status, Some(4), "{outcome:#?}");
        assert!(outcome.stderr.contains("is no name for a result: HDF5 wants text in UTF-8"), "{outcome:#?}");
        assert!(!outcome.stderr.contains("solid:") && !outcome.stderr.contains("MPI_ABORT"), "{outcome:#?}");
    }
}

fn what_cannot_be_said_is_an_error_of_output() {
    let folder = folder(BOX);
    good(&folder, 0, "run scene.toml -o out.h5");
    for line in ["ricochet info out.h5 >/dev/full", "ricochet check scene.toml >/dev/full"] {
        let outcome = bash(folder.path(), line);
        assert_eq!(outcome.status, Some(4), "{line}: {outcome:#?}");
        let told = "error: standard output: cannot be written: No space left on device";
        assert!(outcome.stderr.contains(told), "{line}: {outcome:#?}");
    }
    // It is no error if the reader of a pipe closes it.
    let outcome = bash(folder.path(), "set -o pipefail; ricochet info out.h5 | head -n 1");
    assert_eq!(outcome.status, Some(0), "{outcome:#?}");
    assert_eq!(words(&outcome.stdout).next(), Some("title"));
}

/// A library that PETSc needs is damaged on one of two ranks: there is one message with the cause and the rank, and no
/// rank waits for the other.
fn a_rank_without_petsc_ends_all() {
    let folder = folder(BOX);
    let find = "LD_DEBUG=files ricochet check scene.toml 2>&1 | sed -n 's/.*file=\\(lib[^ ]*\\) \\[0\\]; *needed by [^ ]*libpetsc.*/\\1/p' | head -1";
    let library = bash(folder.path(), find).stdout;
    let library = library.trim();
    assert!(!library.is_empty());
    fs::create_dir(folder.path().join("spoilt")).unwrap();
    fs::write(folder.path().join("spoilt").join(library), "no library").unwrap();
    let program = env!("CARGO_BIN_EXE_ricochet");
    for spoilt_rank in [0, 1] {
        // (Not two commands with a colon between them: these crash mpirun of Open MPI 5.0.7.)
        let line = format!(
            "if ((OMPI_COMM_WORLD_RANK == {spoilt_rank})); then export LD_LIBRARY_PATH=spoilt; fi\n\
             exec '{program}' run scene.toml -o out.h5"
        );
        let mut command = mpi_test::mpirun(2);
        command.args(["bash", "-c", &line]);
        let outcome = run(command.current_dir(folder.path()));
        assert_ne!(outcome.status, Some(0), "{outcome:?}");
        assert_eq!(outcome.stderr.matches("PETSc cannot be loaded").count(), 1, "{outcome:?}");
        assert!(outcome.stderr.contains(&format!("(rank {spoilt_rank} of 2)")), "{outcome:?}");
        assert!(!folder.path().join("out.h5").exists());
    }
}

/// Runs of one process with reduction and modal coordinates do not load PETSc: a plate with probes and fields, a plate
/// hit off its centre, a laminate, a solid of splines; and their checks, limits and sweeps, with separate bases and
/// with a common one.
fn plates_need_no_petsc() {
    let springs = glass::sides(1e9, 0.0);
    let read = "[output]\nfields = 50\nprobes = [{ name = \"middle\", point = [0.0, 0.0, 0.0] }]\n";
    let plate = |size: &str, hit: &str| {
        let body = format!("size = {size}\nmodel = \"auto\"");
        glass::scene(&body, &format!("mass = 5.0\nspeed = 1.0\n{hit}"), "end = 2e-3", &springs)
    };
    let glass = "young = 70e9\npoisson = 0.23\ndensity = 2500.0\n";
    let laminate = format!(
        "[body]\nsize = [0.5, 0.5]\nmodel = \"layerwise\"\n[[body.layer]]\nthickness = 0.006\nmaterial = \"glass\"\n\
         [[body.layer]]\nthickness = 0.00152\nmaterial = \"film\"\n[[body.layer]]\nthickness = 0.006\nmaterial = \"glass\"\n\
         [material.glass]\n{glass}[material.film]\nbulk = 2e9\ndensity = 1100.0\nshear = 1e6\n\
         prony = [{{ modulus = 6e7, time = 1e-4 }}]\n\
         [impactor]\nmass = 1.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n[time]\nend = 5e-4\n"
    );
    let thick = "size = [0.3, 0.3, 0.1]\nmodel = \"solid\"";
    let solid = glass::scene(thick, "mass = 5.0\nspeed = 1.0", "end = 5e-4", &springs);
    let middle = plate("[1.0, 1.0, 0.05]", "");
    let run = "run scene.toml -o out.h5 --force";
    let sweep = |values: &str| format!("sweep scene.toml -o sweep.h5 --vary support.0.stiffness={values}");
    for (scene, line) in [
        (format!("{middle}{read}"), run.to_owned()),
        (plate("[1.0, 1.0, 0.05]", "point = [0.1, 0.07, 0.025]"), run.to_owned()),
        (laminate, run.to_owned()),
        (solid, run.to_owned()),
        (middle.clone(), "check scene.toml".to_owned()),
        (middle.clone(), sweep("0,1e9")),
        (middle.clone(), sweep("1e8..1e9:20")),
        (format!("{middle}[strength]\ntension = 1e7\n"), "limit scene.toml --vary impactor.speed=0.01..10".to_owned()),
    ] {
        let folder = folder(&scene);
        let outcome = run_under_loader(&folder, &line);
        assert!(!outcome.stderr.contains("libpetsc"), "{line}\n{scene}");
    }
    assert!(run_under_loader(&folder(BOX), run).stderr.contains("libpetsc"), "what is stepped needs it");
}

/// Runs a line that succeeds; the loader reports each library that it loads.
fn run_under_loader(folder: &TempDir, line: &str) -> Outcome {
    let outcome = run(ricochet(folder.path(), 0).env("LD_DEBUG", "files").args(words(line)));
    let said = outcome.stderr.lines().filter(|line| !line.contains("file=") && !line.contains("calling"));
    assert_eq!(outcome.status, Some(0), "{line}: {}", said.collect::<Vec<_>>().join("\n"));
    outcome
}
