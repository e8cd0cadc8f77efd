//! Tests of `ricochet stability`: its output, and the agreement of its verdicts with theory.

use mpi_test::{PlainTest, tests};
use std::fs;
use std::path::Path;
use std::time::Duration;

use crate::program::{BOX, LIMIT, ricochet, run, send, start, wait_for_handlers};
use crate::results::{folder, good, long, words};

pub const TESTS: &[PlainTest] = tests![
    verdicts_are_those_of_theory,
    ranks_agree,
    a_folder_that_cannot_be_made_is_told_before_any_work,
    an_interrupted_study_ends_in_order,
    a_budget_leaves_the_finest_steps_out,
    a_scene_beyond_the_contact_law_fails_as_its_run_does
];

/// A line of the CSV.
#[derive(Debug)]
struct Line {
    scheme: String,
    step: f64,
    limit: f64,
    steps: f64,
    energy_error: f64,
    growth: f64,
    force_error: f64,
    verdict: String,
    reason: String,
}

/// Three times the duration of the first contact, for a plate of 150 unknowns.
fn scene() -> String {
    BOX.replace("end = 1e-3", "end = 2e-3")
}

fn lines(path: &Path) -> Vec<Line> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let place = |name: &str| header.iter().position(|column| *column == name).unwrap();
    lines
        .map(|line| {
            // The reason is the last column, and the only one with commas.
            let fields: Vec<&str> = line.splitn(header.len(), ',').collect();
            let number = |name: &str| fields[place(name)].parse::<f64>().unwrap();
            Line {
                scheme: fields[place("scheme")].into(),
                step: number("step_s"),
                limit: number("stable_step_s"),
                steps: number("steps"),
                energy_error: number("energy_error"),
                growth: number("growth"),
                force_error: number("force_error_first"),
                verdict: fields[place("verdict")].into(),
                reason: fields[place("reason")].into(),
            }
        })
        .collect()
}

fn of<'a>(lines: &'a [Line], scheme: &str) -> Vec<&'a Line> {
    let found: Vec<_> = lines.iter().filter(|line| line.scheme == scheme).collect();
    assert!(found.len() >= 8 && found.windows(2).all(|pair| pair[0].step < pair[1].step), "{scheme}: {found:#?}");
    found
}

