//! Tests of `check`: measurements of a mesh, warnings, facts for other programs, and an answer within seconds.

use std::fs;

use mpi_test::{PlainTest, tests};
use serde_json::Value;
use tempfile::TempDir;

use crate::bad_meshes::{TWO, sample};
use crate::glass;
use crate::program::{BOX, Outcome, ricochet, run};
use crate::results::{self, folder, good, words};

pub const TESTS: &[PlainTest] = tests![
    a_mesh_is_measured,
    what_looks_wrong_with_a_mesh_is_warned_of,
    odd_values_are_warned_of_and_computed,
    two_physical_volumes_are_refused,
    facts_for_programs,
    poor_deflections_are_noted,
    a_slow_scene_is_answered_soon,
];

/// A scene with a mesh body and supports on a surface.
fn scene(surface: &str, point: &str) -> String {
    format!(
        "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500\nmesh = \"body.msh\"\norder = 1\n\
         [[support]]\nsurface = {surface:?}\nkind = \"elastic\"\nstiffness = 1e9\n\
         [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\npoint = {point}\n\
         [time]\nend = 1e-4\n[contact]\nlocalization = \"point\"\n"
    )
}

fn with_mesh(surface: &str, point: &str, mesh: &str) -> TempDir {
    let folder = folder(&scene(surface, point));
    fs::write(folder.path().join("body.msh"), mesh).unwrap();
    folder
}

