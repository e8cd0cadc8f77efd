//! Tests of restarts: runs continue from a checkpoint, on any number of ranks, and give the series of an uninterrupted
//! run.

use mpi_test::{PlainTest, tests};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::program::{BOX, LIMIT, ricochet, run, send, start};
use crate::restarts::{check_alike, interrupted, refused, scene};
use crate::results::{column, difference, folder, good, words};

pub const TESTS: &[PlainTest] = tests![
    restarted_series_are_those_of_one_run,
    probes_and_fields_go_on,
    the_full_newton_goes_on_within_its_tolerance,
    ranks_may_change,
    a_basis_goes_on_where_it_is_the_same,
    the_end_and_the_file_may_change,
    what_cannot_go_on_says_why,
    without_a_checkpoint_it_begins_anew,
    a_result_is_run_again_from_itself,
    a_result_knows_its_mesh,
    one_run_at_a_time_writes_a_result
];

/// Largest relative change from another number of ranks. It comes from the order of sums, 1e-16 of the largest terms in
/// each time step, which several contacts amplify. The largest value seen is 6e-9.
const RANKS: f64 = 1e-7;

/// A run that a signal has ended and that is continued equals the uninterrupted run bit for bit: for every scheme,
/// dampers, pads, loads, moving supports, adaptive time steps and a basis.
fn restarted_series_are_those_of_one_run() {
    let damper = "\n[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e8\ndamping = 1e4\n";
    let pad = "\n[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nstiffness = 1e9\nnormal = [0, 0, -1]\n";
    let load = "\n[load]\nbody_force = [0, 0, -2.5e4]\n[[load.traction]]\nsurface = \"top\"\nvalue = [1e3, 0, -1e4]\n";
    let moved = "\n[[support]]\nsurface = \"side\"\nkind = \"clamped\"\ndisplacement = [0, 0, 1e-5]\n";
    let cases = [
        ("newmark", "", "--set time.scheme=newmark --set output.every=3"),
        ("a damper", damper, "--set time.scheme=generalized-alpha"),
        ("loads", load, "--set time.scheme=newmark"),
        ("a support that is moved", moved, "--set time.scheme=energy"),
        ("a pad", pad, "--set time.scheme=energy --set time.end=0.02"),
        ("explicit", "", "--set time.scheme=central-difference --set time.step=1e-6 --set time.end=0.01"),
        ("chosen steps", damper, "--set time.step= --set time.scheme=newmark"),
        ("chosen steps of the energy scheme", "", "--set time.step= --set time.scheme=energy"),
        ("a basis", "", "--set body.reduction=20 --set time.scheme=newmark --set time.step=2e-6"),
    ];
    for (name, more, settings) in cases {
        // Pads keep a factorisation while it converges, and a restart makes a new one: the results agree within the
        // tolerance of Newton's method.
        let tolerance = if name == "a pad" { 1e-10 } else { 0.0 };
        let folder = folder(&scene(more));
        good(&folder, 0, &format!("run scene.toml -o whole.h5 {settings}"));
        let line = format!("run scene.toml -o out.h5 {settings} --set output.checkpoint_steps=100");
        interrupted(&folder, 0, &line, if more.is_empty() { "TERM" } else { "USR1" });
        let rows = column(&folder.path().join("out.h5"), "time").len();
        let outcome = good(&folder, 0, &format!("run scene.toml --restart out.h5 {settings}"));
        assert!(outcome.stderr.contains("continuing from t = "), "{name}: {outcome:#?}");
        let apart = check_alike(&folder.path().join("out.h5"), &folder.path().join("whole.h5"), tolerance);
        println!("{name}: ended after {rows} rows, {apart:e} apart");
        assert!(!folder.path().join("out.checkpoint.h5").exists(), "{name}: a checkpoint of a complete run");
    }
}

