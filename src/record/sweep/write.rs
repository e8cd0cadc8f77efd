//! Writes the file of a sweep while its members are computed.
//!
//! A process may be killed at any moment. The datasets of the members have their final size from the beginning, so that
//! a flush moves nothing in the file. The status of a member is written when all its other data are on the disk. Two
//! moments are not safe: the flush in which the table of contacts outgrows its chunk, and the flush in which series are
//! added. A full disk does no damage: space is reserved before anything is written, and after an error nothing more is
//! written.

use super::Header;
use super::begin::{begin, chunk, new_quantity};
use super::member::{Member, Quantity, Status};
use super::read::{Sweep, series_path};
use super::room;
use crate::error::{Error, Result};
use crate::record::columns::{CONTACTS, SERIES, append, not_written};
use crate::record::episodes::Episode;
use crate::record::probes;
use crate::record::provenance::write_text;
use crate::record::target;
use hdf5_metno as hdf5;
use hdf5_metno::types::FixedUnicode;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Value of the attribute `kind` of the root.
pub(super) const KIND: &str = "sweep";
/// Reason why a member failed. It has a fixed length, so that its space exists from the beginning.
pub(super) type Message = FixedUnicode<MESSAGE>;
const MESSAGE: usize = 400;
/// Wall time between two flushes, and thus the largest wall time lost by a kill.
const FLUSH_EVERY: Duration = Duration::from_secs(1);

/// Writes a sweep. Only one process (rank 0) has a writer.
pub struct SweepWriter {
    path: PathBuf,
    file: hdf5::File,
    header: Header,
    /// Status of each member. This and the following fields include members that are not on the disk yet.
    status: Vec<Status>,
    quantities: Vec<Vec<f64>>,
    contacts: Vec<(usize, Episode)>,
    contacts_written: usize,
    messages: BTreeMap<usize, String>,
    /// Whether the file is new and has no member yet.
    is_new: bool,
    /// Members that are not on the disk yet.
    fresh: Vec<usize>,
    flushed: Instant,
    /// Whether a write operation has failed. Nothing more is written then, because metadata in memory may refer to data
    /// that are not on the disk.
    has_failed: bool,
}

impl SweepWriter {
    /// Creates the sweep `path`, or continues it if it exists.
    ///
    /// # Errors
    /// [`Error::Io`] if `path` is another kind of file, or a sweep of another scene or of other values, or if it cannot
    /// be written.
    pub fn open(path: &Path, header: &Header) -> Result<Self> {
        target::check_writable(path, target::Kind::Sweep)?;
        if path.exists() { Self::resume(path, header) } else { Self::create(path, header) }
    }

    fn create(path: &Path, header: &Header) -> Result<Self> {
        let part = target::part(&target::resolved(path))?;
        let begun = begin(&part, header).map_err(|error| not_written(path, &error));
        let named = begun
            .and_then(|file| fs::rename(&part, target::resolved(path)).map(|()| file).map_err(|e| Error::io(path, e)));
        if named.is_err() {
            // The present error says more than an error of the removal.
            let _ = fs::remove_file(&part);
        }
        let members = header.members();
        Ok(Self {
            path: path.to_owned(),
            file: named?,
            header: header.clone(),
            status: vec![Status::Missing; members],
            quantities: vec![vec![f64::NAN; members]; Quantity::ALL.len()],
            contacts: Vec::new(),
            contacts_written: 0,
            messages: BTreeMap::new(),
            is_new: true,
            fresh: Vec::new(),
            flushed: Instant::now(),
            has_failed: false,
        })
    }

