//! Fields for ParaView in a separate file in the folder of the result: VTKHDF, and an XDMF file that refers to it.
//!
//! A frame takes megabytes. In the file of the result, writing a frame would allocate space in the middle of the
//! series, and a kill at that moment could destroy the file (see [`series`](super::series)). So the result contains
//! only links to the fields' file. That file is written by the same rules as the series: a chunk has room for the
//! planned frames, and a flush changes only lengths.

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

/// Endings of the names of the fields' file and of the XDMF file.
pub const ENDINGS: [&str; 2] = ["vtkhdf", "xdmf"];

/// Paths of the fields (`.vtkhdf`) and of the XDMF file (`.xdmf`) of a result.
pub fn paths(result: &Path) -> [PathBuf; 2] {
    ENDINGS.map(|ending| target::companion(result, ending))
}

/// Checks that the fields of a result can be written, like [`target::check_writable`].
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

/// Writes the fields of one run. Only one process (rank 0) has a writer.
pub struct FieldWriter {
    path: PathBuf,
    xdmf: PathBuf,
    /// Temporary name of the file until the first frame is on the disk, then `None`.
    part: Option<PathBuf>,
    file: VtkHdf,
    flushed: Option<Instant>,
}

impl FieldWriter {
    /// Creates the fields of `result` on a grid; `planned` is the number of frames if it is known. Older fields are
    /// replaced when the first frame has been written.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn create(result: &Path, grid: &Grid, planned: Option<usize>) -> Result<Self> {
        let [path, xdmf] = paths(result);
        let create = |part: &Path| VtkHdf::create(part, grid, planned).map_err(|e| not_written(&path, &e));
        let (part, file) = target::write_part(&target::resolved(&path), create)?;
        Ok(Self { path, xdmf, part: Some(part), file, flushed: None })
    }

    /// Continues the fields of the result `from` in the fields of `result`, after its frames up to the time `end`, s.
    ///
    /// # Errors
    /// [`Error::Io`] if the earlier fields cannot be read or copied, or belong to another grid.
    pub fn continued(result: &Path, grid: &Grid, (from, end): (&Path, f64)) -> Result<Self> {
        let ([earlier, _], [path, xdmf]) = (paths(from), paths(result));
        let (part, file) = target::write_part(&target::resolved(&path), |part| {
            fs::copy(&earlier, part).map_err(|e| Error::io(&earlier, e))?;
            let reopened = VtkHdf::reopen(part, grid, end);
            reopened.map_err(|e| Error::io(&earlier, format!("its fields do not go on: {e}")))
        })?;
        Ok(Self { path, xdmf, part: Some(part), file, flushed: None })
    }

    /// Records the frame at a time, s. The first one is on the disk when this returns; later ones follow about once a
    /// second of wall time.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn push(&mut self, time: f64, frame: &Fields) -> Result<()> {
        self.file.append(time, frame).map_err(|e| not_written(&self.path, &e))?;
        if self.flushed.is_none_or(|t| t.elapsed() >= FLUSH_EVERY) { self.flush() } else { Ok(()) }
    }

    /// Writes the recorded frames, so that they survive the end of the process.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
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

    /// Like [`Self::flush`]; the frames also survive a loss of power.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails.
    pub fn sync(&mut self) -> Result<()> {
        self.flush()?;
        target::synced(&self.path).map_err(|e| Error::io(&self.path, e))
    }
}

impl Drop for FieldWriter {
    /// Writes the recorded frames; errors are ignored. Fields without a frame are removed.
    fn drop(&mut self) {
        let _ = match &self.part {
            Some(part) => fs::remove_file(part).map_err(|e| Error::io(part, e)),
            None => self.flush(),
        };
    }
}
