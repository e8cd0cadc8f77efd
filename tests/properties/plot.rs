//! Tests of figures of results.

use crate::alone;
use crate::sample::{COST, provenance, step};
use hdf5_metno as hdf5;
use ricochet::cli::plot::plot;
use ricochet::error::Error;
use ricochet::impact::{Probe, Reading};
use ricochet::record::series::{Points, SeriesWriter};
use std::fs;
use std::path::{Path, PathBuf};

/// A result of 10 000 steps, with three contacts.
fn result(folder: &Path, name: &str, title: &str) -> PathBuf {
    let path = folder.join(name);
    let mut writer = SeriesWriter::create(&path, &provenance(title, None), &Points::default()).unwrap();
    (0..10_000).for_each(|n| writer.push(&step(n), &Reading::default()).unwrap());
    writer.finish(&COST, true).unwrap();
    path
}

#[test]
fn svg_has_a_title_a_line_and_the_contacts_of_each_file() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let files = [
        result(folder.path(), "1.h5", "plate <a> & b"),
        result(folder.path(), "2.h5", "twin"),
        result(folder.path(), "3.h5", "twin"),
    ];
    let out = folder.path().join("figure.svg");
    plot(&files, &out, None).unwrap();
    let svg = fs::read_to_string(&out).unwrap();
    for label in ["plate &lt;a&gt; &amp; b", "twin (2.h5)", "twin (3.h5)", "time (ms)"] {
        assert!(svg.contains(label), "{label}");
    }
    for colour in ["#0072B2", "#D55E00", "#009E73"] {
        let lines = svg.matches("<polyline").zip(svg.split("<polyline").skip(1));
        let of_colour: Vec<&str> =
            lines.map(|(_, line)| line.split('>').next().unwrap()).filter(|line| line.contains(colour)).collect();
        // Each colour has one line in the legend, with two points, and one in the plot.
        assert_eq!(of_colour.len(), 2, "{colour}");
        assert_eq!(of_colour[0].matches(',').count(), 2);
        assert!(of_colour[1].matches(',').count() > 1000);
        let bars = svg.split("<rect").filter(|bar| bar.contains(&format!("fill=\"{colour}\"")));
        assert_eq!(bars.count(), 3, "{colour}");
    }
}

#[test]
fn png_decodes_to_a_white_sheet_with_the_curves_on_it() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let files = [result(folder.path(), "1.h5", "plate")];
    let out = folder.path().join("figure.PNG");
    plot(&files, &out, None).unwrap();
    let png = image::load_from_memory(&fs::read(&out).unwrap()).unwrap().into_rgb8();
    assert_eq!(png.dimensions(), (1600, 1000));
    for corner in [(0, 0), (1599, 0), (0, 999), (1599, 999)] {
        assert_eq!(png.get_pixel(corner.0, corner.1).0, [255; 3]);
    }
    // Columns of pixels that contain the curve's colour: the whole width of the plot, for a curve from end to end.
    let blue = |x: u32| (0..1000).any(|y| png.get_pixel(x, y).0 == [0, 114, 178]);
    assert!((0..1600).filter(|x| blue(*x)).count() > 1200);
}

#[test]
fn errors_say_what_is_wrong_with_which_file() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let good = result(folder.path(), "good.h5", "plate");
    let missing = folder.path().join("missing.h5");
    let text = folder.path().join("text.h5");
    fs::write(&text, "no HDF5").unwrap();
    let other = folder.path().join("other.h5");
    hdf5::File::create(&other).unwrap();
    let svg = folder.path().join("figure.svg");
    for (file, reason) in [
        (&missing, "No such file"),
        (&folder.path().to_owned(), "is a folder"),
        (&text, "is not an HDF5 file"),
        (&other, "is not a result of ricochet: it has no series"),
    ] {
        let error = plot(&[good.clone(), file.clone()], &svg, None).unwrap_err();
        assert_eq!(error.status(), 4);
        let message = error.to_string();
        assert!(message.starts_with(&file.display().to_string()) && message.contains(reason), "{message}");
    }
    assert!(!svg.exists());

    for out in ["figure.pdf", "figure"] {
        let error = plot(std::slice::from_ref(&good), Path::new(out), None).unwrap_err();
        assert!(matches!(error, Error::Usage(_)));
        let message = error.to_string();
        assert!(message.contains(".svg") && message.contains(".png"), "{message}");
    }
    for name in ["no/figure.svg", "no/figure.png"] {
        let error = plot(std::slice::from_ref(&good), &folder.path().join(name), None).unwrap_err();
        assert_eq!(error.status(), 4);
    }
}

/// A result of 100 steps with a probe, whose components are 1, 2 and 3 times the step number.
fn probed(folder: &Path) -> PathBuf {
    let path = folder.join("probed.h5");
    let names = ["edge".to_owned()];
    let mut writer = SeriesWriter::create(
        &path,
        &provenance("Plate", None),
        &Points { probes: names.to_vec(), ..Points::default() },
    )
    .unwrap();
    for n in 0..100 {
        let values = [1.0, 2.0, 3.0].map(|factor| factor * n as f64);
        let read = Probe { displacement: values, velocity: values, principal_stress: values };
        writer.push(&step(n), &Reading { probes: vec![read], ..Reading::default() }).unwrap();
    }
    writer.finish(&COST, true).unwrap();
    path
}

