//! Tests of the largest tension in the program: in summaries, results and sweeps, with and without a strength.

use crate::program::{ricochet, run};
use crate::results::{change, column, folder, good, number, open, text, words};
use mpi_test::{PlainTest, tests};
use serde_json::Value;

pub const TESTS: &[PlainTest] = tests![
    results_tell_the_largest_tension,
    each_face_of_a_laminate_is_told,
    maps_have_the_largest_tension_at_each_point,
    strengths_are_of_faces_that_are_there,
    sweeps_have_a_column_for_it,
    tensions_are_continuous_in_the_distance_from_an_edge,
    a_strength_is_not_exceeded_only_with_an_estimate,
    what_has_no_estimate_is_told,
    tensions_at_clamped_edges_have_no_estimate,
    a_tension_after_the_first_contact_has_an_estimate
];

/// A pane with a tension of some 60 MPa.
const PANE: &str = "[body]\nmodel = \"mindlin\"\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.5, 0.5, 0.02]\n\
                    [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = 1e9\n\
                    [impactor]\nmass = 52.0\nspeed = 1.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\n[time]\nend = 5e-4\n";

/// A run and `info` have the largest tension on each face of the layers, from the struck one down.
fn each_face_of_a_laminate_is_told() {
    let layer = |thickness: f64, material: &str| {
        format!("[[body.layer]]\nthickness = {thickness}\nmaterial = \"{material}\"\n")
    };
    let glass = layer(0.01, "glass");
    let film = layer(0.00076, "film");
    let folder = folder(&format!(
        "[body]\nsize = [0.5, 0.5]\nmodel = \"layerwise\"\nreduction = 20\n{glass}{film}{glass}\
         [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
         [material.film]\nyoung = 1e7\npoisson = 0.45\ndensity = 1100.0\n\
         [impactor]\nmass = 52.0\nspeed = 1.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\n[time]\nend = 5e-4\n"
    ));
    let said = good(&folder, 0, "run scene.toml -o out.h5");
    assert!(
        said.stdout.contains(
            "\nlargest tension on each face, MPa (the error is estimated for the largest value only): 1-upper "
        ),
        "{said:?}"
    );
    // Steps that are not recorded count too.
    let all = said.stdout.lines().find(|line| line.starts_with("largest tension on each face"));
    let few = good(&folder, 0, "run scene.toml -o few.h5 --set output.every=100").stdout;
    assert_eq!(few.lines().find(|line| line.starts_with("largest tension on each face")), all);
    let facts: Value = serde_json::from_str(&good(&folder, 0, "info out.h5 --json").stdout).unwrap();
    let faces = facts["largest"]["faces"].as_array().unwrap();
    let names = ["1-upper", "1-lower", "2-upper", "2-lower", "3-upper", "3-lower"];
    assert_eq!(faces.len(), names.len(), "{facts:#}");
    for (face, name) in faces.iter().zip(names) {
        let largest = column(&folder.path().join("out.h5"), &format!("stress/{name}/largest"));
        let largest = largest.into_iter().fold(f64::NAN, f64::max);
        let value = face["value"].as_f64().unwrap();
        // Reading a number from JSON may round it.
        assert!((value / largest - 1.0).abs() < 1e-15 && face["face"] == name, "{largest} {facts:#}");
    }
}

