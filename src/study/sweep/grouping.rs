//! Groups the members of a sweep that share a body, and finds the most demanding member of each group.

use std::collections::HashMap;

use petsc_wrap::Comm;

use crate::error::{Error, Result};
use crate::impact::{Cause, Errors};
use crate::model::watch::Watch;
use crate::model::{Model, ModelContext, admits};
use crate::scene::{self, Scene, Support, SupportKind};

use super::by_body::BodyOf;

/// Families of members that differ only in the impactor, the gap, the times or the tolerance, by their body. Each
/// family's basis is made for its most demanding member, by tolerance and then by contact time. No result therefore
/// depends on the order of members.
#[derive(Debug, Default)]
pub struct Grouping {
    families: HashMap<BodyOf, Member>,
    ends: Vec<usize>,
    /// The varied property of a line, if exactly one is varied, with each member's value.
    line: Option<(Property, Vec<f64>)>,
    /// Lines by all properties of the body except the varied one: the most demanding member of each value, in order of
    /// the values.
    lines: HashMap<BodyOf, Vec<(f64, Member)>>,
}

/// The theory selected for all members.
pub struct Found {
    /// The selected theory.
    pub theory: scene::Model,
    /// First member that needs this theory, if a simpler one suffices for other tested members.
    pub asked_by: Option<usize>,
    /// First tested member for which the layerwise theory suffices. It is given if all members are computed as solids and
    /// the layerwise theory admits the member in `asked_by`, too.
    pub layerwise_suffices: Option<usize>,
    /// Largest errors of this theory that `auto` estimated, if it estimated any.
    pub errors: Option<Errors>,
    /// Models of this theory that were made to select it, with their scenes; each has the basis of its own body.
    pub(super) made: Vec<(Scene, Model)>,
}

/// A line of members that differ only in one support's stiffness or damping, or in the relaxation of an interlayer's
/// shear modulus.
pub struct Line {
    /// Description of the body without the varied property.
    pub body: BodyOf,
    /// Value of one member.
    pub value: f64,
    /// Number of different values on the line.
    pub count: usize,
}

/// The property in which the bodies of a line differ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Property {
    /// Stiffness of the support with this index.
    Stiffness(usize),
    /// Damping of the support with this index.
    Damping(usize),
    /// Relaxation of interlayers: the temperature, or the long-term (equilibrium) shear modulus.
    Relaxation,
}

#[derive(Debug, Clone, Copy)]
struct Member {
    index: usize,
    contact: f64,
    tolerance: f64,
}

impl Member {
    /// The member that demands more of a body: a smaller tolerance, then a shorter contact.
    fn harder(self, other: Self) -> Self {
        let order = |member: &Self| (member.tolerance, member.contact, member.index);
        if order(&other) < order(&self) { other } else { self }
    }
}

impl Grouping {
    /// Adds a member, with its value on the line of [`Grid::line`](super::Grid::line).
    pub fn count(&mut self, index: usize, scene: &Scene, on_line: Option<(Property, f64)>) {
        // Contact damping makes the contact stiffer from the first touch on, so it counts as a shorter contact.
        let contact = scene.impactor.contact_time() / (1.0 + scene.impactor.damping * scene.impactor.hit_speed());
        let member = Member { index, contact, tolerance: scene.tolerance };
        // Elastic bodies are the same at all temperatures.
        let differ = |(property, _): &(Property, f64)| {
            *property != Property::Relaxation || scene.body.composition.is_viscoelastic()
        };
        if let Some((property, value)) = on_line {
            self.line.get_or_insert((property, Vec::new())).1.push(value);
        }
        if let Some((property, value)) = on_line.filter(differ) {
            let line = self.lines.entry(without(scene, property)).or_default();
            match line.binary_search_by(|(other, _)| other.total_cmp(&value)) {
                Ok(place) => line[place].1 = line[place].1.harder(member),
                Err(place) => line.insert(place, (value, member)),
            }
        }
        self.families.entry(BodyOf::new(scene)).and_modify(|most| *most = most.harder(member)).or_insert(member);
        self.ends.truncate(1);
        self.ends.push(index);
    }

    /// The member for which the basis of a scene's family is made.
    pub fn representative(&self, scene: &Scene) -> Option<usize> {
        self.families.get(&BodyOf::new(scene)).map(|member| member.index)
    }

