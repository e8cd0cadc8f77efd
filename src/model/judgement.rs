//! Judges a basis: estimates its error from the contact force on a smaller one.

use crate::body::{InfinitePlate, Projection, Start};
use crate::error::Result;
use crate::impact::{ErrorRule, Errors};
use crate::scene::{Reduction, Scene};

use super::context::ModelContext;
use super::error_factors::ErrorFactors;
use super::long_waves::ORDER;
use super::reduce::BASIS_SHARE;
use super::trials::{Trial, Trials};
use super::watch::Judged;

/// Share of the tolerance for the basis if short waves are treated separately. It is [`BASIS_SHARE`] times [`LONG_WAVES_MARGIN`],
/// so that this factor does not enlarge the basis.
const BASIS_SHARE_OF_LONG_WAVES: f64 = LONG_WAVES_MARGIN * BASIS_SHARE;

/// Safety factor on the error of a basis without short waves, which is extrapolated from the difference to a smaller
/// basis by the order of convergence. The error over this extrapolation was 0.4 to 1.5 on twenty free panes.
const LONG_WAVES_MARGIN: f64 = 1.55;

/// Error of a basis without short waves that the difference does not show, over the tolerance. On three free panes whose contact ends
/// before the first echo, the errors were at most 0.1 of a tolerance of 1e-2, and up to twice what the difference shows.
const UNSEEN_OF_LONG_WAVES: f64 = 0.1;

/// Error of the deflection over its largest value, above which the deflection is of little use. A basis with a low shift
/// must have an estimated error below [`BASIS_SHARE`] times this value, if the tolerance applies to another quantity.
pub const LARGE_ERROR_OF_DEFLECTION: f64 = 0.1;

/// Error of the largest tension over its peak, above which the tension is of little use.
pub const LARGE_ERROR_OF_TENSION: f64 = 0.1;

/// Largest [`cost`] of a basis that is enlarged, or made again, to limit the error of the deflection. A plate of this cost
/// takes about a second, a laminate up to four.
pub(super) const LARGEST_COST_FOR_DEFLECTIONS: f64 = 4e8;

/// Measure of the cost of a basis: unknowns times the square of the number of vectors.
pub(super) fn cost(unknowns: usize, vectors: usize) -> f64 {
    unknowns as f64 * (vectors as f64).powi(2)
}

/// Differences of histories, over the peak, from which they do not measure errors: one history then has contacts that
/// the other lacks.
pub const OTHER_CONTACTS: f64 = 0.3;

/// Number of vectors of the second basis for comparison, over that of the basis, if the histories have different
/// contacts.
const HISTORY_BASIS_FRACTION: f64 = 0.875;

/// Settings of the error estimate of a basis.
pub(super) struct Rule<'a> {
    pub(super) context: &'a ModelContext<'a>,
    pub(super) scene: &'a Scene,
    pub(super) start: Start,
    /// Number of unknowns of the body.
    pub(super) unknowns: usize,
    /// Numbers of vectors of the basis and of a smaller one.
    pub(super) vectors: usize,
    pub(super) smaller: usize,
    pub(super) factors: ErrorFactors,
    /// Infinite plate that replaces the short waves; `None` if the bases have all waves.
    pub(super) plate: Option<&'a InfinitePlate>,
}

/// Result of comparing a basis with a smaller one.
pub(super) struct Judgement {
    /// Difference of the forces on the two bases.
    pub(super) difference: Errors,
    /// Estimates the error from the difference.
    pub(super) rule: ErrorRule,
    pub(super) error: Errors,
    /// Whether the error is within its share of the tolerance.
    pub(super) is_met: bool,
    /// Whether the smaller basis is used.
    pub(super) takes_smaller: bool,
    pub(super) judged: Judged,
}

