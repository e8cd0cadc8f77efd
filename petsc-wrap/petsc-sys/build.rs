//! Finds PETSc and MPI, refuses builds that cannot work, and generates the bindings.
//!
//! PETSc is not linked: its library and the hundred that this one needs are loaded when PETSc is first wanted. So a program starts without
//! them where it does not want PETSc, and can set its environment before OpenBLAS, one of them, starts threads.

use std::path::{Path, PathBuf};

use quote::quote;

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
    "KSPGetOperators",
    "KSPGetOperatorsSet",
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
    "MatAssembled",
    "MatAssemblyBegin",
    "MatAssemblyEnd",
    "MatCholeskyFactorSymbolic",
    "MatCopy",
    "MatCreate",
    "MatCreateMAIJ",
    "MatCreateSeqAIJWithArrays",
    "MatDuplicate",
    "MatFactorInfoInitialize",
    "MatGetDiagonal",
    "MatGetFactor",
    "MatGetFactorAvailable",
    "MatGetInfo",
    "MatGetLocalSize",
    "MatGetOwnershipRange",
    "MatGetOwnershipRanges",
    "MatGetOwnershipRangesColumn",
    "MatGetRow",
    "MatGetRowIJ",
    "MatGetSize",
    "MatGetTrace",
    "MatGetType",
    "MatInitializePackage",
    "MatMPIAIJGetSeqAIJ",
    "MatMPIAIJSetPreallocation",
    "MatMPIAIJSetPreallocationCSR",
    "MatMPISBAIJSetPreallocationCSR",
    "MatMult",
    "MatMumpsGetInfog",
    "MatMumpsGetRinfog",
    "MatMumpsSetIcntl",
    "MatNorm",
    "MatNullSpaceCreateRigidBody",
    "MatNullSpaceGetVecs",
    "MatRestoreRow",
    "MatSeqAIJGetArray",
    "MatSeqAIJRestoreArray",
    "MatSeqAIJSetPreallocation",
    "MatSeqSBAIJSetPreallocationCSR",
    "MatSetBlockSize",
    "MatSetNearNullSpace",
    "MatSetOption",
    "MatSetPreallocationCOO",
    "MatSetSizes",
    "MatSetType",
    "MatSetUp",
    "MatSetValues",
    "MatSolverTypeGet",
    "MatZeroEntries",
    "MatZeroRowsColumns",
    "PCFactorGetMatSolverType",
    "PCFactorGetMatrix",
    "PCFactorSetMatSolverType",
    "PCFactorSetUpMatSolverType",
    "PCGetFailedReason",
    "PCGetOperatorsSet",
    "PCGetType",
    "PCRedundantGetKSP",
    "PCSetType",
    "PCShellGetContext",
    "PCShellSetApply",
    "PCShellSetContext",
    "PCShellSetDestroy",
    "PetscErrorMessage",
    "PetscFinalize",
    "PetscGarbageCleanup",
    "PetscGetArgs",
    "PetscInitialize",
    "PetscObjectDelayedDestroy",
    "PetscObjectDestroy",
    "PetscObjectReference",
    "PetscOptionsClearValue",
    "PetscOptionsFindPair",
    "PetscOptionsGetAll",
    "PetscOptionsHasName",
    "PetscOptionsLeftGet",
    "PetscOptionsLeftRestore",
    "PetscOptionsSetValue",
    "PetscPartitionerSetFromOptions",
    "PetscPartitionerSetType",
    "PetscPushErrorHandler",
    "PetscErrorPrintfNone",
    "PetscSectionCreate",
    "PetscSectionGetChart",
    "PetscSectionGetConstrainedStorageSize",
    "PetscSectionGetDof",
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
    "SNESLineSearchShellSetApply",
    "SNESLineSearchShellSetUserFunc",
    "SNESSetFromOptions",
    "SNESSetFunction",
    "SNESSetFunctionDomainError",
    "SNESSetJacobian",
    "SNESSetLagPreconditioner",
    "SNESSetOptionsPrefix",
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
    "VecGetOwnershipRanges",
    "VecGetSize",
    "VecMAXPY",
    "VecMDot",
    "VecNorm",
    "VecPlaceArray",
    "VecPointwiseDivide",
    "VecPointwiseMult",
    "VecResetArray",
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

/// The oldest version that petsc-wrap is written for.
const OLDEST: (u32, u32) = (3, 18);

/// What bindgen calls the library with its functions.
const LIBRARY: &str = "Library";

/// Where PETSc is.
struct Petsc {
    include: Vec<PathBuf>,
    /// Where its library is, and what that is called.
    folder: PathBuf,
    name: String,
}

