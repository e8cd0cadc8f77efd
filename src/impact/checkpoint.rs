//! Checkpoint of an impact simulation: the part of its state that the next step and the energies after it depend on.

use std::collections::BTreeMap;

use petsc_wrap::Vector;

use crate::error::{Error, Result};

/// The state of a run at one time, stored as named values.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Checkpoint {
    /// Values of vectors over the body's unknowns: the part owned by this rank.
    pub vectors: BTreeMap<String, Vec<f64>>,
    /// Scalars, the same on all ranks.
    pub numbers: BTreeMap<String, f64>,
    /// Lists that only rank 0 has, in addition to the state of the body.
    pub lists: BTreeMap<String, Vec<f64>>,
}

/// Visits the values of a state in a fixed order, either to save them in a checkpoint or to restore them from it.
pub struct Visitor<'a> {
    way: Way<'a>,
    /// Prefix of all names.
    prefix: String,
}

enum Way<'a> {
    To(&'a mut Checkpoint),
    From(&'a Checkpoint),
}

impl<'a> Visitor<'a> {
    /// Returns a visitor that saves values in a checkpoint.
    pub fn save(checkpoint: &'a mut Checkpoint) -> Self {
        Self { way: Way::To(checkpoint), prefix: String::new() }
    }

    /// Returns a visitor that restores values from a checkpoint.
    pub fn restore(checkpoint: &'a Checkpoint) -> Self {
        Self { way: Way::From(checkpoint), prefix: String::new() }
    }

    /// Whether the visitor restores values from a checkpoint.
    pub fn is_restoring(&self) -> bool {
        matches!(self.way, Way::From(_))
    }

    /// Visits values of a part of the state; their names get the prefix `name` and a dot.
    ///
    /// # Errors
    /// Same as `visit`.
    pub fn within(&mut self, name: &str, visit: impl FnOnce(&mut Self) -> Result<()>) -> Result<()> {
        let outer = self.prefix.len();
        self.prefix += name;
        self.prefix.push('.');
        let carried = visit(self);
        self.prefix.truncate(outer);
        carried
    }

    /// Saves or restores a number.
    ///
    /// # Errors
    /// [`Error::Output`] if the checkpoint does not have the number.
    pub fn number(&mut self, name: &str, value: &mut f64) -> Result<()> {
        let name = format!("{}{name}", self.prefix);
        match &mut self.way {
            Way::To(checkpoint) => {
                checkpoint.numbers.insert(name, *value);
            }
            Way::From(checkpoint) => *value = *checkpoint.numbers.get(&name).ok_or_else(|| missing(&name))?,
        }
        Ok(())
    }

    /// Saves or restores a non-negative integer below 9e15, which a double holds exactly.
    ///
    /// # Errors
    /// Same as [`Self::number`]; [`Error::Output`] if the value is not such an integer.
    pub fn count(&mut self, name: &str, value: &mut usize) -> Result<()> {
        let mut number = *value as f64;
        self.number(name, &mut number)?;
        if !(0.0..9e15).contains(&number) || number.fract() != 0.0 {
            return Err(Error::Output(format!(
                "the checkpoint's {}{name} is {number}, which is no count",
                self.prefix
            )));
        }
        *value = number as usize;
        Ok(())
    }

    /// Saves or restores a list that only rank 0 has.
    ///
    /// # Errors
    /// Same as [`Self::number`].
    pub fn list(&mut self, name: &str, list: &mut Vec<f64>) -> Result<()> {
        let name = format!("{}{name}", self.prefix);
        match &mut self.way {
            Way::To(checkpoint) => {
                checkpoint.lists.insert(name, list.clone());
            }
            Way::From(checkpoint) => list.clone_from(checkpoint.lists.get(&name).ok_or_else(|| missing(&name))?),
        }
        Ok(())
    }

    /// Saves or restores a vector over the body's unknowns.
    ///
    /// # Errors
    /// [`Error::Output`] if the checkpoint does not have the vector or its length differs; if a PETSc call fails.
    pub fn vector(&mut self, name: &str, vector: &mut Vector) -> Result<()> {
        let name = format!("{}{name}", self.prefix);
        match &mut self.way {
            Way::To(checkpoint) => {
                checkpoint.vectors.insert(name, vector.read()?.to_vec());
            }
            Way::From(checkpoint) => {
                let values = checkpoint.vectors.get(&name).ok_or_else(|| missing(&name))?;
                let mut place = vector.write()?;
                if place.len() != values.len() {
                    let message = format!("the checkpoint's {name} has {} unknowns, not {}", values.len(), place.len());
                    return Err(Error::Output(message));
                }
                place.copy_from_slice(values);
            }
        }
        Ok(())
    }
}

fn missing(name: &str) -> Error {
    Error::Output(format!("the checkpoint has no {name}: it is of another kind of run, or of another version"))
}
