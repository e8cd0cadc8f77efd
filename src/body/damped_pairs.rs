//! Krylov vectors of a body with dampers, by the two-level orthogonal Arnoldi method.
//!
//! With dampers, each vector q has a companion p,
//!
//! q_{j+1} = −S⁻¹ ((C + 2sM) q_j + M p_j),  p_{j+1} = q_j,
//!
//! and both are combinations of the basis vectors. The pairs of their coefficients are kept orthonormal. A vector q that
//! lies in the basis therefore does not end the sequence, since the next one follows from its companion too (D. Lu, Y.
//! Su & Z. Bai, Stability analysis of the two-level orthogonal Arnoldi procedure, SIAM J. Matrix Anal. Appl. 37, 2016).

use nalgebra::{DMatrix, DVector};

use super::columns::Columns;
use super::linear::{LinearBody, Operator};
use crate::error::Result;

/// Ratio of the lengths of a pair after and before orthogonalisation below which the pair is only rounding.
const DEPENDENT: f64 = 1e-12;

/// Vectors with their companions, in coordinates of the basis.
pub(super) struct DampedPairs {
    /// First shift s₁ of the basis, 1/s. All companions are those at this shift, and count over s₁ in products.
    first: f64,
    pairs: Vec<Pair>,
}

/// A vector and its companion, as coefficients of the first basis vectors.
struct Pair {
    vector: DVector<f64>,
    companion: DVector<f64>,
}

impl DampedPairs {
    /// Starts without pairs.
    pub fn new(first: f64) -> Self {
        Self { first, pairs: Vec::new() }
    }

    /// Returns S q for the vector q that follows a pair at the shift `rate` (1/s). Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn right_side(&self, body: &dyn LinearBody, basis: &Columns, number: usize, rate: f64) -> Result<Columns> {
        let Pair { vector, companion } = &self.pairs[number];
        let combined = |of: &DVector<f64>| basis.combined(&DMatrix::from_column_slice(of.len(), 1, of.as_slice()));
        let (q, p) = (combined(vector), combined(companion));
        // p at this shift is p at the first shift plus the difference of the shifts times q.
        let mut side = body.apply(Operator::Mass, &q)?;
        side.scale(rate + self.first);
        side.add(1.0, &body.apply(Operator::Damping, &q)?);
        side.add(1.0, &body.apply(Operator::Mass, &p)?);
        side.scale(-1.0);
        Ok(side)
    }

    /// Adds the pair of a vector that follows the pair `before`, or begins a sequence, at the shift `rate` (1/s). Returns
    /// its number; `None` if it depends on the others.
    pub fn push(&mut self, before: Option<usize>, rate: f64, vector: DVector<f64>) -> Option<usize> {
        let mut companion = DVector::zeros(vector.len());
        if let Some(before) = before {
            let before = &self.pairs[before].vector;
            companion.rows_mut(0, before.len()).copy_from(before);
        }
        companion.axpy(rate - self.first, &vector, 1.0);
        companion /= self.first;
        let mut pair = Pair { vector, companion };
        let length = pair.length();
        // The second pass removes the rounding of the first.
        for _ in 0..2 {
            for Pair { vector, companion } in &self.pairs {
                let count = vector.len();
                let [mut own, mut own_companion] =
                    [&mut pair.vector, &mut pair.companion].map(|v| v.rows_mut(0, count));
                let share = own.dot(vector) + own_companion.dot(companion) / self.first;
                own.axpy(-share, vector, 1.0);
                own_companion.axpy(-share / self.first, companion, 1.0);
            }
        }
        let left = pair.length();
        if left <= DEPENDENT * length {
            return None;
        }
        pair.vector /= left;
        pair.companion *= self.first / left;
        self.pairs.push(pair);
        Some(self.pairs.len() - 1)
    }
}

impl Pair {
    /// Length of the pair, with the companion over s₁.
    fn length(&self) -> f64 {
        self.vector.norm().hypot(self.companion.norm())
    }
}
