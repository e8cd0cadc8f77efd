//! Which nodes a Gmsh file has, and which of them its elements use.

/// PETSc makes an array over the span of the nodes' numbers: it may be this many times their count, and some.
const SPARSEST: usize = 64;
const SPAN_ALWAYS: usize = 1 << 20;

/// What is known of a number.
const ABSENT: u8 = 0;
const UNUSED: u8 = 1;
/// Used by a point, a line or a facet only.
const LOOSE: u8 = 2;
const IN_CELL: u8 = 3;

/// The nodes: first added, then closed, then touched by elements.
#[derive(Default)]
pub(super) struct Nodes {
    numbers: Vec<usize>,
    first: usize,
    states: Vec<u8>,
    /// For each node one of the same connected part; for the part's root itself.
    joined: Vec<usize>,
}

impl Nodes {
    pub fn add(&mut self, number: usize) {
        self.numbers.push(number);
    }

    /// All nodes are known; `span` are the least and the largest number where the file tells them.
    pub fn close(&mut self, span: Option<(usize, usize)>) -> Result<(), String> {
        let (Some(&least), Some(&largest)) = (self.numbers.iter().min(), self.numbers.iter().max()) else {
            return Err("the mesh has no nodes".to_owned());
        };
        let (first, last) = span.unwrap_or((least, largest));
        if least < first || largest > last {
            return Err(format!("nodes are numbered from {least} to {largest}, where {first} to {last} was announced"));
        }
        let count = self.numbers.len();
        if last - first > SPARSEST * count + SPAN_ALWAYS {
            return Err(format!("the {count} nodes are numbered from {first} to {last}: renumber them in Gmsh"));
        }
        self.first = first;
        self.states = vec![ABSENT; last - first + 1];
        self.joined = (0..=last - first).collect();
        for number in std::mem::take(&mut self.numbers) {
            let state = &mut self.states[number - first];
            if *state != ABSENT {
                return Err(format!("two nodes have the number {number}"));
            }
            *state = UNUSED;
        }
        Ok(())
    }

    /// An element uses a node; whether there is such a node.
    pub fn touch(&mut self, number: usize, by_cell: bool) -> bool {
        let state = number.checked_sub(self.first).and_then(|index| self.states.get_mut(index));
        match state {
            None | Some(&mut ABSENT) => false,
            Some(state) => {
                *state = (*state).max(if by_cell { IN_CELL } else { LOOSE });
                true
            }
        }
    }

    /// A cell joins its nodes, which are there.
    pub fn join(&mut self, corners: &[usize]) {
        for pair in corners.windows(2) {
            let [one, other] = [pair[0], pair[1]].map(|number| self.root(number - self.first));
            self.joined[one.max(other)] = one.min(other);
        }
    }

    fn root(&mut self, mut index: usize) -> usize {
        while self.joined[index] != index {
            // Each node on the way comes nearer to the root.
            self.joined[index] = self.joined[self.joined[index]];
            index = self.joined[index];
        }
        index
    }

    /// Parts of the body that share no node.
    pub fn parts(&self) -> usize {
        (0..self.states.len()).filter(|&index| self.states[index] == IN_CELL && self.joined[index] == index).count()
    }

    /// There must be cells; a node outside all of them that other elements use would be a vertex without stiffness.
    pub fn check_use(&self) -> Result<(), String> {
        if !self.states.contains(&IN_CELL) {
            return Err("the mesh has no cells: a solid needs tetrahedra or hexahedra".to_owned());
        }
        match self.states.iter().position(|state| *state == LOOSE) {
            Some(index) => Err(format!(
                "node {} belongs to a point, line or surface but to no cell: save without Mesh.SaveAll",
                self.first + index
            )),
            None => Ok(()),
        }
    }
}
