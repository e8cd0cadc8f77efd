//! Tests of the files next to a result: to which result they belong, and which of them a restart refuses or leaves
//! unchanged.

use crate::results;
use mpi_test::{PlainTest, tests};
use std::fs;
use std::io::Write;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::program::{LIMIT, ricochet, run, start};
use crate::restarts::{check_alike, interrupted, killed, refused, scene};
use crate::results::{column, folder, good, is_complete, words};
use hdf5_metno as hdf5;
use ricochet::record::provenance::digest;
use tempfile::TempDir;

pub const TESTS: &[PlainTest] = tests![
    a_checkpoint_goes_with_its_result,
    fields_go_on_without_a_new_frame,
    a_restart_that_fails_replaces_nothing,
    a_complete_run_is_done_only_where_nothing_else_is_wanted,
    an_end_at_the_checkpoint_and_one_before_it,
    another_mesh_and_other_options,
    results_share_nothing_but_links,
    parts_of_killed_runs_are_cleared
];

/// Names of the files in a folder except the scene.
fn names(folder: &TempDir) -> Vec<String> {
    let entries = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut all: Vec<_> = entries.filter(|name| name != "scene.toml").collect();
    all.sort();
    all
}

/// Contents of the files in a folder, except the scene and the remains of killed runs, which the next run removes.
fn files(folder: &TempDir) -> Vec<(String, Vec<u8>)> {
    let shown = names(folder).into_iter().filter(|name| !name.starts_with('.'));
    shown.map(|name| (name.clone(), fs::read(folder.path().join(name)).unwrap())).collect()
}

/// The checkpoint of an older run is removed when the new run's result replaces the old one, and not before. A
/// checkpoint next to the result of another run is refused.
fn a_checkpoint_goes_with_its_result() {
    let folder = folder(&scene(""));
    let path = |name: &str| folder.path().join(name);
    interrupted(&folder, 0, "run scene.toml -o out.h5 --set output.checkpoint_steps=100", "TERM");
    let older = files(&folder);
    // This run fails before its first time step.
    let outcome = run(ricochet(folder.path(), 0).args(words("run scene.toml -o out.h5 --force -- -ksp_type nonsense")));
    assert_eq!(outcome.status, Some(2), "{outcome:#?}");
    assert!(files(&folder) == older);

    let started = |line: &str| {
        let before = fs::read(path("out.h5")).unwrap();
        let mut started = start(ricochet(folder.path(), 0).args(words(line)));
        let begin = Instant::now();
        while fs::read(path("out.h5")).unwrap() == before {
            assert!(begin.elapsed() < LIMIT, "no first row");
            std::thread::sleep(Duration::from_millis(1));
        }
        started.child.kill().unwrap();
        assert_eq!(started.wait(LIMIT).signal, Some(9));
    };
    started("run scene.toml -o out.h5 --force --set output.every=10 --set time.end=10");
    assert!(!path("out.checkpoint.h5").exists());
    fs::write(path("out.checkpoint.h5"), &older[0].1).unwrap();
    refused(&folder, "run scene.toml --restart out.h5", 4, &["out.checkpoint.h5", "is of another run than out.h5"]);
    fs::remove_file(path("out.checkpoint.h5")).unwrap();
    let outcome = good(&folder, 0, "run scene.toml --restart out.h5");
    assert!(outcome.stderr.contains("from the beginning"), "{outcome:#?}");
    assert!(column(&path("out.h5"), "time").windows(2).all(|pair| pair[1] > pair[0]));
}

/// Fields continue even if no frame follows the checkpoint: in the same file, cut to the frames up to the checkpoint,
/// and in another file.
fn fields_go_on_without_a_new_frame() {
    let folder = folder(&scene("\n[output]\nfields = 100\n").replace("end = 0.1", "end = 10"));
    let time = killed(&folder, "run scene.toml -o out.h5 --set output.checkpoint_steps=1010");
    let steps = (time / 2e-5).round() as usize;
    // Five time steps later, before the next hundred.
    let end = format!("--set time.end={:e}", (steps + 5) as f64 * 2e-5);
    good(&folder, 0, &format!("run scene.toml -o whole.h5 {end}"));
    good(&folder, 0, &format!("run scene.toml --restart out.h5 -o more.h5 {end}"));
    good(&folder, 0, &format!("run scene.toml --restart out.h5 {end}"));
    for name in ["more", "out"] {
        let [path, whole] = [name, "whole"].map(|name| folder.path().join(format!("{name}.h5")));
        check_alike(&path, &whole, 0.0);
        let [part, whole] = [path, whole].map(results::open);
        for dataset in ["fields/Steps/Values", "VTKHDF/PointData/displacement", "fields/PointData/principal_stress"] {
            let [part, whole]: [Vec<f64>; 2] =
                [&part, &whole].map(|file| file.dataset(dataset).unwrap().read_raw().unwrap());
            assert!(part == whole, "{name}: {dataset}: {} and {} values", part.len(), whole.len());
        }
        let frames = part.group("fields/Steps").unwrap().attr("NSteps").unwrap().read_scalar::<i64>().unwrap();
        assert_eq!(frames as usize, steps / 100 + 1);
        let text = fs::read_to_string(folder.path().join(format!("{name}.xdmf"))).unwrap();
        assert_eq!(text.matches("<Time ").count(), frames as usize);
    }
}

