//! Parses a Gmsh file and checks everything in it: a file that does not follow its format is refused.
//!
//! The sections come in the order in which Gmsh writes them. Formats: Gmsh's manual, "MSH file format", 2.2 and 4.1,
//! text and binary.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::io::BufRead;

use crate::Int;

use super::PhysicalGroup;
use super::nodes::Nodes;
use super::tokens::Tokens;

/// Most tags of an element in format 2.2, which has one for each rank of a partitioned mesh.
const TAGS: usize = 1000;
/// Most bytes of a physical name.
const NAME: usize = 255;

/// The contents of a Gmsh file.
#[derive(Default)]
pub(super) struct GmshFile {
    /// The nodes.
    pub nodes: Nodes,
    /// The cells.
    pub cells: Elements,
    /// The facets.
    pub facets: Elements,
    /// Physical groups of facets and of cells: the named ones, and unnamed ones that have elements, named by their
    /// number.
    pub groups: [Vec<PhysicalGroup>; 2],
    /// For the physical groups of facets and of cells, the number of the first group of the same name.
    first_of_name: [HashMap<Int, Int>; 2],
    /// Physical groups of the geometric entities of format 4.1, by dimension and number; `None` if the file has no list
    /// of them.
    entities: Option<[HashMap<i32, BTreeSet<Int>>; 4]>,
}

/// Elements of one dimension. One that the file lists for each of its physical groups is a single element here.
#[derive(Default)]
pub(super) struct Elements {
    /// Vertices of the elements in the file's order, element after element: positions in the list of nodes.
    pub vertices: Vec<Int>,
    /// For each element the index of its set of groups in `sets`.
    pub set_of: Vec<usize>,
    /// Sets of numbers of physical groups; the first one is empty.
    pub sets: Vec<BTreeSet<Int>>,
    indices_of_sets: HashMap<BTreeSet<Int>, usize>,
    /// Index of each element, by its [`key`].
    indices: HashMap<[Int; 8], usize>,
    /// Number of elements with four vertices, and with another number.
    pub counts: [usize; 2],
}

/// The vertices of an element in ascending order, which identify it; further entries are −1.
fn key(vertices: &[Int]) -> [Int; 8] {
    let mut key = [-1; 8];
    key[..vertices.len()].copy_from_slice(vertices);
    key[..vertices.len()].sort_unstable();
    key
}

impl Elements {
    /// Adds an element with its groups. If there is one of these vertices already, it gets the groups as well.
    fn add(&mut self, vertices: &[Int], groups: &BTreeSet<Int>) {
        let next = self.set_of.len();
        let index = *self.indices.entry(key(vertices)).or_insert(next);
        if index < next {
            let all = self.sets[self.set_of[index]].union(groups).copied().collect();
            self.set_of[index] = self.index_of_set(all);
            return;
        }
        self.vertices.extend(vertices);
        self.counts[usize::from(vertices.len() != 4)] += 1;
        let set = self.index_of_set(groups.clone());
        self.set_of.push(set);
    }

    fn index_of_set(&mut self, groups: BTreeSet<Int>) -> usize {
        if let Some(index) = self.indices_of_sets.get(&groups) {
            return *index;
        }
        self.sets.push(groups.clone());
        self.indices_of_sets.insert(groups, self.sets.len() - 1);
        self.sets.len() - 1
    }

    /// Index of the element with these vertices, in any order.
    pub fn find(&self, vertices: &[Int]) -> Option<usize> {
        self.indices.get(&key(vertices)).copied()
    }

    /// The physical groups of an element.
    pub fn groups(&self, element: usize) -> &BTreeSet<Int> {
        &self.sets[self.set_of[element]]
    }
}

impl GmshFile {
    /// Parses a file.
    pub fn parse(source: impl BufRead) -> Result<Self, String> {
        let mut tokens = Tokens::new(source)?;
        let mut file = Self::default();
        let is_modern = read_format(&mut tokens)?;
        loop {
            match tokens.word()?.as_str() {
                "$Comments" => while tokens.word()? != "$EndComments" {},
                "$PhysicalNames" => file.read_names(&mut tokens)?,
                "$Entities" if is_modern => file.read_entities(&mut tokens)?,
                "$PartitionedEntities" => {
                    return tokens
                        .error("the mesh is partitioned: save it whole (in Gmsh: Modules, Mesh, Unpartition)");
                }
                "$ParametricNodes" => return refuse_parametric(&tokens),
                "$Nodes" => break,
                other => return tokens.error(format!("expected $Nodes, found {other:?}")),
            }
        }
        if is_modern { file.read_nodes_41(&mut tokens) } else { file.read_nodes_22(&mut tokens) }?;
        tokens.expect("$EndNodes")?;
        tokens.expect("$Elements")?;
        if is_modern { file.read_elements_41(&mut tokens) } else { file.read_elements_22(&mut tokens) }?;
        tokens.expect("$EndElements")?;
        file.name_unnamed_groups();
        file.check()?;
        Ok(file)
    }

