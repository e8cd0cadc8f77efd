//! Chooses the cells of viscoelastic layers on a substitute elastic body, with the secant moduli at half the contact
//! time on a half-space.
//!
//! The discretisation error is in the waves and in the field under the impactor, which the elastic body has too. Its
//! modes cost a small part of those of the viscoelastic body. The viscoelastic body is then made once, on cells that
//! are fine enough. If the first cells are not, finer ones are chosen by the order of convergence, and their error is
//! extrapolated in the same way: a fitted estimate.

use super::cell_error::{ORDER, are_few};
use super::cells::{
    CELL_SHARE, COARSER_CELL_FACTOR, CellSize, FINER_CELL_FACTORS, Fitted, fitted, has_parts, judge_of, of_other_bases,
    on_cells_built, on_coarser_cells, refine, unrefined, with_averaging,
};
use super::error_factors::ErrorFactors;
use super::local_field_error::local_field_errors;
use super::making::Making;
use super::reduce::{BASIS_SHARE, Plan, Reduced, larger};
use super::theory::{Built, Operators, build, cells_of_grid};
use super::watch::Watch;
use crate::body::{Assembled, rates, vectors_over_one_shift};
use crate::description::Description;
use crate::error::{Error, Result};
use crate::impact::{ErrorRule, Errors};
use crate::scene::{Body, Model, Parts, Scene};

/// The scene with elastic layers in place of the viscoelastic ones, with their secant moduli at half the contact time.
pub(super) fn elastic(scene: &Scene) -> Scene {
    let composition = scene.body.composition.with_secant_moduli(scene.impactor.moduli_time());
    Scene { body: Body { composition, ..scene.body.clone() }, ..scene.clone() }
}

/// The cells that bodies of a sweep share are chosen for this part of a run's discretisation error. The rest is for the
/// error of the common basis, which a run does not have.
const PART_FOR_SHARED_CELLS: f64 = 0.9;

/// Whether a scene has viscoelastic layers and its cells are chosen in this way.
pub(super) fn serves(scene: &Scene, theory: Model) -> bool {
    let is_layered = theory == Model::Layerwise && scene.body.composition.uniform().is_none();
    // Stresses on a viscoelastic face layer would be read with other moduli. Layers of equal moduli would be a plate of
    // another theory.
    let Parts::Layers(layers) = &scene.body.composition.parts else { return false };
    let has_elastic_faces =
        [layers.first(), layers.last()].into_iter().flatten().all(|face| face.material.shear.is_none());
    is_layered && has_elastic_faces && scene.time.modal && !Description::new(scene).relaxations().is_empty()
}

/// Cells that are fine enough.
struct Found {
    /// Cell size relative to the rule of thumb.
    size: f64,
    /// Estimated discretisation error.
    error: Errors,
    /// Numbers of vectors that two bases of the elastic body need.
    vectors: [usize; 2],
}

impl Found {
    /// Numbers of vectors with which the basis of the viscoelastic body begins to grow.
    fn first_vectors(&self, making: &Making, built: &Operators, scene: &Scene) -> [usize; 2] {
        // These too are a first guess: a body whose shapes change while it relaxes needs more vectors.
        let body = built.body.linear();
        let start = Plan::new(making, body, scene).start;
        let shifts = rates(&body.chains(), start.shift, start.end).len();
        if start.leaves_short_waves {
            return self.vectors.map(|vectors| (vectors_over_one_shift(shifts) * vectors as f64).ceil() as usize);
        }
        let [fewer, _] = self.vectors;
        let fewer = if shifts == 1 { fewer } else { larger(fewer) };
        [fewer, larger(fewer)]
    }
}

/// Numbers of vectors of two bases with which the error of a viscoelastic body meets its share of the tolerance, if it
/// is the error of the elastic body: a first guess. If short waves are treated separately, the error is estimated in the
/// same way. Otherwise it falls with the square of the number of vectors. More vectors are added if the error is too
/// large.
fn vectors(reduced: &Reduced, scene: &Scene) -> [usize; 2] {
    let [fewer, more] = reduced.counts();
    if reduced.projection.terms.infinite_plate.is_some() {
        return [fewer, more];
    }
    if reduced.rule == ErrorRule::default() {
        return [more, larger(more)];
    }
    let error = ErrorFactors::VISCOELASTIC.smaller * reduced.difference.of(scene.measure);
    let needed = fewer as f64 * (error / (BASIS_SHARE * scene.tolerance)).sqrt();
    let needed = (needed.ceil() as usize).clamp(fewer, more);
    [needed, larger(needed)]
}

/// The same numbers on all ranks. Collective.
fn agreed(numbers: [usize; 2], watch: &dyn Watch) -> [usize; 2] {
    numbers.map(|number| watch.agreed(number as f64) as usize)
}

/// The elastic body on coarser cells.
pub(super) struct Coarser {
    pub operators: Operators,
    /// Numbers of vectors of the smaller and the larger basis for a rough tolerance.
    pub vectors: [usize; 2],
}

