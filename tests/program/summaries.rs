//! Tests of the summaries that `run` and `info` print of a result.

use std::fs;

use mpi_test::{PlainTest, tests};
use serde_json::Value;

use crate::glass::{scene, sides};
use crate::program::{BOX, ricochet, run};
use crate::restarts::refused;
use crate::results::{column, folder, good, number, open, pane, text, words};

pub const TESTS: &[PlainTest] = tests![
    the_largest_values_are_those_of_the_series,
    large_deflections_are_warned_of,
    a_sweep_repeats_the_warnings_of_its_members,
    quiet_runs_say_nothing_but_warnings,
    a_run_by_default_keeps_off_the_result_of_another_scene,
    warnings_are_kept_with_the_result,
    useless_numbers_are_told,
    nothing_is_estimated_without_a_contact,
    completions_schema_and_manual,
];

fn the_largest_values_are_those_of_the_series() {
    let probes = "[output]\nprobes = [{ name = \"below\", point = [0.1, 0, -0.01] }]\n";
    let folder = folder(&(BOX.to_owned() + probes));
    let said = good(&folder, 2, "run scene.toml -o out.h5").stdout;
    let facts: Value = serde_json::from_str(&good(&folder, 0, "info --json out.h5").stdout).unwrap();
    let path = folder.path().join("out.h5");
    let largest = &facts["largest"];
    let time = column(&path, "time");
    let check = |found: &Value, values: &[f64]| {
        let row = time.iter().position(|time| found["time"] == *time).expect("a time of the series");
        assert_eq!(found["value"], values[row]);
        assert!(values.iter().all(|value| value.abs() <= values[row].abs()), "{found}");
    };
    check(&largest["acceleration"], &column(&path, "impactor/acceleration"));
    check(&largest["force"], &column(&path, "contact/force"));
    check(&largest["deflection"], &column(&path, "contact/surface_displacement"));
    let probe = &largest["probes"][0];
    assert_eq!(probe["name"], "below");
    let rows = |name: &str| {
        let file = open(&path);
        let rows = file.dataset(&format!("series/probe/below/{name}")).unwrap().read_raw::<f64>().unwrap();
        rows.chunks_exact(3).map(<[f64]>::to_vec).collect::<Vec<_>>()
    };
    let length = |row: &Vec<f64>| row.iter().map(|x| x * x).sum::<f64>().sqrt();
    check(&probe["displacement"], &rows("displacement").iter().map(length).collect::<Vec<_>>());
    let tension = rows("principal_stress").iter().map(|row| row[0]).fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(probe["tension"]["value"], tension);
    let text = good(&folder, 0, "info out.h5").stdout;
    for line in said.lines().filter(|line| line.starts_with("peak force") || line.starts_with("probe")) {
        assert!(text.contains(line), "{line} is not in {text}");
    }
    assert!(said.contains("peak force ") && said.contains("probe \"below\": displacement "), "{said}");
    // Contacts store their peak whatever rows are recorded. (The deflection is that of a row; in the first it is zero.)
    let rare = good(&folder, 0, "run scene.toml -o rare.h5 --set output.every=1000").stdout;
    let force = |text: &str| {
        text.split("peak force ").nth(1).and_then(|rest| rest.split([';', '\n']).next()).map(str::to_owned)
    };
    assert_eq!(force(&rare), force(&said));
}

/// Large deflections give a warning: a thin plate, supported at its edges, that deflects by more than its thickness.
/// There is none for the same plate made thick, and for a free box that flies away or moves on soft springs. A plate held
/// at one edge is not said to be held in its plane.
fn large_deflections_are_warned_of() {
    let pane = pane().replace("tolerance = 1e-2", "tolerance = 1e-1").replace("end = 1e-3", "end = 0.02");
    let free = pane.split("[[support]]").next().unwrap();
    let on_soft_springs = pane.replace("5e8", "1e5");
    let at_one_edge = format!("{free}[[support]]\nsurface = \"x-min\"\nkind = \"clamped\"\n");
    for (scene, size, is_large) in [
        (pane.as_str(), 0.008, true),
        (&pane, 0.05, false),
        (free, 0.05, false),
        (&on_soft_springs, 0.05, false),
        (&at_one_edge, 0.008, true),
    ] {
        let small = scene.replace("[1.0, 1.5, 0.008]", &format!("[0.5, 0.5, {size}]"));
        let folder = folder(&small);
        let outcome = run(ricochet(folder.path(), 0).args(words("run scene.toml -o out.h5")));
        assert_eq!(outcome.status, Some(0), "{outcome:#?}");
        let largest =
            column(&folder.path().join("out.h5"), "contact/surface_displacement").into_iter().fold(0.0, f64::max);
        // The free box and the one on soft springs move by more than half of their thickness too, but do not bend.
        assert_eq!(largest > 0.5 * size, scene != pane || is_large, "{largest} m");
        let is_warned = outcome.stderr.contains("the model is geometrically linear: it neglects membrane forces");
        assert_eq!(is_warned, is_large, "{largest} m: {outcome:#?}");
        assert_eq!(outcome.stderr.contains("where they cannot"), is_large && scene != at_one_edge, "{outcome:#?}");
    }
}

