//! The share of nodes and cells of a Gmsh file that each rank keeps, by their order in the file.

use std::collections::BTreeSet;
use std::io::{Read, Seek};
use std::ops::Range;

use crate::Int;
use crate::plex::CellType;

use super::walk::GmshReader;

/// The range of `total` consecutive items that belongs to one rank.
fn share(total: usize, ranks: usize, rank: usize) -> Range<usize> {
    let begin = |rank: usize| (total as u128 * rank as u128 / ranks as u128) as usize;
    begin(rank)..begin(rank + 1)
}

/// The part of the file that a rank keeps, and numbers of the whole file.
#[derive(Default)]
pub(super) struct Share {
    /// Coordinates of this rank's share of the nodes.
    pub places: Vec<[f64; 3]>,
    /// Numbers of tetrahedra and of hexahedra in the whole mesh.
    pub counts: [usize; 2],
    /// This rank's cells.
    pub cells: Cells,
    /// Number of regions of the cells, where two regions differ in their physical groups.
    pub volumes: usize,
    /// Number of parts of the mesh that share no node; known to rank 0 alone.
    pub parts: usize,
}

/// Cells of one shape.
#[derive(Default)]
pub(super) struct Cells {
    /// Global numbers of their vertices, cell after cell.
    pub vertices: Vec<Int>,
    /// Region of each cell.
    pub regions: Vec<i32>,
}

impl Share {
    /// Reads the nodes and then the elements.
    pub fn take<R: Read + Seek>(walk: &mut GmshReader<R>, ranks: usize, rank: usize) -> Result<Self, String> {
        let mut taken = Self::default();
        let mut own_nodes = None;
        walk.nodes(|total, index, place| {
            if own_nodes.get_or_insert_with(|| share(total, ranks, rank)).contains(&index) {
                taken.places.push(place);
            }
        })?;
        let (mut regions, mut own_elements) = (BTreeSet::new(), None);
        walk.elements(|element| {
            if element.dimension == 3 {
                taken.counts[usize::from(element.corners.len() == 8)] += 1;
                regions.insert(element.region);
                let own = own_elements.get_or_insert_with(|| share(element.total, ranks, rank));
                if own.contains(&element.number) {
                    taken.cells.vertices.extend(element.corners.iter().map(|&index| index as Int));
                    taken.cells.regions.push(element.region);
                }
            }
            Ok(())
        })?;
        taken.parts = walk.nodes.judge()?;
        let [tetrahedra, hexahedra] = taken.counts;
        if tetrahedra > 0 && hexahedra > 0 {
            return Err(format!("the mesh mixes shapes: {tetrahedra} tetrahedra, {hexahedra} hexahedra"));
        }
        let groups = regions.iter().map(|region| walk.groups(3, region)).filter(|groups| !groups.is_empty());
        taken.volumes = groups.collect::<BTreeSet<_>>().len();
        Ok(taken)
    }

    /// Shape of all cells.
    pub fn shape(&self) -> CellType {
        if self.counts[0] > 0 { CellType::Tetrahedron } else { CellType::Hexahedron }
    }
}