/// Reduces a plate of viscoelastic layers on its present cells or, if they are too coarse, on finer ones. Collective.
///
/// # Errors
/// Same as [`fit`](super::cells::fit).
pub(super) fn fit(
    making: &Making,
    scene: &Scene,
    theory: Model,
    mut built: Operators,
    coarser: Option<Coarser>,
) -> Result<Fitted> {
    let allowed = CELL_SHARE * scene.tolerance;
    let Some(found) = found(making, scene, theory, &built, (coarser, allowed))? else {
        return refine(making, scene, theory, unrefined(making, scene, built)?, Errors::default());
    };
    let served = found.first_vectors(making, &built, scene);
    if found.size < 1.0 {
        match build(making, scene, theory, found.size)? {
            Built::Operators(finer) => built = finer,
            Built::Given(_) => return Err(Error::Solve("a plate has unknowns".into())),
        }
    }
    let relaxing = fitted(making, scene, built, (found.size, Some(served)))?;
    Ok(Fitted { error: Some(found.error), ..relaxing })
}

/// The cells for bodies of a sweep, chosen as [`fit`] does; `None` if the cells are few, or if there are no coarser cells
/// to compare with. Collective.
///
/// # Errors
/// Same as [`fit`](super::cells::fit).
pub(super) fn cell_size(making: &Making, scene: &Scene, theory: Model, built: &Operators) -> Result<Option<CellSize>> {
    let allowed = PART_FOR_SHARED_CELLS * CELL_SHARE * scene.tolerance;
    let found = found(making, scene, theory, built, (None, allowed))?;
    Ok(found.map(|found| {
        let evaluator = built.evaluator.as_ref();
        let error = with_averaging(evaluator, None, found.error);
        CellSize { size: found.size, error, local_field: local_field_errors(scene, theory, evaluator, None) }
    }))
}

/// Chooses the cells for an allowed discretisation error; `None` if the cells are few, or if there are no coarser cells
/// on which the elastic body can be computed.
fn found(
    making: &Making,
    scene: &Scene,
    theory: Model,
    built: &Operators,
    (coarser, allowed): (Option<Coarser>, f64),
) -> Result<Option<Found>> {
    let (Assembled::Local(body), Some(cells)) = (&built.body, built.cells) else { return Ok(None) };
    let stand_in = Operators {
        body: Assembled::Local(Box::new(body.with_secant_moduli(scene.impactor.moduli_time()))),
        discretisation: String::new(),
        cells: built.cells,
        cell_over_disc: built.cell_over_disc,
        evaluator: None,
        measures: None,
    };
    // The error on few cells does not follow an order of convergence.
    let coarser_cells = match &coarser {
        Some(coarser) => coarser.operators.cells,
        None => cells_of_grid(scene, theory, COARSER_CELL_FACTOR),
    };
    let has_parts = has_parts(scene);
    if !has_parts && coarser_cells.is_none_or(|coarser| are_few(cells, coarser)) {
        return Ok(None);
    }
    let (elastic, watch) = (elastic(scene), making.watch);
    let served = coarser.as_ref().map(|coarser| coarser.vectors);
    let fine = fitted(making, &elastic, stand_in, (1.0, served))?;
    let coarse = match coarser {
        _ if has_parts => judge_of(making, &elastic, theory, &fine),
        Some(coarser) => on_cells_built(making, &elastic, &fine, coarser.operators),
        None => on_coarser_cells(making, &elastic, theory, &fine),
    };
    let coarse = match coarse {
        Ok(Some(judge)) => judge,
        Ok(None) | Err(Error::Solve(_)) => return Ok(None),
        Err(error) => return Err(error),
    };
    let difference = watch.shared(fine.on_short_basis(&elastic, coarse.vectors))?.difference(&coarse.force);
    let error = coarse.errors(cells, &elastic, theory, difference);
    let vectors = agreed(self::vectors(&fine.reduced, scene), watch);
    tracing::info!(size = fine.size, unknowns = fine.unknowns, first_contact = error.first_contact, "elastic cells");
    let over = watch.agreed(error.of(scene.measure) / allowed);
    if over <= 1.0 || making.keeps_cells {
        return Ok(Some(Found { size: 1.0, error, vectors }));
    }
    let finer = over.recip().powf(ORDER.recip());
    let mut size = FINER_CELL_FACTORS[1];
    while !has_parts && finer >= FINER_CELL_FACTORS[0] && size >= FINER_CELL_FACTORS[0] {
        // Numbers of cells are integers: sizes that give the same numbers are skipped.
        if let Some(finer) = cells_of_grid(scene, theory, size).filter(|finer| *finer != cells) {
            // Histories with different contacts do not follow an order of convergence.
            let of_finer = coarse.errors_on_finer((cells, error), finer, &elastic, theory);
            let of_histories = if error.history <= scene.tolerance { of_finer } else { error };
            let Errors { history, deflection, .. } = of_histories;
            let of_finer = Errors { history, deflection, ..of_finer };
            if watch.decided(of_finer.of(scene.measure) <= allowed) {
                return Ok(Some(Found { size, error: of_finer, vectors }));
            }
        }
        size *= FINER_CELL_FACTORS[1];
    }
    // The required size is too far from the present one for an extrapolation.
    let Fitted { size, error, reduced, .. } = refine(making, &elastic, theory, fine, of_other_bases(scene))?;
    let vectors = agreed(self::vectors(&reduced, scene), watch);
    Ok(error.map(|error| Found { size, error, vectors }))
}
