//! A model on which the impacts of several scenes are computed.

use std::rc::Rc;

use crate::body::ModalBody;
use crate::error::{Error, Result};
use crate::impact::{Cause, ErrorEstimate, ErrorRule, Errors, ModalImpact, Readout, Steps, Trace};
use crate::material::Maxwell;
use crate::scene::{self, Scene};
use crate::space::evaluate::ContactSize;

use super::{Dynamics, JudgeBasis, Model, Simulation, has_automatic_basis, may_lack_rotations};

/// A body reduced to a basis. The error of the basis in each impact is estimated by the force on a second basis.
pub struct SharedModel {
    /// Theory of the body.
    pub theory: scene::Model,
    /// The body.
    pub body: Rc<ModalBody>,
    /// The body on the second basis, and the rule that estimates the error from the difference of the forces.
    pub judge: Option<(ModalBody, ErrorRule)>,
    /// Number of unknowns of the body before any reduction.
    pub unknowns: usize,
    /// Readout of the stresses on faces.
    pub readout: Option<Readout>,
    /// Estimated error by cause; that of the basis is for the impact of `made_for`.
    pub error: ErrorEstimate,
    /// The scene for which the basis was made, if the error of the basis is known for it.
    pub made_for: Option<Box<Scene>>,
    /// Whether loads move the body and the impactor does not touch it: the basis is not for contacts.
    pub is_moved_by_loads: bool,
    /// Same as [`Model::may_lower_shift`].
    pub may_lower_shift: bool,
}

impl SharedModel {
    /// Shares the model of a scene.
    ///
    /// # Errors
    /// [`Error::Solve`] if the model is not in modal coordinates.
    pub fn new(scene: &Scene, model: Model) -> Result<Self> {
        let Model { theory, dynamics, judge, unknowns, gauges, error, is_untouched, may_lower_shift, .. } = model;
        let Dynamics::Modal(body) = dynamics else {
            return Err(Error::Solve("the body has no modal coordinates".into()));
        };
        Ok(Self {
            theory,
            is_moved_by_loads: is_untouched && body.is_loaded(),
            body: Rc::new(body),
            judge: judge.map(JudgeBasis::into_modal),
            unknowns,
            readout: gauges.map(|gauges| gauges.readout),
            made_for: error.of(Cause::Basis).map(|_| Box::new(scene.clone())),
            error,
            may_lower_shift,
        })
    }

    /// The impact of a scene on this body, with other Prony series for its viscoelastic parts. Steps with tensions below
    /// `least_tension` (Pa) are not searched for the largest one.
    ///
    /// # Errors
    /// Same as [`ModalBody::with_chains`].
    pub fn simulation(
        &self,
        scene: &Scene,
        chains: &[Maxwell],
        has_energies: bool,
        least_tension: f64,
    ) -> Result<Simulation> {
        let body = self.body.with_chains(chains)?.map_or_else(|| self.body.clone(), Rc::new);
        let patch = body.footprint.patch();
        let impact = ModalImpact::new(scene, body);
        let impact = if has_energies { impact } else { impact.without_energies() };
        let contact = ContactSize::new(scene);
        let readout = self.readout.clone();
        let readout = readout.map(|readout| Readout { contact, least_tension: Some(least_tension), ..readout });
        Simulation::of((scene, self.theory, self.unknowns), Box::new(impact), self.error.clone(), patch, readout)
    }

    /// Estimated error of this model in a scene's impact, with the force of that impact and its time steps.
    ///
    /// # Errors
    /// Same as a run on the second basis.
    pub fn error_in(&self, scene: &Scene, chains: &[Maxwell], force: &(Trace, Steps)) -> Result<ErrorEstimate> {
        let (force, steps) = force;
        // Without a contact, the error is unknown.
        if !force.has_contact() {
            return Ok(ErrorEstimate::default());
        }
        let error = self.error.clone();
        let made_for_this = self.made_for.as_ref().is_some_and(|made_for| **made_for == *scene);
        let error = match &self.judge {
            _ if self.is_moved_by_loads => error.with(Cause::Basis, Errors::throughout(f64::INFINITY)),
            Some((judge, rule)) if !made_for_this => {
                let own = judge.with_chains(chains)?;
                let (other, _) = ModalImpact::new(scene, own.as_ref().unwrap_or(judge)).trace(Some(*steps))?;
                let mut of_basis = rule.errors(force.difference(&other));
                // Two bases that both lack the rotations of the body agree and are wrong.
                let may_lack = || may_lack_rotations(scene) && !has_automatic_basis(scene);
                if error.of(Cause::Basis).map_or_else(may_lack, |of_basis| of_basis.deflection.is_nan()) {
                    of_basis.deflection = f64::NAN;
                }
                error.with(Cause::Basis, of_basis)
            }
            _ => error,
        };
        Ok(error.with_law(scene))
    }
}
