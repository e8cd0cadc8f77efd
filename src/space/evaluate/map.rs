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
                let count = basis.len();
                let mut forms: Vec<Form> = forms.collect();
                let needed = renumbered(&mut forms);
                // Unknown by unknown, so that a form adds up rows.
                let by_unknown: Vec<f64> =
                    needed.iter().flat_map(|&unknown| basis.iter().map(move |vector| vector[unknown])).collect();
                let mut coefficients = vec![0.0; forms.len() * count];
                for (form, row) in forms.iter().zip(coefficients.chunks_exact_mut(count.max(1))) {
                    // Compiled for the vectors of each kind of processor.
                    pulp::Arch::new().dispatch(|| add(form, &by_unknown, row));
                }
                Self::Dense(count, coefficients)
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

/// The unknowns that some forms need, ascending, and the forms on these.
pub fn renumbered(forms: &mut [Form]) -> Vec<usize> {
    let mut needed: Vec<usize> = forms.iter().flatten().map(|(unknown, _)| *unknown).collect();
    needed.sort_unstable();
    needed.dedup();
    for (unknown, _) in forms.iter_mut().flatten() {
        *unknown = needed.partition_point(|before| before < unknown);
    }
    needed
}

/// Adds the rows of a form's unknowns, times its values.
#[inline(always)]
fn add(form: &Form, by_unknown: &[f64], sums: &mut [f64]) {
    let count = sums.len();
    for (unknown, value) in form {
        let of_unknown = &by_unknown[unknown * count..(unknown + 1) * count];
        sums.iter_mut().zip(of_unknown).for_each(|(sum, x)| *sum += value * x);
    }
}
