//! Cells of layers that relax, judged by the elastic body that the layers are at half the time of a contact with a half-space.
//!
//! What cells leave is in the waves and in the field at the hit, which that body has, too. Its modes cost a small part of those of the body that relaxes, which is
//! then made once, on cells that serve. Where the first ones do not, finer ones are made by how errors fall with the size of cells, and their error is
//! taken to fall so: a fitted estimate.

use petsc_wrap::Comm;

use super::cells::{
    CellSize, FINER, Fitted, OF_CELLS, ORDER, fitted, of_other_bases, on_coarser_cells, refine, unrefined,
    with_local_fields,
};
use super::reduce::{OF_BASIS, OF_SMALLER_RELAXING, Reduced, larger, rate};
use super::theory::{Built, Operators, build, cells_of_plate};
use super::watch::Watch;
use crate::body::{Assembled, rates};
use crate::description::Description;
use crate::error::{Error, Result};
use crate::impact::Errors;
use crate::scene::{Body, Layer, Model, Parts, Scene};
use crate::space::plate::OF_CONTACT;

/// A scene whose layers are elastic, with the moduli of half the contact's time.
pub(super) fn elastic(scene: &Scene) -> Scene {
    let composition = scene.body.composition.elastic_at(time(scene));
    Scene { body: Body { composition, ..scene.body.clone() }, ..scene.clone() }
}

fn time(scene: &Scene) -> f64 {
    OF_CONTACT * scene.impactor.contact_time()
}

/// The part of the modulus at half the contact that is left at the end, from which on one modulus judges the cells of both: 0.65 to 1 of a chain as of
/// PVB. Plies that come apart have shorter waves.
const LEFT_AT_END: f64 = 0.5;

/// Whether a scene's layers relax, and its cells are judged so.
pub(super) fn serves(scene: &Scene, theory: Model) -> bool {
    let is_layered = theory == Model::Layerwise && scene.body.composition.uniform().is_none();
    // What relaxes on a face is read there with other moduli. Layers that are alike then are a plate of another theory.
    let Parts::Layers(layers) = &scene.body.composition.parts else { return false };
    let has_elastic_faces =
        [layers.first(), layers.last()].into_iter().flatten().all(|face| face.material.shear.is_none());
    let [at_first, at_last] = [time(scene), scene.time.end];
    let keeps_much = |layer: &Layer| {
        layer.material.shear.as_ref().is_none_or(|chain| chain.at(at_last) >= LEFT_AT_END * chain.at(at_first))
    };
    is_layered
        && has_elastic_faces
        && layers.iter().all(keeps_much)
        && scene.time.modal
        && !Description::new(scene).relaxations().is_empty()
}

/// Cells that serve.
struct Found {
    /// Their size over that by the rule of thumb.
    size: f64,
    /// What they leave.
    error: Errors,
    /// How many vectors the elastic body needs where the smaller of two bases is used.
    vectors: usize,
}

impl Found {
    /// Numbers of vectors of the body that relaxes with which its basis begins.
    fn first_vectors(&self, built: &Operators, scene: &Scene) -> [usize; 2] {
        // A first guess too: a body whose shapes change while it relaxes needs more vectors.
        let is_at_one_rate = rates(&built.body.linear().chains(), rate(scene), scene.time.end).len() == 1;
        let fewer = if is_at_one_rate { self.vectors } else { larger(self.vectors) };
        [fewer, larger(fewer)]
    }
}

/// Vectors of a body that relaxes over those of the elastic one: a first guess, of one pane. More are made where these leave too much.
const MORE: f64 = 1.1;

/// The number of vectors with which the basis meets its part of the tolerance, as errors fall with the square of it.
fn vectors(reduced: &Reduced, scene: &Scene) -> usize {
    let [fewer, more] = reduced.counts();
    if reduced.of_difference == 0.0 {
        return more;
    }
    let error = OF_SMALLER_RELAXING * reduced.difference.of(scene.measure);
    let needed = MORE * fewer as f64 * (error / (OF_BASIS * scene.tolerance)).sqrt();
    (needed.ceil() as usize).clamp(fewer, more)
}

