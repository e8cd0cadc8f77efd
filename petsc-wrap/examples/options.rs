//! PETSc's options: given at the start, set later, read by a solver with its prefix; and the list of options that were
//! never read.
//!
//!     cargo run --example options

use petsc_wrap::{Ksp, Session, options};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words = ["-mine_ksp_type", "gmres", "-misspelt_ksp_tpye", "cg"].map(String::from);
    let session = Session::start(&words).ok_or("MPI has been started before")??;

    let mut solver = Ksp::new(&session.world())?;
    solver.set_options_prefix("mine_")?;
    solver.set_from_options()?;
    assert_eq!(solver.type_name()?, "gmres");

    options::set(&session, "-mine_ksp_type", "minres")?;
    solver.set_from_options()?;
    assert_eq!(solver.type_name()?, "minres");

    options::clear(&session, "-mine_ksp_type")?;
    assert_eq!(options::get(&session, "-mine_ksp_type")?, None);

    let unused = options::unused(&session)?;
    assert!(unused.contains(&"misspelt_ksp_tpye".to_owned()), "{unused:?}");
    if session.world().is_root() {
        println!("nobody has read: {unused:?}");
    }
    Ok(())
}
