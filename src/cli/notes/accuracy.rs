//! Remarks on estimated errors: of a model before a run, and of a result after it.

use crate::impact::{Cause, ErrorEstimate, Errors, beside, estimated};
use crate::model::{self, LARGE_ERROR_OF_DEFLECTION, LARGE_ERROR_OF_TENSION, Model, OTHER_CONTACTS};
use crate::record::stress::LargestTension;
use crate::record::useless::USELESS;
use crate::scene::{Contact, Geometry, Measure, Model as Theory, Reduction, Scene};
use crate::space::spline;

use super::{counted, listed};

/// Description of the theory, its unknowns and its basis, with the estimated error of the quantity to which the
/// tolerance applies.
pub fn describe_model(model: &Model, scene: &Scene) -> String {
    let mut words = format!("{}: {}", model::name(model.theory), model.discretisation);
    if model.unknowns > 0 {
        words += &format!(", {} unknowns", model.unknowns);
    }
    if let Some(vectors) = model.vectors {
        words += &format!(", reduced to {}", counted(vectors, "vector"));
        words += if model.leaves_short_waves { ", short waves as on an infinite plate" } else { "" };
    }
    if let Some(errors) = model.error.total() {
        let causes = listed(&model.error.causes(scene.measure));
        // If the error of another quantity is not estimated, the tolerance applies to the acceleration, as a note says.
        let of_what = match scene.measure {
            Measure::Stress | Measure::Deflection if !errors.own(scene.measure).is_nan() => {
                format!("{} by {causes}", scene.of_measure())
            }
            _ => format!(" of {causes}"),
        };
        let (error, part) = (errors.of(scene.measure), scene.in_measured_part());
        words += &format!("; estimated error{of_what} {} of the peak{part}", estimated(error));
    }
    words
}

/// Error over the whole history relative to the error in the first contact, above which later times are more sensitive.
const GROWTH: f64 = 1.2;

/// Note on a basis that may lack the rotations of a free body.
pub const UNESTIMATED_ROTATIONS: &str = "the error of the deflection under the impactor is not estimated: nothing holds the body, and the basis may lack its rotations. \
                                         accuracy.quantity = \"deflection\" includes them";

/// Warning for a run whose estimated error in the first contact is above the tolerance; `None` if it is not.
pub fn verdict(model: &Model, scene: &Scene) -> Option<Verdict> {
    let tolerance = scene.tolerance;
    // False for NaN, which is not a usable estimate.
    let is_good = |error: &f64| *error <= tolerance;
    let estimate = model.error_before_steps();
    let error = estimate.total().map(|errors| errors.of(scene.measure)).filter(|error| !is_good(error))?;
    let (of_what, part) = (scene.of_measure(), scene.in_measured_part());
    let causes = estimate.causes(scene.measure);
    let of = listed(&causes);
    let message = format!(
        "the estimated error{of_what}{part} is {} of the peak, above accuracy.tolerance = {tolerance:e} (estimated for {of}); \
         {}",
        beside(error, tolerance),
        remedies_of_measure(&estimate, scene)
    );
    Some(Verdict { message, is_useless: error.is_nan() || error > USELESS })
}

/// Warning that the error of a time history is above the tolerance.
pub struct Verdict {
    /// Text of the warning.
    pub message: String,
    /// Whether the error is so large that the history is of no use.
    pub is_useless: bool,
}

/// Note that the tolerance applies to the acceleration, if the error of another quantity is not estimated.
pub fn note_of_measure(model: &Model, scene: &Scene) -> Option<String> {
    let known = match scene.measure {
        Measure::Deflection => model.error.of_deflection(),
        measure => model.error.total().map_or(f64::NAN, |errors| errors.own(measure)),
    };
    if !known.is_nan() {
        return None;
    }
    let (what, which) = match scene.measure {
        Measure::Acceleration => return None,
        Measure::Stress => (
            "stresses",
            "plates and splines in modal coordinates, hit at least 0.45 thicknesses of the impacted layer from an edge, have an estimate",
        ),
        Measure::Deflection => (
            "the deflection",
            "reduced plates and splines that the impactor touches, in modal coordinates, have an estimate",
        ),
    };
    Some(format!(
        "the error of {what} is not estimated for this body: accuracy.tolerance is for the acceleration here ({which})"
    ))
}

