//! Selects the theory for a scene's body, reduces the body to a basis, and runs impacts on it.

mod cell_error;
mod cells;
mod context;
mod error_factors;
mod judgement;
mod led;
mod linearity;
mod local_field_error;
mod long_waves;
mod plate_error;
mod readings;
mod reduce;
mod select_plate;
mod select_theory;
mod shared;
mod simulation;
mod theory;
mod trials;
pub mod watch;

pub use context::ModelContext;
pub use error_factors::ErrorFactors;
pub use judgement::{LARGE_ERROR_OF_DEFLECTION, LARGE_ERROR_OF_TENSION, OTHER_CONTACTS};
use judgement::{LARGEST_COST_FOR_DEFLECTIONS, cost};
pub use linearity::{Edges, Linearity, STIFFENING, edges, largest_linear};
use local_field_error::local_field_errors;
pub use plate_error::plate_error_over_difference;
pub use readings::Gauges;
pub use reduce::{BASIS_SHARE, Reduced, may_lack_rotations, rate, reduce, shift};
pub use select_theory::thickness_compression;
pub use shared::SharedModel;
pub use simulation::Simulation;
pub use theory::{Built, Operators, admits, build, name};

pub use cells::{CellSize, Fitted, cell_size};
use cells::{fit, refine, unrefined, with_averaging};

use petsc_wrap::Comm;

use crate::body::{Body, ModalBody, Projection};
use crate::contact::{Footprint, Patch};
use crate::error::{Error, Result};
use crate::impact::{Cause, ErrorEstimate, ErrorRule, Errors, KnownForce};
use crate::mesh::Measures;
use crate::scene::{self, Scene};
use crate::solve::Method;

use watch::Unwatched;

/// A scene's body, ready for impact simulations.
pub struct Model {
    /// Theory of the body.
    pub theory: scene::Model,
    /// Ranks on which the model is made.
    pub comm: Comm,
    /// The body as it is integrated in time.
    pub dynamics: Dynamics,
    /// Number of unknowns of the body in this theory, before any reduction.
    pub unknowns: usize,
    /// Description of the unknowns, for results.
    pub discretisation: String,
    /// Size of the cells relative to the rule of thumb for the scene.
    pub cell_size: f64,
    /// Number of basis vectors, if the body is reduced.
    pub vectors: Option<usize>,
    /// Whether the basis leaves out short waves, which are those of an infinite plate, without their echoes.
    pub leaves_short_waves: bool,
    /// The body reduced to another basis, for estimating the error of impacts that differ from the scene's.
    pub judge: Option<JudgeBasis>,
    /// Tolerance of the time steps: the scene's, or half of the theory's error if that is larger.
    pub tolerance: f64,
    /// Contact forces of the scene's impact that are known already, in time steps that its error control tries.
    pub known: Vec<KnownForce>,
    /// Estimated error by basis, discretisation and theory, as far as each is known.
    pub error: ErrorEstimate,
    /// Whether the impactor does not touch the body. No error is estimated then.
    pub is_untouched: bool,
    /// Reason for this theory, if it was selected automatically.
    pub reason: Option<String>,
    /// Readout of the body, if the scene asks for any.
    pub gauges: Option<Gauges>,
    /// Measures of the mesh, if it is from a file.
    pub measures: Option<Measures>,
    /// Whether a second model, on a basis with a low shift for slow vibrations, is possible and cheap.
    pub may_lower_shift: bool,
}

/// The body on a second basis, with which the error of the first is estimated. Its modes are computed when they are
/// needed.
pub struct JudgeBasis {
    projection: Projection,
    modal: Option<ModalBody>,
    rule: ErrorRule,
}

impl JudgeBasis {
    /// The body in modal coordinates, and the rule that estimates the error from the difference of the forces on the
    /// two bases.
    pub fn into_modal(self) -> (ModalBody, ErrorRule) {
        (self.modal.unwrap_or_else(|| ModalBody::of(&self.projection)), self.rule)
    }
}

/// How the body is integrated in time.
pub enum Dynamics {
    /// By a stepping scheme, in the body's unknowns.
    Stepped(Box<Body>),
    /// In modal coordinates.
    Modal(ModalBody),
}

impl Dynamics {
    /// Whether several ranks share the factorisation of the time stepping matrix.
    pub fn is_factorised_on_ranks(&self) -> bool {
        let Self::Stepped(body) = self else { return false };
        body.comm().size() > 1 && body.lumped.is_none() && body.method == Method::Cholesky
    }

    /// The patch under the impactor, if there is one.
    pub fn patch(&self) -> Option<Patch> {
        self.footprint().patch()
    }

