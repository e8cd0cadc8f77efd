//! Files from somebody else are data: what they hold is neither run nor followed, and cannot end the program.

use std::fs;
use std::os::unix::process::CommandExt;
use std::process::Command;
use std::time::{Duration, Instant};

use mpi_test::{PlainTest, tests};

use crate::program::{BOX, LIMIT, ricochet, run, send, start};
use crate::results::{self, change, folder, good, words};
use crate::texts::set_text;

pub const TESTS: &[PlainTest] = tests![
    a_hidden_file_of_options_is_not_read,
    options_in_a_result_are_left_out,
    escapes_are_shown_as_text,
    a_surface_that_is_lost_is_told,
    sizes_beyond_use_are_refused,
    a_scene_has_some_megabytes,
    little_address_space_is_told,
    a_second_signal_ends_at_once,
    a_closed_terminal_ends_a_run_in_order,
    a_sweep_ends_soon,
    damaged_results_end_in_order,
    a_result_is_as_large_as_its_rows
];

/// PETSc would read options from `.petscrc`, and could load a library.
fn a_hidden_file_of_options_is_not_read() {
    let folder = folder(BOX);
    for name in [".petscrc", "petscrc"] {
        fs::write(folder.path().join(name), "-dll_prepend ./evil.so\n-ksp_view ascii:precious.txt\n").unwrap();
    }
    for ranks in [0, 2] {
        let mut command = ricochet(folder.path(), ranks);
        let outcome = run(command.args(words("run scene.toml")).env("HOME", folder.path()));
        assert_eq!(outcome.status, Some(0), "{outcome:#?}");
        assert!(!outcome.stderr.contains("evil") && !folder.path().join("precious.txt").exists(), "{outcome:#?}");
    }
}

/// Options for PETSc that a result was made with are named, and used only if the user says so.
fn options_in_a_result_are_left_out() {
    let folder = folder(BOX);
    good(&folder, 0, "run scene.toml -- -ksp_view ascii:victim.txt");
    let victim = folder.path().join("victim.txt");
    fs::write(&victim, "precious").unwrap();
    let said = good(&folder, 0, "run scene.h5 -o again.h5");
    assert!(said.stderr.contains("are not applied: -ksp_view ascii:victim.txt (`--stored-options`"), "{said:#?}");
    let said = good(&folder, 0, "-q check scene.h5");
    assert!(said.stderr.contains("are not applied"), "{said:#?}");
    let outcome = run(ricochet(folder.path(), 0).args(words("run scene.toml -o plain.h5 --stored-options")));
    assert!(outcome.status == Some(2) && outcome.stderr.contains("not a result"), "{outcome:#?}");
    assert_eq!(fs::read_to_string(&victim).unwrap(), "precious");
    good(&folder, 0, "run scene.h5 -o again.h5 --stored-options");
    good(&folder, 0, "check scene.h5 --stored-options");
    assert_ne!(fs::read_to_string(&victim).unwrap(), "precious");
}

fn escapes_are_shown_as_text() {
    let escape = "A\u{1b}[2J\u{1b}]0;title\u{7}";
    let folder = folder(&BOX.replace("Small plate", "A\\u001b[2J\\u001b]0;title\\u0007"));
    for line in ["check scene.toml", "run scene.toml", "info scene.h5"] {
        let said = good(&folder, 0, line);
        let all = said.stdout.clone() + &said.stderr;
        assert!(!all.contains('\u{1b}') && !all.contains('\u{7}'), "{line}: {all:?}");
        assert!(line.starts_with("run") || all.contains("\\u{1b}[2J"), "{line}: {all:?}");
    }
    // A title is one line, in the direction of its letters.
    fs::write(folder.path().join("scene.toml"), BOX.replace("Small plate", "A\\nerror: B\\u202ethgir")).unwrap();
    let said = good(&folder, 0, "check scene.toml");
    assert!(said.stdout.contains("A error: B\\u{202e}thgir"), "{said:#?}");
    fs::write(folder.path().join("scene.toml"), BOX.replace("Small plate", "A\\u0000B")).unwrap();
    let outcome = run(ricochet(folder.path(), 0).args(words("check scene.toml")));
    assert!(outcome.status == Some(2) && outcome.stderr.contains("NUL"), "{outcome:#?}");
    // Names of files and keys, and the text of a scene beside an error.
    fs::write(folder.path().join(format!("{escape}.toml")), format!("# {escape}\nkey\u{1b}[2J = 1\n")).unwrap();
    let outcome = run(ricochet(folder.path(), 0).args(["check", &format!("{escape}.toml")]));
    assert_eq!(outcome.status, Some(2));
    assert!(!outcome.stderr.contains('\u{1b}') && outcome.stderr.contains("\\u{1b}"), "{:?}", outcome.stderr);
}