/// Reduces a plate of layers that relax on the cells that it has, or on finer ones where these leave too much; `vectors` are numbers that
/// served for a like elastic body. Collective.
///
/// # Errors
/// Those of [`fit`](super::cells::fit).
pub(super) fn fit(
    comm: &Comm,
    scene: &Scene,
    theory: Model,
    mut built: Operators,
    vectors: Option<[usize; 2]>,
    watch: &dyn Watch,
) -> Result<Fitted> {
    let Some(found) = found(comm, scene, theory, &built, vectors, watch)? else {
        return refine(comm, scene, theory, unrefined(comm, scene, built, watch)?, Errors::default(), watch);
    };
    let served = found.first_vectors(&built, scene);
    if found.size < 1.0 {
        match build(comm, scene, theory, found.size, watch)? {
            Built::Operators(finer) => built = finer,
            Built::Given(_) => return Err(Error::Solve("a plate has unknowns".into())),
        }
    }
    let relaxing = fitted(comm, scene, built, (found.size, Some(served)), watch)?;
    let error = with_local_fields(scene, relaxing.evaluator.as_ref(), found.error);
    Ok(Fitted { error: Some(error), ..relaxing })
}

/// The cells that [`fit`] finds; `None` where there are no coarser ones. Collective.
///
/// # Errors
/// Those of [`fit`](super::cells::fit).
pub(super) fn cell_size(
    comm: &Comm,
    scene: &Scene,
    theory: Model,
    built: &Operators,
    watch: &dyn Watch,
) -> Result<Option<CellSize>> {
    let found = found(comm, scene, theory, built, None, watch)?;
    Ok(found.map(|found| {
        let vectors = Some(found.first_vectors(built, scene));
        CellSize { size: found.size, error: found.error, vectors }
    }))
}

/// `None` where there are no coarser cells that the elastic body could be compared on.
fn found(
    comm: &Comm,
    scene: &Scene,
    theory: Model,
    built: &Operators,
    served: Option<[usize; 2]>,
    watch: &dyn Watch,
) -> Result<Option<Found>> {
    let (Assembled::Local(body), Some(cells)) = (&built.body, built.cells) else { return Ok(None) };
    let stand_in = Operators {
        body: Assembled::Local(Box::new(body.elastic_at(time(scene)))),
        words: String::new(),
        cells: built.cells,
        cell_over_disc: built.cell_over_disc,
        evaluator: None,
        measures: None,
    };
    let elastic = elastic(scene);
    let fine = fitted(comm, &elastic, stand_in, (1.0, served), watch)?;
    let coarse = match on_coarser_cells(comm, &elastic, theory, &fine, watch) {
        Ok(Some(judge)) => judge,
        Ok(None) | Err(Error::Solve(_)) => return Ok(None),
        Err(error) => return Err(error),
    };
    let difference = watch.shared(fine.on_short_basis(&elastic, coarse.vectors))?.difference(&coarse.force);
    let error = coarse.errors(cells, &elastic, theory, difference);
    let vectors = watch.agreed(self::vectors(&fine.reduced, scene) as f64) as usize;
    tracing::info!(size = fine.size, unknowns = fine.unknowns, first_contact = error.first_contact, "elastic cells");
    let over = watch.agreed(error.of(scene.measure) / (OF_CELLS * scene.tolerance));
    if over <= 1.0 {
        return Ok(Some(Found { size: 1.0, error, vectors }));
    }
    let finer = over.recip().powf(ORDER.recip());
    let mut size = finer.min(FINER[1]);
    while finer >= FINER[0] && size >= FINER[0] {
        // Cells are whole numbers: sizes that give the same ones are passed over.
        if let Some(finer) = cells_of_plate(scene, theory, size).filter(|finer| *finer != cells) {
            // (Histories with other contacts say nothing of an order.)
            let of_finer = coarse.errors_on_finer((cells, error), finer, &elastic, theory);
            let history = if error.history <= scene.tolerance { of_finer.history } else { error.history };
            if watch.decided(of_finer.of(scene.measure) <= OF_CELLS * scene.tolerance) {
                return Ok(Some(Found { size, error: Errors { history, ..of_finer }, vectors }));
            }
        }
        size *= FINER[1];
    }
    // Too far to tell by one difference.
    let Fitted { size, error, reduced, .. } = refine(comm, &elastic, theory, fine, of_other_bases(scene), watch)?;
    let vectors = watch.agreed(self::vectors(&reduced, scene) as f64) as usize;
    Ok(error.map(|error| Found { size, error, vectors }))
}
