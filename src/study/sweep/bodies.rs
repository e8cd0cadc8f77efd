//! Makes each body of a sweep once: members that differ only in the impactor, the gap, the times or the tolerance share
//! it.

use std::rc::Rc;

use petsc_wrap::Comm;

use super::by_body::{BodyOf, ByBody, chains, shared};
use super::family::{self, Family};
use super::grouping::{Found, Grouping, Line};
use super::member::Computed;
use crate::body::ModalBody;
use crate::error::{Error, Result};
use crate::impact::step::Step;
use crate::impact::{self, Cause, ErrorRule, Errors, ModalImpact, Reading, Readout, TimeIntegration as _, joined};
use crate::model::watch::{Until, Watch};
use crate::model::{
    BASIS_SHARE, Dynamics, JudgeBasis, LARGE_ERROR_OF_DEFLECTION, Linearity, Model, ModelContext, edges,
    largest_linear, may_lack_rotations, thickness_compression,
};
use crate::record::episodes::Episodes;
use crate::record::stress::{LargestTension, strengths};
use crate::scene::{self, Scene};
use crate::space::evaluate::ContactSize;

/// Largest number of bodies kept; when it is reached, all are dropped.
const MAX_BODIES: usize = 64;

/// Factor by which a member may exceed the share of the tolerance for the basis before another basis is made for it.
const SLACK: f64 = 2.0;

/// Largest compression of the thickness of a plate by a support, over its effect and the tolerance, with which members that
/// differ in the support's stiffness share a merged basis: half of it is in series with the support.
const LARGEST_COMPRESSION: f64 = 0.2;

/// Bodies and bases that the members of a sweep share.
pub struct Bodies<'a> {
    comm: Comm,
    grouping: &'a Grouping,
    scene_of: &'a dyn Fn(usize) -> Result<Scene>,
    /// The theory that `auto` selected for all members, with its estimated errors, if any member asks for `auto`.
    theory: Option<(scene::Model, Errors)>,
    /// Whether the energies are computed at each step.
    has_energies: bool,
    kept: ByBody<Kept>,
    /// Families by the body that their line shares; `None` if no merged basis was good enough.
    families: ByBody<Option<Family>>,
}

/// A body reduced to a basis. The error of each member is estimated as the given factor times the difference from a
/// second basis.
struct Kept {
    body: ModalBody,
    theory: scene::Model,
    judge: Option<(ModalBody, ErrorRule)>,
    unknowns: usize,
    /// Readout of the stresses on faces.
    readout: Option<Readout>,
    /// Estimated errors by theory and discretisation, as far as known, and by merging bases.
    of_model: Errors,
    /// The impact for which the basis was made, if known.
    made_for: Option<MadeFor>,
    /// Whether loads move the body and the impactor does not touch it: the basis is not for contacts.
    is_moved_by_loads: bool,
    /// Same as [`Model::may_lower_shift`].
    may_lower_shift: bool,
}

/// The impact for which a basis was made.
struct MadeFor {
    scene: Box<Scene>,
    /// Estimated errors of the basis in this impact. They use more bases than the judge.
    of_basis: Errors,
}

impl<'a> Bodies<'a> {
    /// Prepares the bodies for members on these ranks. `theory` is the theory that `auto` selected for all members,
    /// with the models made to select it. `scene_of` returns a member's scene by its number.
    pub fn new(
        comm: &Comm,
        grouping: &'a Grouping,
        scene_of: &'a dyn Fn(usize) -> Result<Scene>,
        theory: Option<Found>,
        has_energies: bool,
    ) -> Self {
        let errors = theory.as_ref().map(|found| (found.theory, found.errors));
        let mut bodies = Self {
            comm: comm.clone(),
            grouping,
            scene_of,
            theory: errors,
            has_energies,
            kept: ByBody::default(),
            families: ByBody::default(),
        };
        for (scene, model) in theory.into_iter().flat_map(|found| found.made) {
            let of_theory = bodies.error_of_theory(&scene);
            // Members with different relaxation share a basis that is made with a margin, so their models are not
            // reused.
            if let (false, Ok(kept)) = (scene.body.composition.is_viscoelastic(), Kept::of(&scene, model, of_theory)) {
                bodies.kept.get_or_insert_with(BodyOf::new(&scene), || kept);
            }
        }
        bodies
    }

