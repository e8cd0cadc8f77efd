//! A reader that goes through a Gmsh file and checks everything in it: a file that does not follow its format is
//! refused.
//!
//! The sections come in the order in which Gmsh writes them. Formats: Gmsh's manual, "MSH file format", 2.2 and 4.1,
//! text and binary.

use std::collections::{HashMap, HashSet};
use std::io::{Read, Seek};

use crate::Int;

use super::PhysicalGroup;
use super::nodes::Nodes;
use super::words::{Place, Tokenizer};

/// Largest number of physical groups of an entity and of tags of an element; below: most bytes of a physical name.
const TAGS: usize = 16;
const NAME: usize = 127;

/// A position in a file, and what has been read before it.
pub(super) struct GmshReader<R> {
    pub words: Tokenizer<R>,
    /// Whether the format is 4.1.
    is_modern: bool,
    /// The named groups of faces and of cells.
    pub named: [Vec<PhysicalGroup>; 2],
    pub nodes: Nodes,
    /// Numbers of the geometric entities (4.1), by dimension.
    entities: [HashSet<i32>; 4],
    /// Physical groups of the geometric surfaces and volumes (4.1), by their numbers.
    groups: [HashMap<i32, Vec<i32>>; 2],
    /// Position where the elements begin.
    elements: Place,
}

/// A point, line, facet or cell.
pub(super) struct Element<'a> {
    /// Number of elements that the file announces, and the position of this one among them.
    pub total: usize,
    pub number: usize,
    pub dimension: usize,
    /// Indices of its nodes.
    pub corners: &'a [u32],
    /// Its geometric entity (4.1), or its physical group (2.2). [`GmshReader::groups`] returns the groups of a region.
    pub region: i32,
}

impl<R: Read + Seek> GmshReader<R> {
    /// Reads up to the nodes. `is_judge`: whether this rank finds out how the elements use the nodes.
    pub fn begin(source: R, is_judge: bool) -> Result<Self, String> {
        let mut walk = Self {
            words: Tokenizer::new(source)?,
            is_modern: false,
            named: Default::default(),
            nodes: Nodes::new(is_judge),
            entities: Default::default(),
            groups: Default::default(),
            elements: Place::default(),
        };
        walk.format()?;
        let mut section = walk.section()?;
        if section == "$PhysicalNames" {
            walk.group_names()?;
            section = walk.section()?;
        }
        if walk.is_modern {
            walk.begins(&section, "$Entities")?;
            walk.entities()?;
            section = walk.section()?;
        }
        walk.begins(&section, "$Nodes")?;
        Ok(walk)
    }

    /// Reads the nodes, up to the elements. `visit` gets the number of nodes, and the index and coordinates of each.
    pub fn nodes(&mut self, visit: impl FnMut(usize, usize, [f64; 3])) -> Result<(), String> {
        if self.is_modern { self.nodes_41(visit) } else { self.nodes_22(visit) }?;
        self.words.expect("$EndNodes")?;
        let section = self.section()?;
        self.begins(&section, "$Elements")?;
        self.elements = self.words.here();
        Ok(())
    }

    /// Reads the elements; this may be repeated. An error of `visit` is reported with the position in the file.
    pub fn elements(&mut self, visit: impl FnMut(&Element) -> Result<(), String>) -> Result<(), String> {
        self.words.go_to(self.elements)?;
        if self.is_modern { self.elements_41(visit) } else { self.elements_22(visit) }?;
        self.words.expect("$EndElements")
    }

    /// Physical groups of an element of dimension 2 or 3 in a region.
    pub fn groups<'a>(&'a self, dimension: usize, region: &'a i32) -> &'a [i32] {
        match (self.is_modern, *region) {
            (true, _) => self.groups[dimension - 2].get(region).map_or(&[], Vec::as_slice),
            (false, 0) => &[],
            (false, _) => std::slice::from_ref(region),
        }
    }