    /// The line of a member, with the member's value.
    pub fn line_of(&self, index: usize, scene: &Scene) -> Option<Line> {
        let (property, values) = self.line.as_ref()?;
        let body = without(scene, *property);
        let count = self.lines.get(&body)?.len();
        Some(Line { body, value: values[index], count })
    }

    /// Index of the support whose stiffness differs between the bodies of a line.
    pub fn varied_stiffness(&self) -> Option<usize> {
        if let Some((Property::Stiffness(support), _)) = self.line { Some(support) } else { None }
    }

    /// Whether the bodies of a line differ in their relaxation.
    pub fn is_of_relaxations(&self) -> bool {
        matches!(self.line, Some((Property::Relaxation, _)))
    }

    /// The values of a line, ascending, each with its most demanding member.
    pub fn members_on(&self, line: &BodyOf) -> Vec<(f64, usize)> {
        let all = self.lines.get(line).into_iter().flatten();
        all.map(|(value, member)| (*value, member.index)).collect()
    }

    /// The theory for all members: the highest one that `auto` selects for the first, the last and the most demanding
    /// member. Of these, members whose models cannot be solved or do not fit their meshes are passed over. Collective.
    ///
    /// # Errors
    /// Same as making a model, if none of these models can be made.
    pub fn theory(&self, comm: &Comm, scene_of: impl Fn(usize) -> Result<Scene>, watch: &dyn Watch) -> Result<Found> {
        let hardest = self.families.values().copied().reduce(Member::harder);
        let mut asked = self.ends.clone();
        asked.extend(hardest.map(|member| member.index));
        asked.sort_unstable();
        asked.dedup();
        let none = |theory| Found { theory, asked_by: None, layerwise_suffices: None, errors: None, made: Vec::new() };
        let mut found = none(scene::Model::HalfSpace);
        let (mut theories, mut failed) = (Vec::new(), None);
        for index in asked {
            let scene = scene_of(index)?;
            let model = match Model::made(&ModelContext::new(comm, watch), &scene) {
                Err(error @ (Error::Solve(_) | Error::Fault(_))) => {
                    failed = Some(error);
                    continue;
                }
                model => model?,
            };
            theories.push((index, model.theory));
            if model.theory > found.theory {
                found = none(model.theory);
            }
            if model.theory == found.theory {
                if let Some(errors) = model.error.of(Cause::Theory) {
                    found.errors = Some(found.errors.map_or(errors, |largest| largest.max(errors)));
                }
                // A model made by several ranks together can be read by only one of them. For layers `auto` uses a
                // smaller tolerance for cells and basis than the layerwise theory called by its name. Such models are
                // not kept.
                let is_alike = comm.size() == 1 && model.theory != scene::Model::Layerwise;
                if is_alike && self.representative(&scene) == Some(index) {
                    found.made.push((scene, model));
                }
            }
            comm.collect_garbage()?;
        }
        if let Some(error) = failed.filter(|_| theories.is_empty()) {
            return Err(error);
        }
        let first_with = |wanted| theories.iter().find(|(_, theory)| *theory == wanted).map(|(index, _)| *index);
        if theories.iter().any(|(_, theory)| *theory != found.theory) {
            found.asked_by = first_with(found.theory);
        }
        let is_layerwise = |index| Ok::<_, Error>(admits(&scene_of(index)?, scene::Model::Layerwise).is_ok());
        if let (scene::Model::Solid, Some(index)) = (found.theory, found.asked_by)
            && is_layerwise(index)?
        {
            found.layerwise_suffices = first_with(scene::Model::Layerwise);
        }
        Ok(found)
    }
}

/// The description of a scene's body without a property.
fn without(scene: &Scene, property: Property) -> BodyOf {
    let mut scene = scene.clone();
    match property {
        Property::Relaxation => return BodyOf::of_relaxations(&scene),
        Property::Damping(support) => {
            if let Some(support) = scene.supports.get_mut(support) {
                support.damping = [0.0; 3];
            }
        }
        Property::Stiffness(support) => {
            let support = scene.supports.get_mut(support);
            if let Some(Support { kind: SupportKind::Elastic { stiffness }, .. }) = support {
                *stiffness = [0.0; 3];
            }
        }
    }
    BodyOf::new(&scene)
}
