//! Chooses spline cells as fine as a scene needs, and estimates their discretisation error.
//!
//! The cell size that a tolerance requires depends on the contact time and on the waves reflected at the edges. It is
//! known only by a rule of thumb. The force is therefore also computed on coarser cells, or on finer ones if there are
//! few, with a basis of the same size.

use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use super::elastic_cells;
use super::reduce::{BASIS_SHARE, Plan, Reduced, grow, reduce_from};
use super::theory::{Built, Operators, build, cells_of_grid};
use super::trials::{Trial, Trials};
use super::watch::{Stage, Watch};
use crate::body::{DirectSum, InfinitePlate, ModalBody};
use crate::error::{Error, Result};
use crate::impact::{Errors, ModalImpact, TIME_STEP_SHARE, Trace, joined, rest};
use crate::mesh::Measures;
use crate::scene::{Measure, Model, Scene, Symmetry};
use crate::space::evaluate::{Evaluator, TensionErrors};
use crate::space::plate::crossing;

/// Size of the coarser cells relative to the others; and least and largest size of finer cells relative to the present
/// ones.
pub(super) const COARSER_CELL_FACTOR: f64 = 1.5;
pub(super) const FINER_CELL_FACTORS: [f64; 2] = [1.0 / COARSER_CELL_FACTOR, 0.85];

/// Order of convergence in the cell size assumed for the force and for averaged stresses. Measured: 3.8 for the
/// stresses of statically loaded plates.
pub(super) const ORDER: f64 = 3.0;

/// The same for solids on grids with fewer cells than [`FEW_OF_SOLIDS`]. They do not resolve the edges, where stresses
/// are singular. An estimate.
const ORDER_OF_SOLIDS: f64 = 2.0;
const FEW_OF_SOLIDS: usize = 6;

/// Order of convergence of coarse grids per cell along the axis with the fewest cells: such grids do not reach their
/// full order. An estimate.
const ORDER_PER_CELL: f64 = 0.58;

/// Order of convergence of solids if a clamp prevents the sections of an edge from warping: stresses are singular
/// there. An estimate. The force on plates converges as with other edges.
const ORDER_AT_CLAMPS: f64 = 1.1;

/// Largest cell at the impact point, over the radius of Mindlin's disc, that resolves the disc's pressure; and the
/// order of convergence then, for any number of cells. With two and three cells the error of the force was measured to
/// be 0.08 to 0.2 of the difference, which corresponds to orders of 4.5 and more.
const RESOLVING_CELL_OVER_DISC: f64 = 0.7;
const ORDER_OF_RESOLVED: f64 = 3.5;

/// Range of the same ratio for coarser cells whose first grid line is near the disc's edge, while the first line of the
/// finer cells is not. The error of the coarser cells may then be small by accident, and the difference is unreliable:
/// the error was measured to be up to 2.2 times the difference.
const LINE_AT_EDGE: [f64; 2] = [0.78, 1.1];

/// Least order outside that range, for any number of cells: errors of up to 0.7 of the difference were measured, which
/// is an order of 2.2.
const ORDER_BESIDE_EDGE: f64 = 2.0;

/// Largest error of a solid's tension over the difference, if the coarser grid also has fewer cells across the
/// thickness: their effect converges with a higher order. Measured: 0.2 to 0.5 where the difference is large.
const TENSION_FACTOR_IF_COARSER_ACROSS: f64 = 0.8;

/// Error of the tension by the static local field under the impactor, over the square of [`crossing`]: the time in
/// which shear waves cross the thickness, over the contact time on a half-space. With the pressure on a disc half as
/// wide the tension near its peak changed by 1.3 to 2 times that square.
const LOCAL_FIELD_FACTOR: f64 = 2.5;

/// A plate is compared with coarser cells if there are at least this many of them along each edge, and if the error is
/// at most this factor times the difference; otherwise it is compared with finer cells. On few cells the force converges
/// irregularly: with two coarser cells along an edge, the error was measured to be 0.1 to 15 of the difference.
const FEWEST_COARSER_CELLS: usize = 3;
const LARGEST_FACTOR_TO_COARSER: f64 = 1.0;

/// Least number of coarser cells between the impact point and each edge with which a solid is compared. With three
/// of them in a thick box, the estimate was 0.3 of the error of the cells.
const FEWEST_COARSER_CELLS_OF_SOLIDS: f64 = 4.0;

/// Least ratio of the numbers of those finer cells to the others along each edge.
const FINER_RATIO_IF_FEW: f64 = 1.5;

