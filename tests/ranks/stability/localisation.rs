//! The area on which a force acts: with a point force the solution has no limit as the mesh is refined, with a patch it
//! has one; and a patch smaller than the contact fails.

use mpi_test::{Test, tests};
use std::ops::ControlFlow;

use crate::glass::plate;
use crate::start::{run, start};
use petsc_wrap::{Comm, Session};
use ricochet::body::Body;
use ricochet::error::Error;
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;

/// On one rank: other tests show that the series are the same on several.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![point_and_patch, patch_below_the_contact];

/// Largest acceleration (m/s²) of the paper's impactor on its plate of 0.1 m, with a quarter model.
fn peak(comm: &Comm, body: &str, time: &str, contact: &str) -> f64 {
    let body = format!("size = [1.5, 1.5, 0.1]\nsymmetry = \"quarter\"\n{body}");
    let (_, mut impact) = start(comm, &plate(&body, time, &format!("[contact]\n{contact}\n")));
    let series = run(&mut impact);
    drop(impact);
    comm.collect_garbage().unwrap();
    let peak = series.iter().map(|step| step.impactor.acceleration).fold(0.0, f64::max);
    assert!(series.last().unwrap().impactor.acceleration < peak, "the run goes past the peak");
    peak
}

/// Under a point force the mesh has a compliance of 1/(E h) times a constant, with the cell size h: finer cells make
/// the body softer. With a patch, its radius replaces the cell size.
fn point_and_patch(session: &Session) {
    let world = session.world();
    // Edges of the cells at the impact point, mm.
    let meshes = [
        (37, "cells = [20, 20, 2]\ngrading = [3.5, 3.5, 1.0]"),
        (10, "cells = [24, 24, 3]\ngrading = [18.0, 18.0, 6.0]"),
        (5, "cells = [24, 24, 3]\ngrading = [45.0, 45.0, 14.5]"),
        (3, "cells = [24, 24, 3]\ngrading = [100.0, 100.0, 32.0]"),
    ];
    let [mut points, mut patches] = [vec![], vec![]];
    for (cell, body) in meshes {
        let point = peak(&world, body, "end = 2.4e-3\nstep = 4e-5", "localization = \"point\"");
        points.push(point);
        if (5..=10).contains(&cell) {
            patches.push(peak(&world, body, "end = 8e-4\nstep = 1e-5", "patch_radius = 0.025"));
        }
        println!("cells of {cell} mm: {point:.1} m/s² under a point, patches of 25 mm so far {patches:.1?}");
    }
    assert!(points.windows(2).all(|pair| pair[1] < 0.9 * pair[0]), "no limit: {points:?}");
    assert!(points[2] < 0.8 * points[0], "{points:?}");
    // Relative to the converged 2002.7 m/s² of independent computations.
    assert!(patches.iter().all(|peak| (peak / 2002.7 - 1.0).abs() < 5e-3), "{patches:?}");
}

/// A small plate with its bottom clamped, under the paper's impactor.
fn held(radius: f64) -> String {
    let held = "[[support]]\nsurface = \"bottom\"\nkind = \"clamped\"\n";
    let contact = format!("[contact]\npatch_radius = {radius:e}\n");
    // Cells of 2 mm at the impact point.
    let body = "size = [0.1, 0.1, 0.02]\ncells = [16, 16, 3]\ngrading = [6.0, 6.0, 3.0]";
    plate(body, "end = 1e-3\nstep = 1e-5", &format!("{held}{contact}"))
}

/// For patch radii below 1.2 (E*/E') times the contact's radius the stiffness of the law is negative. If the plate is
/// soft at its first contact, this can be predicted, and smaller radii are refused. If the support stiffens the plate
/// later, the run detects it.
fn patch_below_the_contact(session: &Session) {
    let world = session.world();
    let solid = |radius: f64| {
        let (scene, _) = Scene::parse("test", &held(radius), &[]).unwrap_or_else(|error| panic!("{error}"));
        let mesh = Mesh::new(&world, &scene.body).unwrap();
        Body::solid(&scene, &mesh)
    };
    let limit = solid(0.02).unwrap().terms.contact.footprint.patch().unwrap().limit_radius;
    let Err(error) = solid(0.3 * limit) else { panic!("{:e} m is accepted", 0.3 * limit) };
    assert_eq!(error.status(), 2, "{error}");
    assert!(matches!(&error, Error::Fault(fault) if fault.key == "contact.patch_radius"), "{error}");
    println!("patch of {:.2} mm: {error}", 300.0 * limit);

    // A wider disc is an option for plates only, not for a mesh.
    let text = held(0.02).replace("patch_radius", "disc_radius");
    let (scene, _) = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let Err(error) = Body::solid(&scene, &Mesh::new(&world, &scene.body).unwrap()) else { panic!("a disc on a mesh") };
    assert!(matches!(&error, Error::Fault(fault) if fault.key == "contact.disc_radius"), "{error}");

    let (_, mut impact) = start(&world, &held(0.7 * limit));
    let mut last = None;
    let error = impact
        .run(|step| {
            last = Some(*step);
            Ok(ControlFlow::Continue(()))
        })
        .expect_err("the contact grows as wide as the patch");
    let last = last.unwrap();
    println!("patch of {:.2} mm: {error}", 700.0 * limit);
    assert!(matches!(error, Error::Solve(_)) && error.status() == 3, "{error:?}");
    let message = error.to_string();
    for part in [&format!("step {}", last.number + 1), "stiffness would turn negative", "contact.patch_radius"] {
        assert!(message.contains(part), "{part:?} is not in: {message}");
    }
    // The time steps before are within the law, and there was contact.
    assert!(last.contact.force > 0.0 && last.energy.total.is_finite());

    // The margin of a radius that the program chooses.
    let (_, mut impact) = start(&world, &held(1.25 * limit));
    let series = run(&mut impact);
    let largest = series.iter().map(|step| step.contact.force).fold(0.0, f64::max);
    println!("patch of {:.2} mm: holds, {largest:.3e} N", 1250.0 * limit);
    assert!(largest > last.contact.force, "the run goes beyond the place where the small patch failed");
    assert!(series.iter().all(|step| (step.energy.total / series[0].energy.total - 1.0).abs() < 1e-2));
}
