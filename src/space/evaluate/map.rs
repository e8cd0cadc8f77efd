//! Linear forms on the coordinates in which a body moves: its unknowns, or those on a basis.

use super::Form;

/// Some forms, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub enum Map {
    /// On the unknowns.
    Sparse(Vec<Form>),
    /// On a basis: so many coefficients a form.
    Dense(usize, Vec<f64>),
}

impl Map {
    /// Forms on the unknowns, or, with a basis, on its coordinates: vector by vector the values of all unknowns.
    pub fn new(forms: impl Iterator<Item = Form>, basis: Option<&[Vec<f64>]>) -> Self {
        match basis {
            None => Self::Sparse(forms.collect()),
            Some(basis) => {
                let along = |form: &Form, vector: &[f64]| form.iter().map(|(i, value)| value * vector[*i]).sum::<f64>();
                let coefficients =
                    forms.flat_map(|form| basis.iter().map(|vector| along(&form, vector)).collect::<Vec<f64>>());
                Self::Dense(basis.len(), coefficients.collect())
            }
        }
    }

    /// How many.
    pub fn len(&self) -> usize {
        match self {
            Self::Sparse(forms) => forms.len(),
            Self::Dense(count, coefficients) => coefficients.len() / (*count).max(1),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Their values.
    pub fn apply(&self, coordinates: &[f64]) -> Vec<f64> {
        match self {
            Self::Sparse(forms) => {
                forms.iter().map(|form| form.iter().map(|(i, value)| value * coordinates[*i]).sum()).collect()
            }
            Self::Dense(count, coefficients) => coefficients
                .chunks_exact((*count).max(1))
                .map(|row| row.iter().zip(coordinates).map(|(a, b)| a * b).sum())
                .collect(),
        }
    }
}
