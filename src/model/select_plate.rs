//! Selects the plate of a scene's body if its estimated error is small enough, otherwise the solid.
//!
//! The error has two parts. In the interior of a plate of several layers the theory's waves have other frequencies than
//! those of three-dimensional elasticity. The frequencies of the plate's modes are corrected by the ratio for an infinite
//! plate, and the force changes by the first part. (One layer has the exact frequencies to 2e-4 down to waves of 2.6
//! thicknesses, for ν = 0.23.) The second part, for edges and the local field under the impactor, is a part of the effect of shear and
//! of the local field ([`super::plate_error`]). That effect is the difference between the plate and a thin one, which has
//! neither: Kirchhoff's plate for one layer, or layers that are rigid in shear. If the tolerance is for the stress, the
//! error of the static local field next to slow interlayers counts, too ([`delay_error`]). A viscoelastic body is compared
//! with the secant moduli at half the contact time. It is an estimate, not a bound.
//!
//! A solid that is too large for splines would need a mesh. The error of a mesh is not estimated, and it gives stresses on
//! its outer faces only, while the largest tension of a laminate is often on a face between layers. The plate is then
//! kept, with its estimate.

use super::cells::{CELL_SHARE, COARSER_CELL_FACTOR, fitted};
use super::context::ModelContext;
use super::local_field_error::delay_error;
use super::plate_error::plate_error_over_difference;
use super::reduce::BASIS_SHARE;
use super::select_theory::{LARGEST_ERROR_INSTEAD_OF_MESH, THEORY_SHARE, bedding_error};
use super::theory::build_thin;
use super::trials::Trials;
use super::{Built, Fitted, Model, Reduced, build, name, reduce, refine, unrefined};
use crate::body::ModalBody;
use crate::description::Description;
use crate::error::{Error, Result};
use crate::impact::{Cause, Errors, TIME_STEP_SHARE, beside, joined, rest};
use crate::scene::{Body, Measure, Model as Theory, Scene, Time};
use crate::space::plate;
use crate::space::spline;

/// Tolerance for cells, basis and time steps, divided by the theory's error, if that error exceeds the scene's tolerance
/// and no better theory is available. Smaller errors of the other parts would hardly lower the sum of all errors.
const TOLERANCE_OVER_THEORY_ERROR: f64 = 0.5;

/// Part of the tolerance left for cells and basis from which a plate that was made for the whole tolerance is kept.
const NEARLY_WHOLE: f64 = 0.9;

/// Tolerance of bodies that are computed for a difference only, relative to the scene's tolerance; and its largest value.
const ROUGH_TOLERANCE_FACTOR: f64 = 10.0;
const LARGEST_ROUGH_TOLERANCE: f64 = 0.1;

/// The elastic plate. Its difference from the plate of [`build_thin`] gives the error of the theory.
enum Thick {
    /// On cells and a basis for the scene's tolerance.
    Whole(Box<Fitted>),
    /// On coarser cells, and on a basis for a rough tolerance.
    Coarser(Box<Reduced>),
}

impl Thick {
    fn reduced(&self) -> &Reduced {
        match self {
            Self::Whole(fitted) => &fitted.reduced,
            Self::Coarser(reduced) => reduced,
        }
    }
}

/// The scene in modal coordinates, with elastic layers in place of the viscoelastic ones, with their secant moduli at half
/// the contact time.
fn elastic_scene(scene: &Scene) -> Scene {
    let composition = scene.body.composition.with_secant_moduli(scene.impactor.moduli_time());
    let time = Time { modal: true, ..scene.time.clone() };
    Scene { body: Body { composition, ..scene.body.clone() }, time, ..scene.clone() }
}

/// The scene with a larger tolerance, for bodies that are computed for a difference only.
fn rougher(scene: &Scene) -> Scene {
    let tolerance = scene.tolerance.max((ROUGH_TOLERANCE_FACTOR * scene.tolerance).min(LARGEST_ROUGH_TOLERANCE));
    Scene { tolerance, ..scene.clone() }
}

/// Change of the force on a basis if its modes have the exact frequencies of flexural waves. Collective.
fn error_of_frequencies(context: &ModelContext, elastic: &Scene, reduced: &Reduced) -> Result<Errors> {
    let ratios = plate::frequency_ratios(elastic)?;
    let Reduced { projection, force: (force, steps), .. } = reduced;
    let retuned = ModalBody::retuned(projection, |frequency| ratios.at(frequency));
    let found = Trials::new(context, elastic).force_on(Some(retuned), *steps, projection)?;
    Ok(found.force.difference(force))
}

