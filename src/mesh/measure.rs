//! Dimensions of a body, and its thickness under a point of its surface.

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use nalgebra::{DMatrix, DVector, Vector3};

use super::{Mesh, Site, mean};
use crate::element::{Element, Quadrature, Table};
use crate::scene::{Impactor, Vec3};

/// Dimensions that a user can compare with the drawing of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Measures {
    /// Smallest and largest coordinates of the vertices, m.
    pub bounds: [Vec3; 2],
    /// Volume, m³.
    pub volume: f64,
    /// Area of the whole boundary, m².
    pub area: f64,
    /// Named surfaces, sorted by name.
    pub surfaces: Vec<Surface>,
    /// Named surfaces that are not on the boundary alone or have no faces, with the reason why they cannot be used.
    pub unusable: Vec<(String, String)>,
    /// Number of parts that share no node.
    pub parts: usize,
    /// Number of pairs of faces that coincide but do not share their nodes, so that the body is not connected there.
    pub open_faces: usize,
    /// Mean curvature of the surface at the impact point, 1/m: positive where the body is convex.
    pub curvature: f64,
    /// Cosine of the angle between the impactor's direction and the inward normal at the impact point.
    pub steepness: f64,
}

/// Radius around the impact point in which the surface is looked at for its curvature, in lengths of cells there.
const CELLS_AROUND: f64 = 2.0;

/// Smallest cosine of the angle between normals of one smooth surface within this radius.
const SMOOTH: f64 = 0.7;

/// Largest difference in the coordinates of coinciding faces, as a fraction of the diameter of the mesh.
const SAME: f64 = 1e-9;

/// A named surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Name in the mesh file or of the box.
    pub name: String,
    /// Area, m².
    pub area: f64,
}

impl Mesh {
    /// Measures the mesh, and its surface where an impactor hits it. Collective.
    pub fn measures(&self, impactor: &Impactor) -> Measures {
        let mpi = self.comm.mpi();
        let (mut least, mut largest) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for x in &self.cells.x {
            for i in 0..3 {
                (least[i], largest[i]) = (least[i].min(x[i]), largest[i].max(x[i]));
            }
        }
        let mut bounds = [[0.0; 3]; 2];
        mpi.all_reduce_into(&least, &mut bounds[0], SystemOperation::min());
        mpi.all_reduce_into(&largest, &mut bounds[1], SystemOperation::max());
        let all: Vec<usize> = (0..self.facets.len()).collect();
        let site = self.locate(impactor.point, impactor.direction);
        let surfaces =
            self.surfaces.iter().map(|(name, facets)| Surface { name: name.clone(), area: self.area(facets) });
        Measures {
            bounds,
            volume: self.volume(),
            surfaces: surfaces.collect(),
            unusable: self.unusable_surfaces.clone().into_iter().collect(),
            area: self.area(&all),
            parts: self.parts,
            open_faces: self.open_faces(),
            curvature: self.curvature(&site),
            steepness: -Vector3::from(site.normal).dot(&Vector3::from(impactor.direction)),
        }
    }

    /// Mean curvature of the surface at a point of it, 1/m, from the quadratic surface closest to the vertices around; 0 if
    /// there are too few. Collective.
    fn curvature(&self, site: &Site) -> f64 {
        let (origin, up, reach) = (Vector3::from(site.x), Vector3::from(site.normal), CELLS_AROUND * site.cell);
        let across = up.cross(&Vector3::ith(up.iamin(), 1.0)).normalize();
        let along = up.cross(&across);
        let mut here = Vec::new();
        for x in (0..self.facets.len()).map(|i| self.facets.x(i)) {
            let [a, b, c] = [x[0], x[1], x[2]].map(|x| Vector3::from(x) - origin);
            let normal = (b - a).cross(&(c - a));
            if normal.dot(&up) < SMOOTH * normal.norm() {
                continue;
            }
            for offset in x.iter().map(|x| (Vector3::from(*x) - origin) / reach).filter(|offset| offset.norm() < 1.0) {
                here.extend([offset.dot(&across), offset.dot(&along), offset.dot(&up)]);
            }
        }
        let all = self.comm.all_gather(&here);
        let rows = all.len() / 3;
        let terms = DMatrix::from_fn(rows, 6, |row, term| {
            let (u, v) = (all[3 * row], all[3 * row + 1]);
            [u * u, v * v, u * v, u, v, 1.0][term]
        });
        let heights = DVector::from_fn(rows, |row, _| all[3 * row + 2]);
        // Too few vertices leave some terms open; singular values this small are rounding.
        let fitted = terms.svd(true, true).solve(&heights, 1e-9);
        fitted.map_or(0.0, |of| -(of[0] + of[1]) / reach)
    }