/// The attributes agree with the series, with 2 ranks as with one. The tension of the contact ring follows from F and α
/// with only ν and R.
fn results_tell_the_largest_tension() {
    let folder = folder(PANE);
    let mut found = Vec::new();
    for ranks in [0, 2] {
        let said = good(&folder, ranks, "run scene.toml -o out.h5 --force --set strength.tension=50e6");
        assert!(
            said.stdout.contains("largest tension ")
                && said.stdout.contains("; the strength of face \"lower\" is first exceeded at "),
            "{said:?}"
        );
        let path = folder.path().join("out.h5");
        let lower = column(&path, "stress/lower/largest");
        let time = column(&path, "time");
        let file = open(&path);
        let largest: f64 = number(&file, "largest_stress");
        assert_eq!(lower.iter().copied().fold(f64::NAN, f64::max), largest);
        assert_eq!(text(&file, "largest_stress_face"), "lower");
        let passed: f64 = number(&file, "strength_passed_at");
        let first = lower.iter().position(|tension| *tension > 50e6).unwrap();
        assert_eq!(time[first], passed);
        assert_eq!(text(&file, "strength_passed_face"), "lower");
        let [ring, force, indentation] =
            ["stress/ring", "contact/force", "contact/indentation"].map(|name| column(&path, name));
        for (row, ring) in ring.iter().enumerate().skip(1) {
            let expected = 0.54 / (2.0 * std::f64::consts::PI * 0.05) * force[row] / indentation[row];
            assert!((ring - expected).abs() < 1e-12 * expected.abs(), "{row}: {ring} {expected}");
        }
        found.push(largest);
    }
    assert!((found[0] / found[1] - 1.0).abs() < 1e-9, "{found:?}");
    let facts = good(&folder, 0, "info out.h5 --json").stdout;
    assert!(facts.contains("\"strength_passed_at\"") && facts.contains("\"strength_passed_face\""), "{facts}");
    // The largest tension is on the lower face, but only the upper one has a strength.
    let said = good(&folder, 0, "run scene.toml -o upper.h5 --set strength.face.upper=1e6");
    let is_named =
        said.stdout.contains("on face \"lower\"") && said.stdout.contains("the strength of face \"upper\" is");
    assert!(is_named, "{said:?}");
    assert_eq!(text(&open(folder.path().join("upper.h5")), "strength_passed_face"), "upper");
    good(&folder, 0, "plot out.h5 --quantity stress -o stress.svg");
}

/// For a plate in modal coordinates, a plate integrated in its unknowns, and a mesh: the map's largest value and its
/// time agree with the time history. Rows that are not recorded count too. In the last two cases the test computes the
/// maximum over all steps directly.
fn maps_have_the_largest_tension_at_each_point() {
    let folder = folder(PANE);
    let stepped = "--set body.reduction=none --set time.step=1e-5 --set time.scheme=newmark";
    let mesh = &format!("--set body.model=solid --set body.order=1 --set body.cells=[4,4,1] {stepped}");
    for (settings, ranks) in [("", 0), ("", 2), (stepped, 0), (mesh, 0), (mesh, 2)] {
        good(&folder, ranks, &format!("run scene.toml -o out.h5 --force {settings}"));
        let path = folder.path().join("out.h5");
        let time = column(&path, "time");
        let file = open(&path);
        for face in ["upper", "lower"] {
            let of =
                |name: &str| file.dataset(&format!("stress_map/{face}/{name}")).unwrap().read_raw::<f64>().unwrap();
            let (points, tension, when) = (of("points"), of("tension"), of("time"));
            assert!(points.len() == 3 * tension.len() && when.len() == tension.len());
            let history = column(&path, &format!("stress/{face}/largest"));
            let row = (0..history.len()).fold(0, |best, row| if history[row] > history[best] { row } else { best });
            let best = (0..tension.len()).filter(|point| !tension[*point].is_nan());
            let best = best.max_by(|one, other| tension[*one].total_cmp(&tension[*other])).unwrap();
            // Single precision: 1e-4 is several times its error bound for sums of a hundred products.
            let apart = (tension[best] / history[row] - 1.0).abs();
            assert!(apart < 1e-4, "{settings} {face}: {} {}", tension[best], history[row]);
            assert!(
                history
                    .iter()
                    .zip(&time)
                    .any(|(value, time)| { *time == when[best] && (value / history[row] - 1.0).abs() < 1e-4 })
            );
            // Some points have their largest tension at another time.
            assert!(when.iter().any(|time| !time.is_nan() && *time != when[best]), "{settings} {face}");
        }
        good(&folder, 0, "plot out.h5 --quantity stress_map/lower -o lower.svg");
        good(&folder, 0, "plot out.h5 --quantity stress_map -o map.svg");
        for figure in ["lower.svg", "map-lower.svg", "map-upper.svg"] {
            let svg = std::fs::read_to_string(folder.path().join(figure)).unwrap();
            assert!(svg.contains("largest:") && svg.matches("<rect").count() > 200, "{figure}");
        }
    }
    let outcome = run(ricochet(folder.path(), 0).args(words("plot out.h5 --quantity stress_map/botom -o none.svg")));
    assert_eq!(outcome.status, Some(2), "{outcome:?}");
    assert!(outcome.stderr.contains("upper, lower"), "{outcome:?}");
    // Rows that are not recorded count.
    good(&folder, 0, "run scene.toml -o all.h5");
    good(&folder, 0, "run scene.toml -o some.h5 --set output.every=1000");
    let [all, some] = ["all.h5", "some.h5"].map(|name| open(folder.path().join(name)));
    let of = |file: &hdf5_metno::File| file.dataset("stress_map/lower/tension").unwrap().read_raw::<f64>().unwrap();
    assert!(of(&all).iter().zip(of(&some)).all(|(one, other)| *one == other || (one.is_nan() && other.is_nan())));
    good(&folder, 0, "run scene.toml -o without.h5 --set output.stress=false");
    assert!(open(folder.path().join("without.h5")).group("stress_map").is_err());
}