/// Notes on the deflection if its estimated error is large or unknown, and the tolerance applies to another quantity.
pub fn of_deflection(estimate: &ErrorEstimate, scene: &Scene) -> Vec<String> {
    let mut notes = Vec::new();
    let of_basis = estimate.of(Cause::Basis).map(|of_basis| of_basis.deflection);
    // With a contact patch, only the error by the basis is known.
    let error = estimate.of_deflection().max(of_basis.unwrap_or(f64::NAN));
    let applies = match scene.measure {
        Measure::Acceleration => "acceleration",
        Measure::Stress => "largest tension",
        Measure::Deflection => return notes,
    };
    if error > LARGE_ERROR_OF_DEFLECTION {
        // Cells that cannot be refined for the acceleration cannot be refined for the deflection either.
        let of_cells = estimate.of(Cause::Cells).unwrap_or_default();
        let is_at_limit =
            of_cells.deflection > LARGE_ERROR_OF_DEFLECTION && of_cells.of(scene.measure) > scene.tolerance;
        let remedy = match scene.body.reduction {
            Reduction::Vectors(_) => "; body.reduction = \"auto\" in place of a number may lower this error",
            _ if is_at_limit => "",
            _ => "; accuracy.quantity = \"deflection\" may lower this error",
        };
        notes.push(format!(
            "{}. Deflections elsewhere may have errors as large. accuracy.tolerance applies to the {applies} only{remedy}",
            of_large_deflection_error(error)
        ));
    }
    if of_basis.is_some_and(f64::is_nan) && model::may_lack_rotations(scene) {
        notes.push(UNESTIMATED_ROTATIONS.to_owned());
    }
    notes
}

/// What may lower a large error of the tension, if the tolerance applies to another quantity.
pub fn remedy_of_tension(scene: &Scene) -> &'static str {
    match scene.body.reduction {
        Reduction::Vectors(_) => "accuracy.quantity = \"stress\" with body.reduction = \"auto\" in place of a number",
        _ => "accuracy.quantity = \"stress\"",
    }
}

/// Note on the tension if its estimated error is large, and the tolerance is smaller and applies to another quantity.
/// `of_largest` is the estimated error of the largest tension; if it is NaN, the estimate is for the tension under the impact
/// point.
pub fn of_tension(estimate: &ErrorEstimate, scene: &Scene, of_largest: f64) -> Option<String> {
    let is_elsewhere = of_largest.is_nan();
    let error = if is_elsewhere { estimate.of_tension().stress } else { of_largest };
    let does_not_apply = scene.measure != Measure::Stress;
    (does_not_apply && error > LARGE_ERROR_OF_TENSION.max(scene.tolerance)).then(|| {
        let which =
            if is_elsewhere { "tension under the impact point in the first contact" } else { "largest tension" };
        // Finer cells and larger bases do not help against the other causes.
        let causes = estimate.causes_to_mend(Measure::Stress, scene.tolerance);
        let help = if causes.iter().any(|cause| matches!(cause, Cause::Cells | Cause::Basis)) {
            format!("; {} may lower this error", remedy_of_tension(scene))
        } else {
            format!(" (estimated for {})", listed(&estimate.causes(Measure::Stress)))
        };
        format!(
            "the estimated error of the {which} is {} of its peak. accuracy.tolerance does not apply to tensions{help}",
            estimated(error)
        )
    })
}

