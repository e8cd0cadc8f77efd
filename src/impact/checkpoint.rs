//! What an impact goes on from: all of its motion that the next step, and the energies after it, come from.

use std::collections::BTreeMap;

use petsc_wrap::Vector;

use crate::error::{Error, Result};

/// A moment of a run, by name.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Checkpoint {
    /// This rank's values of vectors over the body's unknowns.
    pub vectors: BTreeMap<String, Vec<f64>>,
    /// Numbers that all ranks have alike.
    pub numbers: BTreeMap<String, f64>,
    /// What rank 0 alone knows, beside the state of the body.
    pub lists: BTreeMap<String, Vec<f64>>,
}

/// Visits the values of a state in one order: to save them in a checkpoint, or to restore them from it.
pub struct Visitor<'a> {
    way: Way<'a>,
    /// Before all names.
    prefix: String,
}

enum Way<'a> {
    To(&'a mut Checkpoint),
    From(&'a Checkpoint),
}

impl<'a> Visitor<'a> {
    /// Takes values to a checkpoint.
    pub fn save(checkpoint: &'a mut Checkpoint) -> Self {
        Self { way: Way::To(checkpoint), prefix: String::new() }
    }

    /// Takes values from a checkpoint.
    pub fn restore(checkpoint: &'a Checkpoint) -> Self {
        Self { way: Way::From(checkpoint), prefix: String::new() }
    }

    /// Whether it takes values from a checkpoint.
    pub fn is_restoring(&self) -> bool {
        matches!(self.way, Way::From(_))
    }

    /// Visits values whose names follow the name of their owner.
    ///
    /// # Errors
    /// Those of `visit`.
    pub fn within(&mut self, name: &str, visit: impl FnOnce(&mut Self) -> Result<()>) -> Result<()> {
        let outer = self.prefix.len();
        self.prefix += name;
        self.prefix.push('.');
        let carried = visit(self);
        self.prefix.truncate(outer);
        carried
    }

    /// A number.
    ///
    /// # Errors
    /// [`Error::Output`] where the checkpoint does not have it.
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

    /// A whole number below 2⁵³.
    ///
    /// # Errors
    /// As [`Self::number`], and for what is no such number.
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

    /// A list that rank 0 alone has.
    ///
    /// # Errors
    /// As [`Self::number`].
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

    /// A vector over the body's unknowns.
    ///
    /// # Errors
    /// [`Error::Output`] where the checkpoint does not have it, or has one of another length; PETSc's.
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