fn verdicts_are_those_of_theory() {
    let folder = folder(&scene());
    let outcome = good(&folder, 0, "stability scene.toml -o a/study");
    let study = folder.path().join("a/study");
    let lines = lines(&study.join("stability.csv"));

    let average = of(&lines, "newmark beta=0.25 gamma=0.5");
    assert_eq!(average[0].verdict, "holds");
    assert!(average.iter().all(|line| line.limit == f64::INFINITY && line.verdict != "grows"), "{average:#?}");
    // Second order over the two smallest time steps. The reference's own error is a quarter of theirs.
    let order = (average[1].force_error / average[0].force_error).log2();
    assert!((1.7..2.7).contains(&order), "{order}: {average:#?}");

    // The energy balance of the energy-conserving scheme is exact to rounding.
    assert!(of(&lines, "energy").iter().all(|line| line.energy_error < 1e-9));
    // Generalised-α loses more energy if it keeps less of the high frequencies (smaller rho_inf); here with 9 time
    // steps in a contact.
    let lost = |rho: &str| of(&lines, &format!("generalized-alpha rho_inf={rho}"))[5].energy_error;
    assert!(lost("0") > 2.0 * lost("0.5") && lost("0.5") > 2.0 * lost("0.8"), "{lines:#?}");

    // γ < 1/2: every vibration grows in some hundred time steps. If there are fewer steps, energy is gained
    // nevertheless.
    let growing = of(&lines, "newmark beta=0.25 gamma=0.45");
    assert!(growing.iter().all(|line| line.limit == 0.0 && line.growth > 1.005), "{growing:#?}");
    assert!(growing.iter().filter(|line| line.verdict == "grows").count() >= 3, "{growing:#?}");

    // The verdict is "holds" below the limit, also at 0.95 of it, and "grows" from 1.05 on.
    for scheme in ["central-difference", "newmark beta=0.1667 gamma=0.5"] {
        let found = of(&lines, scheme);
        let limit = found[0].limit;
        assert!(found.iter().any(|line| (line.step / limit - 0.95).abs() < 1e-6));
        assert!(found.iter().any(|line| (line.step / limit - 1.05).abs() < 1e-6));
        for line in found {
            if line.step < limit {
                assert_eq!(line.verdict, "holds", "{line:?}");
                assert_eq!((line.energy_error < 1e-3, line.reason.as_str()), (true, ""));
            } else {
                assert_eq!(line.verdict, "grows", "{line:?}");
                assert!(line.reason.starts_with("\"step ") && line.reason.contains("spurious energy gain"), "{line:?}");
            }
        }
    }

    // A run above the limit is refused, with the same limit.
    let limit = of(&lines, "central-difference")[0].limit;
    let line = format!("run scene.toml --set time.scheme=\"central-difference\" --set time.step={:e}", 1.05 * limit);
    let refused = run(ricochet(folder.path(), 0).args(words(&line)));
    assert_eq!(refused.status, Some(2), "{refused:#?}");
    assert!(refused.stderr.contains(&format!("stable up to a step of {limit:.3e} s")), "{refused:#?}");

    // Only the three files, and their main results on the terminal.
    let mut names: Vec<_> =
        fs::read_dir(&study).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    assert_eq!(names, ["stability.csv", "stability.png", "stability.svg"]);
    let svg = fs::read_to_string(study.join("stability.svg")).unwrap();
    assert!(svg.starts_with("<svg"));
    for part in ["Small plate", "central difference", "steps a contact", "predicted limit", "the scene&apos;s step"] {
        assert!(svg.contains(part) || svg.contains(&part.replace("&apos;", "'")), "{part}");
    }
    assert!(fs::read(study.join("stability.png")).unwrap().starts_with(b"\x89PNG"));
    let widest = outcome.stdout.lines().map(|line| line.chars().count()).max();
    assert!(widest.is_some_and(|widest| widest <= 80), "{}", outcome.stdout);
    for part in ["average acceleration", "at every step", "at no step", &format!("up to {limit:.2e} s")] {
        assert!(outcome.stdout.contains(part), "{part}: {}", outcome.stdout);
    }
}

/// Two ranks give the same results. Unstable runs grow from rounding, which differs.
fn ranks_agree() {
    let folder = folder(&scene());
    let [alone, two] = [0, 2].map(|ranks| {
        good(&folder, ranks, &format!("stability scene.toml -o {ranks} --set time.end=1e-3"));
        lines(&folder.path().join(format!("{ranks}/stability.csv")))
    });
    assert_eq!(alone.len(), two.len());
    for (a, b) in alone.iter().zip(&two) {
        assert_eq!((&a.scheme, &a.verdict), (&b.scheme, &b.verdict));
        // The estimate of ω_max starts from the same vector on any number of ranks, to rounding.
        assert!((a.step / b.step - 1.0).abs() < 1e-9);
        if a.verdict == "grows" {
            continue;
        }
        assert_eq!(a.steps, b.steps);
        for (x, y) in [(a.energy_error, b.energy_error), (a.force_error, b.force_error)] {
            // Rounding, which bending amplifies a millionfold, in differences of 1e-6 and more.
            assert!((x - y).abs() < 1e-8 + 1e-4 * x, "{a:?} {b:?}");
        }
    }
}

