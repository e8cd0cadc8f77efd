//! Which members of a sweep share a body, and which of them asks most of it.

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
    /// Members by all that their bodies depend on but for that value: the hardest of each value, by its bits, which ascend with it.
    lines: ByBody<BTreeMap<u64, Member>>,
}

/// Members that differ in one support's stiffness or in its damping alone.
pub struct Line {
    /// What they share.
    pub body: BodyOf,
    /// One member's value.
    pub value: f64,
    /// How many values there are.
    pub count: usize,
}

/// A property of one support.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Property {
    /// The support.
    pub support: usize,
    /// Whether its damping, not its stiffness.
    pub is_damping: bool,
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
    /// Counts a member, with its value on the line of [`Grid::line`](super::Grid::line), which is not negative.
    pub fn count(&mut self, index: usize, scene: &Scene, on_line: Option<(Property, f64)>) {
        // Damping makes a contact harder from its first moment on.
        let contact = scene.impactor.contact_time() / (1.0 + scene.impactor.damping * scene.impactor.speed);
        let member = Member { index, contact, tolerance: scene.tolerance };
        let harder = |most: &mut Member| {
            if member.is_harder(most) {
                *most = member;
            }
        };
        if let Some((property, value)) = on_line {
            self.line.get_or_insert((property, Vec::new())).1.push(value);
            let line = self.lines.get_or_insert_with(BodyOf::new(&without(scene, property)), BTreeMap::new);
            harder(line.entry(value.to_bits()).or_insert(member));
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
        let body = BodyOf::new(&without(scene, *property));
        let count = self.lines.get(&body)?.len();
        Some(Line { body, value: values[index], count })
    }

    /// The values of a line, ascending, each with the hardest member.
    pub fn members_on(&self, line: &BodyOf) -> Vec<(f64, usize)> {
        let all = self.lines.get(line).into_iter().flatten();
        all.map(|(bits, member)| (f64::from_bits(*bits), member.index)).collect()
    }

    /// The theory that auto finds for all members, the highest that the first, the last and the hardest of them ask for, with the
    /// largest errors that it found for that. Collective.
    ///
    /// # Errors
    /// Those of a model.
    pub fn theory(
        &self,
        comm: &Comm,
        scene_of: impl Fn(usize) -> Result<Scene>,
        watch: &dyn Watch,
    ) -> Result<(scene::Model, Errors)> {
        let hardest = self.families.values().copied().reduce(|a, b| if b.is_harder(&a) { b } else { a });
        let mut asked = self.ends.clone();
        asked.extend(hardest.map(|member| member.index));
        asked.sort_unstable();
        asked.dedup();
        let mut found = Vec::new();
        for index in asked {
            let model = Model::watched(comm, &scene_of(index)?, watch)?;
            found.push((model.theory, model.error_beside_basis()));
            drop(model);
            comm.collect_garbage()?;
        }
        let highest = found.iter().map(|(theory, _)| *theory).max().unwrap_or(scene::Model::HalfSpace);
        let errors = found.iter().filter(|(theory, _)| *theory == highest);
        Ok((highest, errors.fold(Errors::default(), |largest, (_, errors)| largest.max(*errors))))
    }
}

/// A scene without a property of a support.
fn without(scene: &Scene, Property { support, is_damping }: Property) -> Scene {
    let mut scene = scene.clone();
    match scene.supports.get_mut(support) {
        Some(support) if is_damping => support.damping = [0.0; 3],
        Some(Support { kind: SupportKind::Elastic { stiffness }, .. }) => *stiffness = [0.0; 3],
        _ => {}
    }
    scene
}
