//! Chooses spline cells as fine as a scene needs, and estimates their discretisation error.
//!
//! The cell size that a tolerance requires depends on the contact time and on the waves reflected at the edges. It is
//! known only by a rule of thumb. The force is therefore also computed on coarser cells, or on finer ones if there are
//! few, with a basis of the same size.

use serde::{Deserialize, Serialize};

use super::cell_error::{Judge, are_few, finer_size, is_unreliable};
use super::context::ModelContext;
use super::judgement::cost;
use super::local_field_error::{local_field_errors, of_hit};
use super::reduce::{BASIS_SHARE, Plan, Reduced, grow, reduce_from};
use super::theory::{Built, Operators, build, cells_of_grid};
use super::trials::{Trial, Trials};
use super::watch::{Stage, Watch};
use crate::body::{DirectSum, ModalBody};
use crate::error::{Error, Result};
use crate::impact::{Errors, ModalImpact, TIME_STEP_SHARE, Trace, joined, rest};
use crate::mesh::Measures;
use crate::scene::{Measure, Model, Scene};
use crate::space::evaluate::{Evaluator, TensionErrors};
use crate::space::parts::parts;
use crate::space::{RUNG, rung_below};

/// Size of the coarser cells relative to the others; and least and largest size of finer cells relative to the present
/// ones.
pub(super) const COARSER_CELL_FACTOR: f64 = 1.5;
const FINER_CELL_FACTORS: [f64; 2] = [1.0 / COARSER_CELL_FACTOR, RUNG];

/// Order of convergence that is not exceeded. Cells of a size between the present and the next one would not be fine enough
/// even with this order, so that a smaller tolerance never takes fewer cells.
const LARGEST_ORDER: f64 = 6.0;

/// Share of the tolerance for the estimated discretisation error. It may be more if steps, basis and theory need less.
pub(super) const CELL_SHARE: f64 = 0.6;

/// Smallest cell size, relative to the rule of thumb.
pub(super) const SMALLEST_CELL_FACTOR: f64 = 0.25;

/// A reduced body with its cells.
pub struct Fitted {
    /// The body reduced to its basis.
    pub reduced: Reduced,
    /// Number of unknowns before reduction.
    pub unknowns: usize,
    /// Number of cells, as in [`Operators::cells`].
    pub cells: Option<[usize; 3]>,
    /// Description of the unknowns, for results.
    pub discretisation: String,
    /// Cell size relative to the rule of thumb.
    pub size: f64,
    /// Estimated discretisation error, if it was estimated.
    pub error: Option<Errors>,
    /// Reads stresses and displacements of the body, as [`Operators::evaluator`].
    pub evaluator: Option<Evaluator>,
    /// Measures of a mesh file, as in [`Operators::measures`].
    pub measures: Option<Measures>,
}

/// Cells that are fine enough for a scene.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CellSize {
    /// Cell size relative to the rule of thumb.
    pub size: f64,
    /// Estimated errors of discretisation and averaging.
    pub error: Errors,
    /// Estimated errors of the local field.
    pub local_field: Errors,
}

/// Largest number of basis vectors on which cells are compared. The errors of bases with the same number of vectors are
/// similar, and cancel in the difference. If short waves are treated separately, the smaller basis of the two is used:
/// coarser cells carry no more waves, and with all vectors the difference was ten times the error.
const MAX_COMPARED_VECTORS: usize = 800;

/// Largest value of unknowns times the square of the number of vectors for which cells are still refined. Such a basis
/// takes some five seconds, and one on finer cells at least as long. Beyond this value the remaining discretisation
/// error is reported with the results.
const LARGEST_REFINED_COST: f64 = 4e9;

impl Fitted {
    /// Number of basis vectors on which cells are compared.
    fn compared(&self) -> usize {
        match &self.reduced.projection.terms.infinite_plate {
            Some(_) => self.reduced.counts()[0],
            None => self.reduced.projection.vectors().min(MAX_COMPARED_VECTORS),
        }
    }

    /// The force on the basis, or on the first `vectors` vectors of a longer one.
    pub(super) fn on_short_basis(&self, scene: &Scene, vectors: usize) -> Result<Trace> {
        let Reduced { projection, judge, force_of_judge, force: (trace, steps), .. } = &self.reduced;
        if projection.vectors() <= vectors {
            return Ok(trace.clone());
        }
        if judge.vectors() == vectors {
            return Ok(force_of_judge.clone());
        }
        Ok(ModalImpact::new(scene, &ModalBody::of(&projection.leading(vectors))).trace(*steps)?.0)
    }
}

