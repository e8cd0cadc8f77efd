//! The interface of a linear body for model reduction, for bodies held by one process ([`LocalBody`](super::LocalBody))
//! or by PETSc ([`Body`](super::Body)).

use crate::error::Result;
use crate::material::Maxwell;

use super::columns::Columns;
use super::direct::Precision;
use super::shift::Solver;
use super::{BodyTerms, DiagonalSymmetry, FoundationPoints, InfinitePlate, StressReadings};

/// Selects one of the symmetric operators of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// Mass matrix M, kg.
    Mass,
    /// Stiffness K of the elastic body alone, N/m. Viscoelastic parts contribute their fully relaxed stiffness.
    Elastic,
    /// Stiffness K of the elastic supports (11), N/m.
    Support,
    /// Damping matrix C of the dampers (13), N s/m.
    Damping,
    /// Distortion stiffness D of the viscoelastic part with this number, m ([`LinearBody::chains`]).
    Distortion(usize),
}

/// Vectors and scalars of a body. Vectors contain this rank's rows.
pub struct Properties {
    /// Empty set of columns with the row layout of the body's vectors.
    pub layout: Columns,
    /// Rows of the constrained unknowns.
    pub held: Vec<usize>,
    /// Static displacement u, m, if the motion starts from equilibrium.
    pub equilibrium: Option<Vec<f64>>,
    /// Load vector of each unilateral foundation for a penetration of 1 m, N.
    pub pushed: Vec<Vec<f64>>,
    /// Vectors and numbers of the terms; which operators there are. Without readings.
    pub terms: BodyTerms<(), Vec<f64>>,
    /// Stresses that are read.
    pub readings: StressReadings<Vec<f64>>,
    /// Whether nothing resists a translation along the impactor's direction.
    pub is_free: bool,
    /// Same as [`System::is_nearly_incompressible`](super::System::is_nearly_incompressible).
    pub is_nearly_incompressible: bool,
}

impl Properties {
    /// Returns the load vector of all loads, N, if they excite waves: if the motion does not start from equilibrium.
    /// Collective.
    pub(super) fn sudden_loads(&self) -> Option<Columns> {
        let mut loads = self.layout.one(self.terms.load.clone());
        loads.add(1.0, &self.layout.one(self.terms.support_load.clone()));
        Some(loads).filter(|loads| self.equilibrium.is_none() && loads.largest() > 0.0)
    }
}

/// A linear body. All ranks that share it must call each method together.
pub trait LinearBody {
    /// Number of unknowns on all ranks.
    fn unknowns(&self) -> usize;

    /// Returns the vectors and scalars of the body.
    ///
    /// # Errors
    /// If a PETSc call fails.
    fn properties(&self) -> Result<Properties>;

    /// Whether the body has this operator.
    fn has(&self, operator: Operator) -> bool;

    /// Returns the products of an operator with vectors; zero if the body does not have the operator.
    ///
    /// # Errors
    /// If a PETSc call fails.
    fn apply(&self, operator: Operator, vectors: &Columns) -> Result<Columns>;

    /// Returns a solver for S(s) = K + G̃(s) D + s C + s² M at the shift s = `rate` (1/s), without the constrained
    /// unknowns.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] if the matrix is not positive definite. Other errors if a PETSc call fails.
    fn solver(&self, rate: f64, precision: Precision) -> Result<Solver>;

    /// Returns the generalised Maxwell chain (Prony series) of each viscoelastic part.
    fn chains(&self) -> Vec<&Maxwell>;

    /// Returns the response of an infinite plate of the same section, if the body is a plate.
    fn infinite_plate(&self) -> Option<&InfinitePlate>;

    /// Whether the body rests on unilateral foundations, with their springs included in the support stiffness.
    fn is_on_foundations(&self) -> bool;

    /// Returns the points of the unilateral foundations, projected onto a basis.
    ///
    /// # Errors
    /// If a PETSc call fails.
    fn foundation(&self, basis: &Columns) -> Result<Option<FoundationPoints>>;

    /// Whether the unknowns belong to a mesh. Basis vectors are expensive in this case.
    fn is_meshed(&self) -> bool;

    /// Returns the uncoupled symmetry classes that the force and the loads excite: consecutive blocks of the unknowns,
    /// the part that is symmetric about the diagonal ([`LinearBody::exchange`]), or the whole body.
    fn classes(&self) -> Vec<&dyn LinearBody>;

    /// Returns the map from the part that is symmetric about the diagonal to the whole body, if the body has this
    /// symmetry.
    fn exchange(&self) -> Option<&DiagonalSymmetry> {
        None
    }
}