/// Probes and fields continue too, into another file and into the same one.
fn probes_and_fields_go_on() {
    let read =
        "\n[output]\nfields = 7\nprobes = [{ name = \"under\", point = [0.05, 0, -0.01] }]\ncheckpoint_steps = 100\n";
    for step in ["", "--set time.step= --set time.scheme=newmark"] {
        let folder = folder(&scene(read));
        good(&folder, 0, &format!("run scene.toml -o whole.h5 {step}"));
        interrupted(&folder, 2, &format!("run scene.toml -o out.h5 {step}"), "USR1");
        good(&folder, 0, &format!("run scene.toml --restart out.h5 -o more.h5 {step}"));
        good(&folder, 2, &format!("run scene.toml --restart out.h5 {step}"));
        for name in ["more.h5", "out.h5"] {
            let [path, whole] = [name, "whole.h5"].map(|name| folder.path().join(name));
            let mut most = check_alike(&path, &whole, RANKS);
            let [part, whole] = [path, whole].map(|path| hdf5_metno::File::open(path).unwrap());
            for dataset in
                ["Steps/Values", "PointData/displacement", "PointData/velocity", "PointData/principal_stress"]
            {
                let [part, whole]: [Vec<f64>; 2] =
                    [&part, &whole].map(|file| file.dataset(&format!("VTKHDF/{dataset}")).unwrap().read_raw().unwrap());
                let apart = difference(&part, &whole);
                assert!(apart <= RANKS, "{name}: {dataset}: {apart:e}");
                most = most.max(apart);
            }
            // A unit in the last place of single precision.
            let apart = maps_apart(&folder.path().join(name), &folder.path().join("whole.h5"));
            assert!(apart <= 1.2e-7, "{name}: {apart:e}");
            most = most.max(apart);
            println!("probes and fields, {step:?}, {name}: {most:e} apart");
        }
    }
}

/// Largest difference of the tension maps of two results, over the largest tension. Except for a few points, the times
/// of the largest tension must agree.
fn maps_apart(path: &Path, other: &Path) -> f64 {
    let [file, other] = [path, other].map(|path| hdf5_metno::File::open(path).unwrap());
    let read = |file: &hdf5_metno::File, name: &str| file.dataset(name).unwrap().read_raw::<f64>().unwrap();
    let both = |name: &str| [&file, &other].map(|file| read(file, &format!("stress_map/lower/{name}")));
    let [one, two] = both("time");
    // Adaptive time steps end at other times, because of rounding.
    let end = one.iter().copied().fold(0.0, f64::max);
    let same = one.iter().zip(&two).filter(|(one, two)| (*one - *two).abs() <= RANKS * end).count();
    assert!(10 * same >= 9 * one.len(), "{same} of {} points", one.len());
    let [one, two] = both("tension");
    assert!(one.iter().all(|tension| tension.is_finite()));
    difference(&one, &two)
}

/// The paper's Newton's method keeps its factorisation while it converges, and a restart makes a new one: the results
/// agree to its tolerance.
fn the_full_newton_goes_on_within_its_tolerance() {
    let folder = folder(&BOX.replace("end = 1e-3", "end = 0.05"));
    good(&folder, 0, "run scene.toml -o whole.h5");
    interrupted(&folder, 0, "run scene.toml -o out.h5 --set output.checkpoint_steps=50", "TERM");
    good(&folder, 0, "run scene.toml --restart out.h5");
    // At most 1e-10 of the largest force in each time step, and mostly far less: 3e-13 was seen.
    let apart = check_alike(&folder.path().join("out.h5"), &folder.path().join("whole.h5"), 1e-9);
    println!("the full Newton's method: {apart:e} apart");
}

/// One rank, two, three and one again: nodes are identified by their positions.
fn ranks_may_change() {
    let damper = "\n[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e8\ndamping = 1e4\n";
    for (settings, most) in [("", 3), ("--set body.order=2 --set time.step=", 2), ("--set body.symmetry=auto", 2)] {
        let folder = folder(&scene(damper).replace("end = 0.1", "end = 0.04"));
        good(&folder, 1, &format!("run scene.toml -o whole.h5 {settings}"));
        let line =
            |restart: &str| format!("run scene.toml -o out.h5 {restart} {settings} --set output.checkpoint_steps=200");
        interrupted(&folder, 1, &line(""), "USR1");
        interrupted(&folder, 2, &line("--restart out.h5"), "USR1");
        if most > 2 {
            interrupted(&folder, most, &line("--restart out.h5"), "USR1");
        }
        good(&folder, 1, &line("--restart out.h5"));
        let apart = check_alike(&folder.path().join("out.h5"), &folder.path().join("whole.h5"), RANKS);
        println!("ranks, {settings:?}: {apart:e} apart");
    }
}

