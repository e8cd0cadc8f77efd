//! One form for functions and constants that differ between PETSc's versions.

use super::*;

/// PETSC_TRUE and PETSC_FALSE, which are C's own `true` and `false` in newer versions.
#[cfg(bool_is_of_c)]
pub const TRUE: PetscBool = true;
#[cfg(bool_is_of_c)]
pub const FALSE: PetscBool = false;
#[cfg(not(bool_is_of_c))]
pub const TRUE: PetscBool = PetscBool::PETSC_TRUE;
#[cfg(not(bool_is_of_c))]
pub const FALSE: PetscBool = PetscBool::PETSC_FALSE;

/// `DMPlexCreateBoxMesh` without localised coordinates; newer versions have an argument for them.
///
/// # Safety
/// Same as for PETSc's function.
pub unsafe fn create_box_mesh(
    comm: MPI_Comm,
    dimension: PetscInt,
    simplex: PetscBool,
    faces: *const PetscInt,
    (lower, upper): (*const PetscReal, *const PetscReal),
    interpolate: PetscBool,
    mesh: *mut DM,
) -> PetscErrorCode {
    let none = std::ptr::null();
    #[cfg(box_mesh_is_localized)]
    // SAFETY: guaranteed by the caller.
    return unsafe {
        DMPlexCreateBoxMesh(comm, dimension, simplex, faces, lower, upper, none, interpolate, 0, FALSE, mesh)
    };
    #[cfg(not(box_mesh_is_localized))]
    // SAFETY: guaranteed by the caller.
    return unsafe { DMPlexCreateBoxMesh(comm, dimension, simplex, faces, lower, upper, none, interpolate, mesh) };
}

/// `SNESLineSearchShellSetApply`, which older versions call `SNESLineSearchShellSetUserFunc`.
///
/// # Safety
/// Same as for PETSc's function.
pub unsafe fn set_line_search(
    search: SNESLineSearch,
    apply: Option<unsafe extern "C" fn(SNESLineSearch, *mut std::ffi::c_void) -> PetscErrorCode>,
    context: *mut std::ffi::c_void,
) -> PetscErrorCode {
    #[cfg(line_search_has_apply)]
    // SAFETY: guaranteed by the caller.
    return unsafe { SNESLineSearchShellSetApply(search, apply, context) };
    #[cfg(not(line_search_has_apply))]
    // SAFETY: guaranteed by the caller.
    return unsafe { SNESLineSearchShellSetUserFunc(search, apply, context) };
}
