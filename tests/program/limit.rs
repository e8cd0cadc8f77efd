//! Tests of `ricochet limit`: its answers agree with runs close to them, on any number of ranks.

use mpi_test::{PlainTest, tests};
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

use crate::glass::{plate, sides};
use crate::program::{BOX, LIMIT, Outcome, ricochet, run, send, start, wait_for_handlers};
use crate::results::{self, folder, good, number, text, words};

pub const TESTS: &[PlainTest] = tests![
    the_limit_is_that_of_runs_around_it,
    the_lower_one_of_two_limits,
    a_thickness_is_passed_up_to_its_limit,
    no_limit_in_the_range_is_an_answer,
    values_in_other_units_are_doubted,
    a_limit_after_the_first_contact_has_an_uncertainty,
    the_run_at_the_limit_is_written,
    any_number_of_ranks_finds_the_same,
    what_cannot_be_searched_is_said,
    a_signal_ends_it,
];

/// Largest number of runs for a simple case.
const FEW: u64 = 15;

/// A pane on springs, as Mindlin's plate.
fn pane(strength: f64) -> TempDir {
    let rest = format!("{}[strength]\ntension = {strength:e}\n", sides(1e9, 0.0));
    folder(&plate("model = \"mindlin\"\nsize = [0.5, 0.5, 0.02]", "end = 0.005", &rest))
}

fn facts(outcome: &Outcome) -> Value {
    serde_json::from_str(&outcome.stdout).unwrap_or_else(|error| panic!("{error}: {outcome:#?}"))
}

fn of(facts: &Value, path: &str) -> f64 {
    facts.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path}: {facts:#}"))
}

/// Largest tensile stress of a run with this value, Pa.
fn tension(folder: &TempDir, key: &str, value: f64) -> f64 {
    good(folder, 0, &format!("run scene.toml --set {key}={value} -o run.h5"));
    number(&results::open(folder.path().join("run.h5")), "largest_stress")
}

/// The limit agrees with linear interpolation between two runs close to it.
fn the_limit_is_that_of_runs_around_it() {
    for strength in [45e6, 120e6] {
        let folder = pane(strength);
        let facts = facts(&good(&folder, 0, "limit scene.toml --vary impactor.speed=0.1..10 --json"));
        let speed = of(&facts, "/limit/value");
        let [low, high] = [0.99 * speed, 1.01 * speed];
        let [below, above] = [low, high].map(|value| tension(&folder, "impactor.speed", value));
        assert!(below < strength && strength < above, "{below} {above} {facts:#}");
        let between = low + (high - low) * (strength - below) / (above - below);
        // The root is found to a twentieth of the tolerance, 5e-4. The rest is the interpolation error between the runs, and
        // the difference of their own cells from those of the search: cells may use 0.6 of the tolerance.
        assert!((speed / between - 1.0).abs() < 3e-3, "{speed} {between}");
        assert!(facts["runs"].as_u64().unwrap() < FEW, "{facts:#}");
        assert_eq!((&facts["outcome"], &facts["limit"]["face"]), (&"reached".into(), &"lower".into()));
        assert_eq!((&facts["key"], &facts["unit"]), (&"impactor.speed".into(), &"m/s".into()));
        // The estimated error of such a run is 1e-2 to 2e-2, and the tension is about proportional to the speed.
        let uncertainty = of(&facts, "/limit/uncertainty") / speed;
        assert!((5e-3..5e-2).contains(&uncertainty), "{facts:#}");
        assert!(of(&facts, "/limit/peak_force") > 0.0 && of(&facts, "/limit/time") > 0.0);
    }
}