fn facts(outcome: &Outcome) -> Value {
    serde_json::from_str(&outcome.stdout).unwrap_or_else(|error| panic!("{error}: {outcome:#?}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The cube −0.5 ≤ x, y, z ≤ 0.5, on one rank and on two.
fn a_mesh_is_measured() {
    let folder = with_mesh("side", "[0, 0, 0.5]", &sample("block-tet41.msh"));
    for ranks in [0, 2] {
        let facts = facts(&good(&folder, ranks, "check scene.toml --json"));
        // Tolerance for sums of some hundred products of the coordinates.
        let is = |value: &Value, exact: f64| (number(value) - exact).abs() < 1e-12 * exact.abs();
        assert!(is(&facts["mass"], 2500.0) && is(&facts["volume"], 1.0), "{facts:#}");
        assert!((0..3).all(|i| is(&facts["bounds"][0][i], -0.5) && is(&facts["bounds"][1][i], 0.5)), "{facts:#}");
        let areas: Vec<(&str, bool)> = [("bottom", 1.0), ("side", 4.0), ("top", 1.0)]
            .into_iter()
            .zip(facts["surfaces"].as_array().unwrap())
            .map(|((name, area), found)| (name, found["name"] == name && is(&found["area"], area)))
            .collect();
        assert!(areas.iter().all(|(_, is_right)| *is_right), "{areas:?} {facts:#}");
        assert_eq!(facts["warnings"], Value::Array(Vec::new()));
    }
    let said = good(&folder, 0, "check scene.toml").stdout;
    assert!(said.contains("surface    \"side\": 4.0000 m²") && said.contains("whole boundary: 6.0000 m²"), "{said}");
}

/// Ten vectors represent the force of a light impactor, but not the vibrations after it has left. `check` says so as `run`
/// does, and not of the basis that is chosen by default.
fn poor_deflections_are_noted() {
    let body = "model = \"mindlin\"\nsize = [0.5, 0.4, 0.02]";
    let folder = folder(&glass::scene(body, "mass = 0.05\nspeed = 1.0", "end = 4e-3", ""));
    let few = "scene.toml --set body.reduction=10";
    let noted = "error of the deflection under the impactor, over the whole history, is";
    // The largest deflection is printed, and of no use.
    let useless = run(ricochet(folder.path(), 0).args(words(&format!("run {few} -o run.h5"))));
    assert_eq!(useless.status, Some(3), "{useless:?}");
    assert!(useless.stderr.contains(noted) && useless.stderr.contains("largest deflection under"), "{useless:?}");
    assert!(good(&folder, 0, &format!("run {few} -o run.h5 --force")).stderr.contains(noted));
    assert!(good(&folder, 0, &format!("check {few}")).stdout.contains(noted));
    assert!(!good(&folder, 0, "check scene.toml").stdout.contains(noted));
}

fn what_looks_wrong_with_a_mesh_is_warned_of() {
    // The upper one of the two hexahedra has separate nodes.
    let apart = TWO
        .replace("12\n1 0 0 0", "16\n1 0 0 0")
        .replace("12 0 1 2\n", "12 0 1 2\n13 0 0 1.5\n14 1 0 1.5\n15 1 1 1.5\n16 0 1 1.5\n")
        .replace("3 5 2 3 1 5 6 7 8 9", "3 5 2 3 1 13 14 15 16 9");
    // All six faces of the upper hexahedron.
    let whole = "1 3 2 1 1 9 10 11 12\n4 3 2 1 1 1 2 3 4\n5 3 2 1 1 1 2 6 5\n6 3 2 1 1 5 6 10 9\n7 3 2 1 1 2 3 7 6\n8 3 2 1 1 6 7 11 10\n\
                 9 3 2 1 1 3 4 8 7\n10 3 2 1 1 7 8 12 11\n11 3 2 1 1 4 1 5 8\n12 3 2 1 1 8 5 9 12";
    let covered = TWO.replace("$Elements\n3", "$Elements\n12").replace("1 3 2 1 1 9 10 11 12", whole);
    let large = sample("block-tet41.msh").replace("0.5", "500");
    // The upper hexahedron shares only two of its four nodes with the lower one.
    let open = TWO
        .replace("12\n1 0 0 0", "14\n1 0 0 0")
        .replace("12 0 1 2\n", "12 0 1 2\n13 1 1 1\n14 0 1 1\n")
        .replace("3 5 2 3 1 5 6 7 8 9", "3 5 2 3 1 5 6 13 14 9");
    for (mesh, point, warning) in [
        (open, "[0.5, 0.5, 2]", "2 faces of the mesh lie on others without sharing their nodes"),
        (apart, "[0.5, 0.5, 2]", "the mesh has 2 parts that share no node"),
        (covered, "[0.5, 0.5, 2]", "support.0 holds the whole boundary"),
        (large, "[0, 0, 500]", "these look like millimetres"),
    ] {
        let surface = if point.contains("500") { "side" } else { "top" };
        let folder = with_mesh(surface, point, &mesh);
        let said = good(&folder, 0, "check scene.toml").stdout;
        assert!(said.lines().any(|line| line.starts_with("warning") && line.contains(warning)), "{warning}: {said}");
        let outcome = run(ricochet(folder.path(), 2).args(words("run scene.toml --force")));
        let told = outcome.stderr.lines().filter(|line| line.contains(warning)).count();
        assert_eq!((outcome.status, told), (Some(0), 1), "{warning}: {outcome:#?}");
    }
}

fn odd_values_are_warned_of_and_computed() {
    let folder = folder(BOX);
    let told = "scene.toml (after --set):14: impactor.radius: a ball of 50 m and 52 kg";
    let said = good(&folder, 0, "check scene.toml --set impactor.radius=50").stdout;
    assert!(said.lines().any(|line| line.starts_with("warning    ") && line.contains(told)), "{said}");
    let outcome = good(&folder, 2, "run scene.toml -o out.h5 --set impactor.radius=50");
    assert_eq!(outcome.stderr.matches(&format!("warning: {told}")).count(), 1, "{outcome:#?}");
    let ignored = good(
        &folder,
        0,
        "check scene.toml --set body.model=mindlin --set solver.newton= --set body.reduction= \
        --set contact.localization=",
    )
    .stdout;
    assert!(ignored.contains("has no effect with model = \"mindlin\""), "{ignored}");
}

fn two_physical_volumes_are_refused() {
    // Regions are given in version 2.2 by the elements' first tags, in 4.1 by the groups of the volumes. A volume may
    // be in two groups.
    let by_elements = TWO.replace("3 5 2 3 1 5", "3 5 2 4 1 5");
    let modern = sample("block-tet41.msh");
    let volume = modern.lines().find(|line| line.contains(" 1 4 6 ")).unwrap();
    let in_two = modern.replacen(volume, &volume.replacen(" 1 4 6 ", " 2 4 7 6 ", 1), 1);
    good(&with_mesh("side", "[0, 0, 0.5]", &in_two), 0, "check scene.toml");
    // A second volume in another group, which has the last element.
    let other = volume.replacen("1 ", "2 ", 1).replacen(" 1 4 6 ", " 1 7 6 ", 1);
    let mut lines: Vec<String> = modern.lines().map(str::to_owned).collect();
    let at = |lines: &[String], start: &str| lines.iter().position(|line| line.starts_with(start)).unwrap();
    let entities = at(&lines, "$Entities") + 1;
    lines[entities] = lines[entities].replace(" 6 1", " 6 2");
    let after = at(&lines, volume) + 1;
    lines.insert(after, other);
    let elements = at(&lines, "$Elements") + 1;
    let (blocks, rest) = lines[elements].split_once(' ').unwrap();
    lines[elements] = format!("{} {rest}", blocks.parse::<usize>().unwrap() + 1);
    let cells = elements + at(&lines[elements..], "3 1 4 ");
    let count: usize = lines[cells].rsplit(' ').next().unwrap().parse().unwrap();
    lines[cells] = format!("3 1 4 {}", count - 1);
    lines.insert(cells + count, "3 2 4 1".to_owned());
    let by_groups = lines.join("\n") + "\n";
    for (mesh, surface, point) in [(by_elements, "top", "[0.5, 0.5, 2]"), (by_groups, "side", "[0, 0, 0.5]")] {
        let folder = with_mesh(surface, point, &mesh);
        for line in ["check scene.toml", "run scene.toml"] {
            for ranks in [0, 2] {
                let outcome = run(ricochet(folder.path(), ranks).args(words(line)));
                let told =
                    "scene.toml:5: body.mesh: body.msh: it has 2 physical volumes, and the scene has one material";
                assert_eq!((outcome.status, outcome.stderr.matches(told).count()), (Some(2), 1), "{outcome:#?}");
            }
        }
    }
}

fn facts_for_programs() {
    let folder = folder(&BOX.replace("[time]", "point = [0.0, 0.0, 0.01]\n[time]"));
    let facts = facts(&good(&folder, 0, "check scene.toml --json"));
    assert_eq!(facts["title"], "Small plate");
    assert_eq!((&facts["model"]["theory"], &facts["model"]["unknowns"]), (&"solid".into(), &150.into()));
    assert!((number(&facts["mass"]) - 12.5).abs() < 1e-12);
    // Contact stiffness of an impact of 52 kg on a half-space, with k0 by (15): docs/scene.md.
    assert!((number(&facts["contact"]["stiffness"]) / 1.669e10 - 1.0).abs() < 1e-3, "{facts:#}");
}

/// `check` answers soon even for a pane whose model takes much longer than its time limit, and does not begin to assemble
/// one of a million unknowns, which an oblique impact asks for.
fn a_slow_scene_is_answered_soon() {
    let oblique = results::pane().replace("[time]", "direction = [0.5, 0.0, -1.0]\n[time]");
    let outcome = good(&folder(&oblique), 2, "check scene.toml");
    assert!(outcome.stdout.contains("take more than a few seconds: --full makes them"), "{outcome:#?}");
    assert!(!outcome.stderr.contains("so far"), "{outcome:#?}");
    let pane = results::pane().replace("tolerance = 1e-2", "tolerance = 1e-3");
    let folder = folder(&pane);
    let outcome = good(&folder, 2, "check scene.toml");
    assert!(outcome.stdout.contains("take more than a few seconds: --full makes them"), "{outcome:#?}");
    assert!(outcome.stdout.contains("contact    for comparison, on a half-space: "), "{outcome:#?}");
}
