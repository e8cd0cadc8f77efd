//! A sweep's file, written while its members come in.
//!
//! A process may be killed at any moment. The datasets of the members have their final size from the beginning, so that a flush
//! moves nothing in the file; a member's status is written when all else of it is on the disk. What is not safe is the moment of
//! a flush in which the table of contacts outgrows its chunk, or in which series come in. A full disk spoils nothing: room is made before
//! anything is written, and after an error nothing is.

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

/// Attribute `kind` of the root.
pub(super) const KIND: &str = "sweep";
/// Why a member failed: of a fixed length, so that it has its place from the beginning.
pub(super) type Message = FixedUnicode<MESSAGE>;
const MESSAGE: usize = 400;
/// Wall time between two flushes: what a kill may cost.
const FLUSH_EVERY: Duration = Duration::from_secs(1);

/// Writes a sweep. One process (rank 0) has it.
pub struct SweepWriter {
    path: PathBuf,
    file: hdf5::File,
    header: Header,
    /// As on the disk, and what is to come.
    status: Vec<Status>,
    quantities: Vec<Vec<f64>>,
    contacts: Vec<(usize, Episode)>,
    contacts_written: usize,
    messages: BTreeMap<usize, String>,
    /// Whether there was no file, and no member has come in yet.
    is_new: bool,
    /// Members that are not on the disk yet.
    fresh: Vec<usize>,
    flushed: Instant,
    /// Whether a write has failed. What HDF5 still has in memory may lead to what is not on the disk.
    has_failed: bool,
}

impl SweepWriter {
    /// Begins the sweep `path`, or continues it if it is there.
    ///
    /// # Errors
    /// [`Error::Io`] where `path` is something else, or a sweep of another scene or of other values, or cannot be written.
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
            // The error in hand says more than one of the removal would.
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
        // What an earlier version did not have yet.
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
            // All are written again, since some may belong to members whose status did not reach the disk.
            contacts_written: 0,
            messages: sweep.messages.clone(),
            is_new: false,
            fresh: Vec::new(),
            flushed: Instant::now(),
            has_failed: false,
            file: sweep.into_file(),
        })
    }

    /// What the file is of: its own header, as it was begun.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// How far each member is.
    pub fn status(&self) -> &[Status] {
        &self.status
    }

    /// Why members failed.
    pub fn messages(&self) -> &BTreeMap<usize, String> {
        &self.messages
    }

    /// One number of each member.
    pub fn quantity(&self, quantity: Quantity) -> &[f64] {
        &self.quantities[quantity as usize]
    }

    /// Takes a member over. It is on the disk about a second later.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
    pub fn push(&mut self, member: &Member) -> Result<()> {
        let columns = member.series.iter().flatten().map(Vec::len).chain(member.probes.iter().flatten().map(Vec::len));
        let series: u64 = columns.map(|length| room::OF_DATASET + 8 * length as u64).sum();
        if let Err(error) = self.make_room(series, member.contacts.len()) {
            // For those before it there is room.
            let _ = self.flush();
            self.has_failed = true;
            return Err(error);
        }
        let taken = self.take(member);
        self.noted(taken)?;
        self.flush_if_due()
    }

    /// Writes what came in, if the last time was long ago.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
    pub fn flush_if_due(&mut self) -> Result<()> {
        if self.flushed.elapsed() >= FLUSH_EVERY { self.flush() } else { Ok(()) }
    }

    /// Has so many bytes at the end of the file for series, and what so many contacts more and HDF5 itself need.
    fn make_room(&self, series: u64, contacts: usize) -> Result<()> {
        // Whole chunks of the columns, where contacts outgrow those that are there.
        let chunk = chunk(self.header.members());
        let more = (self.contacts.len() + contacts).div_ceil(chunk) - self.contacts_written.div_ceil(chunk);
        let of_contacts = 8 * (1 + CONTACTS.len() as u64) * (more * chunk) as u64;
        let made = room::make(&self.path, self.file.size() + series + of_contacts + room::OF_FLUSH);
        made.map_err(|error| Error::io(&self.path, format!("cannot be written: {}", plain(&error))))
    }

    /// The same result as an error of this file, which is left alone from then on.
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
            // What a kill has left.
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

    /// Writes what came in, so that it outlives the process.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
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
        // First all else, then the word that it is there.
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

    /// Ends the file for now: the contacts in the order of the members, and whether all members are there.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
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

    /// The members that belong into this file.
    pub fn mine(&self) -> impl Iterator<Item = usize> + use<> {
        let (first, pace) = self.header.shard.map_or((0, 1), |(i, n)| (i - 1, n));
        (first..self.status.len()).step_by(pace)
    }
}

impl Drop for SweepWriter {
    /// Writes what came in; an error has nobody to go to. A new sweep without a member leaves nothing behind.
    fn drop(&mut self) {
        if self.has_failed {
            // Closing it would write what is in memory; the program ends without that.
            std::mem::forget(self.file.clone());
        }
        let _ = match self.is_new {
            _ if self.has_failed => Ok(()),
            true => fs::remove_file(target::resolved(&self.path)).map_err(|e| Error::io(&self.path, e)),
            false => self.flush(),
        };
    }
}

/// An error of the system without its number.
fn plain(error: &std::io::Error) -> String {
    let text = error.to_string();
    text.split(" (os error").next().unwrap_or_default().to_owned()
}

/// The text, cut where it is too long.
fn fixed(text: &str) -> Message {
    let end = (0..=MESSAGE.min(text.len())).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
    text[..end].replace('\0', " ").parse().unwrap_or_default()
}