/// With increasing support stiffness the tension rises, falls, and rises again because of the second contact. The lower
/// one of the two limits is found.
fn the_lower_one_of_two_limits() {
    let folder = pane(175e6);
    let line = |range: &str| format!("limit scene.toml --vary support.0.stiffness={range} --json");
    let lower = facts(&good(&folder, 0, &line("2e8..1e9")));
    let upper = facts(&good(&folder, 0, &line("5e8..1e9")));
    assert_eq!((&lower["outcome"], &upper["outcome"]), (&"reached".into(), &"passed_up_to_value".into()));
    let [first, second] = [&lower, &upper].map(|facts| of(facts, "/limit/value"));
    assert!(2e8 < first && first < 5e8 && 5e8 < second && second < 1e9, "{first} {second}");
    // The first search also computes the upper end of its range, where the strength is not exceeded.
    assert_eq!(of(&lower, "/limit/crossed_again_at"), 1e9);
    assert_eq!((&lower["limit"]["safe_side"], &upper["limit"]["safe_side"]), (&"below".into(), &"above".into()));
    assert!(upper["limit"]["crossed_again_at"].is_null());
    let said = good(&folder, 0, "limit scene.toml --vary support.0.stiffness=2e8..1e9");
    let first = said.stdout.lines().next().unwrap();
    assert!(first.ends_with("not exceeded below it, nor at 1e9 N/m3"), "{said:#?}");
    assert!(said.stderr.contains("there is another limit"), "{said:#?}");
    for facts in [&lower, &upper] {
        assert!((of(facts, "/limit/ratio") - 1.0).abs() < 1e-2, "{facts:#}");
    }
}

fn a_thickness_is_passed_up_to_its_limit() {
    let folder = pane(45e6);
    let outcome = good(&folder, 0, "limit scene.toml --vary body.size.2=0.01..0.1");
    assert!(outcome.stdout.starts_with("limit: body.size.2 = 0.05"), "{outcome:#?}");
    let first = outcome.stdout.lines().next().unwrap();
    assert!(first.ends_with("the strength is not exceeded above it"), "{outcome:#?}");
    assert!(outcome.stdout.contains("already exceeded at the lower end, 0.01 m"), "{outcome:#?}");
    let rows = outcome.stderr.lines().filter(|line| line.contains("lower ")).count();
    assert!(outcome.stdout.contains(&format!("{rows} runs")), "{outcome:#?}");
    let quiet = good(&folder, 0, "limit scene.toml --vary body.size.2=0.01..0.1 -q");
    // Only warnings remain.
    let warnings = outcome.stderr.lines().filter(|line| line.starts_with("warning: "));
    let warnings: String = warnings.map(|warning| format!("{warning}\n")).collect();
    assert_eq!((quiet.stdout, quiet.stderr), (outcome.stdout, warnings));
}

fn no_limit_in_the_range_is_an_answer() {
    let folder = pane(45e6);
    let nowhere = good(&folder, 0, "limit scene.toml --vary impactor.speed=0.01..0.1 -o out.h5");
    assert!(nowhere.stdout.contains("reached nowhere from 0.01 m/s to 0.1 m/s"), "{nowhere:#?}");
    assert!(nowhere.stdout.contains("at impactor.speed = 0.1 m/s"), "{nowhere:#?}");
    assert!(nowhere.stderr.contains("out.h5 is not written") && !folder.path().join("out.h5").exists());
    let everywhere = good(&folder, 0, "limit scene.toml --vary impactor.speed=1..2 --json");
    assert_eq!(facts(&everywhere)["outcome"], "passed_everywhere");
    let everywhere = good(&folder, 0, "limit scene.toml --vary impactor.speed=1..2");
    assert!(everywhere.stdout.contains("already exceeded at the lower end, and everywhere"), "{everywhere:#?}");
}

/// A strength in MPa in place of Pa is doubted, whether the scene gives it or the range.
fn values_in_other_units_are_doubted() {
    for (strength, range) in [(45.0, "impactor.speed=1..2"), (45e6, "strength.tension=20..80")] {
        let outcome = good(&pane(strength), 0, &format!("limit scene.toml --vary {range}"));
        let doubts = outcome.stderr.lines().filter(|line| line.contains("weaker than foam")).count();
        assert!(doubts == 1 && outcome.stderr.contains("warning: scene.toml"), "{outcome:#?}");
    }
}

/// On soft springs the pane hits the impactor again, and the tension of the second contact is the largest. Its error is that
/// of the whole run: some per cent, as in the first contact of a pane on stiff springs.
fn a_limit_after_the_first_contact_has_an_uncertainty() {
    let relative = [1e8, 1e10].map(|stiffness| {
        let rest = format!("{}[strength]\ntension = 100e6\n", sides(stiffness, 0.0));
        let folder = folder(&plate("model = \"mindlin\"\nsize = [0.5, 0.5, 0.02]", "end = 0.01", &rest));
        let facts = facts(&good(&folder, 0, "limit scene.toml --vary impactor.speed=0.5..3 --json"));
        of(&facts, "/limit/uncertainty") / of(&facts, "/limit/value")
    });
    assert!(relative.iter().all(|relative| (5e-3..5e-2).contains(relative)), "{relative:?}");
}

