//! `ricochet plot`: draws results as a figure.

use crate::error::{Error, Result};
use crate::figure::face::draw as draw_face;
use crate::figure::history::{Curve, History, Role, RunCurves, draw};
use crate::figure::sweep as figure;
use crate::record::quantity::{Component, Quantity, quantity};
use crate::record::read;
use crate::record::stress::{FaceMap, STRESS_MAP, StressMaps, Stresses};
use crate::record::sweep::{self as record, Key, Status, Sweep, Values, is_sweep};
use crate::report::face_figure;
use crate::scene::{Geometry, Scene, face_names};
use std::path::{Path, PathBuf};

/// Quantity that is drawn by default.
const DEFAULT: &str = "acceleration";

/// Draws a quantity of the results `files` over time to `out`, one curve for each file and component; or a quantity of
/// a single sweep over its keys. `asked` is the name of the quantity; the default is the acceleration of the impactor.
///
/// # Errors
/// Same as [`quantity`] and [`draw`]; [`Error::Usage`] for a sweep among other files, or for a sweep that cannot be
/// drawn.
pub fn plot(files: &[PathBuf], out: &Path, asked: Option<&str>) -> Result<()> {
    if hdf5_metno::File::open(out).is_ok() {
        return Err(Error::io(out, "is an HDF5 file, so no figure replaces it"));
    }
    for file in files {
        let refuse = |why: &str| Err(Error::Usage(format!("{}: {why}", file.display())));
        match is_sweep(file)? {
            true if files.len() > 1 => return refuse("a sweep has a figure of its own"),
            true => return plot_sweep(file, out, asked.unwrap_or(DEFAULT)),
            false => {}
        }
    }
    let name = asked.unwrap_or(DEFAULT);
    if name == STRESS_MAP || name.strip_prefix(STRESS_MAP).is_some_and(|face| face.starts_with('/')) {
        let face = name[STRESS_MAP.len()..].trim_start_matches('/');
        return match files {
            [file] => plot_maps(file, out, face),
            _ => Err(Error::Usage(format!("--quantity {name}: a map is of one result"))),
        };
    }
    let found = files.iter().map(|file| quantity(file, name)).collect::<Result<Vec<_>>>()?;
    let titles: Vec<&str> = found.iter().map(|found| found.title.trim()).collect();
    let labels = labels(files, &titles);
    let Some(first) = found.first() else { return Err(Error::Usage("a figure shows a result at least".into())) };
    // For a single run, the names of the components are enough in the legend.
    let is_alone = found.len() == 1 && first.parts.len() > 1;
    let mut history = History {
        title: if is_alone { labels[0].clone() } else { String::new() },
        quantity: first.label.clone(),
        unit: with_powers(&first.units),
        runs: Vec::new(),
    };
    for (Quantity { time, parts, contacts, .. }, label) in found.into_iter().zip(labels) {
        let curve = |Component { name, values }: Component| {
            let role = if is_alone && name == "total" { Role::Total } else { Role::Value };
            let label = match name.as_str() {
                "" => label.clone(),
                _ if is_alone => name,
                _ => format!("{label}: {name}"),
            };
            Curve { label, values, role }
        };
        history.runs.push(RunCurves { time, curves: parts.into_iter().map(curve).collect(), contacts });
    }
    draw(&history, out)
}

/// Draws the stress map of a face, or the maps of all faces, each to a file with the name of the face.
fn plot_maps(file: &Path, out: &Path, face: &str) -> Result<()> {
    let refuse = |what: String| Err(Error::Usage(format!("--quantity {STRESS_MAP}: {} has {what}", file.display())));
    let Some(maps) = StressMaps::read(file)? else { return refuse("no map of stresses".to_owned()) };
    let (title, stresses) = (read::history(file)?.title, Stresses::read(file)?);
    let is_wanted = |map: &&FaceMap| face.is_empty() || map.name == face;
    let wanted: Vec<&FaceMap> = maps.faces.iter().filter(is_wanted).collect();
    let names: Vec<&str> = maps.faces.iter().map(|map| map.name.as_str()).collect();
    if wanted.is_empty() {
        return refuse(format!("the faces {}", names.join(", ")));
    }
    for map in wanted {
        let titled = [title.trim(), &map.name].join(if title.trim().is_empty() { "" } else { ": " });
        let Some(mut figure) = face_figure((&maps, map), stresses.as_ref(), titled) else { continue };
        if figure.surface.unread.is_some() {
            figure.note += "; within the dashed circle read at the hit alone";
        }
        let place = if face.is_empty() { with_name(out, &map.name) } else { out.to_owned() };
        draw_face(&figure, &place)?;
    }
    Ok(())
}

/// Adds a name before the extension of a path: `fig.svg` becomes `fig-lower.svg`.
fn with_name(path: &Path, name: &str) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let name = format!("{stem}-{name}");
    path.with_file_name(match path.extension() {
        Some(extension) => format!("{name}.{}", extension.to_string_lossy()),
        None => name,
    })
}

/// Converts a unit from results to one with superscripts: m/s² for m/s2. The unit `1` becomes empty.
fn with_powers(units: &str) -> String {
    units.replace('2', "\u{b2}").replace('3', "\u{b3}").trim_matches('1').to_owned()
}

