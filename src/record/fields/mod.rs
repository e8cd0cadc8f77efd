//! Fields for ParaView, in a file of their own beside the result: VTKHDF, and an XDMF that points into it.
//!
//! A frame takes megabytes, and writing one would allocate space in the middle of the series, which a kill at that moment could spoil
//! (see [`series`](super::series)). So the result holds links to the fields' file alone, and that is written by the same rules as the
//! series: a chunk holds the planned frames, a flush changes lengths only.

mod vtkhdf;
mod xdmf;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::error::{Error, Result};
use crate::record::columns::not_written;
use crate::record::series::FLUSH_EVERY;
use crate::record::target;
use crate::space::evaluate::{Fields, Grid};
pub use vtkhdf::GROUP;
use vtkhdf::VtkHdf;

/// Endings of the names of a result's fields and of their XDMF.
pub const ENDINGS: [&str; 2] = ["vtkhdf", "xdmf"];

/// Where the fields of a result are: with the ending `.vtkhdf`, and the XDMF with `.xdmf`.
pub fn paths(result: &Path) -> [PathBuf; 2] {
    ENDINGS.map(|ending| target::companion(result, ending))
}

/// Tells whether the fields of a result can be written, as [`target::check_writable`] does.
///
/// # Errors
/// [`Error::Io`] with the reason.
pub fn check_writable(result: &Path) -> Result<()> {
    let [fields, xdmf] = paths(result);
    if xdmf.is_dir() {
        return Err(Error::io(&xdmf, "is a folder"));
    }
    let is_ours = |text: &[u8]| text.windows(5).take(100).any(|part| part == b"<Xdmf");
    match fs::read(&xdmf) {
        Ok(text) if !is_ours(&text) => {
            return Err(Error::io(&xdmf, "is no XDMF of a run's fields, so it is not replaced"));
        }
        _ => {}
    }
    target::check_writable(&fields, target::Kind::Fields)
}

/// Writes the fields of one run. One process (rank 0) has it.
pub struct FieldWriter {
    path: PathBuf,
    xdmf: PathBuf,
    /// The file's name until the first frame is on the disk.
    part: Option<PathBuf>,
    file: VtkHdf,
    flushed: Option<Instant>,
}

impl FieldWriter {
    /// Begins the fields of `result` on a grid, for so many frames where their number is planned. Older fields are replaced when the first
    /// frame has been written.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
    pub fn create(result: &Path, grid: &Grid, planned: Option<usize>) -> Result<Self> {
        let [path, xdmf] = paths(result);
        let part = target::part(&target::resolved(&path))?;
        let begun = VtkHdf::create(&part, grid, planned);
        if begun.is_err() {
            // The error in hand says more than one of the removal would.
            let _ = fs::remove_file(&part);
        }
        let file = begun.map_err(|e| not_written(&path, &e))?;
        Ok(Self { path, xdmf, part: Some(part), file, flushed: None })
    }

    /// Goes on with the fields of a run, behind the frames up to a time, s: with those of the result `from`, for `result`.
    ///
    /// # Errors
    /// [`Error::Io`] where they cannot be read, or written.
    pub fn continued(result: &Path, grid: &Grid, (from, end): (&Path, f64)) -> Result<Self> {
        let ([earlier, _], [path, xdmf]) = (paths(from), paths(result));
        let part = target::part(&target::resolved(&path))?;
        let copied = fs::copy(&earlier, &part).map_err(|e| Error::io(&earlier, e)).and_then(|_| {
            let reopened = VtkHdf::reopen(&part, grid, end);
            reopened.map_err(|e| Error::io(&earlier, format!("its fields do not go on: {e}")))
        });
        if copied.is_err() {
            // The error in hand says more than one of the removal would.
            let _ = fs::remove_file(&part);
        }
        let file = copied?;
        Ok(Self { path, xdmf, part: Some(part), file, flushed: None })
    }

    /// Takes the frame of a time, s. The first one is on the disk when this returns; later ones follow about once a second of wall time.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
    pub fn push(&mut self, time: f64, frame: &Fields) -> Result<()> {
        self.file.append(time, frame).map_err(|e| not_written(&self.path, &e))?;
        if self.flushed.is_none_or(|t| t.elapsed() >= FLUSH_EVERY) { self.flush() } else { Ok(()) }
    }

    /// Writes what is there, so that it outlives the process.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
    pub fn flush(&mut self) -> Result<()> {
        self.file.flush().map_err(|e| not_written(&self.path, &e))?;
        if let Some(part) = &self.part {
            target::replace_with_part(part, &target::resolved(&self.path)).map_err(|e| Error::io(&self.path, e))?;
            self.part = None;
        }
        xdmf::write(&self.xdmf, &self.path, &self.file)?;
        self.flushed = Some(Instant::now());
        Ok(())
    }

    /// The same, so that it outlives a loss of power too.
    ///
    /// # Errors
    /// [`Error::Io`] when writing fails.
    pub fn sync(&mut self) -> Result<()> {
        self.flush()?;
        target::synced(&self.path).map_err(|e| Error::io(&self.path, e))
    }
}

impl Drop for FieldWriter {
    /// Writes what is there; an error has nobody to go to. Fields without a frame leave nothing behind.
    fn drop(&mut self) {
        let _ = match &self.part {
            Some(part) => fs::remove_file(part).map_err(|e| Error::io(part, e)),
            None => self.flush(),
        };
    }
}
