//! Plans a stability study: the time steps of each scheme and the end time of the runs, within a work budget of some
//! minutes.

/// Number of steps per contact of the finest reference. The runs of the study begin at twice its step.
const FINEST_STEPS_PER_CONTACT: f64 = 1024.0;

/// Number of steps per contact of the coarsest run.
const COARSEST: f64 = 1.0;

/// Largest number of times that the reference's step is doubled to save work.
const DOUBLINGS: u32 = 3;

/// Budget of a study, unknowns times implicit steps: some minutes on one core.
const BUDGET: f64 = 2e8;

/// Least number of unknowns assumed for the cost of a step. It stands for the fixed cost of a step of a small body.
const MIN_UNKNOWNS: f64 = 1000.0;

/// Cost of an explicit step, which solves no system, relative to an implicit one.
const EXPLICIT: f64 = 0.25;

/// Least duration of a run after the first touch, in contact times, unless the scene ends earlier.
const LEAST_CONTACTS: f64 = 1.5;

/// Steps, relative to the stability limit, that are added to the ladder: one that should be stable and one that should
/// not.
const AROUND: [f64; 2] = [0.95, 1.05];

/// Upper bound of the ladder's finest step, relative to the stability limit of the scheme.
const BELOW: f64 = 0.7;

/// Properties of a scheme that its plan depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Demand {
    /// Theoretical stability limit of the time step, s: infinite if always stable, 0 if never.
    pub limit: f64,
    /// Whether the scheme uses the lumped mass, and so needs a separate reference.
    pub is_explicit: bool,
}

/// Properties of a scene that a study is planned from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Occasion {
    /// Contact time on a half-space, s.
    pub contact: f64,
    /// Time to the first touch, s.
    pub touch: f64,
    /// The scene's end, s.
    pub end: f64,
    /// Time step of the scene, s. The ladder is shifted so that it contains this step.
    pub step: Option<f64>,
    /// Unknowns of the body.
    pub unknowns: usize,
}

/// Planned steps and end time of a study.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Plan {
    /// End of the runs, s.
    pub end: f64,
    /// Step of the reference, s.
    pub reference: f64,
    /// Step of the reference with the lumped mass, s; `None` if no such reference is needed or affordable.
    pub explicit_reference: Option<f64>,
    /// Steps of each scheme, s, ascending.
    pub steps: Vec<Vec<f64>>,
    /// Messages about what was left out, and why.
    pub notes: Vec<String>,
}

impl Plan {
    /// Plans a study of the given schemes.
    pub(super) fn new(occasion: &Occasion, demands: &[Demand]) -> Self {
        let Occasion { contact, touch, end, unknowns, .. } = *occasion;
        let affordable = BUDGET / (unknowns as f64).max(MIN_UNKNOWNS);
        let floor = end.min(touch + LEAST_CONTACTS * contact);
        let mut plan = (0..=DOUBLINGS)
            .map(|doublings| Self::at(occasion, demands, (doublings, 0.5 * affordable / floor)))
            .find(|plan| plan.cost(demands) * floor <= affordable)
            .unwrap_or_else(|| Self::at(occasion, demands, (DOUBLINGS, 0.5 * affordable / floor)));
        if plan.reference > 1.5 * occasion.base() {
            let finest = 2.0 * plan.reference;
            plan.notes.push(format!("the ladder begins at {finest:.3e} s, {:.0} steps a contact", contact / finest));
        }
        plan.end = (affordable / plan.cost(demands)).clamp(floor, end);
        if plan.end < end {
            plan.notes.push(format!(
                "runs end at {:.3e} s, not at the scene's {end:.3e} s, to keep the study within some minutes",
                plan.end
            ));
        }
        plan
    }

    /// The plan whose reference step is doubled `doublings` times. Steps below a limit are left out if they cost more
    /// than `most` implicit steps per second of simulated time.
    fn at(occasion: &Occasion, demands: &[Demand], (doublings, most): (u32, f64)) -> Self {
        let base = f64::from(1 << doublings) * occasion.base();
        let mut plan =
            Self { end: occasion.end, reference: base, explicit_reference: None, steps: Vec::new(), notes: Vec::new() };
        for demand in demands {
            let has_limit = demand.limit > 0.0 && demand.limit.is_finite();
            let wanted = if has_limit { finest(base, demand.limit) } else { 2.0 * base };
            let reference = demand.is_explicit.then_some(base.min(0.5 * wanted));
            let is_affordable = demand.weight() * (1.0 / wanted + reference.map_or(0.0, f64::recip)) <= most;
            let mut steps = Vec::new();
            if has_limit && is_affordable {
                steps.extend(AROUND.map(|part| part * demand.limit));
            } else if !is_affordable {
                plan.notes.push(format!(
                    "steps below the limit of {:.3e} s are left out: they are too many ({:.1e} a contact)",
                    demand.limit,
                    occasion.contact / demand.limit
                ));
            }
            let mut step = if is_affordable { wanted } else { 2.0 * base };
            while step <= (1.0 + 1e-9) * occasion.contact / COARSEST && step <= 0.5 * occasion.end {
                // The steps around the limit replace steps of the ladder close to them.
                let is_near = |other: &f64| (step / other).ln().abs() < 1.2_f64.ln();
                if !steps.iter().any(is_near) {
                    steps.push(step);
                }
                step *= 2.0;
            }
            steps.sort_by(f64::total_cmp);
            plan.steps.push(steps);
            if is_affordable {
                plan.explicit_reference = plan.explicit_reference.or(reference);
            }
        }
        plan
    }

