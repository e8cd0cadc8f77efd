//! Projection of a point onto the surface of a distributed mesh.

use std::cmp::Ordering;

use mpi::collective::SystemOperation;
use mpi::traits::{Communicator, CommunicatorCollectives, Root};
use petsc_wrap::Int;

use crate::element::{Element, closest, normal};
use crate::scene::Vec3;

use super::{Mesh, mean};

/// Point of the surface closest to a given point, the same on every rank.
#[derive(Debug, Clone)]
pub struct Site {
    /// Distance between the point and its projection, m.
    pub distance: f64,
    /// Point of the surface, m.
    pub x: Vec3,
    /// Outward unit normal of the facet.
    pub normal: Vec3,
    /// Global numbers of the nodes of the facet.
    pub nodes: Vec<Int>,
    /// Values of the shape functions of these nodes at the point.
    pub weights: Vec<f64>,
    /// Longest edge of the facets that contain the point, m.
    pub cell: f64,
}

impl Mesh {
    /// Finds the point of the surface closest to `point`. On an edge between facets, the facet with the normal most
    /// opposed to `direction` is used, so that the result does not depend on the number of ranks. Collective.
    pub fn locate(&self, point: Vec3, direction: Vec3) -> Site {
        let shape = self.facets.shape;
        let projections: Vec<(Vec3, f64)> =
            (0..self.facets.len()).map(|i| closest(shape, self.facets.x(i), point)).collect();
        let mpi = self.comm.mpi();
        let here = projections.iter().fold(f64::INFINITY, |least, (_, distance)| least.min(*distance));
        let mut least = 0.0;
        mpi.all_reduce_into(&here, &mut least, SystemOperation::min());
        // Distances to facets that meet at the point differ by rounding only.
        let near = least + 1e-12 * self.diameter;
        let holding = || (0..projections.len()).filter(|&i| projections[i].1 <= near);
        let longest = holding().map(|i| longest_edge(self.facets.x(i))).fold(0.0, f64::max);
        let mut cell = 0.0;
        mpi.all_reduce_into(&longest, &mut cell, SystemOperation::max());
        let best = holding()
            .map(|i| {
                (Preference::new(self.facets.x(i), normal(shape, self.facets.x(i), projections[i].0), direction), i)
            })
            .min_by(|(one, _), (other, _)| one.compare(other));
        let mine = best.as_ref().map_or(Preference::NONE, |(preference, _)| *preference);
        let size = self.comm.size();
        let mut all = vec![0.0; mine.0.len() * size];
        mpi.all_gather_into(&mine.0[..], &mut all[..]);
        let preferences: Vec<Preference> =
            all.chunks_exact(mine.0.len()).map(|r| Preference([r[0], r[1], r[2], r[3]])).collect();
        let winner = (1..size).fold(0, |w, r| if preferences[r].compare(&preferences[w]).is_lt() { r } else { w });
        let mut shared = [0.0; 6];
        let mut nodes = vec![0; self.facets.nodes_each()];
        let mut weights = vec![0.0; nodes.len()];
        if winner == self.comm.rank() {
            let (_, facet) = best.expect("the winner has a facet");
            let (x, xi) = (self.facets.x(facet), projections[facet].0);
            shared[..3].copy_from_slice(&interpolate(&Element::new(shape, 1), x, xi));
            shared[3..].copy_from_slice(&normal(shape, x, xi));
            nodes.copy_from_slice(self.facets.nodes(facet));
            Element::new(shape, self.facets.order).values(xi, &mut weights);
        }
        let process = mpi.process_at_rank(winner as i32);
        process.broadcast_into(&mut shared[..]);
        process.broadcast_into(&mut nodes[..]);
        process.broadcast_into(&mut weights[..]);
        let [x, y, z, nx, ny, nz] = shared;
        Site { distance: least, x: [x, y, z], normal: [nx, ny, nz], nodes, weights, cell }
    }
}

/// Order of preference among facets that contain the point: the scalar product of normal and direction (to six digits,
/// which removes rounding), then the position of the centre. This total order does not depend on the partition.
#[derive(Clone, Copy)]
struct Preference([f64; 4]);

impl Preference {
    /// Preference of a rank without a facet that contains the point.
    const NONE: Self = Self([f64::INFINITY; 4]);

    fn new(x: &[Vec3], outward: Vec3, direction: Vec3) -> Self {
        let [a, b, c] = mean(x.iter().copied());
        Self([(1e6 * dot(outward, direction)).round(), a, b, c])
    }

    fn compare(&self, other: &Self) -> Ordering {
        let pairs = self.0.iter().zip(&other.0);
        pairs.map(|(one, other)| one.total_cmp(other)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    }
}

fn interpolate(element: &Element, x: &[Vec3], xi: Vec3) -> Vec3 {
    let mut values = vec![0.0; element.nodes()];
    element.values(xi, &mut values);
    let mut point = [0.0; 3];
    for (x, value) in x.iter().zip(&values) {
        for axis in 0..3 {
            point[axis] += value * x[axis];
        }
    }
    point
}

fn longest_edge(x: &[Vec3]) -> f64 {
    let ends = x.iter().zip(x.iter().cycle().skip(1));
    ends.map(|(a, b)| [0, 1, 2].map(|i| (a[i] - b[i]).powi(2)).iter().sum::<f64>().sqrt()).fold(0.0, f64::max)
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
