//! Estimates the discretisation error from the difference between the forces on two grids.
//!
//! On a grid with enough cells, the error falls with a known order of convergence, and a comparison with a coarser grid
//! gives an estimate. On a grid with few cells it does not. Such a grid is compared with a finer one, and the error is
//! the difference times a measured factor.

use super::cells::SMALLEST_CELL_FACTOR;
use super::theory::cells_of_grid;
use crate::impact::{Errors, Trace};
use crate::scene::{Model, Scene, Symmetry};

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

/// Factor from one size to the next in the search for such cells.
const FINER_STEP: f64 = 0.95;

/// Factor from the difference to the error on few cells, in comparison with finer ones, and the largest one on others: the
/// difference of two nearly equal grids does not estimate their error. Measured on few cells: 1.05 to 2.1 on sixty plates,
/// up to 2.6 on sixty thick boxes. An error that is proportional to the cube of the cell size would be 1.4 of the difference.
const LARGEST_FACTOR: f64 = 3.0;

/// The force on coarser or finer cells, for comparison.
pub(super) struct Judge {
    pub force: Trace,
    /// Number of vectors of the basis.
    pub vectors: usize,
    pub cells: [usize; 3],
}

impl Judge {
    /// Estimated errors on `cells`, from the difference between the forces on `cells` and on these cells.
    pub fn errors(&self, cells: [usize; 3], scene: &Scene, theory: Model, difference: Errors) -> Errors {
        let is_finer = (0..3).all(|axis| self.cells[axis] >= cells[axis]) && self.cells != cells;
        // There may be no finer cells to compare with.
        let is_unreliable = || theory == Model::Solid && is_unreliable(scene, theory, self.cells, cells);
        let of_difference =
            if is_finer || is_unreliable() { LARGEST_FACTOR } else { self.of_difference(cells, scene, theory) };
        of_difference * difference
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
        at_edges.min(ORDER_PER_CELL * fewest as f64)
    }
}

/// Ratio of the finer to the coarser number of cells along an axis, as the geometric mean over the axes.
fn ratio(axes: &[(usize, usize)]) -> f64 {
    let ratios: f64 = axes.iter().map(|(cells, finer)| *finer as f64 / *cells as f64).product();
    ratios.powf(1.0 / axes.len() as f64)
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
pub(super) fn is_unreliable(scene: &Scene, theory: Model, coarser: [usize; 3], cells: [usize; 3]) -> bool {
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

/// Cell size of the finer grid with which a grid of few cells is compared; `None` if there is none.
pub(super) fn finer_size(scene: &Scene, theory: Model, cells: [usize; 3], size: f64) -> Option<f64> {
    let is_finer = |finer: [usize; 3]| {
        let mut axes = along_face(scene, theory, cells);
        axes.all(|axis| finer[axis] as f64 >= FINER_RATIO_IF_FEW * cells[axis] as f64)
    };
    let mut finer = size;
    while !cells_of_grid(scene, theory, finer).is_some_and(is_finer) {
        finer *= FINER_STEP;
        if finer < SMALLEST_CELL_FACTOR * size {
            return None;
        }
    }
    Some(finer)
}
