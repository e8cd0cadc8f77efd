//! Figures of results.

use crate::alone;
use crate::sample::{COST, provenance, step};
use hdf5_metno as hdf5;
use ricochet::cli::plot::plot;
use ricochet::error::Error;
use ricochet::record::series::SeriesWriter;
use std::fs;
use std::path::{Path, PathBuf};

/// A result of 10 000 steps, with three contacts.
fn result(folder: &Path, name: &str, title: &str) -> PathBuf {
    let path = folder.join(name);
    let mut writer = SeriesWriter::create(&path, &provenance(title, None)).unwrap();
    (0..10_000).for_each(|n| writer.push(&step(n)).unwrap());
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
    plot(&files, &out).unwrap();
    let svg = fs::read_to_string(&out).unwrap();
    for label in ["plate &lt;a&gt; &amp; b", "twin (2.h5)", "twin (3.h5)", "time (ms)"] {
        assert!(svg.contains(label), "{label}");
    }
    for colour in ["#0072B2", "#D55E00", "#009E73"] {
        let lines = svg.matches("<polyline").zip(svg.split("<polyline").skip(1));
        let of_colour: Vec<&str> =
            lines.map(|(_, line)| line.split('>').next().unwrap()).filter(|line| line.contains(colour)).collect();
        // One in the legend, of two points; one in the plot.
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
    plot(&files, &out).unwrap();
    let png = image::load_from_memory(&fs::read(&out).unwrap()).unwrap().into_rgb8();
    assert_eq!(png.dimensions(), (1600, 1000));
    for corner in [(0, 0), (1599, 0), (0, 999), (1599, 999)] {
        assert_eq!(png.get_pixel(corner.0, corner.1).0, [255; 3]);
    }
    // Columns that hold the curve's colour: all of the plot's, for a curve from end to end.
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
        (&other, "is not a result of ricochet: there is no dataset /series/time"),
    ] {
        let error = plot(&[good.clone(), file.clone()], &svg).unwrap_err();
        assert_eq!(error.status(), 4);
        let message = error.to_string();
        assert!(message.starts_with(&file.display().to_string()) && message.contains(reason), "{message}");
    }
    assert!(!svg.exists());

    for out in ["figure.pdf", "figure"] {
        let error = plot(std::slice::from_ref(&good), Path::new(out)).unwrap_err();
        assert!(matches!(error, Error::Usage(_)));
        let message = error.to_string();
        assert!(message.contains(".svg") && message.contains(".png"), "{message}");
    }
    for name in ["no/figure.svg", "no/figure.png"] {
        let error = plot(std::slice::from_ref(&good), &folder.path().join(name)).unwrap_err();
        assert_eq!(error.status(), 4);
    }
}
