//! `ricochet report`: writes a run as an HTML page.

use crate::error::{Error, Result};
use crate::record::folder::Folder;
use crate::record::target::resolved;
use crate::report;

use super::{Report, say};

/// Allowed extensions of the page's file.
const ENDINGS: [&str; 2] = ["html", "htm"];

/// Writes the report.
///
/// # Errors
/// [`Error::Usage`] if the file does not have the extension of an HTML page; [`Error::Io`] if the result cannot be read
/// or the page cannot be written.
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
    // The page is written completely or not at all, even if the disk is full.
    Folder::of(&file).put(file.file_name().unwrap_or_default(), |part| {
        std::fs::write(part, &page).map_err(|error| Error::io(output, error))
    })?;
    say(format_args!("{}", output.display()));
    Ok(())
}