fn the_run_at_the_limit_is_written() {
    let folder = pane(45e6);
    let facts = facts(&good(&folder, 0, "limit scene.toml --vary impactor.speed=0.1..10 -o out.h5 --json"));
    assert_eq!(facts["output"], "out.h5");
    let file = results::open(folder.path().join("out.h5"));
    assert_eq!(number::<f64>(&file, "largest_stress"), of(&facts, "/limit/tension"));
    assert!(text(&file, "scene").contains(&format!("speed = {}", facts["limit"]["value"])));
    assert!(number::<bool>(&file, "complete"));
}

fn any_number_of_ranks_finds_the_same() {
    let folder = pane(45e6);
    let line = "limit scene.toml --vary impactor.speed=0.1..10";
    let alone = good(&folder, 0, line).stdout;
    for ranks in 1..=3 {
        assert_eq!(good(&folder, ranks, line).stdout, alone, "{ranks} ranks");
    }
}

fn refused(folder: &Path, ranks: usize, line: &str, fragment: &str) {
    let outcome = run(ricochet(folder, ranks).args(words(&format!("limit scene.toml -o out.h5 {line}"))));
    assert_eq!(outcome.status, Some(2), "{line}: {outcome:#?}");
    assert!(outcome.stderr.contains(fragment) && outcome.stdout.is_empty(), "{line}: {fragment}: {outcome:#?}");
    let messages = outcome.stderr.lines().filter(|line| line.starts_with("error: ") || line.starts_with("  × "));
    assert_eq!(messages.count(), 1, "{line}: {outcome:#?}");
    assert!(!folder.join("out.h5").exists(), "{line}");
}

fn what_cannot_be_searched_is_said() {
    const SPEED: &str = "--vary impactor.speed=0.1..10";
    let folder = pane(45e6);
    let cases = [
        ("--vary impactor.speed=1,2,3".to_owned(), "a list"),
        ("--vary impactor.speed=1..2:5".to_owned(), "leave out their number"),
        ("--vary impactor.speed".to_owned(), "KEY=A..B"),
        ("--vary impactor.speed=1..1".to_owned(), "the same"),
        ("--vary impactor.speed=2..1".to_owned(), "lower one"),
        ("--vary impactor.speed=slow..1".to_owned(), "\"slow\" is not a number"),
        ("--vary time.scheme=0.1..1".to_owned(), "time.scheme: this is the wrong type"),
        ("--vary impactor.sped=0.1..1".to_owned(), "unknown key"),
        ("--vary impactor.speed=-1..1".to_owned(), "must be positive, but is -1"),
        ("--vary impactor.speed=1..1e5".to_owned(), "faster than waves"),
        (format!("{SPEED} --set output.stress=false"), "stresses, which are not read"),
        (format!("{SPEED} --set body.model=half-space"), "a formula and has no faces"),
        (format!("{SPEED} --set body.young=-1"), "before --vary"),
        (format!("{SPEED} --set strength.tension="), "needs the strength of the material"),
    ];
    for (line, fragment) in &cases {
        refused(folder.path(), 0, line, fragment);
    }
    for (line, fragment) in [&cases[0], &cases[8], &cases[13]] {
        refused(folder.path(), 2, line, fragment);
    }
}

fn a_signal_ends_it() {
    let folder = folder(&(BOX.replace("step = 2e-5", "step = 1e-9") + "[strength]\ntension = 45e6\n"));
    let started =
        start(ricochet(folder.path(), 0).args(words("limit scene.toml --vary impactor.speed=0.1..10 -o out.h5")));
    wait_for_handlers(started.child.id());
    send("TERM", &started.child.id().to_string());
    let outcome = started.wait(LIMIT);
    assert_eq!(outcome.status, Some(130), "{outcome:#?}");
    assert!(!folder.path().join("out.h5").exists());
}
