//! Writes the time series of a run during the run.
//!
//! A process may be killed at any moment, so the file must be valid between any two write operations of HDF5. HDF5 is
//! called in short bursts, each of which ends with a flush, about once a second. A flush writes first the data, then
//! the metadata in the order of their addresses, then the length of the file. A burst that allocates no space in the
//! file is therefore safe: it changes only the lengths of the datasets, each in one small write operation after the
//! rows themselves. For this reason a chunk has room for the whole planned series, and the file receives its final name
//! only with its first row, when the chunks exist. Two moments are not safe: the flush in which `/contacts` gets its
//! first chunk (a kill then loses only the contacts), and the flush in which a series outgrows its chunk.

use crate::error::{Error, Result};
use crate::impact::Reading;
use crate::impact::step::Step;
use crate::record::checkpoint;
use crate::record::columns::{CONTACTS, SERIES, append, new_datasets, not_written, put};
use crate::record::episodes::Episodes;
use crate::record::fields;
use crate::record::probes::ProbeDatasets;
use crate::record::provenance::{Cost, Provenance, update_warnings};
use crate::record::read::Rows;
use crate::record::storage::{self, write_scalar};
use crate::record::stress::{EarlierTensions, Faces, LargestTension, MapDatasets, TensionDatasets};
use crate::record::target;
use crate::space::evaluate::TensionMap;
use hdf5_metno as hdf5;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Wall time between two flushes, and thus the largest wall time lost by a kill.
pub(super) const FLUSH_EVERY: Duration = Duration::from_secs(1);
/// Largest number of rows in the buffer; a full buffer is flushed at once (9 MB).
const ROWS_BUFFERED: usize = 1 << 16;
/// Largest number of rows in a chunk (128 MiB; HDF5 allows 4 GiB).
const CHUNK_MOST: usize = 1 << 24;
/// If the number of rows is not planned: bytes of one chunk of each dataset, and the range of its rows. Rows that a run does
/// not have are holes in the file, which its copies need not keep as holes.
const CHUNKS_UNPLANNED: usize = 1 << 19;
const CHUNK_UNPLANNED: [usize; 2] = [16, 1 << 10];
/// Number of contact episodes in a chunk.
const CHUNK_CONTACTS: usize = 64;

/// Recorded part of a run that is continued.
pub struct Earlier {
    /// Path of the result.
    pub result: PathBuf,
    /// `run_id` of the result.
    pub run_id: u64,
    /// Rows of the result so far.
    pub rows: Rows,
    /// Largest tension so far at each point of the faces.
    pub map: TensionMap,
    /// Contact episodes so far.
    pub episodes: Episodes,
}

/// Probes and faces that are read at each step, in addition to the surface under the impactor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Points {
    /// Names of the probes.
    pub probes: Vec<String>,
    /// Faces on which stresses are read.
    pub faces: Faces,
}

/// Open file of a run, with the datasets that are written step by step.
struct Datasets {
    file: hdf5::File,
    series: Vec<hdf5::Dataset>,
    contacts: Vec<hdf5::Dataset>,
    probes: ProbeDatasets,
    tensions: TensionDatasets,
    map: MapDatasets,
}

/// Writes the series and the contacts of one run to a file. Only one process (rank 0) has a writer.
pub struct SeriesWriter {
    path: PathBuf,
    run_id: u64,
    /// Temporary name of the file until the first row is on the disk, then `None`.
    part: Option<PathBuf>,
    datasets: Datasets,
    faces: Faces,
    /// Largest tension of all steps so far at each point, and whether it changed since the last write.
    map: TensionMap,
    map_is_new: bool,
    /// Largest tension of the whole run; NaN if no stresses are read.
    largest: LargestTension,
    /// Warnings and notes of the run.
    warnings: String,
    /// Whether an older result keeps its name until this result is complete.
    waits: bool,
    /// Whether the run continues the result at `path`; the checkpoint of that result is then kept.
    goes_on: bool,
    every: usize,
    buffer: Vec<Step>,
    /// Values of the body read at the steps in `buffer`.
    read: Vec<Reading>,
    rows_written: usize,
    episodes: Episodes,
    episodes_written: usize,
    flushed: Option<Instant>,
}

impl SeriesWriter {
    /// Creates the result `path` of a run described by `provenance`, with datasets for the values at `points`.
    ///
    /// An older result at `path` is replaced, and its checkpoint removed, when the first step has been written. If no
    /// step is written, both remain as they are.
    ///
    /// # Errors
    /// [`Error::Io`] as for [`target::check_writable`], or if writing fails.
    pub fn create(path: &Path, provenance: &Provenance, points: &Points) -> Result<Self> {
        target::check_writable(path, target::Kind::Run)?;
        let begin = |part: &Path| begin(part, provenance, points).map_err(|e| not_written(path, &e));
        let (part, datasets) = target::write_part(&target::resolved(path), begin)?;
        Ok(Self {
            path: path.to_owned(),
            run_id: provenance.run_id,
            part: Some(part),
            datasets,
            faces: points.faces.clone(),
            map: TensionMap::default(),
            map_is_new: false,
            largest: LargestTension::default(),
            warnings: provenance.warnings.clone(),
            waits: false,
            goes_on: false,
            every: 1,
            buffer: Vec::new(),
            read: Vec::new(),
            rows_written: 0,
            episodes: Episodes::default(),
            episodes_written: 0,
            flushed: None,
        })
    }