    /// Computes a member in modal coordinates, on a stored basis if that is accurate enough. Collective.
    ///
    /// # Errors
    /// Same as a run.
    pub fn simulate(
        &mut self,
        index: usize,
        scene: &Scene,
        interrupted: &Rc<dyn Fn() -> bool>,
        observe: &mut dyn FnMut(&Step),
    ) -> Result<Option<Computed>> {
        let comm = self.comm.clone();
        let watch = &Until(&comm, &**interrupted);
        let tried = match self.of_family(index, scene, watch)? {
            Some(kept) => kept.simulate(scene, self.has_energies, interrupted),
            None => self.of_body(scene, interrupted)?,
        };
        let poor = match &tried {
            Ok(Some(tried)) => tried.needs_own_basis || tried.first > SLACK * BASIS_SHARE * scene.tolerance,
            Ok(None) => false,
            // A patch or a basis made for another impact may be unsuitable for this one.
            Err(_) => true,
        };
        let tried = if poor { self.make(scene, watch)?.simulate(scene, self.has_energies, interrupted) } else { tried };
        let Some(tried) = tried? else { return Ok(None) };
        tried.steps.iter().for_each(observe);
        Ok(Some(tried.outcome))
    }

    /// Computes a member on the basis made for its body.
    fn of_body(&mut self, scene: &Scene, interrupted: &Rc<dyn Fn() -> bool>) -> Result<Result<Option<Tried>>> {
        let (body, comm) = (BodyOf::new(scene), self.comm.clone());
        let watch = &Until(&comm, &**interrupted);
        if let Some(kept) = self.kept.get(&body) {
            return Ok(kept.simulate(scene, self.has_energies, interrupted));
        }
        let made = match self.grouping.representative(scene) {
            Some(index) => self.make(&shared((self.scene_of)(index)?), watch),
            None => self.make(scene, watch),
        };
        // A fault of the most demanding member need not apply to this one.
        let kept = made.or_else(|_| self.make(scene, watch))?;
        if self.kept.len() >= MAX_BODIES {
            self.kept.clear();
        }
        let kept = self.kept.get_or_insert_with(body, || kept);
        Ok(kept.simulate(scene, self.has_energies, interrupted))
    }

    /// Scene of the member of a line with a given value, with the theory of all members. The line is in ascending order
    /// of values.
    fn scene_on(&self, line: &[(f64, usize)], value: f64) -> Result<Scene> {
        let at = line.partition_point(|(other, _)| *other < value).min(line.len() - 1);
        Ok(self.named((self.scene_of)(line[at].1)?))
    }

    /// The body on the merged basis of all members that differ only in one support or in their relaxation, if they are
    /// at least [`family::MIN_VALUES`].
    fn of_family(&mut self, index: usize, scene: &Scene, watch: &dyn Watch) -> Result<Option<Kept>> {
        let Some(Line { body, value, count }) = self.grouping.line_of(index, scene) else { return Ok(None) };
        let is_open = scene.body.model == scene::Model::Auto && self.theory.is_none();
        // The local field of a plate depends on the relaxation too, and bodies of one family share it.
        let has_other_fields =
            self.grouping.is_of_relaxations() && self.named(scene.clone()).body.model != scene::Model::Solid;
        if count < family::MIN_VALUES || is_open || has_other_fields || scene.is_on_pads() {
            return Ok(None);
        }
        if self.families.get(&body).is_none() {
            if self.families.len() >= MAX_BODIES {
                self.families.clear();
            }
            let all = self.grouping.members_on(&body);
            let values: Vec<f64> = all.iter().map(|(value, _)| *value).collect();
            let family = |limits_deflection_error: bool| {
                let context = ModelContext { limits_deflection_error, ..ModelContext::new(&self.comm, watch) };
                // If one body of the family fails, the other members may still be computed separately.
                match Family::new(&context, &values, &|value| self.scene_on(&all, value)) {
                    Err(Error::Solve(_) | Error::Fault(_)) => Ok(None),
                    family => family,
                }
            };
            let named = self.named(scene.clone());
            let lacks_rotations = has_automatic_basis(&named) && may_lack_rotations(&named);
            // Merged bases mix the stiffness matrices of two values. On a plate, whose thickness is in series with a support, these are
            // not linear in its stiffness.
            let hardest = self.scene_on(&all, values[values.len() - 1])?;
            let varied = self.grouping.varied_stiffness().filter(|_| named.body.model != scene::Model::Solid);
            let compression = varied.map_or(0.0, |support| thickness_compression(&hardest, &hardest.supports[support]));
            let is_linear = compression <= LARGEST_COMPRESSION * hardest.tolerance;
            let mut made = if is_linear { family(lacks_rotations)? } else { None };
            let is_poor = !lacks_rotations && made.as_ref().is_some_and(|made| made.needs_low_shift(&named));
            if watch.decided(is_poor) {
                made = family(true)?.or(made);
            }
            self.families.get_or_insert_with(body.clone(), || made);
        }
        let of_theory = self.error_of_theory(scene);
        let theory = self.named(scene.clone()).body.model;
        let family = self.families.get(&body).and_then(Option::as_ref);
        Ok(family.map(|family| {
            let ([body, larger], of_merging) = family.at(value, &chains(scene));
            Kept {
                body,
                theory,
                judge: Some((larger, ErrorRule::with_factor(family::ERROR_FACTOR_OF_MERGED))),
                unknowns: family.unknowns,
                readout: family.readout.clone(),
                of_model: of_theory.joined(Errors { stress: f64::NAN, stress_history: f64::NAN, ..of_merging }),
                made_for: None,
                is_moved_by_loads: false,
                may_lower_shift: false,
            }
        }))
    }