    /// Distribution of the contact force on the surface.
    pub fn footprint(&self) -> Footprint {
        match self {
            Self::Stepped(body) => body.terms.contact.footprint,
            Self::Modal(body) => body.footprint,
        }
    }
}

impl Model {
    /// Makes the theory that a scene names, or selects one for `auto`; reduces the body as the scene says. Collective.
    ///
    /// # Errors
    /// A fault if the theory does not admit the scene; the errors of meshes; [`crate::Error::Solve`] if the impact
    /// cannot be solved on any basis; or if a PETSc call fails.
    pub fn new(comm: &Comm, scene: &Scene) -> Result<Self> {
        Self::made(&ModelContext::new(comm, &Unwatched(comm)), scene)
    }

    /// [`Model::new`], made in a given way. Collective.
    ///
    /// # Errors
    /// Same as [`Model::new`]; [`crate::Error::Interrupted`] if the watch stops it.
    pub fn made(context: &ModelContext, scene: &Scene) -> Result<Self> {
        let made = |context: &ModelContext| match scene.body.model {
            scene::Model::Auto => select_theory::select_theory(context, scene),
            theory => Self::of(context, scene, theory),
        };
        // Theories and cells are compared on bases with the same shift, so that the whole model is made again.
        let mut model = made_with_low_shift(context, scene, made, |model| {
            model.may_lower_shift && model.error_of_deflection_by_basis() > LARGE_ERROR_OF_DEFLECTION
        })?;
        model.error = model.error.with_law(scene);
        // All errors are estimated from contact forces.
        if !model.is_untouched {
            return Ok(model);
        }
        let reason =
            model.reason.map(|_| "there is no contact, with whose force theories could be compared".to_owned());
        Ok(Self { error: ErrorEstimate::default(), reason, ..model })
    }

    /// Makes the model of one theory. Collective.
    fn of(context: &ModelContext, scene: &Scene, theory: scene::Model) -> Result<Self> {
        let comm = context.comm;
        match build(context, scene, theory, 1.0)? {
            Built::Given(body) => {
                Ok(Self::bare(comm, (scene, theory), Dynamics::Modal(body), 0, "a formula".to_owned()))
            }
            Built::Operators(Operators { body, discretisation, evaluator, measures, .. }) if !scene.is_reduced() => {
                let body = body.in_petsc(&comm.session().alone())?;
                let unknowns = body.unknowns();
                let gauges = || Gauges::new(comm, scene, evaluator, unknowns, None);
                let gauges = scene.output.is_read().then(gauges).transpose()?;
                Ok(Self {
                    gauges,
                    measures,
                    ..Self::bare(comm, (scene, theory), Dynamics::Stepped(body), unknowns, discretisation)
                })
            }
            Built::Operators(built) => Self::on_basis(context, scene, theory, fit(context, scene, theory, built)?),
        }
    }

    /// The model of a reduced body. Collective.
    fn on_basis(context: &ModelContext, scene: &Scene, theory: scene::Model, fitted: Fitted) -> Result<Self> {
        let comm = context.comm;
        let may_lower_shift = !context.limits_deflection_error && may_lower_shift(scene, theory, &fitted);
        let Fitted { reduced, unknowns, discretisation, evaluator, measures, error: cells, size, .. } = fitted;
        let Reduced { projection, judge, rule, krylov, error, modal, modal_of_judge, known, force, .. } = reduced;
        let (vectors, is_untouched) = (projection.vectors(), !force.0.has_contact());
        let leaves_short_waves = projection.terms.infinite_plate.is_some();
        let cells = cells.map(|error| {
            let (evaluator, force) = (evaluator.as_ref(), Some(&force.0));
            [with_averaging(evaluator, force, error), local_field_errors(scene, theory, evaluator, force)]
        });
        let gauges = match (vectors, scene.output.is_read()) {
            (0, _) | (_, false) => None,
            _ => Some(Gauges::new(comm, scene, evaluator, unknowns, Some(krylov.whole(vectors)))?),
        };
        let dynamics = if scene.time.modal {
            Dynamics::Modal(modal.unwrap_or_else(|| ModalBody::of(&projection)))
        } else {
            Dynamics::Stepped(Box::new(Body::of(&comm.session().alone(), &projection.system())?))
        };
        let judge = Some(JudgeBasis { projection: judge, modal: modal_of_judge, rule });
        let vectors = Some(vectors);
        let bare = Self::bare(comm, (scene, theory), dynamics, unknowns, discretisation);
        let model =
            Self { vectors, leaves_short_waves, judge, known, gauges, measures, is_untouched, may_lower_shift, ..bare };
        let model = Self { cell_size: size, ..model };
        let model = model.with_error(Cause::Basis, error);
        Ok(match cells {
            Some([of_cells, local]) if local.stress == 0.0 => model.with_error(Cause::Cells, of_cells),
            Some([of_cells, local]) => model.with_error(Cause::Cells, of_cells).with_error(Cause::LocalField, local),
            None => model,
        })
    }

