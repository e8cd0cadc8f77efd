//! Writes the file of a sweep while its members are computed.
//!
//! A process may be killed at any moment. The datasets of the members have their final size from the beginning, so that
//! most flushes move nothing in the file. The status of a member is written when all its other data are on the disk. If
//! something does move, because the table of contacts outgrows its chunk or is written again, or because series are added,
//! the flush writes to a copy of the file, which then replaces it. A full disk does no damage: space is reserved before
//! anything is written, and after an error nothing more is written.

use super::Header;
use super::begin::{begin, chunk};
use super::member::{Member, Quantity, Status};
use super::read::{Sweep, series_path};
use super::room;
use crate::error::{Error, Result};
use crate::record::columns::{CONTACTS, SERIES, append, not_written, put};
use crate::record::episodes::Episode;
use crate::record::lock::Lock;
use crate::record::probes;
use crate::record::storage::{self, write_text};
use crate::record::target;
use hdf5_metno as hdf5;
use hdf5_metno::types::FixedUnicode;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Value of the attribute `kind` of the root.
pub(super) const KIND: &str = "sweep";
/// Reason why a member failed. It has a fixed length, so that its space exists from the beginning.
pub(super) type Message = FixedUnicode<MESSAGE>;
const MESSAGE: usize = 400;
/// Smallest wall time between two flushes, unless many series are waiting.
const MIN_FLUSH_INTERVAL: Duration = Duration::from_secs(1);
/// Smallest ratio of this time to the wall time in which the last flush copied the file. Copying a file with many series
/// takes long.
const MIN_INTERVAL_OVER_COPY_TIME: u32 = 20;
/// Size of the unwritten series at which a flush happens at once: this fraction of the size of the file, within this range
/// of bytes.
const MANY_SERIES_OVER_FILE: f64 = 0.25;
const MANY_SERIES: [u64; 2] = [1 << 26, 1 << 30];

/// Writes a sweep. Only one process (rank 0) has a writer.
pub struct SweepWriter {
    /// The sweep, with the members that are not on the disk yet.
    sweep: Sweep,
    contacts_written: usize,
    /// Whether the next flush writes the contacts again, from the first one on.
    rewrites_contacts: bool,
    /// Whether the file is new and has no member yet.
    is_new: bool,
    /// Members that are not on the disk yet.
    fresh: Vec<Member>,
    /// Upper bound of the bytes of their series.
    series_bytes: u64,
    /// Copy of the file to which the next flush writes, if something moves.
    copy: Option<PathBuf>,
    /// Wall time spent so far on copying the file for the next flush, and on replacing it.
    copying: Duration,
    /// Time of the last flush, and the least wall time from then to the next.
    flushed: Instant,
    pause: Duration,
    /// Whether a write operation has failed. Nothing more is written then, because metadata in memory may refer to data
    /// that are not on the disk.
    has_failed: bool,
    /// Keeps other sweeps from writing the file; released after the file is closed.
    _lock: Lock,
}

impl SweepWriter {
    /// Creates the sweep `path`, or continues it if it exists.
    ///
    /// # Errors
    /// [`Error::Io`] if `path` is another kind of file, or a sweep of another scene or of other values, if it cannot be
    /// written, if another run is writing it, or if its name is reserved ([`Lock::take`]).
    pub fn open(path: &Path, header: &Header) -> Result<Self> {
        let lock = Lock::take(path)?;
        target::check_writable(path, target::Kind::Sweep)?;
        let is_new = !path.exists();
        let file = if is_new {
            create(path, header)?
        } else {
            storage::open_to_write(path).map_err(|error| not_written(path, &error))?
        };
        let read = || {
            let sweep = Sweep::of(path, file)?;
            header.check_same(&sweep.header).map_err(|why| Error::io(path, format!("{why}: choose another file")))?;
            Ok(sweep)
        };
        // A new sweep that cannot be read again is not left behind.
        let sweep = read().inspect_err(|_: &Error| {
            if is_new {
                let _ = std::fs::remove_file(path);
            }
        })?;
        Ok(Self {
            contacts_written: if sweep.matches_file_contacts { sweep.contacts.len() } else { 0 },
            rewrites_contacts: !sweep.matches_file_contacts,
            sweep,
            is_new,
            fresh: Vec::new(),
            series_bytes: 0,
            copy: None,
            copying: Duration::ZERO,
            flushed: Instant::now(),
            pause: MIN_FLUSH_INTERVAL,
            has_failed: false,
            _lock: lock,
        })
    }

    /// The sweep, with the members that are not on the disk yet.
    pub fn sweep(&self) -> &Sweep {
        &self.sweep
    }

