//! Cells of splines as fine as a scene needs, with the error that they leave.
//!
//! What cells a tolerance takes goes with the length of the contact and what comes back from the edges, and is known by a rule of thumb
//! only. So the force is computed on coarser cells too, on a basis as large.

use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use super::elastic_cells;
use super::reduce::{OF_BASIS, Plan, Reduced, grow, reduce_from};
use super::theory::{Built, Operators, build, cells_of_plate};
use super::trials::{Trial, Trials};
use super::watch::{Stage, Watch};
use crate::body::{DirectSum, ModalBody, Projection};
use crate::error::{Error, Result};
use crate::impact::{Errors, ModalImpact, OF_STEPS, Trace, joined, rest};
use crate::mesh::Measures;
use crate::scene::{Measure, Model, Scene};
use crate::space::evaluate::Evaluator;
use crate::space::plate::crossing;

/// The coarser cells over the others, and finer ones over those at least and at most.
const COARSER: f64 = 1.5;
pub(super) const FINER: [f64; 2] = [1.0 / COARSER, 0.85];

/// Errors fall with this power of the size, or faster: of the force, and of means of stresses (3.8 of plates at rest).
pub(super) const ORDER: f64 = 3.0;

/// The same of solids on grids of fewer cells than [`FEW_OF_SOLIDS`]: their edges, at which stresses have no limit, are not resolved. An estimate.
const ORDER_OF_SOLIDS: f64 = 2.0;
const FEW_OF_SOLIDS: usize = 6;

/// Order of grids with few cells, for each cell along the axis that has the fewest: they are too coarse for their own order. With three cells
/// along a quarter of a plate the error was measured to be up to 1.6 times the difference from two. An estimate.
const ORDER_PER_CELL: f64 = 0.58;

/// Order where a clamp holds the sections of an edge: stresses have no limit there. An estimate.
const ORDER_AT_CLAMPS: f64 = 1.25;

/// Cells at the hit over the radius of Mindlin's disc up to which they carry its pressure, and the order of the error there however few
/// cells there are. With two and three cells the error of the force was measured to be 0.08 to 0.2 of the difference, which are orders of 4.5 and more.
const RESOLVED: f64 = 0.7;
const ORDER_OF_RESOLVED: f64 = 3.5;

/// The same ratio of the coarser cells where their first line is near the disc's edge, and that of the finer ones is not. The error of the coarser cells may then
/// be small by accident, and the difference is unreliable: the error was measured to be up to 2.2 times it.
const LINE_AT_EDGE: [f64; 2] = [0.78, 1.1];

/// The least order elsewhere, however few cells there are: errors of up to 0.7 of the difference were measured, which is an order of 2.2.
const ORDER_BESIDE_EDGE: f64 = 2.0;

/// The error of a solid's tension over a difference at most where the coarser cells are fewer across the thickness, too: what these change
/// is of a higher order. 0.2 to 0.5 were measured where the difference is large.
const OF_TENSION_ACROSS: f64 = 0.8;

/// What the field at rest under the hit leaves of the tension, over the square of the part of the contact time on a half-space in which
/// shear waves cross the thickness. With the pressure on a disc half as wide the tension near its peak changed by 1.3 to 2 times that.
const OF_CROSSING: f64 = 2.5;

/// Part of the tolerance that the estimate may take, where steps, basis and theory leave no more.
pub(super) const OF_CELLS: f64 = 0.6;

/// An error over a difference at most: grids that are more alike than this do not judge each other.
const LARGEST_FACTOR: f64 = 3.0;

/// Cells are not made finer than by this part of the rule of thumb's.
pub(super) const FINEST: f64 = 0.25;

/// A body on cells and a basis.
pub struct Fitted {
    /// The body on its basis.
    pub reduced: Reduced,
    /// Unknowns before that.
    pub unknowns: usize,
    /// As [`Operators::cells`].
    pub cells: Option<[usize; 3]>,
    /// As [`Operators::cell_over_disc`].
    pub cell_over_disc: Option<f64>,
    /// What these are of.
    pub words: String,
    /// Size of the cells over that by the rule of thumb.
    pub size: f64,
    /// Estimated error by the cells, where it was looked for.
    pub error: Option<Errors>,
    /// What reads the body, as [`Operators::evaluator`].
    pub evaluator: Option<Evaluator>,
    /// As [`Operators::measures`].
    pub measures: Option<Measures>,
}

