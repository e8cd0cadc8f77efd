//! A box cut into hexahedra by planes across its axes: the whole, or the part between its planes of symmetry.

use std::collections::BTreeMap;

use petsc_wrap::{Comm, Int, Plex};

use crate::element::Shape;
use crate::error::Result;
use crate::scene::{Symmetry, Vec3};

use super::Elements;
use super::lattice::{BoxPart, box_part};
use super::part::{BOUNDARY, Part};

/// The grid of a box, or of a part of one.
pub struct Grid {
    /// Coordinates across each axis, m, ascending.
    planes: [Vec<f64>; 3],
    /// Whether the lowest of them is a plane of symmetry.
    mirrors: [bool; 3],
}

impl Grid {
    /// The part of a box's grid that is solved.
    pub fn new(planes: &[Vec<f64>; 3], symmetry: &Symmetry) -> Self {
        let mut grid = Self { planes: planes.clone(), mirrors: [false; 3] };
        if let Symmetry::Quarter { axes } = symmetry {
            for &axis in axes {
                let half = grid.planes[axis].len() / 2;
                grid.planes[axis].drain(..half);
                grid.mirrors[axis] = true;
            }
        }
        grid
    }

    /// How many such parts make the whole.
    pub fn copies(&self) -> usize {
        1 << self.mirrors.iter().filter(|mirror| **mirror).count()
    }

    /// This rank's cells, and its facets on the boundary, planes of symmetry included. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn part(&self, comm: &Comm, order: usize) -> Result<BoxPart> {
        if comm.size() > 1 {
            return box_part(comm, &self.planes, order);
        }
        // On one rank nodes are numbered as PETSc numbers its own box, by which the paper's results were computed.
        let plex = self.cubes(comm)?;
        plex.label_boundary(BOUNDARY)?;
        let part = Part::new(&plex, Shape::Hexahedron, order, |vertex| self.place(vertex))?;
        let (cells, facets, _) = part.elements(&[])?;
        Ok(BoxPart { cells, facets, owned_nodes: part.numbering.owned })
    }

    /// Its cells as unit cubes: [`Grid::place`] moves the vertices to the planes. Collective.
    ///
    /// # Errors
    /// PETSc's.
    fn cubes(&self, comm: &Comm) -> Result<Plex> {
        let cells = self.planes.each_ref().map(|planes| planes.len() - 1);
        Ok(Plex::hexahedral_box(comm, cells, [0.0; 3], cells.map(|n| n as f64))?)
    }

    /// Where a vertex of the unit cubes belongs, m.
    fn place(&self, vertex: Vec3) -> Vec3 {
        [0, 1, 2].map(|axis| self.planes[axis][vertex[axis].round() as usize])
    }

    /// Takes the facets on planes of symmetry out: those that are left, and the nodes of the others by the plane's axis.
    pub fn cut(&self, facets: &Elements) -> (Elements, [Vec<Int>; 3]) {
        let mut outer = Elements::new(facets.shape, facets.order);
        let mut mirrored: [Vec<Int>; 3] = Default::default();
        for i in 0..facets.len() {
            match (0..3).find(|&axis| self.mirrors[axis] && self.lies_in(facets.x(i), axis, false)) {
                Some(axis) => mirrored[axis].extend(facets.nodes(i)),
                None => outer.push(facets.x(i).iter().copied(), facets.nodes(i).iter().copied()),
            }
        }
        for nodes in &mut mirrored {
            nodes.sort_unstable();
            nodes.dedup();
        }
        (outer, mirrored)
    }

    /// The surfaces of the box by name. The faces beyond a plane of symmetry have no facets here.
    pub fn surfaces(&self, facets: &Elements) -> BTreeMap<String, Vec<usize>> {
        let names = [["x-min", "x-max"], ["y-min", "y-max"], ["z-min", "z-max"]];
        let all = names.iter().flatten().chain(&["side", "top", "bottom"]);
        let mut surfaces: BTreeMap<String, Vec<usize>> = all.map(|name| ((*name).to_owned(), Vec::new())).collect();
        for i in 0..facets.len() {
            for (axis, names) in names.iter().enumerate() {
                for upper in [false, true] {
                    if !self.lies_in(facets.x(i), axis, upper) {
                        continue;
                    }
                    let group = if axis < 2 { "side" } else { ["bottom", "top"][usize::from(upper)] };
                    for name in [names[usize::from(upper)], group] {
                        surfaces.entry(name.to_owned()).or_default().push(i);
                    }
                }
            }
        }
        surfaces
    }

    /// Whether a facet lies in the lower or the upper face across an axis. Its coordinates are those of the planes exactly.
    fn lies_in(&self, x: &[Vec3], axis: usize, upper: bool) -> bool {
        let planes = &self.planes[axis];
        let face = if upper { planes.last() } else { planes.first() };
        x.iter().all(|x| Some(&x[axis]) == face)
    }
}
