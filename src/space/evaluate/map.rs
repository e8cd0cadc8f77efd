//! Linear forms on the coordinates of a body: its unknowns, or the reduced coordinates of a basis.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};

use super::Form;

/// A sequence of linear forms.
#[derive(Debug, Clone, PartialEq)]
pub enum Map {
    /// Forms on the unknowns.
    Sparse(Vec<Form>),
    /// Forms on a basis: the number of coefficients of a form, and the coefficients form by form.
    Dense(usize, Vec<f64>),
}

impl Map {
    /// Forms on the unknowns or, with a basis, on its coordinates. Each basis vector holds the values of all unknowns.
    pub fn new(forms: impl Iterator<Item = Form>, basis: Option<&[Vec<f64>]>) -> Self {
        match basis {
            None => Self::Sparse(forms.collect()),
            Some(basis) => Self::Dense(basis.len(), Self::coefficients(forms.collect(), basis)),
        }
    }

    /// Coefficients of forms on the coordinates of a basis, form by form.
    pub fn coefficients(mut forms: Vec<Form>, basis: &[Vec<f64>]) -> Vec<f64> {
        let count = basis.len();
        let needed = renumbered(&mut forms);
        // Rows by unknown, so that a form is a sum of rows.
        let by_unknown: Vec<f64> =
            needed.iter().flat_map(|&unknown| basis.iter().map(move |vector| vector[unknown])).collect();
        let mut coefficients = vec![0.0; forms.len() * count];
        for (form, row) in forms.iter().zip(coefficients.chunks_exact_mut(count.max(1))) {
            // Compiled for the vector units of each kind of processor.
            pulp::Arch::new().dispatch(|| add(form, &by_unknown, row));
        }
        coefficients
    }

    /// Number of forms.
    pub fn len(&self) -> usize {
        match self {
            Self::Sparse(forms) => forms.len(),
            Self::Dense(count, coefficients) => coefficients.len() / (*count).max(1),
        }
    }

    /// Whether there are no forms.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Values of the forms.
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

/// Products of `rows`, form by form, with the coordinates of some steps, `count` each: a column of values for each step.
pub fn products_of_steps(rows: &[f64], count: usize, coordinates: &[f64]) -> Vec<f64> {
    let (forms, steps) = (rows.len() / count.max(1), coordinates.len() / count.max(1));
    let mut products = vec![0.0; forms * steps];
    matmul(
        MatMut::from_column_major_slice_mut(&mut products, forms, steps),
        Accum::Replace,
        MatRef::from_row_major_slice(rows, forms, count),
        MatRef::from_column_major_slice(coordinates, count, steps),
        1.0,
        Par::Seq,
    );
    products
}

/// Renumbers the unknowns that the forms use, and returns these unknowns, ascending.
pub fn renumbered(forms: &mut [Form]) -> Vec<usize> {
    let end = forms.iter().flatten().map(|(unknown, _)| unknown + 1).max().unwrap_or_default();
    let mut is_needed = vec![false; end];
    forms.iter().flatten().for_each(|(unknown, _)| is_needed[*unknown] = true);
    let needed: Vec<usize> = (0..end).filter(|unknown| is_needed[*unknown]).collect();
    let mut numbers = vec![0; end];
    needed.iter().enumerate().for_each(|(number, unknown)| numbers[*unknown] = number);
    forms.iter_mut().flatten().for_each(|(unknown, _)| *unknown = numbers[*unknown]);
    needed
}

/// Adds the rows of the unknowns of a form, times its values.
#[inline(always)]
fn add(form: &Form, by_unknown: &[f64], sums: &mut [f64]) {
    let count = sums.len();
    for (unknown, value) in form {
        let of_unknown = &by_unknown[unknown * count..(unknown + 1) * count];
        sums.iter_mut().zip(of_unknown).for_each(|(sum, x)| *sum += value * x);
    }
}