/// A sweep repeats each warning of its runs once, with the member that it concerns most.
fn a_sweep_repeats_the_warnings_of_its_members() {
    let pane = pane().replace("tolerance = 1e-2", "tolerance = 1e-1").replace("end = 1e-3", "end = 0.02");
    let folder = folder(&pane.replace("[1.0, 1.5, 0.008]", "[0.5, 0.5, 0.008]"));
    let line =
        "sweep scene.toml --vary impactor.speed=0.1,8,7 --vary output.every=1,2 -o s.h5 --set impactor.young=210e4";
    let outcome = good(&folder, 0, line);
    let told = |start: &str, part: &str| {
        outcome.stderr.lines().filter(|line| line.starts_with(start) && line.contains(part)).count()
    };
    let most =
        "warning: 4 of 6 members, most of all member 2: impactor.speed=8, output.every=1: the body bends by about";
    assert_eq!((told(most, "membrane forces"), told("warning: ", "the body bends by")), (1, 1), "{outcome:#?}");
    assert_eq!(told("note: --vary output.every has no effect", ""), 1, "{outcome:#?}");
    let rough = good(
        &folder,
        0,
        &line.replace("s.h5", "rough.h5 --set body.reduction=4 --set body.model=mindlin --set accuracy.tolerance=1e-4"),
    );
    assert!(rough.stderr.contains("the estimated error in the first contact is "), "{rough:#?}");
    // The soft impactor is still being decelerated at this end.
    let short = good(&folder, 0, &line.replace("s.h5", "short.h5 --set time.end=1e-4"));
    let end = "warning: 6 of 6 members, most of all member 2: impactor.speed=8, output.every=1: the force is the largest at the end";
    assert!(short.stderr.contains(end), "{short:#?}");
    // Edges that cannot move in the plane are known.
    let clamped = line.replace("s.h5", "clamped.h5 --set support.0.kind=clamped --set support.0.stiffness=");
    let clamped = good(&folder, 0, &clamped);
    assert!(clamped.stderr.contains("since its edges cannot move in the plane"), "{clamped:#?}");
    // A wrong unit in the scene concerns all members.
    let odd = good(&folder, 0, "sweep scene.toml --vary impactor.speed=0.1,0.2 -o odd.h5 --set impactor.young=210");
    let unit = odd
        .stderr
        .lines()
        .filter(|line| line.contains("warning: 2 of 2 members") && line.contains("softer than rubber"));
    assert_eq!(unit.count(), 1, "{odd:#?}");
}

fn quiet_runs_say_nothing_but_warnings() {
    let folder = folder(BOX);
    let usual = good(&folder, 0, "run scene.toml -o out.h5");
    let quiet = good(&folder, 0, "run --quiet scene.toml -o out.h5");
    assert!(!usual.stderr.is_empty() && quiet.stderr.is_empty(), "{quiet:#?}");
    assert_eq!(quiet.stdout.lines().count(), usual.stdout.lines().count());
    let verbose = good(&folder, 0, "-v run scene.toml -o out.h5");
    assert!(verbose.stderr.lines().count() > usual.stderr.lines().count(), "{verbose:#?}");
    refused(&folder, "run -q -v scene.toml", 2, &["--quiet", "--verbose"]);
}

fn a_run_by_default_keeps_off_the_result_of_another_scene() {
    let folder = folder("");
    for name in ["a", "b"] {
        fs::create_dir(folder.path().join(name)).unwrap();
        fs::write(folder.path().join(name).join("plate.toml"), BOX).unwrap();
    }
    good(&folder, 0, "run a/plate.toml");
    let before = fs::read(folder.path().join("plate.h5")).unwrap();
    refused(
        &folder,
        "run b/plate.toml",
        4,
        &["plate.h5: holds the result of another scene", "-o names this one's result"],
    );
    assert!(fs::read(folder.path().join("plate.h5")).unwrap() == before);
    // The same scene by another path, and by name.
    good(&folder, 0, "run ./b/../a/plate.toml");
    good(&folder, 0, "run b/plate.toml -o plate.h5");
}

