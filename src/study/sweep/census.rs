//! Which members of a sweep share a body, and which of them asks most of it.

use std::collections::{BTreeMap, HashMap};
use std::hash::{DefaultHasher, Hash, Hasher};

use petsc_wrap::Comm;

use crate::error::Result;
use crate::model::Model;
use crate::model::watch::Watch;
use crate::scene::{self, Impactor, Scene, Support, SupportKind};

/// The families of members that differ in the impactor, the gap, the times or the tolerance alone, by the key of their body; with the
/// member that asks most, by its tolerance and then by its contact, for which the family's basis is made: so that no result depends on
/// the order of members.
#[derive(Debug, Default)]
pub struct Census {
    families: HashMap<u64, Member>,
    ends: Vec<usize>,
    /// What is varied of a support, where it is one thing, with each member's value.
    line: Option<(Property, Vec<f64>)>,
    /// Members by all that their bodies depend on but for that value: the hardest of each value, by its bits, which ascend with it.
    lines: HashMap<u64, BTreeMap<u64, Member>>,
}

/// Members that differ in one support's stiffness or in its damping alone.
pub struct Line {
    /// What they share.
    pub key: u64,
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

impl Census {
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
            let line = self.lines.entry(key(&without(scene, property))).or_default();
            harder(line.entry(value.to_bits()).or_insert(member));
        }
        harder(self.families.entry(key(scene)).or_insert(member));
        self.ends.truncate(1);
        self.ends.push(index);
    }

    /// The member for which the basis of a scene's family is made.
    pub fn representative(&self, scene: &Scene) -> Option<usize> {
        self.families.get(&key(scene)).map(|member| member.index)
    }

    /// The line that a member is on, and where.
    pub fn line_of(&self, index: usize, scene: &Scene) -> Option<Line> {
        let (property, values) = self.line.as_ref()?;
        let line = key(&without(scene, *property));
        Some(Line { key: line, value: values[index], count: self.lines.get(&line)?.len() })
    }

    /// The values of a line, ascending, each with the hardest member.
    pub fn members_on(&self, line: u64) -> Vec<(f64, usize)> {
        let all = self.lines.get(&line).into_iter().flatten();
        all.map(|(bits, member)| (f64::from_bits(*bits), member.index)).collect()
    }

    /// The theory that auto finds for all members, the highest that the first, the last and the hardest of them ask for, with the
    /// largest errors that it found for that, in the first contact and over the whole history. Collective.
    ///
    /// # Errors
    /// Those of a model.
    pub fn theory(
        &self,
        comm: &Comm,
        scene_of: impl Fn(usize) -> Result<Scene>,
        watch: &dyn Watch,
    ) -> Result<(scene::Model, (f64, f64))> {
        let hardest = self.families.values().copied().reduce(|a, b| if b.is_harder(&a) { b } else { a });
        let mut asked = self.ends.clone();
        asked.extend(hardest.map(|member| member.index));
        asked.sort_unstable();
        asked.dedup();
        let mut found = Vec::new();
        for index in asked {
            let Model { theory, beside_basis, .. } = Model::watched(comm, &scene_of(index)?, watch)?;
            found.push((theory, beside_basis));
            comm.collect_garbage()?;
        }
        let highest = found.iter().map(|(theory, _)| *theory).max().unwrap_or(scene::Model::HalfSpace);
        let errors = found.iter().filter(|(theory, _)| *theory == highest);
        let largest =
            errors.fold((0.0_f64, 0.0_f64), |(first, all), (_, error)| (first.max(error.0), all.max(error.1)));
        Ok((highest, largest))
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

/// All of a scene that its body depends on.
pub(super) fn key(scene: &Scene) -> u64 {
    let Scene { body, supports, impactor, contact, load, .. } = scene;
    let Impactor { point, direction, .. } = impactor;
    let mut hasher = DefaultHasher::new();
    format!("{body:?} {supports:?} {point:?} {direction:?} {contact:?} {load:?}").hash(&mut hasher);
    hasher.finish()
}
