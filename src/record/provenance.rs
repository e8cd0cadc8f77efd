//! Where a result comes from: the attributes of the root of a result file.

use std::fs::File;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{BufRead, BufReader};
use std::path::Path;

use hdf5_metno::types::VarLenUnicode;
use hdf5_metno::{H5Type, Location, Result};

/// Everything that is needed to tell, and to repeat, how a result was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Provenance {
    /// Tells the run from others; a run that goes on keeps it.
    pub run_id: u64,
    /// Title of the scene.
    pub title: String,
    /// The scene's full text.
    pub scene: String,
    /// The folder that the scene's mesh file is relative to.
    pub folder: String,
    /// Digest of that mesh file, where there is one.
    pub mesh_digest: Option<String>,
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
    /// More of the model; results of earlier versions have none.
    pub model_details: Option<ModelDetails>,
    /// Reduction of the body: `none`, or how many basis vectors of which kind.
    pub reduction: String,
    /// Number of unknowns, the impactor's included.
    pub unknowns: usize,
    /// m0, kg: what impulses are computed with.
    pub impactor_mass: f64,
    /// Number of rows that the run will record, where the steps are fixed: it sizes the chunks of the series, so
    /// that a run that keeps to it never has to enlarge the file.
    pub planned_rows: Option<usize>,
}

/// What a report says of a model beside its name.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelDetails {
    /// The discretisation in words.
    pub discretisation: String,
    /// Why the program has selected this theory; empty where the scene names it.
    pub reason: String,
    /// What the error before the first step is estimated of, in words; empty where nothing is.
    pub error_causes: String,
    /// That error in the first contact, of the acceleration over its peak; NaN where there is no estimate.
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

/// What a run has cost, and how good it is: attributes of the root, made with the file and filled in at the end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Wall time of choosing the theory, reading or making the mesh, assembling the body and its basis, s.
    pub model: f64,
    /// Wall time of what steps need before the first of them, as factorisations, s.
    pub setup: f64,
    /// Wall time of all steps, s.
    pub steps: f64,
    /// Wall time of everything, s.
    pub total: f64,
    /// Newton iterations of all steps.
    pub newton_iterations: usize,
    /// Steps taken, those that were rejected and those of the error estimate included.
    pub solves: usize,
    /// Estimated error of the acceleration history over its peak; NaN where there is no estimate.
    pub error_estimate: f64,
}

impl Cost {
    /// Before the end.
    pub(super) const UNKNOWN: Self = Self {
        model: f64::NAN,
        setup: f64::NAN,
        steps: f64::NAN,
        total: f64::NAN,
        newton_iterations: 0,
        solves: 0,
        error_estimate: f64::NAN,
    };

