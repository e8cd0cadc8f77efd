//! Values on points of a mesh, by name.

use petsc_sys as sys;

use super::Plex;
use crate::Int;
use crate::error::{Result, check, require};
use crate::text::to_c;

/// A point of this rank, and a value that a label is to give it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LabelledPoint {
    /// The point.
    pub point: Int,
    /// The value.
    pub value: Int,
}

/// Labels by which PETSc finds its way in a mesh.
fn check_free(name: &str) -> Result<()> {
    require(!["depth", "celltype"].contains(&name.replace('\0', "").as_str()), "PETSc needs this label for itself")
}

impl Plex {
    /// Adds values to a label, which is made where the mesh has none of that name. Each rank labels its own points: one that several have is
    /// labelled where they do.
    ///
    /// # Errors
    /// A point that this rank does not have; a label by which PETSc itself finds its way in the mesh; PETSc's.
    pub fn label(&self, name: &str, points: impl IntoIterator<Item = LabelledPoint>) -> Result<()> {
        check_free(name)?;
        let label = self.make_label(name)?;
        for LabelledPoint { point, value } in points {
            self.check_point(point)?;
            // SAFETY: the label is valid, and the mesh has the point.
            check(unsafe { sys::DMLabelSetValue(label, point, value) })?;
        }
        Ok(())
    }

    /// The label of that name, new if need be; it belongs to the mesh.
    fn make_label(&self, name: &str) -> Result<sys::DMLabel> {
        let name = to_c(name);
        let mut label = std::ptr::null_mut();
        // SAFETY: the mesh is valid; the name outlives the calls.
        check(unsafe { sys::DMCreateLabel(self.raw(), name.as_ptr()) })?;
        // SAFETY: as above.
        check(unsafe { sys::DMGetLabel(self.raw(), name.as_ptr(), &raw mut label) })?;
        Ok(label)
    }

    /// Puts all faces on the boundary of the whole mesh into a label. Collective.
    ///
    /// # Errors
    /// A label by which PETSc itself finds its way in the mesh; PETSc's.
    pub fn label_boundary(&self, name: &str) -> Result<()> {
        check_free(name)?;
        let label = self.make_label(name)?;
        // SAFETY: mesh and label are valid.
        check(unsafe { sys::DMPlexMarkBoundaryFaces(self.raw(), 1, label) })?;
        // A face between ranks has one cell on either.
        let faces = self.points(2)?;
        for face in self.shared_points()?.into_iter().filter(|point| faces.contains(point)) {
            // SAFETY: the label is valid.
            check(unsafe { sys::DMLabelClearValue(label, face, 1) })?;
        }
        Ok(())
    }

    /// Whether a point carries a label, whatever its value.
    ///
    /// # Errors
    /// PETSc's.
    pub fn has_label(&self, name: &str, point: Int) -> Result<bool> {
        self.check_point(point)?;
        let name = to_c(name);
        let mut value = -1;
        // SAFETY: the mesh is valid and has the point; the name outlives the call.
        check(unsafe { sys::DMGetLabelValue(self.raw(), name.as_ptr(), point, &raw mut value) })?;
        // A point without the label has the label's default value, −1.
        Ok(value != -1)
    }

    /// Whether a label gives a point this value, maybe among others; none does where there is no such label.
    ///
    /// # Errors
    /// PETSc's.
    pub fn has_label_value(&self, name: &str, value: Int, point: Int) -> Result<bool> {
        self.check_point(point)?;
        let name = to_c(name);
        let mut label = std::ptr::null_mut();
        // SAFETY: the mesh is valid; the name outlives the call, and the label belongs to the mesh.
        check(unsafe { sys::DMGetLabel(self.raw(), name.as_ptr(), &raw mut label) })?;
        if label.is_null() {
            return Ok(false);
        }
        let mut found = sys::FALSE;
        // SAFETY: the label is valid.
        check(unsafe { sys::DMLabelStratumHasPoint(label, value, point, &raw mut found) })?;
        Ok(found == sys::TRUE)
    }
}
