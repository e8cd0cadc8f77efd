//! A linear body with its pads, as operators that any scheme can apply and solve with.

use petsc_wrap::{Comm, Ksp, Matrix, NullSpace, Vector};

use crate::contact::Localization;
use crate::error::Result;
use crate::solve::linear::{Method, solver, solver_of_nodes};

use super::{Clamps, InfinitePlate, Lumped, Pads, Relaxation, Unilateral};

/// Relative residual of an iterative solution with M.
const OF_MASS: f64 = 1e-12;

/// The body's side of M ü + C u̇ + K u + p(u) = a F + f, as PETSc holds it.
///
/// Matrices are those of all unknowns, held ones included; [`Clamps`] says which of them move.
pub struct Body {
    /// M, kg.
    pub mass: Matrix,
    /// K of the elastic body alone, N/m: of relaxing parts what is left after all relaxation.
    pub elastic: Matrix,
    /// What relaxes beside that.
    pub relaxations: Vec<Relaxation>,
    /// M and K for products, with less memory traffic than the matrices themselves, which serve where there are none: entries by node,
    /// or an upper triangle.
    pub(crate) products: Option<[Matrix; 2]>,
    /// K of the elastic supports (11), N/m.
    pub support: Option<Matrix>,
    /// C of the dampers (13), N s/m.
    pub damping: Option<Matrix>,
    /// Diagonals in the places of M and C, where the scheme is explicit.
    pub lumped: Option<Lumped>,
    /// Pads (12).
    pub pads: Option<Pads>,
    /// The pads of a body that is to be reduced, whose springs are in K ([`Body::take_pads_as_springs`]).
    pub unilateral: Option<Unilateral>,
    /// Held unknowns (2).
    pub clamps: Clamps,
    /// u at rest under loads, supports and pads, where the motion starts there.
    pub equilibrium: Option<Vector>,
    /// Body force and tractions, N.
    pub load: Vector,
    /// ∫ k ū·v dS of the elastic supports, N.
    pub support_load: Vector,
    /// ½ ∫ k ū·ū dS of the elastic supports, J.
    pub support_offset: f64,
    /// Where the impactor hits.
    pub localization: Localization,
    /// How systems of its operators are solved.
    pub method: Method,
    /// The rigid motions, which multigrid needs to know of, where there are unknowns enough for that.
    pub(crate) rigid_motions: Option<NullSpace>,
    /// As of [`System::hit_stress`](super::System::hit_stress).
    pub hit_stress: Vec<Vector>,
    /// As of [`System::hit_local`](super::System::hit_local).
    pub hit_local: [f64; 3],
    /// The body moved as a whole by one in the impactor's direction.
    pub translation: Vector,
    /// As of [`System::infinite_plate`](super::System::infinite_plate).
    pub infinite_plate: Option<InfinitePlate>,
    /// Numbers that look like independent normal deviates, the same on any number of ranks: where iterations start.
    pub deviates: Vector,
    /// Where this rank's nodes lie (m), three unknowns each; `None` for a body of numbers, of which every rank has all.
    pub nodes: Option<Vec<[f64; 3]>>,
    /// How many such bodies make the whole: 1, or 4 for a quarter of a symmetric box.
    pub copies: f64,
    /// The body's classes of motions, each by itself: blocks of its unknowns, one after the other. None where there is one.
    pub classes: Vec<Body>,
}

impl Body {
    /// The ranks that share it.
    pub fn comm(&self) -> &Comm {
        self.mass.comm()
    }

    /// Unknowns on all ranks.
    pub fn unknowns(&self) -> usize {
        self.load.len()
    }

