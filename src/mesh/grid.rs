//! Grid of hexahedra in a box, cut by planes normal to its axes: the whole box, or its part between planes of symmetry.

use std::collections::BTreeMap;

use petsc_wrap::{Comm, Int, Plex};

use crate::element::Shape;
use crate::error::Result;
use crate::scene::{Symmetry, Vec3};

use super::Elements;
use super::lattice::{BoxPart, box_part};
use super::part::{BOUNDARY, RankPart};

/// Grid of a box, or of a part of it.
pub struct Grid {
    /// Coordinates of the planes normal to each axis, m, ascending.
    planes: [Vec<f64>; 3],
    /// Whether the lowest plane of each axis is a plane of symmetry.
    mirrors: [bool; 3],
}

impl Grid {
    /// Creates the grid of the computed part of a box.
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

    /// Number of such parts that make up the whole box.
    pub fn multiplicity(&self) -> usize {
        1 << self.mirrors.iter().filter(|mirror| **mirror).count()
    }

    /// This rank's cells and its boundary facets, including planes of symmetry. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn part(&self, comm: &Comm, order: usize) -> Result<BoxPart> {
        if comm.size() > 1 {
            return box_part(comm, &self.planes, order);
        }
        // On one rank, nodes have the numbers of PETSc's box, which were used for the results of the paper.
        let plex = self.cubes(comm)?;
        plex.label_boundary(BOUNDARY)?;
        let part = RankPart::new(&plex, Shape::Hexahedron, order, |vertex| self.place(vertex))?;
        let (cells, facets, _) = part.elements(&[])?;
        Ok(BoxPart { cells, facets, owned_nodes: part.numbering.owned })
    }

    /// Mesh of the cells as unit cubes, whose vertices [`Grid::place`] moves to the planes. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    fn cubes(&self, comm: &Comm) -> Result<Plex> {
        let cells = self.planes.each_ref().map(|planes| planes.len() - 1);
        Ok(Plex::hexahedral_box(comm, cells, [0.0; 3], cells.map(|n| n as f64))?)
    }

    /// Position of a vertex of the unit cubes in the box, m.
    fn place(&self, vertex: Vec3) -> Vec3 {
        [0, 1, 2].map(|axis| self.planes[axis][vertex[axis].round() as usize])
    }

    /// Removes the facets on planes of symmetry. Returns the other facets, and for each axis the nodes of the removed
    /// facets.
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

    /// Surfaces of the box by name. The faces on the other side of a plane of symmetry have no facets.
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

    /// Whether a facet lies in the lower or upper face normal to an axis. Its coordinates are exactly equal to the
    /// coordinates of the planes.
    fn lies_in(&self, x: &[Vec3], axis: usize, upper: bool) -> bool {
        let planes = &self.planes[axis];
        let face = if upper { planes.last() } else { planes.first() };
        x.iter().all(|x| Some(&x[axis]) == face)
    }
}
