//! How a member of a sweep is computed.

use std::ops::ControlFlow;
use std::rc::Rc;

use petsc_wrap::Comm;

use crate::body::Solid;
use crate::error::Result;
use crate::impact::Impact;
use crate::impact::step::Step;
use crate::mesh::Mesh;
use crate::scene::Scene;

/// What a simulation knows beside its steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outcome {
    /// Estimated error of the acceleration history over its peak; NaN where there is no estimate.
    pub error_estimate: f64,
    /// Number of unknowns, the impactor's included.
    pub unknowns: usize,
}

/// Computes the impact of a scene to its end, and gives each accepted step to `observe`. `interrupted` is asked now and then
/// whether to leave off, and keeps to its answer; then the outcome is `None`. Collective on `comm`.
///
/// # Errors
/// Those of a run: a fault of the scene, a step that is not solved, the energy gate, PETSc's.
pub fn simulate(
    comm: &Comm,
    scene: &Scene,
    interrupted: Rc<dyn Fn() -> bool>,
    mut observe: impl FnMut(&Step),
) -> Result<Option<Outcome>> {
    let mesh = Mesh::new(comm, &scene.body)?;
    let body = Solid::new(scene, &mesh)?;
    let mut impact = Impact::new(&mesh, scene, body)?;
    drop(mesh);
    let asked = interrupted.clone();
    impact.set_interrupt(move || asked());
    let flow = impact.run(|step| {
        observe(step);
        Ok(if interrupted() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    })?;
    let patch_error = impact.body().localization.patch.map_or(0.0, |patch| patch.error());
    let outcome = Outcome {
        error_estimate: impact.count.error.map_or(f64::NAN, |error| error + patch_error),
        unknowns: impact.body().unknowns() + 1,
    };
    Ok(flow.is_continue().then_some(outcome))
}
