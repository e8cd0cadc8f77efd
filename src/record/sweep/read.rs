//! Reads a sweep.

use super::member::{Member, Quantity, Status};
use super::{Header, Key, Values};
use crate::error::{Error, Result};
use crate::record::columns::{CONTACTS, SERIES};
use crate::record::episodes::Episode;
use crate::record::probes;
use crate::record::provenance::Origin;
use crate::record::read::open;
use crate::record::storage::{self, decoded, long_text, read_list, text, words};
use hdf5_metno as hdf5;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::write::{KIND, Message};

/// Content of the file of a sweep.
#[derive(Debug)]
pub struct Sweep {
    /// Definition and provenance of the sweep.
    pub header: Header,
    /// Status of each member.
    pub status: Vec<Status>,
    /// For each [`Quantity`] a list with one value for each member.
    pub(super) quantities: Vec<Vec<f64>>,
    /// Contacts of all members that are done, each with the number of its member, in the order of the members.
    pub contacts: Vec<(usize, Episode)>,
    /// Whether the file has exactly these contacts, in this order. After a kill it may have contacts of members whose status
    /// did not reach the disk.
    pub(super) matches_file_contacts: bool,
    /// Reasons for the failures, by member.
    pub messages: BTreeMap<usize, String>,
    pub(super) path: PathBuf,
    /// Open file.
    pub(super) file: hdf5::File,
}

/// Whether a file is a sweep.
///
/// # Errors
/// [`Error::Io`] if it is not a readable HDF5 file.
pub fn is_sweep(path: &Path) -> Result<bool> {
    open(path).map(|file| is_one(&file))
}

/// Whether an open file is a sweep.
pub fn is_one(file: &hdf5::File) -> bool {
    text(file, "kind").is_ok_and(|kind| kind == KIND)
}

impl Sweep {
    /// Reads a sweep without its series.
    ///
    /// # Errors
    /// [`Error::Io`] if the file is not a sweep, or is still being written.
    pub fn read(path: &Path) -> Result<Self> {
        Self::of(path, open(path)?)
    }

    /// Reads the sweep from an open file.
    pub(super) fn of(path: &Path, file: hdf5::File) -> Result<Self> {
        if !is_one(&file) {
            return Err(Error::io(path, "is not a sweep of ricochet"));
        }
        read(path, file).map_err(|error| Error::io(path, format!("is not a whole sweep of ricochet: {error}")))
    }

    /// Values of a quantity, one for each member; NaN where it is unknown.
    pub fn quantity(&self, quantity: Quantity) -> &[f64] {
        &self.quantities[quantity as usize]
    }

    /// Values of a quantity of the members that are done, with the numbers of the members, without NaN.
    pub fn done(&self, quantity: Quantity) -> impl Iterator<Item = (f64, usize)> + Clone {
        let values = self.quantity(quantity).iter().copied().zip(0..);
        values.filter(|(value, member)| self.status[*member] == Status::Done && !value.is_nan())
    }

    /// Number of members with a status.
    pub fn count(&self, status: Status) -> usize {
        self.status.iter().filter(|one| **one == status).count()
    }

    /// Contacts of a member.
    pub fn contacts_of(&self, index: usize) -> Vec<Episode> {
        // They are sorted by member, so a binary search finds them.
        let from = self.contacts.partition_point(|(member, _)| *member < index);
        let of_member = self.contacts[from..].iter().take_while(|(member, _)| *member == index);
        of_member.map(|(_, contact)| *contact).collect()
    }

    /// All data of a member.
    ///
    /// # Errors
    /// [`Error::Io`] if its series cannot be read.
    pub fn member(&self, index: usize) -> Result<Member> {
        self.read_member(index)
            .map_err(|error| Error::io(&self.path, format!("member {index} cannot be read: {error}")))
    }

