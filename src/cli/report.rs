//! `ricochet report`: a run as a page to hand in.

use crate::error::{Error, Result};
use crate::record::folder::Folder;
use crate::record::target::resolved;
use crate::report;

use super::{Report, say};

/// Endings of a page's name.
const ENDINGS: [&str; 2] = ["html", "htm"];

/// Writes it.
///
/// # Errors
/// [`Error::Usage`] for a file that is no page by its name; [`Error::Io`] where the result cannot be read or the page not be written.
pub fn report(arguments: &Report) -> Result<()> {
    let Report { result, output } = arguments;
    let ending = output.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    if !ENDINGS.contains(&ending.to_ascii_lowercase().as_str()) {
        return Err(Error::Usage(format!("{}: a report is an .html file", output.display())));
    }
    if hdf5_metno::File::open(output).is_ok() {
        return Err(Error::io(output, "is an HDF5 file, so no report replaces it"));
    }
    let page = report::report(result)?;
    let file = resolved(output);
    // Whole or not at all: a disk may be full.
    Folder::of(&file).put(file.file_name().unwrap_or_default(), |part| {
        std::fs::write(part, &page).map_err(|error| Error::io(output, error))
    })?;
    say(format_args!("{}", output.display()));
    Ok(())
}
