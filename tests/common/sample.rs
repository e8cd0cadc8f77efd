//! A series computed from the step number, for the tests of results and of figures.

use ricochet::impact::step::{Contact, Energy, Motion, Step};
use ricochet::record::provenance::{Cost, Origin, Provenance};

/// Costs of such a run.
pub const COST: Cost = Cost {
    model: 0.125,
    setup: 0.25,
    steps: 1.5,
    total: 2.0,
    newton_iterations: 42,
    solves: 21,
    error_estimate: 1e-3,
    deflection_error_estimate: 2e-3,
};

/// Number of time steps in half a contact, and in the gap after it.
pub const HALF_PERIOD: usize = 2000;

/// Mass of the impactor, kg.
const MASS: f64 = 2e-3;

/// A time step whose values all follow from its number. The first half of [`HALF_PERIOD`] is in contact.
pub fn step(number: usize) -> Step {
    let t = number as f64;
    let alpha = (t / HALF_PERIOD as f64 * std::f64::consts::PI).cos();
    let phase = t / HALF_PERIOD as f64 * std::f64::consts::PI;
    // ∫ cos over all contacts so far, which determines how much the impactor has slowed down.
    let contacts = ((phase / std::f64::consts::PI + 0.5) / 2.0).floor();
    let rest = (phase - 2.0 * std::f64::consts::PI * contacts).min(0.5 * std::f64::consts::PI);
    let impulse = 1e-5 * HALF_PERIOD as f64 / std::f64::consts::PI * (2.0 * contacts + rest.sin());
    let rate = -phase.sin() * std::f64::consts::PI / (1e-5 * HALF_PERIOD as f64);
    Step {
        number,
        time: 1e-5 * t,
        impactor: Motion { position: t + 0.01, velocity: 1.0 - impulse / MASS, acceleration: alpha.max(0.0) / MASS },
        contact: Contact {
            force: alpha.max(0.0),
            indentation: alpha,
            surface_displacement: t + 0.04,
            approach: alpha,
            rate,
            impulse,
        },
        energy: Energy {
            kinetic: t + 0.05,
            elastic: t + 0.06,
            support: t + 0.07,
            impactor: t + 0.08,
            contact: t + 0.09,
            dissipated: t + 0.10,
            external: t + 0.11,
            numerical: t + 0.115,
            total: t + 0.12,
        },
    }
}

/// Provenance of a result of such steps. Its scene is longer than the 64 KiB that HDF5 allows for a plain attribute.
pub fn provenance(title: &str, planned_rows: Option<usize>) -> Provenance {
    Provenance {
        run_id: 0x0123_4567_89ab_cdef,
        origin: Origin {
            title: title.into(),
            scene: "title = \"Δt\"\n".repeat(10_000),
            version: "0.1.0".into(),
            commit: "0123456789ab".into(),
            petsc_version: "3.18.5".into(),
            petsc_options: String::new(),
            ranks: 2,
        },
        folder: "/scenes".into(),
        mesh_digest: Some("0123456789abcdef".into()),
        model: "solid".into(),
        model_details: None,
        reduction: "none".into(),
        unknowns: 4711,
        impactor_mass: MASS,
        planned_rows,
        warnings: "warning: one\nnote: another".into(),
    }
}
