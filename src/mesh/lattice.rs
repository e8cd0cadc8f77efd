//! Cells and nodes of a box on several ranks. Each rank computes its part; the position of a node in the grid
//! determines its number and its owner.

use std::ops::Range;

use petsc_wrap::{Comm, Error, Int};

use crate::element::{Element, Shape};
use crate::error::Result;
use crate::scene::Vec3;

use super::Elements;
use super::block::block;

/// Node numbering of the grid. Elements of order p on n cells have p n + 1 nodes along an axis.
struct Lattice {
    order: usize,
    /// Nodes owned by this rank and by the ranks with adjacent cells.
    owners: Vec<Owned>,
}

/// Nodes that a rank owns: the nodes of its cells, except nodes on their lower faces that also belong to other cells.
struct Owned {
    nodes: [Range<usize>; 3],
    /// Global number of the first node. The last axis runs fastest, since a plate has few cells across it.
    first: usize,
}

/// A rank's part of a box.
pub(super) struct BoxPart {
    pub cells: Elements,
    /// Facets on the boundary of the grid.
    pub facets: Elements,
    pub owned_nodes: usize,
}

impl Owned {
    fn new(cells: &[Range<usize>; 3], order: usize, first: usize) -> Self {
        let along = |Range { start, end }: &Range<usize>| match (start, end) {
            (0, 0) => 0..0,
            (0, _) => 0..order * end + 1,
            _ => order * start + 1..order * end + 1,
        };
        Self { nodes: cells.each_ref().map(along), first }
    }

    fn count(&self) -> usize {
        self.nodes.iter().map(ExactSizeIterator::len).product()
    }

    /// Global number of a node, if this rank owns it.
    fn number(&self, node: [usize; 3]) -> Option<usize> {
        let [x, y, z] = &self.nodes;
        let is_own = self.nodes.iter().zip(&node).all(|(range, i)| range.contains(i));
        is_own.then(|| self.first + node[2] - z.start + z.len() * (node[1] - y.start + y.len() * (node[0] - x.start)))
    }
}

impl Lattice {
    fn number(&self, node: [usize; 3]) -> Int {
        let found = self.owners.iter().find_map(|owned| owned.number(node));
        found.expect("a cell's nodes are of ranks whose cells touch it") as Int
    }
}

/// This rank's cells of a grid between planes (m), with elements of an order. Except for the numbers of the nodes, the
/// mesh does not depend on the number of ranks.
///
/// # Errors
/// If there are more nodes than PETSc's integer type can number, on all ranks.
pub(super) fn box_part(comm: &Comm, planes: &[Vec<f64>; 3], order: usize) -> Result<BoxPart> {
    let counts = planes.each_ref().map(|planes| planes.len() - 1);
    let total = counts.iter().try_fold(3_usize, |total, n| total.checked_mul(order * n + 1)).unwrap_or(usize::MAX);
    if Int::try_from(total).is_err() {
        return Err(crate::Error::from(Error::TooLarge { number: total }).of_all_ranks());
    }
    let mine = block(counts, comm.size(), comm.rank());
    let (mut first, mut owners, mut owned_nodes) = (0, Vec::new(), 0);
    for rank in 0..comm.size() {
        let cells = block(counts, comm.size(), rank);
        let owned = Owned::new(&cells, order, first);
        first += owned.count();
        if rank == comm.rank() {
            owned_nodes = owned.count();
            owners.insert(0, owned);
        } else if cells.iter().zip(&mine).all(|(one, other)| one.start <= other.end && other.start <= one.end) {
            owners.push(owned);
        }
    }
    let lattice = Lattice { order, owners };
    let shape = Shape::Hexahedron;
    let (element, facet_element) = (Element::new(shape, order), Element::new(shape.facet(), order));
    let (mut cells, mut facets) = (Elements::new(shape, order), Elements::new(shape.facet(), order));
    let [x, y, z] = mine;
    for i in x {
        for (j, k) in y.clone().flat_map(|j| z.clone().map(move |k| (j, k))) {
            let corner =
                |xi: &Vec3| [(i, xi[0]), (j, xi[1]), (k, xi[2])].map(|(cell, xi)| cell + usize::from(xi > 0.0));
            let corners: Vec<[usize; 3]> = shape.reference_vertices().iter().map(corner).collect();
            let place = |corner: &[usize; 3]| [0, 1, 2].map(|axis| planes[axis][corner[axis]]);
            let node = |of: &mut dyn ExactSizeIterator<Item = usize>| {
                let count = of.len();
                let sum = of.fold([0; 3], |sum, v| [0, 1, 2].map(|axis| sum[axis] + lattice.order * corners[v][axis]));
                lattice.number(sum.map(|sum| sum / count))
            };
            cells.push(
                corners.iter().map(place),
                element.node_vertices().iter().map(|of| node(&mut of.iter().copied())),
            );
            for local in shape.facets() {
                let lies_in = |axis: usize, end: usize| local.iter().all(|&v| corners[v][axis] == end);
                if (0..3).any(|axis| lies_in(axis, 0) || lies_in(axis, counts[axis])) {
                    let nodes = facet_element.node_vertices().iter();
                    let nodes = nodes.map(|of| node(&mut of.iter().map(|&vertex| local[vertex])));
                    facets.push(local.iter().map(|&v| place(&corners[v])), nodes);
                }
            }
        }
    }
    Ok(BoxPart { cells, facets, owned_nodes })
}

#[cfg(test)]
mod tests {
    use super::{Lattice, Owned};
    use crate::mesh::block::block;

    /// Every node has one number, and the numbers of each owner are contiguous.
    #[test]
    fn nodes_are_numbered_once() {
        for (cells, order) in [([5, 4, 2], 1), ([3, 3, 1], 2), ([1, 2, 7], 2)] {
            for ranks in 1..9 {
                let (mut first, mut owners) = (0, Vec::new());
                for rank in 0..ranks {
                    let owned = Owned::new(&block(cells, ranks, rank), order, first);
                    first += owned.count();
                    owners.push(owned);
                }
                let lattice = Lattice { order, owners };
                let [x, y, z] = cells.map(|n| order * n + 1);
                let nodes = (0..x).flat_map(|i| (0..y).flat_map(move |j| (0..z).map(move |k| [i, j, k])));
                let mut numbers: Vec<_> = nodes.map(|node| lattice.number(node) as usize).collect();
                numbers.sort_unstable();
                assert!(numbers.into_iter().eq(0..x * y * z), "{cells:?} of order {order} on {ranks} ranks");
                assert_eq!(first, x * y * z);
            }
        }
    }
}
