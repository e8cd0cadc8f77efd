//! Finds PETSc and MPI, refuses builds that cannot work, and generates the bindings.

use std::path::{Path, PathBuf};

/// The functions that petsc-wrap calls; everything else stays out of the bindings.
const FUNCTIONS: &[&str] = &[
    "DMCreateLabel",
    "DMGetCoordinateSection",
    "DMGetCoordinatesLocal",
    "DMGetDimension",
    "DMGetGlobalSection",
    "DMGetLabel",
    "DMGetLabelValue",
    "DMLabelStratumHasPoint",
    "DMPlexCreateBoxMesh",
    "DMPlexCreateGmshFromFile",
    "DMPlexDistribute",
    "DMPlexGetCellType",
    "DMPlexGetChart",
    "DMPlexGetCone",
    "DMPlexGetConeSize",
    "DMPlexGetDepthStratum",
    "DMPlexGetPartitioner",
    "DMPlexGetTransitiveClosure",
    "DMPlexMarkBoundaryFaces",
    "DMPlexRestoreTransitiveClosure",
    "DMSetLocalSection",
    "ISCreateGeneral",
    "KSPCreate",
    "KSPGetConvergedReason",
    "KSPGetConvergedReasonString",
    "KSPGetIterationNumber",
    "KSPGetPC",
    "KSPGetResidualNorm",
    "KSPGetType",
    "KSPSetFromOptions",
    "KSPSetInitialGuessNonzero",
    "KSPSetNormType",
    "KSPSetOperators",
    "KSPSetOptionsPrefix",
    "KSPSetTolerances",
    "KSPSetType",
    "KSPSolve",
    "MatAXPY",
    "MatAssemblyBegin",
    "MatAssemblyEnd",
    "MatCholeskyFactorSymbolic",
    "MatCopy",
    "MatCreate",
    "MatCreateMAIJ",
    "MatDuplicate",
    "MatFactorInfoInitialize",
    "MatGetDiagonal",
    "MatGetFactor",
    "MatGetFactorAvailable",
    "MatGetInfo",
    "MatCreateSeqAIJWithArrays",
    "MatGetLocalSize",
    "MatGetOwnershipRange",
    "MatGetRow",
    "MatGetSize",
    "MatGetTrace",
    "MatMPIAIJSetPreallocation",
    "MatMPIAIJSetPreallocationCSR",
    "MatMPISBAIJSetPreallocationCSR",
    "MatMult",
    "MatMumpsGetInfog",
    "MatMumpsGetRinfog",
    "MatNorm",
    "MatNullSpaceCreateRigidBody",
    "MatRestoreRow",
    "MatSeqAIJGetArray",
    "MatSeqAIJRestoreArray",
    "MatSeqAIJSetPreallocation",
    "MatSeqSBAIJSetPreallocationCSR",
    "MatSetBlockSize",
    "MatSetNearNullSpace",
    "MatSetPreallocationCOO",
    "MatZeroEntries",
    "MatSetOption",
    "MatSetSizes",
    "MatSetType",
    "MatSetUp",
    "MatSetValues",
    "MatZeroRowsColumns",
    "PCFactorSetMatSolverType",
    "PCGetFailedReason",
    "PCGetType",
    "PCSetType",
    "PetscErrorMessage",
    "PetscFinalize",
    "PetscGarbageCleanup",
    "PetscInitialize",
    "PetscObjectDelayedDestroy",
    "PetscObjectDestroy",
    "PetscObjectReference",
    "PetscOptionsClearValue",
    "PetscOptionsGetAll",
    "PetscOptionsHasName",
    "PetscOptionsLeftGet",
    "PetscOptionsLeftRestore",
    "PetscOptionsSetValue",
    "PetscPartitionerSetFromOptions",
    "PetscPushErrorHandler",
    "PetscSectionCreate",
    "PetscSectionGetConstrainedStorageSize",
    "PetscSectionGetOffset",
    "PetscSectionSetChart",
    "PetscSectionSetDof",
    "PetscSectionSetUp",
    "SNESComputeFunction",
    "SNESCreate",
    "SNESGetConvergedReason",
    "SNESGetConvergedReasonString",
    "SNESGetFunctionNorm",
    "SNESGetIterationNumber",
    "SNESGetKSP",
    "SNESGetLineSearch",
    "SNESGetTolerances",
    "SNESLineSearchGetSNES",
    "SNESLineSearchGetVecs",
    "SNESLineSearchSetLambda",
    "SNESLineSearchSetNorms",
    "SNESLineSearchSetReason",
    "SNESLineSearchSetType",
    "SNESLineSearchShellSetUserFunc",
    "SNESSetFromOptions",
    "SNESSetFunction",
    "SNESSetFunctionDomainError",
    "SNESSetJacobian",
    "SNESSetLagPreconditioner",
    "SNESSetTolerances",
    "SNESSetType",
    "SNESSolve",
    "VecAXPY",
    "VecAYPX",
    "VecAssemblyBegin",
    "VecAssemblyEnd",
    "VecCopy",
    "VecCreate",
    "VecDot",
    "VecDuplicate",
    "VecGetArray",
    "VecGetArrayRead",
    "VecGetLocalSize",
    "VecGetOwnershipRange",
    "VecGetSize",
    "VecMAXPY",
    "VecMDot",
    "VecNorm",
    "VecPointwiseDivide",
    "VecPointwiseMult",
    "VecRestoreArray",
    "VecRestoreArrayRead",
    "VecScale",
    "VecScatterBegin",
    "VecScatterCreate",
    "VecScatterEnd",
    "VecSet",
    "VecSetBlockSize",
    "VecSetSizes",
    "VecSetType",
    "VecSetValues",
];

