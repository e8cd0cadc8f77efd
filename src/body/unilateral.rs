//! Unilateral foundations (12) of a body that is reduced: linear springs, and a correction of their tensile forces.
//!
//! With the penetrations g = G u − s ū of the foundation points and their stiffness k (N/m),
//!
//! p(u) = Gᵀ k⟨g⟩ = Gᵀ (k g + λ),  λ = k⟨−g⟩.
//!
//! The springs k g are linear. They are part of K and of the loads, so that bases and modes include them. The
//! correction λ is the pull of the springs where the body has lifted off. It is applied in the time steps.

use std::cell::RefCell;

use nalgebra::{DMatrix, DVector};
use petsc_wrap::Vector;

use super::{Body, Pads};
use crate::error::Result;

/// Unilateral foundations of a body whose K contains their springs.
pub struct Unilateral {
    pads: RefCell<Pads>,
    stiffness: DVector<f64>,
    offsets: DVector<f64>,
    /// Surface region of each point.
    places: Vec<usize>,
    /// λ in the equilibrium at the start of the motion, N.
    resting: Option<DVector<f64>>,
    /// ∫ k s·v dS of each foundation region, N: start vectors of bases in addition to the contact force vector.
    pub loads: Vec<Vector>,
}

/// Points of unilateral foundations, with their displacements as linear forms on some coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundationPoints {
    /// Stiffness k of each point, N/m.
    pub stiffness: DVector<f64>,
    /// Offset s ū of each point, m.
    pub offsets: DVector<f64>,
    /// Surface region of each point.
    pub places: Vec<usize>,
    /// Displacement s·u as a linear form on the coordinates, one row for each point.
    pub rows: DMatrix<f64>,
    /// λ in the equilibrium at the start of the motion, N; zero if the motion starts undeformed.
    pub resting: DVector<f64>,
    /// Whether the motion starts from equilibrium.
    pub is_settled: bool,
}

impl Body {
    /// Replaces the pads by springs that act in both directions, with [`Unilateral`] as the correction of their tensile
    /// forces. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn take_pads_as_springs(&mut self) -> Result<()> {
        let Some(mut pads) = self.pads.take() else { return Ok(()) };
        let mut springs = self.terms.elastic.duplicate()?;
        springs.axpy(-1.0, &self.terms.elastic)?;
        if let Some(support) = &self.terms.support {
            springs.axpy(1.0, support)?;
        }
        self.terms.support_offset += pads.add_springs(&mut springs, &mut self.terms.support_load)?;
        springs.assemble()?;
        self.terms.support = Some(springs);
        let points = pads.points();
        let places = points.places;
        let [stiffness, offsets] = [points.weights, points.offsets].map(DVector::from_vec);
        let resting = match &self.equilibrium {
            Some(rest) => {
                let penetration = DVector::from_vec(pads.moved(rest)?) - &offsets;
                Some(stiffness.zip_map(&penetration, pull))
            }
            None => None,
        };
        let loads = pads.loads(&self.terms.load)?;
        self.unilateral = Some(Unilateral { pads: RefCell::new(pads), stiffness, offsets, places, resting, loads });
        Ok(())
    }
}

impl Unilateral {
    /// Returns s·u of all points, m. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub(super) fn moved(&self, u: &Vector) -> Result<Vec<f64>> {
        Ok(self.pads.borrow_mut().moved(u)?)
    }

    /// Number of points.
    pub(super) fn points(&self) -> usize {
        self.stiffness.len()
    }

    /// Returns the points on a basis. `rows` has one column of [`Self::moved`] for each basis vector.
    pub(super) fn on(&self, rows: DMatrix<f64>) -> FoundationPoints {
        FoundationPoints {
            stiffness: self.stiffness.clone(),
            offsets: self.offsets.clone(),
            places: self.places.clone(),
            rows,
            resting: self.resting.clone().unwrap_or_else(|| DVector::zeros(self.stiffness.len())),
            is_settled: self.resting.is_some(),
        }
    }
}

impl FoundationPoints {
    /// Transforms the points to other coordinates. Each column of the matrix is the direction of a new coordinate in
    /// the present ones.
    pub fn on(&self, coordinates: &DMatrix<f64>) -> Self {
        Self { rows: &self.rows * coordinates, ..self.without_rows() }
    }

    /// Returns the stiffness of all points, pressed, along a coordinate.
    pub fn square(&self, coordinate: usize) -> f64 {
        self.rows.column(coordinate).component_mul(&self.stiffness).dot(&self.rows.column(coordinate))
    }

    /// Restricts the points to the first coordinates.
    pub fn leading(&self, count: usize) -> Self {
        Self { rows: self.rows.columns(0, count).into_owned(), ..self.without_rows() }
    }

    /// Restricts the points to some of the coordinates.
    pub fn select(&self, coordinates: &[usize]) -> Self {
        Self { rows: self.rows.select_columns(coordinates), ..self.without_rows() }
    }

    /// Iterates over the entries of all arrays.
    pub(super) fn numbers(&mut self) -> impl Iterator<Item = &mut [f64]> {
        let Self { stiffness, offsets, rows, resting, .. } = self;
        [stiffness, offsets, resting].map(|v| v.as_mut_slice()).into_iter().chain([rows.as_mut_slice()])
    }

    fn without_rows(&self) -> Self {
        let Self { stiffness, offsets, places, resting, is_settled, .. } = self;
        let rows = DMatrix::zeros(0, 0);
        let (stiffness, offsets, resting) = (stiffness.clone(), offsets.clone(), resting.clone());
        Self { stiffness, offsets, places: places.clone(), rows, resting, is_settled: *is_settled }
    }

