//! PETSc's options database, process-wide.

use std::ffi::CString;

use petsc_sys as sys;

use crate::error::{Result, check, owned};
use crate::session::Session;

fn text(value: &str) -> CString {
    CString::new(value.replace('\0', "")).unwrap_or_default()
}

/// Whether an option (`name` with its leading dash) is set.
///
/// # Errors
/// PETSc's.
pub fn is_set(_session: &Session, name: &str) -> Result<bool> {
    let name = text(name);
    let mut set = sys::FALSE;
    let (database, prefix) = (std::ptr::null_mut(), std::ptr::null());
    // SAFETY: PETSc is initialised (a session exists); the string outlives the call.
    check(unsafe { sys::PetscOptionsHasName(database, prefix, name.as_ptr(), &raw mut set) })?;
    Ok(set == sys::TRUE)
}

/// Sets an option, also where it is set already.
///
/// # Errors
/// PETSc's.
pub fn set(_session: &Session, name: &str, value: &str) -> Result<()> {
    let (name, value) = (text(name), text(value));
    // SAFETY: PETSc is initialised; the strings outlive the call, and PETSc copies them.
    check(unsafe { sys::PetscOptionsSetValue(std::ptr::null_mut(), name.as_ptr(), value.as_ptr()) })
}

/// Removes an option, so that it no longer applies to objects made later.
///
/// # Errors
/// PETSc's.
pub fn clear(_session: &Session, name: &str) -> Result<()> {
    let name = text(name);
    // SAFETY: PETSc is initialised; the string outlives the call.
    check(unsafe { sys::PetscOptionsClearValue(std::ptr::null_mut(), name.as_ptr()) })
}

/// All options that are set, in one line.
///
/// # Errors
/// PETSc's.
pub fn all(_session: &Session) -> Result<String> {
    let mut raw = std::ptr::null_mut();
    // SAFETY: PETSc is initialised; the out-pointer receives an allocation of PETSc's.
    check(unsafe { sys::PetscOptionsGetAll(std::ptr::null_mut(), &raw mut raw) })?;
    let value = owned(raw);
    // SAFETY: PETSc's own free function for PETSc's own allocation, once.
    if let Some(free) = unsafe { sys::PetscTrFree } {
        // SAFETY: as above.
        check(unsafe { free(raw.cast(), 0, c"all".as_ptr(), c"options.rs".as_ptr()) })?;
    }
    Ok(value.trim().to_owned())
}

/// Names of options that nothing has asked for so far: most often misspelt.
///
/// # Errors
/// PETSc's.
pub fn unused(_session: &Session) -> Result<Vec<String>> {
    let mut count = 0;
    let (mut names, mut values) = (std::ptr::null_mut(), std::ptr::null_mut());
    let database = std::ptr::null_mut();
    // SAFETY: PETSc is initialised; the out-pointers are valid.
    check(unsafe { sys::PetscOptionsLeftGet(database, &raw mut count, &raw mut names, &raw mut values) })?;
    let list = (0..count as usize)
        // SAFETY: PETSc filled `count` names.
        .map(|i| owned(unsafe { *names.add(i) }))
        .collect();
    // SAFETY: gives back exactly what was got.
    check(unsafe { sys::PetscOptionsLeftRestore(database, &raw mut count, &raw mut names, &raw mut values) })?;
    Ok(list)
}
