//! Reads results: provenance, series, contacts and stresses.

use crate::error::{Error, Result};
use crate::impact::Probe;
use crate::impact::step::Step;
use crate::record::columns::{CONTACTS, Column, SERIES};
use crate::record::episodes::Episode;
use crate::record::probes;
use crate::record::provenance::{Cost, Provenance};
use crate::record::quantity::{Quantity, quantity};
use crate::record::series::Points;
use crate::record::storage;
use crate::record::stress::{self, EarlierTensions};
use crate::record::sweep::is_one as is_sweep;
use crate::record::target::is_locked;
use hdf5_metno as hdf5;
use std::path::Path;

/// Provenance of a result.
///
/// # Errors
/// Same as [`history`].
pub fn provenance(path: &Path) -> Result<Provenance> {
    origin(path).map(|(provenance, ..)| provenance)
}

/// Provenance of a result, the cost of its run, and whether the run is complete.
///
/// # Errors
/// Same as [`history`]; [`Error::Io`] if attributes are missing.
pub fn origin(path: &Path) -> Result<(Provenance, Cost, bool)> {
    let file = open(path)?;
    check_run(&file, path)?;
    let read = || Ok((Provenance::read(&file)?, Cost::read(&file)?, file.attr("complete")?.read_scalar()?));
    read().map_err(|e: hdf5::Error| Error::io(path, format!("is not a result of this version of ricochet: {e}")))
}

/// First rows of a result, by kind: all with the same number of rows.
#[derive(Debug, Default)]
pub struct Rows {
    /// Columns of the series in the order of `SERIES`.
    pub columns: Vec<Vec<f64>>,
    /// Values of every probe, for each row.
    pub probes: Vec<Vec<Probe>>,
    /// Largest tensions on the faces, and the tension at the edge of the contact, for each row.
    pub tensions: EarlierTensions,
}

impl Rows {
    /// First `rows` rows of the result `path`, with those of its `points`. The tension at the edge of the contact is read if it
    /// is recorded; missing rows of it are NaN.
    ///
    /// # Errors
    /// [`Error::Io`] if the file cannot be opened, or if a dataset is missing or has fewer rows.
    pub fn read(path: &Path, points: &Points, rows: usize) -> Result<Self> {
        let file = open(path)?;
        let of_column = |column: &Column<Step>| {
            let read = storage::read::<f64>(&file, column.path);
            let mut values = read.map_err(|e| Error::io(path, format!("/{} cannot be read ({e})", column.path)))?;
            if values.len() < rows {
                let reason = format!("/{} has {} rows, and its checkpoint {rows}", column.path, values.len());
                return Err(Error::io(path, reason));
            }
            values.truncate(rows);
            Ok(values)
        };
        let wrong =
            |what: &'static str| move |e: hdf5::Error| Error::io(path, format!("its {what} cannot be read: {e}"));
        let mut ring = storage::read::<f64>(&file, "series/stress/ring").ok();
        ring.iter_mut().for_each(|ring| ring.resize(rows, f64::NAN));
        let faces = stress::rows(&file, &points.faces.names, rows).map_err(wrong("stresses"))?;
        Ok(Self {
            columns: SERIES.iter().map(of_column).collect::<Result<_>>()?,
            probes: probes::rows(&file, &points.probes, rows).map_err(wrong("probes"))?,
            tensions: EarlierTensions { faces, ring },
        })
    }
}

/// Reads the acceleration history of the result `path`. After a kill, the lengths of the datasets may differ by the
/// rows of one flush; only the rows present in all of them are returned.
///
/// # Errors
/// [`Error::Io`], which says whether the file is missing, not HDF5, still being written, or not a result of ricochet.
pub fn history(path: &Path) -> Result<Quantity> {
    quantity(path, "acceleration").map_err(|error| match error {
        Error::Usage(_) => not_result(path, "it has no acceleration"),
        other => other,
    })
}

/// Contact episodes of a result.
#[derive(Debug, Clone, PartialEq)]
pub struct Contacts {
    /// Episodes in the order of time.
    pub episodes: Vec<Episode>,
    /// Whether the last episode continues at the last step.
    pub is_open: bool,
}

/// Reads the contact episodes of the result `path`.
///
/// # Errors
/// Same as [`history`].
pub fn episodes(path: &Path) -> Result<Contacts> {
    let file = open(path)?;
    check_run(&file, path)?;
    let open_at_end = file.group("contacts").and_then(|group| group.attr("open_at_end")?.read_scalar::<bool>());
    Ok(Contacts { episodes: contacts(&file, path)?, is_open: open_at_end.unwrap_or_default() })
}

/// Contact episodes of a result. After a kill, only those that are in all datasets.
pub(super) fn contacts(file: &hdf5::File, path: &Path) -> Result<Vec<Episode>> {
    let columns = CONTACTS.iter().map(|of| column(file, path, of.path)).collect::<Result<Vec<_>>>()?;
    let count = columns.iter().map(Vec::len).min().unwrap_or_default();
    Ok((0..count).map(|n| Episode::of_columns(std::array::from_fn(|column| columns[column][n]))).collect())
}

/// Values of a one-dimensional dataset of a result.
pub(super) fn column(file: &hdf5::File, path: &Path, name: &str) -> Result<Vec<f64>> {
    let dataset = file.dataset(name).map_err(|_| not_result(path, &format!("there is no dataset /{name}")))?;
    if dataset.ndim() != 1 {
        return Err(not_result(path, &format!("/{name} has {} dimensions, not 1", dataset.ndim())));
    }
    storage::values::<f64>(&dataset).map_err(|e| not_result(path, &format!("/{name} cannot be read ({e})")))
}

/// Checks that a file is the result of a run. Otherwise the error says what the file is.
pub(super) fn check_run(file: &hdf5::File, path: &Path) -> Result<()> {
    let is_checkpoint = file.dataset("names").is_ok() && file.attr("run_id").is_ok();
    let what = match file.group("series") {
        _ if is_sweep(file) => {
            "is a sweep, and the result of a run is needed (`ricochet info` and `ricochet plot` read sweeps)"
        }
        Ok(_) => return Ok(()),
        Err(_) if is_checkpoint => "is a checkpoint: give the result that it lies beside",
        Err(_) if storage::has_group(file, "VTKHDF") => {
            "holds the fields of a run: give the result that it lies beside"
        }
        Err(_) => "is not a result of ricochet: it has no series",
    };
    Err(Error::io(path, what))
}

/// Error for a file that is not a result, with the reason.
pub(super) fn not_result(path: &Path, why: &str) -> Error {
    Error::io(path, format!("is not a result of ricochet: {why}"))
}

/// Opens a result for reading.
///
/// # Errors
/// [`Error::Io`], which says whether the file is missing, not HDF5, or still being written.
pub(super) fn open(path: &Path) -> Result<hdf5::File> {
    if let Err(e) = std::fs::File::open(path) {
        return Err(Error::io(path, e));
    }
    storage::open(path).map_err(|e| not_opened(path, &e))
}

fn not_opened(path: &Path, error: &hdf5::Error) -> Error {
    if path.is_dir() {
        return Error::io(path, "is a folder");
    }
    if is_locked(error) {
        let reason =
            "is still being written by a run (with HDF5_USE_FILE_LOCKING=FALSE in the environment it can be read)";
        return Error::io(path, reason);
    }
    if error.contains_minor(hdf5::MinorErrorCode::NotHdf5) {
        return Error::io(path, "is not an HDF5 file");
    }
    Error::io(path, error)
}
