//! Provenance of a result: the attributes of the root of a result file.

use std::fs::File;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{BufRead, BufReader};
use std::path::Path;

use hdf5_metno::{Group, Location, Result};
use serde::Serialize;

use super::storage::{long_text, text, update_text, write_long_text, write_scalar, write_text, write_text_with_room};

/// Scene and program from which a result was computed.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Origin {
    /// Title of the scene.
    pub title: String,
    /// Full text of the scene; that of a sweep is without the values of the members.
    #[serde(skip)]
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
}

impl Origin {
    fn texts(&mut self) -> [(&'static str, &mut String); 5] {
        [
            ("title", &mut self.title),
            ("version", &mut self.version),
            ("commit", &mut self.commit),
            ("petsc_version", &mut self.petsc_version),
            ("petsc_options", &mut self.petsc_options),
        ]
    }

    pub(super) fn write(&self, root: &Group) -> Result<()> {
        self.clone().texts().into_iter().try_for_each(|(name, text)| write_text(root, name, text))?;
        write_long_text(root, "scene", &self.scene)?;
        write_scalar(root, "ranks", self.ranks as u64)
    }

    pub(super) fn read(root: &Group) -> Result<Self> {
        let mut origin = Self { scene: long_text(root, "scene")?, ranks: count(root, "ranks")?, ..Self::default() };
        for (name, value) in origin.texts() {
            *value = text(root, name)?;
        }
        Ok(origin)
    }
}

/// Data needed to identify and to repeat the run that made a result. For programs, the parts that `ricochet info` prints.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Provenance {
    /// Identifies the run; random. A continued run keeps it.
    #[serde(skip)]
    pub run_id: u64,
    /// Scene and program.
    #[serde(flatten)]
    pub origin: Origin,
    /// Folder to which the path of the scene's mesh file is relative.
    #[serde(skip)]
    pub folder: String,
    /// Digest of the mesh file; `None` if the scene has none.
    #[serde(skip)]
    pub mesh_digest: Option<String>,
    /// Theory of the body: `solid`, `kirchhoff`, …
    pub model: String,
    /// Further details of the model; `None` for results of earlier versions.
    #[serde(skip)]
    pub model_details: Option<ModelDetails>,
    /// Reduction of the body: `none`, or the number and kind of the basis vectors.
    pub reduction: String,
    /// Number of unknowns, including the impactor's.
    pub unknowns: usize,
    /// Mass m0 of the impactor, with which impulses are computed, kg.
    #[serde(skip)]
    pub impactor_mass: f64,
    /// Number of rows that the run will record if the time steps are fixed. It determines the chunk size of the series,
    /// so that a run with this number of rows never has to enlarge the file.
    #[serde(skip)]
    pub planned_rows: Option<usize>,
    /// Warnings and notes of the run, each in a line; complete at the end of the run.
    #[serde(skip)]
    pub warnings: String,
}

/// Description of a model for reports, in addition to its name.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelDetails {
    /// Discretisation in words.
    pub discretisation: String,
    /// Reason why the program selected this theory; empty if the scene names the theory.
    pub reason: String,
    /// Causes included in the error estimate made before the first step, in words; empty if there is no estimate.
    pub error_causes: String,
    /// That estimate: error of the acceleration in the first contact divided by its peak; NaN if there is no estimate.
    pub first_contact_error: f64,
}

impl ModelDetails {
    fn texts(&self) -> [(&'static str, &str); 3] {
        [
            ("discretisation", &self.discretisation),
            ("model_reason", &self.reason),
            ("first_contact_error_causes", &self.error_causes),
        ]
    }

    fn write(&self, root: &Location) -> Result<()> {
        self.texts().into_iter().try_for_each(|(name, text)| write_text(root, name, text))?;
        write_scalar(root, "first_contact_error", self.first_contact_error)
    }

    fn read(root: &Location) -> Result<Self> {
        Ok(Self {
            discretisation: text(root, "discretisation")?,
            reason: text(root, "model_reason")?,
            error_causes: text(root, "first_contact_error_causes")?,
            first_contact_error: root.attr("first_contact_error")?.read_scalar()?,
        })
    }
}

/// Name of the attribute with the warnings and notes of a run.
const WARNINGS: &str = "warnings";

/// Bytes kept for them from the beginning, so that nothing in the file moves at the end.
const ROOM_OF_WARNINGS: usize = 16_000;

/// Cost and estimated error of a run: attributes of the root, created with the file and set at the end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cost {
    /// Estimated error of the acceleration history divided by its peak; NaN if there is no estimate.
    pub error_estimate: f64,
    /// Estimated error of the deflection under the impactor divided by its largest value; NaN if there is no estimate.
    pub deflection_error_estimate: f64,
    /// Total wall time, s; NaN if the run has not ended.
    #[serde(rename = "wall_time")]
    pub total: f64,
    /// Wall time to choose the theory, read or make the mesh, and assemble the body and its basis, s.
    #[serde(rename = "wall_time_model")]
    pub model: f64,
    /// Wall time of preparations before the first step, such as factorisations, s.
    #[serde(rename = "wall_time_setup")]
    pub setup: f64,
    /// Wall time of all steps, s.
    #[serde(rename = "wall_time_steps")]
    pub steps: f64,
    /// Number of steps solved, including the rejected ones and the ones for the error estimate.
    pub solves: usize,
    /// Newton iterations of all steps.
    pub newton_iterations: usize,
}