/// Error on few cells over the difference from the finer cells. Measured on sixty plates: 1.05 to 2.1. An
/// error that is proportional to the cube of the cell size would be 1.4 of the difference.
const ERROR_FACTOR_IF_FEW: f64 = 2.2;

/// The same factor for a solid with at most two cells between the impact point and an edge. On sixty thick boxes the error
/// was measured to be at most 2.6 of the difference, and with more cells at most 1.5 of it.
const ERROR_FACTOR_OF_TWO_CELLS: f64 = 3.0;

/// Factor from one size to the next in the search for such cells.
const FINER_STEP: f64 = 0.95;

/// Share of the tolerance for the estimated discretisation error. It may be more if steps, basis and theory need less.
pub(super) const CELL_SHARE: f64 = 0.6;

/// Largest factor from a difference to an error. The difference of two nearly equal grids does not estimate their
/// error.
const LARGEST_FACTOR: f64 = 3.0;

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
    /// Longest cell at the impact point over the disc's radius, as in [`Operators::cell_over_disc`].
    pub cell_over_disc: Option<f64>,
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
    /// Estimated discretisation error.
    pub error: Errors,
    /// Numbers of vectors, of a smaller and a larger basis, with which a basis may begin to grow, if known.
    pub vectors: Option<[usize; 2]>,
}

/// Largest number of basis vectors on which cells are compared. The errors of bases with the same number of vectors are
/// similar, and cancel in the difference. If short waves are treated separately, the smaller basis of the two is used:
/// coarser cells carry no more waves, and with all vectors the difference was ten times the error.
const MAX_COMPARED_VECTORS: usize = 800;

/// Number of basis vectors over that on which cells are compared, if the echoes of short waves are computed in closed form.
const COMPARED_BESIDE_ECHOES: f64 = 1.8;

/// Largest value of unknowns times the square of the number of vectors for which cells are still refined. Such a basis
/// takes some five seconds, and one on finer cells at least as long. Beyond this value the remaining discretisation
/// error is reported with the results.
const LARGEST_REFINED_COST: f64 = 4e9;

/// The force on coarser or finer cells, for comparison.
pub(super) struct Judge {
    pub force: Trace,
    /// Number of vectors of the basis.
    pub vectors: usize,
    pub cells: [usize; 3],
    pub cell_over_disc: Option<f64>,
}

impl Judge {
    /// Estimated errors on `cells`, from the difference between the forces on `cells` and on these cells.
    pub fn errors(&self, cells: [usize; 3], scene: &Scene, theory: Model, difference: Errors) -> Errors {
        let is_finer = (0..3).all(|axis| self.cells[axis] >= cells[axis]) && self.cells != cells;
        if !is_finer {
            return self.errors_of_finer(cells, scene, theory, difference);
        }
        let has_two = || along_face(scene, theory, cells).any(|axis| cells_from_hit(scene, cells, axis) <= 2.0);
        let of_difference =
            if theory == Model::Solid && has_two() { ERROR_FACTOR_OF_TWO_CELLS } else { ERROR_FACTOR_IF_FEW };
        of_difference * difference
    }

    /// Estimated errors on finer cells, from their difference from these cells.
    fn errors_of_finer(&self, finer: [usize; 3], scene: &Scene, theory: Model, difference: Errors) -> Errors {
        // There are no finer cells to compare with.
        let is_unreliable = theory == Model::Solid && is_unreliable(scene, theory, self.cells, finer);
        let of_difference = if is_unreliable { LARGEST_FACTOR } else { self.of_difference(finer, scene, theory) };
        let mut errors = of_difference * difference;
        let is_finer_across = |axis: usize| theory == Model::Solid && self.cells[axis] < finer[axis];
        if scene.struck_axis().is_some_and(is_finer_across) {
            errors.stress = of_difference.min(TENSION_FACTOR_IF_COARSER_ACROSS) * difference.stress;
        }
        errors
    }

    /// Error on finer cells over their difference from these cells.
    ///
    /// Numbers of cells are integers, so their ratio differs from the ratio of the requested sizes.
    fn of_difference(&self, finer: [usize; 3], scene: &Scene, theory: Model) -> f64 {
        let axes = self.axes(finer, scene, theory);
        let Some(fewest) = axes.iter().map(|(cells, _)| *cells).min() else { return LARGEST_FACTOR };
        // The bound keeps the result finite if the grids are equal.
        (ratio(&axes).powf(self.order(fewest, scene, theory)) - 1.0).max(LARGEST_FACTOR.recip()).recip()
    }

