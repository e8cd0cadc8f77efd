//! Creates the file of a sweep, before its first member.

use super::member::Quantity;
use super::write::{KIND, Message};
use super::{Header, Values};
use crate::record::columns::{CONTACTS, new_datasets, new_rows};
use crate::record::storage::{self, write_long_text, write_scalar, write_text, write_words};
use hdf5_metno as hdf5;
use std::path::Path;

/// Number of contacts reserved for each member; minimum and maximum number of contacts in a chunk.
const ROOM: usize = 8;
const CHUNK: (usize, usize) = (1 << 12, 1 << 22);

/// Number of contacts in a chunk of the table of contacts, for a number of members.
pub(super) fn chunk(members: usize) -> usize {
    (ROOM * members).clamp(CHUNK.0, CHUNK.1)
}

/// Creates the file at `path` with its attributes and all its datasets.
pub(super) fn begin(path: &Path, header: &Header) -> hdf5::Result<hdf5::File> {
    let (file, members) = (storage::create(path)?, header.members());
    write_text(&file, "kind", KIND)?;
    header.origin.write(&file)?;
    // A name in each line.
    write_long_text(&file, "probes", &header.probes.join("\n"))?;
    let paths: Vec<&str> = header.keys.iter().map(|key| key.path.as_str()).collect();
    write_text(&file, "vary", &paths.join("\n"))?;
    write_scalar(&file, "series", header.has_series)?;
    write_scalar(&file, "complete", false)?;
    if let Some((i, n)) = header.shard {
        file.new_attr::<u64>().shape(2).create("shard")?.write(&[i as u64, n as u64])?;
    }
    for key in &header.keys {
        let (path, new) = (format!("members/vary/{}", key.path), file.new_dataset_builder());
        let dataset = match &key.values {
            Values::Numbers(numbers) => new.with_data(numbers).create(path.as_str())?,
            Values::Words(words) => write_words(&file, &path, words.iter().map(String::as_str))?,
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
    Quantity::ALL.iter().try_for_each(|quantity| new_quantity(&file, quantity, members))?;
    let chunk = chunk(members);
    new_rows::<u64>(&file, "contacts/member", "1", None, chunk)?;
    new_datasets(&file, &CONTACTS, chunk)?;
    if header.has_series {
        file.create_group("series")?;
    }
    file.flush()?;
    Ok(file)
}

/// Creates the dataset of a quantity for all members, filled with NaN.
fn new_quantity(file: &hdf5::File, (_, name, units): &(Quantity, &str, &str), members: usize) -> hdf5::Result<()> {
    let unknown = vec![f64::NAN; members];
    let dataset = file.new_dataset_builder().with_data(&unknown).create(format!("members/{name}").as_str())?;
    write_text(&dataset, "units", units)
}
