//! Bodies at many temperatures, interpolated between a few: comparison with the body at the temperature itself, on one
//! rank and on several.

use mpi_test::{Test, tests};
use petsc_wrap::{Comm, Session};
use ricochet::impact::ModalImpact;
use ricochet::model::watch::Unwatched;
use ricochet::scene::Scene;
use ricochet::study::sweep::{Interpolated, Start};

use crate::modelled::parse;

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![what_is_interpolated_is_within_its_part_of_the_estimate];

/// Temperatures of the bodies, °C.
fn temperatures() -> Vec<f64> {
    (0..24).map(|n| 2.0 * f64::from(n)).collect()
}

/// A small pane at a temperature (°C), with its size and its impact.
fn pane(impact: &Case, temperature: f64) -> Scene {
    let Case { edge, mass, speed, end } = impact;
    let glass = "[[body.layer]]\nthickness = 0.005\nmaterial = \"glass\"\n";
    parse(&format!(
        "title = \"Laminate\"\n[body]\nsize = [{edge}, {edge}]\nmodel = \"layerwise\"\ntemperature = {temperature:e}\n{glass}\
         [[body.layer]]\nthickness = 0.00076\nmaterial = \"interlayer\"\n{glass}\
         [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
         [material.interlayer]\nbulk = 2e9\ndensity = 1100.0\nshear = 3e6\n\
         prony = [{{ modulus = 6.9e6, time = 1e-5 }}, {{ modulus = 3.9e6, time = 1e-4 }}, {{ modulus = 2.3e6, time = 1e-3 }}]\n\
         wlf = {{ c1 = 20.7, c2 = 91.1, reference = 20.0 }}\n\
         [impactor]\nmass = {mass}\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = {speed}\n\
         [time]\nend = {end:e}\n[accuracy]\ntolerance = 2e-2\n"
    ))
}

fn interpolated(ranks: &Comm, impact: &Case) -> Interpolated {
    let scene_of = |temperature: f64| Ok(pane(impact, temperature));
    let alone = ranks.session().alone();
    let (values, watch) = (temperatures(), &Unwatched(&alone));
    let start = Start::new(ranks, &values, &scene_of, watch).unwrap().expect("a common basis");
    Interpolated::new(ranks, &values, &scene_of, start, watch).unwrap().expect("few bodies")
}

/// A pane with its impact.
struct Case {
    /// Length of the pane's edges, m.
    edge: f64,
    /// Mass of the impactor, kg.
    mass: f64,
    /// Speed of the impactor, m/s.
    speed: f64,
    /// End of the run, s.
    end: f64,
}

/// The second contact is slow: the directions with large weights alone are not an accurate common basis.
const CASES: [Case; 2] =
    [Case { edge: 0.3, mass: 2.0, speed: 1.0, end: 6e-4 }, Case { edge: 0.2, mass: 5.0, speed: 0.1, end: 2e-3 }];

/// At temperatures between the computed bodies, the force is compared with the force for the body there, on the same
/// basis. The difference is within the interpolation's estimate, and is not negligible compared with it. A single rank
/// gives the same result to the last digit.
fn what_is_interpolated_is_within_its_part_of_the_estimate(session: &Session) {
    let (ranks, alone) = (session.world(), session.alone());
    for impact in &CASES {
        is_within_its_part_of_the_estimate([&ranks, &alone], impact);
    }
}

fn is_within_its_part_of_the_estimate([ranks, alone]: [&Comm; 2], impact: &Case) {
    let watch = &Unwatched(alone);
    let [together, by_itself] = [ranks, alone].map(|ranks| interpolated(ranks, impact));
    let mut largest = 0.0_f64;
    for temperature in temperatures() {
        let scene = pane(impact, temperature);
        let peaks = [&together, &by_itself].map(|of| {
            let (body, ..) = of.at(temperature, &scene).unwrap().expect("within the range");
            ModalImpact::new(&scene, &body).trace(None).unwrap().0.peak()
        });
        assert_eq!(peaks[0].to_bits(), peaks[1].to_bits(), "{temperature} °C: {peaks:?}");
        let found = together.difference_at(temperature, &scene, watch).unwrap();
        let estimate = together.error_at(temperature).expect("within the range");
        println!("  {temperature} °C: {:.1e} of {:.1e}", found.first_contact, estimate.first_contact);
        // (At a computed body the part neglected by its reduced response remains.)
        assert!(found.first_contact <= estimate.first_contact + 1e-3, "{temperature} °C: {found:?} {estimate:?}");
        largest = largest.max(found.first_contact);
    }
    assert!(largest > 1e-6, "{largest:e}");
}
