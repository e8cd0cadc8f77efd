//! Datasets of probes, `/series/probe/<name>/…`, with three values in each row.

use hdf5_metno as hdf5;
use ndarray::ArrayView2;

use crate::impact::Probe;
use crate::record::columns::{new_rows, put_vectors};
use crate::record::storage::{self, write_text};
use crate::scene::Vec3;

/// Name, unit and value of one quantity of a probe.
type Column = (&'static str, &'static str, fn(&Probe) -> Vec3);

/// Quantities of a probe, in the order of [`ProbeHistory`].
const COLUMNS: [Column; 3] = [
    ("displacement", "m", |probe| probe.displacement),
    ("velocity", "m/s", |probe| probe.velocity),
    ("principal_stress", "Pa", |probe| probe.principal_stress),
];

/// First `rows` rows of the probes `names` of a result: for each row the values of every probe.
pub(super) fn rows(file: &hdf5::File, names: &[String], rows: usize) -> hdf5::Result<Vec<Vec<Probe>>> {
    let mut all = vec![Vec::with_capacity(names.len()); rows];
    for name in names {
        let whole = read(file, "series", name)?;
        if let Some(short) = whole.iter().find(|values| values.len() < 3 * rows) {
            return Err(format!("/series/probe/{name} has {} rows, and its checkpoint {rows}", short.len() / 3).into());
        }
        let [displacement, velocity, principal_stress] = whole.each_ref().map(|values| values.as_chunks().0);
        for (n, row) in all.iter_mut().enumerate() {
            let [displacement, velocity, principal_stress] = [displacement[n], velocity[n], principal_stress[n]];
            row.push(Probe { displacement, velocity, principal_stress });
        }
    }
    Ok(all)
}

/// All rows of a probe: displacement, velocity and principal stress, three numbers in each row.
pub(super) type ProbeHistory = [Vec<f64>; 3];

/// Appends the values of a probe at one step.
pub(super) fn push(whole: &mut ProbeHistory, probe: &Probe) {
    whole.iter_mut().zip(COLUMNS).for_each(|(values, (_, _, value))| values.extend(value(probe)));
}

/// Writes all rows of a probe into the group `parent`.
pub(super) fn write(file: &hdf5::File, parent: &str, name: &str, whole: &ProbeHistory) -> hdf5::Result<()> {
    for (values, (column, units, _)) in whole.iter().zip(COLUMNS) {
        let rows = ArrayView2::from_shape((values.len() / 3, 3), values).map_err(|error| error.to_string())?;
        let path = format!("{parent}/probe/{name}/{column}");
        let dataset = file.new_dataset_builder().with_data(rows).create(path.as_str())?;
        write_text(&dataset, "units", units)?;
    }
    Ok(())
}

/// Reads all rows of a probe from the group `parent`.
pub(super) fn read(file: &hdf5::File, parent: &str, name: &str) -> hdf5::Result<ProbeHistory> {
    let column = |of: &str| storage::read::<f64>(file, &format!("{parent}/probe/{name}/{of}"));
    let [displacement, velocity, stress] = COLUMNS.map(|(of, ..)| column(of));
    Ok([displacement?, velocity?, stress?])
}

/// Datasets of all probes, in the order of the scene.
pub(super) struct ProbeDatasets(Vec<[hdf5::Dataset; 3]>);

impl ProbeDatasets {
    /// Creates empty, extensible datasets; `chunk` is the number of rows in a chunk.
    pub fn new(file: &hdf5::File, names: &[String], chunk: usize) -> hdf5::Result<Self> {
        let new = |name: &String| {
            let [a, b, c] = COLUMNS.map(|(column, units, _)| {
                new_rows::<f64>(file, &format!("series/probe/{name}/{column}"), units, Some(3), chunk)
            });
            Ok([a?, b?, c?])
        };
        names.iter().map(new).collect::<hdf5::Result<_>>().map(Self)
    }

    /// Writes rows, each with the values of every probe, from the row `first` on, and cuts the datasets after them.
    pub fn append(&self, first: usize, rows: &[impl AsRef<[Probe]>]) -> hdf5::Result<()> {
        for (number, datasets) in self.0.iter().enumerate() {
            for (dataset, (_, _, value)) in datasets.iter().zip(COLUMNS) {
                let values: Vec<Vec3> = rows.iter().map(|row| value(&row.as_ref()[number])).collect();
                put_vectors(dataset, first, &values)?;
            }
        }
        Ok(())
    }
}
