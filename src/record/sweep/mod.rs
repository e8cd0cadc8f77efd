//! The result of a sweep: one file for all members.

mod begin;
mod member;
mod read;
mod room;
mod write;

pub use member::{Member, Quantity, Status};
pub use read::{Sweep, is_one, is_sweep};
pub use write::SweepWriter;

/// What a sweep is of, and where it comes from: the attributes of the file's root.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// Title of the scene.
    pub title: String,
    /// The scene's full text, without the members' values.
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
    /// What is varied, the slowest first; at least one.
    pub keys: Vec<Key>,
    /// Whether the members' series are kept.
    pub has_series: bool,
    /// Names of the probes in these series.
    pub probes: Vec<String>,
    /// `(i, n)` in a part that has the members i − 1, i − 1 + n, … alone.
    pub shard: Option<(usize, usize)>,
}

/// A key of the scene that is varied.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// Its dotted path.
    pub path: String,
    /// Unit of its values.
    pub units: String,
    /// Whether its values belong on a logarithmic axis.
    pub is_log: bool,
    /// Its value in every member.
    pub values: Values,
}

/// One value a member.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers, in the key's unit.
    Numbers(Vec<f64>),
    /// As the scene has them.
    Words(Vec<String>),
}

impl Values {
    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Words(words) => words.len(),
        }
    }
}

impl Header {
    /// Number of members.
    pub fn members(&self) -> usize {
        self.keys.first().map_or(0, |key| key.values.count())
    }

    /// Whether `other` has the same members with the same results: the same scene, keys and values.
    ///
    /// # Errors
    /// What is different in `other`.
    pub fn check_same(&self, other: &Self) -> Result<(), String> {
        if self.scene != other.scene {
            return Err("holds a sweep of another scene".into());
        }
        let paths = |header: &Self| header.keys.iter().map(|key| key.path.as_str()).collect::<Vec<_>>().join(", ");
        if paths(self) != paths(other) {
            return Err(format!("holds a sweep over {}, not over {}", paths(other), paths(self)));
        }
        if let Some((key, _)) = self.keys.iter().zip(&other.keys).find(|(mine, other)| mine.values != other.values) {
            return Err(format!("holds a sweep over other values of {}", key.path));
        }
        match (self.has_series, other.has_series) {
            (true, false) => Err("holds a sweep without --series".into()),
            (false, true) => Err("holds a sweep with --series".into()),
            _ => Ok(()),
        }
    }
}
