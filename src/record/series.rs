//! The series of a run, written while it goes on.
//!
//! A process may be killed at any moment, so the file has to be whole between any two writes that HDF5 makes. HDF5 is
//! called in short bursts that end with a flush, about once a second. Within a flush HDF5 writes data first, then
//! metadata in the order of the addresses, then the length of the file, so a burst is safe if it allocates nothing:
//! then it changes the lengths of the datasets only, each in one small write, after the rows themselves. That is why
//! a chunk holds the whole planned series, and why the file takes its name only with its first row, when the chunks
//! are there. Not safe is the moment of a flush in which `/contacts` gets its first chunk
//! (it alone is lost then), or in which a series outgrows its chunk.

use crate::error::{Error, Result};
use crate::impact::step::Step;
use crate::impact::{Probe, Reading};
use crate::record::checkpoint;
use crate::record::columns::{CONTACTS, SERIES, append, new_datasets, not_written};
use crate::record::episodes::Episodes;
use crate::record::fields;
use crate::record::probes::ProbeDatasets;
use crate::record::provenance::{Cost, Provenance, write_scalar};
use crate::record::stress::{EarlierTensions, Faces, LargestTension, MapDatasets, TensionDatasets, rings};
use crate::record::target;
use crate::space::evaluate::TensionMap;
use hdf5_metno as hdf5;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Wall time between two flushes: what a kill may cost.
pub(super) const FLUSH_EVERY: Duration = Duration::from_secs(1);
/// Rows that a buffer holds at most, however fast they come (9 MB).
const ROWS_BUFFERED: usize = 1 << 16;
/// Rows in a chunk where their number is not planned, and at most (128 MiB; HDF5 allows 4 GiB).
const CHUNK_UNPLANNED: usize = 1 << 15;
const CHUNK_MOST: usize = 1 << 24;
/// Episodes in a chunk.
const CHUNK_CONTACTS: usize = 64;

/// What is there of a run that goes on.
pub struct Earlier {
    /// Its result.
    pub result: PathBuf,
    /// Its `run_id`.
    pub run_id: u64,
    /// Every column of the series, all of the same number of rows.
    pub columns: Vec<Vec<f64>>,
    /// Of each row what every probe has read.
    pub probes: Vec<Vec<Probe>>,
    /// Its stresses.
    pub tensions: EarlierTensions,
    /// The map of them.
    pub map: TensionMap,
    /// The contacts.
    pub episodes: Episodes,
}

impl Earlier {
    fn rows(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }
}

/// What a run reads of its body at each step beside the surface under the impactor.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Points {
    /// Names of the probes.
    pub probes: Vec<String>,
    /// The faces.
    pub faces: Faces,
}

/// Writes the series and the contacts of one run to a file. One process (rank 0) has it.
pub struct SeriesWriter {
    path: PathBuf,
    run_id: u64,
    /// The file's name until the first row is on the disk.
    part: Option<PathBuf>,
    file: hdf5::File,
    series: Vec<hdf5::Dataset>,
    contacts: Vec<hdf5::Dataset>,
    probes: ProbeDatasets,
    faces: Faces,
    tensions: TensionDatasets,
    map_datasets: MapDatasets,
    /// Of all steps so far, and whether it is not in the file yet.
    map: TensionMap,
    map_is_new: bool,
    /// Of the whole run, where stresses are read.
    largest: LargestTension,
    /// Whether an older result keeps its name until this one is whole.
    waits: bool,
    /// Whether it goes on with the result that is at `path`, whose checkpoint then stays.
    goes_on: bool,
    every: usize,
    buffer: Vec<Step>,
    /// What was read at the buffer's steps.
    read: Vec<Reading>,
    rows_written: usize,
    episodes: Episodes,
    episodes_written: usize,
    flushed: Option<Instant>,
}

impl SeriesWriter {
    /// Begins the result `path` of a run described by `provenance`.
    ///
    /// An older result at `path` is replaced, and its checkpoint removed, when the first step has been written; both are untouched if it
    /// never is.
    ///
    /// # Errors
    /// [`Error::Io`] as of [`target::check_writable`], or when writing fails.
    pub fn create(path: &Path, provenance: &Provenance) -> Result<Self> {
        Self::with_points(path, provenance, &Points::default())
    }