/// Notes on errors above the tolerance, including the errors of the time steps. The error before the steps has its own
/// [`verdict`]: `was_warned` says whether it was already above the tolerance. If the `largest` tension has no estimate,
/// for example at a clamped edge, the estimate is for the tension under the impact point.
pub fn missed(estimate: &ErrorEstimate, scene: &Scene, was_warned: bool, largest: &LargestTension) -> Vec<String> {
    let Some(errors) = estimate.total() else { return Vec::new() };
    let (measure, tolerance) = (scene.measure, scene.tolerance);
    let mut missed = Vec::new();
    let is_for_another_place = largest.error_estimate.is_nan() && !estimate.of_tension().stress.is_nan();
    let remedies_of_measure = || remedies_of_measure(estimate, scene);
    if measure == Measure::Stress && is_for_another_place {
        let (error, help) = if errors.stress > tolerance {
            (beside(errors.stress, tolerance), format!("; {}", remedies_of_measure()))
        } else {
            (estimated(errors.stress), String::new())
        };
        missed.push(format!(
            "accuracy.tolerance = {tolerance:e} is for the tension under the impact point, whose estimated error in the first contact is {error}; \
             the error of the largest tension is not estimated{help}"
        ));
    } else if measure == Measure::Stress && !was_warned && errors.stress > tolerance {
        missed.push(format!(
            "the estimated error of the largest tension in the first contact is {} with that of the steps, above accuracy.tolerance = {tolerance:e}; \
             {}",
            beside(errors.stress, tolerance),
            remedies_of_measure()
        ));
    }
    let error_of_deflection = estimate.of_deflection();
    if measure == Measure::Deflection && !was_warned && error_of_deflection > tolerance {
        missed.push(format!(
            "the estimated error of the deflection under the impactor, including that of the steps, is {} of its largest value, \
             above accuracy.tolerance = {tolerance:e}; {}",
            beside(error_of_deflection, tolerance),
            remedies_of_measure()
        ));
    }
    missed.extend(of_tension(estimate, scene, largest.error_estimate));
    missed.extend(of_deflection(estimate, scene));
    let was_told = was_warned && measure == Measure::Acceleration;
    if let Some(above) = history_above([errors.first_contact, errors.history], [measure; 2], tolerance, was_told) {
        let step = match scene.time.step {
            Some(_) => "; the error of the given time.step is not included",
            None => "",
        };
        let remedies = remedies(estimate, &estimate.main_causes_of_history(), scene, |errors| errors.history);
        missed.push(format!("{above}; {remedies}{step}"));
    }
    missed
}

/// Text that the error of the acceleration over the whole history is above the tolerance, which applies to `measure`, and for
/// this result to `scope`; `None` if it is not, or if a warning about the first contact was told and the error hardly grows
/// after it.
pub fn history_above(
    [first, whole]: [f64; 2],
    [measure, scope]: [Measure; 2],
    tolerance: f64,
    was_told: bool,
) -> Option<String> {
    let grows = whole > GROWTH * first;
    if whole.is_nan() || whole <= tolerance || was_told && !grows {
        return None;
    }
    let later = if grows { ": later times are more sensitive" } else { "" };
    let of_what = if measure == Measure::Acceleration { "" } else { " of the acceleration" };
    let scope = match scope {
        Measure::Acceleration => "the first contact",
        Measure::Stress => "the largest tension in the first contact",
        Measure::Deflection => "the deflection and, in the first contact, the acceleration",
    };
    Some(format!(
        "the estimated error{of_what} over the whole history is {} of the peak, above accuracy.tolerance = {tolerance:e}, which is for \
         {scope}{later}",
        beside(whole, tolerance)
    ))
}

/// Text about a large error of the deflection.
pub fn of_large_deflection_error(error: f64) -> String {
    format!(
        "the estimated error of the deflection under the impactor, over the whole history, is {} of its largest value",
        estimated(error)
    )
}

/// Settings that may reduce the error that the tolerance applies to: a clause.
fn remedies_of_measure(estimate: &ErrorEstimate, scene: &Scene) -> String {
    let causes = estimate.causes_to_mend(scene.measure, scene.tolerance);
    remedies(estimate, &causes, scene, |errors| errors.of(scene.measure))
}