/// A strength on a face that the mesh does not have would never be judged, nor a tension on a surface without faces.
fn a_surface_that_is_lost_is_told() {
    let mesh = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/meshes/block-hex.msh")).unwrap();
    // Faces of the surface "bottom" get no group.
    let lost: Vec<String> = mesh
        .lines()
        .map(|line| match line.split(' ').collect::<Vec<_>>()[..] {
            [number, "3", "2", "3", ref rest @ ..] => format!("{number} 3 2 0 {}", rest.join(" ")),
            _ => line.to_owned(),
        })
        .collect();
    let scene = BOX.replace("size = [0.5, 0.5, 0.02]\ncells = [4, 4, 1]\n", "mesh = \"block.msh\"\n");
    let scene =
        scene.replace("symmetry = \"none\"\n", "").replace("speed = 1\n", "speed = 1\npoint = [0.0, 0.0, 0.5]\n");
    let folder = folder(&scene);
    let path = folder.path().join("block.msh");
    fs::write(&path, &mesh).unwrap();
    let strength = "--set strength.face.botom=3e6";
    for line in ["check scene.toml", "limit scene.toml --vary impactor.speed=0.5..1"] {
        let outcome = run(ricochet(folder.path(), 0).args(words(&format!("{line} {strength}"))));
        assert!(outcome.status == Some(2) && outcome.stderr.contains("no surface \"botom\""), "{line}: {outcome:#?}");
    }
    let line = format!("sweep scene.toml --vary impactor.speed=0.5,1 -o s.h5 {strength}");
    let outcome = run(ricochet(folder.path(), 0).args(words(&line)));
    assert!((outcome.stdout.clone() + &outcome.stderr).contains("no surface \"botom\""), "{outcome:#?}");
    let check = "check scene.toml --set strength.tension=3e6";
    let said = good(&folder, 0, check);
    assert!(
        !said.stdout.contains("no stresses are read") && !said.stdout.contains("named surfaces alone"),
        "{said:#?}"
    );
    assert!(lost.iter().any(|line| line.contains(" 3 2 0 ")));
    fs::write(&path, lost.join("\n") + "\n").unwrap();
    let said = good(&folder, 0, check);
    for told in ["the surface \"bottom\" has no faces", "named surfaces alone, which have 5.0000 m2 of 6.0000 m2"] {
        assert!(said.stdout.contains(told), "{told}: {said:#?}");
    }
}

/// `check` answers within seconds, or refuses.
fn sizes_beyond_use_are_refused() {
    let supports = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\n".repeat(2000);
    let terms: Vec<String> = (1..=1000).map(|n| format!("{{ modulus = 1e3, time = {n}e-6 }}")).collect();
    let relaxing = format!(
        "[body]\nsize = [0.3, 0.3]\n[[body.layer]]\nthickness = 0.008\nmaterial = \"pvb\"\n[material.pvb]\nbulk = 2e9\nshear = 1e6\n\
         density = 1100.0\nprony = [{}]\n[impactor]\nmass = 1.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 2.0\n\
         [time]\nend = 1e-3\n",
        terms.join(", ")
    );
    for (scene, told) in [(format!("{BOX}{supports}"), "2000 supports"), (relaxing, "1000 terms")] {
        let folder = folder(&scene);
        let outcome = start(ricochet(folder.path(), 0).args(words("check scene.toml"))).wait(Duration::from_secs(30));
        assert_eq!(outcome.status, Some(2), "{outcome:#?}");
        assert!(outcome.stderr.contains(told), "{outcome:#?}");
    }
}

