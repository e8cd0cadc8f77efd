//! The energy balance of every time integration scheme, to rounding.

use crate::glass;
use mpi_test::{Test, tests};

use crate::glass::{plate, scene, sides};
use crate::start::{run, start};
use petsc_wrap::Session;
use ricochet::contact::hertz;
use ricochet::impact::step::Step;
use ricochet::record::episodes::Episodes;

/// On one rank: other tests show that the series are the same on several.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![
    the_energy_scheme_keeps_the_total,
    the_energy_scheme_balances_dampers_and_pads,
    the_ledger_closes_for_every_scheme
];

/// The paper's plate of 0.04 m with a coarse mesh: conservation does not depend on the mesh.
const PLATE: &str = "size = [1.5, 1.5, 0.04]\ncells = [8, 8, 1]\ngrading = [6, 6, 1]";

/// Tolerance for rounding, as a fraction of the initial energy: noise in K u of up to 5e-10 was seen, and no drift.
const ROUNDING: f64 = 1e-9;

/// Contact time of the paper's impactor on a half-space, s.
fn contact_time() -> f64 {
    let stiffness = hertz::stiffness(0.05, (70e9, 0.23), (210e9, 0.3));
    hertz::contact_time(stiffness, glass::MASS, 1.0)
}

/// Number of contact episodes.
fn episodes(series: &[Step]) -> usize {
    let mut episodes = Episodes::default();
    series.iter().for_each(|step| episodes.push(step));
    episodes.all().len()
}

/// The largest change of a quantity, as a fraction of the initial energy.
fn drift(series: &[Step], quantity: impl Fn(&Step) -> f64) -> f64 {
    let first = quantity(&series[0]);
    let largest = series.iter().map(|step| (quantity(step) - first).abs()).fold(0.0, f64::max);
    largest / series[0].energy.total.abs()
}

/// The energy scheme conserves the total energy of body and impactor over 20 ms and several contacts, with time steps
/// from 1e-5 s to a third of a contact. With a patch, the impact energy includes the patch's potential. The plate is
/// free, on springs, or clamped.
fn the_energy_scheme_keeps_the_total(session: &Session) {
    let world = session.world();
    let third = contact_time() / 3.0;
    let held = "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n";
    for rest in [sides(0.0, 0.0), sides(1e9, 0.0), held.into()] {
        for step in [1e-5, 3e-5, 1e-4, 2e-4, third] {
            for newton in ["condensed", "full"] {
                if newton == "full" && step < 1e-4 {
                    continue;
                }
                let time = format!("end = 0.02\nstep = {step:e}\nscheme = \"energy\"");
                let rest = format!("{rest}[solver]\nnewton = \"{newton}\"\n");
                let (_, mut impact) = start(&world, &plate(PLATE, &time, &rest));
                assert!(impact.body().terms.contact.footprint.patch().is_some());
                let series = run(&mut impact);
                let drift = drift(&series, |step| step.energy.total);
                let hits = episodes(&series);
                println!("{newton}, {step:.1e} s: {hits} hits, total changes by {drift:.1e}");
                assert!(hits >= 2, "several hits");
                assert!(drift < ROUNDING, "{newton}, {step:e} s: {drift:e}");
                world.collect_garbage().unwrap();
            }
        }
    }
}

/// With dampers, and with a pad from which the plate lifts off and to which it returns, total + dissipated is constant.
fn the_energy_scheme_balances_dampers_and_pads(session: &Session) {
    let world = session.world();
    let pad = "[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0, 0, -1]\nstiffness = [0, 0, 1e9]\n";
    let damped_pad = format!("{pad}damping = 1e4\n");
    for (name, rest) in [("dampers", sides(1e9, 1e5)), ("pad", pad.into()), ("pad with dampers", damped_pad)] {
        for step in [1e-5, 1e-4, contact_time() / 3.0] {
            let time = format!("end = 0.02\nstep = {step:e}\nscheme = \"energy\"");
            let (_, mut impact) = start(&world, &plate(PLATE, &time, &rest));
            let series = run(&mut impact);
            let drift = drift(&series, |step| step.energy.total + step.energy.dissipated);
            let last = series.last().unwrap().energy;
            let (hits, lost) = (episodes(&series), last.dissipated / series[0].energy.total);
            println!("{name}, {step:.1e} s: {hits} hits, {lost:.2e} dissipated, balance changes by {drift:.1e}");
            assert_eq!(name == "pad", lost == 0.0, "{name}");
            assert!(lost == 0.0 || lost > 1e-2, "the dampers count");
            assert!(drift < ROUNDING, "{name}, {step:e} s: {drift:e}");
            world.collect_garbage().unwrap();
        }
    }
}

