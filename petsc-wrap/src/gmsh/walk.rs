//! Whether a Gmsh file keeps what it promises, before PETSc reads it.
//!
//! PETSc takes counts, and references to nodes and entities, from the file and uses them unchecked: where a line is
//! missing, the process may end by a signal. So the sections are walked through first, in the order in which PETSc
//! wants them. Formats: Gmsh's manual, "MSH file format", 2.2 and 4.1, text and binary.

use std::collections::{BTreeSet, HashMap, HashSet};

use crate::Int;

use super::nodes::Nodes;
use super::words::Words;
use super::{Contents, PhysicalGroup};

/// What PETSc's reader holds at most: tags of an element or entity, bytes of a physical name.
const TAGS: usize = 16;
const NAME: usize = 127;

/// Walks through a whole file.
///
/// # Errors
/// What is wrong, with the line of a text file or the byte of a binary one.
pub(super) fn validate(bytes: &[u8]) -> Result<Contents, String> {
    let mut walk = Walk {
        words: Words::new(bytes),
        entities: Default::default(),
        groups: HashMap::new(),
        volumes: BTreeSet::new(),
        nodes: Nodes::default(),
    };
    let modern = walk.format()?;
    let (mut surfaces, mut named_volumes) = (Vec::new(), Vec::new());
    let mut section = walk.section()?;
    if section == "$PhysicalNames" {
        [surfaces, named_volumes] = walk.group_names()?;
        section = walk.section()?;
    }
    if modern {
        walk.begins(section, "$Entities")?;
        walk.entities()?;
        section = walk.section()?;
    }
    walk.begins(section, "$Nodes")?;
    if modern { walk.nodes_41() } else { walk.nodes_22() }?;
    walk.words.expect("$EndNodes")?;
    section = walk.section()?;
    walk.begins(section, "$Elements")?;
    if modern { walk.elements_41() } else { walk.elements_22() }?;
    walk.words.expect("$EndElements")?;
    walk.nodes.check_use()?;
    let (volumes, parts) = (walk.volumes.len(), walk.nodes.parts());
    Ok(Contents { surfaces, named_volumes, volumes, parts, all_tags: modern })
}

struct Walk<'a> {
    words: Words<'a>,
    /// Numbers of the geometric entities (4.1), by dimension.
    entities: [HashSet<i32>; 4],
    /// Physical groups of the geometric volumes (4.1), by the volumes' numbers.
    groups: HashMap<i32, Vec<i32>>,
    /// The physical groups that cells are in, by region: a region may be in several.
    volumes: BTreeSet<Vec<i32>>,
    nodes: Nodes,
}

impl<'a> Walk<'a> {
    /// The section $MeshFormat; whether it says 4.1.
    fn format(&mut self) -> Result<bool, String> {
        if self.words.word() != Ok("$MeshFormat") {
            return Err("it is not a Gmsh mesh: it does not begin with $MeshFormat".to_owned());
        }
        let modern = match self.words.word()? {
            "2.2" => false,
            "4.1" => true,
            other => return self.words.error(format!("Gmsh's format {other:?} is not read, only 2.2 and 4.1")),
        };
        let binary = match self.words.word()? {
            "0" => false,
            "1" => true,
            other => return self.words.error(format!("expected 0 (text) or 1 (binary), found {other:?}")),
        };
        self.words.expect("8")?;
        self.words.binary = binary;
        if binary && self.words.int()? != 1 {
            return self.words.error("the file is binary with the bytes of a number in the other order");
        }
        self.words.expect("$EndMeshFormat")?;
        Ok(modern)
    }

