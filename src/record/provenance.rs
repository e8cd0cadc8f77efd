//! Where a result comes from: the attributes of the root of a result file.

use hdf5_metno::types::VarLenUnicode;
use hdf5_metno::{H5Type, Location, Result};

/// Everything that is needed to tell, and to repeat, how a result was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// Title of the scene.
    pub title: String,
    /// The scene's full text.
    pub scene: String,
    /// Version of the program.
    pub version: String,
    /// Git commit of the program.
    pub commit: String,
    /// Version of PETSc.
    pub petsc_version: String,
    /// Options given to PETSc.
    pub petsc_options: String,
    /// Number of MPI ranks.
    pub ranks: usize,
    /// Theory of the body: `solid`, `kirchhoff`, …
    pub model: String,
    /// Reduction of the body: `none`, or how many basis vectors of which kind.
    pub reduction: String,
    /// Number of unknowns, the impactor's included.
    pub unknowns: usize,
    /// Estimated error of the acceleration history over its peak, where there is an estimate.
    pub error_estimate: Option<f64>,
    /// Number of rows that the run will record, where the steps are fixed: it sizes the chunks of the series, so
    /// that a run that keeps to it never has to enlarge the file.
    pub planned_rows: Option<usize>,
}

impl Provenance {
    /// Writes one attribute a field at `root`; a `None` is left out.
    pub(super) fn write(&self, root: &Location) -> Result<()> {
        for (name, text) in [
            ("title", &self.title),
            ("scene", &self.scene),
            ("version", &self.version),
            ("commit", &self.commit),
            ("petsc_version", &self.petsc_version),
            ("petsc_options", &self.petsc_options),
            ("model", &self.model),
            ("reduction", &self.reduction),
        ] {
            write_text(root, name, text)?;
        }
        write_scalar(root, "ranks", self.ranks as u64)?;
        write_scalar(root, "unknowns", self.unknowns as u64)?;
        if let Some(error) = self.error_estimate {
            write_scalar(root, "error_estimate", error)?;
        }
        if let Some(rows) = self.planned_rows {
            write_scalar(root, "planned_rows", rows as u64)?;
        }
        Ok(())
    }
}

/// A new text attribute. A variable-length string, since fixed ones end at 64 KiB.
pub(super) fn write_text(at: &Location, name: &str, text: &str) -> Result<()> {
    let text: VarLenUnicode = text
        .parse()
        .map_err(|_| format!("attribute {name}: the text holds a NUL character"))?;
    write_scalar(at, name, text)
}

/// A new attribute of one value.
pub(super) fn write_scalar<T: H5Type>(at: &Location, name: &str, value: T) -> Result<()> {
    at.new_attr::<T>().create(name)?.write_scalar(&value)
}
