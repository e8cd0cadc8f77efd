//! Estimates the cost of the time steps of a run.

use petsc_wrap::{FactorEstimate, Int, estimate_cholesky};

use crate::body::Body;
use crate::error::Result;
use crate::impact::{Method, Plan};
use crate::scene::Scene;
use crate::scheme::Implicit;
use crate::solve::Method as Solution;

/// Solution of the linear systems of a step, and its cost.
enum Linear {
    /// No linear systems.
    None,
    /// By a Cholesky factorisation. Its cost is known only with MUMPS.
    Cholesky(Option<FactorEstimate>),
    /// By conjugate gradients with multigrid.
    Multigrid,
    /// By conjugate gradients with an incomplete factorisation.
    Incomplete,
}

/// Peak memory for S and its multigrid over the memory of S, on one rank and on several. Measured with 3e5 and 1e6
/// unknowns.
const MULTIGRID_MEMORY_FACTOR: [f64; 2] = [1.8, 2.9];

/// Same for S with one of its triangles and its incomplete factor.
const INCOMPLETE_MEMORY_FACTOR: f64 = 2.2;

/// Memory for the fields of a whole body per node of the modelled quarter, bytes. Measured; most of it is used to
/// recover stresses.
const FIELD_BYTES_PER_NODE: f64 = 4.5e3;

/// Memory per matrix entry, for its value and its column index, bytes.
const ENTRY: f64 = (size_of::<f64>() + size_of::<Int>()) as f64;

/// Cost of the time steps of a run.
pub(super) struct Cost {
    /// Description of the solver of a step.
    pub solver: String,
    /// Description of the required memory.
    pub memory: Option<String>,
    /// Memory for fields, bytes.
    pub fields: Option<f64>,
}

impl Cost {
    /// Cost with modal coordinates.
    pub fn modal() -> Self {
        let solver = "modal coordinates: two scalar equations per step".to_owned();
        Self { solver, memory: None, fields: None }
    }

    /// Cost of the time steps of a body. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn of_steps(scene: &Scene, body: &mut Body, plan: &Plan) -> Result<Self> {
        // Queries all ranks if there are pads.
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
        let entries = body.terms.elastic.entries()?;
        let boundary: u64 =
            body.terms.support.iter().chain(&body.terms.damping).map(|m| m.entries()).sum::<petsc_wrap::Result<_>>()?;
        let fields = scene.output.fields.is_some().then(|| FIELD_BYTES_PER_NODE * body.unknowns() as f64 / 3.0);
        let (solver, memory) = words(body, &method, plan, (entries as f64, boundary as f64), linear);
        Ok(Self { solver, memory: Some(memory), fields })
    }
}

/// Descriptions of the solver and of its memory.
fn words(
    body: &Body,
    method: &Method,
    plan: &Plan,
    (entries, boundary): (f64, f64),
    linear: Linear,
) -> (String, String) {
    // With controlled steps there are matrices for steps in contact, for the error estimate, and for the larger steps out of
    // contact; and the vectors of two motions and their saved states.
    let (sizes, note, vectors) = match plan {
        Plan::Equal { .. } => (1.0, "", 30.0),
        Plan::Controlled { .. } => (5.0, ", in up to five step sizes", 100.0),
    };
    // For products: one triangle of K, and M by nodes.
    let products = 0.6 * entries;
    // K, M and S; in the full method also Ŝ and the Newton matrix; three dense matrices for pads.
    let (name, matrices, dense) = match method {
        Method::Condensed => ("condensed Newton: one solve and a scalar equation a step".to_owned(), 3.0, 0.0),
        Method::CondensedOnPads(pushed) => {
            let n = pushed.len();
            let name = format!("condensed Newton: two solves and {n} equations of the pads a step");
            (name, 3.0, 24.0 * (n as f64).powi(2))
        }
        Method::Full => ("full Newton (SNES) with the block aaᵀ".to_owned(), 5.0, 0.0),
    };
    let megabytes = |bytes: f64| format!("{:.0} MB", 1e-6 * bytes);
    let stored =
        |entries: f64, dense: f64| ENTRY * (entries + boundary) + dense + 8.0 * vectors * body.unknowns() as f64;
    let iterative = |factor: f64, preconditioner: &str| {
        let all = stored(2.0 * entries + products + sizes * factor * entries, sizes * dense);
        let solver = format!(
            "{name}; conjugate gradients with {preconditioner}, since a factor would take more: {entries:.2e} entries in K"
        );
        (solver, format!("about {} over all ranks", megabytes(all)))
    };
    let of_factors = stored((2.0 + sizes * (matrices - 2.0)) * entries, sizes * dense);
    match linear {
        Linear::None => {
            let all = megabytes(stored(2.0 * entries + products, 0.0));
            ("none: every unknown by itself".to_owned(), format!("about {all} over all ranks"))
        }
        Linear::Multigrid => {
            iterative(MULTIGRID_MEMORY_FACTOR[usize::from(body.comm().size() > 1)], "multigrid (GAMG)")
        }
        Linear::Incomplete => iterative(INCOMPLETE_MEMORY_FACTOR, "incomplete factors"),
        Linear::Cholesky(None) => (
            format!("{name}; Cholesky{note}: {entries:.2e} entries in K"),
            format!(
                "about {} for matrices, over all ranks, and the factorisations, of which MUMPS would tell: this PETSc is without it",
                megabytes(of_factors)
            ),
        ),
        Linear::Cholesky(Some(factor)) => {
            let solver = format!(
                "{name}; Cholesky{note}: {entries:.2e} entries in K, {:.2e} in a factor, {:.2e} operations",
                factor.entries, factor.operations
            );
            let factors = sizes * factor.memory;
            let [all, matrices, factors] = [of_factors + factors, of_factors, factors].map(megabytes);
            (solver, format!("about {all}: matrices {matrices}, factorisations {factors}, over all ranks"))
        }
    }
}