    /// A scene with the theory that `auto` selected for all members.
    pub fn named(&self, scene: Scene) -> Scene {
        match (scene.body.model, self.theory) {
            (scene::Model::Auto, Some((theory, _))) => {
                let body = scene::Body { model: theory, ..scene.body };
                Scene { body, ..scene }
            }
            _ => scene,
        }
    }

    /// Estimated errors of the theory that `auto` selected for all members; 0 if the scene names its theory.
    pub fn error_of_theory(&self, scene: &Scene) -> Errors {
        match (scene.body.model, self.theory) {
            (scene::Model::Auto, Some((_, error))) => error,
            _ => Errors::default(),
        }
    }

    fn make(&self, scene: &Scene, watch: &dyn Watch) -> Result<Kept> {
        let model = Model::made(&ModelContext::new(&self.comm, watch), &self.named(scene.clone()))?;
        Kept::of(scene, model, self.error_of_theory(scene))
    }
}

impl Kept {
    /// Takes the body from a model of a scene in modal coordinates. `of_theory` are the errors of the theory selected for
    /// all members.
    fn of(scene: &Scene, model: Model, of_theory: Errors) -> Result<Self> {
        // Each member has its own contact.
        let of_others = [Cause::Basis, Cause::Theory, Cause::ContactLaw];
        let of_others = of_others.into_iter().fold(model.error.clone(), |error, cause| error.without(cause));
        let of_others = of_others.total().unwrap_or_default();
        let of_model = of_theory.joined(of_others);
        let made_for = model.error.of(Cause::Basis);
        let made_for = made_for.map(|of_basis| MadeFor { scene: Box::new(scene.clone()), of_basis });
        let Model { theory, dynamics, judge, unknowns, gauges, is_untouched, may_lower_shift, .. } = model;
        let readout = gauges.map(|gauges| gauges.readout);
        let judge = judge.map(JudgeBasis::into_modal);
        match dynamics {
            Dynamics::Modal(body) => Ok(Self {
                is_moved_by_loads: is_untouched && body.is_loaded(),
                body,
                theory,
                judge,
                unknowns,
                readout,
                of_model,
                made_for,
                may_lower_shift,
            }),
            Dynamics::Stepped(_) => Err(Error::Solve("the body has no modal coordinates".into())),
        }
    }

    /// Whether the error of a member's deflection is estimated: its basis was compared with another, it has the rotations
    /// of the body, and there is no contact patch.
    fn estimates_deflection(&self, scene: &Scene) -> bool {
        let is_compared = self.made_for.is_some() || self.judge.is_some();
        let lacks_rotations = match &self.made_for {
            Some(MadeFor { of_basis, .. }) => of_basis.deflection.is_nan(),
            // Automatic bases of families have a low shift if they would lack rotations.
            None => may_lack_rotations(scene) && !has_automatic_basis(scene),
        };
        is_compared && !lacks_rotations && self.body.footprint.patch().is_none()
    }