    fn read_member(&self, index: usize) -> hdf5::Result<Member> {
        let mut member = Member::new(index, false);
        member.status = self.status[index];
        member.message = self.messages.get(&index).cloned().unwrap_or_default();
        member.quantities = std::array::from_fn(|n| self.quantities[n][index]);
        member.contacts = self.contacts_of(index);
        if self.header.has_series && member.status == Status::Done {
            let column = |path: &str| storage::read(&self.file, &series_path(index, path));
            member.series = Some(SERIES.iter().map(|column_of| column(column_of.path)).collect::<hdf5::Result<_>>()?);
            let of_probe = |name: &String| probes::read(&self.file, &format!("series/{index}"), name);
            member.probes = self.header.probes.iter().map(of_probe).collect::<hdf5::Result<_>>()?;
        }
        Ok(member)
    }
}

/// Path `series/<index>/…` of a member for the path `series/…` of a column.
pub(super) fn series_path(index: usize, column: &str) -> String {
    format!("series/{index}/{}", column.trim_start_matches("series/"))
}

fn read(path: &Path, file: hdf5::File) -> hdf5::Result<Sweep> {
    let header = header(&file)?;
    let members = header.members();
    let status: Vec<u8> = storage::read(&file, "members/status")?;
    let status: Vec<Status> = status.into_iter().map(Status::from_number).collect();
    let of = |(_, name, _): &(Quantity, &str, &str)| storage::read::<f64>(&file, &format!("members/{name}"));
    let quantities = Quantity::ALL.iter().map(of).collect::<hdf5::Result<Vec<_>>>()?;
    let lengths = quantities.iter().map(Vec::len).chain(header.keys.iter().map(|key| key.values.count()));
    if status.len() != members || lengths.into_iter().any(|length| length != members) {
        return Err(format!("its datasets are not of {members} members each").into());
    }
    // After a kill the columns may differ in length; the rows of members that are done are present in all of them.
    let of_rows: Vec<u64> = storage::read(&file, "contacts/member")?;
    let columns = CONTACTS.iter().map(|column| storage::read::<f64>(&file, column.path));
    let columns = columns.collect::<hdf5::Result<Vec<_>>>()?;
    let rows = columns.iter().map(Vec::len).fold(of_rows.len(), usize::min);
    let longest = columns.iter().map(Vec::len).fold(of_rows.len(), usize::max);
    let row = |n: usize| (of_rows[n] as usize, Episode::of_columns(std::array::from_fn(|column| columns[column][n])));
    let is_done = |(member, _): &(usize, Episode)| status.get(*member) == Some(&Status::Done);
    let mut contacts: Vec<(usize, Episode)> = (0..rows).map(row).filter(is_done).collect();
    let matches_file_contacts = contacts.len() == longest && contacts.is_sorted_by_key(|(member, _)| *member);
    contacts.sort_by_key(|(member, _)| *member);
    let messages = (0..).zip(storage::read::<Message>(&file, "members/message")?);
    let messages = messages.filter(|(_, message)| !message.as_bytes().is_empty());
    let messages = messages.map(|(n, message)| Ok((n, decoded(message.as_bytes())?))).collect::<hdf5::Result<_>>()?;
    let path = path.to_owned();
    Ok(Sweep { header, status, quantities, contacts, matches_file_contacts, messages, path, file })
}

fn header(file: &hdf5::File) -> hdf5::Result<Header> {
    let lines = |text: String| -> Vec<String> { text.lines().map(str::to_owned).collect() };
    let shard = match read_list::<u64>(file, "shard").ok().as_deref() {
        None => None,
        Some([i, n]) if (1..=*n).contains(i) => Some((*i as usize, *n as usize)),
        Some(_) => return Err("its shard is not i of n".into()),
    };
    Ok(Header {
        origin: Origin::read(file)?,
        keys: lines(text(file, "vary")?).iter().map(|path| key(file, path)).collect::<hdf5::Result<_>>()?,
        has_series: file.attr("series")?.read_scalar()?,
        probes: lines(long_text(file, "probes")?),
        shard,
    })
}

fn key(file: &hdf5::File, path: &str) -> hdf5::Result<Key> {
    let dataset = file.dataset(&format!("members/vary/{path}"))?;
    let values = match words(&dataset)? {
        Some(words) => Values::Words(words),
        None => Values::Numbers(storage::values(&dataset)?),
    };
    Ok(Key {
        path: path.to_owned(),
        units: text(&dataset, "units")?,
        is_log: dataset.attr("log")?.read_scalar()?,
        values,
    })
}