    /// Numbers of cells along the relevant axes, here and on the finer grid.
    fn axes(&self, finer: [usize; 3], scene: &Scene, theory: Model) -> Vec<(usize, usize)> {
        // Across the thickness a solid has few cells of high order.
        let across = if theory == Model::Solid { scene.struck_axis() } else { None };
        let axes = (0..3).filter(|axis| Some(*axis) != across && self.cells[*axis] > 1);
        axes.map(|axis| (self.cells[axis], finer[axis])).collect()
    }

    /// Order of convergence in the cell size; `fewest` is the smallest number of cells along an axis.
    fn order(&self, fewest: usize, scene: &Scene, theory: Model) -> f64 {
        let is_solid = theory == Model::Solid;
        let full = if is_solid && fewest < FEW_OF_SOLIDS { ORDER_OF_SOLIDS } else { ORDER };
        let at_edges = if is_solid && scene.clamps_sections() { ORDER_AT_CLAMPS } else { full };
        let of_few = full.min(ORDER_PER_CELL * fewest as f64);
        let [from, to] = LINE_AT_EDGE;
        match self.cell_over_disc.filter(|_| !is_solid) {
            Some(cell) if cell <= RESOLVING_CELL_OVER_DISC => ORDER_OF_RESOLVED,
            Some(cell) if cell <= from || cell > to => at_edges.min(of_few.max(ORDER_BESIDE_EDGE)),
            _ => at_edges.min(of_few),
        }
    }