    /// Computes a member on this body; `None` if interrupted.
    fn simulate(&self, scene: &Scene, has_energies: bool, interrupted: &Rc<dyn Fn() -> bool>) -> Result<Option<Tried>> {
        let mut steps = Vec::new();
        let relaxing = chains(scene);
        let with_chains = |body: &ModalBody| body.with_chains(&relaxing);
        let own = with_chains(&self.body)?;
        let body = own.as_ref().unwrap_or(&self.body);
        let mut impact = ModalImpact::new(scene, body);
        if !has_energies {
            impact = impact.without_energies();
        }
        let names = self.readout.as_ref().map_or_else(Vec::new, Readout::face_names);
        let (mut tension, strengths) = (LargestTension::default(), strengths(&scene.strength, &names));
        if let Some(readout) = &self.readout {
            let least = strengths.iter().flatten().copied().fold(f64::INFINITY, f64::min);
            impact.set_readout(Readout {
                contact: ContactSize::new(scene),
                least_tension: Some(least),
                ..readout.clone()
            })?;
        }
        let mut contacts = Episodes::default();
        let take = |step: &Step, reading: &Reading| {
            contacts.push(step);
            tension.take(step.time, &reading.faces, &strengths);
            steps.push(*step);
        };
        if impact.run_watched(&mut impact::Until { interrupted: &**interrupted, take })?.is_break() {
            return Ok(None);
        }
        let linearity = Linearity::new(scene, self.theory, self.body.footprint.patch().as_ref());
        let deflection_over_thickness = linearity.map_or(f64::NAN, |linearity| {
            let each = steps.iter().map(|step| linearity.over_thickness(linearity.deflection(step)));
            each.fold(0.0, f64::max)
        });
        // Only the energies tell which part of the deflection is due to the compliance of the supports.
        let yields = scene.supports.iter().any(|support| !support.is_rigid());
        let is_doubtful = yields && deflection_over_thickness > largest_linear(edges(scene));
        if !has_energies && is_doubtful {
            return self.simulate(scene, true, interrupted);
        }
        let made_for_this = self.made_for.as_ref().filter(|made_for| *made_for.scene == *scene);
        let of_basis = match (made_for_this, &self.judge) {
            // Without a contact, the error is unknown. A member with a contact may need another basis.
            _ if impact.force().is_some_and(|(force, _)| !force.has_contact()) => Errors::throughout(f64::NAN),
            _ if self.is_moved_by_loads => Errors::throughout(f64::INFINITY),
            (Some(made_for), _) => made_for.of_basis,
            (None, Some((judge, rule))) => {
                let Some((force, taken)) = impact.force() else { return Ok(None) };
                let own = with_chains(judge)?;
                let judge = own.as_ref().unwrap_or(judge);
                rule.errors(force.difference(&ModalImpact::new(scene, judge).trace(Some(*taken))?.0))
            }
            (None, None) => Errors::default(),
        };
        let of_patch = Errors::throughout(self.body.footprint.patch().and_then(|patch| patch.error()).unwrap_or(0.0));
        // Hertz's law is exact on a half-space.
        let is_exact = self.theory == scene::Model::HalfSpace;
        let of_law = Errors::throughout(if is_exact { 0.0 } else { scene.impactor.error_of_law() });
        let all = of_basis.joined(self.of_model).joined(of_patch).joined(of_law);
        let (error_estimate, first_error) = (joined(impact.count.error.unwrap_or(0.0), all.history), all.first_contact);
        // Given steps have no error estimate, and their error counts as 0. Adaptive steps without an estimate of the
        // stress error give NaN.
        let of_steps = if impact.count.error.is_some() { f64::NAN } else { 0.0 };
        let impact::Count { stress_error, stress_history_error, .. } = impact.count;
        let of_steps_of_stress = Errors {
            stress: stress_error.unwrap_or(of_steps),
            stress_history: stress_history_error.unwrap_or(of_steps),
            ..Errors::default()
        };
        let first_end = contacts.all().first().map(|first| first.end);
        tension = tension.with_error(&all.joined(of_steps_of_stress), scene, first_end);
        let deflection_error = if self.estimates_deflection(scene) {
            joined(impact.count.deflection_error.unwrap_or(of_steps), all.deflection)
        } else {
            f64::NAN
        };
        let unknowns = self.unknowns + 1;
        let outcome =
            Computed { error_estimate, first_error, deflection_error, deflection_over_thickness, unknowns, tension };
        let needs_own_basis = self.may_lower_shift && of_basis.deflection > LARGE_ERROR_OF_DEFLECTION;
        Ok(Some(Tried { steps, first: of_basis.of(scene.measure), needs_own_basis, outcome }))
    }
}

/// Whether the number of basis vectors follows from the tolerance.
fn has_automatic_basis(scene: &Scene) -> bool {
    scene.body.reduction == scene::Reduction::Auto
}

/// Result of computing a member.
struct Tried {
    steps: Vec<Step>,
    /// Estimated error of the basis in the quantity that the tolerance applies to.
    first: f64,
    /// Whether a basis with a low shift is needed for the deflection, and the member's own model has one.
    needs_own_basis: bool,
    outcome: Computed,
}