    fn resume(path: &Path, header: &Header) -> Result<Self> {
        let file = hdf5::File::open_rw(path).map_err(|error| not_written(path, &error))?;
        let sweep = Sweep::of(path, file)?;
        header.check_same(&sweep.header).map_err(|why| Error::io(path, format!("{why}: choose another file")))?;
        let file = sweep.file();
        // Quantities that an earlier version did not store.
        let missing = Quantity::ALL.iter().filter(|(_, name, _)| !file.link_exists(&format!("members/{name}")));
        missing
            .into_iter()
            .try_for_each(|quantity| new_quantity(file, quantity, header.members()))
            .map_err(|error| not_written(path, &error))?;
        Ok(Self {
            path: path.to_owned(),
            header: sweep.header.clone(),
            status: sweep.status.clone(),
            quantities: sweep.quantities.clone(),
            contacts: sweep.contacts.clone(),
            // All are written again, because some may belong to members whose status did not reach the disk.
            contacts_written: 0,
            messages: sweep.messages.clone(),
            is_new: false,
            fresh: Vec::new(),
            flushed: Instant::now(),
            has_failed: false,
            file: sweep.into_file(),
        })
    }

    /// Header of the file, as it was created.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Status of each member.
    pub fn status(&self) -> &[Status] {
        &self.status
    }

    /// Reasons for the failures, by member.
    pub fn messages(&self) -> &BTreeMap<usize, String> {
        &self.messages
    }

    /// Values of a quantity, one for each member; NaN where it is unknown.
    pub fn quantity(&self, quantity: Quantity) -> &[f64] {
        &self.quantities[quantity as usize]
    }

