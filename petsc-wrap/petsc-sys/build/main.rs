//! Finds PETSc and MPI, refuses builds that cannot work, and generates the bindings.
//!
//! PETSc is not linked: its library and the hundred libraries that it needs are loaded when PETSc is first used. So a
//! program that does not use PETSc starts without them. A program can also set its environment before OpenBLAS, one of
//! these libraries, starts threads.

mod bindings;
mod functions;
mod petsc;

use petsc::Petsc;

fn main() {
    println!("cargo::rerun-if-changed=wrapper.h");
    for name in ["PETSC_DIR", "PETSC_ARCH", "PKG_CONFIG_PATH", "MPICC", "MPI_PKG_CONFIG", "CRAY_MPICH_DIR"] {
        println!("cargo::rerun-if-env-changed={name}");
    }
    let petsc = Petsc::find().unwrap_or_else(|reason| fail(&reason));
    petsc.check_configuration();
    println!("cargo::rustc-env=PETSC_LIBRARY={}", petsc.library().display());
    let mpi =
        build_probe_mpi::probe().unwrap_or_else(|reasons| fail(&format!("MPI was not found: {}", listed(&reasons))));
    bindings::generate(&petsc, &mpi.include_paths);
}

fn listed(reasons: &[impl ToString]) -> String {
    reasons.iter().map(|reason| format!("\n  - {}", reason.to_string())).collect()
}

fn fail(message: &str) -> ! {
    eprintln!("\n{message}\n");
    std::process::exit(1)
}