    /// Reads the section $MeshFormat.
    fn format(&mut self) -> Result<(), String> {
        if self.words.word().as_deref() != Ok("$MeshFormat") {
            return Err("it is not a Gmsh mesh: it does not begin with $MeshFormat".to_owned());
        }
        self.is_modern = match self.words.word()?.as_str() {
            "2.2" => false,
            "4.1" => true,
            other => return self.words.error(format!("Gmsh's format {other:?} is not read, only 2.2 and 4.1")),
        };
        let is_binary = match self.words.word()?.as_str() {
            "0" => false,
            "1" => true,
            other => return self.words.error(format!("expected 0 (text) or 1 (binary), found {other:?}")),
        };
        self.words.expect("8")?;
        self.words.binary = is_binary;
        if is_binary && self.words.int()? != 1 {
            return self.words.error("the file is binary with the bytes of a number in the other order");
        }
        self.words.expect("$EndMeshFormat")
    }

    /// Returns the mark of the next section and skips comments.
    fn section(&mut self) -> Result<String, String> {
        loop {
            match self.words.word()? {
                mark if mark == "$Comments" => while self.words.word()? != "$EndComments" {},
                mark => return Ok(mark),
            }
        }
    }

    fn begins(&self, found: &str, wanted: &str) -> Result<(), String> {
        if found == wanted { Ok(()) } else { self.words.error(format!("expected {wanted}, found {found:?}")) }
    }

