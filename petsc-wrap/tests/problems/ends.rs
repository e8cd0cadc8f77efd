//! What is used before PETSc starts and after the session ends.

use petsc_wrap::mpi::traits::{Communicator, CommunicatorCollectives};
use petsc_wrap::{Factor, Session};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let session = Session::start(&[]).ok_or("MPI has been started before")??;
    // On one rank this is the first call of PETSc.
    assert!(Factor::Lu.is_known(&session, "petsc", "seqaij")?);
    let world = session.world();
    let (kept, rank) = (world.mpi().duplicate(), world.rank());
    drop(world);
    session.finish()?;
    kept.barrier();
    assert_eq!(kept.rank() as usize, rank);
    Ok(())
}