fn main() {
    println!("cargo::rerun-if-changed=wrapper.h");
    for name in ["PETSC_DIR", "PETSC_ARCH", "PKG_CONFIG_PATH", "MPICC", "MPI_PKG_CONFIG", "CRAY_MPICH_DIR"] {
        println!("cargo::rerun-if-env-changed={name}");
    }
    // Who sets PETSC_DIR means that PETSc and no other.
    let found = match std::env::var("PETSC_DIR") {
        Ok(dir) if !dir.is_empty() => in_folder(Path::new(&dir)),
        _ => from_pkg_config(),
    };
    let petsc = found.unwrap_or_else(|reason| fail(&reason));
    check_configuration(&petsc);
    println!("cargo::rustc-env=PETSC_LIBRARY={}", library(&petsc).display());
    let mpi =
        build_probe_mpi::probe().unwrap_or_else(|reasons| fail(&format!("MPI was not found: {}", listed(&reasons))));
    generate(&petsc, &mpi.include_paths);
}

/// PETSc's shared library, by the name that stays when it is updated.
fn library(petsc: &Petsc) -> PathBuf {
    let (major, minor) = version(petsc);
    let names = [format!("lib{}.so.{major}.{minor}", petsc.name), format!("lib{}.so", petsc.name)];
    let found = names.iter().map(|name| petsc.folder.join(name)).find(|library| library.exists());
    found.unwrap_or_else(|| {
        let library = petsc.folder.join(&names[1]);
        fail(&format!("there is no {}: PETSc must be built with shared libraries", library.display()))
    })
}

fn write(name: &str, text: &str) {
    let path = PathBuf::from(std::env::var("OUT_DIR").expect("cargo sets OUT_DIR")).join(name);
    std::fs::write(&path, text).unwrap_or_else(|error| fail(&format!("cannot write {}: {error}", path.display())));
}

/// A function for each method of the loaded library, by the same name.
fn functions(bindings: &str) -> String {
    let file = syn::parse_file(bindings).unwrap_or_else(|error| fail(&format!("the bindings are no Rust: {error}")));
    let methods = file.items.iter().filter_map(|item| match item {
        syn::Item::Impl(item) if item.self_ty == syn::parse_str(LIBRARY).expect("a type") => Some(&item.items),
        _ => None,
    });
    let of_petsc = methods.flatten().filter_map(|item| match item {
        // What makes the library has no library yet.
        syn::ImplItem::Fn(method) if method.sig.receiver().is_some() => Some(&method.sig),
        _ => None,
    });
    let function = |signature: &syn::Signature| {
        let (name, output) = (&signature.ident, &signature.output);
        let arguments: Vec<_> = signature.inputs.iter().skip(1).collect();
        let names = arguments.iter().filter_map(|argument| match argument {
            syn::FnArg::Typed(argument) => Some(&argument.pat),
            syn::FnArg::Receiver(_) => None,
        });
        quote! {
            #[inline]
            pub unsafe fn #name(#(#arguments),*) #output {
                unsafe { library().#name(#(#names),*) }
            }
        }
        .to_string()
    };
    of_petsc.map(|signature| function(signature) + "\n").collect()
}

/// PETSc where the user says it is: `PETSC_DIR`, and `PETSC_ARCH` for a build inside its source tree.
fn in_folder(dir: &Path) -> Result<Petsc, String> {
    let build = match std::env::var("PETSC_ARCH") {
        Ok(arch) if !arch.is_empty() => dir.join(arch),
        _ => dir.to_owned(),
    };
    let include = vec![dir.join("include"), build.join("include")];
    if !include.iter().any(|folder| folder.join("petscconf.h").is_file()) {
        return Err(format!(
            "there is no PETSc at PETSC_DIR and PETSC_ARCH: {} has no include/petscconf.h",
            build.display()
        ));
    }
    let folder = build.join("lib");
    // Debian's names tell its builds apart.
    let names = ["petsc", "petsc_real", "petsc64_real"];
    let name = names.into_iter().find(|name| folder.join(format!("lib{name}.so")).exists()).unwrap_or(names[0]);
    Ok(Petsc { include, folder, name: name.to_owned() })
}

fn from_pkg_config() -> Result<Petsc, String> {
    let mut reasons = vec!["PETSC_DIR is not set".to_owned()];
    for name in ["petsc", "PETSc"] {
        match pkg_config::Config::new().cargo_metadata(false).probe(name) {
            Ok(library) => return of_package(library),
            Err(error) => {
                let text = error.to_string();
                let line = text.lines().find(|l| !l.trim().is_empty()).unwrap_or_default();
                reasons.push(format!("pkg-config {name}: {}", line.trim()));
            }
        }
    }
    Err(format!("PETSc was not found. On Debian: apt-get install petsc-dev. Tried: {}", listed(&reasons)))
}

