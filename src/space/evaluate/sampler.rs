//! Fields of a whole body at one time, from its coordinates (unknowns or reduced coordinates).

use std::rc::Rc;

use crate::form::stress::principal;

use super::stress_map::Recovered;
use super::{ContactNow, ContactSize, Evaluator, Grid, Kind, LocalPoint, Map, NearHit};
use crate::space::finite_element::Nodes;

/// Fields at all points of a grid, three values for each point.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Fields {
    /// Displacement, m.
    pub displacement: Vec<f64>,
    /// Velocity, m/s.
    pub velocity: Vec<f64>,
    /// Principal stresses, the largest first, Pa.
    pub principal_stress: Vec<f64>,
}

/// A grid, with the maps from the coordinates of a body to the fields at its points.
pub struct FieldSampler {
    /// Size of the contact area.
    pub contact: ContactSize,
    grid: Grid,
    /// Displacements of the points of the modelled part.
    displacement: Map,
    stress: Stress,
    /// Local field at points near the impact point, by point number.
    local: Vec<(usize, LocalPoint)>,
}

/// How stresses are computed.
enum Stress {
    /// Six forms for each point.
    Forms(Map),
    /// Recovery at the original nodes of a mesh (not mirror images) from the displacements of the points.
    Recovered(Recovered, Rc<Nodes>),
}

impl FieldSampler {
    /// Sampler of a body in its unknowns or, with `basis`, in its reduced coordinates. Each basis vector holds the
    /// values of all unknowns.
    pub fn new(evaluator: &Evaluator, contact: ContactSize, basis: Option<&[Vec<f64>]>) -> Self {
        let part = match &evaluator.kind {
            Kind::Nodes(nodes) => Self::of_nodes(nodes, evaluator.near.as_deref(), contact, basis),
            Kind::Grid(points) => Self::of_lines(evaluator, &points.field_lines(), contact, basis),
        };
        Self { grid: evaluator.mirrors.iter().fold(part.grid, |grid, &axis| grid.with_image(axis)), ..part }
    }

    fn of_nodes(nodes: &Rc<Nodes>, near: Option<&NearHit>, contact: ContactSize, basis: Option<&[Vec<f64>]>) -> Self {
        let all = (0..nodes.mesh.nodes.len()).flat_map(|node| (0..3).map(move |axis| (node, axis)));
        let displacement = Map::new(all.map(|(node, axis)| nodes.displacement(node, axis)), basis);
        // Mirror images have the same principal stresses.
        let is_original = |node: usize| nodes.mesh.originals[node] == node;
        let recovered = Recovered::new(nodes.clone(), nodes.recovery.weights(&nodes.mesh, is_original));
        let mut local = Vec::new();
        if let Some(near) = near {
            let originals = nodes.mesh.nodes.iter().enumerate().filter(|(node, _)| is_original(*node));
            local.extend(originals.filter_map(|(node, x)| Some((node, near.recovered(*x, recovered.samples(node))?))));
        }
        let stress = Stress::Recovered(recovered, nodes.clone());
        Self { contact, grid: Grid::of_mesh(&nodes.mesh), displacement, stress, local }
    }

    fn of_lines(
        evaluator: &Evaluator,
        lines: &[Vec<f64>; 3],
        contact: ContactSize,
        basis: Option<&[Vec<f64>]>,
    ) -> Self {
        let grid = Grid::of_lines(lines);
        let (mut displacements, mut stresses, mut local) = (Vec::new(), Vec::new(), Vec::new());
        for (number, forms) in grid.points.iter().map(|x| evaluator.at(*x).unwrap_or_default()).enumerate() {
            displacements.extend(forms.displacement);
            stresses.extend(forms.stress);
            local.extend(forms.local.map(|local| (number, local)));
        }
        let [displacement, stress] = [displacements, stresses].map(|forms| Map::new(forms.into_iter(), basis));
        Self { contact, grid, displacement, stress: Stress::Forms(stress), local }
    }

    /// Grid of the points.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Fields for the coordinates of displacement and velocity and the state of the contact.
    pub fn fields(&self, [displacement, velocity]: [&[f64]; 2], contact: &ContactNow) -> Fields {
        let moved = self.displacement.apply(displacement);
        let mut stresses: Vec<[f64; 6]> = match &self.stress {
            Stress::Forms(map) => map.apply(displacement).as_chunks().0.to_vec(),
            Stress::Recovered(recovered, _) => recovered.stresses(|node, axis| moved[3 * node + axis]),
        };
        if contact.force > 0.0 {
            for (point, local) in &self.local {
                stresses[*point].iter_mut().zip(local.stress(contact)).for_each(|(to, more)| *to += more);
            }
        }
        let principal: Vec<[f64; 3]> = match &self.stress {
            Stress::Forms(_) => stresses.into_iter().map(principal).collect(),
            Stress::Recovered(_, nodes) => nodes.mesh.originals.iter().map(|&node| principal(stresses[node])).collect(),
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