    /// The next section's mark, comments passed over.
    fn section(&mut self) -> Result<&'a str, String> {
        loop {
            match self.words.word()? {
                "$Comments" => while self.words.word()? != "$EndComments" {},
                mark => return Ok(mark),
            }
        }
    }

    fn begins(&self, found: &str, wanted: &str) -> Result<(), String> {
        if found == wanted { Ok(()) } else { self.words.error(format!("expected {wanted}, found {found:?}")) }
    }

    /// The named groups of faces, and those of cells.
    fn group_names(&mut self) -> Result<[Vec<PhysicalGroup>; 2], String> {
        let mut groups = [Vec::new(), Vec::new()];
        for _ in 0..self.words.written_count()? {
            let dimension = self.words.written_count()?;
            let number = self.words.written_count()? as Int;
            let quoted = self.words.line()?.trim();
            match quoted.strip_prefix('"').and_then(|name| name.strip_suffix('"')) {
                Some(name) if (1..=NAME).contains(&name.len()) => {
                    if let 2 | 3 = dimension {
                        groups[dimension - 2].push(PhysicalGroup { number, name: name.to_owned() });
                    }
                }
                _ => return self.words.error(format!("expected a name in quotes, found {quoted:?}")),
            }
        }
        self.words.expect("$EndPhysicalNames")?;
        Ok(groups)
    }

    fn entities(&mut self) -> Result<(), String> {
        let words = &mut self.words;
        let counts = [words.size()?, words.size()?, words.size()?, words.size()?];
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let number = words.int()?;
                self.entities[dimension].insert(number);
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    words.real()?;
                }
                let tags = words.size()?;
                if tags > TAGS {
                    return words.error(format!("{tags} physical groups of one entity are more than {TAGS}"));
                }
                let groups = (0..tags).map(|_| words.int()).collect::<Result<Vec<_>, _>>()?;
                if dimension == 3 {
                    // In any order.
                    let groups = BTreeSet::from_iter(groups).into_iter().collect();
                    self.groups.insert(number, groups);
                }
                let bounds = if dimension == 0 { 0 } else { words.size()? };
                for _ in 0..bounds {
                    words.int()?;
                }
            }
        }
        words.expect("$EndEntities")
    }

    fn coordinates(&mut self) -> Result<(), String> {
        for _ in 0..3 {
            if !self.words.real()?.is_finite() {
                return self.words.error("a node has a coordinate that is not finite");
            }
        }
        Ok(())
    }

    fn nodes_22(&mut self) -> Result<(), String> {
        for _ in 0..self.words.written_count()? {
            let number = self.words.int()?;
            match usize::try_from(number) {
                Ok(number) => self.nodes.add(number),
                Err(_) => return self.words.error(format!("{number} cannot be the number of a node")),
            }
            self.coordinates()?;
        }
        self.nodes.close(None)
    }

    fn nodes_41(&mut self) -> Result<(), String> {
        let (blocks, total) = (self.words.size()?, self.words.size()?);
        let span = (self.words.size()?, self.words.size()?);
        let mut sum = 0;
        for _ in 0..blocks {
            self.entity()?;
            if self.words.int()? != 0 {
                return self.words.error("parametric coordinates are not read: save with Mesh.SaveParametric = 0");
            }
            let count = self.words.size()?;
            sum += count;
            self.check_sum(sum, total, false)?;
            for _ in 0..count {
                let number = self.words.size()?;
                self.nodes.add(number);
            }
            for _ in 0..count {
                self.coordinates()?;
            }
        }
        self.check_sum(sum, total, true)?;
        self.nodes.close(Some(span))
    }

    /// Dimension and number of the entity that a block is of.
    fn entity(&mut self) -> Result<(usize, i32), String> {
        let (dimension, number) = (self.words.int()?, self.words.int()?);
        match usize::try_from(dimension).ok().and_then(|d| Some((d, self.entities.get(d)?))) {
            Some((dimension, known)) if known.contains(&number) => Ok((dimension, number)),
            _ => self.words.error(format!("there is no entity {number} of dimension {dimension}")),
        }
    }

    /// Blocks must hold what was promised, no more, and at the `end` no less.
    fn check_sum(&self, sum: usize, total: usize, end: bool) -> Result<(), String> {
        if sum > total || end && sum < total {
            return self.words.error(format!("the blocks hold {sum} in all, where {total} were announced"));
        }
        Ok(())
    }

    fn elements_22(&mut self) -> Result<(), String> {
        let total = self.words.written_count()?;
        let mut sum = 0;
        while sum < total {
            // Text: number, kind, count of tags, for each element. Binary: kind, count of elements, count of tags, for a block.
            let head = [self.words.int()?, self.words.int()?, self.words.int()?];
            let (kind, count) = if self.words.binary { (head[0], head[1]) } else { (head[1], 1) };
            let tags = match usize::try_from(head[2]) {
                Ok(tags) if tags <= TAGS => tags,
                _ => return self.words.error(format!("{} is not a count of tags", head[2])),
            };
            let (dimension, nodes) = self.kind(kind)?;
            if count < 1 {
                return self.words.error("a block without elements");
            }
            sum += count as usize;
            self.check_sum(sum, total, false)?;
            for _ in 0..count {
                // The first tag is the physical group, 0 for none; a block's elements begin with their number.
                for tag in 0..tags + usize::from(self.words.binary) {
                    let group = self.words.int()?;
                    if dimension == 3 && tag == usize::from(self.words.binary) && group != 0 {
                        self.volumes.insert(vec![group]);
                    }
                }
                self.element(dimension, nodes, |words| Ok(words.int()?.try_into().unwrap_or(usize::MAX)))?;
            }
        }
        Ok(())
    }

    fn elements_41(&mut self) -> Result<(), String> {
        let (blocks, total) = (self.words.size()?, self.words.size()?);
        self.words.size()?;
        self.words.size()?;
        let mut sum = 0;
        for _ in 0..blocks {
            let (entity, number) = self.entity()?;
            let kind = self.words.int()?;
            let (dimension, nodes) = self.kind(kind)?;
            if entity != dimension {
                return self.words.error(format!("elements of dimension {dimension} on an entity of {entity}"));
            }
            let count = self.words.size()?;
            sum += count;
            self.check_sum(sum, total, false)?;
            if dimension == 3 && count > 0 {
                self.volumes.extend(self.groups.get(&number).filter(|groups| !groups.is_empty()).cloned());
            }
            for _ in 0..count {
                self.words.size()?;
                self.element(dimension, nodes, Words::size)?;
            }
        }
        self.check_sum(sum, total, true)
    }

    /// Dimension and number of nodes of a kind of element.
    fn kind(&self, kind: i32) -> Result<(usize, usize), String> {
        match kind {
            15 => Ok((0, 1)),
            1 => Ok((1, 2)),
            2 => Ok((2, 3)),
            3 => Ok((2, 4)),
            4 => Ok((3, 4)),
            5 => Ok((3, 8)),
            6 | 7 => self.words.error("the mesh has prisms or pyramids: mesh with tetrahedra alone, or with hexahedra"),
            _ => self
                .words
                .error(format!("elements of Gmsh's type {kind} are not read: save with Mesh.ElementOrder = 1")),
        }
    }

    fn element(
        &mut self,
        dimension: usize,
        count: usize,
        next: impl Fn(&mut Words<'a>) -> Result<usize, String>,
    ) -> Result<(), String> {
        let mut corners = [0; 8];
        for i in 0..count {
            corners[i] = next(&mut self.words)?;
            if corners[..i].contains(&corners[i]) {
                return self.words.error(format!("an element has node {} twice", corners[i]));
            }
            if !self.nodes.touch(corners[i], dimension == 3) {
                return self.words.error(format!("an element has a node {} that is not there", corners[i]));
            }
        }
        if dimension == 3 {
            self.nodes.join(&corners[..count]);
        }
        Ok(())
    }
}