    fn numbers(&self) -> [(&'static str, f64); 5] {
        [
            ("wall_time_model", self.model),
            ("wall_time_setup", self.setup),
            ("wall_time_steps", self.steps),
            ("wall_time_total", self.total),
            ("error_estimate", self.error_estimate),
        ]
    }

    fn counts(&self) -> [(&'static str, u64); 2] {
        [("newton_iterations", self.newton_iterations as u64), ("solves", self.solves as u64)]
    }

    pub(super) fn write(&self, root: &Location) -> Result<()> {
        for (name, number) in self.numbers() {
            write_scalar(root, name, number)?;
        }
        for (name, count) in self.counts() {
            write_scalar(root, name, count)?;
        }
        Ok(())
    }

    /// Reads what [`Self::write`] has written.
    pub(super) fn read(root: &Location) -> Result<Self> {
        let number = |name: &str| root.attr(name)?.read_scalar::<f64>();
        let count = |name: &str| root.attr(name)?.read_scalar::<u64>().map(|count| count as usize);
        Ok(Self {
            model: number("wall_time_model")?,
            setup: number("wall_time_setup")?,
            steps: number("wall_time_steps")?,
            total: number("wall_time_total")?,
            newton_iterations: count("newton_iterations")?,
            solves: count("solves")?,
            error_estimate: number("error_estimate")?,
        })
    }

    /// Overwrites in place, so that nothing in the file moves.
    pub(super) fn update(&self, root: &Location) -> Result<()> {
        for (name, number) in self.numbers() {
            root.attr(name)?.write_scalar(&number)?;
        }
        for (name, count) in self.counts() {
            root.attr(name)?.write_scalar(&count)?;
        }
        Ok(())
    }
}

/// A new `run_id`: two runs have the same by a chance of 2⁻⁶⁴.
pub fn new_run_id() -> u64 {
    // What std has of the system's random numbers.
    RandomState::new().build_hasher().finish()
}

impl Provenance {
    /// Writes one attribute a field at `root`; a `None` is left out.
    pub(super) fn write(&self, root: &Location) -> Result<()> {
        for (name, text) in [
            ("title", &self.title),
            ("scene", &self.scene),
            ("folder", &self.folder),
            ("version", &self.version),
            ("commit", &self.commit),
            ("petsc_version", &self.petsc_version),
            ("petsc_options", &self.petsc_options),
            ("model", &self.model),
            ("reduction", &self.reduction),
        ] {
            write_text(root, name, text)?;
        }
        if let Some(digest) = &self.mesh_digest {
            write_text(root, "mesh_digest", digest)?;
        }
        if let Some(details) = &self.model_details {
            details.write(root)?;
        }
        write_scalar(root, "run_id", self.run_id)?;
        write_scalar(root, "ranks", self.ranks as u64)?;
        write_scalar(root, "unknowns", self.unknowns as u64)?;
        write_scalar(root, "impactor_mass", self.impactor_mass)?;
        if let Some(rows) = self.planned_rows {
            write_scalar(root, "planned_rows", rows as u64)?;
        }
        Ok(())
    }

    /// Reads what [`Self::write`] has written.
    pub(super) fn read(root: &Location) -> Result<Self> {
        let words = |name: &str| text(root, name);
        let count = |name: &str| root.attr(name)?.read_scalar::<u64>().map(|count| count as usize);
        Ok(Self {
            run_id: root.attr("run_id").and_then(|id| id.read_scalar()).unwrap_or_default(),
            title: words("title")?,
            scene: words("scene")?,
            folder: words("folder").unwrap_or_default(),
            mesh_digest: words("mesh_digest").ok(),
            version: words("version")?,
            commit: words("commit")?,
            petsc_version: words("petsc_version")?,
            // Earlier versions recorded the option that every session sets itself.
            petsc_options: words("petsc_options")?.replace("-no_signal_handler", "").trim().to_owned(),
            ranks: count("ranks")?,
            model: words("model")?,
            model_details: ModelDetails::read(root).ok(),
            reduction: words("reduction")?,
            unknowns: count("unknowns")?,
            impactor_mass: root.attr("impactor_mass")?.read_scalar()?,
            planned_rows: count("planned_rows").ok(),
        })
    }
}

/// FNV-1a of no bytes.
const OF_NOTHING: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a of bytes, the same in all versions of the program.
pub fn digest(bytes: &[u8]) -> u64 {
    digested(OF_NOTHING, bytes)
}

/// The same of a file, which is read piece by piece.
///
/// # Errors
/// Of a file that cannot be read.
pub fn digest_of_file(path: &Path) -> std::io::Result<u64> {
    let (mut file, mut hash) = (BufReader::new(File::open(path)?), OF_NOTHING);
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

/// FNV-1a of more bytes behind those of a hash.
fn digested(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3))
}

/// A new text attribute. A variable-length string, since fixed ones end at 64 KiB.
pub(super) fn write_text(at: &Location, name: &str, text: &str) -> Result<()> {
    let text: VarLenUnicode = text.parse().map_err(|_| format!("attribute {name}: the text holds a NUL character"))?;
    write_scalar(at, name, text)
}

/// A text attribute.
pub(super) fn text(at: &Location, name: &str) -> Result<String> {
    at.attr(name)?.read_scalar::<VarLenUnicode>().map(|text| text.to_string())
}

/// A new attribute of one value.
pub(super) fn write_scalar<T: H5Type>(at: &Location, name: &str, value: T) -> Result<()> {
    at.new_attr::<T>().create(name)?.write_scalar(&value)
}