/// Reduces a body on its cells. A body of splines in modal coordinates is then refined until its discretisation error
/// is small enough. Collective.
///
/// # Errors
/// Same as [`reduce`](super::reduce::reduce) and [`build`].
pub fn fit(context: &ModelContext, scene: &Scene, theory: Model, built: Operators) -> Result<Fitted> {
    refine(context, scene, theory, unrefined(context, scene, built)?)
}

/// The cells on which `fit` reduces a body. Collective.
///
/// # Errors
/// Same as `fit`.
pub fn cell_size(context: &ModelContext, scene: &Scene, theory: Model, built: Operators) -> Result<CellSize> {
    let Fitted { size, error, evaluator, reduced, .. } =
        refined(context, scene, theory, unrefined(context, scene, built)?, of_other_bases(scene))?;
    let force = Some(&reduced.force.0);
    let error = error.map_or_else(Errors::default, |error| with_averaging(evaluator.as_ref(), force, error));
    let local_field = local_field_errors(scene, theory, evaluator.as_ref(), force);
    Ok(CellSize { size, error, local_field })
}

/// Reduces a body on its present cells. Collective.
///
/// # Errors
/// Same as [`reduce`](super::reduce::reduce).
pub fn unrefined(context: &ModelContext, scene: &Scene, built: Operators) -> Result<Fitted> {
    fitted(context, scene, built, (1.0, None))
}

/// Refines the cells of a spline body in modal coordinates until its discretisation error is small enough. Collective.
///
/// # Errors
/// Same as [`reduce`](super::reduce::reduce) and [`build`].
pub fn refine(context: &ModelContext, scene: &Scene, theory: Model, fine: Fitted) -> Result<Fitted> {
    refined(context, scene, theory, fine, Errors::default())
}

/// Same as [`refine`], with the errors of other bodies on the same cells.
fn refined(context: &ModelContext, scene: &Scene, theory: Model, mut fine: Fitted, others: Errors) -> Result<Fitted> {
    let Some(mut cells) = fine.cells.filter(|_| scene.time.modal) else { return Ok(fine) };
    let watch = context.watch;
    let mut judge = match judge_of(context, scene, theory, &fine) {
        Ok(judge) => judge,
        // On other cells the body may be too soft or too stiff for the contact law. The present cells are then compared
        // with finer ones.
        Err(Error::Solve(_)) => None,
        Err(error) => return Err(error),
    };
    loop {
        let mut finer = FINER_CELL_FACTORS[0];
        if let Some(judge) = &judge {
            let difference = watch.shared(fine.on_short_basis(scene, judge.vectors))?.difference(&judge.force);
            let error = judge.errors(cells, scene, theory, difference);
            let Errors { first_contact, history, stress, .. } = error;
            tracing::info!(size = fine.size, unknowns = fine.unknowns, first_contact, history, stress, "cells");
            fine.error = Some(error);
            let wanted = allowed(scene, fine.reduced.error.joined(others));
            let over = watch.agreed(error.of(scene.measure) / wanted);
            finer = rung_below(over.recip().powf(1.0 / LARGEST_ORDER)).clamp(RUNG * RUNG, RUNG);
            let is_last = context.keeps_cells || finer * fine.size < SMALLEST_CELL_FACTOR;
            let cost = cost(fine.unknowns, fine.reduced.projection.vectors());
            if over <= 1.0 || is_last || cost > LARGEST_REFINED_COST {
                return Ok(fine);
            }
        }
        let mut size = finer * fine.size;
        // Numbers of cells are integers: sizes that give the same numbers are skipped.
        while size >= SMALLEST_CELL_FACTOR && cells_of_grid(scene, theory, size) == Some(cells) {
            size *= FINER_CELL_FACTORS[1];
        }
        let built = loop {
            let built = match build(context, scene, theory, size) {
                Ok(Built::Operators(built)) => built,
                // The spline body would have too many unknowns. The remaining error is reported with the results.
                Ok(Built::Given(_)) | Err(Error::Fault(_)) => return Ok(fine),
                Err(error) => return Err(error),
            };
            if built.cells != Some(cells) || size < SMALLEST_CELL_FACTOR {
                break built;
            }
            size *= FINER_CELL_FACTORS[1];
        };
        let vectors = fine.compared();
        let force = watch.shared(fine.on_short_basis(scene, vectors))?;
        let coarser = Judge { force, vectors, cells };
        cells = built.cells.unwrap_or(cells);
        let vectors = fine.reduced.counts();
        fine = fitted(context, scene, built, (size, Some(vectors)))?;
        let is_few = is_unreliable(scene, theory, coarser.cells, cells) || has_parts(scene);
        judge = match finer_size_if(is_few, scene, theory, &fine, watch) {
            Some(size) => match on_cells_of(context, scene, theory, &fine, size) {
                Ok(judge) => judge.or(Some(coarser)),
                Err(Error::Solve(_)) => Some(coarser),
                Err(error) => return Err(error),
            },
            None => Some(coarser),
        };
    }
}