impl Cost {
    /// Values before the end of the run.
    pub(super) const UNKNOWN: Self = Self {
        error_estimate: f64::NAN,
        deflection_error_estimate: f64::NAN,
        total: f64::NAN,
        model: f64::NAN,
        setup: f64::NAN,
        steps: f64::NAN,
        solves: 0,
        newton_iterations: 0,
    };

    fn numbers(&mut self) -> [(&'static str, &mut f64); 6] {
        [
            ("wall_time_model", &mut self.model),
            ("wall_time_setup", &mut self.setup),
            ("wall_time_steps", &mut self.steps),
            ("wall_time_total", &mut self.total),
            ("error_estimate", &mut self.error_estimate),
            ("deflection_error_estimate", &mut self.deflection_error_estimate),
        ]
    }

    fn counts(&mut self) -> [(&'static str, &mut usize); 2] {
        [("newton_iterations", &mut self.newton_iterations), ("solves", &mut self.solves)]
    }

    pub(super) fn write(mut self, root: &Location) -> Result<()> {
        self.numbers().into_iter().try_for_each(|(name, number)| write_scalar(root, name, *number))?;
        self.counts().into_iter().try_for_each(|(name, count)| write_scalar(root, name, *count as u64))
    }

    /// Reads the attributes written by [`Self::write`].
    pub(super) fn read(root: &Location) -> Result<Self> {
        let mut cost = Self::UNKNOWN;
        for (name, number) in cost.numbers() {
            *number = root.attr(name)?.read_scalar()?;
        }
        for (name, number) in cost.counts() {
            *number = count(root, name)?;
        }
        Ok(cost)
    }

    /// Overwrites the attributes in place, so that nothing in the file moves.
    pub(super) fn update(mut self, root: &Location) -> Result<()> {
        self.numbers().into_iter().try_for_each(|(name, number)| root.attr(name)?.write_scalar(number))?;
        self.counts().into_iter().try_for_each(|(name, count)| root.attr(name)?.write_scalar(&(*count as u64)))
    }
}

/// Reads an attribute with a count.
fn count(root: &Location, name: &str) -> Result<usize> {
    root.attr(name)?.read_scalar::<u64>().map(|count| count as usize)
}

/// New random `run_id`. Two runs have the same id with a probability of 2⁻⁶⁴.
pub fn new_run_id() -> u64 {
    // The hasher of the standard library is seeded with random numbers of the system.
    RandomState::new().build_hasher().finish()
}

impl Provenance {
    /// Writes one attribute of `root` for each field; a field that is `None` is left out.
    pub(super) fn write(&self, root: &Group) -> Result<()> {
        self.origin.write(root)?;
        for (name, text) in [("folder", &self.folder), ("model", &self.model), ("reduction", &self.reduction)] {
            write_text(root, name, text)?;
        }
        write_text_with_room(root, WARNINGS, &self.warnings, ROOM_OF_WARNINGS)?;
        if let Some(digest) = &self.mesh_digest {
            write_text(root, "mesh_digest", digest)?;
        }
        if let Some(details) = &self.model_details {
            details.write(root)?;
        }
        write_scalar(root, "run_id", self.run_id)?;
        write_scalar(root, "unknowns", self.unknowns as u64)?;
        write_scalar(root, "impactor_mass", self.impactor_mass)?;
        self.planned_rows.map_or(Ok(()), |rows| write_scalar(root, "planned_rows", rows as u64))
    }

    /// Reads the attributes written by [`Self::write`].
    pub(super) fn read(root: &Group) -> Result<Self> {
        Ok(Self {
            run_id: root.attr("run_id")?.read_scalar()?,
            origin: Origin::read(root)?,
            folder: text(root, "folder")?,
            mesh_digest: text(root, "mesh_digest").ok(),
            model: text(root, "model")?,
            model_details: ModelDetails::read(root).ok(),
            reduction: text(root, "reduction")?,
            unknowns: count(root, "unknowns")?,
            impactor_mass: root.attr("impactor_mass")?.read_scalar()?,
            planned_rows: count(root, "planned_rows").ok(),
            warnings: text(root, WARNINGS)?,
        })
    }
}

/// Initial value of the 64-bit FNV-1a hash: the hash of no bytes.
const FNV_OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a hash of bytes, the same in all versions of the program.
pub fn digest(bytes: &[u8]) -> u64 {
    digested(FNV_OFFSET_BASIS, bytes)
}

/// FNV-1a hash of a file, which is read piece by piece.
///
/// # Errors
/// If the file cannot be read.
pub fn digest_of_file(path: &Path) -> std::io::Result<u64> {
    let (mut file, mut hash) = (BufReader::new(File::open(path)?), FNV_OFFSET_BASIS);
    loop {
        let piece = file.fill_buf()?;
        if piece.is_empty() {
            return Ok(hash);
        }
        hash = digested(hash, piece);
        let read = piece.len();
        file.consume(read);
    }
}

/// Extends an FNV-1a hash by more bytes.
fn digested(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Overwrites the warnings of a result.
pub(super) fn update_warnings(root: &Location, text: &str) -> Result<()> {
    update_text(root, WARNINGS, text)
}