    /// Records a member. It is written at the next flush: about a second after the last one, later if copying the file takes
    /// more than a twentieth of a second, and sooner if many series are waiting.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn push(&mut self, member: Member) -> Result<()> {
        let columns = member.series.iter().flatten().map(Vec::len).chain(member.probes.iter().flatten().map(Vec::len));
        let series: u64 = columns.map(|length| room::BYTES_PER_DATASET + 8 * length as u64).sum();
        if let Err(error) = self.make_room(series, member.contacts.len()) {
            // There is space for the earlier members.
            let _ = self.flush();
            self.has_failed = true;
            return Err(error);
        }
        self.series_bytes += series;
        self.take(member);
        let many =
            ((MANY_SERIES_OVER_FILE * self.sweep.file.size() as f64) as u64).clamp(MANY_SERIES[0], MANY_SERIES[1]);
        if self.series_bytes >= many { self.flush() } else { self.flush_if_due() }
    }

    /// Writes the recorded members if the last flush was long enough ago.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn flush_if_due(&mut self) -> Result<()> {
        if self.flushed.elapsed() >= self.pause { self.flush() } else { Ok(()) }
    }

    /// Reserves space at the end of the file, or of its copy if something moves: `series` more bytes for series, and the
    /// space for `contacts` more contacts and for the metadata of HDF5.
    fn make_room(&mut self, series: u64, contacts: usize) -> Result<()> {
        // New contacts may need further chunks, which are allocated whole in each column.
        let chunk = chunk(self.sweep.header.members());
        let more = (self.sweep.contacts.len() + contacts).div_ceil(chunk) - self.contacts_written.div_ceil(chunk);
        let (series, of_contacts) =
            (self.series_bytes + series, 8 * (1 + CONTACTS.len() as u64) * (more * chunk) as u64);
        let file = self.file_to_write(series > 0 || more > 0 || self.rewrites_contacts)?;
        let made = room::make(&file, self.sweep.file.size() + series + of_contacts + room::BYTES_PER_FLUSH);
        made.map_err(|error| Error::io(&self.sweep.path, format!("cannot be written: {}", plain(&error))))
    }

    /// Returns the file that the next flush writes. Makes a copy first if something moves.
    fn file_to_write(&mut self, moves: bool) -> Result<PathBuf> {
        if moves && self.copy.is_none() {
            let begun = Instant::now();
            self.copy = Some(copy_of(&self.sweep.path)?);
            self.copying = begun.elapsed();
        }
        Ok(self.copy.clone().unwrap_or_else(|| target::resolved(&self.sweep.path)))
    }

    /// Converts an error of HDF5 to an error of this file, and remembers it so that nothing more is written.
    fn noted<T>(&mut self, result: hdf5::Result<T>) -> Result<T> {
        self.has_failed |= result.is_err();
        result.map_err(|error| not_written(&self.sweep.path, &error))
    }

    fn take(&mut self, member: Member) {
        let index = member.index;
        if !member.message.is_empty() {
            self.sweep.messages.insert(index, member.message.clone());
        }
        self.sweep.status[index] = member.status;
        self.sweep.quantities.iter_mut().zip(member.quantities).for_each(|(values, value)| values[index] = value);
        self.sweep.contacts.extend(member.contacts.iter().map(|contact| (index, *contact)));
        self.fresh.push(member);
        self.is_new = false;
    }

    /// Writes the recorded members, so that they survive the end of the process.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn flush(&mut self) -> Result<()> {
        if !self.fresh.is_empty() {
            self.write()?;
        }
        self.flushed = Instant::now();
        self.pause = MIN_FLUSH_INTERVAL.max(MIN_INTERVAL_OVER_COPY_TIME * std::mem::take(&mut self.copying));
        Ok(())
    }

    /// Writes to the file, or to its copy, which then replaces the file.
    fn write(&mut self) -> Result<()> {
        let made = self.make_room(0, 0);
        self.has_failed |= made.is_err();
        made?;
        let Some(copy) = self.copy.take() else {
            let written = self.write_to(&self.sweep.file.clone());
            return self.noted(written);
        };
        let file = storage::open_to_write(&copy);
        let written = file.and_then(|file| self.write_to(&file).map(|()| file));
        let (written, begun) = (self.noted(written), Instant::now());
        let replaced = replaced(&self.sweep.path, &copy, written);
        self.has_failed |= replaced.is_err();
        self.sweep.file = replaced?;
        self.copying += begun.elapsed();
        Ok(())
    }

    fn write_to(&mut self, file: &hdf5::File) -> hdf5::Result<()> {
        for member in &self.fresh {
            self.write_texts_and_series(file, member)?;
        }
        self.write_contacts(file)?;
        let members = self.fresh.iter().map(|member| member.index);
        if let (Some(first), Some(last)) = (members.clone().min(), members.max()) {
            let range = first..last + 1;
            for ((_, name, _), values) in Quantity::ALL.iter().zip(&self.sweep.quantities) {
                file.dataset(&format!("members/{name}"))?.write_slice(&values[range.clone()], range.clone())?;
            }
            // The status follows when all other data are on the disk.
            file.flush()?;
            let status: Vec<u8> = self.sweep.status[range.clone()].iter().map(|status| *status as u8).collect();
            file.dataset("members/status")?.write_slice(&status, range)?;
        }
        file.flush()?;
        self.fresh.clear();
        self.series_bytes = 0;
        Ok(())
    }

    fn write_texts_and_series(&self, file: &hdf5::File, member: &Member) -> hdf5::Result<()> {
        let index = member.index;
        if !member.message.is_empty() {
            let message = [fixed(&member.message)];
            file.dataset("members/message")?.write_slice(&message, index..index + 1)?;
        }
        if let Some(series) = member.series.as_ref().filter(|_| member.status == Status::Done) {
            // Of a member whose status did not reach the disk.
            let root = file.group("series")?;
            if root.link_exists(&index.to_string()) {
                root.unlink(&index.to_string())?;
            }
            for (values, column) in series.iter().zip(&SERIES) {
                let path = series_path(index, column.path);
                let dataset = file.new_dataset_builder().with_data(values).create(path.as_str())?;
                write_text(&dataset, "units", column.units)?;
            }
            for (name, whole) in self.sweep.header.probes.iter().zip(&member.probes) {
                probes::write(file, &format!("series/{index}"), name, whole)?;
            }
        }
        Ok(())
    }

    fn write_contacts(&mut self, file: &hdf5::File) -> hdf5::Result<()> {
        let (first, end) = (self.contacts_written, self.sweep.contacts.len());
        let (members, contacts): (Vec<u64>, Vec<Episode>) =
            self.sweep.contacts[first..].iter().map(|(member, contact)| (*member as u64, *contact)).unzip();
        put(&file.dataset("contacts/member")?, first, &members)?;
        let columns = CONTACTS.iter().map(|column| file.dataset(column.path)).collect::<hdf5::Result<Vec<_>>>()?;
        append(&columns, &CONTACTS, first, &contacts)?;
        (self.contacts_written, self.rewrites_contacts) = (end, false);
        Ok(())
    }

    /// Finishes the file for this call of the program: sorts the contacts by member, and writes whether all members are
    /// present.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn finish(&mut self) -> Result<()> {
        // Without a copy the members need no more space on the disk. Sorting the contacts does.
        if self.copy.is_none() {
            self.flush()?;
        }
        if !self.sweep.contacts.is_sorted_by_key(|(member, _)| *member) {
            self.sweep.contacts.sort_by_key(|(member, _)| *member);
            (self.contacts_written, self.rewrites_contacts) = (0, true);
        }
        if self.rewrites_contacts || !self.fresh.is_empty() {
            self.write()?;
        }
        let is_complete = self.mine().all(|member| self.sweep.status[member] != Status::Missing);
        let mark = || {
            self.sweep.file.attr("complete")?.write_scalar(&is_complete)?;
            self.sweep.file.flush()
        };
        let marked = mark();
        self.noted(marked)?;
        room::give_back(&self.sweep.path, self.sweep.file.size()).map_err(|error| Error::io(&self.sweep.path, error))
    }

    /// Members that belong to this file: all, or the ones of its shard.
    pub fn mine(&self) -> impl Iterator<Item = usize> + use<> {
        let (first, pace) = self.sweep.header.shard.map_or((0, 1), |(i, n)| (i - 1, n));
        (first..self.sweep.status.len()).step_by(pace)
    }
}

