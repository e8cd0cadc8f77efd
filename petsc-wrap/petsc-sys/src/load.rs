//! Loads PETSc's library when it is first used.

use std::ffi::{CStr, c_char, c_int};
use std::path::Path;
use std::sync::OnceLock;

use super::{Library, PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR, PetscInt, PetscReal, PetscScalar};

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
/// If the loader fails, or if the library is not like the one for which the bindings were made.
pub fn load() -> Result<&'static Library, String> {
    let loaded = LOADED.get_or_init(|| {
        let built_with = Path::new(FILE);
        let has_gone = !built_with.exists();
        let file = if has_gone { Path::new(built_with.file_name().expect("the name of a file")) } else { built_with };
        // (All needed libraries are loaded at once, in one scope. Fortran's MPI recognises MPI_IN_PLACE by the address
        // of a common block. Each library has such a block, and the loader must use the same one for all. Loading them
        // one by one, or with RTLD_DEEPBIND, takes half the time, but MUMPS then crashes.)
        // SAFETY: this is PETSc's library, or one of the same name, like the linker would take. It and the libraries
        // that it needs may be loaded at any time: while loading, they only initialise themselves.
        let library = unsafe { libloading::Library::new(file) }.map_err(|error| error.to_string());
        let bound = library.and_then(|library| {
            check(&library)?;
            // SAFETY: after the check, the library's functions have the types of the bindings.
            unsafe { Library::from_library(library) }.map_err(|error| error.to_string())
        });
        bound.map(Loaded).map_err(|error| {
            let gone = if has_gone { format!(" (it has gone from {FILE})") } else { String::new() };
            format!("PETSc cannot be loaded: {error}{gone}")
        })
    });
    loaded.as_ref().map(|loaded| &loaded.0).map_err(Clone::clone)
}

/// Returns an error if a library has another version, or numbers of other sizes, than the bindings: it may have been
/// exchanged since they were made.
fn check(library: &libloading::Library) -> Result<(), String> {
    type OfName = unsafe extern "C" fn(*const c_char, *mut c_int, *mut c_int) -> c_int;
    type SizeOf = unsafe extern "C" fn(c_int, *mut usize) -> c_int;
    type Version = unsafe extern "C" fn(*mut i64, *mut i64, *mut i64, *mut i64) -> c_int;
    let missing = |error: libloading::Error| error.to_string();
    // SAFETY: these are PETSc's declarations, with room for what differs between its builds: the enum and the truth
    // value have at most the size of an int, and the numbers of the version are of 32 or 64 bits. The functions may be
    // called before PETSc is initialised.
    let (version, sizes) = unsafe {
        let of_name = library.get::<OfName>(b"PetscDataTypeFromString").map_err(missing)?;
        let size_of = library.get::<SizeOf>(b"PetscDataTypeGetSize").map_err(missing)?;
        let version = library.get::<Version>(b"PetscGetVersionNumber").map_err(missing)?;
        let sizes = [c"int", c"real", c"scalar"].map(|name: &CStr| {
            let (mut kind, mut is_known, mut size) = (0, 0, 0);
            of_name(name.as_ptr(), &raw mut kind, &raw mut is_known);
            size_of(kind, &raw mut size);
            size
        });
        let mut numbers = [0; 4];
        let [major, minor, patch, release] = &mut numbers;
        version(major, minor, patch, release);
        let number = |place: &i64| if sizes[0] == 4 { *std::ptr::from_ref(place).cast::<i32>() as i64 } else { *place };
        ((number(&numbers[0]), number(&numbers[1])), sizes)
    };
    let built = (PETSC_VERSION_MAJOR as i64, PETSC_VERSION_MINOR as i64);
    let built_sizes = [size_of::<PetscInt>(), size_of::<PetscReal>(), size_of::<PetscScalar>()];
    let told = |(major, minor), [int, real, scalar]: [usize; 3]| {
        format!("PETSc {major}.{minor} with integers of {int}, reals of {real} and scalars of {scalar} bytes")
    };
    let (found, built) = (told(version, sizes), told(built, built_sizes));
    if found == built { Ok(()) } else { Err(format!("this is {found}; the program was built for {built}")) }
}

/// Returns the loaded library.
///
/// # Panics
/// If it cannot be loaded. A caller of [`load`] gets this as an error instead.
pub(crate) fn library() -> &'static Library {
    load().unwrap_or_else(|error| panic!("{error}"))
}

#[cfg(test)]
mod tests {
    use std::process::Command;

    /// A library is refused that has the name and the functions of PETSc, but another version or other types. The one
    /// for which the bindings were made is loaded.
    #[test]
    fn a_library_of_another_build_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let said = |version: &str, int: &str, sizes: [usize; 3]| {
            let (code, file) = (folder.path().join("petsc.c"), folder.path().join(format!("{version}{sizes:?}.so")));
            let [of_int, of_real, of_scalar] = sizes;
            let text = format!(
                "int PetscDataTypeFromString(const char *name, int *type, int *found)
                 {{ *type = name[0] == 'i' ? {of_int} : name[0] == 'r' ? {of_real} : {of_scalar}; return 0; }}
                 int PetscDataTypeGetSize(int type, unsigned long *size) {{ *size = type; return 0; }}
                 int PetscGetVersionNumber({int} *major, {int} *minor, {int} *patch, {int} *release)
                 {{ *major = 3; *minor = {version}; *patch = *release = 1; return 0; }}"
            );
            std::fs::write(&code, text).unwrap();
            let made = Command::new("cc").args(["-shared", "-fPIC", "-o"]).args([&file, &code]).status().unwrap();
            assert!(made.success());
            // SAFETY: the library has the three functions above.
            super::check(&unsafe { libloading::Library::new(file) }.unwrap())
        };
        let minor = crate::PETSC_VERSION_MINOR.to_string();
        let (mine, other) = (size_of::<crate::PetscInt>(), 12 - size_of::<crate::PetscInt>());
        let [int, long] = if mine == 4 { ["int", "long"] } else { ["long", "int"] };
        assert_eq!(said(&minor, int, [mine, 8, 8]), Ok(()));
        let old = said("9", int, [mine, 8, 8]).unwrap_err();
        assert!(old.starts_with("this is PETSc 3.9 with") && old.contains(&format!("for PETSc 3.{minor} ")), "{old}");
        let wide = said(&minor, long, [other, 8, 8]).unwrap_err();
        assert!(wide.starts_with(&format!("this is PETSc 3.{minor} with integers of {other}, ")), "{wide}");
        assert!(said(&minor, int, [mine, 4, 4]).is_err() && said(&minor, int, [mine, 8, 16]).is_err());
        assert!(super::load().is_ok());
    }
}