    /// A solver of an operator of the body ([`Self::operator`]). Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn solver(&self, operator: &Matrix) -> Result<Ksp> {
        Ok(solver(self.comm(), "", operator, self.method)?)
    }

    /// A solver of S ([`Self::operator_of_step`]) for many steps of a length (s), by the method that suits it ([`Self::step_method`]). Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn step_solver(&self, step: f64, c1: f64, c2: f64) -> Result<Ksp> {
        let operator = self.operator_of_step(step, c1, c2)?;
        let (method, places) = (self.step_method(c2)?, self.nodes.as_deref());
        let ksp = solver_of_nodes(self.comm(), "", &operator, method, places)?;
        // The solver has what it needs of it.
        operator.destroy()?;
        Ok(ksp)
    }

    /// How the systems of a step are solved: as all, but by incomplete factors in the place of multigrid where the stiffness does
    /// not outweigh the mass by far. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn step_method(&self, c2: f64) -> Result<Method> {
        match self.method {
            Method::Multigrid { .. } => {
                Ok(self.method.for_stiffness(self.elastic.trace()? / (c2 * self.mass.trace()?)))
            }
            method => Ok(method),
        }
    }

    /// M with the held unknowns taken out, and its solver. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn mass_solver(&self) -> Result<(Matrix, Ksp)> {
        let mut mass = self.mass.duplicate()?;
        mass.zero_rows_columns(&self.clamps.rows, 1.0)?;
        mass.declare_positive_definite()?;
        let method = match self.method {
            Method::Multigrid { .. } | Method::Incomplete { .. } => Method::Diagonal { tolerance: OF_MASS },
            method => method,
        };
        let solver = solver(self.comm(), "mass_", &mass, method)?;
        Ok((mass, solver))
    }

    /// Whether nothing resists a translation along the impactor's direction. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn is_free(&self) -> Result<bool> {
        Ok(self.support.is_none() && self.pads.is_none() && !self.is_translation_held()?)
    }

    /// Whether clamps hold that translation. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn is_translation_held(&self) -> Result<bool> {
        let mut held = self.translation.duplicate()?;
        held.copy_from(&self.translation)?;
        self.clamps.zero(&mut held)?;
        held.axpy(-1.0, &self.translation)?;
        Ok(held.norm_max()? != 0.0)
    }

    /// out ← M v, with the lumped M where the scheme is explicit. Collective.
    ///
    /// # Errors
    /// PETSc's.
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

    /// out ← K u of the body alone. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn apply_elastic(&self, u: &Vector, out: &mut Vector) -> Result<()> {
        Ok(self.products.as_ref().map_or(&self.elastic, |[_, elastic]| elastic).mult(u, out)?)
    }

    /// out ← C v, with the lumped C where the scheme is explicit; nothing without dampers. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn apply_damping(&self, v: &Vector, out: &mut Vector) -> Result<()> {
        match (&self.lumped, &self.damping) {
            (Some(Lumped { damping: Some(diagonal), .. }), _) => {
                out.copy_from(v)?;
                out.pointwise_mult(diagonal)?;
            }
            (_, Some(matrix)) => matrix.mult(v, out)?,
            _ => {}
        }
        Ok(())
    }

    /// S = K + c1 C + c2 M, pads left out. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn combination(&self, c1: f64, c2: f64) -> Result<Matrix> {
        let mut sum = self.elastic.duplicate()?;
        sum.axpy(c2, &self.mass)?;
        if let Some(support) = &self.support {
            sum.axpy(1.0, support)?;
        }
        if let Some(damping) = &self.damping {
            sum.axpy(c1, damping)?;
        }
        Ok(sum)
    }

    /// [`Self::combination`] with the held unknowns taken out, to be solved with by direct or iterative methods. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn operator(&self, c1: f64, c2: f64) -> Result<Matrix> {
        self.without_held(self.combination(c1, c2)?)
    }

    /// [`Self::operator`] of a step of a length (s), in which relaxing parts are as stiff as strains that are linear over it find them.
    /// Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn operator_of_step(&self, step: f64, c1: f64, c2: f64) -> Result<Matrix> {
        let mut matrix = self.combination(c1, c2)?;
        for relaxation in &self.relaxations {
            matrix.axpy(relaxation.stiffness(step), &relaxation.distortion)?;
        }
        self.without_held(matrix)
    }

    /// K + c2 M with the pads' tangent at u, or that of pads pressed everywhere, and the held unknowns taken out. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn operator_on_pads(&mut self, c2: f64, u: Option<&Vector>) -> Result<Matrix> {
        let mut matrix = self.combination(0.0, c2)?;
        match (&mut self.pads, u) {
            (Some(pads), Some(u)) => pads.add_tangent(None, u, 1.0, &mut matrix)?,
            (Some(pads), None) => {
                let mut idle = self.load.duplicate()?;
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
}