/// The library among those that pkg-config names whose name begins as PETSc's does.
fn of_package(package: pkg_config::Library) -> Result<Petsc, String> {
    let name = package.libs.into_iter().find(|name| name.starts_with("petsc"));
    let name = name.ok_or("pkg-config names no library of PETSc")?;
    let mut folders = package.link_paths.into_iter();
    let folder = folders.find(|folder| folder.join(format!("lib{name}.so")).exists());
    let folder = folder.ok_or_else(|| format!("lib{name}.so is in none of the folders that pkg-config names"))?;
    Ok(Petsc { include: package.include_paths, folder, name })
}

fn listed(reasons: &[impl ToString]) -> String {
    reasons.iter().map(|reason| format!("\n  - {}", reason.to_string())).collect()
}

/// Refuses versions and scalar types that the bindings do not describe.
fn check_configuration(petsc: &Petsc) {
    let (found, configuration) = (version(petsc), header(petsc, "petscconf.h"));
    if found < OLDEST {
        fail(&format!("this is PETSc {}.{}; {}.{} or newer is needed", found.0, found.1, OLDEST.0, OLDEST.1));
    }
    if defined(&configuration, "PETSC_USE_COMPLEX").is_some() {
        fail(
            "this PETSc is built with complex scalars; one with real scalars is needed: set PETSC_DIR and PETSC_ARCH to such a \
             build (on Debian, apt-get install petsc-dev and leave both unset)",
        );
    }
    if defined(&configuration, "PETSC_USE_REAL_DOUBLE").is_none() {
        fail("this PETSc is not built in double precision; --with-precision=double is needed");
    }
}

/// The text of one of PETSc's headers.
fn header(petsc: &Petsc, name: &str) -> String {
    let text = petsc.include.iter().find_map(|folder| std::fs::read_to_string(folder.join(name)).ok());
    text.unwrap_or_else(|| fail(&format!("{name} is not in PETSc's include folders")))
}

/// Major and minor version of PETSc.
fn version(petsc: &Petsc) -> (u32, u32) {
    let header = header(petsc, "petscversion.h");
    let number = |name: &str| {
        defined(&header, name)
            .and_then(|value| value.parse().ok())
            .unwrap_or_else(|| fail(&format!("petscversion.h does not define {name}")))
    };
    (number("PETSC_VERSION_MAJOR"), number("PETSC_VERSION_MINOR"))
}

/// The value of a macro of a header, empty where it has none.
fn defined<'a>(header: &'a str, name: &str) -> Option<&'a str> {
    header.lines().find_map(|line| {
        let mut words = line.split_whitespace();
        (words.next() == Some("#define") && words.next() == Some(name)).then(|| words.next().unwrap_or_default())
    })
}

fn generate(petsc: &Petsc, mpi: &[PathBuf]) {
    let include = petsc.include.iter().chain(mpi).map(|i| format!("-I{}", i.display()));
    let bindings = bindgen::Builder::default()
        .header("wrapper.h")
        .clang_args(include)
        .allowlist_function(FUNCTIONS.join("|"))
        .allowlist_var("PETSC_(DETERMINE|DEFAULT|COMM_WORLD|VERSION_.*)|PetscTrFree|PetscErrorPrintf")
        .blocklist_type("MPI_.*|ompi_.*|_?MPI.*")
        .blocklist_item("MPI_.*|ompi_.*")
        // Where PETSc is configured with strict error codes they are an enum, of the same size.
        .blocklist_type("PetscErrorCode")
        .raw_line("pub type PetscErrorCode = ::std::os::raw::c_int;")
        .allowlist_recursively(true)
        .raw_line("use mpi::ffi::*;")
        .default_enum_style(bindgen::EnumVariation::NewType { is_bitfield: false, is_global: false })
        .layout_tests(false)
        .dynamic_library_name(LIBRARY)
        .dynamic_link_require_all(true)
        .wrap_unsafe_ops(true)
        .generate_comments(false)
        .generate()
        .unwrap_or_else(|error| fail(&format!("bindgen failed on PETSc's headers: {error}")));
    let bindings = bindings.to_string();
    tell_changes(&bindings);
    write("bindings.rs", &bindings);
    write("functions.rs", &functions(&bindings));
}

/// Which of the things that PETSc has changed are the new ones: `src/versions.rs`.
fn tell_changes(bindings: &str) {
    let arguments = |name: &str| {
        let list = bindings.split(&format!("fn {name}(")).nth(1).and_then(|rest| rest.split(')').next());
        list.map_or(0, |list| list.matches(": ").count())
    };
    for (name, is_new) in [
        ("box_mesh_is_localized", arguments("DMPlexCreateBoxMesh") == 11),
        ("line_search_has_apply", arguments("SNESLineSearchShellSetApply") > 0),
        ("bool_is_of_c", bindings.contains("pub type PetscBool = bool;")),
    ] {
        println!("cargo::rustc-check-cfg=cfg({name})");
        if is_new {
            println!("cargo::rustc-cfg={name}");
        }
    }
}

fn fail(message: &str) -> ! {
    eprintln!("\n{message}\n");
    std::process::exit(1)
}
