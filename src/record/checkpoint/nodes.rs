//! Finds nodes by their positions.

use std::collections::HashMap;

use crate::scene::Vec3;

/// Tolerance of node positions divided by the diagonal of the box around all nodes: closer positions are the same node.
const POSITION_TOLERANCE: f64 = 1e-9;

/// Hash table of nodes by position.
pub struct Nodes<'a> {
    nodes: &'a [Vec3],
    /// Side length of the cells of the table, m.
    size: f64,
    by_cell: HashMap<[i64; 3], Vec<usize>>,
}

impl<'a> Nodes<'a> {
    /// Builds the table.
    pub fn new(nodes: &'a [Vec3]) -> Self {
        let across = |axis: usize| {
            let values = || nodes.iter().map(|x| x[axis]);
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        };
        let diagonal = (0..3).map(|axis| across(axis).powi(2)).sum::<f64>().sqrt();
        // Cells are much larger than the tolerance, so that for most positions only one cell must be searched.
        let size = if diagonal > 0.0 { 1e3 * POSITION_TOLERANCE * diagonal } else { 1.0 };
        let mut by_cell: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
        for (number, x) in nodes.iter().enumerate() {
            by_cell.entry(cell(*x, size)).or_default().push(number);
        }
        Self { nodes, size, by_cell }
    }

    /// Number of the node at a position; `None` if there is no node or more than one.
    pub fn at(&self, x: Vec3) -> Option<usize> {
        let near = 1e-3 * self.size;
        let [low, high] = [-near, near].map(|by| cell(x.map(|x| x + by), self.size));
        let mut found = None;
        for i in low[0]..=high[0] {
            for j in low[1]..=high[1] {
                for k in low[2]..=high[2] {
                    for &number in self.by_cell.get(&[i, j, k]).into_iter().flatten() {
                        let distance =
                            (0..3).map(|axis| (self.nodes[number][axis] - x[axis]).abs()).fold(0.0, f64::max);
                        if distance <= near && found.replace(number).is_some() {
                            return None;
                        }
                    }
                }
            }
        }
        found
    }
}

fn cell(x: Vec3, size: f64) -> [i64; 3] {
    x.map(|x| (x / size).floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes are found from positions with rounding errors, also across cells of the table; other positions have no
    /// node.
    #[test]
    fn nodes_are_found_by_their_places() {
        let nodes: Vec<Vec3> = (0..1000)
            .map(|i| [0.1 * f64::from(i % 10), 0.3 * f64::from(i / 10 % 10), -0.02 * f64::from(i / 100)])
            .collect();
        let table = Nodes::new(&nodes);
        for (number, x) in nodes.iter().enumerate() {
            for by in [0.0, 1e-12, -1e-12] {
                assert_eq!(table.at(x.map(|x| x + by)), Some(number));
            }
            assert_eq!(table.at(x.map(|x| x + 1e-4)), None);
        }
    }

    /// Neither of two nodes at the same position is returned.
    #[test]
    fn twins_are_not_told_apart() {
        let nodes = [[0.0; 3], [1.0; 3], [1.0; 3]];
        let table = Nodes::new(&nodes);
        assert_eq!((table.at([0.0; 3]), table.at([1.0; 3])), (Some(0), None));
    }
}
