//! Which members of a sweep share a body, and which of them asks most of it.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use petsc_wrap::Comm;

use crate::error::Result;
use crate::impact::Errors;
use crate::model::Model;
use crate::model::watch::Watch;
use crate::scene::{self, Scene, Support, SupportKind};

use super::by_body::{BodyOf, ByBody};

/// The families of members that differ in the impactor, the gap, the times or the tolerance alone, by their body; with the
/// member that asks most, by its tolerance and then by its contact, for which the family's basis is made: so that no result depends on
/// the order of members.
#[derive(Debug, Default)]
pub struct Grouping {
    families: ByBody<Member>,
    ends: Vec<usize>,
    /// What is varied of a support, where it is one thing, with each member's value.
    line: Option<(Property, Vec<f64>)>,
    /// Members by all that their bodies depend on but for that value: the hardest of each value, by the value.
    lines: ByBody<BTreeMap<Ordered, Member>>,
}

/// The theory for all members.
pub struct Found {
    /// The theory.
    pub theory: scene::Model,
    /// The first member that asks for it, where others that were asked do with less.
    pub asked_by: Option<usize>,
    /// The largest errors that `auto` found for it.
    pub errors: Errors,
    /// The models of it that were made on the way, each for its own body's basis, with the scenes.
    pub(super) made: Vec<(Scene, Model)>,
}

/// Members that differ in one support's stiffness or damping, or in what a relaxing interlayer's shear depends on, alone.
pub struct Line {
    /// What they share.
    pub body: BodyOf,
    /// One member's value.
    pub value: f64,
    /// How many values there are.
    pub count: usize,
}

/// What bodies on a line differ in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Property {
    /// The stiffness of the support of this number.
    Stiffness(usize),
    /// Its damping.
    Damping(usize),
    /// The relaxation of interlayers: the temperature, or a modulus after all relaxation.
    Relaxation,
}

#[derive(Debug, Clone, Copy)]
struct Member {
    index: usize,
    contact: f64,
    tolerance: f64,
}

impl Member {
    /// Whether it asks more of a body: by its tolerance, then by its contact.
    fn is_harder(&self, other: &Self) -> bool {
        (self.tolerance, self.contact, self.index) < (other.tolerance, other.contact, other.index)
    }
}

impl Grouping {
    /// Counts a member, with its value on the line of [`Grid::line`](super::Grid::line).
    pub fn count(&mut self, index: usize, scene: &Scene, on_line: Option<(Property, f64)>) {
        // Damping makes a contact harder from its first moment on.
        let contact = scene.impactor.contact_time() / (1.0 + scene.impactor.damping * scene.impactor.speed);
        let member = Member { index, contact, tolerance: scene.tolerance };
        let harder = |most: &mut Member| {
            if member.is_harder(most) {
                *most = member;
            }
        };
        // Bodies that do not relax are the same at all temperatures.
        let differ = |(property, _): &(Property, f64)| {
            *property != Property::Relaxation || scene.body.composition.is_viscoelastic()
        };
        if let Some((property, value)) = on_line {
            self.line.get_or_insert((property, Vec::new())).1.push(value);
        }
        if let Some((property, value)) = on_line.filter(differ) {
            let line = self.lines.get_or_insert_with(without(scene, property), BTreeMap::new);
            harder(line.entry(Ordered(value)).or_insert(member));
        }
        harder(self.families.get_or_insert_with(BodyOf::new(scene), || member));
        self.ends.truncate(1);
        self.ends.push(index);
    }

    /// The member for which the basis of a scene's family is made.
    pub fn representative(&self, scene: &Scene) -> Option<usize> {
        self.families.get(&BodyOf::new(scene)).map(|member| member.index)
    }

    /// The line that a member is on, and where.
    pub fn line_of(&self, index: usize, scene: &Scene) -> Option<Line> {
        let (property, values) = self.line.as_ref()?;
        let body = without(scene, *property);
        let count = self.lines.get(&body)?.len();
        Some(Line { body, value: values[index], count })
    }

    /// How many lines there are.
    pub fn lines(&self) -> usize {
        self.lines.len()
    }

    /// Whether lines are of bodies that differ in their relaxation.
    pub fn is_of_relaxations(&self) -> bool {
        matches!(self.line, Some((Property::Relaxation, _)))
    }

    /// The values of a line, ascending, each with the hardest member.
    pub fn members_on(&self, line: &BodyOf) -> Vec<(f64, usize)> {
        let all = self.lines.get(line).into_iter().flatten();
        all.map(|(value, member)| (value.0, member.index)).collect()
    }

    /// The theory that auto finds for all members, the highest that the first, the last and the hardest of them ask for. Collective.
    ///
    /// # Errors
    /// Those of a model.
    pub fn theory(&self, comm: &Comm, scene_of: impl Fn(usize) -> Result<Scene>, watch: &dyn Watch) -> Result<Found> {
        let hardest = self.families.values().copied().reduce(|a, b| if b.is_harder(&a) { b } else { a });
        let mut asked = self.ends.clone();
        asked.extend(hardest.map(|member| member.index));
        asked.sort_unstable();
        asked.dedup();
        let none = |theory| Found { theory, asked_by: None, errors: Errors::default(), made: Vec::new() };
        let mut found = none(scene::Model::HalfSpace);
        let mut theories = Vec::new();
        for index in asked {
            let scene = scene_of(index)?;
            let model = Model::watched(comm, &scene, watch)?;
            theories.push((index, model.theory));
            if model.theory > found.theory {
                found = none(model.theory);
            }
            if model.theory == found.theory {
                found.errors = found.errors.max(model.error_beside_basis());
                // What several ranks have made together is read by one of them; of layers `auto` asks more than the theory by its name.
                let is_alike = comm.size() == 1 && model.theory != scene::Model::Layerwise;
                if is_alike && self.representative(&scene) == Some(index) {
                    found.made.push((scene, model));
                }
            }
            comm.collect_garbage()?;
        }
        let do_not_agree = theories.iter().any(|(_, theory)| *theory != found.theory);
        let first = theories.iter().find(|(_, theory)| *theory == found.theory).filter(|_| do_not_agree);
        found.asked_by = first.map(|(index, _)| *index);
        Ok(found)
    }
}

/// A scene's body without a property.
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

/// A finite value in its order.
#[derive(Debug, Clone, Copy)]
struct Ordered(f64);

impl Ord for Ordered {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

impl PartialOrd for Ordered {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ordered {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Ordered {}
