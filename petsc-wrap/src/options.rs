//! PETSc's options database, which is global to the process.

use petsc_sys as sys;

use crate::error::{Result, check};
use crate::session::Session;
use crate::text::{from_c, option_name, to_c};

/// The options that a session sets: MPI's and the program's own signal handlers stay in use, and a file `.petscrc` in the
/// current or the home folder, which could make PETSc load a library, is not read.
pub(crate) const SESSION_OPTIONS: [&str; 2] = ["-no_signal_handler", "-skip_petscrc"];

/// Whether an option (`name` with its leading dash) is set.
///
/// # Errors
/// If a PETSc call fails.
pub fn is_set(session: &Session, name: &str) -> Result<bool> {
    session.petsc()?;
    let name = option_name(name)?;
    let mut set = sys::FALSE;
    let (database, prefix) = (std::ptr::null_mut(), std::ptr::null());
    // SAFETY: PETSc is initialised; the string outlives the call.
    check(unsafe { sys::PetscOptionsHasName(database, prefix, name.as_ptr(), &raw mut set) })?;
    Ok(set == sys::TRUE)
}

/// Value of an option; empty if it is set without a value, `None` if it is not set.
///
/// # Errors
/// If a PETSc call fails.
pub fn get(session: &Session, name: &str) -> Result<Option<String>> {
    session.petsc()?;
    let (name, none) = (option_name(name)?, std::ptr::null());
    let (mut value, mut set) = (std::ptr::null(), sys::FALSE);
    let database = std::ptr::null_mut();
    // SAFETY: PETSc is initialised; the string outlives the call, and the out-pointers are valid.
    check(unsafe { sys::PetscOptionsFindPair(database, none, name.as_ptr(), &raw mut value, &raw mut set) })?;
    // SAFETY: null, or a string of the database, which nobody changes during this call.
    Ok((set == sys::TRUE).then(|| unsafe { from_c(value) }))
}

/// Sets an option, or replaces its value.
///
/// # Errors
/// If a PETSc call fails.
pub fn set(session: &Session, name: &str, value: &str) -> Result<()> {
    session.petsc()?;
    let (name, value) = (option_name(name)?, to_c(value));
    // SAFETY: PETSc is initialised; the strings outlive the call, and PETSc copies them.
    check(unsafe { sys::PetscOptionsSetValue(std::ptr::null_mut(), name.as_ptr(), value.as_ptr()) })
}

/// Removes an option, so that it no longer applies to objects made later.
///
/// # Errors
/// If a PETSc call fails.
pub fn clear(session: &Session, name: &str) -> Result<()> {
    session.petsc()?;
    let name = option_name(name)?;
    // SAFETY: PETSc is initialised; the string outlives the call.
    check(unsafe { sys::PetscOptionsClearValue(std::ptr::null_mut(), name.as_ptr()) })
}

/// All options that are set, on one line, without those that a [`Session`] sets.
///
/// # Errors
/// If a PETSc call fails.
pub fn all(session: &Session) -> Result<String> {
    if !session.has_petsc() {
        return Ok(String::new());
    }
    let mut raw = std::ptr::null_mut();
    // SAFETY: PETSc is initialised; the out-pointer receives an allocation of PETSc's.
    check(unsafe { sys::PetscOptionsGetAll(std::ptr::null_mut(), &raw mut raw) })?;
    // SAFETY: PETSc has made a C string.
    let value = unsafe { from_c(raw) };
    // SAFETY: PETSc's own free function is called once on PETSc's own allocation.
    if let Some(free) = unsafe { *sys::PetscTrFree() } {
        // SAFETY: as above.
        check(unsafe { free(raw.cast(), 0, c"all".as_ptr(), c"options.rs".as_ptr()) })?;
    }
    Ok(value.split_whitespace().filter(|word| !SESSION_OPTIONS.contains(word)).collect::<Vec<_>>().join(" "))
}

/// Names of options that nothing has read so far. Most often they are misspelt.
///
/// # Errors
/// If a PETSc call fails.
pub fn unused(session: &Session) -> Result<Vec<String>> {
    if !session.has_petsc() {
        return Ok(Vec::new());
    }
    let mut count = 0;
    let (mut names, mut values) = (std::ptr::null_mut(), std::ptr::null_mut());
    let database = std::ptr::null_mut();
    // SAFETY: PETSc is initialised; the out-pointers are valid.
    check(unsafe { sys::PetscOptionsLeftGet(database, &raw mut count, &raw mut names, &raw mut values) })?;
    let list = (0..count as usize)
        // SAFETY: PETSc filled `count` names, C strings all of them.
        .map(|i| unsafe { from_c(*names.add(i)) })
        .collect();
    // SAFETY: returns exactly what was obtained above.
    check(unsafe { sys::PetscOptionsLeftRestore(database, &raw mut count, &raw mut names, &raw mut values) })?;
    Ok(list)
}
