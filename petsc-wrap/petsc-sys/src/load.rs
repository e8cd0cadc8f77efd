//! PETSc's library, loaded when it is first wanted.

use std::path::Path;
use std::sync::OnceLock;

use libloading::os::unix;

use super::Library;

/// PETSc's library as the build found it.
const FILE: &str = env!("PETSC_LIBRARY");

/// The libraries that it needs, each after those that it needs itself: a list as of PATH.
const NEEDED: &str = env!("PETSC_NEEDED");

/// The loader's flag for a library whose names are looked for in what it needs first, where the loader has one.
#[cfg(target_env = "gnu")]
const OWN_FIRST: i32 = libc::RTLD_DEEPBIND;
#[cfg(not(target_env = "gnu"))]
const OWN_FIRST: i32 = 0;

struct Loaded {
    petsc: Library,
    /// Never read: dropped, they would be unloaded.
    _needed: Vec<libloading::Library>,
}

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
        // One by one, each is bound among the few that it needs; together, each name of each is looked for in all of them. What has gone, or
        // cannot stand alone, comes with PETSc.
        let needed = std::env::split_paths(NEEDED).filter(|_| !has_gone);
        // SAFETY: PETSc's library needs them: the loader would load them with it.
        let needed = needed.filter_map(|needed| unsafe { open(&needed) }.ok()).collect();
        // SAFETY: the library that the bindings were made for, or one of the same name and version, as the linker would take.
        let petsc = unsafe { open(file).and_then(|library| Library::from_library(library)) };
        petsc.map(|petsc| Loaded { petsc, _needed: needed }).map_err(|error| {
            let gone = if has_gone { format!(" (it has gone from {FILE})") } else { String::new() };
            format!("PETSc cannot be loaded: {error}{gone}")
        })
    });
    loaded.as_ref().map(|loaded| &loaded.petsc).map_err(Clone::clone)
}

/// Opens a library.
///
/// # Safety
/// As the library's own: what it does when it is loaded. (PETSc's, and those that it needs, set up themselves, which they may at any time.)
unsafe fn open(file: &Path) -> Result<libloading::Library, libloading::Error> {
    // Names are looked for in what the library needs before the program and its libraries. But whoever preloads a library, as a profiler of
    // MPI, wants to be found first.
    let own_first = if std::env::var_os("LD_PRELOAD").is_none() { OWN_FIRST } else { 0 };
    // SAFETY: the caller's.
    unsafe { unix::Library::open(Some(file), unix::RTLD_LAZY | unix::RTLD_LOCAL | own_first) }.map(Into::into)
}

/// The library.
///
/// # Panics
/// Where it cannot be loaded. Who calls [`load`] first is told of that.
pub(crate) fn library() -> &'static Library {
    load().unwrap_or_else(|error| panic!("{error}"))
}
