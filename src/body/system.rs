//! A body as plain matrices and vectors, without a mesh, small enough for a copy on every rank.

use nalgebra_sparse::CsrMatrix;
use petsc_wrap::{Comm, Int, Matrix, Vector};

use crate::contact::{Footprint, Localization};
use crate::error::Result;
use crate::material::Maxwell;
use crate::solve::Method;

use super::deviates::normal;
use super::{Body, Clamps, InfinitePlate, PadOnSurface, Pads, Relaxation};

/// Number of matrix entries that fit into the cache of a core. For smaller matrices, products with an upper triangle
/// are no faster, and extracting it takes long.
const CACHED: u64 = 100_000;

/// Matrices and vectors of M ü + C u̇ + K u = a F + f. All unknowns are numbered from zero, constrained ones included.
#[derive(Debug, Clone)]
pub struct System {
    /// Mass matrix M, kg.
    pub mass: CsrMatrix<f64>,
    /// Stiffness K of the elastic body alone, N/m. Viscoelastic parts contribute their fully relaxed stiffness.
    pub elastic: CsrMatrix<f64>,
    /// Distortion stiffness D and Prony series of each viscoelastic part ([`Relaxation`]).
    pub relaxations: Vec<(CsrMatrix<f64>, Maxwell)>,
    /// Stiffness K of the elastic supports (11), N/m.
    pub support: Option<CsrMatrix<f64>>,
    /// Damping matrix C of the dampers (13), N s/m.
    pub damping: Option<CsrMatrix<f64>>,
    /// One-sided foundation pads (12).
    pub pads: Vec<PadOnSurface>,
    /// Constrained unknowns and their prescribed values.
    pub held: Vec<(usize, f64)>,
    /// Load vector f of the body force and the tractions, N.
    pub load: Vec<f64>,
    /// ∫ k ū·v dS of the elastic supports, N.
    pub support_load: Vec<f64>,
    /// ½ ∫ k ū·ū dS of the elastic supports, J.
    pub support_offset: f64,
    /// Contact force vector a: aᵀu is the displacement of the surface along the impactor's direction, m.
    pub localization: Vec<f64>,
    /// Local compliance c of the contact law α = δ + c F, m/N, of the modelled part.
    pub compliance: f64,
    /// Distribution of the contact force on the surface.
    pub footprint: Footprint,
    /// Stresses σ_a, σ_b and σ_ab, Pa, along the axes of a face, as linear forms: on the face opposite the impact point, then
    /// at other watched places. Empty if they are not read.
    pub hit_stress: Vec<Vec<f64>>,
    /// Local stresses that the first three forms lack for a force of 1 N on the whole body, Pa.
    pub local_stress_per_newton: [f64; 3],
    /// Unknowns of a rigid unit translation along the impactor's direction.
    pub translation: Vec<f64>,
    /// Response of an infinite plate of the same section, if the body is a plate.
    pub infinite_plate: Option<InfinitePlate>,
    /// Number of each unknown after an exchange of the two axes, if the body is a square that permits it.
    pub exchange: Option<Vec<usize>>,
    /// Whether parts are nearly incompressible, so that stresses need mode acceleration.
    pub is_nearly_incompressible: bool,
    /// Number of such bodies that form the whole.
    pub multiplicity: f64,
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
        let count = system.load.len();
        let of_list = |matrix: &Option<CsrMatrix<f64>>| matrix.as_ref().map(|m| matrix_of(alone, m)).transpose();
        let (mut free, mut displacement) = (vec![1.0; count], vec![0.0; count]);
        for (unknown, value) in &system.held {
            (free[*unknown], displacement[*unknown]) = (0.0, *value);
        }
        let clamps = Clamps::new(vector(&free)?, vector(&displacement)?)?;
        let pads = match &system.pads[..] {
            [] => None,
            pads => Some(Pads::new(alone, pads.to_vec(), &clamps)?),
        };
        let entries = (0..).zip(&system.localization).filter(|(_, a)| **a != 0.0).map(|(i, a)| (i, *a)).collect();
        let deviates: Vec<f64> = (0..count as u64).map(normal).collect();
        let (mass, elastic) = (matrix_of(alone, &system.mass)?, matrix_of(alone, &system.elastic)?);
        let relaxation = |(distortion, chain): &(CsrMatrix<f64>, Maxwell)| {
            Ok::<_, crate::Error>(Relaxation { distortion: matrix_of(alone, distortion)?, chain: chain.clone() })
        };
        let relaxations = system.relaxations.iter().map(relaxation).collect::<Result<Vec<_>>>()?;
        let is_cached = elastic.entries()? <= CACHED;
        let triangles = || Ok::<_, crate::Error>([mass.upper_triangle(1)?, elastic.upper_triangle(1)?]);
        Ok(Self {
            products: if is_cached { None } else { Some(triangles()?) },
            mass,
            elastic,
            relaxations,
            support: of_list(&system.support)?,
            damping: of_list(&system.damping)?,
            lumped: None,
            pads,
            unilateral: None,
            clamps,
            equilibrium: None,
            load: vector(&system.load)?,
            support_load: vector(&system.support_load)?,
            support_offset: system.support_offset,
            localization: Localization {
                vector: vector(&system.localization)?,
                entries,
                compliance: system.compliance,
                footprint: system.footprint,
            },
            rigid_motions: None,
            method: Method::Cholesky,
            hit_stress: system.hit_stress.iter().map(|form| vector(form)).collect::<Result<_>>()?,
            local_stress_per_newton: system.local_stress_per_newton,
            translation: vector(&system.translation)?,
            infinite_plate: system.infinite_plate.clone(),
            deviates: vector(&deviates)?,
            nodes: None,
            multiplicity: system.multiplicity,
            classes: match system.classes {
                0 | 1 => Vec::new(),
                classes => (0..classes).map(|class| Self::of(alone, &system.class(class))).collect::<Result<_>>()?,
            },
        })
    }
}