    /// Creates a result with the rows of an earlier result of the same run; the next steps are appended to it.
    ///
    /// # Errors
    /// Same as [`Self::create`].
    pub fn continued(path: &Path, provenance: &Provenance, points: &Points, earlier: Earlier) -> Result<Self> {
        let provenance = Provenance { run_id: earlier.run_id, ..provenance.clone() };
        let mut writer = Self::create(path, &provenance, points)?;
        writer.goes_on = target::is_same(path, &earlier.result);
        let Rows { columns, probes, tensions } = &earlier.rows;
        let rows = columns.first().map_or(0, Vec::len);
        let copy = || {
            let mut series = writer.datasets.series.iter().zip(columns);
            series.try_for_each(|(dataset, values)| put(dataset, 0, values))?;
            let EarlierTensions { faces, ring } = tensions;
            let ring = ring.clone().unwrap_or_else(|| vec![f64::NAN; rows]);
            writer.datasets.tensions.append(0, faces, &ring)?;
            writer.datasets.probes.append(0, probes)
        };
        copy().map_err(|e| not_written(path, &e))?;
        (writer.rows_written, writer.episodes) = (rows, earlier.episodes);
        (writer.map, writer.map_is_new) = (earlier.map, true);
        Ok(writer)
    }

    /// For a run that computes all steps before the first one is recorded: an older result is replaced only when this
    /// one is complete. If the disk becomes full while writing, the older result remains.
    #[must_use]
    pub fn all_at_once(mut self) -> Self {
        self.waits = self.path.exists();
        self
    }

    /// `run_id` of the result.
    pub fn run_id(&self) -> u64 {
        self.run_id
    }

    /// Number of rows so far, including the buffered ones.
    pub fn rows(&self) -> usize {
        self.rows_written + self.buffer.len()
    }

    /// Largest tension so far at each point of the faces.
    pub fn map(&self) -> &TensionMap {
        &self.map
    }

    /// Contact episodes so far.
    pub fn episodes(&self) -> &Episodes {
        &self.episodes
    }

    /// Records only the steps whose number is a multiple of `n` (0 counts as 1). The contact episodes include all
    /// steps.
    pub fn every(mut self, n: usize) -> Self {
        self.every = n.max(1);
        self
    }

    /// Records the next accepted step, with the values of the body at the step. The first one is on the disk when this returns; later ones follow about once a
    /// second of wall time.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails; the rows remain in the buffer.
    pub fn push(&mut self, step: &Step, reading: &Reading) -> Result<()> {
        self.episodes.push(step);
        if !reading.map.tension.is_empty() {
            self.map.take(&reading.map);
            self.map_is_new = true;
        }
        if step.number.is_multiple_of(self.every) {
            self.buffer.push(*step);
            let Reading { probes, faces, .. } = reading;
            self.read.push(Reading { probes: probes.clone(), faces: faces.clone(), ..Reading::default() });
        }
        let due = self.flushed.is_none_or(|t| t.elapsed() >= FLUSH_EVERY);
        if due || self.buffer.len() >= ROWS_BUFFERED {
            self.flush()?;
        }
        Ok(())
    }

    /// Writes the buffered rows, so that they survive the end of the process.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails (the rows remain in the buffer), or if the file was removed during the run.
    pub fn flush(&mut self) -> Result<()> {
        self.write().map_err(|e| not_written(&self.path, &e))?;
        if self.waits {
            return Ok(());
        }
        if let Some(part) = &self.part {
            if !self.goes_on {
                // The old checkpoint is removed before its result is replaced, so that no result has a checkpoint of
                // another run.
                checkpoint::remove(&self.path)?;
            }
            target::replace_with_part(part, &target::resolved(&self.path)).map_err(|e| Error::io(&self.path, e))?;
            self.part = None;
        }
        // Writing to an open file also succeeds after the file has been removed. An error of the file system does not
        // prove that the file is missing.
        if matches!(self.path.try_exists(), Ok(false)) {
            return Err(Error::io(&self.path, "has been removed while the run was writing it"));
        }
        Ok(())
    }

