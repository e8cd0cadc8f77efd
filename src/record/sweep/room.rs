//! Room on the disk, taken before it is needed.
//!
//! HDF5 writes what leads to new data beside what is there already. On a full disk the one may be written and the other not, and the file is
//! spoilt. So the file is made longer with zeros first: where that fails, nothing of it has changed.

use std::fs::OpenOptions;
use std::io::{self, Seek, SeekFrom, Write};
use std::path::Path;

/// What HDF5 may add for itself to data, bytes: at each flush, and for each dataset.
pub(super) const OF_FLUSH: u64 = 1 << 16;
pub(super) const OF_DATASET: u64 = 1 << 11;

/// Makes a file as long as `wanted` bytes, if it is shorter.
pub(super) fn make(path: &Path, wanted: u64) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).open(path)?;
    let there = file.seek(SeekFrom::End(0))?;
    let zeros = [0_u8; 1 << 16];
    let mut at = there;
    while at < wanted {
        let part = (wanted - at).min(zeros.len() as u64);
        if let Err(error) = file.write_all(&zeros[..part as usize]) {
            // What is there is whole without the rest.
            let _ = file.set_len(there);
            return Err(error);
        }
        at += part;
    }
    Ok(())
}

/// Gives back what is behind so many bytes.
pub(super) fn give_back(path: &Path, used: u64) -> io::Result<()> {
    OpenOptions::new().write(true).open(path)?.set_len(used)
}