/// Cells that serve a scene.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CellSize {
    /// Their size over that by the rule of thumb.
    pub size: f64,
    /// What they leave of the force.
    pub error: Errors,
    /// Numbers of vectors, of a smaller and a larger basis, with which a basis may begin to grow, where they are known.
    pub vectors: Option<[usize; 2]>,
}

/// Vectors of a basis on which cells are compared, at most: on bases of as many vectors the errors of these are alike, and cancel. Where short
/// waves are kept apart these are the vectors of the smaller basis: coarser cells carry no more waves, and their difference with all of
/// them was ten times the error.
const SHORT: usize = 800;

/// Unknowns times the square of the vectors above which no basis is made anew on finer cells, which takes as long again and longer: some
/// five seconds. What the cells leave is told with the results.
const DEAREST: f64 = 4e9;

/// The force on other cells.
pub(super) struct Judge {
    pub force: Trace,
    /// Vectors of its basis.
    pub vectors: usize,
    pub cells: [usize; 3],
    pub cell_over_disc: Option<f64>,
}

impl Judge {
    /// Errors on finer cells by their differences from this.
    pub fn errors(&self, finer: [usize; 3], scene: &Scene, theory: Model, difference: Errors) -> Errors {
        let of_difference = self.of_difference(finer, scene, theory);
        let mut errors = of_difference * difference;
        let is_finer_across = |axis: usize| theory == Model::Solid && self.cells[axis] < finer[axis];
        if scene.struck_axis().is_some_and(is_finer_across) {
            errors.stress = of_difference.min(OF_TENSION_ACROSS) * difference.stress;
        }
        errors
    }

    /// Error on finer cells over their difference from this.
    ///
    /// Cells are whole numbers, so that the ratio of their numbers is not that of the sizes that were asked for.
    fn of_difference(&self, finer: [usize; 3], scene: &Scene, theory: Model) -> f64 {
        let axes = self.axes(finer, scene, theory);
        let Some(fewest) = axes.iter().map(|(cells, _)| *cells).min() else { return LARGEST_FACTOR };
        // Grids that are alike give nothing finite.
        (ratio(&axes).powf(self.order(fewest, scene, theory)) - 1.0).max(LARGEST_FACTOR.recip()).recip()
    }

    /// Cells along the axes that count, with those of finer ones.
    fn axes(&self, finer: [usize; 3], scene: &Scene, theory: Model) -> Vec<(usize, usize)> {
        // Across a thickness a solid has few cells of a high order.
        let across = if theory == Model::Solid { scene.struck_axis() } else { None };
        let axes = (0..3).filter(|axis| Some(*axis) != across && self.cells[*axis] > 1);
        axes.map(|axis| (self.cells[axis], finer[axis])).collect()
    }

    /// The power of the size with which errors fall.
    fn order(&self, fewest: usize, scene: &Scene, theory: Model) -> f64 {
        let is_solid = theory == Model::Solid;
        let is_clamped = scene.clamps_sections();
        let full = if is_solid && fewest < FEW_OF_SOLIDS { ORDER_OF_SOLIDS } else { ORDER };
        let at_edges = if is_clamped { ORDER_AT_CLAMPS } else { full };
        let of_few = full.min(ORDER_PER_CELL * fewest as f64);
        let [from, to] = LINE_AT_EDGE;
        match self.cell_over_disc.filter(|_| !is_solid) {
            Some(cell) if cell <= RESOLVED => ORDER_OF_RESOLVED,
            Some(cell) if cell <= from || cell > to => at_edges.min(of_few.max(ORDER_BESIDE_EDGE)),
            _ => at_edges.min(of_few),
        }
    }

    /// Scales the errors on `cells`, as compared with these coarser ones, to `finer` cells by the order of convergence.
    pub fn errors_on_finer(
        &self,
        (cells, errors): ([usize; 3], Errors),
        finer: [usize; 3],
        scene: &Scene,
        theory: Model,
    ) -> Errors {
        let [before, after] = [cells, finer].map(|cells| ratio(&self.axes(cells, scene, theory)));
        let fewest = self.axes(cells, scene, theory).iter().map(|(cells, _)| *cells).min();
        let order = fewest.map_or(0.0, |fewest| self.order(fewest, scene, theory));
        (before / after).powf(order) * errors
    }
}

