//! All of a distributed mesh on one rank, in an order that knows no partition.

use std::collections::BTreeMap;

use petsc_wrap::Int;

use crate::element::{Element, Shape, within};
use crate::scene::Vec3;

use super::{Mesh, add_image};

/// Coordinates that differ by less than this part of the mesh's diameter are of one node.
const SAME: f64 = 1e-9;

/// How far out of a cell, over its size, a point still counts as in it: far above rounding.
const NEAR: f64 = 1e-6;

/// A mesh with its nodes ordered by their coordinates, x first, and its cells by those of their middles; images follow.
pub struct Whole {
    /// Shape of the cells.
    pub shape: Shape,
    /// Order of the elements.
    pub order: usize,
    /// Coordinates of the nodes, m.
    pub nodes: Vec<Vec3>,
    /// Number of each on the ranks, or of the one that it is the image of: the unknowns of node n are 3n, 3n + 1, 3n + 2.
    pub numbers: Vec<Int>,
    /// What these are multiplied by: −1 across a plane of symmetry for an image.
    pub signs: Vec<Vec3>,
    /// The node that it is the image of, or the node itself.
    pub originals: Vec<usize>,
    /// Nodes of the cells, one after the other; within a cell in the element's order, vertices first.
    pub cells: Vec<usize>,
    /// Nodes of each cell.
    pub nodes_each: usize,
    /// The number of the part of the body that each cell is of.
    pub parts_of_cells: Vec<usize>,
    /// Nodes of each named surface, without images.
    pub surfaces: BTreeMap<String, Vec<usize>>,
}

impl Mesh {
    /// All of it on rank 0, nothing on the others. Collective.
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
    /// How many cells.
    pub fn len(&self) -> usize {
        self.cells.len() / self.nodes_each
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// With its mirror image across the plane where a coordinate is zero.
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

    /// The displacement along an axis at a node, m, of those of all unknowns.
    pub fn displacement(&self, unknowns: &[f64], node: usize, axis: usize) -> f64 {
        self.signs[node][axis] * unknowns[3 * self.numbers[node] as usize + axis]
    }

    /// Nodes of a cell.
    pub fn cell(&self, i: usize) -> &[usize] {
        &self.cells[i * self.nodes_each..(i + 1) * self.nodes_each]
    }

    /// Coordinates of a cell's vertices, m.
    pub fn x(&self, i: usize) -> Vec<Vec3> {
        let vertices = self.shape.reference_vertices().len();
        self.cell(i)[..vertices].iter().map(|&node| self.nodes[node]).collect()
    }

    /// The cell that holds a point (m), and the values of its shape functions there; of several cells the first. `None` outside of
    /// the body.
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
                point[axis] < low - NEAR * size || point[axis] > high + NEAR * size
            };
            if (0..3).any(is_far) {
                continue;
            }
            if let Some((xi, out)) = within(self.shape, &x, point)
                && out <= NEAR
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