    /// Returns the shapes in which each pad moves.
    pub fn pad_shapes(&self) -> Vec<PadShapes> {
        let mut places = self.places.clone();
        places.sort_unstable();
        places.dedup();
        places.into_iter().map(|place| PadShapes::new(self, place)).collect()
    }

    /// Returns λ at given penetrations minus λ in equilibrium, N.
    pub fn pull(&self, penetration: &DVector<f64>) -> DVector<f64> {
        self.stiffness.zip_map(penetration, pull) - &self.resting
    }

    /// Returns ½ λ²/k over all points, J: the energy of springs in tension, which does not exist. `pull` is λ minus λ
    /// in equilibrium.
    pub fn energy(&self, pull: &DVector<f64>) -> f64 {
        let terms = pull.iter().zip(&self.resting).zip(&self.stiffness);
        terms.map(|((pull, resting), k)| 0.5 * (pull + resting).powi(2) / k).sum()
    }
}

/// Displacements s·u of the points of one pad as combinations of few shapes: a pad is small compared with the waves of most
/// modes, so that it moves in far fewer ways than there are points or modes.
#[derive(Debug, Clone, PartialEq)]
pub struct PadShapes {
    /// Numbers of the points.
    points: Vec<usize>,
    /// Shapes of unit length, one column each, with a row for each point.
    shapes: DMatrix<f64>,
    /// Amplitude of each shape as a linear form on the coordinates.
    amplitudes: DMatrix<f64>,
}

/// Displacement in the shapes that are left out, relative to the largest displacement of a pad.
const NEGLIGIBLE_SHAPE: f64 = 1e-12;

impl PadShapes {
    /// Factorises the rows of the points in one place: a modified Gram-Schmidt process that takes the longest remaining column
    /// as the next shape (a QR decomposition with column pivoting that stops early).
    fn new(all: &FoundationPoints, place: usize) -> Self {
        let points: Vec<usize> = (0..all.places.len()).filter(|point| all.places[*point] == place).collect();
        let mut left = all.rows.select_rows(&points);
        let (mut shapes, mut amplitudes) = (Vec::new(), Vec::new());
        let mut least = 0.0;
        while shapes.len() < left.ncols() {
            let (longest, length) = left.column_iter().map(|column| column.norm()).enumerate().fold(
                (0, 0.0),
                |(longest, most), (number, length)| if length > most { (number, length) } else { (longest, most) },
            );
            if length <= least {
                break;
            }
            least = f64::max(least, NEGLIGIBLE_SHAPE * length);
            let shape = left.column(longest) / length;
            let amplitude = left.tr_mul(&shape);
            left.ger(-1.0, &shape, &amplitude, 1.0);
            shapes.push(shape);
            amplitudes.push(amplitude.transpose());
        }
        let [rows, columns] = [points.len(), left.ncols()];
        let shapes = DMatrix::from_iterator(rows, shapes.len(), shapes.iter().flat_map(|shape| shape.iter().copied()));
        let amplitudes = DMatrix::from_fn(amplitudes.len(), columns, |shape, column| amplitudes[shape][column]);
        Self { points, shapes, amplitudes }
    }

    /// Adds the displacements of the pad's points, m, at given coordinates.
    pub fn add_displacements(&self, coordinates: &DVector<f64>, displacements: &mut DVector<f64>) {
        let moved = &self.shapes * (&self.amplitudes * coordinates);
        self.points.iter().zip(&moved).for_each(|(point, moved)| displacements[*point] += moved);
    }

    /// Adds the generalised forces along the coordinates of forces on the points, N.
    pub fn add_forces(&self, at_points: &DVector<f64>, along: &mut DVector<f64>) {
        let at_points = at_points.select_rows(&self.points);
        along.gemv_tr(1.0, &self.amplitudes, &self.shapes.tr_mul(&at_points), 1.0);
    }
}

/// Returns k⟨−g⟩.
fn pull(stiffness: f64, penetration: f64) -> f64 {
    stiffness * (-penetration).clamp(0.0, f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Displacements and forces in the shapes are those of the rows, of points of two pads in any order. Waves that are long
    /// compared with a pad have a small rank there.
    #[test]
    fn shapes_have_the_displacements_of_the_rows() {
        let (count, modes) = (400, 60);
        let at = |point: usize| (point % 2) as f64 + 0.1 * (point as f64 * 0.618).fract();
        let rows = DMatrix::from_fn(count, modes, |point, mode| (0.3 * mode as f64 * at(point) + mode as f64).cos());
        let zeros = DVector::zeros(count);
        let all = FoundationPoints {
            stiffness: zeros.clone(),
            offsets: zeros.clone(),
            places: (0..count).map(|point| point % 2).collect(),
            rows,
            resting: zeros.clone(),
            is_settled: false,
        };
        let pads = all.pad_shapes();
        assert!(pads.len() == 2 && pads.iter().all(|pad| pad.shapes.ncols() < 20));
        let x = DVector::from_fn(modes, |mode, _| (mode as f64).sin());
        let (mut moved, mut along) = (zeros, DVector::zeros(modes));
        pads.iter().for_each(|pad| pad.add_displacements(&x, &mut moved));
        pads.iter().for_each(|pad| pad.add_forces(&moved, &mut along));
        // The shapes that are left out have 1e-12 of the largest column, of length 20; sixty of them add up here.
        assert!((&moved - &all.rows * &x).amax() < 1e-9);
        assert!((along - all.rows.tr_mul(&moved)).amax() < 1e-8 * moved.norm());
    }
}
