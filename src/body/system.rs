//! A body as plain matrices and vectors, without a mesh, small enough for a copy on every rank.

use nalgebra_sparse::CsrMatrix;
use petsc_wrap::{Comm, Int, Matrix, Vector};

use crate::error::Result;
use crate::solve::Method;

use super::deviates::normal;
use super::{Body, BodyTerms, Clamps, PadOnSurface, Pads};

/// Number of matrix entries that fit into the cache of a core. For smaller matrices, products with an upper triangle
/// are no faster, and extracting it takes long.
const CACHED: u64 = 100_000;

/// Matrices and vectors of M ü + C u̇ + K u = a F + f. All unknowns are numbered from zero, constrained ones included.
#[derive(Debug, Clone)]
pub struct System {
    /// Mass matrix M, kg.
    pub mass: CsrMatrix<f64>,
    /// Operators, loads, contact port and readings.
    pub terms: BodyTerms<CsrMatrix<f64>, Vec<f64>>,
    /// One-sided foundation pads (12).
    pub pads: Vec<PadOnSurface>,
    /// Constrained unknowns and their prescribed values.
    pub held: Vec<(usize, f64)>,
    /// Number of each unknown after an exchange of the two axes, if the body is a square that permits it.
    pub exchange: Option<Vec<usize>>,
    /// Whether parts are nearly incompressible, so that stresses need mode acceleration.
    pub is_nearly_incompressible: bool,
    /// Number of uncoupled symmetry classes. They are consecutive blocks of equally many unknowns, on the diagonals of
    /// all matrices.
    pub classes: usize,
}

impl Body {
    /// Creates the body of a system in PETSc storage, on one rank.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn of(alone: &Comm, system: &System) -> Result<Self> {
        let vector = |values: &[f64]| {
            let mut vector = Vector::new(alone, values.len())?;
            vector.write()?.copy_from_slice(values);
            Ok::<_, crate::Error>(vector)
        };
        let count = system.unknowns();
        let (mut free, mut displacement) = (vec![1.0; count], vec![0.0; count]);
        for (unknown, value) in &system.held {
            (free[*unknown], displacement[*unknown]) = (0.0, *value);
        }
        let clamps = Clamps::new(vector(&free)?, vector(&displacement)?)?;
        let pads = match &system.pads[..] {
            [] => None,
            pads => Some(Pads::new(alone, pads.to_vec(), &clamps)?),
        };
        let force = &system.terms.contact.force;
        let deviates: Vec<f64> = (0..count as u64).map(normal).collect();
        let mass = matrix_of(alone, &system.mass)?;
        let terms = system.terms.try_map(|_, matrix| matrix_of(alone, matrix), |values| vector(values))?;
        let is_cached = terms.elastic.entries()? <= CACHED;
        let triangles = || Ok::<_, crate::Error>([mass.upper_triangle(1)?, terms.elastic.upper_triangle(1)?]);
        Ok(Self {
            products: if is_cached { None } else { Some(triangles()?) },
            contact_entries: (0..).zip(force).filter(|(_, a)| **a != 0.0).map(|(i, a)| (i, *a)).collect(),
            mass,
            terms,
            lumped: None,
            pads,
            unilateral: None,
            clamps,
            equilibrium: None,
            rigid_motions: None,
            method: Method::Cholesky,
            deviates: vector(&deviates)?,
            nodes: None,
            classes: match system.classes {
                0 | 1 => Vec::new(),
                classes => (0..classes).map(|class| Self::of(alone, &system.class(class))).collect::<Result<_>>()?,
            },
        })
    }
}

impl System {
    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.terms.load.len()
    }

    /// Returns one symmetry class as a separate system.
    pub(super) fn class(&self, number: usize) -> Self {
        let size = self.unknowns() / self.classes;
        let range = number * size..(number + 1) * size;
        let square = |matrix: &CsrMatrix<f64>| {
            let rows = &matrix.row_offsets()[range.start..=range.end];
            let entries = rows[0]..rows[size];
            let offsets = rows.iter().map(|end| end - entries.start).collect();
            let columns = matrix.col_indices()[entries.clone()].iter().map(|j| j - range.start).collect();
            CsrMatrix::try_from_csr_data(size, size, offsets, columns, matrix.values()[entries].to_vec())
                .expect("a block on the diagonal")
        };
        let mut terms = self.terms.map(|_, matrix| square(matrix), |vector| vector[range.clone()].to_vec());
        // The prescribed displacement is even and belongs to the first class.
        terms.support_offset = if number == 0 { terms.support_offset } else { 0.0 };
        let held = self.held.iter().filter(|(unknown, _)| range.contains(unknown));
        Self {
            mass: square(&self.mass),
            terms,
            pads: Vec::new(),
            held: held.map(|(unknown, value)| (unknown - range.start, *value)).collect(),
            exchange: None,
            is_nearly_incompressible: self.is_nearly_incompressible,
            classes: 1,
        }
    }
}

fn matrix_of(alone: &Comm, from: &CsrMatrix<f64>) -> Result<Matrix> {
    let numbers = |indices: &[usize]| indices.iter().map(|index| *index as Int).collect::<Vec<_>>();
    Ok(Matrix::csr(alone, &numbers(from.row_offsets()), &numbers(from.col_indices()), from.values())?)
}