/// A strength for a face or body that does not exist is an error with the key, on one rank and on two, and no result is
/// started.
fn strengths_are_of_faces_that_are_there() {
    let folder = folder(PANE);
    for (more, key) in [
        ("--set strength.face.botom=1e6", "strength.face.botom"),
        ("--set body.model=half-space --set strength.tension=1e6", "strength"),
        ("--set output.stress=false --set strength.tension=1e6", "output.stress"),
        ("--set strength.tension=-1", "strength.tension"),
    ] {
        for ranks in [0, 2] {
            let outcome = run(ricochet(folder.path(), ranks).args(words(&format!("run scene.toml -o none.h5 {more}"))));
            assert_eq!(outcome.status, Some(2), "{more}: {outcome:?}");
            assert!(
                outcome.stderr.matches("error").count() <= 2 && outcome.stderr.contains(key),
                "{more}: {outcome:?}"
            );
            assert!(!folder.path().join("none.h5").exists());
        }
    }
}

/// Each member's largest tension equals the value of its run, except for the effect of another basis.
fn sweeps_have_a_column_for_it() {
    let folder = folder(PANE);
    let line = "sweep scene.toml --vary impactor.speed=0.5,1";
    let said = good(&folder, 0, &format!("{line} --set strength.face.lower=50e6 -o sweep.h5")).stdout;
    let summary = "MPa, the largest of member 1: impactor.speed=1; the strength is exceeded in 1 of 2 members, the first of them member 1";
    assert!(said.contains("largest tension ") && said.contains(summary), "{said}");
    for (strength, told) in [(1e6, "the strength is exceeded in all members"), (1e9, "the strength is not exceeded")] {
        let said =
            good(&folder, 0, &format!("{line} --set strength.tension={strength:e} -o other-{strength}.h5")).stdout;
        assert!(said.contains(told), "{said}");
    }
    assert!(!good(&folder, 0, &format!("{line} -o without.h5")).stdout.contains("largest tension"));
    let file = open(folder.path().join("sweep.h5"));
    let of = |name: &str| file.dataset(&format!("members/{name}")).unwrap().read_raw::<f64>().unwrap();
    good(&folder, 0, "plot sweep.h5 --quantity largest_stress_face -o faces.svg");
    let figure = std::fs::read_to_string(folder.path().join("faces.svg")).unwrap();
    assert!(figure.contains("\nlower\n") && figure.contains("\nupper\n"), "{figure}");
    let (tensions, faces, passed) = (of("largest_stress"), of("largest_stress_face"), of("strength_passed_at"));
    assert!(faces == [1.0, 1.0] && passed[0].is_nan() && passed[1] > 0.0, "{faces:?} {passed:?}");
    assert!(of("stress_error_estimate").iter().all(|error| *error > 0.0 && *error < 0.1));
    good(&folder, 0, "plot sweep.h5 --quantity stress -o sweep.svg");
    let figure = std::fs::read_to_string(folder.path().join("sweep.svg")).unwrap();
    assert!(figure.contains("largest tension") && !figure.contains("peak acceleration"));
    for (speed, tension) in ["0.5", "1"].iter().zip(tensions) {
        good(&folder, 0, &format!("run scene.toml -o run.h5 --force --set impactor.speed={speed}"));
        let alone: f64 = number(&open(folder.path().join("run.h5")), "largest_stress");
        // Half of the tolerance is for the error of the bases.
        assert!((tension / alone - 1.0).abs() < 5e-3, "{speed}: {tension} {alone}");
    }
}