/// A small basis is the same on other ranks, except for rounding, and a run can continue there. The last vectors of a
/// larger basis are partly rounding errors, so the run continues only on the number of ranks where the basis was made.
fn a_basis_goes_on_where_it_is_the_same() {
    let damper = "\n[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e8\ndamping = 1e4\n";
    let scene = scene(damper).replace("[4, 4, 1]", "[8, 8, 1]").replace("step = 2e-5", "step = 2e-6");
    let folder = folder(&scene.replace("end = 0.1", "end = 0.02"));
    for (vectors, is_same) in [(10, true), (40, false)] {
        let settings = format!("--set body.reduction={vectors} --set time.scheme=newmark");
        good(&folder, 0, &format!("run scene.toml -o whole.h5 {settings}"));
        interrupted(
            &folder,
            0,
            &format!("run scene.toml -o out.h5 {settings} --set output.checkpoint_steps=2000"),
            "TERM",
        );
        let restart = format!("run scene.toml --restart out.h5 {settings}");
        let tolerance = if is_same {
            good(&folder, 2, &restart);
            RANKS
        } else {
            let before = fs::read(folder.path().join("out.h5")).unwrap();
            let outcome = run(ricochet(folder.path(), 2).args(words(&restart)));
            assert_eq!(outcome.status, Some(4), "{outcome:#?}");
            assert!(
                outcome.stderr.contains("out.checkpoint.h5: the recomputed basis differs from the checkpoint's"),
                "{outcome:#?}"
            );
            assert!(before == fs::read(folder.path().join("out.h5")).unwrap());
            good(&folder, 0, &restart);
            0.0
        };
        let apart = check_alike(&folder.path().join("out.h5"), &folder.path().join("whole.h5"), tolerance);
        println!("{vectors} vectors: {apart:e} apart");
    }
}

/// A restart may have a later end time, and another file for the continuation.
fn the_end_and_the_file_may_change() {
    let folder = folder(&scene(""));
    good(&folder, 0, "run scene.toml -o whole.h5 --set time.end=0.12");
    interrupted(&folder, 0, "run scene.toml -o out.h5 --set output.checkpoint_steps=100", "TERM");
    let before = fs::read(folder.path().join("out.h5")).unwrap();
    good(&folder, 0, "run scene.toml --restart out.h5 -o longer.h5 --set time.end=0.12");
    check_alike(&folder.path().join("longer.h5"), &folder.path().join("whole.h5"), 0.0);
    assert!(before == fs::read(folder.path().join("out.h5")).unwrap(), "the result that was gone on from has changed");
}

/// A run that cannot continue gives the reason in one message, and changes nothing.
fn what_cannot_go_on_says_why() {
    let folder = folder(&scene(""));
    let path = |name: &str| folder.path().join(name);
    refused(&folder, "run scene.toml --restart out.h5", 4, &["out.h5", "No such file"]);
    interrupted(&folder, 0, "run scene.toml -o out.h5 --set output.checkpoint_steps=100", "TERM");
    let whole = [fs::read(path("out.h5")).unwrap(), fs::read(path("out.checkpoint.h5")).unwrap()];
    refused(
        &folder,
        "run scene.toml --restart out.h5 --set body.young=71e9",
        2,
        &["out.checkpoint.h5", "another scene (other values of body.young; `ricochet info out.h5 --scene` shows it)"],
    );
    refused(&folder, "run scene.toml --restart out.h5 --set time.step=1e-5", 2, &["another scene"]);
    for (line, why) in [
        ("run out.checkpoint.h5 -o more.h5", "is a checkpoint: give the result that it lies beside"),
        ("info out.checkpoint.h5", "is a checkpoint: give the result that it lies beside"),
        ("plot out.checkpoint.h5 -o more.svg", "is a checkpoint: give the result that it lies beside"),
    ] {
        let outcome = run(ricochet(folder.path(), 0).args(words(line)));
        assert_eq!(outcome.status, Some(4), "{outcome:#?}");
        assert!(outcome.stderr.contains(why), "{line}: {outcome:#?}");
    }
    // The file is cut at every kind of place: in the superblock, in the headers, in the numbers, just before the end.
    let length = whole[1].len();
    for part in [0, 4, 100, 800, length / 8, length / 3, length / 2, length - 3000, length - 8, length - 1] {
        fs::write(path("out.checkpoint.h5"), &whole[1][..part]).unwrap();
        refused(&folder, "run scene.toml --restart out.h5", 4, &["out.checkpoint.h5", "is no whole checkpoint"]);
    }
    fs::write(path("out.checkpoint.h5"), &whole[1]).unwrap();
    fs::write(path("out.h5"), &whole[0][..whole[0].len() / 2]).unwrap();
    refused(&folder, "run scene.toml --restart out.h5", 4, &["out.h5"]);
    fs::write(path("out.h5"), &whole[0]).unwrap();
    good(&folder, 0, "run scene.toml --restart out.h5");
    let outcome = good(&folder, 0, "run scene.toml --restart out.h5");
    assert!(outcome.stderr.contains("is complete: there is nothing to continue"), "{outcome:#?}");
}

/// A run that was ended before any checkpoint begins anew. A run in modal coordinates has no checkpoint.
fn without_a_checkpoint_it_begins_anew() {
    let folder = folder(&scene(""));
    good(&folder, 0, "run scene.toml -o whole.h5");
    let mut started = start(ricochet(folder.path(), 0).args(words("run scene.toml -o out.h5")));
    let begin = Instant::now();
    while !folder.path().join("out.h5").exists() {
        assert!(begin.elapsed() < LIMIT);
        std::thread::sleep(Duration::from_millis(1));
    }
    started.child.kill().unwrap();
    started.wait(LIMIT);
    let outcome = good(&folder, 0, "run scene.toml --restart out.h5");
    assert!(outcome.stderr.contains("from the beginning"), "{outcome:#?}");
    check_alike(&folder.path().join("out.h5"), &folder.path().join("whole.h5"), 0.0);
}