    /// The same with groups for what is read of the body.
    ///
    /// # Errors
    /// As [`Self::create`].
    pub fn with_points(path: &Path, provenance: &Provenance, points: &Points) -> Result<Self> {
        target::check_writable(path, target::Kind::Run)?;
        let part = target::part(&target::resolved(path))?;
        let begun = begin(&part, provenance, points);
        if begun.is_err() {
            // The error in hand says more than one of the removal would.
            let _ = fs::remove_file(&part);
        }
        let Begun { file, series, contacts, probes, tensions, map } = begun.map_err(|e| not_written(path, &e))?;
        Ok(Self {
            path: path.to_owned(),
            run_id: provenance.run_id,
            part: Some(part),
            file,
            series,
            contacts,
            probes,
            faces: points.faces.clone(),
            tensions,
            map_datasets: map,
            map: TensionMap::default(),
            map_is_new: false,
            largest: LargestTension::default(),
            waits: false,
            goes_on: false,
            every: 1,
            buffer: Vec::new(),
            read: Vec::new(),
            rows_written: 0,
            episodes: Episodes::new(provenance.impactor_mass),
            episodes_written: 0,
            flushed: None,
        })
    }

    /// Begins a result with what an earlier one of the same run holds, to which the next steps are added.
    ///
    /// # Errors
    /// As [`Self::create`].
    pub fn continued(path: &Path, provenance: &Provenance, points: &Points, earlier: Earlier) -> Result<Self> {
        let provenance = Provenance { run_id: earlier.run_id, ..provenance.clone() };
        let mut writer = Self::with_points(path, &provenance, points)?;
        writer.goes_on = target::is_same(path, &earlier.result);
        let rows = earlier.rows();
        let copy = || {
            for (dataset, values) in writer.series.iter().zip(&earlier.columns) {
                dataset.resize((rows,))?;
                dataset.write_slice(values, 0..rows)?;
            }
            let EarlierTensions { faces, ring } = &earlier.tensions;
            writer.tensions.append(0, faces, ring.as_deref().unwrap_or_default())?;
            writer.probes.append(0, &earlier.probes)
        };
        copy().map_err(|e| not_written(path, &e))?;
        (writer.rows_written, writer.episodes) = (rows, earlier.episodes);
        (writer.map, writer.map_is_new) = (earlier.map, true);
        Ok(writer)
    }

    /// For a run whose steps are all there before the first of them is told: an older result is replaced when this one has its end, so that
    /// a disk that fills meanwhile costs nothing.
    #[must_use]
    pub fn all_at_once(mut self) -> Self {
        self.waits = self.path.exists();
        self
    }

    /// The run's.
    pub fn run_id(&self) -> u64 {
        self.run_id
    }

    /// Rows so far.
    pub fn rows(&self) -> usize {
        self.rows_written + self.buffer.len()
    }

    /// The largest tension so far at each point of the faces.
    pub fn map(&self) -> &TensionMap {
        &self.map
    }

    /// The episodes so far.
    pub fn episodes(&self) -> &Episodes {
        &self.episodes
    }

    /// Records only the steps whose number is a multiple of `n` (0 counts as 1). The contacts are those of all steps.
    pub fn every(mut self, n: usize) -> Self {
        self.every = n.max(1);
        self
    }

    /// Takes the next accepted step. The first one is on the disk when this returns; later ones follow about once a
    /// second of wall time.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails; the rows stay in the buffer.
    pub fn push(&mut self, step: &Step) -> Result<()> {
        self.push_read(step, &Reading::default())
    }

