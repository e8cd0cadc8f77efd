//! PETSc's library, loaded when it is first wanted.

use std::path::Path;
use std::sync::OnceLock;

use super::Library;

/// PETSc's library as the build found it.
const FILE: &str = env!("PETSC_LIBRARY");

struct Loaded(Library);

// SAFETY: these are addresses of functions and of variables of PETSc's, the same for all threads as long as the process lives. What may be
// called and read when, and on which thread, is PETSc's matter, as it is where its library is linked.
unsafe impl Send for Loaded {}
// SAFETY: as above.
unsafe impl Sync for Loaded {}

static LOADED: OnceLock<Result<Loaded, String>> = OnceLock::new();

/// Loads PETSc, where nobody has done so: from where it was when this was built; or, if it has gone from there, from where the loader finds
/// one of that name, which has the version in it.
///
/// # Errors
/// The loader's.
pub fn load() -> Result<&'static Library, String> {
    let loaded = LOADED.get_or_init(|| {
        let built_with = Path::new(FILE);
        let has_gone = !built_with.exists();
        let file = if has_gone { Path::new(built_with.file_name().expect("the name of a file")) } else { built_with };
        // (With all that it needs at once, in one scope: Fortran's MPI tells MPI_IN_PLACE by the address of a common block, of which each library has
        // one, and the loader must take the same for all. Loaded one by one, or with RTLD_DEEPBIND, they start in half the time, and MUMPS crashes.)
        // SAFETY: the library that the bindings were made for, or one of the same name and version, as the linker would take; it and those
        // that it needs may be loaded at any time: what they do on the way is to set up themselves.
        unsafe { Library::new(file) }.map(Loaded).map_err(|error| {
            let gone = if has_gone { format!(" (it has gone from {FILE})") } else { String::new() };
            format!("PETSc cannot be loaded: {error}{gone}")
        })
    });
    loaded.as_ref().map(|loaded| &loaded.0).map_err(Clone::clone)
}

/// The library.
///
/// # Panics
/// Where it cannot be loaded. Who calls [`load`] first is told of that.
pub(crate) fn library() -> &'static Library {
    load().unwrap_or_else(|error| panic!("{error}"))
}