fn a_scene_has_some_megabytes() {
    let folder = folder(&format!("{BOX}# {}\n", "x".repeat(5 << 20)));
    let outcome = run(ricochet(folder.path(), 0).args(words("check scene.toml")));
    assert!(outcome.status == Some(4) && outcome.stderr.contains("more than 4 MB"), "{outcome:#?}");
    let outcome = run(ricochet(folder.path(), 0).args(words("check /dev/zero")));
    assert_eq!(outcome.status, Some(4), "{outcome:#?}");
}

/// OpenBLAS would wait for memory for ever.
fn little_address_space_is_told() {
    let folder = folder(BOX);
    for limit in ["-v 400000", "-v 700000", "-v 1000000", "-d 150000"] {
        let program = env!("CARGO_BIN_EXE_ricochet");
        let line = format!("ulimit {limit}; exec {program} run scene.toml");
        let mut command = Command::new("sh");
        command.args(["-c", &line]).current_dir(folder.path()).env("OMP_NUM_THREADS", "1");
        let outcome = start(&mut command).wait(Duration::from_secs(60));
        assert_eq!(outcome.status, Some(3), "{limit}: {outcome:#?}");
        assert!(outcome.stderr.contains("ulimit"), "{limit}: {outcome:#?}");
    }
}

/// Starts a run and waits for its first row.
fn begun(folder: &tempfile::TempDir) -> crate::program::Started {
    let started = start(ricochet(folder.path(), 0).args(words("run scene.toml")));
    let begin = Instant::now();
    while !folder.path().join("scene.h5").exists() {
        assert!(begin.elapsed() < LIMIT, "no result: {}", started.said());
        std::thread::sleep(Duration::from_millis(5));
    }
    started
}

/// A run of large steps, each of which takes seconds: it ends in order after the step, and at once after a second signal.
fn a_second_signal_ends_at_once() {
    let scene = results::long().replace("[8, 8, 1]", "[40, 40, 4]").replace("order = 1", "order = 2");
    let folder = folder(&scene);
    let started = begun(&folder);
    let process = started.child.id().to_string();
    send("TERM", &process);
    // Two signals at once may be one to the process.
    std::thread::sleep(Duration::from_millis(200));
    send("TERM", &process);
    let begin = Instant::now();
    let outcome = started.wait(LIMIT);
    assert_eq!(outcome.status, Some(130), "{outcome:#?}");
    // One step takes seconds; the end of the process takes far less.
    assert!(begin.elapsed() < Duration::from_secs(2), "{:?}", begin.elapsed());
    let left: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().contains("lock")), "{left:?}");
}

/// SIGHUP is obeyed like SIGTERM, but not by a run that was started to outlive its terminal.
fn a_closed_terminal_ends_a_run_in_order() {
    let folder = folder(&results::long());
    let started = begun(&folder);
    send("HUP", &started.child.id().to_string());
    let outcome = started.wait(LIMIT);
    assert_eq!(outcome.status, Some(130), "{outcome:#?}");
    assert!(folder.path().join("scene.checkpoint.h5").exists());
    let program = env!("CARGO_BIN_EXE_ricochet");
    let mut command = Command::new("sh");
    let line = format!("trap '' HUP; exec {program} run scene.toml -o nohup.h5 --set time.end=2e-3");
    command.args(["-c", &line]).current_dir(folder.path()).env("OMP_NUM_THREADS", "1").process_group(0);
    let started = start(&mut command);
    std::thread::sleep(Duration::from_millis(200));
    let libraries = fs::read_to_string(format!("/proc/{}/maps", started.child.id())).unwrap();
    send("HUP", &started.child.id().to_string());
    let status = started.wait(LIMIT).status;
    // UCX, which Open MPI 5 loads, takes SIGHUP for itself before the program begins: that it was ignored is lost.
    assert!(status == Some(0) || libraries.contains("libucs") && status == Some(130), "{status:?}");
}