    /// The same with what was read of the body at the step.
    ///
    /// # Errors
    /// As [`Self::push`].
    pub fn push_read(&mut self, step: &Step, reading: &Reading) -> Result<()> {
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

    /// Writes what is buffered, so that it outlives the process.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails; the rows stay in the buffer.
    pub fn flush(&mut self) -> Result<()> {
        self.write().map_err(|e| not_written(&self.path, &e))?;
        if self.waits {
            return Ok(());
        }
        if let Some(part) = &self.part {
            if !self.goes_on {
                // Before the result that it belongs to: no result is ever beside another one's.
                checkpoint::remove(&self.path)?;
            }
            target::replace_with_part(part, &target::resolved(&self.path)).map_err(|e| Error::io(&self.path, e))?;
            self.part = None;
        }
        // An open file is written to the end also where nobody can find it any more. A file system that does not answer proves nothing.
        if matches!(self.path.try_exists(), Ok(false)) {
            return Err(Error::io(&self.path, "has been removed while the run was writing it"));
        }
        Ok(())
    }

    /// Has `/fields`, and `/VTKHDF`, which readers of VTK look for, lead into the fields' file beside the result.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
    pub fn link_fields(&self) -> Result<()> {
        let [fields, _] = fields::paths(&self.path);
        let name = fields.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let link = |as_name: &str| self.file.link_external(&name, fields::GROUP, as_name);
        link("fields").and_then(|()| link(fields::GROUP)).map_err(|e| not_written(&self.path, &e))
    }

    /// [`Self::flush`], so that it outlives a loss of power too.
    ///
    /// # Errors
    /// As [`Self::flush`].
    pub fn sync(&mut self) -> Result<()> {
        self.flush()?;
        target::synced(&self.path).map_err(|e| Error::io(&self.path, e))
    }

    /// Whether anything of this process is in the result.
    pub fn has_begun(&self) -> bool {
        self.flushed.is_some()
    }

    /// What the root is to say of the largest tension of the whole run.
    pub fn set_largest(&mut self, largest: LargestTension) {
        self.largest = largest;
    }

    /// Ends the result: the last rows, what the run cost, and whether it came to its end. A run that has not come to its end, nor taken a
    /// step in this process, leaves what was there.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
    pub fn finish(mut self, cost: &Cost, complete: bool) -> Result<()> {
        if !complete && !self.has_begun() {
            return Ok(());
        }
        self.write().map_err(|e| not_written(&self.path, &e))?;
        let mark = || {
            cost.update(&self.file)?;
            self.largest.update(&self.file, &self.faces.names)?;
            self.file.attr("complete")?.write_scalar(&complete)?;
            self.file.flush()
        };
        mark().map_err(|e| not_written(&self.path, &e))?;
        self.waits = false;
        self.flush()
    }

    fn write(&mut self) -> hdf5::Result<()> {
        let (probes, tensions): (Vec<_>, Vec<_>) =
            self.read.iter_mut().map(|read| (std::mem::take(&mut read.probes), read.faces.clone())).unzip();
        self.probes.append(self.rows_written, &probes)?;
        self.tensions.append(self.rows_written, &tensions, &rings(&self.faces, &self.buffer))?;
        if std::mem::take(&mut self.map_is_new) {
            self.map_datasets.write(&self.map)?;
        }
        append(&self.series, &SERIES, self.rows_written, &self.buffer)?;
        // An open episode grows, so the last one that was written may have changed.
        let first = self.episodes_written.saturating_sub(1);
        let episodes = &self.episodes.all()[first..];
        append(&self.contacts, &CONTACTS, first, episodes)?;
        self.file.group("contacts")?.attr("open_at_end")?.write_scalar(&self.episodes.is_open())?;
        self.file.flush()?;
        self.episodes_written = self.episodes.all().len();
        self.rows_written += self.buffer.len();
        self.buffer.clear();
        self.read.clear();
        self.flushed = Some(Instant::now());
        Ok(())
    }
}

impl Drop for SeriesWriter {
    /// Writes what is buffered; an error has nobody to go to. A result without a step leaves nothing behind.
    fn drop(&mut self) {
        let _ = match &self.part {
            Some(part) => fs::remove_file(part).map_err(|e| Error::io(part, e)),
            None => self.flush(),
        };
    }
}

struct Begun {
    file: hdf5::File,
    series: Vec<hdf5::Dataset>,
    contacts: Vec<hdf5::Dataset>,
    probes: ProbeDatasets,
    tensions: TensionDatasets,
    map: MapDatasets,
}

/// The file at `path` with its attributes, and its datasets under `/series` and `/contacts`.
fn begin(path: &Path, provenance: &Provenance, points: &Points) -> hdf5::Result<Begun> {
    let file = hdf5::File::create(path)?;
    provenance.write(&file)?;
    Cost::UNKNOWN.write(&file)?;
    LargestTension::begin(&file)?;
    write_scalar(&file, "complete", false)?;
    let chunk = provenance.planned_rows.unwrap_or(CHUNK_UNPLANNED).clamp(1, CHUNK_MOST);
    let contacts = new_datasets(&file, &CONTACTS, CHUNK_CONTACTS)?;
    // Before the series, whose time is to come last.
    let probes = ProbeDatasets::new(&file, &points.probes, chunk)?;
    let tensions = TensionDatasets::new(&file, &points.faces, chunk)?;
    let map = MapDatasets::new(&file, &points.faces.names, &points.faces.map)?;
    let series = new_datasets(&file, &SERIES, chunk)?;
    let group = file.group("contacts")?;
    write_scalar(&group, "open_at_end", false)?;
    Ok(Begun { file, series, contacts, probes, tensions, map })
}
