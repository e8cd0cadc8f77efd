//! Section of a report with the origin and the cost of the result.

use super::data::Data;
use super::number::{TIME, computed, date};
use super::page::{Block, Fact, Section};

/// Makes the section.
pub fn section(data: &Data) -> Section {
    let (provenance, cost) = (&data.provenance, &data.cost);
    let origin = &provenance.origin;
    let options = if origin.petsc_options.is_empty() { "none" } else { &origin.petsc_options };
    let mut rows = vec![
        Fact::new("Result", &data.file),
        Fact::new("Last written", data.written.map_or("not known".to_owned(), date)),
        Fact::new("Run", format!("{:016x}", provenance.run_id)),
        Fact::new("State", if data.is_complete { "complete" } else { "not complete: the run did not reach its end" }),
        Fact::new("Program", format!("ricochet {}, commit {}", origin.version, origin.commit)),
        Fact::new("PETSc", &origin.petsc_version),
        Fact::new("Options for PETSc", options),
        Fact::new("MPI ranks", origin.ranks.to_string()),
    ];
    if let Some(digest) = &provenance.mesh_digest {
        rows.push(Fact::new("Digest of the mesh file", digest));
    }
    if cost.total.is_finite() {
        let [total, model, setup, steps] =
            [cost.total, cost.model, cost.setup, cost.steps].map(|time| computed(time, TIME));
        rows.push(Fact::new("Wall time", format!("{total} (model {model}, setup {setup}, steps {steps})")));
        rows.push(Fact::new("Solves", format!("{}, with {} Newton iterations", cost.solves, cost.newton_iterations)));
    }
    let again = format!("ricochet run {} -o again.h5 computes the same scene again.", data.file);
    let parts = vec![Block::Facts { caption: "Origin of the result", rows }, Block::Text(again)];
    Section { id: "origin", title: "Provenance", parts }
}
