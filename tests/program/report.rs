//! Tests of `ricochet report`: the content of the page for results of all kinds, and its validity.

use std::fs;
use std::path::Path;
use std::process::Command;

use mpi_test::{PlainTest, tests};
use scraper::Html;
use tempfile::TempDir;

use crate::page::{count, says, select, strictly};
use crate::program::{BOX, LIMIT, ricochet, run, send, start, wait_for_writes};
use crate::restarts::refused;
use crate::results::{change, folder, good, long, words};
use crate::stresses;
use crate::texts::set_text;

pub const TESTS: &[PlainTest] = tests![
    a_plate_in_modal_coordinates,
    a_solid_in_steps_with_markup_in_its_names,
    an_interrupted_run_is_called_so,
    a_half_space_has_no_faces,
    tension_is_held_against_the_strength,
    layers_that_relax_have_their_chains,
    earlier_results_have_a_report,
    one_result_has_one_page,
    what_is_no_result_of_a_run_is_refused,
];

pub const IN_A_BROWSER: &[PlainTest] = tests![pages_are_sound_in_a_browser];

const PANE: &str = include_str!("../../scenes/pane.toml");

/// Makes the report of out.h5, and reads the page strictly.
fn report(folder: &TempDir) -> Html {
    good(folder, 0, "report out.h5 -o report.html");
    let text = fs::read_to_string(folder.path().join("report.html")).unwrap();
    let page = strictly(&text);
    let headings: Vec<String> = select(&page, "h2").collect();
    let wanted =
        ["Summary", "Scene", "Model", "History of the impact", "Contacts", "Largest tension", "Probes", "Energies"];
    assert_eq!(headings, [&wanted[..], &["Provenance"]].concat());
    assert!(!text.contains("NaN") && !text.contains("inf "), "a number is none");
    page
}

