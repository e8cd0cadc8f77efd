//! What a basis needs of a linear body, whether one process has all of it ([`LocalBody`](super::LocalBody)) or PETSc ([`Body`](super::Body)).

use crate::contact::Patch;
use crate::error::Result;
use crate::material::Maxwell;

use super::columns::Columns;
use super::direct::Precision;
use super::shift::Solver;
use super::{Exchange, FoundationPoints, InfinitePlate};

/// One of a body's symmetric operators.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    /// M, kg.
    Mass,
    /// K of the elastic body alone, N/m: of relaxing parts what is left after all relaxation.
    Elastic,
    /// K of the elastic supports (11), N/m.
    Support,
    /// C of the dampers (13), N s/m.
    Damping,
    /// D of the relaxation of this number, m ([`LinearBody::chains`]).
    Distortion(usize),
}

/// Vectors of a body, this rank's rows of them, and its numbers.
pub struct Properties {
    /// None, laid out as the body's vectors.
    pub layout: Columns,
    /// Rows of the held unknowns.
    pub held: Vec<usize>,
    /// u at rest, where the motion starts there.
    pub equilibrium: Option<Vec<f64>>,
    /// Forces, N, by which unilateral foundations push.
    pub pushed: Vec<Vec<f64>>,
    /// Body force and tractions, N.
    pub load: Vec<f64>,
    /// ∫ k ū·v dS of the elastic supports, N.
    pub support_load: Vec<f64>,
    /// ½ ∫ k ū·ū dS of the elastic supports, J.
    pub support_offset: f64,
    /// a, the contact's force of 1 N.
    pub force: Vec<f64>,
    /// c_l of the contact law, m/N.
    pub compliance: f64,
    /// The patch, where there is one.
    pub patch: Option<Patch>,
    /// The body moved as a whole by one in the impactor's direction.
    pub translation: Vec<f64>,
    /// Whether nothing resists that.
    pub is_free: bool,
    /// As of [`System::hit_stress`](super::System::hit_stress).
    pub hit_stress: Vec<Vec<f64>>,
    /// As of [`System::hit_local`](super::System::hit_local).
    pub hit_local: [f64; 3],
    /// How many such bodies make the whole.
    pub copies: f64,
}

/// A linear body: ranks that share it call each of these together.
pub trait LinearBody {
    /// Unknowns on all ranks.
    fn unknowns(&self) -> usize;

    /// Its vectors and numbers.
    ///
    /// # Errors
    /// PETSc's.
    fn properties(&self) -> Result<Properties>;

    /// Whether it has an operator.
    fn has(&self, operator: Operator) -> bool;

    /// An operator's products with vectors; zero where it has none.
    ///
    /// # Errors
    /// PETSc's.
    fn apply(&self, operator: Operator, vectors: &Columns) -> Result<Columns>;

    /// Solves with S(s) = K + G̃(s) D + s C + s² M of a rate (1/s), without the held unknowns.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] where the matrix is not positive definite; PETSc's.
    fn solver(&self, rate: f64, precision: Precision) -> Result<Solver>;

    /// The chain of each relaxation.
    fn chains(&self) -> Vec<&Maxwell>;

    /// Of a plate, what an infinite one does.
    fn infinite_plate(&self) -> Option<&InfinitePlate>;

    /// Whether unilateral foundations bear it, whose springs are among its supports.
    fn is_on_foundations(&self) -> bool;

    /// The points of unilateral foundations on a basis.
    ///
    /// # Errors
    /// PETSc's.
    fn foundation(&self, basis: &Columns) -> Result<Option<FoundationPoints>>;

    /// Whether a mesh has its unknowns: vectors take long each then.
    fn is_meshed(&self) -> bool;

    /// The uncoupled symmetry classes that the force and the loads excite: consecutive blocks of its unknowns, the part that is symmetric about the
    /// diagonal ([`LinearBody::exchange`]), or the whole body.
    fn classes(&self) -> Vec<&dyn LinearBody>;

    /// What maps the part that is symmetric about the diagonal to the whole body, if the body has that symmetry.
    fn exchange(&self) -> Option<&Exchange> {
        None
    }
}

/// The part of a body whose motions are all that the force and the loads excite: its one class, or the whole.
pub fn excited(body: &dyn LinearBody) -> &dyn LinearBody {
    match body.classes()[..] {
        [one] => one,
        _ => body,
    }
}
