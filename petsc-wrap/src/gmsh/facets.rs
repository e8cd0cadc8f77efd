//! Finds the facets of a Gmsh file among the faces of this rank's cells.

use std::io::{Read, Seek};

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;

use crate::Int;
use crate::error::Result;
use crate::plex::Plex;

use super::walk::GmshReader;

/// A facet whose vertices are all on this rank.
struct Facet {
    /// Mesh points of its vertices, ascending; the fourth is −1 for a triangle.
    vertices: [Int; 4],
    /// Position in the file's list of facets.
    number: usize,
    region: i32,
}

/// The facets of a file whose vertices are all on this rank.
pub(super) struct Facets {
    listed: Vec<Facet>,
    /// Number of facets in the file.
    total: usize,
}

impl Facets {
    /// Reads the elements of the file once more. `vertices` are the numbers of this rank's vertices, ascending; `first`
    /// is the mesh point of the first one.
    pub fn read<R: Read + Seek>(
        walk: &mut GmshReader<R>,
        vertices: &[Int],
        first: Int,
    ) -> std::result::Result<Self, String> {
        let mut facets = Self { listed: Vec::new(), total: 0 };
        walk.elements(|element| {
            if element.dimension != 2 {
                return Ok(());
            }
            let number = facets.total;
            facets.total += 1;
            let mut points = [-1; 4];
            for (point, corner) in points.iter_mut().zip(element.corners) {
                let Ok(i) = vertices.binary_search(&(*corner as Int)) else { return Ok(()) };
                *point = first + i as Int;
            }
            points[..element.corners.len()].sort_unstable();
            facets.listed.push(Facet { vertices: points, number, region: element.region });
            Ok(())
        })?;
        facets.listed.sort_unstable_by_key(|facet| facet.vertices);
        Ok(facets)
    }

    /// Calls `found` for each face of this rank that the file lists, with its region. Returns whether every facet of
    /// the file is a face on some rank. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn find(&self, plex: &Plex, found: impl FnMut(Int, i32)) -> Result<bool> {
        let mut mine = vec![0_u64; self.total.div_ceil(64)];
        let searched = self.search(plex, &mut mine, found);
        let mut all = vec![0_u64; mine.len()];
        plex.comm().mpi().all_reduce_into(&mine[..], &mut all[..], SystemOperation::bitwise_or());
        searched?;
        Ok(all.iter().map(|bits| bits.count_ones() as usize).sum::<usize>() == self.total)
    }

    /// Sets the bits of the facets that are faces on this rank.
    fn search(&self, plex: &Plex, bits: &mut [u64], mut found: impl FnMut(Int, i32)) -> Result<()> {
        for face in plex.points(2)? {
            let (mut vertices, mut count) = ([-1; 4], 0);
            for edge in plex.cone(face)? {
                for vertex in plex.cone(*edge)? {
                    if count < 4 && !vertices[..count].contains(vertex) {
                        vertices[count] = *vertex;
                        count += 1;
                    }
                }
            }
            vertices[..count].sort_unstable();
            let begin = self.listed.partition_point(|facet| facet.vertices < vertices);
            for facet in self.listed[begin..].iter().take_while(|facet| facet.vertices == vertices) {
                bits[facet.number / 64] |= 1 << (facet.number % 64);
                found(face, facet.region);
            }
        }
        Ok(())
    }
}
