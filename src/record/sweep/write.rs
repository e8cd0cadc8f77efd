//! A sweep's file, written while its members come in.
//!
//! A process may be killed at any moment. The datasets of the members have their final size from the beginning, so that a flush
//! moves nothing in the file; a member's status is written when all else of it is on the disk. What is not safe is the moment of
//! a flush in which the table of contacts outgrows its chunk, or in which series come in.

use super::member::{Member, Quantity, Status};
use super::read::{Sweep, series_path};
use super::{Header, Values};
use crate::error::{Error, Result};
use crate::record::columns::{CONTACTS, SERIES, append, new_datasets, not_written};
use crate::record::episodes::Episode;
use crate::record::probes;
use crate::record::provenance::{write_scalar, write_text};
use crate::record::target;
use hdf5_metno as hdf5;
use hdf5_metno::plist::dataset_create::FillTime;
use hdf5_metno::types::{FixedUnicode, VarLenUnicode};
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
/// Contacts that a member is given room for, and at least and at most in all: the unused end takes no space on the disk.
const ROOM: usize = 8;
const CHUNK: (usize, usize) = (1 << 12, 1 << 22);

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
        })
    }

    fn resume(path: &Path, header: &Header) -> Result<Self> {
        let file = hdf5::File::open_rw(path).map_err(|error| not_written(path, &error))?;
        let sweep = Sweep::of(path, file)?;
        header.check_same(&sweep.header).map_err(|why| Error::io(path, format!("{why}: choose another file")))?;
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
        self.take(member).map_err(|error| not_written(&self.path, &error))?;
        self.flush_if_due()
    }

    /// Writes what came in, if the last time was long ago.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
    pub fn flush_if_due(&mut self) -> Result<()> {
        if self.flushed.elapsed() >= FLUSH_EVERY { self.flush() } else { Ok(()) }
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
        self.write().map_err(|error| not_written(&self.path, &error))
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
        mark().map_err(|error| not_written(&self.path, &error))
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
        let _ = match self.is_new {
            true => fs::remove_file(target::resolved(&self.path)).map_err(|e| Error::io(&self.path, e)),
            false => self.flush(),
        };
    }
}

/// The text, cut where it is too long.
fn fixed(text: &str) -> Message {
    let end = (0..=MESSAGE.min(text.len())).rev().find(|end| text.is_char_boundary(*end)).unwrap_or(0);
    text[..end].replace('\0', " ").parse().unwrap_or_default()
}

/// The file at `path` with its attributes and all its datasets.
fn begin(path: &Path, header: &Header) -> hdf5::Result<hdf5::File> {
    let (file, members) = (hdf5::File::create(path)?, header.members());
    for (name, text) in [
        ("kind", KIND),
        ("title", &header.title),
        ("scene", &header.scene),
        ("version", &header.version),
        ("commit", &header.commit),
        ("petsc_version", &header.petsc_version),
        ("petsc_options", &header.petsc_options),
    ] {
        write_text(&file, name, text)?;
    }
    write_scalar(&file, "ranks", header.ranks as u64)?;
    write_scalar(&file, "series", header.has_series)?;
    write_scalar(&file, "complete", false)?;
    let names = header.probes.iter().map(|name| word(name)).collect::<hdf5::Result<Vec<_>>>()?;
    // HDF5 has no attributes of no values.
    if !names.is_empty() {
        file.new_attr::<VarLenUnicode>().shape(names.len()).create("probes")?.write(&names)?;
    }
    if let Some((i, n)) = header.shard {
        file.new_attr::<u64>().shape(2).create("shard")?.write(&[i as u64, n as u64])?;
    }
    let paths = header.keys.iter().map(|key| word(&key.path)).collect::<hdf5::Result<Vec<_>>>()?;
    file.new_attr::<VarLenUnicode>().shape(paths.len()).create("vary")?.write(&paths)?;
    for key in &header.keys {
        let (path, new) = (format!("members/vary/{}", key.path), file.new_dataset_builder());
        let dataset = match &key.values {
            Values::Numbers(numbers) => new.with_data(numbers).create(path.as_str())?,
            Values::Words(words) => {
                let words = words.iter().map(|text| word(text)).collect::<hdf5::Result<Vec<_>>>()?;
                new.with_data(&words).create(path.as_str())?
            }
        };
        write_text(&dataset, "units", &key.units)?;
        write_scalar(&dataset, "log", key.is_log)?;
    }
    let status = file.new_dataset_builder().with_data(&vec![0_u8; members]).create("members/status")?;
    write_text(&status, "units", "1")?;
    write_text(&status, "codes", "0 not computed, 1 done, 2 solve failed, 3 scene refused on its mesh")?;
    let empty = vec![Message::default(); members];
    let message = file.new_dataset_builder().with_data(&empty).create("members/message")?;
    write_text(&message, "units", "1")?;
    for (_, name, units) in Quantity::ALL {
        let unknown = vec![f64::NAN; members];
        let dataset = file.new_dataset_builder().with_data(&unknown).create(format!("members/{name}").as_str())?;
        write_text(&dataset, "units", units)?;
    }
    let chunk = (ROOM * members).clamp(CHUNK.0, CHUNK.1);
    let member = file.new_dataset::<u64>().shape((0..,)).chunk((chunk,)).fill_time(FillTime::Never);
    let member = member.chunk_cache(0, 0, 1.0).create("contacts/member")?;
    write_text(&member, "units", "1")?;
    new_datasets(&file, &CONTACTS, chunk)?;
    if header.has_series {
        file.create_group("series")?;
    }
    file.flush()?;
    Ok(file)
}

fn word(text: &str) -> hdf5::Result<VarLenUnicode> {
    text.parse().map_err(|_| format!("{text:?} holds a NUL character").into())
}
