//! Which members of a sweep share a body, and which of them asks most of it.

use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};

use petsc_wrap::Comm;

use crate::contact::hertz;
use crate::error::Result;
use crate::model::Model;
use crate::scene::{self, Impactor, Scene};

/// The families of members that differ in the impactor, the gap, the times or the tolerance alone, by the key of their body; with the
/// member whose contact is the shortest, for which the family's basis is made: so that no result depends on the order of members.
#[derive(Debug, Default)]
pub struct Census {
    families: HashMap<u64, Member>,
    ends: Vec<usize>,
}

#[derive(Debug, Clone, Copy)]
struct Member {
    index: usize,
    contact: f64,
}

impl Census {
    /// Counts a member.
    pub fn count(&mut self, index: usize, scene: &Scene) {
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

/// All of a scene that its body depends on.
pub(super) fn key(scene: &Scene) -> u64 {
    let Scene { body, supports, impactor, contact, load, .. } = scene;
    let Impactor { point, direction, .. } = impactor;
    let mut hasher = DefaultHasher::new();
    format!("{body:?} {supports:?} {point:?} {direction:?} {contact:?} {load:?}").hash(&mut hasher);
    hasher.finish()
}