    /// Number of pairs of boundary faces with the same centre. Collective.
    fn open_faces(&self) -> usize {
        let middles: Vec<f64> = (0..self.facets.len()).flat_map(|i| mean(self.facets.x(i).iter().copied())).collect();
        let all = self.comm.all_gather(&middles);
        let key = |x: &[f64]| [x[0], x[1], x[2]].map(|x| (x / (SAME * self.diameter)).round() as i64);
        let mut keys: Vec<[i64; 3]> = all.chunks_exact(3).map(key).collect();
        keys.sort_unstable();
        keys.windows(2).filter(|pair| pair[0] == pair[1]).count()
    }

    /// Area of the given facets of this rank plus the areas given by the other ranks, m². Collective.
    fn area(&self, facets: &[usize]) -> f64 {
        let shape = self.facets.shape;
        let table = Table::new(&Element::new(shape, 1), &Quadrature::exact(shape, 2));
        let of_facet = |x: &[Vec3]| -> f64 {
            let element = |q| {
                let tangents = table.jacobian(q, x);
                table.weight(q) * tangents.column(0).cross(&tangents.column(1)).norm()
            };
            (0..table.points()).map(element).sum()
        };
        let (here, mut all) = (facets.iter().map(|&i| of_facet(self.facets.x(i))).sum::<f64>(), 0.0);
        self.comm.mpi().all_reduce_into(&here, &mut all, SystemOperation::sum());
        all
    }

    /// Volume of all cells, m³. Collective.
    pub fn volume(&self) -> f64 {
        let shape = self.cells.shape;
        // The determinant of a trilinear map is a polynomial of degree 2 in each coordinate.
        let table = Table::new(&Element::new(shape, 1), &Quadrature::exact(shape, 2));
        let of_cell = |x: &[Vec3]| -> f64 {
            (0..table.points()).map(|q| table.weight(q) * table.jacobian(q, x).determinant()).sum()
        };
        let here: f64 = (0..self.cells.len()).map(|i| of_cell(self.cells.x(i))).sum();
        let mut all = 0.0;
        self.comm.mpi().all_reduce_into(&here, &mut all, SystemOperation::sum());
        all
    }

    /// Positions of the nodes that this rank owns, m, in the order of their numbers. Collective.
    pub fn positions(&self) -> Vec<Vec3> {
        let mut end = 0;
        self.comm.mpi().scan_into(&self.owned_nodes, &mut end, SystemOperation::sum());
        let first = end - self.owned_nodes;
        let mut positions = vec![[f64::NAN; 3]; self.owned_nodes];
        let cells = &self.cells;
        for (&node, x) in (0..cells.len()).flat_map(|i| cells.nodes(i).iter().zip(cells.node_positions(i))) {
            // A node of another rank is set on that rank.
            let at = (node as usize).checked_sub(first);
            if let Some(place) = at.and_then(|at| positions.get_mut(at)) {
                *place = x;
            }
        }
        positions
    }

    /// Distance from a point of the surface along the inward normal to the point where this line leaves the body, m.
    /// Collective.
    ///
    /// A warped quadrilateral is divided into two triangles, so that no line passes between them.
    pub fn thickness(&self, site: &Site) -> f64 {
        let (origin, inward) = (Vector3::from(site.x), -Vector3::from(site.normal));
        let rounding = 1e-9 * self.diameter;
        let mut here = f64::INFINITY;
        for x in (0..self.facets.len()).map(|i| self.facets.x(i)) {
            for i in 2..x.len() {
                let corners = [x[0], x[i - 1], x[i]].map(|x| Vector3::from(x) - origin);
                if let Some(distance) = exit(corners, inward, rounding) {
                    here = here.min(distance.max(0.0));
                }
            }
        }
        let mut least = 0.0_f64;
        self.comm.mpi().all_reduce_into(&here, &mut least, SystemOperation::min());
        // No line in the body is longer.
        least.min(self.diameter)
    }
}

/// Distance at which the line from the origin leaves through a triangle, right-handed about its outward normal. A miss
/// within rounding counts as an intersection, since the line may follow an edge.
fn exit([a, b, c]: [Vector3<f64>; 3], along: Vector3<f64>, rounding: f64) -> Option<f64> {
    let area = (b - a).cross(&(c - a));
    let facing = area.dot(&along);
    if facing <= 1e-9 * area.norm() {
        return None;
    }
    let distance = a.dot(&area) / facing;
    let foot = along * distance;
    let outside = |from: Vector3<f64>, to: Vector3<f64>| {
        // Distance of the intersection from the line of the edge, positive outside the triangle.
        let edge = to - from;
        (foot - from).cross(&edge).dot(&area) > rounding * edge.norm() * area.norm()
    };
    let missed = outside(a, b) || outside(b, c) || outside(c, a);
    (!missed && distance >= -rounding).then_some(distance)
}