/// Between two looks at the signal, a sweep may make the model of a member for a minute: it does not wait for that.
fn a_sweep_ends_soon() {
    let folder = folder(&results::pane());
    let line = "sweep scene.toml --vary impactor.speed=1..8:4 -o s.h5 --set accuracy.tolerance=1e-3";
    let started = start(ricochet(folder.path(), 0).args(words(line)));
    let begin = Instant::now();
    while !folder.path().join("s.h5").exists() {
        assert!(begin.elapsed() < LIMIT, "no result: {}", started.said());
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(500));
    send("TERM", &started.child.id().to_string());
    let begin = Instant::now();
    let outcome = started.wait(LIMIT);
    assert_eq!(outcome.status, Some(130), "{outcome:#?}");
    assert!(begin.elapsed() < Duration::from_secs(10), "{:?}", begin.elapsed());
}

/// Changed bytes in results of a run, a sweep and a checkpoint: each command ends by itself, soon, with one of its own
/// statuses, and with little memory.
fn damaged_results_end_in_order() {
    let folder = folder(BOX);
    let fields = "--set output.fields=10 --set output.checkpoint_steps=20";
    good(&folder, 0, &format!("run scene.toml -o run.h5 {fields}"));
    good(&folder, 0, "sweep scene.toml --vary impactor.speed=1..2:3 -o sweep.h5 --series");
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = move |below: usize| {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed % below as u64) as usize
    };
    for (name, commands) in [("run.h5", &["info", "report", "plot", "run"][..]), ("sweep.h5", &["info", "plot"])] {
        let whole = fs::read(folder.path().join(name)).unwrap();
        for round in 0..12 {
            let mut bytes = whole.clone();
            for _ in 0..=random(8) {
                // Most of what a reader can stumble over is at the beginning.
                let place = random(if round % 2 == 0 { bytes.len().min(12_288) } else { bytes.len() });
                bytes[place] = random(256) as u8;
            }
            fs::write(folder.path().join("damaged.h5"), &bytes).unwrap();
            let command = commands[round % commands.len()];
            let output = match command {
                "info" => "",
                "report" => "-o x.html",
                "plot" => "-o x.svg",
                _ => "-o x.h5",
            };
            let program = env!("CARGO_BIN_EXE_ricochet");
            let line = format!("ulimit -v 3000000; exec {program} {command} damaged.h5 {output}");
            let mut process = Command::new("sh");
            process.args(["-c", &line]).current_dir(folder.path()).env("OMP_NUM_THREADS", "1");
            let outcome = start(&mut process).wait(Duration::from_secs(60));
            let is_known = matches!(outcome.status, Some(0 | 2 | 3 | 4));
            assert!(is_known && !outcome.stderr.contains("panicked"), "{name} {round} {command}: {outcome:#?}");
        }
    }
    // A text that is not UTF-8, which a changed byte may make.
    change(&folder.path().join("run.h5"), |file| set_text(file, "title", "\u{e4}"));
    let path = folder.path().join("run.h5");
    let mut bytes = fs::read(&path).unwrap();
    let places: Vec<usize> = (0..bytes.len() - 1).filter(|at| bytes[*at..*at + 2] == [0xc3, 0xa4]).collect();
    places.iter().for_each(|at| bytes[*at] = 0x20);
    fs::write(&path, bytes).unwrap();
    for line in ["info run.h5", "report run.h5 -o x.html"] {
        let outcome = run(ricochet(folder.path(), 0).args(words(line)));
        // The checksum of the changed part, or the text itself, tells it.
        assert!(matches!(outcome.status, Some(0 | 4)) && !outcome.stderr.contains("panicked"), "{outcome:#?}");
    }
}

/// The rows of a run are not known before its end: no room is kept for thousands.
fn a_result_is_as_large_as_its_rows() {
    let folder = tempfile::tempdir().unwrap();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/pane.toml");
    good(&folder, 0, &format!("run {scene} -o pane.h5"));
    let size = fs::metadata(folder.path().join("pane.h5")).unwrap().len();
    assert!(size < 600_000, "{size} bytes");
}
