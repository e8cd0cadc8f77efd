//! Tests of successful runs of the program.

use crate::bad_meshes;
use crate::results;
use mpi_test::{PlainTest, tests};
use std::fs;
use std::path::PathBuf;
use std::process::Command;
use std::time::Duration;

use crate::program::{BOX, LIMIT, ricochet, run, start};
use crate::results::{column, difference, folder, good, is_complete, long, number, text, words};

pub const TESTS: &[PlainTest] = tests![
    a_result_tells_where_it_comes_from,
    ranks_agree,
    mesh_formats_agree,
    check_and_run_agree_on_unknowns_and_memory,
    figures_are_made,
    help_and_version,
    a_terminal_shows_a_bar,
    a_reader_who_leaves_early_is_no_error
];

/// Number of time steps of [`BOX`].
const STEPS: usize = 50;

fn a_result_tells_where_it_comes_from() {
    let folder = folder(BOX);
    let line = "run scene.toml --set output.every=7 --set impactor.speed=2 -- -snes_rtol 0 -snes_maxit 9";
    let outcome = good(&folder, 2, line);
    assert!(outcome.stdout.contains("peak acceleration") && outcome.stdout.contains("scene.h5"), "{outcome:#?}");
    // A misspelt option gives a warning, and the run continues.
    assert!(outcome.stderr.contains("WARN PETSc has not used the option -snes_maxit\n"), "{outcome:#?}");
    assert!(!outcome.stderr.contains('\u{1b}'));
    let file = results::open(folder.path().join("scene.h5"));
    assert_eq!(text(&file, "title"), "Small plate");
    assert_eq!(text(&file, "version"), env!("CARGO_PKG_VERSION"));
    assert!(text(&file, "commit").len() >= 7);
    assert!(text(&file, "petsc_version").starts_with("3."));
    assert!(text(&file, "petsc_options").contains("-snes_rtol 0"));
    assert_eq!((text(&file, "model"), text(&file, "reduction")), ("solid".into(), "none".into()));
    assert_eq!(number::<u64>(&file, "ranks"), 2);
    // 5 × 5 × 2 nodes, and the impactor.
    assert_eq!(number::<u64>(&file, "unknowns"), 151);
    assert!(number::<bool>(&file, "complete"));
    let iterations = number::<u64>(&file, "newton_iterations");
    assert!((STEPS as u64..10 * STEPS as u64).contains(&iterations), "{iterations}");
    let times = ["model", "setup", "steps", "total"].map(|p| number::<f64>(&file, &format!("wall_time_{p}")));
    assert!(times.iter().all(|t| *t > 0.0) && (times[..3].iter().sum::<f64>() - times[3]).abs() < 1e-9, "{times:?}");
    // Every seventh of the steps 0 to 50.
    let time = column(&folder.path().join("scene.h5"), "time");
    assert_eq!(time.len(), 8);
    assert!(time.iter().enumerate().all(|(n, t)| (t - 1.4e-4 * n as f64).abs() < 1e-15), "{time:?}");

    // The stored text is sufficient to repeat the run.
    let again = results::folder(&text(&file, "scene"));
    good(&again, 2, "run scene.toml -o again.h5");
    let [first, second] = [folder.path().join("scene.h5"), again.path().join("again.h5")];
    assert!(difference(&column(&first, "contact/force"), &column(&second, "contact/force")) < 1e-9);
}

fn ranks_agree() {
    let scene = BOX.replace("order = 1", "order = 2").replace("[4, 4, 1]", "[6, 5, 1]")
        + "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\ndamping = 1e4\n";
    let folder = folder(&scene);
    let results: Vec<PathBuf> = (0..=3)
        .map(|ranks| {
            let name = format!("{ranks}.h5");
            good(&folder, ranks, &format!("run scene.toml -o {name}"));
            folder.path().join(name)
        })
        .collect();
    for name in ["contact/force", "impactor/position", "contact/surface_displacement", "energy/elastic"] {
        let alone = column(&results[0], name);
        assert!(alone.iter().any(|x| *x != 0.0), "{name}");
        for other in &results[1..] {
            // The residual is solved to 1e-10 of the force; the rest is rounding that bending amplifies.
            let off = difference(&alone, &column(other, name));
            assert!(off < 1e-7, "{name}: {off:e} in {}", other.display());
        }
    }
}

/// The same tetrahedra in both Gmsh formats. In 2.2 an element also has the number of its geometric entity, which is
/// not a physical group: the bottom is entity 1, and "side" is group 1.
fn mesh_formats_agree() {
    let scene = BOX.replace("size = [0.5, 0.5, 0.02]\ncells = [4, 4, 1]", "mesh = \"mesh.msh\"")
        + "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e12\n";
    let scene = scene.replace("speed = 1", "speed = 1\npoint = [0, 0, 0.5]");
    let forces = ["block-tet22.msh", "block-tet41.msh"].map(|mesh| {
        let folder = folder(&scene);
        fs::write(folder.path().join("mesh.msh"), bad_meshes::sample(mesh)).unwrap();
        good(&folder, 0, "run scene.toml");
        column(&folder.path().join("scene.h5"), "contact/force")
    });
    // If the bottom were supported too, the force would change by 3e-4.
    assert!(difference(&forces[0], &forces[1]) < 1e-9);
}

