//! Parallel factorisation by substructuring: each rank factorises its part of the body, and all ranks share a factor of
//! the interface between the parts (Przemieniecki, AIAA J. 1, 1963).
//!
//! With the unknowns i in the interior of the parts and b on the interface, A = [A_ii A_ib; A_bi A_bb], and A_ii has
//! one block per rank,
//!
//! ```text
//! S = A_bb − Σ A_bi A_ii⁻¹ A_ib,    S x_b = f_b − Σ A_bi A_ii⁻¹ f_i,    x_i = A_ii⁻¹ (f_i − A_ib x_b),
//! ```
//!
//! with sums over the ranks. With A_ii = L Lᵀ, only the forward substitution L⁻¹ is needed before x_b, and only the
//! backward substitution L⁻ᵀ after it. So a solve reads the factor of the rank twice, the same as on a single rank, and
//! sums one vector on the interface over the ranks.

mod partial;
mod split;

use faer::{Mat, Side};
use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::{Comm, MatrixView, Result};

use super::triangle::DenseCholesky;
use partial::PartialCholesky;
use split::Split;

/// Factors of a symmetric positive definite matrix: of this rank's part and of the interface.
pub(super) struct Substructures {
    comm: Comm,
    split: Split,
    part: PartialCholesky,
    /// Factor of S, the same on every rank.
    interface: DenseCholesky,
    /// Values of this rank's interior unknowns, then of the interface unknowns coupled to them.
    local: Vec<f64>,
    /// Right-hand side on the interface: the contribution of this rank.
    mine: Vec<f64>,
    /// Sum of the contributions of all ranks, which becomes x_b.
    all: Vec<f64>,
}

impl Substructures {
    /// Whether the interface is small enough for each rank to store its whole factor: the factor must have no more
    /// entries than the interior rows of the largest rank. It is then much smaller than the factor of a part.
    /// Collective.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for a matrix that is not AIJ.
    pub fn is_suitable(matrix: &MatrixView) -> Result<bool> {
        let split = Split::new(matrix)?;
        let mine: usize = split.rows.iter().map(Vec::len).sum();
        let mut most = 0_u64;
        matrix.comm().mpi().all_reduce_into(&(mine as u64), &mut most, SystemOperation::max());
        Ok(triangle(split.interface.len()) as u64 <= most)
    }

    /// Factorises an assembled matrix; `None` if it is not positive definite. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for a matrix that is not AIJ.
    pub fn new(matrix: &MatrixView) -> Result<Option<Self>> {
        let comm = matrix.comm().clone();
        let split = Split::new(matrix)?;
        let count = split.interface.len();
        // Either all ranks continue or none.
        let (part, mut least) = (PartialCholesky::new(&split.rows, &split.bounds), 0_u64);
        comm.mpi().all_reduce_into(&u64::from(part.is_some()), &mut least, SystemOperation::min());
        let (Some(part), 1) = (part, least) else { return Ok(None) };
        let mut schur = vec![0.0; count * count];
        split.add_own(&mut schur);
        part.subtract_from(&mut schur, &split.coupled);
        let mut sum = vec![0.0; count * count];
        if count > 0 {
            comm.mpi().all_reduce_into(&schur[..], &mut sum[..], SystemOperation::sum());
        }
        drop(schur);
        let schur = Mat::from_fn(count, count, |i, j| sum[i.max(j) * count + i.min(j)]);
        let (factor, mut least) = (schur.llt(Side::Lower), 0_u64);
        comm.mpi().all_reduce_into(&u64::from(factor.is_ok()), &mut least, SystemOperation::min());
        let (Ok(factor), 1) = (factor, least) else { return Ok(None) };
        let interface = DenseCholesky::new(factor.L());
        let local = vec![0.0; split.rows.len() + split.coupled.len()];
        let (mine, all) = (vec![0.0; count], vec![0.0; count]);
        Ok(Some(Self { comm, split, part, interface, local, mine, all }))
    }

    /// Computes x ← A⁻¹ b for this rank's entries. Collective.
    ///
    /// # Panics
    /// If `b` or `x` has fewer entries than this rank has rows.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64]) {
        let Self { comm, split, part, interface, local, mine, all } = self;
        let (inside, coupled) = local.split_at_mut(split.rows.len());
        inside.iter_mut().zip(&split.inside).for_each(|(value, row)| *value = b[*row]);
        coupled.fill(0.0);
        part.forward(local);
        mine.fill(0.0);
        split.own.iter().for_each(|own| mine[own.place] = b[own.row]);
        let (_, coupled) = local.split_at_mut(split.rows.len());
        coupled.iter().zip(&split.coupled).for_each(|(value, place)| mine[*place] += value);
        if !all.is_empty() {
            comm.mpi().all_reduce_into(&mine[..], &mut all[..], SystemOperation::sum());
        }
        interface.solve_in_place(all);
        coupled.iter_mut().zip(&split.coupled).for_each(|(value, place)| *value = all[*place]);
        part.backward(local);
        local.iter().zip(&split.inside).for_each(|(value, row)| x[*row] = *value);
        split.own.iter().for_each(|own| x[own.row] = all[own.place]);
    }
}

/// Number of entries of a triangle of a full matrix, including its diagonal.
fn triangle(count: usize) -> usize {
    count * (count + 1) / 2
}