/// The plate of a `theory`, Mindlin's or the layerwise one; `None` if the solid is needed. `passed` is extended by the
/// reason. Collective.
pub(super) fn select_plate(
    context: &ModelContext,
    scene: &Scene,
    theory: Theory,
    passed: &mut Vec<String>,
) -> Result<Option<Model>> {
    let elastic = elastic_scene(scene);
    let rough = rougher(&elastic);
    let plate = |scene: &Scene, size: f64| match build(context, scene, theory, size)? {
        Built::Operators(operators) => Ok(operators),
        Built::Given(_) => Err(Error::Solve("a plate has unknowns".into())),
    };
    // For a viscoelastic body the elastic plate is made for comparisons only: on coarser cells and a short basis.
    let relaxes = !Description::new(scene).relaxations().is_empty();
    // Cells and basis are not checked yet. Their part of the difference is small, and so is their effect on the
    // estimate.
    let thick = if relaxes {
        Thick::Coarser(Box::new(reduce(context, plate(&elastic, COARSER_CELL_FACTOR)?.body.linear(), &rough)?))
    } else {
        Thick::Whole(Box::new(unrefined(context, &elastic, plate(&elastic, 1.0)?)?))
    };
    let force = &thick.reduced().force.0;
    let thin = reduce(context, build_thin(context.comm, &rough)?.body.linear(), &rough)?;
    let difference = force.difference(&thin.force.0);
    let of_bedding = bedding_error(scene, force);
    let of_waves = match theory {
        Theory::Layerwise => error_of_frequencies(context, &elastic, thick.reduced())?,
        _ => Errors::default(),
    };
    let of_boundaries = plate_error_over_difference(&elastic) * difference;
    tracing::debug!(waves = of_waves.first_contact, boundaries = of_boundaries.first_contact, "error of the theory");
    let of_theory = of_waves + of_boundaries;
    let (differ, alone) = (difference.of(scene.measure), of_theory.of(scene.measure));
    // Used only to choose the theory: the estimate already has it under `Cause::LocalField`.
    let of_delay = match scene.measure {
        Measure::Stress => delay_error(scene, theory) - delay_error(scene, Theory::Solid),
        Measure::Acceleration | Measure::Deflection => 0.0,
    };
    let error = joined(alone, of_delay);
    let (of_what, part) = (scene.of_measure(), scene.in_measured_part());
    let (tolerance, name) = (scene.tolerance, name(theory));
    let share = THEORY_SHARE * tolerance;
    let judged = format!(
        "shear and the local field change {name} by {differ:.1e}{of_what}{part}; estimated error of {name} relative to solid: {}",
        beside(error, share)
    );
    let above = format!("{judged}, above {share:.1e}, the theory's share of the tolerance");
    let [over, alone] = [error, alone].map(|error| context.watch.agreed(error / tolerance));
    // Cells and basis get what the theory and the time steps leave of the tolerance.
    let rest = rest(rest(1.0, TIME_STEP_SHARE), over) / joined(CELL_SHARE, BASIS_SHARE);
    let mut accepted = tolerance;
    let left_tolerance = if rest < NEARLY_WHOLE { rest * tolerance } else { tolerance };
    let mut left = Scene { tolerance: left_tolerance, ..scene.clone() };
    if over > THEORY_SHARE {
        let splines = match scene.is_reduced() {
            true => spline::admits(scene),
            false if theory == Theory::Layerwise => Err("it is not reduced".to_owned()),
            false => Ok(()),
        };
        match splines {
            Err(reason) if alone * tolerance <= LARGEST_ERROR_INSTEAD_OF_MESH => {
                accepted = tolerance.max(TOLERANCE_OVER_THEORY_ERROR * alone * tolerance);
                left.tolerance = accepted;
                passed.push(format!(
                    "{above}, but used: splines cannot model its solid ({reason}), and the error of a mesh is not estimated"
                ));
            }
            _ => {
                passed.push(format!("{above}, so the solid is used"));
                return Ok(None);
            }
        }
    } else {
        passed.push(judged);
    }
    let model = if scene.time.modal {
        let on_first_cells = match thick {
            Thick::Whole(thick) if left.tolerance >= tolerance => *thick,
            // The basis of the elastic plate, for a rough tolerance, is a first guess of that of the viscoelastic one.
            Thick::Coarser(reduced) => fitted(context, &left, plate(&left, 1.0)?, (1.0, Some(reduced.counts())))?,
            Thick::Whole(_) => unrefined(context, &left, plate(&left, 1.0)?)?,
        };
        let fitted = refine(context, &left, theory, on_first_cells)?;
        Model::on_basis(context, scene, theory, fitted)?
    } else {
        Model::of(context, &left, theory)?
    };
    let model = Model { tolerance: accepted, ..model };
    Ok(Some(model.with_error(Cause::Theory, of_theory.joined(of_bedding))))
}
