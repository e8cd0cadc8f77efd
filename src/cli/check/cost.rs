//! What a run's steps cost.

use petsc_wrap::{FactorEstimate, Int, estimate_cholesky};

use crate::body::Body;
use crate::error::Result;
use crate::impact::{Method, Plan};
use crate::scene::Scene;
use crate::scheme::Implicit;
use crate::solve::Method as Solution;

/// How the systems of a step are solved, and what that takes.
enum Linear {
    /// Not at all.
    None,
    /// By a factor, of which MUMPS alone tells what it will take.
    Cholesky(Option<FactorEstimate>),
    /// By iterations with multigrid.
    Multigrid,
    /// By iterations with an incomplete factor.
    Incomplete,
}

/// Memory of S with its multigrid while that is set up, over that of S, on one rank and on several; as measured on 3e5 and 1e6 unknowns.
const OF_MULTIGRID: [f64; 2] = [1.8, 2.9];

/// The same of S with one triangle of it and its incomplete factor.
const OF_INCOMPLETE: f64 = 2.2;

/// Memory for the fields of a whole body, a node of the modelled quarter, bytes: measured. Of it most is what recovers the stresses there.
const OF_FIELDS: f64 = 4.5e3;

/// Memory of an entry of a matrix: its value and its column, bytes.
const ENTRY: f64 = (size_of::<f64>() + size_of::<Int>()) as f64;

/// What a run's steps take.
pub(super) struct Cost {
    /// How a step is solved.
    pub solver: String,
    /// Memory, in words.
    pub memory: Option<String>,
    /// Memory of fields, bytes.
    pub fields: Option<f64>,
}

impl Cost {
    /// Of modal coordinates.
    pub fn modal() -> Self {
        let solver = "modal coordinates: two scalar equations per step".to_owned();
        Self { solver, memory: None, fields: None }
    }

    /// Of a body's steps. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn of_steps(scene: &Scene, body: &mut Body, plan: &Plan) -> Result<Self> {
        // Asks all ranks where there are pads.
        let method = Method::of(scene.solver.newton, body);
        let is_iterative = matches!(body.method, Solution::Multigrid { .. }) && method != Method::Full;
        let linear = match Implicit::new(scene.time.scheme) {
            Some(scheme) if is_iterative => match body.step_method(scheme.stage(plan.step()).c2)? {
                Solution::Incomplete { .. } => Linear::Incomplete,
                _ => Linear::Multigrid,
            },
            Some(scheme) => {
                let stage = scheme.stage(plan.step());
                Linear::Cholesky(estimate_cholesky(&body.operator(stage.c1, stage.c2)?)?)
            }
            None => Linear::None,
        };
        let entries = body.elastic.entries()?;
        let boundary: u64 =
            body.support.iter().chain(&body.damping).map(|m| m.entries()).sum::<petsc_wrap::Result<_>>()?;
        let fields = scene.output.fields.is_some().then(|| OF_FIELDS * body.unknowns() as f64 / 3.0);
        let (solver, memory) = words(body, &method, plan, (entries as f64, boundary as f64), linear);
        Ok(Self { solver, memory: Some(memory), fields })
    }
}

/// The solver and its memory.
fn words(
    body: &Body,
    method: &Method,
    plan: &Plan,
    (entries, boundary): (f64, f64),
    linear: Linear,
) -> (String, String) {
    // Those of one motion, or of two with what is kept to go back to.
    let vectors = if matches!(plan, Plan::Equal { .. }) { 30.0 } else { 100.0 } * 8.0 * body.unknowns() as f64;
    // For products: one triangle of K, and M by node.
    let products = 0.6 * entries;
    // K, M and S; in the full method also Ŝ and the Newton matrix; three dense ones for pads.
    let (name, matrices, dense) = match method {
        Method::Condensed => ("condensed Newton: one solve and a scalar equation a step".to_owned(), 3.0, 0.0),
        Method::CondensedOnPads(pushed) => {
            let n = pushed.len();
            (
                format!("condensed Newton: two solves and {n} equations of the pads a step"),
                3.0,
                24.0 * (n as f64).powi(2),
            )
        }
        Method::Full => ("full Newton (SNES) with the block aaᵀ".to_owned(), 5.0, 0.0),
    };
    let factor = match linear {
        Linear::Cholesky(factor) => factor,
        Linear::None => {
            let matrices = ENTRY * (2.0 * entries + products + boundary) + vectors;
            return (
                "none: every unknown by itself".to_owned(),
                format!("about {:.0} MB over all ranks", 1e-6 * matrices),
            );
        }
        Linear::Multigrid | Linear::Incomplete => {
            let sizes = if matches!(plan, Plan::Equal { .. }) { 1.0 } else { 5.0 };
            let (of_solver, preconditioner) = match linear {
                Linear::Incomplete => (OF_INCOMPLETE, "incomplete factors"),
                _ => (OF_MULTIGRID[usize::from(body.comm().size() > 1)], "multigrid (GAMG)"),
            };
            let operators = sizes * of_solver * entries;
            let matrices = ENTRY * (2.0 * entries + products + boundary + operators) + sizes * dense + vectors;
            let solver = format!(
                "{name}; conjugate gradients with {preconditioner}, since a factor would take more: {entries:.2e} entries in K"
            );
            return (solver, format!("about {:.0} MB over all ranks", 1e-6 * matrices));
        }
    };
    // In chosen steps those in contact, those of the error estimate, and the larger ones out of contact.
    let (factors, note) = match plan {
        Plan::Equal { .. } => (1.0, ""),
        Plan::Controlled { .. } => (5.0, ", in up to five step sizes"),
    };
    let matrices = ENTRY * ((2.0 + factors * (matrices - 2.0)) * entries + boundary) + factors * dense + vectors;
    let Some(factor) = factor else {
        let memory = format!(
            "about {:.0} MB for matrices, over all ranks, and the factorisations, of which MUMPS would tell: this PETSc is without it",
            1e-6 * matrices
        );
        return (format!("{name}; Cholesky{note}: {entries:.2e} entries in K"), memory);
    };
    let solver = format!(
        "{name}; Cholesky{note}: {entries:.2e} entries in K, {:.2e} in a factor, {:.2e} operations",
        factor.entries, factor.operations
    );
    let factors = factors * factor.memory;
    let memory = format!(
        "about {:.0} MB: matrices {:.0} MB, factorisations {:.0} MB, over all ranks",
        1e-6 * (matrices + factors),
        1e-6 * matrices,
        1e-6 * factors
    );
    (solver, memory)
}