/// Largest error of the basis of another body on the same cells.
fn of_other_bases(scene: &Scene) -> Errors {
    Errors::throughout(BASIS_SHARE * scene.tolerance)
}

/// Largest allowed discretisation error: its share of the tolerance, or more if steps and the `others` need less, or less
/// if the `others` need more. For stresses only the share is allowed, because the local fields have an error too.
fn allowed(scene: &Scene, others: Errors) -> f64 {
    let own = CELL_SHARE * scene.tolerance;
    match scene.measure {
        Measure::Acceleration | Measure::Deflection => {
            own.max(rest(rest(1.0, TIME_STEP_SHARE) * scene.tolerance, others.of(scene.measure)))
        }
        Measure::Stress => own,
    }
}

/// Adds the error of averaging stresses over a disc to the discretisation error. The choice of the cell size ignores it.
pub(super) fn with_averaging(evaluator: Option<&Evaluator>, force: Option<&Trace>, error: Errors) -> Errors {
    let TensionErrors { of_cells, of_width, .. } = evaluator.map(Evaluator::tension_errors).unwrap_or_default();
    error.joined(of_hit(joined(of_cells, of_width), force))
}

/// Reduces a body to a basis. `size` is the size of its cells; `vectors` are numbers of vectors that were enough on
/// other cells.
pub(super) fn fitted(
    context: &ModelContext,
    scene: &Scene,
    built: Operators,
    (size, vectors): (f64, Option<[usize; 2]>),
) -> Result<Fitted> {
    let Operators { body, discretisation, evaluator, cells, measures } = built;
    let linear = body.linear();
    let (reduced, unknowns) = (reduce_from(context, linear, scene, vectors)?, linear.unknowns());
    let fitted = Fitted { reduced, unknowns, cells, discretisation, size, error: None, evaluator, measures };
    drop(body);
    context.comm.collect_garbage()?;
    Ok(fitted)
}

/// Whether parts of faces carry supports or loads. Lines on their edges make the numbers of cells no measure of their sizes,
/// by which a comparison with coarser cells is scaled; so such bodies are compared with finer cells.
fn has_parts(scene: &Scene) -> bool {
    !parts(scene).is_empty()
}

/// The force on coarser cells, or on finer ones if a comparison with coarser cells would be unreliable; `None` if there
/// are no other cells.
fn judge_of(context: &ModelContext, scene: &Scene, theory: Model, fitted: &Fitted) -> Result<Option<Judge>> {
    let coarser = cells_of_grid(scene, theory, COARSER_CELL_FACTOR * fitted.size);
    let is_few = fitted.cells.zip(coarser).is_some_and(|(cells, coarser)| match theory {
        Model::Solid => is_unreliable(scene, theory, coarser, cells) || has_parts(scene),
        _ => are_few(cells, coarser) || has_parts(scene),
    });
    let finer = finer_size_if(is_few, scene, theory, fitted, context.watch);
    on_cells_of(context, scene, theory, fitted, finer.unwrap_or(COARSER_CELL_FACTOR * fitted.size))
}

/// Size of finer cells for a comparison, if there are few cells. The same on all ranks. Collective.
fn finer_size_if(is_few: bool, scene: &Scene, theory: Model, fitted: &Fitted, watch: &dyn Watch) -> Option<f64> {
    let cells = fitted.cells.filter(|_| is_few);
    let size = cells.and_then(|cells| finer_size(scene, theory, cells, fitted.size));
    Some(watch.agreed(size.unwrap_or(f64::NAN))).filter(|size| !size.is_nan())
}

/// The force on cells of another size; `None` if they are the same cells.
fn on_cells_of(
    context: &ModelContext,
    scene: &Scene,
    theory: Model,
    fine: &Fitted,
    size: f64,
) -> Result<Option<Judge>> {
    let Built::Operators(built) = build(context, scene, theory, size)? else { return Ok(None) };
    if built.body.linear().unknowns() == fine.unknowns {
        return Ok(None);
    }
    let Operators { body, cells, .. } = built;
    context.watch.at(Stage::Factor)?;
    let linear = body.linear();
    let mut krylov = DirectSum::new(linear, Plan::new(context, linear, scene).start)?;
    let vectors = fine.compared();
    grow(&mut krylov, linear, vectors, None, context.watch)?;
    let (_, steps) = fine.reduced.force;
    let Trial { force, .. } = Trials::new(context, scene).force_in(steps, &krylov.projection(linear)?)?;
    drop((krylov, body));
    context.comm.collect_garbage()?;
    Ok(cells.map(|cells| Judge { force, vectors, cells }))
}
