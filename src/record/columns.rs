//! Datasets of a series and of a table of contacts, and writing of rows to them.

use crate::error::Error;
use crate::impact::step::Step;
use crate::record::episodes::Episode;
use crate::record::storage::write_text;
use crate::scene::Vec3;
use hdf5_metno as hdf5;
use hdf5_metno::plist::dataset_create::FillTime;
use ndarray::ArrayView2;
use std::path::Path;

/// Dataset: its path in the file, its unit, and the function that returns its value from a record.
pub(super) struct Column<T> {
    pub path: &'static str,
    pub units: &'static str,
    pub value: fn(&T) -> f64,
}

/// All datasets under `/series`. The time is last: HDF5 flushes in the order of the addresses, so after a kill during a
/// flush no dataset is shorter than the time.
pub(super) const SERIES: [Column<Step>; 16] = [
    column("series/impactor/position", "m", |s| s.impactor.position),
    column("series/impactor/velocity", "m/s", |s| s.impactor.velocity),
    column("series/impactor/acceleration", "m/s2", |s| s.impactor.acceleration),
    column("series/contact/force", "N", |s| s.contact.force),
    column("series/contact/indentation", "m", |s| s.contact.indentation),
    column("series/contact/surface_displacement", "m", |s| s.contact.surface_displacement),
    column("series/energy/kinetic", "J", |s| s.energy.kinetic),
    column("series/energy/elastic", "J", |s| s.energy.elastic),
    column("series/energy/support", "J", |s| s.energy.support),
    column("series/energy/impactor", "J", |s| s.energy.impactor),
    column("series/energy/contact", "J", |s| s.energy.contact),
    column("series/energy/dissipated", "J", |s| s.energy.dissipated),
    column("series/energy/external", "J", |s| s.energy.external),
    column("series/energy/numerical", "J", |s| s.energy.numerical),
    column("series/energy/total", "J", |s| s.energy.total),
    column("series/time", "s", |s| s.time),
];

/// All datasets under `/contacts`.
pub(super) const CONTACTS: [Column<Episode>; 5] = [
    column("contacts/start", "s", |e| e.start),
    column("contacts/end", "s", |e| e.end),
    column("contacts/peak_force", "N", |e| e.peak_force),
    column("contacts/peak_time", "s", |e| e.peak_time),
    column("contacts/impulse", "N s", |e| e.impulse),
];

const fn column<T>(path: &'static str, units: &'static str, value: fn(&T) -> f64) -> Column<T> {
    Column { path, units, value }
}

/// Error of HDF5 in one line. It gives the reason from the operating system if there is one, for example a full disk.
pub(super) fn not_written(path: &Path, error: &hdf5::Error) -> Error {
    let text = error.to_string();
    let system = text.split_once("error message = '").and_then(|(_, rest)| rest.split('\'').next());
    let reason = system.or(text.lines().next()).unwrap_or_default();
    Error::io(path, format!("cannot be written: {reason}"))
}

/// Creates an empty, extensible dataset for each column; `chunk` is the number of rows in a chunk.
pub(super) fn new_datasets<T>(
    file: &hdf5::File,
    columns: &[Column<T>],
    chunk: usize,
) -> hdf5::Result<Vec<hdf5::Dataset>> {
    let new = |column: &Column<T>| new_rows::<f64>(file, column.path, column.units, None, chunk);
    columns.iter().map(new).collect()
}

/// Creates an empty dataset that is extensible by rows, of `columns` values each if given; `chunk` is the number of rows in a
/// chunk.
pub(super) fn new_rows<T: hdf5::H5Type>(
    group: &hdf5::Group,
    path: &str,
    units: &str,
    columns: Option<usize>,
    chunk: usize,
) -> hdf5::Result<hdf5::Dataset> {
    let builder = group.new_dataset::<T>();
    let builder = match columns {
        None => builder.shape((0..,)).chunk((chunk,)),
        Some(columns) => builder.shape((0.., columns)).chunk((chunk, columns)),
    };
    // Without a chunk cache and a fill value, only new rows are written; the rest of a chunk is a hole in the file.
    let dataset = builder.chunk_cache(0, 0, 1.0).fill_time(FillTime::Never).create(path)?;
    write_text(&dataset, "units", units)?;
    Ok(dataset)
}

/// Writes `records` to the rows from `first` on, and cuts the datasets after them.
pub(super) fn append<T>(
    datasets: &[hdf5::Dataset],
    columns: &[Column<T>],
    first: usize,
    records: &[T],
) -> hdf5::Result<()> {
    let put = |(dataset, column): (&hdf5::Dataset, &Column<T>)| {
        put(dataset, first, &records.iter().map(column.value).collect::<Vec<f64>>())
    };
    datasets.iter().zip(columns).try_for_each(put)
}

/// Writes numbers to the rows of a dataset from `first` on, and cuts it after them.
pub(super) fn put<T: hdf5::H5Type>(dataset: &hdf5::Dataset, first: usize, values: &[T]) -> hdf5::Result<()> {
    let end = first + values.len();
    if dataset.size() != end {
        dataset.resize((end,))?;
    }
    dataset.write_slice(values, first..end)
}

/// The same for vectors, of a dataset with three columns.
pub(super) fn put_vectors(dataset: &hdf5::Dataset, first: usize, values: &[Vec3]) -> hdf5::Result<()> {
    let end = first + values.len();
    if dataset.shape() != [end, 3] {
        dataset.resize((end, 3))?;
    }
    dataset.write_slice(ArrayView2::from(values), (first..end, ..))
}
