//! Result of a sweep: one file for all members.

mod begin;
mod member;
mod read;
mod room;
#[cfg(test)]
mod tests;
mod write;

pub use member::{Member, Quantity, Status};
pub use read::{Sweep, is_one, is_sweep};
pub use write::SweepWriter;

use std::collections::HashSet;

use crate::record::provenance::Origin;

/// Definition and provenance of a sweep: the attributes of the root of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// Scene, without the values of the members, and program.
    pub origin: Origin,
    /// Varied keys, the slowest first; at least one.
    pub keys: Vec<Key>,
    /// Whether the series of the members are stored.
    pub has_series: bool,
    /// Names of the probes in the series.
    pub probes: Vec<String>,
    /// Shard `(i, n)` if the file has only the members i − 1, i − 1 + n, …; `None` if it has all.
    pub shard: Option<(usize, usize)>,
}

/// Varied key of the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Key {
    /// Dotted path of the key.
    pub path: String,
    /// Unit of the values.
    pub units: String,
    /// Whether a figure shows the values on a logarithmic axis.
    pub is_log: bool,
    /// Value of the key in every member.
    pub values: Values,
}

/// Values of a key, one for each member.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// Numbers, in the key's unit.
    Numbers(Vec<f64>),
    /// Texts, as in the scene.
    Words(Vec<String>),
}

impl Values {
    /// Number of members.
    pub fn count(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Words(words) => words.len(),
        }
    }

    /// Number of different values.
    pub fn distinct(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.iter().map(|number| number.to_bits()).collect::<HashSet<_>>().len(),
            Self::Words(words) => words.iter().collect::<HashSet<_>>().len(),
        }
    }
}

impl Header {
    /// Number of members.
    pub fn members(&self) -> usize {
        self.keys.first().map_or(0, |key| key.values.count())
    }

    /// Checks that `other` has the same members with the same results: the same scene, keys and values.
    ///
    /// # Errors
    /// If they differ: text with the difference, as a statement about `other`.
    pub fn check_same(&self, other: &Self) -> Result<(), String> {
        if self.origin.scene != other.origin.scene {
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
