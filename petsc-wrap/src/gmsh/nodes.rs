//! Which nodes a Gmsh file has, in which order, and which of them its elements use.

/// A list over the span of the nodes' numbers may be this many times as long as their count, and some.
const SPARSEST: usize = 64;
const SPAN_ALWAYS: usize = 1 << 20;

/// A number that no node has.
const ABSENT: u32 = u32::MAX;

/// The nodes: first added, then closed, then looked up by elements.
pub(super) struct Nodes {
    numbers: Numbers,
    use_: Option<Use>,
}

/// From a node's number to its index: its place in the file.
enum Numbers {
    /// As Gmsh writes them: no list is needed.
    Consecutive { first: usize, count: usize },
    /// Any others, while they are added.
    Listed(Vec<u32>),
    /// The index by the number, from the least number.
    Table { first: usize, count: usize, indices: Vec<u32> },
}

/// What one rank finds out for all.
struct Use {
    states: Vec<State>,
    /// For each node one of the same connected part; for the part's root itself.
    joined: Vec<u32>,
}

#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum State {
    Unused,
    /// Used by a point, a line or a facet only.
    Loose,
    InCell,
}

impl Nodes {
    /// None yet. `is_judge`: whether it is to be told which are used, and how they hang together.
    pub fn new(is_judge: bool) -> Self {
        let use_ = is_judge.then(|| Use { states: Vec::new(), joined: Vec::new() });
        Self { numbers: Numbers::Consecutive { first: 0, count: 0 }, use_ }
    }

    /// A node, by a number of 31 bits.
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

    /// All nodes are known; `span` are the least and the largest number where the file tells them.
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

    /// How many.
    pub fn count(&self) -> usize {
        match &self.numbers {
            Numbers::Consecutive { count, .. } | Numbers::Table { count, .. } => *count,
            Numbers::Listed(list) => list.len(),
        }
    }

    /// The index of a node that an element uses; `None` where there is none of that number.
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

    /// An element, a cell or not, uses nodes that are there.
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

    /// How many parts of the body share no node, and 0 where that is not for this rank to say. There must be cells; a node outside all of them that
    /// other elements use would be a vertex without stiffness. Nothing is known of the nodes' use from here on.
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
            // Each node on the way comes nearer to the root.
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
