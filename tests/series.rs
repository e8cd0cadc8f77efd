//! The result file: what is written can be read, whatever happens to the process in between.

use hdf5_metno as hdf5;
use ricochet::impact::step::{Contact, Energy, Motion, Step};
use ricochet::record::provenance::Provenance;
use ricochet::record::series::SeriesWriter;
use std::path::Path;

/// A step whose values all follow from its number, with a contact in every other hundred steps, the first halved.
fn step(number: usize) -> Step {
    let t = number as f64;
    let alpha = (t / 100.0 * std::f64::consts::PI).cos();
    Step {
        number,
        time: 1e-5 * t,
        impactor: Motion {
            position: t + 0.01,
            velocity: t + 0.02,
            acceleration: t + 0.03,
        },
        contact: Contact {
            force: alpha.max(0.0),
            indentation: alpha,
            surface_displacement: t + 0.04,
        },
        energy: Energy {
            kinetic: t + 0.05,
            elastic: t + 0.06,
            support: t + 0.07,
            impactor: t + 0.08,
            contact: t + 0.09,
            dissipated: t + 0.10,
            external: t + 0.11,
            total: t + 0.12,
        },
    }
}

fn provenance(planned_rows: Option<usize>) -> Provenance {
    Provenance {
        title: "Plate h = 0,1 m, ν = 0,23".into(),
        scene: "title = \"x\"\n".repeat(10_000),
        version: "0.1.0".into(),
        commit: "abc".into(),
        petsc_version: "3.18.5".into(),
        petsc_options: String::new(),
        ranks: 2,
        model: "solid".into(),
        reduction: "none".into(),
        unknowns: 4711,
        error_estimate: Some(1e-3),
        planned_rows,
    }
}

/// Not a test of its own: what the kill test starts as a child.
#[test]
fn child_pushes_steps() {
    let Ok(args) = std::env::var("RICOCHET_TEST_CHILD") else {
        return;
    };
    let mut args = args.split('|');
    let path = args.next().unwrap();
    let planned = args.next().unwrap().parse().ok();
    let rows: usize = args.next().unwrap().parse().unwrap();
    let every: usize = args.next().unwrap().parse().unwrap();
    let mut writer = SeriesWriter::create(Path::new(path), &provenance(planned)).unwrap();
    for n in 0..rows {
        writer.push(&step(n)).unwrap();
        if n % every == 0 {
            writer.flush().unwrap();
        }
    }
    writer.finish(&[("steps", 1.0)]).unwrap();
    let _ = hdf5::File::open(path);
}