/// A result file can be run again, with its PETSc options, and gives the same numbers. It also lists its content.
fn a_result_is_run_again_from_itself() {
    let folder = folder(&scene("").replace("end = 0.1", "end = 0.01"));
    good(&folder, 0, "run scene.toml -o out.h5 --set time.step=1e-5 -- -ksp_type cg -pc_type jacobi -ksp_rtol 1e-11");
    fs::remove_file(folder.path().join("scene.toml")).unwrap();
    good(&folder, 0, "run out.h5 -o again.h5 --stored-options");
    check_alike(&folder.path().join("again.h5"), &folder.path().join("out.h5"), 0.0);
    let outcome = good(&folder, 0, "info again.h5");
    for words in ["Small plate", "complete", "1001 rows", "-ksp_type cg", "contact    0.0000 to "] {
        assert!(outcome.stdout.contains(words), "{words}: {outcome:#?}");
    }
    let scene = good(&folder, 0, "info out.h5 --scene").stdout;
    assert!(scene.contains("step = 1e-5"), "{scene}");
    fs::write(folder.path().join("from.toml"), scene).unwrap();
    good(&folder, 0, "run from.toml -o from.h5 -- -ksp_type cg -pc_type jacobi -ksp_rtol 1e-11");
    check_alike(&folder.path().join("from.h5"), &folder.path().join("out.h5"), 0.0);
    refused(&folder, "run out.h5", 2, &["-o OUT.h5"]);
}

/// If the mesh file has changed since, a result file cannot be run again.
fn a_result_knows_its_mesh() {
    let folder = folder(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500\nmesh = \"plate.msh\"\n[impactor]\nmass = 1\nradius = 0.05\n\
         young = 210e9\npoisson = 0.3\nspeed = 1\npoint = [0, 0, 0.5]\n[time]\nend = 1e-4\nstep = 1e-5\nscheme = \"newmark\"\n\
         [contact]\nlocalization = \"point\"\n",
    );
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes");
    fs::copy(meshes.join("block-hex.msh"), folder.path().join("plate.msh")).unwrap();
    good(&folder, 0, "run scene.toml -o out.h5");
    fs::create_dir(folder.path().join("elsewhere")).unwrap();
    fs::rename(folder.path().join("out.h5"), folder.path().join("elsewhere/out.h5")).unwrap();
    good(&folder, 0, "run elsewhere/out.h5 -o again.h5");
    check_alike(&folder.path().join("again.h5"), &folder.path().join("elsewhere/out.h5"), 0.0);
    // Also from another folder, and as a sweep.
    for line in ["run out.h5 -o again.h5", "sweep out.h5 --vary impactor.speed=1,2 -o speeds.h5"] {
        let outcome = run(ricochet(&folder.path().join("elsewhere"), 0).args(words(line)));
        assert_eq!(outcome.status, Some(0), "{line}: {outcome:#?}");
    }
    let mut text = fs::read(folder.path().join("plate.msh")).unwrap();
    text.push(b'\n');
    fs::write(folder.path().join("plate.msh"), text).unwrap();
    refused(&folder, "run elsewhere/out.h5 -o again.h5", 2, &["plate.msh", "out.h5"]);
}

/// Of two runs with the same output the second is refused, whatever the first is doing.
fn one_run_at_a_time_writes_a_result() {
    let folder = folder(&scene("").replace("end = 0.1", "end = 10"));
    let line = "run scene.toml -o out.h5";
    let started = start(ricochet(folder.path(), 2).args(words(line)));
    let begin = Instant::now();
    while !folder.path().join(".out.h5.lock").exists() {
        assert!(begin.elapsed() < LIMIT);
        std::thread::sleep(Duration::from_millis(1));
    }
    refused(&folder, line, 4, &["out.h5", "another run"]);
    refused(&folder, "run scene.toml --restart out.h5", 4, &["out.h5", "another run"]);
    while !folder.path().join("out.h5").exists() {
        assert!(begin.elapsed() < LIMIT);
        std::thread::sleep(Duration::from_millis(1));
    }
    send("USR1", &started.child.id().to_string());
    assert_eq!(started.wait(LIMIT).status, Some(130));
    assert!(!folder.path().join(".out.h5.lock").exists());
    good(&folder, 0, "run scene.toml -o out.h5 --set time.end=1e-3 --force");
}
