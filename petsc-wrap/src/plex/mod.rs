//! Unstructured meshes: creation, topology, labels, and numbering of unknowns.

mod create;
mod labels;

use std::ops::Range;

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_sys as sys;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Error, Result, check, require};
use crate::object::Object;
use crate::text::int;

/// A distributed mesh of points: cells, faces, edges and vertices share one numbering on each rank.
pub struct Plex(Object<sys::_p_DM>);

pub use labels::LabelledPoint;

/// Shape of a cell or of a face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CellType {
    /// Three vertices.
    Triangle,
    /// Four vertices, plane.
    Quadrilateral,
    /// Four vertices, solid.
    Tetrahedron,
    /// Eight vertices.
    Hexahedron,
    /// Any other.
    Other,
}

/// Global numbers of the unknowns on each point of this rank's part of the mesh.
pub struct Numbering {
    chart: Range<Int>,
    first: Vec<Int>,
    /// Number of unknowns that this rank owns.
    pub owned: usize,
}

impl Numbering {
    /// Global number of the first unknown on a point, and whether this rank owns it. Undefined for a point without
    /// unknowns.
    pub fn first(&self, point: Int) -> (Int, bool) {
        // PETSc's encoding of another rank's number n: −(n + 1).
        match self.first[(point - self.chart.start) as usize] {
            n if n < 0 => (-(n + 1), false),
            n => (n, true),
        }
    }
}

impl Plex {
    fn raw(&self) -> sys::DM {
        self.0.raw()
    }

    /// Takes ownership of a PETSc mesh.
    ///
    /// # Safety
    /// `raw` is a reference to a valid mesh of type `plex` on `comm`, set up, which nobody else releases or changes.
    pub unsafe fn from_raw(raw: sys::DM, comm: &Comm) -> Self {
        // SAFETY: guaranteed by the caller.
        Self(unsafe { Object::new(raw, comm) })
    }

    /// The raw handle. It is valid while `self` lives.
    pub fn as_raw(&self) -> sys::DM {
        self.raw()
    }

    /// The communicator of this object.
    pub fn comm(&self) -> &Comm {
        self.0.comm()
    }

