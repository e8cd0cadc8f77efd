//! Which theory stands for a scene's body, on what basis, and the impacts that are run of it.

mod cells;
mod climb;
mod elastic_cells;
mod layers;
mod linearity;
mod long_waves;
mod mindlin_error;
mod readings;
mod reduce;
mod simulation;
mod theory;
mod trials;
pub mod watch;

pub use linearity::{LARGE, Linearity, STIFFENING};
pub use mindlin_error::mindlin_error_over_difference;
pub use readings::Gauges;
pub use reduce::{OF_BASIS, OF_SMALLER, Reduced, rate, reduce, reduce_from};
pub use simulation::Simulation;
pub use theory::{Built, Operators, admits, build, name};

pub use cells::{CellSize, Fitted, cell_size};
use cells::{fit, refine, unrefined};

use petsc_wrap::Comm;

use crate::body::{Body, ModalBody};
use crate::contact::Patch;
use crate::error::Result;
use crate::impact::{Cause, ErrorEstimate, Errors};
use crate::mesh::Measures;
use crate::scene::{self, Scene};
use crate::solve::Method;

use watch::{Unwatched, Watch};

/// A scene's body, ready for impacts.
pub struct Model {
    /// The theory.
    pub theory: scene::Model,
    /// The body.
    pub dynamics: Dynamics,
    /// Unknowns of the body as the theory has it, before any reduction.
    pub unknowns: usize,
    /// What these unknowns are of.
    pub words: String,
    /// Vectors of the basis, where there is one.
    pub vectors: Option<usize>,
    /// The body on another basis, by which this one is judged, and the error over the difference of the two.
    pub judge: Option<(ModalBody, f64)>,
    /// Estimated error by basis, cells and theory, as far as each is known.
    pub error: ErrorEstimate,
    /// Why this theory and not another, where that was to be found.
    pub reason: Option<String>,
    /// What is read of the body, where the scene wants that.
    pub gauges: Option<Gauges>,
    /// Measures of a mesh from a file.
    pub measures: Option<Measures>,
}

/// How a body moves.
pub enum Dynamics {
    /// Step by step, in its unknowns.
    Stepped(Box<Body>),
    /// In modal coordinates.
    Modal(ModalBody),
}

impl Dynamics {
    /// Whether several ranks share a factor in its steps.
    pub fn is_factorised_on_ranks(&self) -> bool {
        let Self::Stepped(body) = self else { return false };
        body.comm().size() > 1 && body.lumped.is_none() && body.method == Method::Cholesky
    }

    /// The patch under the impactor, where there is one.
    pub fn patch(&self) -> Option<Patch> {
        match self {
            Self::Stepped(body) => body.localization.patch,
            Self::Modal(body) => body.patch,
        }
    }
}

impl Model {
    /// The theory that a scene names, or the one that it needs; reduced as it says. Collective.
    ///
    /// # Errors
    /// A fault where the theory does not stand for the scene; those of meshes; [`crate::Error::Solve`] where the impact has no
    /// solution on any basis; PETSc's.
    pub fn new(comm: &Comm, scene: &Scene) -> Result<Self> {
        Self::watched(comm, scene, &Unwatched(comm))
    }

    /// [`Model::new`] before somebody who may break it off. Collective.
    ///
    /// # Errors
    /// As [`Model::new`]; [`crate::Error::Interrupted`].
    pub fn watched(comm: &Comm, scene: &Scene, watch: &dyn Watch) -> Result<Self> {
        match scene.body.model {
            scene::Model::Auto => climb::climb(comm, scene, watch),
            theory => Self::of(comm, scene, theory, watch),
        }
    }

    /// One theory's model. Collective.
    fn of(comm: &Comm, scene: &Scene, theory: scene::Model, watch: &dyn Watch) -> Result<Self> {
        match build(comm, scene, theory, 1.0, watch)? {
            Built::Given(body) => Ok(Self::bare(theory, Dynamics::Modal(body), 0, "a formula".to_owned())),
            Built::Operators(Operators { body, words, evaluator, measures, .. }) if !scene.is_reduced() => {
                let body = body.in_petsc(&comm.session().alone())?;
                let unknowns = body.unknowns();
                let gauges = || Gauges::new(comm, scene, evaluator, unknowns, None);
                let gauges = scene.output.is_read().then(gauges).transpose()?;
                Ok(Self { gauges, measures, ..Self::bare(theory, Dynamics::Stepped(body), unknowns, words) })
            }
            Built::Operators(built) => Self::on_basis(comm, scene, theory, fit(comm, scene, theory, built, watch)?),
        }
    }

    /// The model of a reduced body. Collective.
    fn on_basis(comm: &Comm, scene: &Scene, theory: scene::Model, fitted: Fitted) -> Result<Self> {
        let Fitted { reduced, unknowns, words, evaluator, measures, error: cells, .. } = fitted;
        let Reduced { projection, judge, of_difference, krylov, error, modal, modal_of_judge, .. } = reduced;
        let vectors = projection.vectors();
        let gauges = match (vectors, scene.output.is_read()) {
            (0, _) | (_, false) => None,
            _ => Some(Gauges::new(comm, scene, evaluator, unknowns, Some(krylov.whole(vectors)))?),
        };
        let dynamics = if scene.time.modal {
            Dynamics::Modal(modal.unwrap_or_else(|| ModalBody::of(&projection)))
        } else {
            Dynamics::Stepped(Box::new(Body::of(&comm.session().alone(), &projection.system())?))
        };
        let (vectors, judge) =
            (Some(vectors), Some((modal_of_judge.unwrap_or_else(|| ModalBody::of(&judge)), of_difference)));
        let model = Self { vectors, judge, gauges, measures, ..Self::bare(theory, dynamics, unknowns, words) };
        let model = model.with_error(Cause::Basis, error);
        Ok(match cells {
            Some(error) => model.with_error(Cause::Cells, error),
            None => model,
        })
    }

    /// Without a basis and without an error.
    fn bare(theory: scene::Model, dynamics: Dynamics, unknowns: usize, words: String) -> Self {
        Self {
            theory,
            dynamics,
            unknowns,
            words,
            vectors: None,
            judge: None,
            error: ErrorEstimate::default(),
            reason: None,
            gauges: None,
            measures: None,
        }
    }

    /// The same with one more error.
    fn with_error(self, cause: Cause, errors: Errors) -> Self {
        Self { error: self.error.with(cause, errors), ..self }
    }

    /// What is estimated before the first step: [`Model::error`], and that of the patch.
    pub fn error_before_steps(&self) -> ErrorEstimate {
        self.error.clone().with_patch(self.dynamics.patch().as_ref())
    }

    /// Estimated error by cells and theory.
    pub fn error_beside_basis(&self) -> Errors {
        self.error.without(Cause::Basis).total().unwrap_or_default()
    }

    /// What the basis is, for a result's attribute.
    pub fn reduction(&self) -> String {
        self.vectors.map_or("none".to_owned(), |vectors| format!("{vectors} Krylov vectors"))
    }
}