#[test]
fn every_quantity_has_its_unit_and_its_components() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let file = probed(folder.path());
    let out = folder.path().join("figure.svg");
    let energies =
        ["kinetic", "elastic", "support", "impactor", "contact", "dissipated", "external", "numerical", "total"];
    for (name, axis, parts) in [
        ("acceleration", "acceleration of the impactor (m/s\u{b2})", &[][..]),
        ("velocity", "velocity of the impactor (m/s)", &[]),
        ("position", "position of the impactor (m)", &[]),
        ("force", "contact force (N)", &[]),
        ("indentation", "indentation (m)", &[]),
        ("deflection", "deflection under the impactor (m)", &[]),
        ("contact/force", "contact force (N)", &[]),
        ("/series/energy/total", "total energy (J)", &[]),
        ("energy", "energy (J)", &energies),
        ("probe/edge/displacement", "displacement at probe edge (m)", &["x", "y", "z"]),
        ("probe/edge/velocity", "velocity at probe edge (m/s)", &["x", "y", "z"]),
        ("probe/edge/principal_stress", "principal stress at probe edge (Pa)", &["largest", "middle", "smallest"]),
    ] {
        plot(std::slice::from_ref(&file), &out, Some(name)).unwrap();
        let svg = fs::read_to_string(&out).unwrap();
        let texts: Vec<&str> = svg.split("</text>").filter_map(|text| text.rsplit('>').next()).map(str::trim).collect();
        assert!(texts.contains(&axis), "{name}: {texts:?}");
        // If there are components, the legend names them and the run's title is above it.
        let legend = if parts.is_empty() { vec!["Plate"] } else { [&["Plate"], parts].concat() };
        assert_eq!(texts[..legend.len()], legend, "{name}");
        // Lines have two points in the legend and more in the plot. Dashed lines, used for many curves, consist of more
        // pieces.
        let lines = svg.split("<polyline").skip(1).map(|line| line.split("/>").next().unwrap().matches(',').count());
        assert!(parts.len() > 5 || lines.filter(|points| *points > 10).count() == parts.len().max(1), "{name}");
    }
    // The columns are the components: the second is twice the first.
    let found = ricochet::record::quantity::quantity(&file, "probe/edge/displacement").unwrap();
    assert_eq!((found.time.len(), found.parts.len()), (100, 3));
    for (part, factor) in found.parts.iter().zip([1.0, 2.0, 3.0]) {
        assert!(part.values.iter().enumerate().all(|(n, value)| *value == factor * n as f64), "{}", part.name);
    }
}

#[test]
fn two_runs_have_the_components_of_each() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let files = [probed(folder.path()), result(folder.path(), "other.h5", "other")];
    let out = folder.path().join("figure.svg");
    plot(&files, &out, Some("energy")).unwrap();
    let svg = fs::read_to_string(&out).unwrap();
    assert!(svg.contains("Plate: kinetic") && svg.contains("other: total"));
    // The second run has no probe.
    let error = plot(&files, &out, Some("probe/edge/velocity")).unwrap_err().to_string();
    assert!(error.contains("other.h5 has acceleration, ") && !error.contains("probe/edge/velocity, "), "{error}");
}

#[test]
fn an_unknown_quantity_is_refused_with_those_there_are() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let file = probed(folder.path());
    let out = folder.path().join("figure.svg");
    for name in ["forces", "", "/", "time", "impactor", "probe/edge", "probe/edge/stress", "../contacts/start"] {
        let error = plot(std::slice::from_ref(&file), &out, Some(name)).unwrap_err();
        assert!(matches!(error, Error::Usage(_)), "{name}: {error}");
        let message = error.to_string();
        for there in ["deflection, energy, energy/kinetic", "probe/edge/principal_stress"] {
            assert!(message.contains(there), "{name}: {message}");
        }
    }
    assert!(!out.exists());
}

/// A bitmap has only the font DejaVu Sans: letters that it lacks are replaced (for example by question marks), and not
/// drawn as boxes, the glyph for missing letters. An SVG keeps the text.
#[test]
fn letters_that_the_font_lacks_are_no_boxes() {
    let _alone = alone();
    let folder = tempfile::tempdir().unwrap();
    let png = |title: &str| {
        let file = result(folder.path(), "title.h5", title);
        let out = folder.path().join("figure.png");
        plot(&[file], &out, None).unwrap();
        fs::read(&out).unwrap()
    };
    assert!(png("\u{5e73}\u{677f} \u{1f389} \u{ff21}") == png("?? ? A"));
    assert!(png("\u{41f}\u{3bb}") != png("??"));
    let file = result(folder.path(), "title.h5", "\u{5e73}\u{677f}");
    let out = folder.path().join("figure.svg");
    plot(&[file], &out, None).unwrap();
    assert!(fs::read_to_string(&out).unwrap().contains("\u{5e73}\u{677f}"));
}
