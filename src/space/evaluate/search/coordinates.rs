//! The coordinates of many steps, of which those are made that are wanted.

use std::borrow::Cow;

use nalgebra::DMatrix;

/// The coordinates in which a body moves, at some steps.
#[derive(Clone, Copy)]
pub enum Coordinates<'a> {
    /// One step after the other.
    Given(&'a [f64]),
    /// Columns times the states of the steps, which are one after the other.
    Of {
        /// A row for each coordinate.
        columns: &'a DMatrix<f64>,
        /// As long as there are columns, each.
        states: &'a [f64],
    },
}

impl Coordinates<'_> {
    /// Those of some steps, so many each, one step after the other.
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

    /// Those of all steps.
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