fn completions_schema_and_manual() {
    let folder = folder(BOX);
    for shell in ["bash", "zsh", "fish"] {
        assert!(good(&folder, 0, &format!("completions {shell}")).stdout.contains("stability"), "{shell}");
    }
    let schema: Value = serde_json::from_str(&good(&folder, 0, "schema").stdout).unwrap();
    assert_eq!(schema["required"], serde_json::json!(["body", "impactor", "time"]));
    good(&folder, 0, "man -o pages");
    let page = fs::read_to_string(folder.path().join("pages/ricochet-run.1")).unwrap();
    assert!(page.contains(".TH ricochet-run 1") && page.contains("restart"), "{page}");
    good(&folder, 0, "man -o pages");
    // Files that are not from this program stay.
    fs::write(folder.path().join("pages/ricochet-run.1"), "my notes").unwrap();
    fs::write(folder.path().join("pages/stability.csv"), "my table").unwrap();
    for (line, why) in [
        ("man -o pages", "pages/ricochet-run.1: is no page of this manual, so it is not replaced"),
        ("stability scene.toml -o pages", "pages: has a file stability.csv that is not of this program"),
    ] {
        let outcome = run(ricochet(folder.path(), 0).args(words(line)));
        assert_eq!((outcome.status, outcome.stderr.contains(why)), (Some(4), true), "{outcome:#?}");
    }
}

/// A pane of 0.5 m by 0.5 m on springs, hit by an impactor of 20 kg at 3 m/s.
fn heavy(thickness: f64, end: f64, tolerance: f64) -> String {
    let rest = format!("{}[accuracy]\ntolerance = {tolerance:?}\n", sides(1e9, 0.0));
    let body = format!("size = [0.5, 0.5, {thickness:?}]");
    scene(&body, "mass = 20.0\nspeed = 3.0", &format!("end = {end:?}"), &rest)
}

/// All warnings and notes that a run prints are in its result, and in what `info` and `report` say of it, even if the
/// notes were not printed.
fn warnings_are_kept_with_the_result() {
    let folder = folder(&heavy(0.005, 2e-3, 1e-3));
    let said = good(&folder, 0, "run scene.toml -o out.h5").stderr;
    let is_remark = |line: &&str| line.starts_with("warning: ") || line.starts_with("note: ");
    let remarks: Vec<&str> = said.lines().filter(is_remark).collect();
    assert!(remarks.iter().any(|line| line.starts_with("warning: ")) && remarks.len() > 1, "{said}");
    assert_eq!(text(&open(folder.path().join("out.h5")), "warnings"), remarks.join("\n"));
    good(&folder, 2, "run scene.toml -o quiet.h5 -q");
    let facts: Value = serde_json::from_str(&good(&folder, 0, "info --json quiet.h5").stdout).unwrap();
    assert_eq!(facts["warnings"], serde_json::json!(remarks));
    let info = good(&folder, 0, "info quiet.h5").stdout;
    good(&folder, 0, "report quiet.h5 -o quiet.html");
    let page = fs::read_to_string(folder.path().join("quiet.html")).unwrap();
    for remark in remarks {
        assert!(info.contains(remark), "{remark}: {info}");
        // Without its first letter, which is a capital there, and up to the first sign that HTML writes otherwise.
        let text = remark.split_once(": ").unwrap().1;
        let plain = text[1..].split(['"', '\'', '<', '>', '&']).next().unwrap();
        assert!(page.contains(plain), "{plain}");
    }
}

/// The largest force is in a later contact, where the histories on two bases differ: it is of no use, although the first
/// contact is good. The result is written, and --force accepts it. In a run that ends before, and in one whose largest
/// force is in the first contact, the number holds.
fn useless_numbers_are_told() {
    let folder = folder(&heavy(0.015, 0.006, 0.4));
    let outcome = run(ricochet(folder.path(), 0).args(words("run scene.toml -o out.h5")));
    assert_eq!(outcome.status, Some(3), "{outcome:#?}");
    assert!(outcome.stderr.contains("of no use") && outcome.stderr.contains("peak force"), "{outcome:#?}");
    let file = open(folder.path().join("out.h5"));
    let [history, first] = ["error_estimate", "first_contact_error"].map(|name| number::<f64>(&file, name));
    assert!(history > 0.5 && first < 0.4 && number::<bool>(&file, "complete"), "{history} {first}");
    good(&folder, 0, "report out.h5 -o out.html");
    let page = fs::read_to_string(folder.path().join("out.html")).unwrap();
    assert!(page.contains("<span aria-hidden=\"true\">!</span> Numbers of no use."), "no sign");
    let forced = good(&folder, 2, "run scene.toml -o forced.h5 --force");
    assert_eq!(forced.stderr.matches("of no use").count(), 1, "{forced:#?}");
    good(&folder, 0, "run scene.toml -o short.h5 --set time.end=1e-3");
    good(&folder, 0, "run scene.toml -o light.h5 --set impactor.mass=1");
}

/// Where nothing was hit, there is no error, not even a small one.
fn nothing_is_estimated_without_a_contact() {
    for more in ["", " --set body.model=half-space", " --set body.model=mindlin --set time.step=1e-5"] {
        let folder = folder(&heavy(0.02, 2e-3, 1e-2));
        let said = good(&folder, 0, &format!("run scene.toml -o out.h5 --set impactor.gap=1{more}"));
        assert!(said.stdout.contains("contacts: none") && !said.stdout.contains("estimated error"), "{said:#?}");
        assert!(number::<f64>(&open(folder.path().join("out.h5")), "error_estimate").is_nan());
    }
}