    fn read_names<R: BufRead>(&mut self, tokens: &mut Tokens<R>) -> Result<(), String> {
        for _ in 0..tokens.written_count()? {
            let (dimension, number) = (tokens.written_count()?, tokens.written_count()? as Int);
            let line = tokens.line()?;
            let quoted = line.trim();
            let Some(name) = quoted.strip_prefix('"').and_then(|name| name.strip_suffix('"')) else {
                return tokens.error(format!("expected a name in quotes, found {quoted:?}"));
            };
            if !(1..=NAME).contains(&name.len()) {
                return tokens.error(format!("a physical name has 1 to {NAME} bytes, and this one has {}", name.len()));
            }
            let (2 | 3) = dimension else { continue };
            let (groups, first_of_name) = (&mut self.groups[dimension - 2], &mut self.first_of_name[dimension - 2]);
            let known = groups.iter().find(|group| group.name == name).map(|group| group.number);
            if first_of_name.get(&number).is_some_and(|before| known != Some(*before)) {
                return tokens.error(format!("physical group {number} of dimension {dimension} has two names"));
            }
            first_of_name.insert(number, known.unwrap_or(number));
            if known.is_none() {
                groups.push(PhysicalGroup { number, name: name.to_owned() });
            }
        }
        tokens.expect("$EndPhysicalNames")
    }

    /// The number of the group of a physical tag: the first group of the same name. `None` for 0, which means no group.
    /// Gmsh writes the tags of reversed entities with a minus.
    fn group<R: BufRead>(&self, tokens: &Tokens<R>, dimension: usize, tag: i32) -> Result<Option<Int>, String> {
        let Some(number) = tag.checked_abs() else { return tokens.error(format!("{tag} is not a physical group")) };
        let number = Int::from(number);
        let first = dimension.checked_sub(2).and_then(|i| self.first_of_name[i].get(&number)).unwrap_or(&number);
        Ok((number != 0).then_some(*first))
    }

    fn read_entities<R: BufRead>(&mut self, tokens: &mut Tokens<R>) -> Result<(), String> {
        let counts = [tokens.size()?, tokens.size()?, tokens.size()?, tokens.size()?];
        let mut entities: [HashMap<i32, BTreeSet<Int>>; 4] = Default::default();
        for (dimension, count) in counts.into_iter().enumerate() {
            for _ in 0..count {
                let number = tokens.int()?;
                for _ in 0..if dimension == 0 { 3 } else { 6 } {
                    tokens.real()?;
                }
                let mut groups = BTreeSet::new();
                for _ in 0..tokens.size()? {
                    let tag = tokens.int()?;
                    groups.extend(self.group(tokens, dimension, tag)?);
                }
                entities[dimension].insert(number, groups);
                for _ in 0..if dimension == 0 { 0 } else { tokens.size()? } {
                    tokens.int()?;
                }
            }
        }
        self.entities = Some(entities);
        tokens.expect("$EndEntities")
    }

    fn read_nodes_22<R: BufRead>(&mut self, tokens: &mut Tokens<R>) -> Result<(), String> {
        for _ in 0..tokens.written_count()? {
            let number = tokens.int()?;
            match usize::try_from(number) {
                Ok(number) => self.nodes.add(number).or_else(|what| tokens.error(what))?,
                Err(_) => return tokens.error(format!("{number} cannot be the number of a node")),
            }
            self.nodes.coordinates.push(read_place(tokens)?);
        }
        Ok(())
    }

    fn read_nodes_41<R: BufRead>(&mut self, tokens: &mut Tokens<R>) -> Result<(), String> {
        let (blocks, total) = (tokens.size()?, tokens.size()?);
        let _span = (tokens.size()?, tokens.size()?);
        for _ in 0..blocks {
            self.read_entity(tokens)?;
            if tokens.int()? != 0 {
                return refuse_parametric(tokens);
            }
            let count = tokens.size()?;
            check_sum(tokens, self.nodes.coordinates.len() + count, total, false)?;
            for _ in 0..count {
                let number = tokens.size()?;
                self.nodes.add(number).or_else(|what| tokens.error(what))?;
            }
            for _ in 0..count {
                self.nodes.coordinates.push(read_place(tokens)?);
            }
        }
        check_sum(tokens, self.nodes.coordinates.len(), total, true)
    }

