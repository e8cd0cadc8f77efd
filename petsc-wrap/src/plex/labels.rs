//! Values on points of a mesh, by name.

use petsc_sys as sys;

use super::Plex;
use crate::Int;
use crate::error::{Result, check, require};
use crate::text::to_c;

impl Plex {
    /// Puts all faces on the boundary of the whole mesh into a label. Collective.
    ///
    /// # Errors
    /// A label by which PETSc itself finds its way in the mesh; PETSc's.
    pub fn label_boundary(&self, name: &str) -> Result<()> {
        require(
            !["depth", "celltype"].contains(&name.replace('\0', "").as_str()),
            "PETSc needs this label for itself",
        )?;
        let name = to_c(name);
        let mut label = std::ptr::null_mut();
        // SAFETY: the mesh is valid; the name outlives the calls.
        check(unsafe { sys::DMCreateLabel(self.raw(), name.as_ptr()) })?;
        // SAFETY: as above; the label belongs to the mesh.
        check(unsafe { sys::DMGetLabel(self.raw(), name.as_ptr(), &raw mut label) })?;
        // SAFETY: as above.
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