    /// Topological dimension.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn dimension(&self) -> Result<usize> {
        let mut value = 0;
        // SAFETY: the mesh is valid.
        check(unsafe { sys::DMGetDimension(self.raw(), &raw mut value) })?;
        Ok(value as usize)
    }

    /// This rank's points of a dimension: 0 vertices, 1 edges, 2 faces, 3 cells.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn points(&self, dimension: usize) -> Result<Range<Int>> {
        let (dimension, mut begin, mut end) = (int(dimension)?, 0, 0);
        // SAFETY: the mesh is valid.
        check(unsafe { sys::DMPlexGetDepthStratum(self.raw(), dimension, &raw mut begin, &raw mut end) })?;
        Ok(begin..end)
    }

    /// All points of this rank.
    fn chart(&self) -> Result<Range<Int>> {
        let (mut begin, mut end) = (0, 0);
        // SAFETY: the mesh is valid.
        check(unsafe { sys::DMPlexGetChart(self.raw(), &raw mut begin, &raw mut end) })?;
        Ok(begin..end)
    }

    /// This rank's points that other ranks have too. Collective.
    fn shared_points(&self) -> Result<Vec<Int>> {
        let (mut owners, mut roots, mut leaves) = (std::ptr::null_mut(), 0, 0);
        let (mut local, mut degrees) = (std::ptr::null(), std::ptr::null());
        // SAFETY: the mesh is valid; the star forest with the owners of points belongs to it.
        check(unsafe { sys::DMGetPointSF(self.raw(), &raw mut owners) })?;
        let (roots_out, leaves_out, remote) = (&raw mut roots, &raw mut leaves, std::ptr::null_mut());
        // SAFETY: as above; the locations of the other ranks' points are not requested.
        check(unsafe { sys::PetscSFGetGraph(owners, roots_out, leaves_out, &raw mut local, remote) })?;
        // A mesh on one rank has no such graph.
        if roots < 0 {
            return Ok(Vec::new());
        }
        // SAFETY: as above, and the graph is set, here and below.
        check(unsafe { sys::PetscSFComputeDegreeBegin(owners, &raw mut degrees) })?;
        // SAFETY: as above.
        check(unsafe { sys::PetscSFComputeDegreeEnd(owners, &raw mut degrees) })?;
        // SAFETY: PETSc's array has a number for each point that other ranks could have too.
        let owned = (0..roots).filter(|&point| unsafe { *degrees.add(point as usize) } > 0);
        // Without a list, the points of other ranks are the first ones.
        // SAFETY: PETSc's array holds this number of points.
        let others = (0..leaves).map(|i| if local.is_null() { i } else { unsafe { *local.add(i as usize) } });
        Ok(owned.chain(others).collect())
    }

    /// Returns an error for a point that this rank does not have: PETSc checks this in debugging builds only.
    fn check_point(&self, point: Int) -> Result<()> {
        let chart = self.chart()?;
        if chart.contains(&point) {
            return Ok(());
        }
        Err(Error::OutOfRange { index: point as i64, size: (chart.end - chart.start) as usize })
    }

    /// Shape of a point.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn cell_type(&self, point: Int) -> Result<CellType> {
        self.check_point(point)?;
        let mut kind = sys::DMPolytopeType(0);
        // SAFETY: the mesh is valid and has the point.
        check(unsafe { sys::DMPlexGetCellType(self.raw(), point, &raw mut kind) })?;
        Ok(match kind {
            sys::DMPolytopeType::DM_POLYTOPE_TRIANGLE => CellType::Triangle,
            sys::DMPolytopeType::DM_POLYTOPE_QUADRILATERAL => CellType::Quadrilateral,
            sys::DMPolytopeType::DM_POLYTOPE_TETRAHEDRON => CellType::Tetrahedron,
            sys::DMPolytopeType::DM_POLYTOPE_HEXAHEDRON => CellType::Hexahedron,
            _ => CellType::Other,
        })
    }

    /// The points of the next lower dimension that bound a point.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn cone(&self, point: Int) -> Result<&[Int]> {
        self.check_point(point)?;
        let (mut len, mut data) = (0, std::ptr::null());
        // SAFETY: the mesh is valid and has the point.
        check(unsafe { sys::DMPlexGetConeSize(self.raw(), point, &raw mut len) })?;
        // SAFETY: as above.
        check(unsafe { sys::DMPlexGetCone(self.raw(), point, &raw mut data) })?;
        if len == 0 {
            return Ok(&[]);
        }
        // SAFETY: `len` entries in the mesh's own array, which no method of this type changes.
        Ok(unsafe { std::slice::from_raw_parts(data, len as usize) })
    }

    /// The point and all points that bound it, with vertices in PETSc's order for the shape.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn closure(&self, point: Int) -> Result<Vec<Int>> {
        self.check_point(point)?;
        let (mut len, mut data) = (0, std::ptr::null_mut());
        let cone = sys::TRUE;
        // SAFETY: the mesh is valid and has the point; PETSc allocates.
        check(unsafe { sys::DMPlexGetTransitiveClosure(self.raw(), point, cone, &raw mut len, &raw mut data) })?;
        // The array holds pairs of a point and its orientation.
        // SAFETY: PETSc filled `len` pairs.
        let points = (0..len as usize).map(|i| unsafe { *data.add(2 * i) }).collect();
        // SAFETY: returns what was obtained above.
        check(unsafe { sys::DMPlexRestoreTransitiveClosure(self.raw(), point, cone, &raw mut len, &raw mut data) })?;
        Ok(points)
    }

    /// Coordinates of this rank's vertices, in the order of `points(0)`. `None` if the mesh has more than vertex
    /// coordinates (curved cells). Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn vertex_coordinates(&self) -> Result<Option<Vec<[f64; 3]>>> {
        let (mut section, mut coordinates) = (std::ptr::null_mut(), std::ptr::null_mut());
        // SAFETY: the mesh is valid; both are borrowed from it.
        check(unsafe { sys::DMGetCoordinateSection(self.raw(), &raw mut section) })?;
        // SAFETY: as above.
        check(unsafe { sys::DMGetCoordinatesLocal(self.raw(), &raw mut coordinates) })?;
        if coordinates.is_null() || section.is_null() {
            return Ok(None);
        }
        let (mut data, mut size) = (std::ptr::null(), 0);
        // SAFETY: the vector is valid.
        check(unsafe { sys::VecGetLocalSize(coordinates, &raw mut size) })?;
        let vertices = self.points(0)?;
        if size != 3 * (vertices.end - vertices.start) {
            return Ok(None);
        }
        let mut places = Vec::new();
        for vertex in vertices {
            // SAFETY: the section belongs to the mesh.
            match unsafe { place_of(section, vertex) }? {
                Some(place) if place.start >= 0 && place.end - place.start == 3 && place.end <= size => {
                    places.push(place.start as usize);
                }
                _ => return Ok(None),
            }
        }
        // SAFETY: as above; restored below.
        check(unsafe { sys::VecGetArrayRead(coordinates, &raw mut data) })?;
        // SAFETY: each place has three coordinates within the array.
        let list = places.iter().map(|place| [0, 1, 2].map(|i| unsafe { *data.add(place + i) })).collect();
        // SAFETY: returns what was obtained above.
        check(unsafe { sys::VecRestoreArrayRead(coordinates, &raw mut data) })?;
        Ok(Some(list))
    }

    /// Numbers `per_point(dimension)` unknowns on each point, contiguously on each rank. The owner numbers a point that
    /// several ranks share. Collective.
    ///
    /// # Errors
    /// If there are more unknowns than PETSc's integers can number (on all ranks), or if a PETSc call fails.
    pub fn number(&self, per_point: impl Fn(usize) -> usize) -> Result<Numbering> {
        let raw = self.raw();
        let counts = [0, 1, 2, 3].map(per_point);
        let (mut mine, mut all) = (0_u64, 0.0);
        for (dimension, count) in counts.iter().enumerate() {
            let points = self.points(dimension)?;
            mine = mine.saturating_add((*count as u64).saturating_mul((points.end - points.start).max(0) as u64));
        }
        // PETSc sums without an overflow check. A double holds every integer up to 2⁵³ and does not wrap.
        self.comm().mpi().all_reduce_into(&(mine as f64), &mut all, SystemOperation::sum());
        require(all < Int::MAX as f64, "more unknowns than PETSc's integers number")?;
        let Range { start: begin, end } = self.chart()?;
        let mut section = std::ptr::null_mut();
        // SAFETY: the communicator is valid.
        check(unsafe { sys::PetscSectionCreate(self.comm().petsc()?, &raw mut section) })?;
        // SAFETY: the new section is ours.
        let section: Object<sys::_p_PetscSection> = unsafe { Object::new(section, self.comm()) };
        // SAFETY: a fresh section, here and below.
        check(unsafe { sys::PetscSectionSetChart(section.raw(), begin, end) })?;
        for (dimension, count) in counts.into_iter().enumerate() {
            let count = int(count)?;
            for point in self.points(dimension)? {
                // SAFETY: the point is in the chart.
                check(unsafe { sys::PetscSectionSetDof(section.raw(), point, count) })?;
            }
        }
        // SAFETY: as above.
        check(unsafe { sys::PetscSectionSetUp(section.raw()) })?;
        // SAFETY: both are valid; the mesh takes its own reference.
        check(unsafe { sys::DMSetLocalSection(raw, section.raw()) })?;
        section.destroy()?;
        let mut global = std::ptr::null_mut();
        // SAFETY: the mesh is valid; the global section belongs to it.
        check(unsafe { sys::DMGetGlobalSection(raw, &raw mut global) })?;
        let first = (begin..end)
            .map(|point| {
                let mut offset = 0;
                // SAFETY: the point is in the chart.
                check(unsafe { sys::PetscSectionGetOffset(global, point, &raw mut offset) })?;
                Ok(offset)
            })
            .collect::<Result<Vec<_>>>()?;
        let mut owned = 0;
        // SAFETY: as above.
        check(unsafe { sys::PetscSectionGetConstrainedStorageSize(global, &raw mut owned) })?;
        Ok(Numbering { chart: begin..end, first, owned: owned as usize })
    }
}

/// Range of a point's entries in a section; `None` for a point that the section does not have.
///
/// # Safety
/// The section is valid.
unsafe fn place_of(section: sys::PetscSection, point: Int) -> Result<Option<Range<Int>>> {
    let (mut begin, mut end, mut first, mut count) = (0, 0, 0, 0);
    // SAFETY: guaranteed by the caller, here and below.
    check(unsafe { sys::PetscSectionGetChart(section, &raw mut begin, &raw mut end) })?;
    if !(begin..end).contains(&point) {
        return Ok(None);
    }
    // SAFETY: as above, and it has the point.
    check(unsafe { sys::PetscSectionGetDof(section, point, &raw mut count) })?;
    // SAFETY: as above.
    check(unsafe { sys::PetscSectionGetOffset(section, point, &raw mut first) })?;
    Ok(Some(first..first.saturating_add(count)))
}