impl System {
    /// Returns the body with elastic parts in place of the viscoelastic ones, with their secant moduli at a time, s.
    pub(super) fn with_secant_moduli(&self, time: f64) -> Self {
        let elastic = self.relaxations.iter().fold(self.elastic.clone(), |sum, (distortion, chain)| {
            add(sum, chain.secant(time) - chain.equilibrium, distortion)
        });
        Self {
            elastic,
            relaxations: Vec::new(),
            mass: self.mass.clone(),
            support: self.support.clone(),
            damping: self.damping.clone(),
            pads: self.pads.clone(),
            held: self.held.clone(),
            load: self.load.clone(),
            support_load: self.support_load.clone(),
            localization: self.localization.clone(),
            hit_stress: self.hit_stress.clone(),
            translation: self.translation.clone(),
            infinite_plate: self.infinite_plate.clone(),
            exchange: self.exchange.clone(),
            ..*self
        }
    }

    /// Returns one symmetry class as a separate system.
    pub(super) fn class(&self, number: usize) -> Self {
        let size = self.load.len() / self.classes;
        let range = number * size..(number + 1) * size;
        let square = |matrix: &CsrMatrix<f64>| {
            let rows = &matrix.row_offsets()[range.start..=range.end];
            let entries = rows[0]..rows[size];
            let offsets = rows.iter().map(|end| end - entries.start).collect();
            let columns = matrix.col_indices()[entries.clone()].iter().map(|j| j - range.start).collect();
            CsrMatrix::try_from_csr_data(size, size, offsets, columns, matrix.values()[entries].to_vec())
                .expect("a block on the diagonal")
        };
        let part = |vector: &Vec<f64>| vector[range.clone()].to_vec();
        let held = self.held.iter().filter(|(unknown, _)| range.contains(unknown));
        Self {
            mass: square(&self.mass),
            elastic: square(&self.elastic),
            support: self.support.as_ref().map(square),
            damping: self.damping.as_ref().map(square),
            pads: Vec::new(),
            held: held.map(|(unknown, value)| (unknown - range.start, *value)).collect(),
            load: part(&self.load),
            support_load: part(&self.support_load),
            // The prescribed displacement is even and belongs to the first class.
            support_offset: if number == 0 { self.support_offset } else { 0.0 },
            localization: part(&self.localization),
            hit_stress: self.hit_stress.iter().map(part).collect(),
            translation: part(&self.translation),
            relaxations: self.relaxations.iter().map(|(d, chain)| (square(d), chain.clone())).collect(),
            infinite_plate: self.infinite_plate.clone(),
            exchange: None,
            classes: 1,
            ..*self
        }
    }
}

/// Returns A + factor B.
fn add(mut to: CsrMatrix<f64>, factor: f64, other: &CsrMatrix<f64>) -> CsrMatrix<f64> {
    let is_within = |row: usize| {
        let (all, few) = (to.row(row), other.row(row));
        let mut columns = all.col_indices().iter();
        few.col_indices().iter().all(|column| columns.any(|of_all| of_all == column))
    };
    if !(0..to.nrows()).all(is_within) {
        return to + other.clone() * factor;
    }
    // Usually, the sum has the same entries as A.
    for row in 0..to.nrows() {
        let (mut row, other) = (to.row_mut(row), other.row(row));
        let (columns, values) = row.cols_and_values_mut();
        let mut entries = columns.iter().zip(values);
        for (column, value) in other.col_indices().iter().zip(other.values()) {
            if let Some((_, sum)) = entries.find(|(of_sum, _)| *of_sum == column) {
                *sum += factor * value;
            }
        }
    }
    to
}

fn matrix_of(alone: &Comm, from: &CsrMatrix<f64>) -> Result<Matrix> {
    let numbers = |indices: &[usize]| indices.iter().map(|index| *index as Int).collect::<Vec<_>>();
    Ok(Matrix::csr(alone, &numbers(from.row_offsets()), &numbers(from.col_indices()), from.values())?)
}