/// The local field of the impacted layer is added at any distance from an edge that a plate admits, half its thickness: the
/// tension changes between neighbouring distances by less than the sum of the two estimates. The references are the
/// program's spline solids with a disc that is narrow where it matters (radius 6 mm; laminate: by default), whose tension
/// converges with the disc to 0.2%; a plate's deviation from them is within its estimate.
fn tensions_are_continuous_in_the_distance_from_an_edge() {
    let impactor = |mass: f64, radius: f64, speed: f64, end: f64| {
        format!(
            "[impactor]\nmass = {mass}\nradius = {radius}\nyoung = 210e9\npoisson = 0.3\nspeed = {speed}\n[time]\nend = {end}\n"
        )
    };
    let layer = |thickness: f64, material: &str| {
        format!("[[body.layer]]\nthickness = {thickness}\nmaterial = \"{material}\"\n")
    };
    let pane =
        "[body]\nmodel = \"mindlin\"\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.2, 0.16, 0.02]\n"
            .to_owned();
    let laminate = format!(
        "[body]\nmodel = \"layerwise\"\nsize = [0.15, 0.12]\n{}{}{}\
         [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
         [material.soft]\nyoung = 200e6\npoisson = 0.45\ndensity = 1100.0\n",
        layer(0.006, "glass"),
        layer(0.0015, "soft"),
        layer(0.006, "glass")
    );
    // Scene, half of the edge (mm), distances (mm), and for some of them the solid's tension (MPa).
    let cases = [
        (
            pane + &impactor(1.0, 0.0312, 3.0, 1.3e-4),
            80.0,
            &[30.0, 25.0, 21.0, 20.0, 19.0, 17.0, 15.0, 13.0, 11.0][..],
            &[(20.0, 70.51), (15.0, 67.89), (11.0, 67.42)][..],
        ),
        (
            laminate + &impactor(0.2, 0.02, 2.0, 1e-4),
            60.0,
            &[15.0, 14.0, 13.0, 12.0, 9.5, 7.0, 5.5, 3.5],
            &[(12.0, 102.12), (7.0, 85.76), (3.5, 84.47)],
        ),
    ];
    for (scene, half, distances, solids) in cases {
        let folder = folder(&scene);
        let mut before: Option<[f64; 2]> = None;
        for distance in distances {
            let at = format!("impactor.point=[0,{}]", 1e-3 * (half - distance));
            let said = good(&folder, 0, &format!("run scene.toml -o out.h5 --force --set {at}"));
            let file = open(folder.path().join("out.h5"));
            let [tension, error]: [f64; 2] =
                ["largest_stress", "stress_error_estimate"].map(|name| number(&file, name));
            let point = file.attr("largest_stress_point").unwrap().read_raw::<f64>().unwrap();
            assert!((point[1] - 1e-3 * (half - distance)).abs() < 1e-9, "{said:?}");
            let error = error * tension;
            if let Some([last, last_error]) = before {
                assert!(
                    (tension - last).abs() <= error + last_error,
                    "{distance}: {last} ± {last_error}, {tension} ± {error}"
                );
            }
            if let Some((_, solid)) = solids.iter().find(|(of, _)| of == distance) {
                assert!((tension - 1e6 * solid).abs() <= error, "{distance}: {tension} ± {error}, solid {solid} MPa");
            }
            before = Some([tension, error]);
        }
    }
}