    /// Records a member. It is on the disk about a second later.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn push(&mut self, member: &Member) -> Result<()> {
        let columns = member.series.iter().flatten().map(Vec::len).chain(member.probes.iter().flatten().map(Vec::len));
        let series: u64 = columns.map(|length| room::BYTES_PER_DATASET + 8 * length as u64).sum();
        if let Err(error) = self.make_room(series, member.contacts.len()) {
            // There is space for the earlier members.
            let _ = self.flush();
            self.has_failed = true;
            return Err(error);
        }
        let taken = self.take(member);
        self.noted(taken)?;
        self.flush_if_due()
    }

    /// Writes the recorded members if the last flush was at least a second ago.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn flush_if_due(&mut self) -> Result<()> {
        if self.flushed.elapsed() >= FLUSH_EVERY { self.flush() } else { Ok(()) }
    }

    /// Reserves space at the end of the file: `series` bytes for series, and the space for `contacts` more contacts and
    /// for the metadata of HDF5.
    fn make_room(&self, series: u64, contacts: usize) -> Result<()> {
        // New contacts may need further chunks, which are allocated whole in each column.
        let chunk = chunk(self.header.members());
        let more = (self.contacts.len() + contacts).div_ceil(chunk) - self.contacts_written.div_ceil(chunk);
        let of_contacts = 8 * (1 + CONTACTS.len() as u64) * (more * chunk) as u64;
        let made = room::make(&self.path, self.file.size() + series + of_contacts + room::BYTES_PER_FLUSH);
        made.map_err(|error| Error::io(&self.path, format!("cannot be written: {}", plain(&error))))
    }

    /// Converts an error of HDF5 to an error of this file, and remembers it so that nothing more is written.
    fn noted<T>(&mut self, result: hdf5::Result<T>) -> Result<T> {
        self.has_failed |= result.is_err();
        result.map_err(|error| not_written(&self.path, &error))
    }

    fn take(&mut self, member: &Member) -> hdf5::Result<()> {
        let index = member.index;
        if !member.message.is_empty() {
            let message = [fixed(&member.message)];
            self.file.dataset("members/message")?.write_slice(&message, index..index + 1)?;
            self.messages.insert(index, member.message.clone());
        }
        if let Some(series) = member.series.as_ref().filter(|_| member.status == Status::Done) {
            let root = self.file.group("series")?;
            // A killed process may have left it.
            if root.link_exists(&index.to_string()) {
                root.unlink(&index.to_string())?;
            }
            for (values, column) in series.iter().zip(&SERIES) {
                let path = series_path(index, column.path);
                let dataset = self.file.new_dataset_builder().with_data(values).create(path.as_str())?;
                write_text(&dataset, "units", column.units)?;
            }
            for (name, whole) in self.header.probes.iter().zip(&member.probes) {
                probes::write(&self.file, &format!("series/{index}"), name, whole)?;
            }
        }
        self.status[index] = member.status;
        self.quantities.iter_mut().zip(member.quantities).for_each(|(values, value)| values[index] = value);
        self.contacts.extend(member.contacts.iter().map(|contact| (index, *contact)));
        self.fresh.push(index);
        self.is_new = false;
        Ok(())
    }

    /// Writes the recorded members, so that they survive the end of the process.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn flush(&mut self) -> Result<()> {
        if self.fresh.is_empty() {
            self.flushed = Instant::now();
            return Ok(());
        }
        let made = self.make_room(0, 0);
        self.has_failed |= made.is_err();
        made?;
        let written = self.write();
        self.noted(written)
    }

    fn write(&mut self) -> hdf5::Result<()> {
        self.flushed = Instant::now();
        let (Some(first), Some(last)) = (self.fresh.iter().min(), self.fresh.iter().max()) else {
            return Ok(());
        };
        let range = *first..*last + 1;
        for ((_, name, _), values) in Quantity::ALL.iter().zip(&self.quantities) {
            self.file.dataset(&format!("members/{name}"))?.write_slice(&values[range.clone()], range.clone())?;
        }
        self.write_contacts()?;
        // The status follows when all other data are on the disk.
        self.file.flush()?;
        let status: Vec<u8> = self.status[range.clone()].iter().map(|status| *status as u8).collect();
        self.file.dataset("members/status")?.write_slice(&status, range)?;
        self.file.flush()?;
        self.fresh.clear();
        Ok(())
    }

    fn write_contacts(&mut self) -> hdf5::Result<()> {
        let (first, end) = (self.contacts_written, self.contacts.len());
        let (members, contacts): (Vec<u64>, Vec<Episode>) =
            self.contacts[first..].iter().map(|(member, contact)| (*member as u64, *contact)).unzip();
        let column = self.file.dataset("contacts/member")?;
        column.resize((end,))?;
        column.write_slice(&members, first..end)?;
        let columns = CONTACTS.iter().map(|column| self.file.dataset(column.path)).collect::<hdf5::Result<Vec<_>>>()?;
        append(&columns, &CONTACTS, first, &contacts)?;
        self.contacts_written = end;
        Ok(())
    }

    /// Finishes the file for this call of the program: sorts the contacts by member, and writes whether all members are
    /// present.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn finish(&mut self) -> Result<()> {
        self.flush()?;
        let mut mark = || {
            if !self.contacts.is_sorted_by_key(|(member, _)| *member) || self.contacts_written == 0 {
                self.contacts.sort_by_key(|(member, _)| *member);
                self.contacts_written = 0;
                self.write_contacts()?;
            }
            let is_complete = self.mine().all(|member| self.status[member] != Status::Missing);
            self.file.attr("complete")?.write_scalar(&is_complete)?;
            self.file.flush()
        };
        let marked = mark();
        self.noted(marked)?;
        room::give_back(&self.path, self.file.size()).map_err(|error| Error::io(&self.path, error))
    }

    /// Members that belong to this file: all, or the ones of its shard.
    pub fn mine(&self) -> impl Iterator<Item = usize> + use<> {
        let (first, pace) = self.header.shard.map_or((0, 1), |(i, n)| (i - 1, n));
        (first..self.status.len()).step_by(pace)
    }
}

impl Drop for SweepWriter {
    /// Writes the recorded members; errors are ignored. A new sweep without a member is removed.
    fn drop(&mut self) {
        if self.has_failed {
            // Closing the file would write the data in memory, so it is left open until the process ends.
            std::mem::forget(self.file.clone());
        }
        let _ = match self.is_new {
            _ if self.has_failed => Ok(()),
            true => fs::remove_file(target::resolved(&self.path)).map_err(|e| Error::io(&self.path, e)),
            false => self.flush(),
        };
    }
}

/// Error text of the operating system without the error number.
fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

/// Text cut to [`MESSAGE`] bytes, with NUL characters replaced by spaces.
fn fixed(text: &str) -> Message {
    let end = (0..=MESSAGE.min(text.len())).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
    text[..end].replace('\0', " ").parse().unwrap_or_default()
}
