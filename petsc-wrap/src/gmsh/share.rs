//! What each rank keeps of a Gmsh file: its share of nodes and cells, by their order in the file.

use std::collections::BTreeSet;
use std::io::{Read, Seek};
use std::ops::Range;

use crate::Int;
use crate::plex::CellType;

use super::walk::Walk;

/// Those of `total` things in a row that one of some ranks has.
fn share(total: usize, ranks: usize, rank: usize) -> Range<usize> {
    let begin = |rank: usize| (total as u128 * rank as u128 / ranks as u128) as usize;
    begin(rank)..begin(rank + 1)
}

/// What a rank keeps, and what it has seen of the whole.
#[derive(Default)]
pub(super) struct Share {
    /// Coordinates of this rank's share of them.
    pub places: Vec<[f64; 3]>,
    /// Tetrahedra and hexahedra of the whole mesh.
    pub counts: [usize; 2],
    /// This rank's cells.
    pub cells: Cells,
    /// How many regions the cells are in that differ in their physical groups.
    pub volumes: usize,
    /// How many parts of the mesh share no node; rank 0 alone knows.
    pub parts: usize,
}

/// Some cells of one shape.
#[derive(Default)]
pub(super) struct Cells {
    /// Their vertices by number over all ranks, one cell after the other.
    pub vertices: Vec<Int>,
    /// The region of each.
    pub regions: Vec<i32>,
}

impl Share {
    /// Walks from the nodes through the elements.
    pub fn take<R: Read + Seek>(walk: &mut Walk<R>, ranks: usize, rank: usize) -> Result<Self, String> {
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