    /// Reads the dimension and the number of a block's entity; returns the dimension and the entity's physical groups.
    fn read_entity<R: BufRead>(&self, tokens: &mut Tokens<R>) -> Result<(usize, BTreeSet<Int>), String> {
        let (dimension, number) = (tokens.int()?, tokens.int()?);
        let Some(known) = usize::try_from(dimension).ok().filter(|dimension| *dimension < 4) else {
            return tokens.error(format!("{dimension} is not the dimension of an entity"));
        };
        match &self.entities {
            None => Ok((known, BTreeSet::new())),
            Some(entities) => match entities[known].get(&number) {
                Some(groups) => Ok((known, groups.clone())),
                None => tokens.error(format!("there is no entity {number} of dimension {dimension}")),
            },
        }
    }

    fn read_elements_22<R: BufRead>(&mut self, tokens: &mut Tokens<R>) -> Result<(), String> {
        let total = tokens.written_count()?;
        let mut sum = 0;
        while sum < total {
            // Text: number, kind and number of tags of each element. Binary: kind, number of elements and number of
            // tags of a block.
            let head = [tokens.int()?, tokens.int()?, tokens.int()?];
            let (kind, count) = if tokens.binary { (head[0], head[1]) } else { (head[1], 1) };
            let tags = match usize::try_from(head[2]) {
                Ok(tags) if tags <= TAGS => tags,
                _ => return tokens.error(format!("{} is not a count of tags", head[2])),
            };
            let kind = Kind::new(tokens, kind)?;
            if count < 1 {
                return tokens.error("a block without elements");
            }
            sum += count as usize;
            check_sum(tokens, sum, total, false)?;
            for _ in 0..count {
                if tokens.binary {
                    // The element's number.
                    tokens.int()?;
                }
                let tags = (0..tags).map(|_| tokens.int()).collect::<Result<Vec<_>, _>>()?;
                // The first tag is the physical group.
                let group = self.group(tokens, kind.dimension, tags.first().copied().unwrap_or_default())?;
                let next = |tokens: &mut Tokens<R>| Ok(tokens.int()?.try_into().unwrap_or(usize::MAX));
                self.read_element(tokens, kind, &group.into_iter().collect(), next)?;
            }
        }
        Ok(())
    }

    fn read_elements_41<R: BufRead>(&mut self, tokens: &mut Tokens<R>) -> Result<(), String> {
        let (blocks, total) = (tokens.size()?, tokens.size()?);
        let _span = (tokens.size()?, tokens.size()?);
        let mut sum = 0;
        for _ in 0..blocks {
            let (dimension, groups) = self.read_entity(tokens)?;
            let kind = tokens.int()?;
            let kind = Kind::new(tokens, kind)?;
            if dimension != kind.dimension {
                return tokens.error(format!("elements of dimension {} on an entity of {dimension}", kind.dimension));
            }
            let count = tokens.size()?;
            sum += count;
            check_sum(tokens, sum, total, false)?;
            for _ in 0..count {
                // The element's number.
                tokens.size()?;
                self.read_element(tokens, kind, &groups, Tokens::size)?;
            }
        }
        check_sum(tokens, sum, total, true)
    }

    /// Reads the nodes of an element, whose other data are known.
    fn read_element<R: BufRead>(
        &mut self,
        tokens: &mut Tokens<R>,
        kind: Kind,
        groups: &BTreeSet<Int>,
        next: impl Fn(&mut Tokens<R>) -> Result<usize, String>,
    ) -> Result<(), String> {
        let mut vertices = [0; 8];
        for i in 0..kind.vertices {
            let number = next(tokens)?;
            let Some(index) = self.nodes.take(number) else {
                return tokens.error(format!("an element has the node {number}, which is not in $Nodes"));
            };
            let index = index as Int;
            if vertices[..i].contains(&index) {
                return tokens.error(format!("an element has node {number} twice"));
            }
            vertices[i] = index;
        }
        match kind.dimension {
            2 => self.facets.add(&vertices[..kind.vertices], groups),
            3 => self.cells.add(&vertices[..kind.vertices], groups),
            _ => (),
        }
        Ok(())
    }

