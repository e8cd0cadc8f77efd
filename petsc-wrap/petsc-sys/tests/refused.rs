//! Tests that builds of PETSc that cannot work are refused in one sentence when the bindings are built.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The build script as it was last compiled, in the same target folder as this test:
/// `release/build/petsc-sys-*/build-script-main`.
fn build_script() -> PathBuf {
    let profile = std::env::current_exe().unwrap().parent().unwrap().parent().unwrap().join("build");
    let folders = fs::read_dir(profile).unwrap().map(|entry| entry.unwrap().path());
    let ours = folders.filter(|path| path.file_name().unwrap().to_string_lossy().starts_with("petsc-sys-"));
    let scripts = ours.map(|path| path.join("build-script-main")).filter(|path| path.exists());
    scripts.max_by_key(|path| path.metadata().unwrap().modified().unwrap()).expect("cargo has built the script")
}

/// The message of the script for a PETSc with this version and configuration.
fn said(folder: &Path, version: (u32, u32), configuration: &str) -> String {
    let include = folder.join("arch/include");
    fs::create_dir_all(&include).unwrap();
    let (major, minor) = version;
    let text = format!("#define PETSC_VERSION_MAJOR    {major}\n#define PETSC_VERSION_MINOR    {minor}\n");
    fs::write(include.join("petscversion.h"), text).unwrap();
    fs::write(include.join("petscconf.h"), configuration).unwrap();
    refusal(folder, "arch")
}

fn refusal(dir: &Path, arch: &str) -> String {
    let output = Command::new(build_script()).env("PETSC_DIR", dir).env("PETSC_ARCH", arch).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    String::from_utf8(output.stderr).unwrap().trim().to_owned()
}

#[test]
fn builds_that_cannot_work_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let complex = said(folder.path(), (3, 18), "#define PETSC_USE_COMPLEX 1\n#define PETSC_USE_REAL_DOUBLE 1\n");
    assert!(complex.starts_with("this PETSc is built with complex scalars; one with real scalars is needed: "));
    assert!(complex.contains("PETSC_DIR and PETSC_ARCH") && complex.lines().count() == 1, "{complex}");
    let single = said(folder.path(), (3, 26), "#define PETSC_USE_REAL_SINGLE 1\n");
    assert_eq!(single, "this PETSc is not built in double precision; --with-precision=double is needed");
    let old = said(folder.path(), (3, 17), "#define PETSC_USE_REAL_DOUBLE 1\n");
    assert_eq!(old, "this is PETSc 3.17; 3.18 or newer is needed");
    let without_library = said(folder.path(), (3, 18), "#define PETSC_USE_REAL_DOUBLE 1\n");
    assert!(without_library.ends_with("/libpetsc.so: PETSc must be built with shared libraries"), "{without_library}");
}

/// If PETSC_DIR is set, no other PETSc is used instead.
#[test]
fn a_folder_without_petsc_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let said = refusal(folder.path(), "");
    let path = folder.path().display();
    assert_eq!(said, format!("there is no PETSc at PETSC_DIR and PETSC_ARCH: {path} has no include/petscconf.h"));
}
