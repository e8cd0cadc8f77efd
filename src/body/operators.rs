//! A linear body with its pads, as PETSc operators for time stepping, factorisation and model reduction.

use petsc_wrap::{Comm, Int, Ksp, Matrix, NullSpace, Vector};

use crate::error::Result;
use crate::solve::linear::{Method, solver, solver_of_nodes};

use super::{BodyTerms, Clamps, Lumped, Pads, Relaxation, Unilateral};

/// Relative residual at which an iterative solution with M stops.
const MASS_SOLVE_TOLERANCE: f64 = 1e-12;

/// Assembled body of M ü + C u̇ + K u + p(u) = a F + f, stored in PETSc matrices and vectors.
///
/// The matrices have rows for all unknowns, constrained ones included; [`Clamps`] lists the constrained unknowns.
pub struct Body {
    /// Mass matrix M, kg.
    pub mass: Matrix,
    /// Operators, loads, contact port and readings.
    pub terms: BodyTerms<Matrix, Vector>,
    /// The nonzero entries of the contact force vector a by ascending global index, the same on all ranks.
    pub contact_entries: Vec<(Int, f64)>,
    /// Copies of M and K that need less memory traffic in products: stored by node, or as an upper triangle. If `None`,
    /// the matrices themselves are used.
    pub(crate) products: Option<[Matrix; 2]>,
    /// Diagonal replacements of M and C, if the time integration is explicit.
    pub lumped: Option<Lumped>,
    /// One-sided foundation pads (12).
    pub pads: Option<Pads>,
    /// Pads of a body that is to be reduced; their springs are part of K ([`Body::take_pads_as_springs`]).
    pub unilateral: Option<Unilateral>,
    /// Constrained unknowns (2).
    pub clamps: Clamps,
    /// Static displacement u under loads, supports and pads, if the motion starts from equilibrium.
    pub equilibrium: Option<Vector>,
    /// Solution method for systems with the body's operators.
    pub method: Method,
    /// Rigid-body motions, the near null space for multigrid. Present if the body has enough unknowns for multigrid.
    pub(crate) rigid_motions: Option<NullSpace>,
    /// Pseudo-random numbers similar to independent normal deviates, equal on any number of ranks. Start vector of
    /// iterations.
    pub deviates: Vector,
    /// Positions of this rank's nodes (m), three unknowns each. `None` for a body without a mesh, which every rank
    /// stores completely.
    pub nodes: Option<Vec<[f64; 3]>>,
    /// Uncoupled symmetry classes of motions as separate bodies, each a consecutive block of the unknowns. Empty if
    /// there is only one class.
    pub classes: Vec<Body>,
}

impl Body {
    /// Communicator of the ranks that share the body.
    pub fn comm(&self) -> &Comm {
        self.mass.comm()
    }

    /// Number of unknowns on all ranks.
    pub fn unknowns(&self) -> usize {
        self.terms.load.len()
    }

