//! Where a point lies on the surface of a distributed mesh.

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
        let tie = 1e-12 * self.diameter;
        // Sorted by distance (up to rounding), by facing, then by place: a total order that knows no partition.
        let mut best: Option<(Candidate, usize, Vec3)> = None;
        for i in 0..self.facets.len() {
            let x = self.facets.x(i);
            let (xi, distance) = closest(shape, x, point);
            let outward = normal(shape, x, xi);
            let candidate = Candidate { distance, facing: dot(outward, direction), place: mean(x.iter().copied()) };
            if best.as_ref().is_none_or(|(other, _, _)| candidate.before(other, tie)) {
                best = Some((candidate, i, xi));
            }
        }
        let mine = best.as_ref().map_or(Candidate::NONE, |(candidate, _, _)| *candidate).pack();
        let size = self.comm.size();
        let mut all = vec![0.0; mine.len() * size];
        self.comm.mpi().all_gather_into(&mine[..], &mut all[..]);
        let candidates: Vec<Candidate> = all.chunks_exact(mine.len()).map(Candidate::unpack).collect();
        let winner = (1..size).fold(0, |w, r| if candidates[r].before(&candidates[w], tie) { r } else { w });
        let mut site = Site {
            distance: candidates[winner].distance,
            x: [0.0; 3],
            normal: [0.0; 3],
            nodes: Vec::new(),
            weights: Vec::new(),
        };
        let mut shared = [0.0; 6];
        if winner == self.comm.rank() {
            let (_, facet, xi) = best.expect("the winner has a facet");
            let x = self.facets.x(facet);
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

/// A facet that may be the closest.
#[derive(Clone, Copy)]
struct Candidate {
    distance: f64,
    /// Outward normal · direction: −1 for a head-on hit.
    facing: f64,
    place: Vec3,
}

impl Candidate {
    /// A rank without boundary facets.
    const NONE: Self = Self { distance: f64::INFINITY, facing: 0.0, place: [0.0; 3] };

    fn before(&self, other: &Self, tie: f64) -> bool {
        if (self.distance - other.distance).abs() > tie {
            return self.distance < other.distance;
        }
        if (self.facing - other.facing).abs() > 1e-9 {
            return self.facing < other.facing;
        }
        self.place < other.place
    }

    fn pack(self) -> [f64; 5] {
        let [x, y, z] = self.place;
        [self.distance, self.facing, x, y, z]
    }

    fn unpack(packed: &[f64]) -> Self {
        Self { distance: packed[0], facing: packed[1], place: [packed[2], packed[3], packed[4]] }
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
