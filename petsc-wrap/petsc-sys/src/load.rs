//! Loads PETSc's library when it is first used.

use std::path::Path;
use std::sync::OnceLock;

use super::Library;

/// Path of PETSc's library that the build found.
const FILE: &str = env!("PETSC_LIBRARY");

struct Loaded(Library);

// SAFETY: these are addresses of PETSc's functions and variables, which are the same for all threads as long as the
// process lives. The rules of when, and on which thread, they may be called and read are PETSc's, as they are for a
// linked library.
unsafe impl Send for Loaded {}
// SAFETY: as above.
unsafe impl Sync for Loaded {}

static LOADED: OnceLock<Result<Loaded, String>> = OnceLock::new();

/// Loads PETSc if it is not loaded yet: from its path at build time or, if the file is no longer there, from where the
/// loader finds a library of the same name, which contains the version.
///
/// # Errors
/// If the loader fails.
pub fn load() -> Result<&'static Library, String> {
    let loaded = LOADED.get_or_init(|| {
        let built_with = Path::new(FILE);
        let has_gone = !built_with.exists();
        let file = if has_gone { Path::new(built_with.file_name().expect("the name of a file")) } else { built_with };
        // (All needed libraries are loaded at once, in one scope. Fortran's MPI recognises MPI_IN_PLACE by the address
        // of a common block. Each library has such a block, and the loader must use the same one for all. Loading them
        // one by one, or with RTLD_DEEPBIND, takes half the time, but MUMPS then crashes.)
        // SAFETY: this is the library for which the bindings were made, or one of the same name and version, like the
        // linker would take. It and the libraries that it needs may be loaded at any time: while loading, they only
        // initialise themselves.
        unsafe { Library::new(file) }.map(Loaded).map_err(|error| {
            let gone = if has_gone { format!(" (it has gone from {FILE})") } else { String::new() };
            format!("PETSc cannot be loaded: {error}{gone}")
        })
    });
    loaded.as_ref().map(|loaded| &loaded.0).map_err(Clone::clone)
}

/// Returns the loaded library.
///
/// # Panics
/// If it cannot be loaded. A caller of [`load`] gets this as an error instead.
pub(crate) fn library() -> &'static Library {
    load().unwrap_or_else(|error| panic!("{error}"))
}