/// Settings that may reduce the errors of these causes: a clause. `error` selects the error that is too large.
fn remedies(estimate: &ErrorEstimate, causes: &[Cause], scene: &Scene, error: impl Fn(&Errors) -> f64) -> String {
    let is_plate = match scene.body.model {
        Theory::Solid => false,
        // A plate that was selected has an error of the theory.
        Theory::Auto => estimate.of(Cause::Theory).is_some(),
        _ => true,
    };
    let mut remedies: Vec<&str> = causes
        .iter()
        .filter_map(|cause| {
            let errors = estimate.of(*cause).unwrap_or_default();
            // Cells and basis are refined until the error that the tolerance applies to is within the tolerance, unless a
            // limit of their size is reached. A smaller tolerance does not help then, nor against different contacts.
            let is_at_limit = errors.of(scene.measure) > scene.tolerance || error(&errors) > OTHER_CONTACTS;
            let is_main = error(&errors) > scene.tolerance;
            remedy(*cause, scene, is_plate, [is_at_limit, is_main])
        })
        .collect();
    if remedies.is_empty() {
        return "no setting lowers this estimate".to_owned();
    }
    remedies.sort_unstable();
    remedies.dedup();
    format!("what may lower it: {}", remedies.join(", or "))
}

/// Setting that may reduce the error of a cause, if there is one. `is_at_limit`: a smaller tolerance cannot lower it;
/// `is_main`: it is above the tolerance without the other causes.
fn remedy(cause: Cause, scene: &Scene, is_plate: bool, [is_at_limit, is_main]: [bool; 2]) -> Option<&'static str> {
    let is_of_layers = scene.body.composition.uniform().is_none();
    match cause {
        Cause::Basis if matches!(scene.body.reduction, Reduction::Vectors(_)) => {
            Some("body.reduction = \"auto\" in place of a number")
        }
        Cause::Patch => Some("finer cells at the impact point"),
        // A solid has errors of its own, which are as large as a small error of the theory.
        Cause::Theory if is_plate && !is_main => None,
        Cause::Theory if is_plate && spline::admits(scene).is_ok() => Some("body.model = \"solid\""),
        Cause::Theory if is_plate && is_of_layers => Some(
            "body.model = \"solid\" on a fine mesh by body.cells (its error is not estimated, and it has no stresses between layers)",
        ),
        Cause::Theory if is_plate => {
            Some("body.model = \"solid\" on a fine mesh by body.cells, whose error is not estimated")
        }
        Cause::LocalField if gives_wide_disc(scene) => Some("a smaller contact.disc_radius"),
        // A solid computes the waves in interlayers.
        Cause::LocalField if is_plate && is_of_layers && spline::admits(scene).is_ok() => {
            Some("body.model = \"solid\"")
        }
        Cause::LocalField | Cause::ContactLaw => None,
        _ if is_at_limit => None,
        Cause::Basis | Cause::Cells | Cause::Steps | Cause::Theory => Some("a smaller accuracy.tolerance"),
    }
}

