//! Reserves space on the disk before it is needed.
//!
//! HDF5 writes new data and the metadata that refer to them separately. On a full disk only one of the two may be
//! written, which makes the file unreadable. Therefore the file is first extended with zeros. If this fails, its
//! content has not changed.

use std::fs::OpenOptions;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

/// Upper bounds of the bytes that HDF5 adds to the data for each flush and for each dataset.
pub(super) const BYTES_PER_FLUSH: u64 = 1 << 16;
pub(super) const BYTES_PER_DATASET: u64 = 1 << 11;

/// Extends a file with zeros to `wanted` bytes if it is shorter.
pub(super) fn make(path: &Path, wanted: u64) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).open(path)?;
    let there = file.seek(SeekFrom::End(0))?;
    let zeros = [0_u8; 1 << 16];
    let mut at = there;
    while at < wanted {
        let part = (wanted - at).min(zeros.len() as u64);
        if let Err(error) = file.write_all(&zeros[..part as usize]) {
            // The existing content is complete without the zeros.
            let _ = file.set_len(there);
            return Err(error);
        }
        at += part;
    }
    Ok(())
}

/// Cuts a file to `used` bytes.
pub(super) fn give_back(path: &Path, used: u64) -> io::Result<()> {
    OpenOptions::new().write(true).open(path)?.set_len(used)
}
