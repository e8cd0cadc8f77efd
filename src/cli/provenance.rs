//! Origin of a result, as stored with it.

use std::path::Path;

use petsc_wrap::{Comm, options, petsc_version};

use crate::error::Result;
use crate::model::Model;
use crate::record::provenance::{ModelDetails, Origin, Provenance, new_run_id};
use crate::scene::{Measure, Scene, Source};

use super::load::mesh_digest;
use super::notes::listed;

/// Scene and program of a result that this program computes.
///
/// # Errors
/// If a PETSc call fails.
pub fn origin(comm: &Comm, scene: &Scene, source: &Source) -> Result<Origin> {
    Ok(Origin {
        title: scene.title.clone(),
        scene: source.text().to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        commit: env!("RICOCHET_COMMIT").to_owned(),
        petsc_version: petsc_version(),
        petsc_options: options::all(comm.session())?,
        ranks: comm.size(),
    })
}

/// Provenance of a run of a scene by this program. The caller gives the name of the theory, the description of the
/// reduction, and the number of unknowns without the impactor's.
///
/// # Errors
/// If a PETSc call fails.
pub fn provenance(
    comm: &Comm,
    scene: &Scene,
    source: &Source,
    (model, reduction, unknowns): (&str, String, usize),
) -> Result<Provenance> {
    Ok(Provenance {
        run_id: new_run_id(),
        origin: origin(comm, scene, source)?,
        // Relative to the current folder: a scene file in the current folder has an empty folder name.
        folder: std::path::absolute(Path::new(".").join(source.folder()).join(""))
            .map(|path| path.display().to_string())
            .unwrap_or_default(),
        mesh_digest: mesh_digest(scene),
        model: model.to_owned(),
        model_details: None,
        reduction,
        unknowns: unknowns + 1,
        impactor_mass: scene.impactor.mass,
        planned_rows: None,
        warnings: String::new(),
    })
}

/// Description of a model for a report.
pub fn model_details(model: &Model) -> ModelDetails {
    let estimate = model.error_before_steps();
    ModelDetails {
        discretisation: model.discretisation.clone(),
        reason: model.reason.clone().unwrap_or_default(),
        error_causes: listed(&estimate.causes(Measure::Acceleration)),
        first_contact_error: estimate.total().map_or(f64::NAN, |errors| errors.first_contact),
    }
}