    /// Names a group that has elements and no name by its number, unless another one has this name.
    fn name_unnamed_groups(&mut self) {
        for (groups, elements) in self.groups.iter_mut().zip([&self.facets, &self.cells]) {
            let known: HashSet<Int> = groups.iter().map(|group| group.number).collect();
            let used: BTreeSet<Int> = elements.sets.iter().flatten().copied().collect();
            for number in used.into_iter().filter(|number| !known.contains(number)) {
                let name = number.to_string();
                if groups.iter().all(|group| group.name != name) {
                    groups.push(PhysicalGroup { number, name });
                }
            }
        }
    }

    /// Checks that there are cells, of one shape, and that every node of a point, line or surface also belongs to a cell.
    fn check(&self) -> Result<(), String> {
        let cells = &self.cells;
        if cells.set_of.is_empty() {
            return Err("the mesh has no cells: a solid needs tetrahedra or hexahedra".to_owned());
        }
        if let Some(number) = self.nodes.find_loose(cells.vertices.iter().map(|index| *index as usize)) {
            return Err(format!(
                "node {number} belongs to a point, line or surface but to no cell: save without Mesh.SaveAll, and without physical groups beside the volumes"
            ));
        }
        match cells.counts {
            [0, _] | [_, 0] => Ok(()),
            [tetrahedra, hexahedra] => {
                Err(format!("the mesh mixes shapes: {tetrahedra} tetrahedra, {hexahedra} hexahedra"))
            }
        }
    }
}

/// Dimension and number of vertices of a kind of element.
#[derive(Clone, Copy)]
struct Kind {
    dimension: usize,
    vertices: usize,
}

impl Kind {
    fn new<R: BufRead>(tokens: &Tokens<R>, kind: i32) -> Result<Self, String> {
        let (dimension, vertices) = match kind {
            15 => (0, 1),
            1 => (1, 2),
            2 => (2, 3),
            3 => (2, 4),
            4 => (3, 4),
            5 => (3, 8),
            6 | 7 => {
                return tokens.error("the mesh has prisms or pyramids: mesh with tetrahedra alone, or with hexahedra");
            }
            _ => {
                let what = format!("elements of Gmsh's type {kind} are not read: save with Mesh.ElementOrder = 1");
                return tokens.error(what);
            }
        };
        Ok(Self { dimension, vertices })
    }
}

/// Reads the section $MeshFormat; returns whether the format is 4.1.
fn read_format<R: BufRead>(tokens: &mut Tokens<R>) -> Result<bool, String> {
    if tokens.word().as_deref() != Ok("$MeshFormat") {
        return Err("it is not a Gmsh mesh: it does not begin with $MeshFormat".to_owned());
    }
    let is_modern = match tokens.word()?.as_str() {
        "2.2" => false,
        "4.1" => true,
        other => return tokens.error(format!("Gmsh's format {other:?} is not read, only 2.2 and 4.1")),
    };
    let is_binary = match tokens.word()?.as_str() {
        "0" => false,
        "1" => true,
        other => return tokens.error(format!("expected 0 (text) or 1 (binary), found {other:?}")),
    };
    tokens.expect("8")?;
    tokens.binary = is_binary;
    if is_binary && tokens.int()? != 1 {
        return tokens
            .error("the file is big-endian (its bytes have the other order), and only little-endian files are read");
    }
    tokens.expect("$EndMeshFormat")?;
    Ok(is_modern)
}

fn read_place<R: BufRead>(tokens: &mut Tokens<R>) -> Result<[f64; 3], String> {
    let mut place = [0.0; 3];
    for x in &mut place {
        *x = tokens.real()?;
        if !x.is_finite() {
            return tokens.error("a node has a coordinate that is not finite");
        }
    }
    Ok(place)
}

fn refuse_parametric<R: BufRead, T>(tokens: &Tokens<R>) -> Result<T, String> {
    tokens.error("parametric coordinates are not read: save with Mesh.SaveParametric = 0")
}

/// Checks that the blocks hold no more items than announced and, at the `end`, no fewer.
fn check_sum<R: BufRead>(tokens: &Tokens<R>, sum: usize, total: usize, end: bool) -> Result<(), String> {
    if sum > total || end && sum < total {
        return tokens.error(format!("the blocks hold {sum} in all, where {total} were announced"));
    }
    Ok(())
}
