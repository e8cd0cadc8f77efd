//! Fields of a whole body at one time, from the coordinates in which it moves.

use std::rc::Rc;

use crate::form::stress::principal;
use crate::scene::Vec3;

use super::stress_map::Recovered;
use super::{Evaluator, Forms, Grid, Kind, Map};
use crate::space::finite_element::Nodes;

/// The fields at all points of a grid, three values a point.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fields {
    /// m.
    pub displacement: Vec<f64>,
    /// m/s.
    pub velocity: Vec<f64>,
    /// The largest first, Pa.
    pub principal_stress: Vec<f64>,
}

/// A grid, and what its points do.
pub struct FieldSampler {
    grid: Grid,
    /// Displacements of the modelled part's points.
    displacement: Map,
    stress: Stress,
}

/// How stresses come about.
enum Stress {
    /// Six forms a point.
    Forms(Map),
    /// Of a mesh, at each node that is no image, from the displacements of the points.
    Recovered(Recovered, Rc<Nodes>),
}

impl FieldSampler {
    /// Of a body in its unknowns, or on a basis: vector by vector the values of all unknowns.
    pub fn new(evaluator: Evaluator, basis: Option<&[Vec<f64>]>) -> Self {
        let part = match evaluator.kind {
            Kind::Nodes(nodes) => Self::of_nodes(nodes, basis),
            Kind::Grid(points) => Self::of_lines(&points.field_lines(), |x| points.at(x), basis),
        };
        Self { grid: evaluator.mirrors.iter().fold(part.grid, |grid, &axis| grid.with_image(axis)), ..part }
    }

    fn of_nodes(nodes: Rc<Nodes>, basis: Option<&[Vec<f64>]>) -> Self {
        let all = (0..nodes.mesh.nodes.len()).flat_map(|node| (0..3).map(move |axis| (node, axis)));
        let displacement = Map::new(all.map(|(node, axis)| nodes.displacement(node, axis)), basis);
        // Images have the same principal values.
        let weights = nodes.recovery.weights(&nodes.mesh, |node| nodes.mesh.originals[node] == node);
        let recovered = Recovered::new(nodes.clone(), weights);
        Self { grid: Grid::of_mesh(&nodes.mesh), displacement, stress: Stress::Recovered(recovered, nodes) }
    }

    fn of_lines(lines: &[Vec<f64>; 3], at: impl Fn(Vec3) -> Forms, basis: Option<&[Vec<f64>]>) -> Self {
        let grid = Grid::of_lines(lines);
        let displacement = Map::new(grid.points.iter().flat_map(|x| at(*x).displacement), basis);
        let stress = Map::new(grid.points.iter().flat_map(|x| at(*x).stress), basis);
        Self { grid, displacement, stress: Stress::Forms(stress) }
    }

    /// The grid.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The fields, of the coordinates of displacement and velocity.
    pub fn fields(&self, [displacement, velocity]: [&[f64]; 2]) -> Fields {
        let moved = self.displacement.apply(displacement);
        let principal: Vec<[f64; 3]> = match &self.stress {
            Stress::Forms(map) => {
                let stresses = map.apply(displacement);
                stresses.chunks_exact(6).map(|s| principal([s[0], s[1], s[2], s[3], s[4], s[5]])).collect()
            }
            Stress::Recovered(recovered, nodes) => {
                let stresses = recovered.stresses(|node, axis| moved[3 * node + axis]);
                nodes.mesh.originals.iter().map(|&node| principal(stresses[node])).collect()
            }
        };
        let images = &self.grid.images;
        let turned = |values: &[f64]| -> Vec<f64> {
            images.iter().flat_map(|(of, signs)| (0..3).map(move |i| signs[i] * values[3 * of + i])).collect()
        };
        Fields {
            displacement: turned(&moved),
            velocity: turned(&self.displacement.apply(velocity)),
            principal_stress: images.iter().flat_map(|(of, _)| principal[*of]).collect(),
        }
    }
}