impl Drop for SweepWriter {
    /// Writes the recorded members; errors are ignored. A new sweep without a member is removed.
    fn drop(&mut self) {
        if self.has_failed {
            // Closing the file would write the data in memory, so it is left open until the process ends.
            std::mem::forget(self.sweep.file.clone());
        }
        let _ = match self.is_new {
            _ if self.has_failed => Ok(()),
            true => fs::remove_file(target::resolved(&self.sweep.path)).map_err(|e| Error::io(&self.sweep.path, e)),
            false => self.flush(),
        };
        if let Some(copy) = &self.copy {
            let _ = fs::remove_file(copy);
        }
    }
}

/// Creates the file of a sweep without members.
fn create(path: &Path, header: &Header) -> Result<hdf5::File> {
    let file = target::resolved(path);
    let created = target::write_part(&file, |part| {
        let begun = begin(part, header).map_err(|error| not_written(path, &error))?;
        fs::rename(part, &file).map(|()| begun).map_err(|error| Error::io(path, error))
    });
    created.map(|(_, file)| file)
}

/// Copies a file for a change. The copy is in the same folder.
fn copy_of(path: &Path) -> Result<PathBuf> {
    let file = target::resolved(path);
    let copied = target::write_part(&file, |copy| {
        fs::copy(&file, copy).map_err(|error| Error::io(path, format!("cannot be written: {}", plain(&error))))
    });
    copied.map(|(copy, _)| copy)
}

/// Replaces a file by its copy with the changes (`written`), which is returned open. If writing has failed, the copy is
/// removed.
fn replaced(path: &Path, copy: &Path, written: Result<hdf5::File>) -> Result<hdf5::File> {
    let replaced = written.and_then(|file| {
        target::replace_with_part(copy, &target::resolved(path)).map(|()| file).map_err(|error| Error::io(path, error))
    });
    if replaced.is_err() {
        let _ = fs::remove_file(copy);
    }
    replaced
}

/// Error text of the operating system without the error number.
fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

/// Text cut to [`MESSAGE`] bytes, with NUL characters replaced by spaces.
fn fixed(text: &str) -> Message {
    storage::cut(text, MESSAGE).replace('\0', " ").parse().unwrap_or_default()
}