    /// Links `/fields` and `/VTKHDF` to the fields' file in the folder of the result. VTK readers look for `/VTKHDF`.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn link_fields(&self) -> Result<()> {
        let [fields, _] = fields::paths(&self.path);
        let name = fields.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let link = |as_name: &str| self.datasets.file.link_external(&name, fields::GROUP, as_name);
        link("fields").and_then(|()| link(fields::GROUP)).map_err(|e| not_written(&self.path, &e))
    }

    /// Like [`Self::flush`]; the rows also survive a loss of power.
    ///
    /// # Errors
    /// Same as [`Self::flush`].
    pub fn sync(&mut self) -> Result<()> {
        self.flush()?;
        target::synced(&self.path).map_err(|e| Error::io(&self.path, e))
    }

    /// Whether this process has written to the result.
    pub fn has_begun(&self) -> bool {
        self.flushed.is_some()
    }

    /// Sets the largest tension of the whole run, which [`Self::finish`] writes to the root of the file.
    pub fn set_largest(&mut self, largest: LargestTension) {
        self.largest = largest;
    }

    /// Sets the warnings and notes of the run.
    pub fn set_warnings(&mut self, warnings: String) {
        self.warnings = warnings;
    }

    /// Finishes the result: writes the last rows, the cost of the run, and whether the run is complete. If the run is
    /// not complete and this process has taken no step, the existing result remains as it is.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn finish(mut self, cost: &Cost, complete: bool) -> Result<()> {
        if !complete && !self.has_begun() {
            return Ok(());
        }
        self.write().map_err(|e| not_written(&self.path, &e))?;
        let mark = || {
            let file = &self.datasets.file;
            cost.update(file)?;
            self.largest.update(file, &self.faces.names)?;
            update_warnings(file, &self.warnings)?;
            file.attr("complete")?.write_scalar(&complete)?;
            file.flush()
        };
        mark().map_err(|e| not_written(&self.path, &e))?;
        self.waits = false;
        self.flush()
    }

    fn write(&mut self) -> hdf5::Result<()> {
        let Datasets { file, series, contacts, probes, tensions, map } = &self.datasets;
        // If this fails, the rows remain, and closing the file tries to write them again.
        let (at_probes, on_faces): (Vec<_>, Vec<_>) =
            self.read.iter().map(|read| (&read.probes[..], read.faces.clone())).unzip();
        probes.append(self.rows_written, &at_probes)?;
        let ring: Vec<f64> = self.buffer.iter().map(|step| self.faces.ring(step)).collect();
        tensions.append(self.rows_written, &on_faces, &ring)?;
        if self.map_is_new {
            map.write(&self.map)?;
            self.map_is_new = false;
        }
        append(series, &SERIES, self.rows_written, &self.buffer)?;
        // An open episode changes, so the episode written last is written again.
        let first = self.episodes_written.saturating_sub(1);
        let episodes = &self.episodes.all()[first..];
        append(contacts, &CONTACTS, first, episodes)?;
        file.group("contacts")?.attr("open_at_end")?.write_scalar(&self.episodes.is_open())?;
        file.flush()?;
        self.episodes_written = self.episodes.all().len();
        self.rows_written += self.buffer.len();
        self.buffer.clear();
        self.read.clear();
        self.flushed = Some(Instant::now());
        Ok(())
    }
}

impl Drop for SeriesWriter {
    /// Writes the buffered rows; errors are ignored. A result without a step is removed.
    fn drop(&mut self) {
        let _ = match &self.part {
            Some(part) => fs::remove_file(part).map_err(|e| Error::io(part, e)),
            None => self.flush(),
        };
    }
}

/// Creates the file at `path` with its attributes and its datasets.
fn begin(path: &Path, provenance: &Provenance, points: &Points) -> hdf5::Result<Datasets> {
    let file = storage::create(path)?;
    provenance.write(&file)?;
    Cost::UNKNOWN.write(&file)?;
    LargestTension::begin(&file)?;
    write_scalar(&file, "complete", false)?;
    // A face has its largest stress and the place, a probe three vectors.
    let columns = SERIES.len() + 4 * points.faces.names.len() + 9 * points.probes.len();
    let unplanned = (CHUNKS_UNPLANNED / (8 * columns)).clamp(CHUNK_UNPLANNED[0], CHUNK_UNPLANNED[1]);
    let chunk = provenance.planned_rows.unwrap_or(unplanned).clamp(1, CHUNK_MOST);
    let contacts = new_datasets(&file, &CONTACTS, CHUNK_CONTACTS)?;
    // These come before the series, because the dataset of the time must be the last one.
    let probes = ProbeDatasets::new(&file, &points.probes, chunk)?;
    let tensions = TensionDatasets::new(&file, &points.faces, chunk)?;
    let map = MapDatasets::new(&file, &points.faces.names, &points.faces.map)?;
    let series = new_datasets(&file, &SERIES, chunk)?;
    let group = file.group("contacts")?;
    write_scalar(&group, "open_at_end", false)?;
    Ok(Datasets { file, series, contacts, probes, tensions, map })
}
