//! Where a point lies on the surface of a distributed mesh.

use std::cmp::Ordering;

use mpi::collective::SystemOperation;
use mpi::traits::{Communicator, CommunicatorCollectives, Root};
use petsc_wrap::Int;

use crate::element::{Element, closest, normal};
use crate::scene::Vec3;

use super::{Mesh, mean};

/// The point of the surface closest to a given point. The same on every rank, but for `nodes` and `weights`, which only
/// one rank has.
#[derive(Debug, Clone)]
pub struct Site {
    /// Distance between the two, m.
    pub distance: f64,
    /// The point of the surface, m.
    pub x: Vec3,
    /// Outward unit normal of the facet.
    pub normal: Vec3,
    /// Global numbers of the facet's nodes; empty on all ranks but one.
    pub nodes: Vec<Int>,
    /// Values of their shape functions at the point.
    pub weights: Vec<f64>,
}

impl Mesh {
    /// Finds the point of the surface closest to `point`. On an edge between facets, the facet that faces `direction`
    /// most squarely is taken, so that the answer does not depend on the number of ranks. Collective.
    pub fn locate(&self, point: Vec3, direction: Vec3) -> Site {
        let shape = self.facets.shape;
        let projections: Vec<(Vec3, f64)> =
            (0..self.facets.len()).map(|i| closest(shape, self.facets.x(i), point)).collect();
        let here = projections.iter().fold(f64::INFINITY, |least, (_, distance)| least.min(*distance));
        let mut least = 0.0;
        self.comm.mpi().all_reduce_into(&here, &mut least, SystemOperation::min());
        // Facets that meet at the point differ by rounding alone.
        let near = least + 1e-12 * self.diameter;
        let best = (0..projections.len())
            .filter(|&i| projections[i].1 <= near)
            .map(|i| {
                (Preference::new(self.facets.x(i), normal(shape, self.facets.x(i), projections[i].0), direction), i)
            })
            .min_by(|(one, _), (other, _)| one.compare(other));
        let mine = best.as_ref().map_or(Preference::NONE, |(preference, _)| *preference);
        let size = self.comm.size();
        let mut all = vec![0.0; mine.0.len() * size];
        self.comm.mpi().all_gather_into(&mine.0[..], &mut all[..]);
        let preferences: Vec<Preference> =
            all.chunks_exact(mine.0.len()).map(|r| Preference([r[0], r[1], r[2], r[3]])).collect();
        let winner = (1..size).fold(0, |w, r| if preferences[r].compare(&preferences[w]).is_lt() { r } else { w });
        let mut site = Site { distance: least, x: [0.0; 3], normal: [0.0; 3], nodes: Vec::new(), weights: Vec::new() };
        let mut shared = [0.0; 6];
        if winner == self.comm.rank() {
            let (_, facet) = best.expect("the winner has a facet");
            let (x, xi) = (self.facets.x(facet), projections[facet].0);
            shared[..3].copy_from_slice(&interpolate(&Element::new(shape, 1), x, xi));
            shared[3..].copy_from_slice(&normal(shape, x, xi));
            site.nodes = self.facets.nodes(facet).to_vec();
            site.weights = vec![0.0; site.nodes.len()];
            Element::new(shape, self.facets.order).values(xi, &mut site.weights);
        }
        self.comm.mpi().process_at_rank(winner as i32).broadcast_into(&mut shared[..]);
        site.x.copy_from_slice(&shared[..3]);
        site.normal.copy_from_slice(&shared[3..]);
        site
    }
}

/// Which of several facets that hold the point is taken: how squarely it faces the direction (to six digits, past rounding),
/// then the place of its centre. A total order that knows no partition.
#[derive(Clone, Copy)]
struct Preference([f64; 4]);

impl Preference {
    /// A part of the mesh without a facet that holds the point.
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

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