    /// A model without basis and without error estimates.
    fn bare(
        comm: &Comm,
        (scene, theory): (&Scene, scene::Model),
        dynamics: Dynamics,
        unknowns: usize,
        discretisation: String,
    ) -> Self {
        Self {
            comm: comm.clone(),
            tolerance: scene.tolerance,
            theory,
            dynamics,
            unknowns,
            discretisation,
            cell_size: 1.0,
            vectors: None,
            leaves_short_waves: false,
            judge: None,
            known: Vec::new(),
            is_untouched: false,
            error: ErrorEstimate::default(),
            reason: None,
            gauges: None,
            measures: None,
            may_lower_shift: false,
        }
    }

    /// Adds the errors of one more cause.
    fn with_error(self, cause: Cause, errors: Errors) -> Self {
        Self { error: self.error.with(cause, errors), ..self }
    }

    /// Estimated error of the deflection by the basis; NaN if it is unknown.
    fn error_of_deflection_by_basis(&self) -> f64 {
        self.error.of(Cause::Basis).map_or(f64::NAN, |of_basis| of_basis.deflection)
    }

    /// The error estimate before the first step: [`Model::error`] and the error of the patch.
    pub fn error_before_steps(&self) -> ErrorEstimate {
        self.error.clone().with_patch(self.dynamics.patch().as_ref())
    }

    /// Description of the basis, for a result's attribute.
    pub fn reduction(&self) -> String {
        self.vectors.map_or("none".to_owned(), |vectors| format!("{vectors} Krylov vectors"))
    }
}

/// Makes a model, or a body that several share, on bases with a low shift if automatic bases would lack rotations without it,
/// or if the first one is poor. Collective.
///
/// # Errors
/// Same as `make`. If the second one is not possible, the first serves.
pub fn made_with_low_shift<T>(
    context: &ModelContext,
    scene: &Scene,
    make: impl Fn(&ModelContext) -> Result<T>,
    is_poor: impl FnOnce(&T) -> bool,
) -> Result<T> {
    let with_low_shift = ModelContext { limits_deflection_error: true, ..*context };
    let lacks_rotations = has_automatic_basis(scene) && may_lack_rotations(scene);
    let made = make(if lacks_rotations { &with_low_shift } else { context })?;
    if !context.watch.decided(!lacks_rotations && is_poor(&made)) {
        return Ok(made);
    }
    match make(&with_low_shift) {
        Err(Error::Solve(_) | Error::Fault(_)) => Ok(made),
        second => second,
    }
}

/// Whether the number of basis vectors follows from the tolerance.
pub fn has_automatic_basis(scene: &Scene) -> bool {
    scene.body.reduction == scene::Reduction::Auto
}

/// Largest number of unknowns of a spline solid for which a second model is made, which then takes about a second.
const MOST_UNKNOWNS_OF_SECOND_SOLID: usize = 4000;

/// Whether a body may be reduced a second time, to a basis with a low shift, at a limited cost. `vectors` is the number
/// of vectors of the first basis.
pub fn is_quickly_reduced_again(scene: &Scene, theory: scene::Model, unknowns: usize, vectors: usize) -> bool {
    has_automatic_basis(scene)
        && scene.measure != scene::Measure::Deflection
        // With pads, each impact that is computed on a basis takes long.
        && !scene.is_on_pads()
        && cost(unknowns, vectors) <= LARGEST_COST_FOR_DEFLECTIONS
        && (theory != scene::Model::Solid || unknowns <= MOST_UNKNOWNS_OF_SECOND_SOLID)
}

/// Whether a second model of a plate or a spline solid, on a basis with a low shift, is possible and cheap.
fn may_lower_shift(scene: &Scene, theory: scene::Model, Fitted { reduced, unknowns, cells, .. }: &Fitted) -> bool {
    // Bases whose short waves are treated separately have all slow vibrations.
    let has_all_waves = reduced.projection.terms.infinite_plate.is_none();
    has_all_waves && cells.is_some() && is_quickly_reduced_again(scene, theory, *unknowns, reduced.projection.vectors())
}