    /// Number of implicit steps per second of simulated time that cost as much as all runs together. Runs beyond the
    /// stability limit are not counted, because they are stopped early.
    fn cost(&self, demands: &[Demand]) -> f64 {
        let runs = self.steps.iter().zip(demands).flat_map(|(steps, demand)| {
            let limit = if demand.limit == 0.0 { f64::INFINITY } else { demand.limit };
            steps.iter().filter(move |step| **step <= limit).map(|step| demand.weight() / step)
        });
        let references = 1.0 / self.reference + self.explicit_reference.map_or(0.0, |step| EXPLICIT / step);
        runs.sum::<f64>() + references
    }
}

impl Demand {
    /// Cost of a step relative to an implicit one.
    fn weight(&self) -> f64 {
        if self.is_explicit { EXPLICIT } else { 1.0 }
    }
}

impl Occasion {
    /// Finest reference step, s: about 1/[`FINEST_STEPS_PER_CONTACT`] of a contact. If the scene gives a step, the result is that step
    /// times a power of two.
    fn base(&self) -> f64 {
        let base = self.contact / FINEST_STEPS_PER_CONTACT;
        self.step.map_or(base, |step| step / (step / base).log2().round().exp2())
    }
}

/// The largest step of the ladder on `base` that is at most [`BELOW`] times the limit, and at most twice the base.
fn finest(base: f64, limit: f64) -> f64 {
    let mut step = 2.0 * base;
    while step > BELOW * limit {
        step *= 0.5;
    }
    step
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALWAYS: Demand = Demand { limit: f64::INFINITY, is_explicit: false };
    const NEVER: Demand = Demand { limit: 0.0, is_explicit: false };
    const SMALL: Occasion = Occasion { contact: 1e-3, touch: 0.0, end: 4e-3, step: None, unknowns: 3000 };

    fn explicit(limit: f64) -> Demand {
        Demand { limit, is_explicit: true }
    }

    fn implicit(limit: f64) -> Demand {
        Demand { limit, is_explicit: false }
    }

    #[test]
    fn the_ladder_goes_from_half_a_thousandth_of_a_contact_to_the_contact() {
        let plan = Plan::new(&SMALL, &[ALWAYS, NEVER]);
        assert_eq!((plan.end, plan.notes.len(), plan.explicit_reference), (SMALL.end, 0, None));
        for steps in &plan.steps {
            assert_eq!(steps.len(), 10);
            assert!((steps[9] / SMALL.contact - 1.0).abs() < 1e-12);
            assert!(steps.windows(2).all(|pair| (pair[1] / pair[0] - 2.0).abs() < 1e-12));
            assert!((steps[0] / plan.reference - 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_scenes_step_is_one_of_the_ladder() {
        for step in [1e-5, 2.7e-5, 3e-7] {
            let plan = Plan::new(&Occasion { step: Some(step), ..SMALL }, &[ALWAYS]);
            let off = (step / plan.reference).log2();
            assert!((off - off.round()).abs() < 1e-9, "{step}");
            assert!((SMALL.contact / plan.reference / FINEST_STEPS_PER_CONTACT).log2().abs() < 0.51);
        }
    }

    /// The plan has steps below a limit, close to it on both sides, and above; and a finer reference with the lumped
    /// mass.
    #[test]
    fn limits_are_bracketed() {
        for limit in [4e-7, 1.3e-6, 4e-5] {
            let plan = Plan::new(&SMALL, &[implicit(limit), explicit(limit)]);
            for steps in &plan.steps {
                let below = steps.iter().filter(|step| **step < 0.94 * limit).count();
                assert!(below >= 1 && steps[0] <= BELOW * limit, "{limit}: {steps:?}");
                for part in AROUND {
                    assert!(steps.iter().any(|step| (step / limit - part).abs() < 1e-12));
                }
                assert!(steps.windows(2).all(|pair| pair[1] > 1.09 * pair[0]), "{steps:?}");
            }
            assert!(plan.explicit_reference.unwrap() <= 0.5 * plan.steps[1][0]);
        }
    }

    /// For any number of unknowns the work stays within the budget, first by an earlier end, then by coarser steps; a
    /// note says so.
    #[test]
    fn large_bodies_get_fewer_steps() {
        for unknowns in [10, 3000, 30_000, 150_000] {
            let demands = [ALWAYS, ALWAYS, ALWAYS, NEVER, implicit(3e-6), explicit(1e-6)];
            let plan = Plan::new(&Occasion { unknowns, end: 0.1, ..SMALL }, &demands);
            let work = plan.cost(&demands) * plan.end * (unknowns as f64).max(MIN_UNKNOWNS);
            assert!(work <= 1.001 * BUDGET || plan.reference > 7.9 * SMALL.base(), "{unknowns}: {work:e}");
            assert!(plan.end >= LEAST_CONTACTS * SMALL.contact && !plan.notes.is_empty());
            assert_eq!(plan.reference > 1.5 * SMALL.base(), plan.notes.iter().any(|note| note.contains("ladder")));
        }
        let plan = Plan::new(&SMALL, &[ALWAYS, explicit(1e-10)]);
        assert_eq!((plan.explicit_reference, plan.steps[1].len(), plan.notes.len()), (None, 10, 1));
    }
}
