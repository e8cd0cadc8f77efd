//! Which theory stands for a scene's body, on what basis, and the impacts that are run of it.

mod climb;
mod reduce;
mod simulation;
mod theory;

pub use reduce::{OF_BASIS, Reduced, SAFETY, rate, reduce};
pub use simulation::Simulation;
pub use theory::{Built, admits, build, name};

use petsc_wrap::Comm;

use crate::body::{Body, ModalBody};
use crate::contact::Patch;
use crate::error::Result;
use crate::scene::{self, Reduction, Scene};

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
    /// The body on a larger basis, by which this one is judged.
    pub larger: Option<ModalBody>,
    /// Estimated error of the acceleration over its peak by the basis and the theory: in the first contact, and over all.
    pub error: Option<(f64, f64)>,
    /// Why this theory and not another, where that was to be found.
    pub reason: Option<String>,
}

/// How a body moves.
pub enum Dynamics {
    /// Step by step, in its unknowns.
    Stepped(Box<Body>),
    /// In modal coordinates.
    Modal(ModalBody),
}

impl Dynamics {
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
        match scene.body.model {
            scene::Model::Auto => climb::climb(comm, scene),
            theory => Self::of(comm, scene, theory),
        }
    }

    /// One theory's model. Collective.
    fn of(comm: &Comm, scene: &Scene, theory: scene::Model) -> Result<Self> {
        let model = |dynamics, unknowns, words| Self {
            theory,
            dynamics,
            unknowns,
            words,
            vectors: None,
            larger: None,
            error: None,
            reason: None,
        };
        match build(comm, scene, theory)? {
            Built::Given(body) => Ok(model(Dynamics::Modal(body), 0, "a formula".to_owned())),
            Built::Operators(body, words) => {
                let unknowns = body.unknowns();
                if !scene.time.modal && !matches!(scene.body.reduction, Reduction::Vectors(_)) {
                    return Ok(model(Dynamics::Stepped(body), unknowns, words));
                }
                let Reduced { projection, larger, error, .. } = reduce(&body, scene)?;
                drop(body);
                comm.collect_garbage()?;
                let dynamics = if scene.time.modal {
                    Dynamics::Modal(ModalBody::of(&projection))
                } else {
                    Dynamics::Stepped(Box::new(Body::of(&comm.session().alone(), &projection.system())?))
                };
                let vectors = Some(projection.vectors());
                let larger = Some(ModalBody::of(&larger));
                Ok(Self { vectors, larger, error: Some(error), ..model(dynamics, unknowns, words) })
            }
        }
    }

    /// What the basis is, for a result's attribute.
    pub fn reduction(&self) -> String {
        self.vectors.map_or("none".to_owned(), |vectors| format!("{vectors} Krylov vectors"))
    }
}
