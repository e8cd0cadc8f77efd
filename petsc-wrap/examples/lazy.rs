//! A session that starts without PETSc: on one rank PETSc is loaded with the first object that needs it.
//!
//!     cargo run --example lazy

use petsc_wrap::{Session, Vector};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let session = Session::start(&[]).ok_or("MPI has been started before")??;
    let world = session.world();
    // Several ranks always start PETSc together, as PETSc requires.
    let waits = world.size() == 1 && std::env::var_os("PETSC_OPTIONS").is_none();
    assert_eq!(is_loaded()?, !waits);

    let mut x = Vector::new(&world, 3)?;
    x.write()?.fill(1.0);
    assert_eq!(x.norm_max()?, 1.0);
    assert!(is_loaded()?);
    Ok(())
}

/// Whether PETSc's library is loaded in this process, according to Linux.
fn is_loaded() -> std::io::Result<bool> {
    Ok(std::fs::read_to_string("/proc/self/maps")?.contains("/libpetsc"))
}
