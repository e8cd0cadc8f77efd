//! Reads any series of a result for a figure.

use crate::error::{Error, Result};
use crate::record::columns::SERIES;
use crate::record::episodes::Episode;
use crate::record::read::{check_run, column, contacts, not_result, open};
use crate::record::storage::{self, text};
use crate::record::stress::{STRESS_MAP, order};
use hdf5_metno as hdf5;
use std::path::Path;

/// Quantity over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// Title of the scene; may be empty.
    pub title: String,
    /// Name for the axis of a figure.
    pub label: String,
    /// Unit, as stored in the file.
    pub units: String,
    /// Time of each row, s.
    pub time: Vec<f64>,
    /// Components; one for a scalar.
    pub parts: Vec<Component>,
    /// Contact episodes.
    pub contacts: Vec<Episode>,
}

/// Component of a quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Component {
    /// Name of the component; empty for the only one.
    pub name: String,
    /// Value in each row.
    pub values: Vec<f64>,
}

/// Short name of a dataset.
struct Named {
    name: &'static str,
    /// Path below `/series`.
    dataset: &'static str,
    label: &'static str,
}

const NAMES: [Named; 6] = [
    named("acceleration", "impactor/acceleration", "acceleration of the impactor"),
    named("velocity", "impactor/velocity", "velocity of the impactor"),
    named("position", "impactor/position", "position of the impactor"),
    named("force", "contact/force", "contact force"),
    named("indentation", "contact/indentation", "indentation"),
    named("deflection", "contact/surface_displacement", "deflection under the impactor"),
];

const fn named(name: &'static str, dataset: &'static str, label: &'static str) -> Named {
    Named { name, dataset, label }
}

/// The name of the largest tensions on all faces together.
const STRESS: &str = "stress";
/// The name of all energies together.
const ENERGY: &str = "energy";

/// Reads a quantity of the result `path`. The name is a short name such as `force`, or the path of a dataset below
/// `/series`. After a kill, the lengths of the datasets may differ by the rows of one flush; only the rows present in
/// all of them are returned.
///
/// # Errors
/// [`Error::Usage`] with the list of available quantities if the result does not have this one; otherwise as for
/// [`super::read::history`].
pub fn quantity(path: &Path, name: &str) -> Result<Quantity> {
    let file = open(path)?;
    check_run(&file, path)?;
    let mut time = column(&file, path, "series/time")?;
    let contacts = contacts(&file, path)?;
    let title = text(&file, "title").map_err(|_| not_result(path, "it has no title"))?;
    let short = name.trim_start_matches('/');
    let short = short.strip_prefix("series/").unwrap_or(short);
    let known = NAMES.iter().find(|named| named.name == short || named.dataset == short);
    let dataset_name = known.map_or(short, |named| named.dataset);
    let (label, datasets) = if short == STRESS {
        let mut faces = file.group("series/stress").and_then(|group| group.member_names()).unwrap_or_default();
        faces.sort_by(|one, other| order(one).cmp(&order(other)));
        let of_face = |face: String| Some((face.clone(), series_dataset(&file, &format!("{STRESS}/{face}/largest"))?));
        ("largest tension".to_owned(), faces.into_iter().filter_map(of_face).collect())
    } else if short == ENERGY {
        let prefix = format!("series/{ENERGY}/");
        let parts = SERIES.iter().filter_map(|column| column.path.strip_prefix(&prefix)).map(|part| {
            let dataset = series_dataset(&file, &format!("{ENERGY}/{part}"));
            dataset.map(|dataset| (part.to_owned(), dataset))
        });
        (ENERGY.to_owned(), parts.flatten().collect())
    } else {
        let label = known.map_or_else(|| label(short), |named| named.label.to_owned());
        let dataset = series_dataset(&file, dataset_name).filter(|_| short != "time");
        (label, dataset.into_iter().map(|dataset| (String::new(), dataset)).collect::<Vec<_>>())
    };
    let Some((_, first)) = datasets.first() else {
        let there = there(&file).join(", ");
        return Err(Error::Usage(format!("--quantity {name}: {} has {there}", path.display())));
    };
    let units = text(first, "units").unwrap_or_default();
    let mut parts = Vec::new();
    for (name, dataset) in &datasets {
        let values = storage::values::<f64>(dataset);
        let values = values.map_err(|e| not_result(path, &format!("{} cannot be read ({e})", dataset.name())))?;
        match dataset.shape()[..] {
            [_, columns] if columns > 0 => parts.extend((0..columns).map(|n| Component {
                name: component(dataset_name, n),
                values: values.iter().skip(n).step_by(columns).copied().collect(),
            })),
            _ => parts.push(Component { name: name.clone(), values }),
        }
    }
    let rows = parts.iter().map(|part| part.values.len()).fold(time.len(), usize::min);
    time.truncate(rows);
    parts.iter_mut().for_each(|part| part.values.truncate(rows));
    Ok(Quantity { title, label, units, time, parts, contacts })
}

/// Dataset below `/series`; `None` if it does not exist.
fn series_dataset(file: &hdf5::File, name: &str) -> Option<hdf5::Dataset> {
    file.dataset(&format!("series/{name}")).ok()
}

/// Label of a dataset without an entry in [`NAMES`].
fn label(dataset: &str) -> String {
    match dataset.split('/').collect::<Vec<_>>()[..] {
        [ENERGY, part] => format!("{part} energy"),
        [STRESS, "ring"] => "tension at the edge of the contact".to_owned(),
        [STRESS, face, "largest"] => format!("largest tension on face {face}"),
        ["probe", name, what] => format!("{} at probe {name}", what.replace('_', " ")),
        _ => dataset.to_owned(),
    }
}

/// Name of a column of a dataset with several columns.
fn component(dataset: &str, column: usize) -> String {
    let names = if dataset.ends_with("principal_stress") { ["largest", "middle", "smallest"] } else { ["x", "y", "z"] };
    names.get(column).map_or_else(|| column.to_string(), |name| (*name).to_owned())
}

/// Names of the quantities available in a result.
fn there(file: &hdf5::File) -> Vec<String> {
    let is_there = |dataset: &str| series_dataset(file, dataset).is_some();
    let members = |group: &str| file.group(group).and_then(|group| group.member_names()).unwrap_or_default();
    let known = NAMES.iter().filter(|named| is_there(named.dataset)).map(|named| named.name.to_owned());
    let energies = SERIES.iter().filter_map(|column| column.path.strip_prefix("series/energy/"));
    let energies: Vec<String> = energies.map(|part| format!("{ENERGY}/{part}")).filter(|name| is_there(name)).collect();
    let all_energies = (!energies.is_empty()).then(|| ENERGY.to_owned());
    let faces = members("series/stress");
    let of_faces = faces.iter().map(|face| match face.as_str() {
        "ring" => format!("{STRESS}/ring"),
        face => format!("{STRESS}/{face}/largest"),
    });
    let all_faces = faces.iter().any(|face| face != "ring").then(|| STRESS.to_owned());
    let map = file.group(STRESS_MAP).is_ok().then(|| STRESS_MAP.to_owned());
    let of_probe = |probe: String| {
        let datasets = members(&format!("series/probe/{probe}")).into_iter();
        datasets.map(move |dataset| format!("probe/{probe}/{dataset}"))
    };
    let of_probes = members("series/probe").into_iter().flat_map(of_probe);
    known.chain(all_energies).chain(energies).chain(all_faces).chain(of_faces).chain(map).chain(of_probes).collect()
}