/// total + dissipated − external − numerical is constant for each scheme, with dampers, loads, the impactor's weight, a
/// gap, displaced supports and a pad. The numerical energy is not zero, except for the energy scheme.
fn the_ledger_closes_for_every_scheme(session: &Session) {
    let world = session.world();
    let displaced = "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [1e9, 2e9, 3e9]\n\
                     damping = [3e4, 2e4, 1e4]\ndisplacement = [0, 0, 2e-5]\n";
    let clamped = "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n\
                   displacement = [0, 0, 1e-5]\n";
    let dampers = "[[support]]\nsurface = \"bottom\"\nkind = \"elastic\"\nstiffness = 0.0\ndamping = 2e4\n";
    let pad = "[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0, 0, -1]\nstiffness = [0, 0, 1e9]\n\
               displacement = [0, 0, -1e-5]\ndamping = 1e4\n";
    let loads = "[load]\nbody_force = [0, 0, 2e5]\n[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -3e4]\n";
    let cases = [
        ("springs", format!("{displaced}{loads}")),
        ("clamps", format!("{clamped}{dampers}{loads}")),
        ("pad", format!("{displaced}{pad}{loads}")),
    ];
    let schemes = [
        "scheme = \"newmark\"",
        "scheme = \"newmark\"\nbeta = 0.3025\ngamma = 0.6",
        "scheme = \"generalized-alpha\"\nrho_inf = 0.8",
        "scheme = \"generalized-alpha\"\nrho_inf = 0",
        "scheme = \"energy\"",
        "scheme = \"central-difference\"",
    ];
    for (name, rest) in &cases {
        for scheme in schemes {
            for newton in ["condensed", "full"] {
                let explicit = scheme.contains("central");
                if explicit && newton == "full" {
                    continue;
                }
                // Explicit time steps are chosen by the program; for the others there are about a dozen time steps in a
                // contact.
                let step = if explicit { "" } else { "step = 1e-4\n" };
                // A displaced clamp starts suddenly and excites the highest frequencies. ρ∞ = 0 overshoots before it
                // damps them, up to five times the initial energy; the default energy gate would stop such a run.
                let rest = format!("{rest}[solver]\nnewton = \"{newton}\"\nenergy_gate = 10.0\n");
                let impactor = "mass = 52.0\nspeed = 1.0\ngap = 1.234e-4\ngravity = true";
                let text = scene(PLATE, impactor, &format!("end = 5e-3\n{step}{scheme}"), &rest);
                let (_, mut impact) = start(&world, &text);
                let series = run(&mut impact);
                let closed = |step: &Step| {
                    step.energy.total + step.energy.dissipated - step.energy.external - step.energy.numerical
                };
                let drift = drift(&series, closed);
                let of = |part: fn(&Step) -> f64| {
                    series.iter().map(|step| part(step).abs()).fold(0.0, f64::max) / series[0].energy.total
                };
                let [dissipated, external, numerical] = [
                    |step: &Step| step.energy.dissipated,
                    |step: &Step| step.energy.external,
                    |step: &Step| step.energy.numerical,
                ]
                .map(of);
                let hits = episodes(&series);
                println!(
                    "{name}, {} {newton}: {hits} hits, {} steps, {dissipated:.1e} dissipated, {external:.1e} external, \
                     {numerical:.1e} numerical, open by {drift:.1e}",
                    scheme.replace('\n', " "),
                    series.len() - 1
                );
                assert!(dissipated > 1e-3 && external > 1e-4 && hits > 0, "{name}: all terms count");
                // The energy scheme has no numerical energy: the rest is rounding.
                assert_eq!(numerical > ROUNDING, !scheme.contains("energy"), "{name}, {scheme}: {numerical:e}");
                assert!(drift < ROUNDING, "{name}, {scheme}, {newton}: {drift:e}");
                world.collect_garbage().unwrap();
            }
        }
    }
}