/// Quantity of a sweep by its name: a dataset of `/members`, or a quantity of runs. The latter stands for the largest
/// value in each run.
fn of_members(name: &str) -> Result<(record::Quantity, figure::Quantity)> {
    let (dataset, label) = match name {
        DEFAULT | "peak_acceleration" => ("peak_acceleration", "peak acceleration".to_owned()),
        "force" => ("peak_force", "peak force".to_owned()),
        "deflection" => ("largest_deflection", "largest deflection".to_owned()),
        "stress" | "largest_stress" => ("largest_stress", "largest tension".to_owned()),
        other => (other, other.replace('_', " ")),
    };
    let Some((quantity, unit)) = record::Quantity::named(dataset) else {
        let names: Vec<&str> = record::Quantity::names().collect();
        return Err(Error::Usage(format!(
            "--quantity {name}: a sweep has acceleration, force, deflection, stress, {}",
            names.join(", ")
        )));
    };
    Ok((quantity, figure::Quantity { label, unit: with_powers(unit), names: Vec::new() }))
}

/// Names of the faces of a sweep's members, from the text of its scene and their numbers. Empty if they are not known,
/// for example on a mesh.
fn names_of_faces(scene: &str, numbers: &[f64]) -> Vec<String> {
    let Ok((scene, _)) = Scene::parse("the sweep's scene", scene, &[]) else { return Vec::new() };
    let Geometry::Box { .. } = scene.body.geometry else { return Vec::new() };
    let names = face_names(scene.hit_layers().len().saturating_sub(1));
    if numbers.iter().any(|number| *number >= names.len() as f64) { Vec::new() } else { names }
}

fn plot_sweep(file: &Path, out: &Path, name: &str) -> Result<()> {
    let (quantity, mut drawn) = of_members(name)?;
    let sweep = Sweep::read(file)?;
    let refuse = |why: String| Err(Error::Usage(format!("{}: {why}", file.display())));
    let Sweep { header, status, .. } = &sweep;
    let is_done = |member: &usize| status[*member] == Status::Done;
    if !(0..status.len()).any(|member| is_done(&member)) {
        return refuse("no member of the sweep is done".into());
    }
    let (title, results) = (header.origin.title.clone(), sweep.quantity(quantity));
    if quantity == record::Quantity::LargestStressFace {
        drawn.names = names_of_faces(&header.origin.scene, results);
    }
    if !results.iter().any(|result| result.is_finite()) {
        return refuse(format!("no member of the sweep has a {}", drawn.label));
    }
    let axis = |key: &Key| figure::Key { label: key.path.clone(), unit: with_powers(&key.units), is_log: key.is_log };
    let numbers = |key: &Key| match &key.values {
        Values::Numbers(numbers) => Some(numbers.clone()),
        Values::Words(_) => None,
    };
    let values: Option<Vec<Vec<f64>>> = header.keys.iter().map(numbers).collect();
    match (header.keys.as_slice(), values.as_deref()) {
        ([key], Some([values])) => {
            let member =
                |n: usize| figure::Member { value: values[n], result: results[n], contacts: sweep.contacts_of(n) };
            let members = (0..status.len()).filter(is_done).map(member).collect();
            figure::draw_curve(&figure::Curve { title, key: axis(key), quantity: drawn, members }, out)
        }
        ([slow, fast], Some([down, along])) => {
            let members = (0..status.len()).map(|n| ([along[n], down[n]], results[n])).collect();
            let keys = [axis(fast), axis(slow)];
            figure::draw_field(&figure::Field { title, keys, quantity: drawn, members }, out)
        }
        (keys, _) => {
            let paths: Vec<&str> = keys.iter().map(|key| key.path.as_str()).collect();
            refuse(format!("a figure shows a sweep over the numbers of one or two keys, not over {}", paths.join(", ")))
        }
    }
}

/// Labels of the files: their titles. The file's name is used if the title is empty, and added if another file has the
/// same title; its path instead if another file has the same name.
fn labels(files: &[PathBuf], titles: &[&str]) -> Vec<String> {
    let names: Vec<String> =
        files.iter().map(|file| file.file_name().unwrap_or_default().to_string_lossy().into_owned()).collect();
    (0..files.len())
        .map(|n| {
            let title = titles[n];
            let alike = titles.iter().filter(|other| **other == title).count() > 1;
            let name = match names.iter().filter(|other| **other == names[n]).count() {
                1 => names[n].clone(),
                _ => files[n].display().to_string(),
            };
            match (title.is_empty(), alike) {
                (true, _) => name,
                (false, true) => format!("{title} ({name})"),
                (false, false) => title.to_owned(),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::labels;
    use std::path::PathBuf;

    #[test]
    fn labels_name_the_file_where_titles_do_not_tell() {
        let files: Vec<PathBuf> = ["a/1.h5", "a/2.h5", "b/2.h5", "3.h5"].map(PathBuf::from).into();
        assert_eq!(
            labels(&files, &["plate", "plate", "plate", ""]),
            ["plate (1.h5)", "plate (a/2.h5)", "plate (b/2.h5)", "3.h5"]
        );
        assert_eq!(labels(&files[..2], &["x", "y"]), ["x", "y"]);
    }
}
