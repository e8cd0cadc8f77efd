//! Messages about a model before the first step.

use petsc_wrap::Comm;

use crate::contact::Footprint;
use crate::error::{Error, Result};
use crate::model::{Model, Simulation};
use crate::scene::Scene;
use crate::solve::linear::has_mumps;

use super::super::note;
use super::super::notes::{self, Said, Verdict, describe_model, verdict};

/// Texts of the messages, prepared while the model exists.
pub(super) struct Announcement {
    /// Warning that the estimated error is above the tolerance.
    pub poor: Option<String>,
    described: String,
    reason: Option<String>,
    /// Warnings about the geometry of the scene.
    warnings: Vec<String>,
    of_measure: Option<String>,
    footprint: Footprint,
    is_factorised: bool,
}

impl Announcement {
    /// Prepares the messages about a model.
    ///
    /// # Errors
    /// [`Error::Solve`] if the result would be of no use, unless `force` is set.
    pub fn new(model: &Model, scene: &Scene, force: bool) -> Result<Self> {
        let poor = match verdict(model, scene) {
            Some(Verdict { message, is_useless: true }) if !force => {
                return Err(Error::Solve(format!(
                    "{message}. The result would be of no use; --force computes it all the same"
                )));
            }
            verdict => verdict.map(|verdict| verdict.message),
        };
        Ok(Self {
            poor,
            described: describe_model(model, scene),
            reason: model.reason.clone(),
            warnings: notes::texts(notes::of_geometry(scene, model.measures.as_ref())),
            of_measure: notes::note_of_measure(model, scene),
            footprint: model.dynamics.footprint(),
            is_factorised: model.dynamics.is_factorised_on_ranks(),
        })
    }

    /// Prints the messages; warnings and notes are kept in `said`.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn print(self, comm: &Comm, scene: &Scene, impact: &Simulation, said: &mut Said) -> Result<()> {
        said.warn(self.poor);
        said.print(said.count());
        note(format_args!("{}", self.described));
        if let Some(reason) = &self.reason {
            note(format_args!("{reason}"));
        }
        said.warn(self.warnings);
        said.warn(notes::texts(notes::missing_faces(scene, impact.faces())));
        said.note(notes::texts(notes::notes(scene, Some(self.footprint), impact.plan().as_ref())));
        said.note(self.of_measure);
        if self.is_factorised && !has_mumps(comm.session())? {
            let text = "this PETSc is without MUMPS: a matrix that the ranks do not share by substructures is factorised by each of them, so that more \
                        ranks save nothing there";
            said.note([text.to_owned()]);
        }
        said.print(said.count());
        Ok(())
    }
}
