//! Which members of a sweep share a body, and which of them asks most of it.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use petsc_wrap::Comm;

use crate::contact::hertz;
use crate::error::Result;
use crate::model::Model;
use crate::scene::{self, Impactor, Scene, SupportKind};

/// The families of members that differ in the impactor, the gap, the times or the tolerance alone, by the key of their body; with the
/// member whose contact is the shortest, for which the family's basis is made: so that no result depends on the order of members.
#[derive(Debug, Default)]
pub struct Census {
    families: HashMap<u64, Member>,
    ends: Vec<usize>,
    /// The support whose stiffness or damping is varied, where one is, with each member's value.
    line: Option<(usize, Vec<f64>)>,
    /// Members by all that their bodies depend on but for that value, and by the value.
    lines: HashMap<u64, Vec<(f64, usize)>>,
}

/// Members that differ in one support's stiffness or damping alone.
pub struct Line {
    /// What they share.
    pub key: u64,
    /// One member's value.
    pub value: f64,
    /// All values, ascending, each with a member.
    pub all: Vec<(f64, usize)>,
}

#[derive(Debug, Clone, Copy)]
struct Member {
    index: usize,
    contact: f64,
}

impl Census {
    /// Counts a member, with its value on the line of [`Grid::line`](super::Grid::line).
    pub fn count(&mut self, index: usize, scene: &Scene, on_line: Option<(usize, f64)>) {
        if let Some((support, value)) = on_line {
            self.line.get_or_insert((support, Vec::new())).1.push(value);
            self.lines.entry(key(&without(scene, support))).or_default().push((value, index));
        }
        let Impactor { stiffness, mass, speed, .. } = scene.impactor;
        let member = Member { index, contact: hertz::contact_time(stiffness, mass, speed) };
        let most = self.families.entry(key(scene)).or_insert(member);
        if member.contact < most.contact {
            *most = member;
        }
        self.ends.truncate(1);
        self.ends.push(index);
    }

    /// The member for which the basis of a scene's family is made.
    pub fn representative(&self, scene: &Scene) -> Option<usize> {
        self.families.get(&key(scene)).map(|member| member.index)
    }

    /// The line that a member is on, and where.
    pub fn line_of(&self, index: usize, scene: &Scene) -> Option<Line> {
        let (support, values) = self.line.as_ref()?;
        let line = key(&without(scene, *support));
        let mut all = self.lines.get(&line)?.clone();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        all.dedup_by(|a, b| a.0 == b.0);
        Some(Line { key: line, value: values[index], all })
    }

    /// The theory that auto finds for all members: the highest that the first, the last and the hardest of them ask for. Collective.
    ///
    /// # Errors
    /// Those of a model.
    pub fn theory(&self, comm: &Comm, scene_of: impl Fn(usize) -> Result<Scene>) -> Result<scene::Model> {
        let hardest = self.families.values().min_by(|a, b| a.contact.total_cmp(&b.contact).then(a.index.cmp(&b.index)));
        let mut asked = self.ends.clone();
        asked.extend(hardest.map(|member| member.index));
        asked.sort_unstable();
        asked.dedup();
        let mut highest = scene::Model::HalfSpace;
        for index in asked {
            highest = highest.max(Model::new(comm, &scene_of(index)?)?.theory);
            comm.collect_garbage()?;
        }
        Ok(highest)
    }
}

/// A scene without the stiffness and the damping of a support.
fn without(scene: &Scene, support: usize) -> Scene {
    let mut scene = scene.clone();
    if let Some(support) = scene.supports.get_mut(support) {
        support.damping = [0.0; 3];
        if let SupportKind::Elastic { stiffness } = &mut support.kind {
            *stiffness = [0.0; 3];
        }
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
