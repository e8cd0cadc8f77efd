//! Makes each body of a sweep once: members that differ only in the impactor, the gap, the times or the tolerance share
//! it.

use std::collections::HashMap;
use std::rc::Rc;

use petsc_wrap::Comm;

use super::by_body::{BodyOf, chains, shared};
use super::family::{self, Family};
use super::grouping::{Found, Grouping, Line};
use super::member::{Computed, run};
use crate::error::{Error, Result};
use crate::impact::step::Step;
use crate::impact::{Cause, ErrorEstimate, ErrorRule, Errors, Readout, Steps, Trace};
use crate::model::watch::{Until, Watch};
use crate::model::{
    BASIS_SHARE, LARGE_ERROR_OF_DEFLECTION, Model, ModelContext, SharedModel, edges, has_automatic_basis,
    largest_linear, made_with_low_shift, may_lack_rotations, thickness_compression,
};
use crate::record::stress::strengths;
use crate::scene::{self, Scene};

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
    theory: Option<(scene::Model, Option<Errors>)>,
    /// Whether the energies are computed at each step.
    has_energies: bool,
    kept: HashMap<BodyOf, Rc<SharedModel>>,
    /// Families by the body that their line shares; `None` if no merged basis was good enough.
    families: HashMap<BodyOf, Option<Family>>,
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
            kept: HashMap::new(),
            families: HashMap::new(),
        };
        for (scene, model) in theory.into_iter().flat_map(|found| found.made) {
            let model = Model { error: bodies.with_error_of_theory(&scene, model.error), ..model };
            // Members with different relaxation share a basis that is made with a margin, so their models are not
            // reused.
            if let (false, Ok(kept)) = (scene.body.composition.is_viscoelastic(), SharedModel::new(&scene, model)) {
                bodies.kept.entry(BodyOf::new(&scene)).or_insert(Rc::new(kept));
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
        let kept = match self.of_family(index, scene, watch)? {
            Some(kept) => Rc::new(kept),
            None => self.of_body(scene, watch)?,
        };
        let tried = self.simulate_on(&kept, scene, &**interrupted);
        let is_poor = match &tried {
            Ok(Some(tried)) => {
                let of_basis = tried.of_basis.unwrap_or_default();
                of_basis.of(scene.measure) > SLACK * BASIS_SHARE * scene.tolerance
                    || kept.may_lower_shift && of_basis.deflection > LARGE_ERROR_OF_DEFLECTION
            }
            Ok(None) => false,
            // A patch or a basis made for another impact may be unsuitable for this one.
            Err(_) => true,
        };
        let tried =
            if is_poor { self.simulate_on(&self.make_shared(scene, watch)?, scene, &**interrupted) } else { tried };
        let Some(tried) = tried? else { return Ok(None) };
        tried.steps.iter().for_each(observe);
        Ok(Some(tried.outcome))
    }

    /// Computes a member on a body; `None` if interrupted.
    fn simulate_on(&self, kept: &SharedModel, scene: &Scene, interrupted: &dyn Fn() -> bool) -> Result<Option<Tried>> {
        let names = kept.readout.as_ref().map_or_else(Vec::new, Readout::face_names);
        let least = strengths(&scene.strength, &names).into_iter().flatten().fold(f64::INFINITY, f64::min);
        let chains = chains(scene);
        let once = |has_energies: bool| {
            let mut simulation = kept.simulation(scene, &chains, has_energies, least)?;
            let (mut steps, mut of_basis) = (Vec::new(), None);
            let mut judge = |force: &(Trace, Steps)| {
                let error = kept.error_in(scene, &chains, force)?;
                of_basis = error.of(Cause::Basis);
                Ok(error)
            };
            let outcome = run(scene, &mut simulation, interrupted, Some(&mut judge), |step, _| steps.push(*step))?;
            Ok::<_, Error>(outcome.map(|outcome| Tried { steps, of_basis, outcome }))
        };
        let tried = once(self.has_energies)?;
        // Only the energies tell which part of the deflection is due to the compliance of the supports.
        let yields = scene.supports.iter().any(|support| !support.is_rigid());
        let is_large = |tried: &Tried| tried.outcome.deflection_over_thickness > largest_linear(edges(scene));
        if !self.has_energies && yields && tried.as_ref().is_some_and(is_large) { once(true) } else { Ok(tried) }
    }

    /// The basis made for a member's body.
    fn of_body(&mut self, scene: &Scene, watch: &dyn Watch) -> Result<Rc<SharedModel>> {
        let body = BodyOf::new(scene);
        if let Some(kept) = self.kept.get(&body) {
            return Ok(kept.clone());
        }
        let made = match self.grouping.representative(scene) {
            Some(index) => self.make_shared(&shared((self.scene_of)(index)?), watch),
            None => self.make_shared(scene, watch),
        };
        // A fault of the most demanding member need not apply to this one.
        let kept = Rc::new(made.or_else(|_| self.make_shared(scene, watch))?);
        if self.kept.len() >= MAX_BODIES {
            self.kept.clear();
        }
        self.kept.insert(body, kept.clone());
        Ok(kept)
    }

    /// Scene of the member of a line with a given value, with the theory of all members. The line is in ascending order
    /// of values.
    fn scene_on(&self, line: &[(f64, usize)], value: f64) -> Result<Scene> {
        let at = line.partition_point(|(other, _)| *other < value).min(line.len() - 1);
        Ok(self.named((self.scene_of)(line[at].1)?))
    }

    /// The body on the merged basis of all members that differ only in one support or in their relaxation, if they are
    /// at least [`family::MIN_VALUES`].
    fn of_family(&mut self, index: usize, scene: &Scene, watch: &dyn Watch) -> Result<Option<SharedModel>> {
        let Some(Line { body, value, count }) = self.grouping.line_of(index, scene) else { return Ok(None) };
        let is_open = scene.body.model == scene::Model::Auto && self.theory.is_none();
        // The local field of a plate depends on the relaxation too, and bodies of one family share it.
        let has_other_fields =
            self.grouping.is_of_relaxations() && self.named(scene.clone()).body.model != scene::Model::Solid;
        if count < family::MIN_VALUES || is_open || has_other_fields || scene.is_on_pads() {
            return Ok(None);
        }
        if !self.families.contains_key(&body) {
            if self.families.len() >= MAX_BODIES {
                self.families.clear();
            }
            let all = self.grouping.members_on(&body);
            let values: Vec<f64> = all.iter().map(|(value, _)| *value).collect();
            let named = self.named(scene.clone());
            // Merged bases mix the stiffness matrices of two values. On a plate, whose thickness is in series with a support, these are
            // not linear in its stiffness.
            let hardest = self.scene_on(&all, values[values.len() - 1])?;
            let varied = self.grouping.varied_stiffness().filter(|_| named.body.model != scene::Model::Solid);
            let compression = varied.map_or(0.0, |support| thickness_compression(&hardest, &hardest.supports[support]));
            let is_linear = compression <= LARGEST_COMPRESSION * hardest.tolerance;
            let context = ModelContext::new(&self.comm, watch);
            let make = |context: &ModelContext| Family::new(context, &values, &|value| self.scene_on(&all, value));
            let made = match is_linear {
                true => made_with_low_shift(&context, &named, make, |family| family.needs_low_shift(&named)),
                false => Err(Error::Solve("the bodies are not linear in the stiffness of the support".into())),
            };
            let made = match made {
                // If one body of the family fails, the other members may still be computed separately.
                Err(why @ (Error::Solve(_) | Error::Fault(_))) => {
                    tracing::debug!("members have bases of their own: {why}");
                    None
                }
                made => Some(made?),
            };
            self.families.insert(body.clone(), made);
        }
        let Some(family) = self.families.get(&body).and_then(Option::as_ref) else { return Ok(None) };
        let ([body, larger], of_merging) = family.at(value, &chains(scene));
        // Automatic bases of families have a low shift if they would lack rotations.
        let lacks_rotations = may_lack_rotations(scene) && !has_automatic_basis(scene);
        let of_basis = Errors { deflection: if lacks_rotations { f64::NAN } else { 0.0 }, ..Errors::default() };
        let of_merging = Errors { stress: f64::NAN, stress_history: f64::NAN, ..of_merging };
        let error = ErrorEstimate::default().with(Cause::Basis, of_basis).with(Cause::Cells, of_merging);
        Ok(Some(SharedModel {
            theory: self.named(scene.clone()).body.model,
            body: Rc::new(body),
            judge: Some((larger, ErrorRule::with_factor(family::ERROR_FACTOR_OF_MERGED))),
            unknowns: family.unknowns,
            readout: family.readout.clone(),
            error: self.with_error_of_theory(scene, error),
            made_for: None,
            is_moved_by_loads: false,
            may_lower_shift: false,
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

    /// An error estimate with the errors of the theory that `auto` selected for all members, if the scene asks for `auto`.
    fn with_error_of_theory(&self, scene: &Scene, error: ErrorEstimate) -> ErrorEstimate {
        match (scene.body.model, self.theory) {
            (scene::Model::Auto, Some((_, Some(of_theory)))) => error.with(Cause::Theory, of_theory),
            _ => error,
        }
    }

    /// The model of a member alone, in the theory of all members. Collective.
    ///
    /// # Errors
    /// Same as [`Model::made`].
    pub(super) fn make(&self, scene: &Scene, watch: &dyn Watch) -> Result<Model> {
        let model = Model::made(&ModelContext::new(&self.comm, watch), &self.named(scene.clone()))?;
        // Without a contact nothing is estimated.
        if model.is_untouched {
            return Ok(model);
        }
        Ok(Model { error: self.with_error_of_theory(scene, model.error), ..model })
    }

    fn make_shared(&self, scene: &Scene, watch: &dyn Watch) -> Result<SharedModel> {
        SharedModel::new(scene, self.make(scene, watch)?)
    }
}

/// Result of computing a member on a shared body.
struct Tried {
    steps: Vec<Step>,
    /// Estimated errors of the basis.
    of_basis: Option<Errors>,
    outcome: Computed,
}
