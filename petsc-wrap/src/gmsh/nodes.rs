//! The nodes of a Gmsh file, by their numbers.

use std::collections::HashMap;

/// The nodes of a file; the index of a node is its position in the file.
#[derive(Default)]
pub(super) struct Nodes {
    /// Coordinates, m.
    pub coordinates: Vec<[f64; 3]>,
    /// Number of the first node. By default, Gmsh numbers nodes consecutively, and `indices` is `None`.
    first: usize,
    indices: Option<HashMap<usize, u32>>,
    /// Whether a node belongs to an element of any dimension.
    is_used: Vec<bool>,
}

impl Nodes {
    /// Adds a node with a number of at most 31 bits.
    pub fn add(&mut self, number: usize) -> Result<(), String> {
        let index = self.is_used.len();
        if index == 0 {
            self.first = number;
        }
        if self.indices.is_none() && number != self.first + index {
            self.indices = Some((0..index).map(|index| (self.first + index, index as u32)).collect());
        }
        if let Some(indices) = &mut self.indices
            && indices.insert(number, index as u32).is_some()
        {
            return Err(format!("two nodes have the number {number}"));
        }
        self.is_used.push(false);
        Ok(())
    }

    /// Returns the index of the node of an element, and notes its use; `None` if no node has this number.
    pub fn take(&mut self, number: usize) -> Option<u32> {
        let index = match &self.indices {
            Some(indices) => *indices.get(&number)?,
            None => number.checked_sub(self.first).filter(|index| *index < self.is_used.len())? as u32,
        };
        self.is_used[index as usize] = true;
        Some(index)
    }

    /// Returns the number of a node that belongs to an element but to none of these `cells`.
    pub fn find_loose(&self, cells: impl IntoIterator<Item = usize>) -> Option<usize> {
        let mut is_loose = self.is_used.clone();
        cells.into_iter().for_each(|index| is_loose[index] = false);
        let loose = is_loose.iter().position(|is_loose| *is_loose)?;
        let listed = self.indices.iter().flatten().find(|(_, index)| **index as usize == loose);
        Some(listed.map_or(self.first + loose, |(number, _)| *number))
    }
}

/// Number of connected components among `count` nodes, where the nodes of each list are connected; nodes in no list are not
/// counted.
pub(super) fn count_parts<'a>(count: usize, lists: impl Iterator<Item = &'a [crate::Int]>) -> usize {
    // Each node refers to another one of its part, and the root of a part to itself.
    let mut parents: Vec<usize> = (0..count).collect();
    let mut is_listed = vec![false; count];
    let mut find_root = |parents: &mut Vec<usize>, node: crate::Int| {
        let mut index = node as usize;
        is_listed[index] = true;
        while parents[index] != index {
            // Each node on the way is linked closer to the root.
            parents[index] = parents[parents[index]];
            index = parents[index];
        }
        index
    };
    for list in lists {
        for pair in list.windows(2) {
            let [one, other] = [pair[0], pair[1]].map(|node| find_root(&mut parents, node));
            parents[one.max(other)] = one.min(other);
        }
    }
    (0..count).filter(|&index| is_listed[index] && parents[index] == index).count()
}

#[cfg(test)]
mod tests {
    use super::{Nodes, count_parts};

    #[test]
    fn numbers_lead_to_places_in_the_file() {
        for numbers in [vec![5, 6, 7, 8], vec![5, 6, 9, 7], vec![9, 2, 4]] {
            let mut nodes = Nodes::default();
            numbers.iter().for_each(|number| nodes.add(*number).unwrap());
            for number in 0..20 {
                assert_eq!(nodes.take(number).map(|i| i as usize), numbers.iter().position(|n| *n == number));
            }
            assert_eq!(nodes.find_loose([0, 2]), Some(numbers[1]));
            assert_eq!(nodes.find_loose(0..numbers.len()), None);
            assert!(nodes.add(numbers[1]).is_err());
        }
    }

    #[test]
    fn parts_share_no_node() {
        let lists: [&[crate::Int]; 4] = [&[0, 3], &[5, 6, 1], &[3, 2], &[1, 8]];
        assert_eq!(count_parts(9, lists.into_iter()), 2);
    }
}
