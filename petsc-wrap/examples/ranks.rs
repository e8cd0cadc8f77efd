//! A vector on all ranks: each rank writes its own part, may add to any entry and fetch any entry. Norms are of the
//! whole vector.
//!
//!     mpirun -n 2 cargo run --example ranks

use petsc_wrap::{Gather, Insert, Int, Session, Vector};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let session = Session::start(&[]).ok_or("MPI has been started before")??;
    let world = session.world();
    let (rank, size) = (world.rank(), world.size());

    // Rank r has r + 1 entries.
    let mut x = Vector::new(&world, rank + 1)?;
    assert_eq!(x.len(), size * (size + 1) / 2);
    x.write()?.fill(1.0);
    // Every rank adds its number to the last entry, which belongs to the last rank.
    let last = x.len() as Int - 1;
    x.assemble()?;
    x.set_values(&[last], &[rank as f64], Insert::Add)?;
    x.assemble()?;
    let expected = 1.0 + (size * (size - 1) / 2) as f64;
    assert_eq!(x.norm_max()?, expected);

    // Every rank fetches the last entry and the first.
    let mut gather = Gather::new(&x, &[last, 0])?;
    let fetched = gather.fetch(&x)?.to_vec();
    assert_eq!(fetched, [expected, if size == 1 { expected } else { 1.0 }]);

    // Concatenated lists of all ranks.
    assert_eq!(world.all_gather(&[rank as Int]), (0..size as Int).collect::<Vec<_>>());
    if world.is_root() {
        println!("{} entries on {size} rank(s), the last one {}", x.len(), fetched[0]);
    }

    // One rank may drop a handle while others keep theirs. Objects that all ranks have dropped are destroyed here, or
    // at the end.
    drop(x);
    world.collect_garbage()?;
    Ok(())
}
