//! Unilateral foundations (12) of a body that is reduced: springs, and what these must not pull.
//!
//! With the penetrations g = G u − s ū of the foundations' points and their stiffness k (N/m),
//!
//! p(u) = Gᵀ k⟨g⟩ = Gᵀ (k g + λ),  λ = k⟨−g⟩.
//!
//! The springs k g are linear: they go to K and to the loads, so that bases and modes know them. λ, their pull where the body has lifted
//! off, is left to the steps.

use std::cell::RefCell;

use nalgebra::{DMatrix, DVector};
use petsc_wrap::Vector;

use super::{Body, Pads};
use crate::error::Result;

/// The foundations of a body whose K has their springs.
pub struct Unilateral {
    pads: RefCell<Pads>,
    stiffness: DVector<f64>,
    offsets: DVector<f64>,
    /// λ in the equilibrium that the motion starts in, N.
    resting: Option<DVector<f64>>,
    /// ∫ k s·v dS over each place, N: what bases begin with, beside the contact's force.
    pub loads: Vec<Vector>,
}

/// The points of unilateral foundations, with their displacements as linear forms on some coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundationPoints {
    /// k, N/m.
    pub stiffness: DVector<f64>,
    /// s ū, m.
    pub offsets: DVector<f64>,
    /// s·u of the coordinates, a row for each point.
    pub rows: DMatrix<f64>,
    /// λ in the equilibrium that the motion starts in, N; zero where it starts undeformed.
    pub resting: DVector<f64>,
    /// Whether it starts in equilibrium.
    pub is_settled: bool,
}

impl Body {
    /// Replaces the pads by springs that act in both directions, and [`Unilateral`], which says what these pull too much. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn take_pads_as_springs(&mut self) -> Result<()> {
        let Some(mut pads) = self.pads.take() else { return Ok(()) };
        let mut springs = self.elastic.duplicate()?;
        springs.axpy(-1.0, &self.elastic)?;
        if let Some(support) = &self.support {
            springs.axpy(1.0, support)?;
        }
        self.support_offset += pads.add_springs(&mut springs, &mut self.support_load)?;
        springs.assemble()?;
        self.support = Some(springs);
        let points = pads.points();
        let [stiffness, offsets] = [points.weights, points.offsets].map(DVector::from_vec);
        let resting = match &self.equilibrium {
            Some(rest) => {
                let penetration = DVector::from_vec(pads.moved(rest)?) - &offsets;
                Some(stiffness.zip_map(&penetration, pull))
            }
            None => None,
        };
        let loads = pads.loads(&self.load)?;
        self.unilateral = Some(Unilateral { pads: RefCell::new(pads), stiffness, offsets, resting, loads });
        Ok(())
    }
}

impl Unilateral {
    /// s·u of all points, m. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn moved(&self, u: &Vector) -> Result<Vec<f64>> {
        Ok(self.pads.borrow_mut().moved(u)?)
    }

    /// How many points there are.
    pub(super) fn points(&self) -> usize {
        self.stiffness.len()
    }

    /// The points on a basis, with a column of [`Self::moved`] for each vector.
    pub(super) fn on(&self, rows: DMatrix<f64>) -> FoundationPoints {
        FoundationPoints {
            stiffness: self.stiffness.clone(),
            offsets: self.offsets.clone(),
            rows,
            resting: self.resting.clone().unwrap_or_else(|| DVector::zeros(self.stiffness.len())),
            is_settled: self.resting.is_some(),
        }
    }
}

impl FoundationPoints {
    /// The same on other coordinates, of which the present ones are the sums in the columns of a matrix.
    pub fn on(&self, coordinates: &DMatrix<f64>) -> Self {
        Self { rows: &self.rows * coordinates, ..self.without_rows() }
    }

    /// Stiffness of all points, pressed, along a coordinate.
    pub fn square(&self, coordinate: usize) -> f64 {
        self.rows.column(coordinate).component_mul(&self.stiffness).dot(&self.rows.column(coordinate))
    }

    /// The same on the first coordinates.
    pub fn leading(&self, count: usize) -> Self {
        Self { rows: self.rows.columns(0, count).into_owned(), ..self.without_rows() }
    }

    /// The same on some of the coordinates.
    pub fn select(&self, coordinates: &[usize]) -> Self {
        Self { rows: self.rows.select_columns(coordinates), ..self.without_rows() }
    }

    fn without_rows(&self) -> Self {
        let Self { stiffness, offsets, resting, is_settled, .. } = self;
        let rows = DMatrix::zeros(0, 0);
        let (stiffness, offsets, resting) = (stiffness.clone(), offsets.clone(), resting.clone());
        Self { stiffness, offsets, rows, resting, is_settled: *is_settled }
    }

    /// g at coordinates, m.
    pub fn penetration(&self, coordinates: &DVector<f64>) -> DVector<f64> {
        let mut penetration = -&self.offsets;
        penetration.gemv(1.0, &self.rows, coordinates, 1.0);
        penetration
    }

    /// λ at penetrations less that in equilibrium, N.
    pub fn pull(&self, penetration: &DVector<f64>) -> DVector<f64> {
        self.stiffness.zip_map(penetration, pull) - &self.resting
    }

    /// ½ λ²/k over all points, J: what of the springs' energy is none, by λ less that in equilibrium.
    pub fn energy(&self, pull: &DVector<f64>) -> f64 {
        let terms = pull.iter().zip(&self.resting).zip(&self.stiffness);
        terms.map(|((pull, resting), k)| 0.5 * (pull + resting).powi(2) / k).sum()
    }
}

/// k⟨−g⟩.
fn pull(stiffness: f64, penetration: f64) -> f64 {
    stiffness * (-penetration).clamp(0.0, f64::INFINITY)
}