    /// Returns a solver for an operator of the body ([`Self::operator`]). Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn solver(&self, operator: &Matrix) -> Result<Ksp> {
        Ok(solver(self.comm(), "", operator, self.method)?)
    }

    /// Returns a solver of S ([`Self::operator_of_step`]) for many time steps of length `step` (s), with the method of
    /// [`Self::step_method`]. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn step_solver(&self, step: f64, c1: f64, c2: f64) -> Result<Ksp> {
        let operator = self.operator_of_step(step, c1, c2)?;
        let (method, places) = (self.step_method(c2)?, self.nodes.as_deref());
        let ksp = solver_of_nodes(self.comm(), "", &operator, method, places)?;
        // The solver keeps its own reference to the operator.
        operator.destroy()?;
        Ok(ksp)
    }

    /// Returns the solution method for the systems of a time step: the method of the body, except that incomplete
    /// factors replace multigrid unless the stiffness is much larger than the mass term. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn step_method(&self, c2: f64) -> Result<Method> {
        match self.method {
            Method::Multigrid { .. } => {
                Ok(self.method.for_stiffness(self.terms.elastic.trace()? / (c2 * self.mass.trace()?)))
            }
            method => Ok(method),
        }
    }

    /// Returns M without the constrained unknowns, and a solver for it. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn mass_solver(&self) -> Result<(Matrix, Ksp)> {
        let mut mass = self.mass.duplicate()?;
        mass.zero_rows_columns(&self.clamps.rows, 1.0)?;
        mass.declare_positive_definite()?;
        let method = match self.method {
            Method::Multigrid { .. } | Method::Incomplete { .. } => {
                Method::Diagonal { tolerance: MASS_SOLVE_TOLERANCE }
            }
            method => method,
        };
        let solver = solver(self.comm(), "mass_", &mass, method)?;
        Ok((mass, solver))
    }

    /// Whether no support, pad or clamp resists a rigid translation along the impactor's direction. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn is_free(&self) -> Result<bool> {
        Ok(self.terms.support.is_none() && self.pads.is_none() && !self.is_translation_held()?)
    }

    /// Whether clamps prevent this translation. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn is_translation_held(&self) -> Result<bool> {
        let mut held = self.terms.translation.duplicate()?;
        held.copy_from(&self.terms.translation)?;
        self.clamps.zero(&mut held)?;
        held.axpy(-1.0, &self.terms.translation)?;
        Ok(held.norm_max()? != 0.0)
    }

    /// Computes out ← M v, with the lumped M if the time integration is explicit. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn apply_mass(&self, v: &Vector, out: &mut Vector) -> Result<()> {
        match &self.lumped {
            Some(lumped) => {
                out.copy_from(v)?;
                out.pointwise_mult(&lumped.mass)?;
            }
            None => self.products.as_ref().map_or(&self.mass, |[mass, _]| mass).mult(v, out)?,
        }
        Ok(())
    }

    /// Computes out ← K u of the elastic body alone. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn apply_elastic(&self, u: &Vector, out: &mut Vector) -> Result<()> {
        Ok(self.products.as_ref().map_or(&self.terms.elastic, |[_, elastic]| elastic).mult(u, out)?)
    }

    /// Computes out ← C v, with the lumped C if the time integration is explicit. Leaves `out` unchanged without
    /// dampers. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn apply_damping(&self, v: &Vector, out: &mut Vector) -> Result<()> {
        match (&self.lumped, &self.terms.damping) {
            (Some(Lumped { damping: Some(diagonal), .. }), _) => {
                out.copy_from(v)?;
                out.pointwise_mult(diagonal)?;
            }
            (_, Some(matrix)) => matrix.mult(v, out)?,
            _ => {}
        }
        Ok(())
    }

    /// Assembles S = K + c1 C + c2 M with the elastic supports, without the pads. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn combination(&self, c1: f64, c2: f64) -> Result<Matrix> {
        let mut sum = self.terms.elastic.duplicate()?;
        sum.axpy(c2, &self.mass)?;
        if let Some(support) = &self.terms.support {
            sum.axpy(1.0, support)?;
        }
        if let Some(damping) = &self.terms.damping {
            sum.axpy(c1, damping)?;
        }
        Ok(sum)
    }

    /// Assembles [`Self::combination`] without the constrained unknowns, ready for direct or iterative solvers.
    /// Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn operator(&self, c1: f64, c2: f64) -> Result<Matrix> {
        self.without_held(self.combination(c1, c2)?)
    }

    /// Assembles [`Self::operator`] for a time step of length `step` (s). Viscoelastic parts have their effective
    /// stiffness for strains that vary linearly over the step. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn operator_of_step(&self, step: f64, c1: f64, c2: f64) -> Result<Matrix> {
        let mut matrix = self.combination(c1, c2)?;
        for relaxation in &self.terms.relaxations {
            matrix.axpy(relaxation.stiffness(step), &relaxation.distortion)?;
        }
        self.without_held(matrix)
    }

    /// Assembles K + c2 M plus the tangent of the pads, without the constrained unknowns. The tangent is taken at u, or
    /// with all pads pressed if `u` is `None`. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn operator_on_pads(&mut self, c2: f64, u: Option<&Vector>) -> Result<Matrix> {
        let mut matrix = self.combination(0.0, c2)?;
        match (&mut self.pads, u) {
            (Some(pads), Some(u)) => pads.add_tangent(None, u, 1.0, &mut matrix)?,
            (Some(pads), None) => {
                let mut idle = self.terms.load.duplicate()?;
                pads.add_springs(&mut matrix, &mut idle)?;
            }
            (None, _) => {}
        }
        matrix.assemble()?;
        self.without_held(matrix)
    }

    pub(super) fn without_held(&self, mut matrix: Matrix) -> Result<Matrix> {
        let typical = matrix.trace()? / self.unknowns() as f64;
        matrix.zero_rows_columns(&self.clamps.rows, typical)?;
        matrix.declare_positive_definite()?;
        if let Some(motions) = &self.rigid_motions {
            matrix.set_near_null_space(motions)?;
        }
        Ok(matrix)
    }

    /// Assembles S(s) = K + G̃(s) D + s C + s² M without the constrained unknowns: the operator of the
    /// Laplace-transformed motion at a shift s (1/s). Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn operator_at_rate(&self, rate: f64) -> Result<Matrix> {
        let mut matrix = self.combination(rate, rate * rate)?;
        for Relaxation { distortion, chain } in &self.terms.relaxations {
            matrix.axpy(chain.transformed_terms(rate), distortion)?;
        }
        self.without_held(matrix)
    }
}
