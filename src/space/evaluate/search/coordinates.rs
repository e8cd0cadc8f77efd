//! Coordinates of many steps, computed only for the steps that need them.

use std::borrow::Cow;

use nalgebra::DMatrix;

/// Coordinates of a body (unknowns or reduced coordinates) at some steps.
#[derive(Clone, Copy)]
pub enum Coordinates<'a> {
    /// Coordinates step by step.
    Given(&'a [f64]),
    /// Product of `columns` and the states of the steps.
    Of {
        /// Matrix with a row for each coordinate and a column for each state variable.
        columns: &'a DMatrix<f64>,
        /// States step by step; the length of a state is the number of columns.
        states: &'a [f64],
    },
}

impl Coordinates<'_> {
    /// Coordinates of some steps, `count` each, step by step.
    pub fn of(&self, steps: &[usize], count: usize) -> Vec<f64> {
        let chosen = |all: &[f64], length: usize| {
            let mut of_steps = Vec::with_capacity(steps.len() * length);
            steps.iter().for_each(|step| of_steps.extend_from_slice(&all[step * length..(step + 1) * length]));
            of_steps
        };
        match self {
            Self::Given(all) => chosen(all, count),
            Self::Of { columns, states } => made(columns, chosen(states, columns.ncols())),
        }
    }

    /// Coordinates of all steps.
    pub fn all(&self) -> Cow<'_, [f64]> {
        match self {
            Self::Given(all) => Cow::Borrowed(all),
            Self::Of { columns, states } => Cow::Owned(made(columns, states.to_vec())),
        }
    }
}

impl<'a> From<&'a Vec<f64>> for Coordinates<'a> {
    fn from(all: &'a Vec<f64>) -> Self {
        Self::Given(all)
    }
}

fn made(columns: &DMatrix<f64>, states: Vec<f64>) -> Vec<f64> {
    let steps = states.len() / columns.ncols();
    (columns * DMatrix::from_vec(columns.ncols(), steps, states)).data.into()
}