/// A tension without an estimate leaves the strength undecided wherever it is told: after a run, in its attributes, in
/// `info`, in a report, in a sweep and in a search for a limit. With an estimate that leaves room, it is not exceeded.
fn a_strength_is_not_exceeded_only_with_an_estimate() {
    let folder = folder(&format!("{PANE}[strength]\ntension = 1e9\n"));
    let mesh = "--set body.model=solid --set body.order=1 --set body.cells=[16,16,1] --set body.size=[0.2,0.2,0.02] \
                --set impactor.mass=0.2 --set time.step=2e-5 --set time.end=2e-4 \
                --set time.scheme=newmark --set body.reduction=none";
    // A tyre at 11 mm from an edge, whose contact is wider.
    let cut = "--set contact.law=power --set contact.stiffness=2e5 --set contact.exponent=1 --set impactor.radius=0.15 \
               --set impactor.point=[0,0.239] --set time.end=2e-3";
    let cases = [
        ("", ""),
        (mesh, "the error of the stresses of a mesh is not estimated"),
        (cut, "an edge cuts it at 11.00 mm"),
    ];
    for (case, (settings, why)) in cases.into_iter().enumerate() {
        let said = good(&folder, 0, &format!("run scene.toml -o out.h5 --force {settings}"));
        let file = open(folder.path().join("out.h5"));
        let verdict = if why.is_empty() { "not exceeded" } else { "undecided" };
        assert_eq!(text(&file, "strength_verdict"), verdict, "{said:?}");
        assert!(text(&file, "stress_without_estimate").contains(why), "{said:?}");
        assert_eq!(text(&file, "stress_without_estimate").is_empty(), why.is_empty(), "{said:?}");
        assert_eq!(number::<f64>(&file, "stress_error_estimate").is_nan(), !why.is_empty(), "{said:?}");
        drop(file);
        assert_eq!(said.stderr.contains("warning: on a body that does not deflect"), settings == cut, "{said:?}");
        let told = good(&folder, 0, "info out.h5").stdout;
        let facts: Value = serde_json::from_str(&good(&folder, 0, "info out.h5 --json").stdout).unwrap();
        assert_eq!(facts["largest"]["tension"]["strength_verdict"], verdict);
        good(&folder, 0, "report out.h5 -o out.html");
        let page = std::fs::read_to_string(folder.path().join("out.html")).unwrap();
        for said in [&said.stdout, &told, &page] {
            assert!(said.contains(why), "{said}");
            assert_eq!(
                said.contains("strength is not exceeded") || said.contains("verdict good"),
                why.is_empty(),
                "{said}"
            );
        }
        if settings == cut {
            continue;
        }
        let swept =
            good(&folder, 0, &format!("sweep scene.toml --vary impactor.speed=0.9,1 -o sweep{case}.h5 {settings}"));
        let undecided = swept.stdout.contains("undecided in 2 of 2 members");
        assert_eq!(undecided, !why.is_empty(), "{swept:?}");
        assert!(swept.stderr.contains(why), "{swept:?}");
        let verdicts = open(folder.path().join(format!("sweep{case}.h5"))).dataset("members/strength_verdict").unwrap();
        assert_eq!(verdicts.read_raw::<f64>().unwrap(), [if why.is_empty() { 0.0 } else { 2.0 }; 2]);
        let limit = format!("limit scene.toml --vary impactor.speed=0.9..1 {settings}");
        let limit: Value = serde_json::from_str(&good(&folder, 0, &format!("{limit} --json")).stdout).unwrap();
        assert_eq!((&limit["outcome"], &limit["verdict"]), (&"reached_nowhere".into(), &verdict.into()), "{limit:#}");
    }
}

/// If there is no estimate for stresses, a message says that their tolerance is used for the acceleration. Nearer to an
/// edge than the means of a solid admit, there is none.
fn what_has_no_estimate_is_told() {
    let folder = folder(PANE);
    let near = "--set body.model=solid --set body.size=[0.2,0.2,0.02] --set impactor.point=[0,0.092,0.01] --set impactor.mass=0.1 \
                --set accuracy.tolerance=0.1 --set time.end=1e-4";
    let said = good(&folder, 0, &format!("check scene.toml --full --set accuracy.quantity=stress {near}"));
    assert!(said.stdout.contains("the error of stresses is not estimated for this body"), "{said:?}");
    let said = good(&folder, 0, &format!("run scene.toml -o edge.h5 {near}"));
    assert!(
        said.stdout.contains(
            "m, without an estimate of its error: the hit is 0.40 thicknesses of the impacted layer from an edge"
        ),
        "{said:?}"
    );
    let below = "run scene.toml -o below.h5 --set body.model=solid --set body.size=[0.2,0.2,0.02] --set support.0.surface=bottom \
                 --set accuracy.tolerance=0.1 --set time.end=1e-4";
    let said = good(&folder, 0, below);
    assert!(said.stdout.contains("without an estimate of its error: a support is on the face that is hit"), "{said:?}");
    // Schemes other than modal coordinates do not estimate the error of the cells.
    let other = "run scene.toml -o newmark.h5 --set time.scheme=newmark --set time.step=2e-6 --set time.end=2e-4";
    let said = good(&folder, 0, other);
    assert!(said.stdout.contains("without an estimate of its error: only plates and spline solids"), "{said:?}");
    let path = folder.path().join("edge.h5");
    change(&path, |file| {
        assert!(number::<f64>(file, "stress_error_estimate").is_nan());
        assert!(number::<f64>(file, "largest_stress").is_finite());
    });
}