fn a_plate_in_modal_coordinates() {
    let folder = folder(PANE);
    let said = good(&folder, 0, "run scene.toml -o out.h5").stdout;
    let page = report(&folder);
    says(
        &page,
        &[
            "A rigid impactor of 2 kg with a surface radius of 50 mm hits a box of 0.5 × 0.5 × 0.02 m at 3 m/s",
            "Young’s modulus",
            "70 GPa",
            "Mindlin’s plate",
            "by ricochet, the cheapest theory that meets the tolerance. Shear and the local field change mindlin by",
            "cells of splines",
            "Estimated error in the first contact",
            "Estimated error of the deflection under the impactor",
            "Largest principal stress on each face",
            "lower face (opposite)",
            "The scene gives no strength.",
            "Largest values at the probes",
            "constant, but for rounding",
            concat!("ricochet ", env!("CARGO_PKG_VERSION"), ", commit "),
        ],
    );
    // The peak that the run has printed, in kN.
    let peak: f64 = said.split("peak force ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    says(&page, &[&format!("{:.2} kN", 1e-3 * peak)]);
    assert_eq!(select(&page, ".verdict").count(), 0);
    assert_eq!(select(&page, "details code").collect::<String>().trim(), PANE.trim());
    // Force, deflection, tension on the faces, its two maps, tension and displacement at the probe, energies.
    assert_eq!(count(&page, "figure"), 8);
}

/// Any text in a scene stays text, in HTML and in SVG.
fn a_solid_in_steps_with_markup_in_its_names() {
    let title = r#"</title><script>alert("1")</script> & <b>'x'</b>"#;
    let scene = BOX.replace("\"Small plate\"", &format!("'''{title}'''"))
        + "[output]\nprobes = [{ name = \"<i>&amp;\", point = [0.1, 0, -0.01] }, { name = \"b\", point = [0, 0, -0.01] }]\n";
    let folder = folder(&scene);
    good(&folder, 2, "run scene.toml -o out.h5 --set output.stress=false -- -snes_rtol 1e-10");
    let page = report(&folder);
    assert_eq!(select(&page, "h1").next().as_deref(), Some(title));
    says(&page, &["Three-dimensional elasticity", "by the scene", "<i>&amp;", "not estimated", "-snes_rtol 1e-10"]);
    says(
        &page,
        &[
            "This result holds no stresses on the faces of the body.",
            "Supports: none. The body is free.",
            "Loads: none but the impact.",
        ],
    );
    // In the wide and the narrow form of both figures of the probes.
    assert_eq!(select(&page, "svg text").filter(|text| text.trim() == "<i>&amp;").count(), 4);
}

fn an_interrupted_run_is_called_so() {
    let folder = folder(&long());
    let out = folder.path().join("out.h5");
    let started = start(ricochet(folder.path(), 0).args(words("run scene.toml -o out.h5")));
    while !out.exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    wait_for_writes(&out, 1);
    send("TERM", &started.child.id().to_string());
    assert_eq!(started.wait(LIMIT).status, Some(130));
    let page = report(&folder);
    says(&page, &["Incomplete. The run was ended at", "of 10 s", "not complete", "(the run did not reach its end)"]);
    assert_eq!(select(&page, ".verdict.open").count(), 1);
}

/// A half-space has no faces, but has a ring around the contact.
fn a_half_space_has_no_faces() {
    let folder = folder(
        &PANE.replace("[body]", "[body]\nmodel = \"half-space\"").replace("[output]", "").replace("probes = ", "# "),
    );
    good(&folder, 0, "run scene.toml -o out.h5");
    let page = report(&folder);
    says(
        &page,
        &["Half-space: the local indentation alone", "This result holds no stresses on the faces of the body."],
    );
    says(&page, &["The scene has no probes.", "the only contact"]);
}

/// A result of the small box with added stresses, and with a strength in its scene.
fn with_strength(strength: &str, passed_at: f64) -> TempDir {
    let folder = folder(BOX);
    good(&folder, 0, "run scene.toml -o out.h5 --set output.stress=false");
    change(&folder.path().join("out.h5"), |file| {
        stresses::add(file, passed_at);
        set_text(file, "scene", &format!("{BOX}[strength]\n{strength}\n"));
    });
    folder
}

/// The tension is compared with the strength: 41 MPa on the lower face, 12 MPa on the upper one, with an error of 5%.
fn tension_is_held_against_the_strength() {
    for (strength, passed_at, verdict, text) in [
        (
            "tension = 60e6",
            f64::NAN,
            "good",
            "Strength not exceeded. On the lower face (opposite) the largest tension, 41.00 MPa",
        ),
        ("tension = 42e6", f64::NAN, "open", "Strength undecided."),
        ("tension = 40e6", 4e-4, "bad", "the strength is first exceeded at 0.4000 ms"),
        // The upper face uses a larger fraction of its strength.
        (
            "[strength.face]\nupper = 10e6\nlower = 100e6",
            2e-4,
            "bad",
            "On the upper face (hit) the largest tension, 12.00 MPa, is 120 % of the strength of 10 MPa",
        ),
    ] {
        let folder = with_strength(strength, passed_at);
        let page = report(&folder);
        let verdicts: Vec<String> = select(&page, &format!(".verdict.{verdict}")).collect();
        assert!(verdicts.len() == 1 && verdicts[0].contains(text), "{strength}: {verdicts:?}");
        says(&page, &["(10, −20, −10) mm", "Hertz’s radial tension reaches 90.00 MPa", "5.0 % of the peak"]);
        // Both faces and their limits are drawn, in both forms of the figure.
        let drawn = select(&page, "svg text").filter(|text| text.trim().starts_with("strength ")).count();
        assert_eq!(drawn, if strength.contains("face") { 4 } else { 2 });
    }
    // The strength is exceeded first on a face other than the one that uses the largest fraction of its strength.
    let folder = with_strength("[strength.face]\nupper = 10e6\nlower = 40e6", 2e-4);
    let page = report(&folder);
    let verdict: String = select(&page, ".verdict.bad").collect();
    assert!(verdict.contains("the strength of the lower face (opposite) is first exceeded at 0.2000 ms"), "{verdict}");
    // The estimate is for the first contact: a later tension has none.
    let folder = with_strength("tension = 60e6", f64::NAN);
    change(&folder.path().join("out.h5"), |file| {
        let end = file.dataset("contacts/end").unwrap().read_raw::<f64>().unwrap()[0];
        file.attr("largest_stress_time").unwrap().write_scalar(&(1.01 * end)).unwrap();
        file.attr("stress_error_estimate").unwrap().write_scalar(&f64::NAN).unwrap();
        set_text(file, "stress_without_estimate", "it is after the first contact");
    });
    let page = report(&folder);
    says(&page, &["Estimated error of the largest tension: not estimated (it is after the first contact)."]);
    assert_eq!(select(&page, ".verdict.good").count(), 0);
    assert!(select(&page, "body").all(|text| !text.contains("5.0 % of the peak")));
    let folder = with_strength("", f64::NAN);
    assert_eq!(select(&report(&folder), ".verdict").count(), 0);
}

/// The report shows the Prony series of viscoelastic layers. There are two interlayers of one material, at a
/// temperature that shortens its relaxation times to a hundredth; and the constants at t → 0.
fn layers_that_relax_have_their_chains() {
    let layer = |thickness: f64, material: &str| {
        format!("[[body.layer]]\nthickness = {thickness}\nmaterial = \"{material}\"\n")
    };
    let glass = layer(0.006, "glass");
    let film = layer(0.00152, "film");
    let scene = format!(
        "[body]\nsize = [0.3, 0.3]\nmodel = \"layerwise\"\nreduction = 20\ntemperature = 71.6\n{glass}{film}{glass}{film}{glass}\
         [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
         [material.film]\nbulk = 2e9\ndensity = 1100.0\nshear = 0.4e6\n\
         prony = [{{ modulus = 7.5e6, time = 0.3 }}, {{ modulus = 12e6, time = 2e-3 }}]\n\
         wlf = {{ c1 = 4.0, c2 = 51.6, reference = 20.0 }}\n\
         [impactor]\nmass = 2.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n[time]\nend = 1e-4\n"
    );
    let folder = folder(&scene);
    good(&folder, 0, "run scene.toml -o out.h5 --set output.stress=false");
    let page = report(&folder);
    let relaxing = "Shear modulus of layer 2 (film), layer 4 (film) at 71.6 °C: G(t) = G∞ + Σ Gᵢ exp(−t/τᵢ), 19.90 MPa at t → 0 and G∞ = 0.4 MPa";
    // log₁₀ a_T = −4 · 51.6/103.2
    let shifted = "The times above are those at 71.6 °C: the given ones, which hold at T₀, times a_T = 0.01000";
    says(&page, &[shifted, "C₁ = 4, C₂ = 51.6 K and T₀ = 20 °C"]);
    let layers =
        ["Layer 2 (film)1.52 mm thick, Young’s modulus at t → 0 ", "Layer 3 (glass)6 mm thick, Young’s modulus 70 GPa"];
    says(&page, &[relaxing, layers[0], layers[1]]);
    // The shorter relaxation time comes first.
    let cells: Vec<String> = select(&page, "td").collect();
    assert!(cells.windows(2).any(|moduli| moduli == ["12.00", "7.500"]), "{cells:?}");
}

/// A report can be made from results without the additions of later versions, and with a scene that this version does
/// not understand.
fn earlier_results_have_a_report() {
    let folder = folder(BOX);
    good(&folder, 0, "run scene.toml -o out.h5");
    change(&folder.path().join("out.h5"), |file| {
        for name in ["discretisation", "model_reason", "first_contact_error"] {
            file.delete_attr(name).unwrap();
        }
        set_text(file, "scene", &BOX.replace("[body]", "[body]\ncolour = \"<red>\""));
    });
    let page = report(&folder);
    says(&page, &["This version of ricochet cannot read the scene (", "body.colour", "An impactor of 52 kg hits"]);
}

fn one_result_has_one_page() {
    let folder = folder(BOX);
    good(&folder, 0, "run scene.toml -o out.h5");
    report(&folder);
    let once = fs::read(folder.path().join("report.html")).unwrap();
    good(&folder, 2, "report out.h5 -o again.html");
    assert!(fs::read(folder.path().join("again.html")).unwrap() == once);
    good(&folder, 0, "report ./out.h5 -o report.html");
    assert!(fs::read(folder.path().join("report.html")).unwrap() == once);
}

fn what_is_no_result_of_a_run_is_refused() {
    let folder = folder(BOX);
    good(&folder, 0, "sweep scene.toml --vary impactor.speed=1,2 -o sweep.h5");
    good(&folder, 0, "run scene.toml -o out.h5");
    let there = || fs::read_dir(&folder).unwrap().count();
    let before = there();
    for (line, status, why) in [
        ("report sweep.h5 -o r.html", 4, "sweep.h5: is a sweep, and the result of a run is needed"),
        ("report scene.toml -o r.html", 4, "scene.toml: is not an HDF5 file"),
        ("report missing.h5 -o r.html", 4, "missing.h5: No such file"),
        ("report out.h5 -o r.pdf", 2, "r.pdf: a report is an .html file"),
        ("report out.h5 -o out.h5", 2, "out.h5: a report is an .html file"),
        ("report out.h5 -o no/r.html", 4, "no/r.html: "),
    ] {
        refused(&folder, line, status, &[why]);
    }
    fs::copy(folder.path().join("out.h5"), folder.path().join("o.html")).unwrap();
    refused(&folder, "report out.h5 -o o.html", 4, &["o.html: is an HDF5 file, so no report replaces it"]);
    assert_eq!(there(), before + 1);
}

/// Pages are valid on narrow and wide screens and in print; `-o out/report` keeps the pictures.
fn pages_are_sound_in_a_browser() {
    let reader = Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/readers/page.py");
    let plate = folder(PANE);
    good(&plate, 0, "run scene.toml -o out.h5");
    let tense = with_strength("[strength.face]\nupper = 10e6\nlower = 100e6", 2e-4);
    let long = folder(&(BOX.replace("Small plate", &"A_title_without_a_space_".repeat(8)) + &many()));
    good(&long, 0, "run scene.toml -o out.h5");
    for folder in [plate, tense, long] {
        report(&folder);
        let outcome = run(Command::new("/usr/bin/python3").arg(&reader).arg("report.html").current_dir(&folder));
        assert_eq!(outcome.status, Some(0), "{outcome:#?}");
    }
}

/// A scene with eight probes with long names, and supports of every kind.
fn many() -> String {
    let probe = |n: usize| format!("{{ name = \"a probe with a long name, {n}\", point = [0.1, 0.0{n}, -0.01] }}");
    let probes: Vec<String> = (0..8).map(probe).collect();
    format!(
        "[output]\nprobes = [{}]\n[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [1e7, 2.5e8, 1e9]\ndamping = 1e4\n\
         [[support]]\nsurface = \"bottom\"\nwithin = {{ disc = {{ centre = [0.2, 0.2, -0.01], radius = 0.03 }} }}\nkind = \"pad\"\n\
         normal = [0, 0, -1]\nstiffness = 1e9\n\
         [[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -1e3]\n",
        probes.join(", ")
    )
}
