//! A whole distributed mesh on one rank, in an order that does not depend on the partition.

use std::collections::BTreeMap;

use petsc_wrap::Int;

use crate::element::{Element, Shape, within};
use crate::scene::Vec3;

use super::{Mesh, add_image};

/// Two nodes are the same if their coordinates differ by less than this fraction of the diameter of the mesh.
const SAME: f64 = 1e-9;

/// Distance from a cell, divided by its size, up to which a point still counts as inside; far above rounding.
const INSIDE_TOLERANCE: f64 = 1e-6;

/// Whole mesh with its nodes ordered by their coordinates, x first, and its cells by the coordinates of their centres.
/// Mirror images follow.
pub struct Whole {
    /// Shape of the cells.
    pub shape: Shape,
    /// Order of the elements.
    pub order: usize,
    /// Coordinates of the nodes, m.
    pub nodes: Vec<Vec3>,
    /// Global number of each node, or of the original of a mirror image: the unknowns of node n are 3n, 3n + 1, 3n + 2.
    pub numbers: Vec<Int>,
    /// Factors of the displacements of each node: −1 along the normal of a plane of symmetry for a mirror image.
    pub signs: Vec<Vec3>,
    /// Original node of each mirror image; for other nodes the node's index.
    pub originals: Vec<usize>,
    /// Nodes of all cells, one cell after the other; within a cell in the order of the element, vertices first.
    pub cells: Vec<usize>,
    /// Number of nodes of each cell.
    pub nodes_each: usize,
    /// For each cell, the number of its part of the body.
    pub parts_of_cells: Vec<usize>,
    /// Nodes of each named surface, without mirror images.
    pub surfaces: BTreeMap<String, Vec<usize>>,
}

impl Mesh {
    /// Gathers the whole mesh on rank 0; `None` on other ranks. Collective.
    pub fn gather(&self) -> Option<Whole> {
        let cells = &self.cells;
        let (mut numbers, mut places) = (Vec::new(), Vec::new());
        for i in 0..cells.len() {
            numbers.extend_from_slice(cells.nodes(i));
            places.extend(cells.node_positions(i).flatten());
        }
        let (numbers, places) = (self.comm.gather_to_root(&numbers), self.comm.gather_to_root(&places));
        let of_parts: Vec<u64> = self.parts_of_cells.iter().map(|part| *part as u64).collect();
        let of_parts = self.comm.gather_to_root(&of_parts);
        let on_surface = |facets: &Vec<usize>| {
            let here: Vec<Int> = facets.iter().flat_map(|&i| self.facets.nodes(i)).copied().collect();
            self.comm.gather_to_root(&here)
        };
        let surfaces: Vec<(String, Vec<Int>)> =
            self.surfaces.iter().map(|(name, facets)| (name.clone(), on_surface(facets))).collect();
        if !self.comm.is_root() {
            return None;
        }
        let key = |x: Vec3| x.map(|x| (x / (SAME * self.diameter)).round() as i64);
        let mut by_number = vec![[0.0; 3]; self.nodes];
        for (&number, place) in numbers.iter().zip(places.chunks_exact(3)) {
            by_number[number as usize] = [place[0], place[1], place[2]];
        }
        let mut order: Vec<usize> = (0..self.nodes).collect();
        order.sort_by_key(|&number| key(by_number[number]));
        let mut position = vec![0; self.nodes];
        order.iter().enumerate().for_each(|(at, &number)| position[number] = at);
        let nodes: Vec<Vec3> = order.iter().map(|&number| by_number[number]).collect();
        let nodes_each = cells.nodes_each();
        let mut all: Vec<(Vec<usize>, u64)> = numbers
            .chunks_exact(nodes_each)
            .map(|cell| cell.iter().map(|n| position[*n as usize]).collect())
            .zip(of_parts)
            .collect();
        all.sort_by_cached_key(|(cell, _)| key(super::mean(cell.iter().map(|&node| nodes[node]))));
        let parts_of_cells = all.iter().map(|(_, part)| *part as usize).collect();
        let placed = |numbers: Vec<Int>| {
            let mut nodes: Vec<usize> = numbers.into_iter().map(|number| position[number as usize]).collect();
            nodes.sort_unstable();
            nodes.dedup();
            nodes
        };
        Some(Whole {
            surfaces: surfaces.into_iter().map(|(name, numbers)| (name, placed(numbers))).collect(),
            shape: cells.shape,
            order: cells.order,
            signs: vec![[1.0; 3]; nodes.len()],
            originals: (0..nodes.len()).collect(),
            nodes,
            numbers: order.into_iter().map(|number| number as Int).collect(),
            cells: all.into_iter().flat_map(|(cell, _)| cell).collect(),
            parts_of_cells,
            nodes_each,
        })
    }
}

impl Whole {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.cells.len() / self.nodes_each
    }

    /// Whether there are no cells.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Adds the mirror image at the plane where the coordinate `axis` is zero.
    #[must_use]
    pub fn with_image(mut self, axis: usize) -> Self {
        self.parts_of_cells.extend_from_within(..);
        for node in add_image((self.shape, self.order), &mut self.nodes, &mut self.cells, axis) {
            let mut signs = self.signs[node];
            signs[axis] = -signs[axis];
            self.signs.push(signs);
            self.numbers.push(self.numbers[node]);
            self.originals.push(self.originals[node]);
        }
        self
    }

    /// Displacement along an axis at a node, m, from the values of all unknowns.
    pub fn displacement(&self, unknowns: &[f64], node: usize, axis: usize) -> f64 {
        self.signs[node][axis] * unknowns[3 * self.numbers[node] as usize + axis]
    }

    /// Nodes of cell `i`.
    pub fn cell(&self, i: usize) -> &[usize] {
        &self.cells[i * self.nodes_each..(i + 1) * self.nodes_each]
    }

    /// Coordinates of the vertices of cell `i`, m.
    pub fn x(&self, i: usize) -> Vec<Vec3> {
        let vertices = self.shape.reference_vertices().len();
        self.cell(i)[..vertices].iter().map(|&node| self.nodes[node]).collect()
    }

    /// Finds the cell that contains a point (m), the first one if there are several, and the values of its shape
    /// functions there. `None` outside the body.
    pub fn locate(&self, point: Vec3) -> Option<(usize, Vec<f64>)> {
        let mut best: Option<(usize, Vec3, f64)> = None;
        for i in 0..self.len() {
            let x = self.x(i);
            let ends = |axis: usize| {
                x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x[axis]), b.max(x[axis])))
            };
            let size = (0..3).map(|axis| ends(axis).1 - ends(axis).0).fold(0.0, f64::max);
            let is_far = |axis: usize| {
                let (low, high) = ends(axis);
                point[axis] < low - INSIDE_TOLERANCE * size || point[axis] > high + INSIDE_TOLERANCE * size
            };
            if (0..3).any(is_far) {
                continue;
            }
            if let Some((xi, out)) = within(self.shape, &x, point)
                && out <= INSIDE_TOLERANCE
                && best.is_none_or(|(_, _, least)| out < least - SAME)
            {
                best = Some((i, xi, out));
            }
        }
        let (cell, xi, _) = best?;
        let mut values = vec![0.0; self.nodes_each];
        Element::new(self.shape, self.order).values(xi, &mut values);
        Some((cell, values))
    }
}