/// A restart that fails before its first time step replaces nothing; the message names the checkpoint.
fn a_restart_that_fails_replaces_nothing() {
    let folder = folder(&scene("\n[output]\nfields = 50\n"));
    for step in ["", "--set time.step= --set time.scheme=newmark"] {
        interrupted(
            &folder,
            0,
            &format!("run scene.toml -o out.h5 --force {step} --set output.checkpoint_steps=100"),
            "TERM",
        );
        let path = folder.path().join("out.checkpoint.h5");
        // A checkpoint of another version: it is sealed, but one of its numbers is missing.
        let whole = fs::read(&path).unwrap();
        fs::write(&path, &whole[..whole.len() - 16]).unwrap();
        let mut name = String::new();
        results::change(&path, |file| {
            let vectors = file.group("vectors").unwrap();
            name = vectors.member_names().unwrap().into_iter().find(|name| name.ends_with("momentum")).unwrap();
            vectors.unlink(&name).unwrap();
        });
        let content = fs::read(&path).unwrap();
        let mut file = fs::OpenOptions::new().append(true).open(&path).unwrap();
        file.write_all(b"ricochet").unwrap();
        file.write_all(&digest(&content).to_le_bytes()).unwrap();
        let before = files(&folder);
        let line = format!("run scene.toml --restart out.h5 {step}");
        refused(&folder, &line, 4, &["out.checkpoint.h5: the checkpoint has no ", &name]);
        assert!(files(&folder) == before, "{:?}", names(&folder));
        refused(&folder, &format!("{line} -o more.h5"), 4, &["out.checkpoint.h5"]);
        assert!(files(&folder) == before, "{:?}", names(&folder));
    }
}

/// Status 0 for a complete run is given only if the command asks for the result that is there.
fn a_complete_run_is_done_only_where_nothing_else_is_wanted() {
    let folder = folder(&scene("").replace("end = 0.1", "end = 1e-3"));
    good(&folder, 0, "run scene.toml -o out.h5");
    let before = files(&folder);
    for (more, said) in [
        ("--set time.end=2e-3", "and a complete run has no checkpoint"),
        ("--set time.end=5e-4", "and a complete run has no checkpoint"),
        ("--set body.young=71e9", "of another scene (other values of body.young"),
        ("--set output.every=2", "of another scene"),
        ("-o more.h5", "more.h5 would be a copy of it"),
    ] {
        refused(&folder, &format!("run scene.toml --restart out.h5 {more}"), 2, &["out.h5 is complete", said]);
    }
    for more in ["", "-o out.h5", "-o ./out.h5", "--set title=x", "--set output.checkpoint_steps=7"] {
        let outcome = good(&folder, 0, &format!("run scene.toml --restart out.h5 {more}"));
        assert!(outcome.stderr.contains("out.h5 is complete: there is nothing to continue"), "{outcome:#?}");
    }
    assert!(files(&folder) == before);
}

/// If the end time equals the checkpoint's time, no step is left, and the summary describes the run. An earlier end
/// time is refused.
fn an_end_at_the_checkpoint_and_one_before_it() {
    let folder = folder(&scene("").replace("end = 0.1", "end = 10"));
    let time = killed(&folder, "run scene.toml -o out.h5 --set output.checkpoint_steps=500");
    let before = files(&folder);
    let early = format!("run scene.toml --restart out.h5 --set time.end={:e}", 0.5 * time);
    refused(&folder, &early, 2, &["out.checkpoint.h5 is at t = ", "beyond the end at "]);
    assert!(files(&folder) == before);
    let end = format!("--set time.end={time:e}");
    let whole = good(&folder, 0, &format!("run scene.toml -o whole.h5 {end}"));
    let outcome = good(&folder, 0, &format!("run scene.toml --restart out.h5 {end}"));
    check_alike(&folder.path().join("out.h5"), &folder.path().join("whole.h5"), 0.0);
    // All lines except the one with the file and its times.
    let lines = |text: &str| text.lines().filter(|line| !line.contains(".h5: ")).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(lines(&outcome.stdout), lines(&whole.stdout));
    assert!(!lines(&whole.stdout).is_empty() && !folder.path().join("out.checkpoint.h5").exists());
}