/// Whether the scene gives a disc whose radius is larger than the thickness.
fn gives_wide_disc(scene: &Scene) -> bool {
    let Contact::Patch { disc: Some(radius), .. } = scene.contact else { return false };
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else { return false };
    radius > size[axis]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pane; `more` has further keys of `[body]` or `[time]`, with the table's name.
    fn pane(more: &str) -> Scene {
        let keys = |table: &str| more.strip_prefix(&format!("[{table}]\n")).unwrap_or("").to_owned();
        let text = format!(
            "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.5, 0.5, 0.01]\n{}\
             [impactor]\nmass = 1.0\nradius = 0.03\nyoung = 3e9\npoisson = 0.3\nspeed = 3.0\n[time]\nend = 0.008\n{}",
            keys("body"),
            keys("time")
        );
        Scene::parse("scene", &text, &[]).expect("a scene").0
    }

    #[test]
    fn what_is_above_a_limit_is_seen_to_be() {
        let shown = [(1.6e-2, "1.6e-2"), (1.004e-2, "1.004e-2"), (1.03e-2, "1.03e-2"), (1.000001e-2, "1.0000e-2")];
        shown.into_iter().for_each(|(number, text)| assert_eq!(beside(number, 1e-2), text));
    }

    /// Errors with these of the stress and of the whole history.
    fn of_stress(stress: f64, history: f64) -> Errors {
        Errors { history, stress, stress_history: stress, ..Errors::throughout(1e-3) }
    }

    #[test]
    fn a_tolerance_for_stresses_is_held_against_stresses() {
        let errors = |history: f64, stress: f64| of_stress(stress, history);
        let told = |errors: Errors, measure: Measure, was_warned: bool| {
            let estimate = ErrorEstimate::default().with(Cause::Cells, errors);
            let largest = LargestTension { error_estimate: errors.stress, ..LargestTension::default() };
            missed(&estimate, &Scene { measure, ..pane("") }, was_warned, &largest)
        };
        assert!(told(errors(9e-3, 2e-2), Measure::Acceleration, false).is_empty());
        let of_stress = told(errors(9e-3, 2e-2), Measure::Stress, false);
        assert!(
            matches!(&of_stress[..], [one] if one.contains("largest tension") && one.contains("2.0e-2")),
            "{of_stress:?}"
        );
        // A warning from before the run is not repeated. An error without estimate is not above the tolerance.
        assert!(told(errors(9e-3, 2e-2), Measure::Stress, true).is_empty());
        assert!(told(errors(9e-3, f64::NAN), Measure::Stress, false).is_empty());
        assert_eq!(told(errors(2e-2, 9e-3), Measure::Acceleration, false).len(), 1);
        assert!(
            told(errors(2e-2, 9e-3), Measure::Stress, false)[0]
                .contains("is for the largest tension in the first contact")
        );
    }

    /// A large error of the tension is noted only if the tolerance is smaller and applies to another quantity.
    #[test]
    fn a_large_error_of_the_tension_is_noted() {
        let estimate = |stress: f64| ErrorEstimate::default().with(Cause::Cells, of_stress(stress, 1e-3));
        let noted = |stress: f64, measure: Measure, tolerance: f64| {
            of_tension(&estimate(stress), &Scene { measure, tolerance, ..pane("") }, stress)
        };
        let text = noted(0.2, Measure::Acceleration, 1e-2).expect("a note");
        assert!(text.contains("2.0e-1") && text.contains("accuracy.quantity"), "{text}");
        // No setting lowers the error of a static local field.
        let fixed = Errors { stress: 0.2, ..Errors::default() };
        let fixed = ErrorEstimate::default().with(Cause::LocalField, fixed);
        let text = of_tension(&fixed, &Scene { tolerance: 1e-2, ..pane("") }, 0.2).expect("a note");
        assert!(text.contains("2.0e-1") && !text.contains("accuracy.quantity"), "{text}");
        assert!(noted(0.2, Measure::Deflection, 1e-2).is_some());
        let text = of_tension(&estimate(0.2), &pane("[body]\nreduction = 20\n"), f64::NAN).expect("a note");
        assert!(text.contains("under the impact point") && text.contains("body.reduction"), "{text}");
        assert_eq!(noted(0.2, Measure::Stress, 1e-2), None);
        assert_eq!(noted(0.2, Measure::Acceleration, 0.3), None);
        assert_eq!(noted(0.09, Measure::Acceleration, 1e-2), None);
        assert_eq!(noted(f64::NAN, Measure::Acceleration, 1e-2), None);
    }

    /// Finer cells do not reduce the error of the local field. For a laminate the advice is the solid, for a body of one
    /// layer there is none. `auto` has an error of the theory only if it selected a plate.
    #[test]
    fn advice_for_the_local_field() {
        let message = |scene: Scene, of_theory: Option<f64>| {
            let of_stress = |stress: f64| Errors { stress, ..Errors::throughout(1e-3) };
            let estimate =
                ErrorEstimate::default().with(Cause::Cells, of_stress(6e-3)).with(Cause::LocalField, of_stress(3e-2));
            let estimate = match of_theory {
                Some(error) => estimate.with(Cause::Theory, of_stress(error)),
                None => estimate,
            };
            let scene = Scene { measure: Measure::Stress, ..scene };
            let largest = LargestTension { error_estimate: 3e-2, ..LargestTension::default() };
            missed(&estimate, &scene, false, &largest).concat()
        };
        let laminate = |model: &str| {
            let layer = |material: &str| format!("[[body.layer]]\nthickness = 0.005\nmaterial = \"{material}\"\n");
            let layers = ["glass", "soft", "glass"].map(layer).concat();
            let text = format!(
                "[body]\nmodel = \"{model}\"\nsize = [0.2, 0.2]\n{layers}\
                 [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
                 [material.soft]\nyoung = 30e6\npoisson = 0.4\ndensity = 1100.0\n\
                 [impactor]\nmass = 1.0\nradius = 0.03\nyoung = 3e9\npoisson = 0.3\nspeed = 3.0\n[time]\nend = 0.008\n"
            );
            Scene::parse("scene", &text, &[]).expect("a scene").0
        };
        let solid = "what may lower it: body.model = \"solid\"";
        assert!(message(laminate("layerwise"), None).ends_with(solid));
        assert!(message(laminate("auto"), Some(4e-2)).ends_with(solid));
        let with_disc = pane("[body]\nmodel = \"mindlin\"\n[contact]\ndisc_radius = 0.1\n");
        assert!(message(with_disc, None).ends_with("what may lower it: a smaller contact.disc_radius"));
        for scene in [laminate("solid"), laminate("auto"), pane("[body]\nmodel = \"mindlin\"\n")] {
            let message = message(scene, None);
            assert!(message.ends_with("no setting lowers this estimate"), "{message}");
        }
    }

    /// The advice fits the cause: a smaller tolerance changes neither a given mesh, nor a given basis, nor a given step.
    #[test]
    fn advice_is_for_the_main_cause() {
        let told = |more: &str, cause: Cause| {
            let estimate = ErrorEstimate::default()
                .with(cause, Errors { history: 2e-2, ..Errors::throughout(9e-3) })
                .with(Cause::Steps, Errors::throughout(1e-3));
            missed(&estimate, &pane(more), false, &LargestTension::default()).concat()
        };
        let ends = |more: &str, cause: Cause, end: &str| {
            let told = told(more, cause);
            assert!(told.ends_with(&format!("what may lower it: {end}")), "{told}");
        };
        // A solid is no remedy for the small error of a theory, nor is a tolerance that cells could not meet.
        let small = ErrorEstimate::default()
            .with(Cause::Theory, Errors { history: 9e-3, ..Errors::throughout(1e-3) })
            .with(Cause::Cells, Errors { history: 2e-2, ..Errors::throughout(9e-3) });
        let message = |estimate: &ErrorEstimate| missed(estimate, &pane(""), true, &LargestTension::default()).concat();
        assert!(message(&small).ends_with("what may lower it: a smaller accuracy.tolerance"), "{}", message(&small));
        let stuck = ErrorEstimate::default()
            .with(Cause::Cells, Errors { history: 8e-2, deflection: 0.3, ..Errors::throughout(4e-2) })
            .with(Cause::Basis, Errors::throughout(1e-3));
        let told = message(&stuck);
        assert!(!told.contains("accuracy.quantity") && told.ends_with("no setting lowers this estimate"), "{told}");
        ends("", Cause::Patch, "finer cells at the impact point");
        ends("", Cause::Cells, "a smaller accuracy.tolerance");
        ends("[body]\nreduction = 20\n", Cause::Basis, "body.reduction = \"auto\" in place of a number");
        let given = "a smaller accuracy.tolerance; the error of the given time.step is not included";
        ends("[time]\nstep = 1e-5\n", Cause::Cells, given);
    }
}
