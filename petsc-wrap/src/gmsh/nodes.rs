//! Numbers and order of the nodes of a Gmsh file, and their use by its elements.

/// The lookup table is as long as the span of the node numbers. Its longest allowed length is `SPARSEST` × number of
/// nodes + `SPAN_ALWAYS`.
const SPARSEST: usize = 64;
const SPAN_ALWAYS: usize = 1 << 20;

/// Marks a number that no node has.
const ABSENT: u32 = u32::MAX;

/// The nodes of a file: they are first added, then closed, then looked up by elements.
pub(super) struct Nodes {
    numbers: Numbers,
    use_: Option<Use>,
}

/// Map from a node's number to its index, which is its position in the file.
enum Numbers {
    /// Consecutive numbers, which Gmsh writes by default: no list is needed.
    Consecutive { first: usize, count: usize },
    /// Any other numbers, while nodes are being added.
    Listed(Vec<u32>),
    /// The index for each number, starting at the smallest number.
    Table { first: usize, count: usize, indices: Vec<u32> },
}

/// How elements use the nodes. One rank finds this out for all ranks.
struct Use {
    states: Vec<State>,
    /// For each node, another node of the same connected part; the root of a part refers to itself.
    joined: Vec<u32>,
}

#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum State {
    Unused,
    /// Used only by points, lines or facets.
    Loose,
    InCell,
}

impl Nodes {
    /// No nodes yet. `is_judge`: whether this rank finds out which nodes are used and how they are connected.
    pub fn new(is_judge: bool) -> Self {
        let use_ = is_judge.then(|| Use { states: Vec::new(), joined: Vec::new() });
        Self { numbers: Numbers::Consecutive { first: 0, count: 0 }, use_ }
    }

    /// Adds a node. Its number has at most 31 bits.
    pub fn add(&mut self, number: usize) {
        match &mut self.numbers {
            Numbers::Consecutive { first, count } if *count == 0 => (*first, *count) = (number, 1),
            Numbers::Consecutive { first, count } if number == *first + *count => *count += 1,
            Numbers::Consecutive { first, count } => {
                let mut list: Vec<u32> = (*first..*first + *count).map(|number| number as u32).collect();
                list.push(number as u32);
                self.numbers = Numbers::Listed(list);
            }
            Numbers::Listed(list) => list.push(number as u32),
            Numbers::Table { .. } => unreachable!("nodes are added before they are closed"),
        }
    }

    /// Closes the list after the last node. `span` is the smallest and the largest number, if the file tells them.
    pub fn close(&mut self, span: Option<(usize, usize)>) -> Result<(), String> {
        let (least, largest) = match &self.numbers {
            Numbers::Listed(list) => {
                let ends = list.iter().fold((ABSENT, 0), |(least, most), n| (least.min(*n), most.max(*n)));
                (ends.0 as usize, ends.1 as usize)
            }
            Numbers::Consecutive { first, count } if *count > 0 => (*first, *first + *count - 1),
            _ => return Err("the mesh has no nodes".to_owned()),
        };
        if let Some((first, last)) = span
            && (least < first || largest > last)
        {
            return Err(format!("nodes are numbered from {least} to {largest}, where {first} to {last} was announced"));
        }
        if let Numbers::Listed(list) = &self.numbers {
            let count = list.len();
            if largest - least > SPARSEST * count + SPAN_ALWAYS {
                return Err(format!("the {count} nodes are numbered from {least} to {largest}: renumber them in Gmsh"));
            }
            let mut indices = vec![ABSENT; largest - least + 1];
            for (index, number) in list.iter().enumerate() {
                let place = &mut indices[*number as usize - least];
                if *place != ABSENT {
                    return Err(format!("two nodes have the number {number}"));
                }
                *place = index as u32;
            }
            self.numbers = Numbers::Table { first: least, count, indices };
        }
        let count = self.count();
        if let Some(of_nodes) = &mut self.use_ {
            *of_nodes = Use { states: vec![State::Unused; count], joined: (0..count as u32).collect() };
        }
        Ok(())
    }

    /// Number of nodes.
    pub fn count(&self) -> usize {
        match &self.numbers {
            Numbers::Consecutive { count, .. } | Numbers::Table { count, .. } => *count,
            Numbers::Listed(list) => list.len(),
        }
    }

    /// Returns the index of a node used by an element; `None` if no node has this number.
    pub fn find(&self, number: usize) -> Option<u32> {
        match &self.numbers {
            Numbers::Consecutive { first, count } => {
                number.checked_sub(*first).filter(|index| index < count).map(|index| index as u32)
            }
            Numbers::Table { first, indices, .. } => {
                indices.get(number.checked_sub(*first)?).copied().filter(|index| *index != ABSENT)
            }
            Numbers::Listed(_) => None,
        }
    }

    /// Notes that an element, which may be a cell or not, uses these existing nodes.
    pub fn use_in(&mut self, corners: &[u32], is_cell: bool) {
        let Some(of_nodes) = &mut self.use_ else { return };
        let state = if is_cell { State::InCell } else { State::Loose };
        for corner in corners {
            let known = &mut of_nodes.states[*corner as usize];
            if *known < state {
                *known = state;
            }
        }
        if is_cell {
            of_nodes.join(corners);
        }
    }

    /// Returns the number of parts of the body that share no node, and 0 on ranks that do not find this out. There must
    /// be cells. A node used only by elements other than cells is an error, because it would be a vertex without
    /// stiffness. The record of the nodes' use is dropped here.
    pub fn judge(&mut self) -> Result<usize, String> {
        let Some(Use { states, joined }) = self.use_.take() else { return Ok(0) };
        if !states.contains(&State::InCell) {
            return Err("the mesh has no cells: a solid needs tetrahedra or hexahedra".to_owned());
        }
        if let Some(index) = states.iter().position(|state| *state == State::Loose) {
            let number = match &self.numbers {
                Numbers::Table { first, indices, .. } => {
                    first + indices.iter().position(|known| *known as usize == index).unwrap_or_default()
                }
                Numbers::Consecutive { first, .. } => first + index,
                Numbers::Listed(_) => index,
            };
            return Err(format!(
                "node {number} belongs to a point, line or surface but to no cell: save without Mesh.SaveAll"
            ));
        }
        Ok((0..states.len()).filter(|&i| states[i] == State::InCell && joined[i] as usize == i).count())
    }
}

impl Use {
    fn join(&mut self, corners: &[u32]) {
        for pair in corners.windows(2) {
            let [one, other] = [pair[0], pair[1]].map(|index| self.root(index));
            self.joined[one.max(other) as usize] = one.min(other);
        }
    }

    fn root(&mut self, mut index: u32) -> u32 {
        while self.joined[index as usize] != index {
            // Path halving: each node on the way is linked closer to the root.
            self.joined[index as usize] = self.joined[self.joined[index as usize] as usize];
            index = self.joined[index as usize];
        }
        index
    }
}

#[cfg(test)]
mod tests {
    use super::Nodes;

    #[test]
    fn numbers_lead_to_places_in_the_file() {
        for numbers in [vec![5, 6, 7, 8], vec![5, 6, 9, 7], vec![9, 2, 4]] {
            let mut nodes = Nodes::new(false);
            numbers.iter().for_each(|number| nodes.add(*number));
            nodes.close(None).unwrap();
            assert_eq!(nodes.count(), numbers.len());
            for number in 0..20 {
                assert_eq!(nodes.find(number).map(|i| i as usize), numbers.iter().position(|n| *n == number));
            }
        }
    }
}