/// A changed mesh is refused, even with the same nodes; other PETSc options are reported.
fn another_mesh_and_other_options() {
    let folder = folder(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500\nmesh = \"plate.msh\"\n[impactor]\nmass = 1\nradius = 0.05\n\
         young = 210e9\npoisson = 0.3\nspeed = 1\npoint = [0, 0, 0.5]\n[time]\nend = 1\nstep = 1e-5\nscheme = \"newmark\"\n\
         [contact]\nlocalization = \"point\"\n",
    );
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("meshes");
    let mesh = fs::read_to_string(meshes.join("block-hex.msh")).unwrap();
    fs::write(folder.path().join("plate.msh"), &mesh).unwrap();
    let time = killed(&folder, "run scene.toml -o out.h5 --set output.checkpoint_steps=100");
    fs::write(folder.path().join("plate.msh"), mesh.clone() + "\n").unwrap();
    refused(
        &folder,
        "run scene.toml --restart out.h5",
        2,
        &["plate.msh", "is not the one that out.h5 was computed on"],
    );
    fs::write(folder.path().join("plate.msh"), mesh).unwrap();
    let line = format!("run scene.toml --restart out.h5 --set time.end={:e} -- -ksp_max_it 77", 2.0 * time);
    let outcome = good(&folder, 0, &line);
    assert!(outcome.stderr.contains("note: out.h5 was begun with other options for PETSc: "), "{outcome:#?}");
}

/// Results with different names share neither checkpoints nor fields. Links share the file to which they point, and all
/// files next to it.
fn results_share_nothing_but_links() {
    let folder = folder(&scene("\n[output]\nfields = 100\n"));
    let path = |name: &str| folder.path().join(name);
    let until = |name: &str, line: &str| {
        let mut started = start(ricochet(folder.path(), 0).args(words(line)));
        let begin = Instant::now();
        while !path(name).exists() {
            assert!(begin.elapsed() < LIMIT, "no {name}");
            std::thread::sleep(Duration::from_millis(2));
        }
        started.child.kill().unwrap();
        started.wait(LIMIT);
    };
    for name in ["k.1e7", "k.1e8", "k.h5"] {
        let beside = name.trim_end_matches(".h5");
        let line = format!("run scene.toml -o {name} --set output.checkpoint_steps=100 --set time.end=10");
        until(&format!("{beside}.checkpoint.h5"), &line);
        assert!(path(&format!("{beside}.vtkhdf")).exists() && path(&format!("{beside}.xdmf")).exists());
    }
    fs::create_dir(path("links")).unwrap();
    std::os::unix::fs::symlink("../k.h5", path("links/link.h5")).unwrap();
    let outcome = good(&folder, 0, "run scene.toml --restart links/link.h5 --set time.end=0.5");
    assert!(outcome.stderr.contains("continuing from t = "), "{outcome:#?}");
    assert!(is_complete(&path("k.h5")) && fs::read_dir(path("links")).unwrap().count() == 1);
    let file = hdf5::File::open(path("links/link.h5")).unwrap();
    assert!(file.group("fields/Steps").is_ok());
    assert!(!path("k.checkpoint.h5").exists() && path("k.1e7.checkpoint.h5").exists());
}

/// Unfinished files of a killed run are removed by the next run with the same result, and nothing else is.
fn parts_of_killed_runs_are_cleared() {
    let folder = folder(&scene("\n[output]\nfields = 100\n").replace("end = 0.1", "end = 1e-3"));
    for name in [".out.h5.4711.part", ".out.checkpoint.h5.1.part", ".out.vtkhdf.12.part", ".out.xdmf.123.part"] {
        fs::write(folder.path().join(name), "begun").unwrap();
    }
    fs::write(folder.path().join(".other.vtkhdf.12.part"), "another's").unwrap();
    good(&folder, 0, "run scene.toml -o out.h5");
    assert_eq!(names(&folder), [".other.vtkhdf.12.part", "out.h5", "out.vtkhdf", "out.xdmf"]);
}