/// A plate that breaks at its clamped edge has no error estimate. The estimate is for the tension under the impact
/// point, and at a clamped edge solids give higher values with smaller cells. With simply supported edges the largest
/// tension is under the impact point, and has an estimate.
fn tensions_at_clamped_edges_have_no_estimate() {
    let folder = folder(
        "[body]\nmodel = \"mindlin\"\nyoung = 210e9\npoisson = 0.3\ndensity = 7850.0\nsize = [0.2, 0.2, 0.01]\n\
         [[support]]\nsurface = \"side\"\nkind = \"clamped\"\n\
         [impactor]\nmass = 2.0\nradius = 0.2\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\npoint = [0.07, 0.0, 0.005]\n\
         [time]\nend = 5e-4\n[accuracy]\ntolerance = 0.1\n[strength]\ntension = 235e6\n",
    );
    for (more, is_at_edge) in [("", true), (" --set support.0.components=[\"z\"]", false)] {
        let said = good(&folder, 0, &format!("run scene.toml -o out.h5 --force{more}"));
        let file = open(folder.path().join("out.h5"));
        let point = file.attr("largest_stress_point").unwrap().read_raw::<f64>().unwrap();
        assert_eq!((point[0] - 0.1).abs() < 1e-9, is_at_edge, "{said:?}");
        assert_eq!(number::<f64>(&file, "stress_error_estimate").is_nan(), is_at_edge, "{said:?}");
        assert_eq!(said.stdout.contains("without an estimate of its error"), is_at_edge, "{said:?}");
    }
    // With accuracy.quantity = "stress", the messages before and after the run do not call the estimate one of the
    // largest tension.
    let said = good(&folder, 0, "run scene.toml -o out.h5 --force --set accuracy.quantity=stress");
    assert!(said.stdout.contains("without an estimate of its error: it is at a clamped edge"), "{said:?}");
    assert!(!said.stderr.contains("estimated error of the largest tension"), "{said:?}");
    assert!(said.stderr.contains("is for the tension under the impact point, whose estimated error"), "{said:?}");
    // Near the corner of two clamped edges a plate's largest tension is under the impact point, and a solid's is at the
    // edge. The run says so.
    let corner = "--set impactor.point=[0.09,0.09,0.005] --set impactor.mass=0.2 --set impactor.radius=0.025 --set impactor.speed=2.4 --set time.end=1e-4";
    let said = good(&folder, 0, &format!("run scene.toml -o corner.h5 --force {corner}"));
    let file = open(folder.path().join("corner.h5"));
    let point = file.attr("largest_stress_point").unwrap().read_raw::<f64>().unwrap();
    assert!((point[0] - 0.09).abs() < 1e-9 && (point[2] + 0.005).abs() < 1e-9, "{said:?}");
    assert!(number::<f64>(&file, "stress_error_estimate").is_nan(), "{said:?}");
    assert!(said.stdout.contains("the hit is 1.00 thicknesses from a clamped edge"), "{said:?}");
    assert!(said.stderr.contains("warning: the hit is 1.00 thicknesses from a clamped edge"), "{said:?}");
    let of_sweep = "sweep scene.toml --vary impactor.speed=0.9,1 -o sweep.h5";
    good(&folder, 0, of_sweep);
    let errors = open(folder.path().join("sweep.h5")).dataset("members/stress_error_estimate").unwrap();
    assert!(errors.read_raw::<f64>().unwrap().iter().all(|error| error.is_nan()));
    let said = good(&folder, 0, "limit scene.toml --vary impactor.speed=0.5..1");
    assert!(said.stderr.contains("the largest ratio of tension to strength is at a clamped edge"), "{said:?}");
}

/// The error of a tension is estimated in the first contact. `info --json` gives no estimate for a later one, or without
/// a contact.
fn a_tension_after_the_first_contact_has_an_estimate() {
    let folder =
        folder(&std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/laminate.toml")).unwrap());
    let mut estimates = Vec::new();
    for (settings, told) in [
        ("", None),
        (" --set time.end=1e-3", None),
        (" --set time.end=1e-3 --set impactor.gap=0.1", Some("there was no contact")),
    ] {
        // The same cells and basis for all.
        let settings = format!("{settings} --set body.model=layerwise --set body.reduction=60");
        let said = good(&folder, 0, &format!("run scene.toml -o out.h5 --force{settings}")).stdout;
        assert!(told.is_none_or(|told| said.contains(told)), "{said}");
        let facts: Value = serde_json::from_str(&good(&folder, 0, "info out.h5 --json").stdout).unwrap();
        let tension = &facts["largest"]["tension"];
        let estimate = tension["error_estimate"].as_f64();
        assert_eq!(estimate.is_none(), told.is_some(), "{facts}");
        estimates.extend(estimate.map(|error| error * tension["value"].as_f64().unwrap()));
    }
    // In Pa: the whole run contains the first contact, and has a larger tension, to which its error is relative.
    assert!(estimates[0] >= estimates[1], "{estimates:?}");
}