/// How many finer cells there are to one along an axis, the mean of some.
fn ratio(axes: &[(usize, usize)]) -> f64 {
    let ratios: f64 = axes.iter().map(|(cells, finer)| *finer as f64 / *cells as f64).product();
    ratios.powf(1.0 / axes.len() as f64)
}

impl Fitted {
    /// Vectors on which cells are compared.
    fn compared(&self) -> usize {
        let [smaller, _] = self.reduced.counts();
        let Projection { infinite_plate, .. } = &self.reduced.projection;
        if infinite_plate.is_some() { smaller } else { self.reduced.projection.vectors().min(SHORT) }
    }

    /// The force on the basis, or on the first vectors of a long one.
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

/// Reduces a body on its cells, then a body of splines in modal coordinates on finer ones where these leave too much. Collective.
///
/// # Errors
/// Those of [`reduce`](super::reduce::reduce) and [`build`].
pub fn fit(comm: &Comm, scene: &Scene, theory: Model, built: Operators, watch: &dyn Watch) -> Result<Fitted> {
    if elastic_cells::serves(scene, theory) {
        return elastic_cells::fit(comm, scene, theory, built, None, watch);
    }
    refine(comm, scene, theory, unrefined(comm, scene, built, watch)?, Errors::default(), watch)
}

/// The cells on which `fit` reduces a body: of layers that relax these are found without a basis of theirs, which takes longest. Collective.
///
/// # Errors
/// Those of `fit`.
pub fn cell_size(comm: &Comm, scene: &Scene, theory: Model, built: Operators, watch: &dyn Watch) -> Result<CellSize> {
    if elastic_cells::serves(scene, theory)
        && let Some(found) = elastic_cells::cell_size(comm, scene, theory, &built, watch)?
    {
        return Ok(found);
    }
    let Fitted { size, error, .. } =
        refine(comm, scene, theory, unrefined(comm, scene, built, watch)?, of_other_bases(scene), watch)?;
    Ok(CellSize { size, error: error.unwrap_or_default(), vectors: None })
}

/// Reduces a body on the cells that it has. Collective.
///
/// # Errors
/// Those of [`reduce`](super::reduce::reduce).
pub fn unrefined(comm: &Comm, scene: &Scene, built: Operators, watch: &dyn Watch) -> Result<Fitted> {
    fitted(comm, scene, built, (1.0, None), watch)
}

/// Reduces a body of splines, in modal coordinates, on finer cells where its own leave too much; `of_theory` is the theory's estimated error,
/// where that counts for the tolerance. Collective.
///
/// # Errors
/// Those of [`reduce`](super::reduce::reduce) and [`build`].
pub fn refine(
    comm: &Comm,
    scene: &Scene,
    theory: Model,
    mut fine: Fitted,
    of_theory: Errors,
    watch: &dyn Watch,
) -> Result<Fitted> {
    let Some(mut cells) = fine.cells.filter(|_| scene.time.modal) else { return Ok(fine) };
    let mut coarse = match on_coarser_cells(comm, scene, theory, &fine, watch) {
        Ok(judge) => judge,
        // Too coarse cells may be too soft, or too stiff, for the contact law: then finer ones judge.
        Err(Error::Solve(_)) => None,
        Err(error) => return Err(error),
    };
    loop {
        let mut finer = FINER[0];
        if let Some(coarse) = &coarse {
            let difference = watch.shared(fine.on_short_basis(scene, coarse.vectors))?.difference(&coarse.force);
            let error = coarse.errors(cells, scene, theory, difference);
            let Errors { first_contact, history, stress } = error;
            tracing::info!(size = fine.size, unknowns = fine.unknowns, first_contact, history, stress, "cells");
            // (What finer cells do not change counts for the estimate, not for the choice of cells.)
            fine.error = Some(with_local_fields(scene, fine.evaluator.as_ref(), error));
            let wanted = allowed(scene, fine.reduced.error.joined(of_theory));
            let over = watch.agreed(error.of(scene.measure) / wanted);
            finer = over.recip().powf(1.0 / ORDER).clamp(FINER[0], FINER[1]);
            let cost = fine.unknowns as f64 * (fine.reduced.projection.vectors() as f64).powi(2);
            if over <= 1.0 || finer * fine.size < FINEST || cost > DEAREST {
                return Ok(fine);
            }
        }
        let mut size = finer * fine.size;
        // Cells are whole numbers: sizes that give the same ones are passed over.
        while size >= FINEST && cells_of_plate(scene, theory, size) == Some(cells) {
            size *= FINER[1];
        }
        let built = loop {
            let built = match build(comm, scene, theory, size, watch) {
                Ok(Built::Operators(built)) => built,
                // More unknowns than splines are made for: what is left is told with the results.
                Ok(Built::Given(_)) | Err(Error::Fault(_)) => return Ok(fine),
                Err(error) => return Err(error),
            };
            if built.cells != Some(cells) || size < FINEST {
                break built;
            }
            size *= FINER[1];
        };
        let vectors = fine.compared();
        let force = watch.shared(fine.on_short_basis(scene, vectors))?;
        coarse = Some(Judge { force, vectors, cells, cell_over_disc: fine.cell_over_disc });
        cells = built.cells.unwrap_or(cells);
        let vectors = fine.reduced.counts();
        fine = fitted(comm, scene, built, (size, Some(vectors)), watch)?;
    }
}

/// The error that the basis of another body on the same cells may have.
pub(super) fn of_other_bases(scene: &Scene) -> Errors {
    Errors::throughout(OF_BASIS * scene.tolerance)
}

/// What cells may leave beside others' errors: their own part of the tolerance, or all that steps and these leave of it. (Of stresses the local
/// fields leave a part, too.)
fn allowed(scene: &Scene, others: Errors) -> f64 {
    let own = OF_CELLS * scene.tolerance;
    match scene.measure {
        Measure::Acceleration => own.max(rest(rest(1.0, OF_STEPS) * scene.tolerance, others.of(scene.measure))),
        Measure::Stress => own,
    }
}

/// The error by cells with that of what their size does not change: the local fields.
pub(super) fn with_local_fields(scene: &Scene, evaluator: Option<&Evaluator>, error: Errors) -> Errors {
    let mean = evaluator.map(Evaluator::error_of_mean).unwrap_or_default();
    let of_crossing = OF_CROSSING * crossing(scene).powi(2);
    let of_local_field = joined(joined(mean.of_cells, mean.of_width), of_crossing);
    error.joined(Errors { stress: of_local_field, ..Errors::default() })
}

/// The body on a basis; `size` is that of its cells, with what numbers of vectors served on others.
pub(super) fn fitted(
    comm: &Comm,
    scene: &Scene,
    built: Operators,
    (size, vectors): (f64, Option<[usize; 2]>),
    watch: &dyn Watch,
) -> Result<Fitted> {
    let Operators { body, words, evaluator, cells, cell_over_disc, measures } = built;
    let linear = body.linear();
    let (reduced, unknowns) = (reduce_from(comm, linear, scene, vectors, watch)?, linear.unknowns());
    let fitted = Fitted { reduced, unknowns, cells, cell_over_disc, words, size, error: None, evaluator, measures };
    drop(body);
    comm.collect_garbage()?;
    Ok(fitted)
}

/// The force on cells that are coarser; none where there are no coarser ones.
pub(super) fn on_coarser_cells(
    comm: &Comm,
    scene: &Scene,
    theory: Model,
    fine: &Fitted,
    watch: &dyn Watch,
) -> Result<Option<Judge>> {
    let Built::Operators(built) = build(comm, scene, theory, COARSER * fine.size, watch)? else { return Ok(None) };
    if built.body.linear().unknowns() == fine.unknowns {
        return Ok(None);
    }
    let Operators { body, cells, cell_over_disc, .. } = built;
    watch.at(Stage::Factor)?;
    let linear = body.linear();
    let mut krylov = DirectSum::new(linear, Plan::new(linear, scene).start)?;
    let vectors = fine.compared();
    grow(&mut krylov, linear, vectors, None, watch)?;
    let (_, steps) = fine.reduced.force;
    let Trial { force, .. } = Trials::new(comm, scene, watch).force_in(steps, &krylov.projection(linear)?)?;
    drop((krylov, body));
    comm.collect_garbage()?;
    Ok(cells.map(|cells| Judge { force, vectors, cells, cell_over_disc }))
}
