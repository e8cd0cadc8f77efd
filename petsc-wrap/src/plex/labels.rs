//! Labels: named values on points of a mesh.

use petsc_sys as sys;

use super::Plex;
use crate::Int;
use crate::error::{Result, check, require};
use crate::text::to_c;

/// A point of this rank and the value that a label gives it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LabelledPoint {
    /// Number of the point.
    pub point: Int,
    /// Value of the label.
    pub value: Int,
}

/// Returns an error for labels that PETSc itself uses for the topology of a mesh.
fn check_free(name: &str) -> Result<()> {
    require(!["depth", "celltype"].contains(&name.replace('\0', "").as_str()), "PETSc needs this label for itself")
}

impl Plex {
    /// Adds values to a label, which is created if the mesh has none of that name. Each rank labels its own points. A
    /// point that several ranks have is labelled only on the ranks that give it.
    ///
    /// # Errors
    /// If this rank does not have a point, if PETSc itself uses the label for the mesh's topology, or if a PETSc call
    /// fails.
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

    /// Returns the label of that name, created if needed; it belongs to the mesh.
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
    /// If PETSc itself uses the label for the mesh's topology, or if a PETSc call fails.
    pub fn label_boundary(&self, name: &str) -> Result<()> {
        check_free(name)?;
        let label = self.make_label(name)?;
        // SAFETY: mesh and label are valid.
        check(unsafe { sys::DMPlexMarkBoundaryFaces(self.raw(), 1, label) })?;
        // A face between ranks has only one cell on each of them, so PETSc has marked it.
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
    /// If a PETSc call fails.
    pub fn has_label(&self, name: &str, point: Int) -> Result<bool> {
        self.check_point(point)?;
        let name = to_c(name);
        let mut value = -1;
        // SAFETY: the mesh is valid and has the point; the name outlives the call.
        check(unsafe { sys::DMGetLabelValue(self.raw(), name.as_ptr(), point, &raw mut value) })?;
        // A point without the label has the label's default value, −1.
        Ok(value != -1)
    }

    /// Whether a label gives a point this value, possibly among others. `false` if there is no such label.
    ///
    /// # Errors
    /// If a PETSc call fails.
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