    /// Scales the errors on `cells`, estimated by comparison with these coarser cells, to `finer` cells by the order of
    /// convergence.
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

/// Ratio of the finer to the coarser number of cells along an axis, as the geometric mean over the axes.
fn ratio(axes: &[(usize, usize)]) -> f64 {
    let ratios: f64 = axes.iter().map(|(cells, finer)| *finer as f64 / *cells as f64).product();
    ratios.powf(1.0 / axes.len() as f64)
}

impl Fitted {
    /// Number of basis vectors on which cells are compared.
    fn compared(&self) -> usize {
        let [smaller, vectors] = self.reduced.counts();
        match &self.reduced.projection.infinite_plate {
            // Both bases have the same number of vectors.
            Some(InfinitePlate { rectangle: Some(_), .. }) => (vectors as f64 / COMPARED_BESIDE_ECHOES).ceil() as usize,
            Some(_) => smaller,
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
pub fn fit(comm: &Comm, scene: &Scene, theory: Model, built: Operators, watch: &dyn Watch) -> Result<Fitted> {
    if elastic_cells::serves(scene, theory) {
        return elastic_cells::fit(comm, scene, theory, built, None, watch);
    }
    refine(comm, scene, theory, unrefined(comm, scene, built, watch)?, Errors::default(), watch)
}

/// The cells on which `fit` reduces a body. For viscoelastic layers they are found without reducing the viscoelastic
/// body, which takes longest. Collective.
///
/// # Errors
/// Same as `fit`.
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

/// Reduces a body on its present cells. Collective.
///
/// # Errors
/// Same as [`reduce`](super::reduce::reduce).
pub fn unrefined(comm: &Comm, scene: &Scene, built: Operators, watch: &dyn Watch) -> Result<Fitted> {
    fitted(comm, scene, built, (1.0, None), watch)
}

/// Refines the cells of a spline body in modal coordinates until its discretisation error is small enough. `of_theory`
/// is the estimated error of the theory, if it uses a part of the tolerance. Collective.
///
/// # Errors
/// Same as [`reduce`](super::reduce::reduce) and [`build`].
pub fn refine(
    comm: &Comm,
    scene: &Scene,
    theory: Model,
    mut fine: Fitted,
    of_theory: Errors,
    watch: &dyn Watch,
) -> Result<Fitted> {
    let Some(mut cells) = fine.cells.filter(|_| scene.time.modal) else { return Ok(fine) };
    let mut judge = match judge_of(comm, scene, theory, &fine, watch) {
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
            let Errors { first_contact, history, stress } = error;
            tracing::info!(size = fine.size, unknowns = fine.unknowns, first_contact, history, stress, "cells");
            // Errors that do not depend on the cell size are part of the estimate, but not of the choice of cells.
            fine.error = Some(with_local_fields(scene, fine.evaluator.as_ref(), error));
            let wanted = allowed(scene, fine.reduced.error.joined(of_theory));
            let over = watch.agreed(error.of(scene.measure) / wanted);
            finer = over.recip().powf(1.0 / ORDER).clamp(FINER_CELL_FACTORS[0], FINER_CELL_FACTORS[1]);
            let cost = fine.unknowns as f64 * (fine.reduced.projection.vectors() as f64).powi(2);
            if over <= 1.0 || finer * fine.size < SMALLEST_CELL_FACTOR || cost > LARGEST_REFINED_COST {
                return Ok(fine);
            }
        }
        let mut size = finer * fine.size;
        // Numbers of cells are integers: sizes that give the same numbers are skipped.
        while size >= SMALLEST_CELL_FACTOR && cells_of_grid(scene, theory, size) == Some(cells) {
            size *= FINER_CELL_FACTORS[1];
        }
        let built = loop {
            let built = match build(comm, scene, theory, size, watch) {
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
        let coarser = Judge { force, vectors, cells, cell_over_disc: fine.cell_over_disc };
        cells = built.cells.unwrap_or(cells);
        let vectors = fine.reduced.counts();
        fine = fitted(comm, scene, built, (size, Some(vectors)), watch)?;
        let is_few = is_unreliable(scene, theory, coarser.cells, cells);
        judge = match finer_size_if(is_few, scene, theory, &fine, watch) {
            Some(size) => match on_cells_of(comm, scene, theory, &fine, size, watch) {
                Ok(judge) => judge.or(Some(coarser)),
                Err(Error::Solve(_)) => Some(coarser),
                Err(error) => return Err(error),
            },
            None => Some(coarser),
        };
    }
}

/// Largest error of the basis of another body on the same cells.
pub(super) fn of_other_bases(scene: &Scene) -> Errors {
    Errors::throughout(BASIS_SHARE * scene.tolerance)
}

/// Largest allowed discretisation error: its share of the tolerance, or more if steps and the `others` need less, or less
/// if the `others` need more. For stresses only the share is allowed, because the local fields have an error too.
fn allowed(scene: &Scene, others: Errors) -> f64 {
    let own = CELL_SHARE * scene.tolerance;
    match scene.measure {
        Measure::Acceleration => own.max(rest(rest(1.0, TIME_STEP_SHARE) * scene.tolerance, others.of(scene.measure))),
        Measure::Stress => own,
    }
}

/// Adds to the discretisation error the errors of the local fields, which do not depend on the cell size.
pub(super) fn with_local_fields(scene: &Scene, evaluator: Option<&Evaluator>, error: Errors) -> Errors {
    let TensionErrors { of_cells, of_width, of_edges } = evaluator.map(Evaluator::tension_errors).unwrap_or_default();
    let of_crossing = LOCAL_FIELD_FACTOR * crossing(scene).powi(2);
    let of_local_field = [of_width, of_crossing, of_edges].into_iter().fold(of_cells, joined);
    error.joined(Errors { stress: of_local_field, ..Errors::default() })
}

/// Reduces a body to a basis. `size` is the size of its cells; `vectors` are numbers of vectors that were enough on
/// other cells.
pub(super) fn fitted(
    comm: &Comm,
    scene: &Scene,
    built: Operators,
    (size, vectors): (f64, Option<[usize; 2]>),
    watch: &dyn Watch,
) -> Result<Fitted> {
    let Operators { body, discretisation, evaluator, cells, cell_over_disc, measures } = built;
    let linear = body.linear();
    let (reduced, unknowns) = (reduce_from(comm, linear, scene, vectors, watch)?, linear.unknowns());
    let fitted =
        Fitted { reduced, unknowns, cells, cell_over_disc, discretisation, size, error: None, evaluator, measures };
    drop(body);
    comm.collect_garbage()?;
    Ok(fitted)
}

/// The force on coarser cells, or on finer ones if a comparison with coarser cells would be unreliable; `None` if there
/// are no other cells.
fn judge_of(comm: &Comm, scene: &Scene, theory: Model, fitted: &Fitted, watch: &dyn Watch) -> Result<Option<Judge>> {
    let coarser = cells_of_grid(scene, theory, COARSER_CELL_FACTOR * fitted.size);
    let is_few = fitted.cells.zip(coarser).is_some_and(|(cells, coarser)| match theory {
        Model::Solid => is_unreliable(scene, theory, coarser, cells),
        _ => are_few(cells, coarser),
    });
    match finer_size_if(is_few, scene, theory, fitted, watch) {
        Some(size) => on_cells_of(comm, scene, theory, fitted, size, watch),
        None => on_coarser_cells(comm, scene, theory, fitted, watch),
    }
}

/// Size of finer cells for a comparison, if there are few cells. The same on all ranks. Collective.
fn finer_size_if(is_few: bool, scene: &Scene, theory: Model, fitted: &Fitted, watch: &dyn Watch) -> Option<f64> {
    let size = is_few.then(|| finer_size(scene, theory, fitted)).flatten();
    Some(watch.agreed(size.unwrap_or(f64::NAN))).filter(|size| !size.is_nan())
}

/// Size of finer cells with which few cells are compared.
fn finer_size(scene: &Scene, theory: Model, fitted: &Fitted) -> Option<f64> {
    let cells = fitted.cells?;
    let is_finer = |finer: [usize; 3]| {
        let mut axes = along_face(scene, theory, cells);
        axes.all(|axis| finer[axis] as f64 >= FINER_RATIO_IF_FEW * cells[axis] as f64)
    };
    let mut size = fitted.size;
    while !cells_of_grid(scene, theory, size).is_some_and(is_finer) {
        size *= FINER_STEP;
        if size < SMALLEST_CELL_FACTOR * fitted.size {
            return None;
        }
    }
    Some(size)
}

/// Whether the cells of a plate are too few for a comparison with coarser ones.
pub(super) fn are_few(cells: [usize; 3], coarser: [usize; 3]) -> bool {
    let axes: Vec<_> = (0..3).filter(|axis| cells[*axis] > 1).map(|axis| (coarser[axis], cells[axis])).collect();
    let fewest = axes.iter().map(|(along, _)| *along).min().unwrap_or(0);
    let order = ORDER.min(ORDER_PER_CELL * fewest as f64);
    fewest < FEWEST_COARSER_CELLS || ratio(&axes).powf(order) - 1.0 < LARGEST_FACTOR_TO_COARSER.recip()
}

/// Whether a comparison of `cells` with coarser ones is unreliable: there are too few of these along an edge of the
/// impacted face, or, for a solid, no fewer than of the others.
fn is_unreliable(scene: &Scene, theory: Model, coarser: [usize; 3], cells: [usize; 3]) -> bool {
    along_face(scene, theory, cells).any(|axis| match theory {
        Model::Solid => {
            cells_from_hit(scene, coarser, axis) < FEWEST_COARSER_CELLS_OF_SOLIDS || coarser[axis] >= cells[axis]
        }
        _ => coarser[axis] < FEWEST_COARSER_CELLS,
    })
}

/// Number of cells between the impact point and an edge: half of the cells, if both halves of the edge are modelled.
fn cells_from_hit(scene: &Scene, cells: [usize; 3], axis: usize) -> f64 {
    let is_halved = matches!(scene.body.symmetry, Symmetry::Quarter { axes } if axes.contains(&axis));
    cells[axis] as f64 * if is_halved { 1.0 } else { 0.5 }
}

/// Axes along the impacted face; those of a plate have several cells.
fn along_face(scene: &Scene, theory: Model, cells: [usize; 3]) -> impl Iterator<Item = usize> {
    let across = if theory == Model::Solid { scene.struck_axis() } else { None };
    (0..3).filter(move |axis| Some(*axis) != across && (theory == Model::Solid || cells[*axis] > 1))
}

/// The force on coarser cells; `None` if there are no coarser cells.
pub(super) fn on_coarser_cells(
    comm: &Comm,
    scene: &Scene,
    theory: Model,
    fine: &Fitted,
    watch: &dyn Watch,
) -> Result<Option<Judge>> {
    on_cells_of(comm, scene, theory, fine, COARSER_CELL_FACTOR * fine.size, watch)
}

/// The force on cells of another size; `None` if they are the same cells.
fn on_cells_of(
    comm: &Comm,
    scene: &Scene,
    theory: Model,
    fine: &Fitted,
    size: f64,
    watch: &dyn Watch,
) -> Result<Option<Judge>> {
    match build(comm, scene, theory, size, watch)? {
        Built::Operators(built) => on_cells_built(comm, scene, fine, built, watch),
        Built::Given(_) => Ok(None),
    }
}

/// The force on the cells of another body; `None` if they are the same cells.
pub(super) fn on_cells_built(
    comm: &Comm,
    scene: &Scene,
    fine: &Fitted,
    built: Operators,
    watch: &dyn Watch,
) -> Result<Option<Judge>> {
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
