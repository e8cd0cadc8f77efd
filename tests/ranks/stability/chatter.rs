//! A plate that bounces on a stiff pad, with time steps too coarse for its bounces.

use crate::start::{run, start};
use mpi_test::{Test, tests};
use petsc_wrap::{Comm, Session};
use ricochet::impact::step::Step;

/// On one rank: other tests show that the series are the same on several.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![bounces];

const END: f64 = 8e-3;

fn solve(comm: &Comm, scheme: &str, step: f64) -> Vec<Step> {
    let (_, mut impact) = start(
        comm,
        &format!(
            "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.5, 0.5, 0.02]\ncells = [4, 4, 1]\norder = 1\n\
             symmetry = \"quarter\"\n\
             [[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nnormal = [0, 0, -1]\nstiffness = [0, 0, 1e13]\n\
             [impactor]\nmass = 2.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n\
             [contact]\nlocalization = \"point\"\n[solver]\nenergy_gate = 1e9\n\
             [time]\nend = {END:e}\nstep = {step:e}\n{scheme}\n"
        ),
    );
    let series = run(&mut impact);
    drop(impact);
    comm.collect_garbage().unwrap();
    series
}

/// The average acceleration method gains or loses energy, depending on the phase of the impact and of the pad's
/// contacts: with coarse time steps the impactor can leave faster than it came. The energy scheme conserves the total
/// energy; the generalised-α scheme only loses.
fn bounces(session: &Session) {
    let world = session.world();
    let schemes = ["scheme = \"newmark\"", "scheme = \"energy\"", "scheme = \"generalized-alpha\"\nrho_inf = 0.5"];
    let rebound = |series: &[Step]| -series.last().unwrap().impactor.velocity;
    let fine = rebound(&solve(&world, schemes[1], 5e-6));
    println!("fine steps: rebound {fine:.4}");
    for step in [1e-4, 2e-4] {
        for (i, scheme) in schemes.into_iter().enumerate() {
            let series = solve(&world, scheme, step);
            let off = |step: &Step| step.energy.total / series[0].energy.total - 1.0;
            let [low, high] = [f64::min, f64::max].map(|pick| series.iter().map(off).reduce(pick).unwrap());
            let found = rebound(&series);
            println!(
                "{step:.0e} s, {}: energy off by {low:.2e} to {high:.2e}, rebound {found:.4}",
                scheme.replace('\n', ", "),
            );
            match i {
                0 => assert!(high > 0.05 && low < -0.05 && found > 1.0, "{low} {high} {found}"),
                // Rounding of K u; the remaining phase errors are a fraction of (Δt/contact)².
                1 => assert!(low.abs().max(high.abs()) < 1e-9 && (found - fine).abs() < 0.02, "{low} {high} {found}"),
                _ => assert!(high < 1e-9 && low < -0.05 && found < fine, "{low} {high} {found}"),
            }
        }
    }
}