    fn group_names(&mut self) -> Result<(), String> {
        for _ in 0..self.words.written_count()? {
            let dimension = self.words.written_count()?;
            let number = self.words.written_count()? as Int;
            let line = self.words.line()?;
            let quoted = line.trim();
            match quoted.strip_prefix('"').and_then(|name| name.strip_suffix('"')) {
                Some(name) if (1..=NAME).contains(&name.len()) => {
                    if let 2 | 3 = dimension {
                        self.named[dimension - 2].push(PhysicalGroup { number, name: name.to_owned() });
                    }
                }
                _ => return self.words.error(format!("expected a name in quotes, found {quoted:?}")),
            }
        }
        self.words.expect("$EndPhysicalNames")
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
                let mut groups = (0..tags).map(|_| words.int()).collect::<Result<Vec<_>, _>>()?;
                if dimension >= 2 {
                    groups.sort_unstable();
                    groups.dedup();
                    self.groups[dimension - 2].insert(number, groups);
                }
                let bounds = if dimension == 0 { 0 } else { words.size()? };
                for _ in 0..bounds {
                    words.int()?;
                }
            }
        }
        words.expect("$EndEntities")
    }

    fn place(&mut self) -> Result<[f64; 3], String> {
        let mut place = [0.0; 3];
        for x in &mut place {
            *x = self.words.real()?;
            if !x.is_finite() {
                return self.words.error("a node has a coordinate that is not finite");
            }
        }
        Ok(place)
    }

    fn nodes_22(&mut self, mut visit: impl FnMut(usize, usize, [f64; 3])) -> Result<(), String> {
        let total = self.words.written_count()?;
        for index in 0..total {
            let number = self.words.int()?;
            match usize::try_from(number) {
                Ok(number) => self.nodes.add(number),
                Err(_) => return self.words.error(format!("{number} cannot be the number of a node")),
            }
            visit(total, index, self.place()?);
        }
        self.nodes.close(None)
    }

    fn nodes_41(&mut self, mut visit: impl FnMut(usize, usize, [f64; 3])) -> Result<(), String> {
        let (blocks, total) = (self.words.size()?, self.words.size()?);
        let span = (self.words.size()?, self.words.size()?);
        let mut sum = 0;
        for _ in 0..blocks {
            self.entity()?;
            if self.words.int()? != 0 {
                return self.words.error("parametric coordinates are not read: save with Mesh.SaveParametric = 0");
            }
            let count = self.words.size()?;
            self.check_sum(sum + count, total, false)?;
            for _ in 0..count {
                let number = self.words.size()?;
                self.nodes.add(number);
            }
            for index in sum..sum + count {
                visit(total, index, self.place()?);
            }
            sum += count;
        }
        self.check_sum(sum, total, true)?;
        self.nodes.close(Some(span))
    }

    /// Reads the dimension and the number of a block's entity.
    fn entity(&mut self) -> Result<(usize, i32), String> {
        let (dimension, number) = (self.words.int()?, self.words.int()?);
        match usize::try_from(dimension).ok().and_then(|d| Some((d, self.entities.get(d)?))) {
            Some((dimension, known)) if known.contains(&number) => Ok((dimension, number)),
            _ => self.words.error(format!("there is no entity {number} of dimension {dimension}")),
        }
    }

    /// Checks that the blocks hold no more items than announced and, at the `end`, no fewer.
    fn check_sum(&self, sum: usize, total: usize, end: bool) -> Result<(), String> {
        if sum > total || end && sum < total {
            return self.words.error(format!("the blocks hold {sum} in all, where {total} were announced"));
        }
        Ok(())
    }

    fn elements_22(&mut self, mut visit: impl FnMut(&Element) -> Result<(), String>) -> Result<(), String> {
        let total = self.words.written_count()?;
        let mut sum = 0;
        while sum < total {
            // Text: number, kind and number of tags of each element. Binary: kind, number of elements and number of
            // tags of a block.
            let head = [self.words.int()?, self.words.int()?, self.words.int()?];
            let (kind, count) = if self.words.binary { (head[0], head[1]) } else { (head[1], 1) };
            let tags = match usize::try_from(head[2]) {
                Ok(tags) if tags <= TAGS => tags,
                _ => return self.words.error(format!("{} is not a count of tags", head[2])),
            };
            let (dimension, corners) = self.kind(kind)?;
            if count < 1 {
                return self.words.error("a block without elements");
            }
            let first = sum;
            sum += count as usize;
            self.check_sum(sum, total, false)?;
            for number in first..sum {
                // The first tag is the physical group, 0 for none. In a binary block each element begins with its
                // number.
                let mut region = 0;
                for tag in 0..tags + usize::from(self.words.binary) {
                    let group = self.words.int()?;
                    if tag == usize::from(self.words.binary) {
                        region = group;
                    }
                }
                let next = |words: &mut Tokenizer<R>| Ok(words.int()?.try_into().unwrap_or(usize::MAX));
                let element = Element { total, number, dimension, corners: &[], region };
                self.element(element, corners, next, &mut visit)?;
            }
        }
        Ok(())
    }

    fn elements_41(&mut self, mut visit: impl FnMut(&Element) -> Result<(), String>) -> Result<(), String> {
        let (blocks, total) = (self.words.size()?, self.words.size()?);
        self.words.size()?;
        self.words.size()?;
        let mut sum = 0;
        for _ in 0..blocks {
            let (entity, region) = self.entity()?;
            let kind = self.words.int()?;
            let (dimension, corners) = self.kind(kind)?;
            if entity != dimension {
                return self.words.error(format!("elements of dimension {dimension} on an entity of {entity}"));
            }
            let first = sum;
            sum += self.words.size()?;
            self.check_sum(sum, total, false)?;
            for number in first..sum {
                self.words.size()?;
                let element = Element { total, number, dimension, corners: &[], region };
                self.element(element, corners, Tokenizer::size, &mut visit)?;
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

    /// Reads the nodes of an element whose other data are known.
    fn element(
        &mut self,
        known: Element,
        count: usize,
        next: impl Fn(&mut Tokenizer<R>) -> Result<usize, String>,
        visit: &mut impl FnMut(&Element) -> Result<(), String>,
    ) -> Result<(), String> {
        let mut corners = [0; 8];
        for i in 0..count {
            let number = next(&mut self.words)?;
            let Some(index) = self.nodes.find(number) else {
                return self.words.error(format!("an element has a node {number} that is not there"));
            };
            if corners[..i].contains(&index) {
                return self.words.error(format!("an element has node {number} twice"));
            }
            corners[i] = index;
        }
        self.nodes.use_in(&corners[..count], known.dimension == 3);
        visit(&Element { corners: &corners[..count], ..known }).or_else(|what| self.words.error(what))
    }
}
