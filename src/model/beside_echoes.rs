//! Reduces a plate whose short waves are computed in closed form to a basis of its longer waves.
//!
//! The modes above ω_c in closed form neglect the waves that corners scatter, so that the error falls slowly with the
//! number of vectors. The force is compared with that on half as many modes of the same basis: modes in closed form
//! take the place of the others. The difference shows the error of that octave, and modes near ω_c that the basis does
//! not resolve.

use petsc_wrap::Comm;

use crate::body::{DirectSum, LinearBody, Projection};
use crate::error::{Error, Result};
use crate::impact::{ErrorRule, Errors};
use crate::scene::Scene;

use super::reduce::{MAX_VECTORS_PER_CLASS, Plan, Reduced, grow};
use super::trials::{Trial, Trials};
use super::watch::{Judged, Watch};

/// Error of the force over its difference from that on half as many modes. Measured on forty panes, where that
/// difference is above 1e-3 of the peak: 0.1 to 0.65. An estimate.
const ERROR_OVER_DIFFERENCE: f64 = 0.85;

/// The same on laminates. With 0.85, the error was 0.1 to 1.0 times the estimated error of basis and cells on twenty laminates. On
/// one with a long contact it was 1.3 times it, which includes the error of the reference. An estimate.
const LAMINATE_ERROR_OVER_DIFFERENCE: f64 = 1.3;

/// The same after the first contact: errors of earlier contacts add to those of later ones. Measured on eleven panes
/// with several contacts: 0.5 to 1.15. An estimate.
const HISTORY_ERROR_OVER_DIFFERENCE: f64 = 1.3;

/// Error of the largest tension near its peak over its difference from that on half as many modes. Measured on the same
/// panes: 0.3 to 1.1. An estimate.
const TENSION_ERROR_OVER_DIFFERENCE: f64 = 1.5;

/// Error that remains where there are no echoes yet. Measured on a free pane with a contact shorter than its first
/// echo: 3e-4 to 5e-4.
const LEAST_ERROR: f64 = 5e-4;

/// Order of convergence of that difference in the number of vectors, for the size of the next basis. Measured on the
/// same panes: 0.8 to 2.1.
const ORDER: f64 = 1.6;

/// Share of the tolerance for the error of the basis. The cells of such plates have smaller errors than those of other
/// bodies.
const SHARE: f64 = 0.85;

/// Least growth of the number of vectors from one basis to the next.
const LEAST_GROWTH: f64 = 1.1;

/// Largest number of vectors over the planned one. The cells do not carry the waves of a larger basis.
const MAX_OVER_PLANNED: usize = 2;

/// Growth of the number of vectors if the impact cannot be solved.
const GROWTH_IF_UNSOLVED: f64 = 2.0;

/// Reduces a body to the basis that the scene's impact needs, or to the largest basis that the cells carry. The first
/// basis has the planned number of vectors, or the number that `served` a similar body. Collective.
///
/// # Errors
/// Same as [`reduce`](super::reduce::reduce).
pub(super) fn reduce(
    comm: &Comm,
    body: &dyn LinearBody,
    scene: &Scene,
    plan: &Plan,
    served: Option<usize>,
    watch: &dyn Watch,
) -> Result<Reduced> {
    let wanted = SHARE * scene.tolerance;
    let is_laminate = scene.body.composition.uniform().is_none();
    let factors = Errors {
        first_contact: if is_laminate { LAMINATE_ERROR_OVER_DIFFERENCE } else { ERROR_OVER_DIFFERENCE },
        history: HISTORY_ERROR_OVER_DIFFERENCE,
        stress: TENSION_ERROR_OVER_DIFFERENCE,
        stress_history: TENSION_ERROR_OVER_DIFFERENCE,
        deflection: HISTORY_ERROR_OVER_DIFFERENCE,
    };
    let rule = ErrorRule { factors, least: LEAST_ERROR };
    let mut krylov = DirectSum::new(body, plan.start)?;
    let mut trials = Trials::new(comm, scene, watch);
    let mut last: Option<Judged> = None;
    let most = (MAX_OVER_PLANNED * plan.vectors).min(MAX_VECTORS_PER_CLASS * body.classes().len());
    let mut count = served.unwrap_or(plan.vectors).min(most);
    loop {
        grow(&mut krylov, body, count, last, watch)?;
        let projection = krylov.projection(body)?;
        count = projection.vectors();
        let is_last = watch.decided(count >= most || krylov.is_exhausted());
        let mut growth = GROWTH_IF_UNSOLVED;
        match compare(&mut trials, &projection) {
            Ok(Compared { trial, judge, of_judge }) => {
                let Trial { force, steps, modal, known } = trial;
                let difference = of_judge.force.difference(&force);
                let error = rule.errors(difference);
                let over = watch.agreed(error.of(scene.measure) / wanted);
                if over <= 1.0 || is_last {
                    tracing::info!(vectors = count, first = error.first_contact, all = error.history, "reduced");
                    return Ok(Reduced {
                        projection,
                        judge,
                        force_of_judge: of_judge.force,
                        rule,
                        difference,
                        krylov,
                        error,
                        force: (force, steps),
                        modal,
                        modal_of_judge: of_judge.modal,
                        known,
                    });
                }
                last = Some(Judged { vectors: count, error: over * wanted, wanted });
                growth = over.powf(1.0 / ORDER).max(LEAST_GROWTH);
            }
            // A basis that is too small may be too soft or too stiff for the contact law.
            Err(Error::Solve(_)) if !is_last => {}
            Err(error) => return Err(error),
        }
        count = ((growth * count as f64).ceil() as usize).min(most);
    }
}

/// A basis and the same basis with half as many modes.
struct Compared {
    trial: Trial,
    judge: Projection,
    of_judge: Trial,
}

/// The force on a basis and on half as many modes. Collective.
///
/// # Errors
/// Same as [`Trials::force`].
fn compare(trials: &mut Trials, projection: &Projection) -> Result<Compared> {
    let mut trial = trials.force(projection)?;
    trials.shorten_steps(projection, &mut trial)?;
    let judge = projection.with_half_the_modes();
    let of_judge = trials.force_in(trial.steps, &judge)?;
    Ok(Compared { trial, judge, of_judge })
}