/// What PETSc's headers and library need on the command lines.
struct Petsc {
    include: Vec<PathBuf>,
}

fn main() {
    println!("cargo::rerun-if-changed=wrapper.h");
    for name in ["PETSC_DIR", "PETSC_ARCH", "PKG_CONFIG_PATH"] {
        println!("cargo::rerun-if-env-changed={name}");
    }
    let mut reasons = Vec::new();
    let Some(petsc) = from_env(&mut reasons).or_else(|| from_pkg_config(&mut reasons)) else {
        fail(&format!(
            "PETSc was not found. On Debian: apt-get install petsc-dev. Tried:\n  - {}",
            reasons.join("\n  - ")
        ));
    };
    check_configuration(&petsc);
    generate(&petsc, &mpi_include());
}

/// PETSc where the user says it is: `PETSC_DIR`, and `PETSC_ARCH` for a build inside its source tree.
fn from_env(reasons: &mut Vec<String>) -> Option<Petsc> {
    let Ok(dir) = std::env::var("PETSC_DIR") else {
        reasons.push("PETSC_DIR is not set".to_owned());
        return None;
    };
    let dir = PathBuf::from(dir);
    let build = match std::env::var("PETSC_ARCH") {
        Ok(arch) if !arch.is_empty() => dir.join(arch),
        _ => dir.clone(),
    };
    let include = vec![dir.join("include"), build.join("include")];
    if !include.iter().any(|i| i.join("petscconf.h").is_file()) {
        reasons.push(format!("no petscconf.h under {} (from PETSC_DIR, PETSC_ARCH)", build.display()));
        return None;
    }
    let lib = build.join("lib");
    let Some(name) = ["petsc", "petsc_real"].into_iter().find(|name| lib.join(format!("lib{name}.so")).exists()) else {
        reasons.push(format!("no libpetsc.so in {}", lib.display()));
        return None;
    };
    println!("cargo::rustc-link-search=native={}", lib.display());
    println!("cargo::rustc-link-lib=dylib={name}");
    Some(Petsc { include })
}

fn from_pkg_config(reasons: &mut Vec<String>) -> Option<Petsc> {
    for name in ["petsc", "PETSc"] {
        match pkg_config::Config::new().probe(name) {
            Ok(library) => {
                return Some(Petsc { include: library.include_paths });
            }
            Err(error) => {
                let text = error.to_string();
                let line = text.lines().find(|l| !l.trim().is_empty()).unwrap_or_default();
                reasons.push(format!("pkg-config {name}: {}", line.trim()));
            }
        }
    }
    None
}

/// Include folders of the MPI that PETSc's headers include.
fn mpi_include() -> Vec<PathBuf> {
    ["ompi-c", "mpi-c", "mpich", "ompi", "mpi"]
        .into_iter()
        .find_map(|name| pkg_config::Config::new().cargo_metadata(false).probe(name).ok())
        .map(|library| library.include_paths)
        .unwrap_or_default()
}

/// Refuses scalar types that the bindings do not describe.
fn check_configuration(petsc: &Petsc) {
    let text = petsc
        .include
        .iter()
        .find_map(|i| std::fs::read_to_string(i.join("petscconf.h")).ok())
        .unwrap_or_else(|| fail("petscconf.h is not in PETSc's include folders"));
    let defined = |name: &str| {
        text.lines().any(|l| {
            let mut words = l.split_whitespace();
            words.next() == Some("#define") && words.next() == Some(name)
        })
    };
    if defined("PETSC_USE_COMPLEX") {
        fail("this PETSc is built with complex scalars; ricochet needs real ones (Debian: libpetsc-real-dev)");
    }
    if !defined("PETSC_USE_REAL_DOUBLE") {
        fail("this PETSc is not built in double precision; ricochet needs --with-precision=double");
    }
}

fn generate(petsc: &Petsc, mpi: &[PathBuf]) {
    let include = petsc.include.iter().chain(mpi).map(|i| format!("-I{}", i.display()));
    let bindings = bindgen::Builder::default()
        .header("wrapper.h")
        .clang_args(include)
        .allowlist_function(FUNCTIONS.join("|"))
        .allowlist_var("PETSC_(DETERMINE|DEFAULT|COMM_WORLD|VERSION_.*)|PetscTrFree")
        .blocklist_type("MPI_.*|ompi_.*|_?MPI.*")
        .blocklist_item("MPI_.*|ompi_.*")
        .allowlist_recursively(true)
        .raw_line("use mpi::ffi::*;")
        .default_enum_style(bindgen::EnumVariation::NewType { is_bitfield: false, is_global: false })
        .layout_tests(false)
        .generate_comments(false)
        .generate()
        .unwrap_or_else(|error| fail(&format!("bindgen failed on PETSc's headers: {error}")));
    let out = PathBuf::from(std::env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    bindings
        .write_to_file(Path::new(&out).join("bindings.rs"))
        .unwrap_or_else(|error| fail(&format!("cannot write the bindings: {error}")));
}

fn fail(message: &str) -> ! {
    eprintln!("\n{message}\n");
    std::process::exit(1)
}