impl Rule<'_> {
    /// Compares the forces on the smaller basis (`judge`) and on the larger one (`trial`). If the larger one is
    /// accurate enough or the last, both forces are computed in its time steps, which are shortened if it needs that.
    /// Collective.
    ///
    /// # Errors
    /// Same as [`Trials::force`].
    pub(super) fn judge_on(
        &self,
        projection: &Projection,
        [judge, trial]: [&mut Trial; 2],
        trials: &mut Trials,
        is_last: bool,
    ) -> Result<Judgement> {
        let judgement = self.judge(judge.force.difference(&trial.force));
        if !(is_last || judgement.is_met) {
            return Ok(judgement);
        }
        trials.shorten_steps(projection, trial)?;
        if !self.context.watch.decided(judge.steps != trial.steps) {
            return Ok(judgement);
        }
        *judge = trials.force_on(judge.modal.take(), trial.steps, &projection.leading(self.smaller))?;
        Ok(self.judge(judge.force.difference(&trial.force)))
    }

    /// Estimates the error from the difference of the two forces. Collective.
    fn judge(&self, difference: Errors) -> Judgement {
        let Self { context, scene, start, vectors, smaller, factors, .. } = *self;
        let share = if start.leaves_short_waves { BASIS_SHARE_OF_LONG_WAVES } else { BASIS_SHARE };
        let wanted = share * scene.tolerance;
        let is_given = matches!(scene.body.reduction, Reduction::Vectors(_));
        let is_small_enough = || context.watch.decided(factors.smaller * difference.of(scene.measure) <= wanted);
        let (of_difference, takes_smaller) = match factors.larger {
            _ if start.leaves_short_waves => (self.of_larger(smaller), false),
            Some(larger) if !is_given && !is_small_enough() => (larger, false),
            _ => (factors.smaller, true),
        };
        let rule = self.rule(of_difference);
        let error = rule.errors(difference);
        let mut over = error.of(scene.measure) / wanted;
        // If the histories have different contacts, a larger basis may not lower the error of the deflection.
        let is_limited = context.limits_deflection_error && error.history <= OTHER_CONTACTS;
        if is_limited && cost(self.unknowns, vectors) <= LARGEST_COST_FOR_DEFLECTIONS {
            // The maximum ignores NaN: the deflection then has no estimate.
            over = over.max(error.deflection / (BASIS_SHARE * LARGE_ERROR_OF_DEFLECTION));
        }
        let over = context.watch.agreed(over);
        let judged = Judged { vectors: if takes_smaller { smaller } else { vectors }, error: over * wanted, wanted };
        tracing::debug!(vectors, smaller, error = judged.error, wanted, "bases compared");
        Judgement { difference, rule, error, is_met: over <= 1.0, takes_smaller, judged }
    }

    /// Factor from the difference of two bases to the error of the larger one, if short waves are treated separately.
    /// The error is proportional to ω_c to the power −[`ORDER`].
    fn of_larger(&self, smaller: usize) -> f64 {
        let growth = match self.plate {
            Some(plate) => plate.cutoff(self.vectors) / plate.cutoff(smaller),
            None => self.vectors as f64 / smaller as f64,
        };
        LONG_WAVES_MARGIN * (growth.powf(ORDER) - 1.0).recip()
    }

    /// The rule with a factor from the difference to the error.
    fn rule(&self, of_difference: f64) -> ErrorRule {
        let unseen = if self.start.leaves_short_waves { UNSEEN_OF_LONG_WAVES * self.scene.tolerance } else { 0.0 };
        ErrorRule { least: unseen, ..ErrorRule::with_factor(of_difference) }
    }

    /// If short waves are treated separately and the two histories have different contacts, estimates the error of the
    /// whole history by comparing the larger basis with one of 7/8 of its vectors. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub(super) fn closer(
        &self,
        mut error: Errors,
        projection: &Projection,
        trial: &Trial,
        trials: &Trials,
    ) -> Result<Errors> {
        let Self { context, start, vectors, smaller, .. } = *self;
        let has_other_contacts = || context.watch.decided(error.history > OTHER_CONTACTS * self.of_larger(smaller));
        if start.leaves_short_waves && has_other_contacts() {
            let near = projection.leading((HISTORY_BASIS_FRACTION * vectors as f64) as usize);
            let force = trials.force_in(trial.steps, &near)?.force;
            let rule = self.rule(self.of_larger(near.vectors()));
            let closer = rule.errors(force.difference(&trial.force));
            (error.history, error.deflection) = (closer.history, closer.deflection);
        }
        Ok(error)
    }
}