fn a_folder_that_cannot_be_made_is_told_before_any_work() {
    let folder = folder(&long());
    for ranks in [0, 2] {
        let outcome = run(ricochet(folder.path(), ranks).args(words("stability scene.toml -o scene.toml/study")));
        assert_eq!(outcome.status, Some(4), "{outcome:#?}");
        let messages: Vec<&str> = outcome.stderr.lines().filter(|line| line.starts_with("error: ")).collect();
        assert_eq!(messages.len(), 1, "{outcome:#?}");
        assert!(
            messages[0].starts_with("error: scene.toml/study: is no folder that can be written to: "),
            "{messages:?}"
        );
    }
}

fn an_interrupted_study_ends_in_order() {
    let folder = folder(&long().replace("order = 1", "order = 2"));
    let started = start(ricochet(folder.path(), 0).args(words("stability scene.toml -o study")));
    wait_for_handlers(started.child.id());
    std::thread::sleep(Duration::from_millis(300));
    send("INT", &started.child.id().to_string());
    let outcome = started.wait(LIMIT);
    assert_eq!(outcome.status, Some(130), "{outcome:#?}");
    let told: Vec<&str> = outcome.stderr.lines().filter(|line| line.starts_with("interrupted: ")).collect();
    assert_eq!(told.len(), 1, "{outcome:#?}");
    // All files or none.
    let files = fs::read_dir(folder.path().join("study")).unwrap().count();
    assert_eq!(files, if told[0].contains("is written") { 3 } else { 0 }, "{outcome:#?}");
}

/// The shortest run is made whatever the budget. The other runs are in the table as left out, and named. On two ranks
/// the clock of the first one counts.
fn a_budget_leaves_the_finest_steps_out() {
    let folder = folder(&scene());
    for ranks in [0, 2] {
        let outcome = good(&folder, ranks, &format!("stability scene.toml -o {ranks} --set time.end=1e-3 --budget 0"));
        let lines = lines(&folder.path().join(format!("{ranks}/stability.csv")));
        let made: Vec<&Line> = lines.iter().filter(|line| line.verdict != "left out").collect();
        assert!(made.len() == 1 && lines.len() > 60, "{lines:#?}");
        // No other run of its scheme has larger time steps.
        let own = of(&lines, &made[0].scheme);
        assert_eq!(own[own.len() - 1].step, made[0].step);
        assert!(lines.iter().all(|line| line.verdict != "left out" || (line.steps == 0.0 && line.growth.is_nan())));
        let count = format!("incomplete {} of {} runs were left out", lines.len() - 1, lines.len());
        assert!(outcome.stdout.contains(&count), "{count}: {}", outcome.stdout);
        // The shortest run is found by measurement; no other scheme has any run.
        let left_out = outcome.stdout.matches(": all steps, to keep to the 0 s of --budget").count();
        let mut schemes: Vec<&str> = lines.iter().map(|line| line.scheme.as_str()).collect();
        schemes.dedup();
        assert!(schemes.len() > 5 && left_out == schemes.len() - 1, "{schemes:?}: {}", outcome.stdout);
        let svg = fs::read_to_string(folder.path().join(format!("{ranks}/stability.svg"))).unwrap();
        assert!(svg.contains(&format!("Small plate ({} of {} runs left out)", lines.len() - 1, lines.len())));
    }
    for budget in ["-1", "nan", "soon"] {
        let line = format!("stability scene.toml -o bad --budget {budget}");
        let refused = run(ricochet(folder.path(), 0).args(words(&line)));
        assert!(refused.status == Some(2) && !folder.path().join("bad").exists(), "{refused:#?}");
    }
}

/// If the scene itself cannot be computed, there is nothing to compare: the message and status are the same as for the
/// run.
fn a_scene_beyond_the_contact_law_fails_as_its_run_does() {
    let folder = folder(&scene());
    let line = "--set contact.patch_radius=0.02 --set impactor.speed=100 --set impactor.radius=5";
    let study = run(ricochet(folder.path(), 0).args(words(&format!("stability scene.toml -o study {line}"))));
    assert!(matches!(study.status, Some(2 | 3)), "{study:#?}");
    assert!(study.stderr.contains("patch"), "{study:#?}");
}
