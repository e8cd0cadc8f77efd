//! Stresses at many points as functions of the coordinates of a body (unknowns or reduced coordinates).

use std::rc::Rc;

use crate::scene::Vec3;
use crate::space::finite_element::Nodes;

use super::{Form, LineStresses, Map};

/// Stresses at points, several components each, linear in the coordinates of a body.
#[derive(Clone)]
pub enum StressMap {
    /// A linear form for each component.
    Forms {
        /// Forms, point by point.
        map: Map,
        /// Number of components of a point.
        components: usize,
    },
    /// Three in-plane components at the crossings of lines on a face.
    Lines(LineStresses),
    /// Six components at nodes of a mesh whose unknowns are the coordinates.
    Recovered(Rc<Recovered>),
}

/// Stress recovery at some nodes of a mesh, from samples in the surrounding cells.
pub struct Recovered {
    nodes: Rc<Nodes>,
    /// Weights of the samples at each node. Samples are numbered by their position in `cells`.
    weights: Vec<Form>,
    /// Cells whose samples are used, ascending.
    cells: Vec<usize>,
    /// Gradients of the shape functions, by cell, then sample, then node, 1/m.
    gradients: Vec<Vec3>,
}

impl Recovered {
    /// Recovery at some nodes, in the given order.
    pub fn at(nodes: &Rc<Nodes>, wanted: &[usize]) -> Self {
        let mut is_wanted = vec![false; nodes.mesh.nodes.len()];
        wanted.iter().for_each(|&node| is_wanted[node] = true);
        let mut weights = nodes.recovery.weights(&nodes.mesh, |node| is_wanted[node]);
        Self::new(nodes.clone(), wanted.iter().map(|&node| std::mem::take(&mut weights[node])).collect())
    }

    /// Recovery with given weights of the samples of all cells for each node
    /// ([`crate::space::finite_element::Recovery::weights`]).
    pub fn new(nodes: Rc<Nodes>, mut weights: Vec<Form>) -> Self {
        let each = nodes.recovery.samples_each();
        let mut cells: Vec<usize> = weights.iter().flatten().map(|(sample, _)| sample / each).collect();
        cells.sort_unstable();
        cells.dedup();
        for (sample, _) in weights.iter_mut().flatten() {
            let place = cells.partition_point(|cell| *cell < *sample / each);
            *sample = place * each + *sample % each;
        }
        let samples = cells.iter().flat_map(|&cell| (0..each).map(move |sample| (cell, sample)));
        let gradients =
            samples.flat_map(|(cell, sample)| nodes.recovery.gradients(&nodes.mesh, cell, sample)).collect();
        Self { nodes, weights, cells, gradients }
    }

    /// Positions (m) and weights of the samples from which the stresses at a node are recovered.
    pub fn samples(&self, number: usize) -> impl Iterator<Item = (Vec3, f64)> {
        let (recovery, each) = (&self.nodes.recovery, self.nodes.recovery.samples_each());
        let place = move |sample: usize| recovery.place(self.cells[sample / each] * each + sample % each);
        self.weights[number].iter().map(move |(sample, weight)| (place(*sample), *weight))
    }

    /// Recovered stresses, Pa. `displacement` returns the displacement (m) of a node along an axis.
    pub fn stresses(&self, displacement: impl Fn(usize, usize) -> f64) -> Vec<[f64; 6]> {
        let (mesh, each) = (&self.nodes.mesh, self.nodes.recovery.samples_each());
        let mut sampled = Vec::with_capacity(each * self.cells.len());
        let mut gradients = self.gradients.chunks_exact(mesh.nodes_each);
        for &cell in &self.cells {
            let moved: Vec<Vec3> =
                mesh.cell(cell).iter().map(|&node| [0, 1, 2].map(|i| displacement(node, i))).collect();
            for gradients in gradients.by_ref().take(each) {
                let mut slope = [0.0; 9];
                for (u, gradient) in moved.iter().zip(gradients) {
                    (0..9).for_each(|entry| slope[entry] += u[entry / 3] * gradient[entry % 3]);
                }
                sampled.push(self.nodes.stress(cell, &slope));
            }
        }
        let at_node = |weights: &Form| {
            let mut sum = [0.0; 6];
            for (sample, weight) in weights {
                (0..6).for_each(|i| sum[i] += weight * sampled[*sample][i]);
            }
            sum
        };
        self.weights.iter().map(at_node).collect()
    }
}

impl StressMap {
    /// Recovered stresses projected onto a basis. Each basis vector holds the values of all unknowns.
    pub fn on_basis(recovered: &Recovered, basis: &[Vec<f64>]) -> Self {
        let mesh = &recovered.nodes.mesh;
        let columns: Vec<Vec<[f64; 6]>> =
            basis.iter().map(|vector| recovered.stresses(|node, axis| mesh.displacement(vector, node, axis))).collect();
        let entries = (0..6 * recovered.weights.len()).flat_map(|row| columns.iter().map(move |c| c[row / 6][row % 6]));
        Self::Forms { map: Map::Dense(basis.len(), entries.collect()), components: 6 }
    }

    /// Number of components of a point.
    pub fn components(&self) -> usize {
        match self {
            Self::Forms { components, .. } => *components,
            Self::Lines(_) => 3,
            Self::Recovered(_) => 6,
        }
    }

    /// Stresses at all points, point by point.
    pub fn apply(&self, coordinates: &[f64]) -> Vec<f64> {
        match self {
            Self::Forms { map, .. } => map.apply(coordinates),
            Self::Lines(lines) => lines.apply(coordinates),
            Self::Recovered(recovered) => {
                let mesh = &recovered.nodes.mesh;
                recovered.stresses(|node, axis| mesh.displacement(coordinates, node, axis)).into_flattened()
            }
        }
    }
}
