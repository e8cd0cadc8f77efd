//! Displacements and stresses at points of a mesh of solid elements.

use crate::form::Material;
use crate::mesh::Whole;
use crate::scene::Vec3;

use super::Recovery;
use crate::space::evaluate::{Form, Forms, add, summed};

/// A mesh, with the stress recovery at its nodes.
pub struct Nodes {
    /// The mesh; for a quarter, with its mirror images.
    pub mesh: Whole,
    /// Stress recovery at its nodes.
    pub recovery: Recovery,
    /// Hooke's law of each part of the body: stresses as functions of ∂u_i/∂x_j. For viscoelastic parts, at t → 0.
    laws: Vec<[[f64; 9]; 6]>,
}

impl Nodes {
    /// Evaluator of a mesh, with the elastic constants of each part of the body.
    pub fn new(mesh: Whole, parts: &[Material]) -> Self {
        let stiffness: Vec<f64> = parts.iter().map(|part| part.young).collect();
        let laws = parts.iter().map(Material::stress_of_gradient).collect();
        Self { recovery: Recovery::new(&mesh, &stiffness), mesh, laws }
    }

    /// Displacement of a node along an axis, as a form.
    pub fn displacement(&self, node: usize, axis: usize) -> Form {
        vec![(3 * self.mesh.numbers[node] as usize + axis, self.mesh.signs[node][axis])]
    }

    /// Forms at a point, with the positions and weights of the samples from which its stresses are recovered; `None`
    /// outside the mesh.
    pub fn at(&self, point: Vec3) -> Option<(Forms, Vec<(Vec3, f64)>)> {
        let (cell, values) = self.mesh.locate(point)?;
        let nodes = self.mesh.cell(cell);
        let mut displacement: [Form; 3] = Default::default();
        for (axis, form) in displacement.iter_mut().enumerate() {
            nodes.iter().zip(&values).for_each(|(&node, value)| add(form, *value, &self.displacement(node, axis)));
        }
        let weights = self.recovery.weights(&self.mesh, |node| nodes.contains(&node));
        let mut samples = Form::new();
        nodes.iter().zip(&values).for_each(|(&node, value)| add(&mut samples, *value, &weights[node]));
        let mut stress: [Form; 6] = Default::default();
        let samples = summed(samples);
        let places = samples.iter().map(|(sample, weight)| (self.recovery.place(*sample), *weight)).collect();
        for (sample, weight) in samples {
            let each = self.recovery.samples_each();
            let (cell, sample) = (sample / each, sample % each);
            let gradients = self.recovery.gradients(&self.mesh, cell, sample);
            for (&node, gradient) in self.mesh.cell(cell).iter().zip(&gradients) {
                for (form, row) in stress.iter_mut().zip(&self.laws[self.mesh.parts_of_cells[cell]]) {
                    for i in 0..3 {
                        let factor: f64 = (0..3).map(|j| row[3 * i + j] * gradient[j]).sum();
                        add(form, weight * factor, &self.displacement(node, i));
                    }
                }
            }
        }
        let forms = Forms { displacement: displacement.map(summed), stress: stress.map(summed), local: None };
        Some((forms, places))
    }

    /// Stresses for a displacement gradient in a cell; entry 3i + j is ∂u_i/∂x_j.
    pub fn stress(&self, cell: usize, gradient: &[f64; 9]) -> [f64; 6] {
        self.laws[self.mesh.parts_of_cells[cell]].map(|row| row.iter().zip(gradient).map(|(a, b)| a * b).sum())
    }
}
