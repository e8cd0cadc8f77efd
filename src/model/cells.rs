//! Cells of splines as fine as a scene needs, with the error that they leave.
//!
//! What cells a tolerance takes goes with the length of the contact and what comes back from the edges, and is known by a rule of thumb
//! only. So the force is computed on coarser cells too, on a basis as large.

use petsc_wrap::Comm;

use super::reduce::{Plan, Reduced, force, grow, reduce};
use super::theory::{Built, Operators, build};
use super::watch::{Stage, Watch};
use crate::body::{DirectSum, ModalBody};
use crate::error::{Error, Result};
use crate::impact::{Errors, ModalImpact, Trace};
use crate::mesh::Measures;
use crate::scene::{Model, Scene};
use crate::space::evaluate::Evaluator;
use crate::space::plate::crossing;

/// The coarser cells over the others, and finer ones over those at least and at most.
const COARSER: f64 = 1.5;
const FINER: [f64; 2] = [1.0 / COARSER, 0.85];

/// Errors fall with this power of the size, or faster: of the force, and of means of stresses (3.8 of plates at rest).
const ORDER: i32 = 3;

/// What is left of the stress under the hit however fine the cells are: by means over a disc, and by a local field that is at rest. Converged
/// tensions were measured to be 0.1% to 0.3% below those of solids, where shear waves cross the thickness in 0.005 and in 0.023 of the
/// contact time on a half-space.
const OF_LOCAL_FIELD: f64 = 3e-3;

/// The part of it that grows with the square of that ratio: waves take their time through the thickness. Set by one impact, of a ratio of
/// 0.12, whose tension was 2.8% low; an estimate.
const OF_CROSSING: f64 = 1.2;

/// Part of the tolerance that the estimate may take.
const OF_CELLS: f64 = 0.6;

/// Cells are not made finer than by this part of the rule of thumb's.
const FINEST: f64 = 0.25;

/// A body on cells and a basis.
pub struct Fitted {
    /// The body on its basis.
    pub reduced: Reduced,
    /// Unknowns before that.
    pub unknowns: usize,
    /// Whether these are of splines.
    pub is_of_splines: bool,
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

/// Vectors of a basis on which cells are compared, at most: on bases of as many vectors the errors of these are alike, and cancel.
const SHORT: usize = 800;

/// Unknowns times the square of the vectors above which no basis is made anew on finer cells, which takes as long again and longer: some
/// five seconds. What the cells leave is told with the results.
const DEAREST: f64 = 4e9;

impl Fitted {
    /// The force on the basis, or on the first vectors of a long one.
    fn on_short_basis(&self, scene: &Scene) -> Result<Trace> {
        let Reduced { projection, force: (trace, steps), .. } = &self.reduced;
        if projection.vectors() <= SHORT {
            return Ok(trace.clone());
        }
        Ok(ModalImpact::new(scene, &ModalBody::of(&projection.leading(SHORT))).trace(*steps)?.0)
    }
}

/// Reduces a body on its cells, then a body of splines in modal coordinates on finer ones where these leave too much. Collective.
///
/// # Errors
/// Those of [`reduce`] and [`build`].
pub fn fit(comm: &Comm, scene: &Scene, theory: Model, built: Operators, watch: &dyn Watch) -> Result<Fitted> {
    refine(comm, scene, theory, unrefined(comm, scene, built, watch)?, watch)
}

/// Reduces a body on the cells that it has. Collective.
///
/// # Errors
/// Those of [`reduce`].
pub fn unrefined(comm: &Comm, scene: &Scene, built: Operators, watch: &dyn Watch) -> Result<Fitted> {
    fitted(comm, scene, built, 1.0, watch)
}

/// Reduces a body of splines, in modal coordinates, on finer cells where its own leave too much. Collective.
///
/// # Errors
/// Those of [`reduce`] and [`build`].
pub fn refine(comm: &Comm, scene: &Scene, theory: Model, mut fine: Fitted, watch: &dyn Watch) -> Result<Fitted> {
    if !fine.is_of_splines || !scene.time.modal {
        return Ok(fine);
    }
    let mut coarse = match on_coarser_cells(comm, scene, theory, &fine, watch) {
        Ok(trace) => trace.map(|trace| (trace, 1.0 / COARSER)),
        // Too coarse cells may be too soft, or too stiff, for the contact law: then finer ones judge.
        Err(Error::Solve(_)) => None,
        Err(error) => return Err(error),
    };
    loop {
        let mut finer = FINER[0];
        if let Some((coarse, ratio)) = &coarse {
            let of_difference = 1.0 / (ratio.powi(-ORDER) - 1.0);
            let difference = watch.shared(fine.on_short_basis(scene))?.difference(coarse);
            let error = of_difference * difference;
            let Errors { first_contact, history, stress } = error;
            tracing::info!(size = fine.size, unknowns = fine.unknowns, first_contact, history, stress, "cells");
            // (What finer cells do not change counts for the estimate, not for the choice of cells.)
            let of_local_field = OF_LOCAL_FIELD + OF_CROSSING * crossing(scene).powi(2);
            fine.error = Some(error + Errors { stress: of_local_field, ..Errors::default() });
            let wanted = OF_CELLS * scene.tolerance;
            let over = watch.agreed(error.of(scene.measure) / wanted);
            finer = over.recip().powf(1.0 / f64::from(ORDER)).clamp(FINER[0], FINER[1]);
            let cost = fine.unknowns as f64 * (fine.reduced.projection.vectors() as f64).powi(2);
            if over <= 1.0 || finer * fine.size < FINEST || cost > DEAREST {
                return Ok(fine);
            }
        }
        let size = finer * fine.size;
        let built = match build(comm, scene, theory, size, watch) {
            Ok(Built::Operators(built)) => built,
            // More unknowns than splines are made for: what is left is told with the results.
            Ok(Built::Given(_)) | Err(Error::Fault(_)) => return Ok(fine),
            Err(error) => return Err(error),
        };
        coarse = Some((watch.shared(fine.on_short_basis(scene))?, finer));
        fine = fitted(comm, scene, built, size, watch)?;
    }
}

fn fitted(comm: &Comm, scene: &Scene, built: Operators, size: f64, watch: &dyn Watch) -> Result<Fitted> {
    let Operators { body, words, evaluator, is_of_splines, measures } = built;
    let (reduced, unknowns) = (reduce(&body, scene, watch)?, body.unknowns());
    let fitted = Fitted { reduced, unknowns, is_of_splines, words, size, error: None, evaluator, measures };
    drop(body);
    comm.collect_garbage()?;
    Ok(fitted)
}

/// The force on cells that are coarser; none where there are no coarser ones.
fn on_coarser_cells(
    comm: &Comm,
    scene: &Scene,
    theory: Model,
    fine: &Fitted,
    watch: &dyn Watch,
) -> Result<Option<Trace>> {
    let Built::Operators(built) = build(comm, scene, theory, COARSER * fine.size, watch)? else { return Ok(None) };
    if built.body.unknowns() == fine.unknowns {
        return Ok(None);
    }
    let body = built.body;
    watch.at(Stage::Factor)?;
    let mut krylov = DirectSum::new(&body, Plan::new(&body, scene).start)?;
    grow(&mut krylov, &body, fine.reduced.projection.vectors().min(SHORT), None, watch)?;
    let mut steps = fine.reduced.force.1;
    let trace = watch.shared(force(scene, &body, &krylov.projection(&body)?, &mut steps))?;
    drop((krylov, body));
    comm.collect_garbage()?;
    Ok(Some(trace))
}