fn check_and_run_agree_on_unknowns_and_memory() {
    let scene = BOX.replace("order = 1", "order = 2").replace("[4, 4, 1]", "[20, 20, 2]");
    let folder = folder(&scene.replace("end = 1e-3", "end = 1e-4"));
    let said = good(&folder, 0, "check scene.toml").stdout;
    let before = |unit: &str| -> f64 {
        let words: Vec<&str> = said.split(unit).next().unwrap().split_whitespace().collect();
        words[words.len() - 1].parse().unwrap()
    };
    let (unknowns, estimate) = (before(" unknowns"), before(" MB: matrices"));

    // The memory that the program needs for a very small mesh does not belong to the scene.
    let small = results::folder(BOX);
    let own = peak_memory(ricochet(small.path(), 0).args(words("run scene.toml")));
    let all = peak_memory(ricochet(folder.path(), 0).args(words("run scene.toml")));
    let file = results::open(folder.path().join("scene.h5"));
    assert_eq!(number::<u64>(&file, "unknowns") as f64, unknowns + 1.0);
    let ratio = (all - own) / estimate;
    println!("memory: estimated {estimate} MB, measured {all:.0} − {own:.0} MB, ratio {ratio:.2}");
    // The estimate serves to choose a machine: it must be between half and double the measured memory.
    assert!((0.5..2.0).contains(&ratio), "estimated {estimate} MB, measured {all:.0} − {own:.0} MB");
}

/// Peak of the resident memory, MB, sampled until the end.
fn peak_memory(command: &mut Command) -> f64 {
    let mut started = start(command);
    let status = format!("/proc/{}/status", started.child.id());
    let mut peak = 0.0f64;
    while started.child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
        peak = peak.max(kilobytes.unwrap_or(0.0) * 1.024e-3);
        std::thread::sleep(Duration::from_millis(2));
    }
    assert_eq!(started.wait(LIMIT).status, Some(0));
    peak
}

fn figures_are_made() {
    let folder = folder(BOX);
    good(&folder, 0, "run scene.toml");
    good(&folder, 0, "run scene.toml -o other.h5 --set impactor.speed=2");
    good(&folder, 0, "plot scene.h5 other.h5 -o figure.svg");
    good(&folder, 0, "plot scene.h5 -o figure.png");
    let svg = fs::read_to_string(folder.path().join("figure.svg")).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("Small plate (other.h5)"));
    assert!(fs::read(folder.path().join("figure.png")).unwrap().starts_with(b"\x89PNG"));
}

fn help_and_version() {
    let folder = folder(BOX);
    let help = good(&folder, 0, "--help").stdout;
    assert!(["run", "check", "plot"].iter().all(|command| help.contains(&format!("\n  {command} "))), "{help}");
    assert!(good(&folder, 0, "run --help").stdout.contains("--set <KEY=VALUE>"));
    // The version includes the commit, which a test cannot know.
    let version = good(&folder, 0, "--version").stdout;
    assert!(version.starts_with(concat!("ricochet ", env!("CARGO_PKG_VERSION"), " (")), "{version}");
    // One answer, not one from each rank.
    assert_eq!(good(&folder, 2, "--version").stdout.lines().count(), 1);
}

/// The terminal is a pty made by `script` of util-linux.
fn a_terminal_shows_a_bar() {
    let folder = folder(&long().replace("end = 10", "end = 5e-3"));
    let command = format!("{} run scene.toml", env!("CARGO_BIN_EXE_ricochet"));
    let on_terminal = run(Command::new("script")
        .args(["-qec", &command, "/dev/null"])
        .current_dir(folder.path())
        .env("TERM", "xterm")
        .env("OMP_NUM_THREADS", "1"));
    assert_eq!(on_terminal.status, Some(0), "{on_terminal:#?}");
    assert!(on_terminal.stdout.contains(" %, ") && on_terminal.stdout.contains('█'), "{on_terminal:#?}");
    assert!(is_complete(&folder.path().join("scene.h5")));
    let elsewhere = good(&folder, 0, "run scene.toml");
    assert_eq!(elsewhere.told(), "solid: 64 cells of order 1, 486 unknowns\n");
}

fn a_reader_who_leaves_early_is_no_error() {
    let folder = folder(BOX);
    for (arguments, told) in [
        ("check scene.toml", ""),
        ("run scene.toml", "solid: 16 cells of order 1, 150 unknowns\n"),
        ("run missing.toml 2>&1", ""),
    ] {
        let line = format!("'{}' {arguments} | true; exit ${{PIPESTATUS[0]}}", env!("CARGO_BIN_EXE_ricochet"));
        let outcome = run(Command::new("bash").args(["-c", &line]).current_dir(folder.path()));
        let expected = if arguments.contains("missing") { 4 } else { 0 };
        assert_eq!(outcome.status, Some(expected), "{outcome:#?}");
        assert_eq!(outcome.told(), told);
    }
}
