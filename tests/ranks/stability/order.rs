//! Orders of the schemes through the kinks of a contact: F ~ (t − t0)^{3/2} at its beginning and at its end.

use crate::start::{run, start};
use mpi_test::{Test, tests};
use petsc_wrap::{Comm, Session};
use ricochet::contact::hertz;
use ricochet::record::episodes::Episodes;

/// On one rank: a single cell cannot be distributed.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] = tests![orders_through_a_hit];

/// Contact stiffness, N/m^1.5, of a mass of 1 kg at 1 m/s.
const STIFFNESS: f64 = 1e10;

/// Number of phases of the first touch within a time step; the errors depend on the phase.
const PHASES: u32 = 8;

/// Errors of the beginning and the end of the contact (s) and of the impactor's position after it (m): the largest over
/// the phases.
///
/// The wall is a clamped cell so stiff that it deforms by 1e-10 of the indentation.
fn errors(comm: &Comm, scheme: &str, steps: u32) -> [f64; 3] {
    let contact = hertz::contact_time(STIFFNESS, 1.0, 1.0);
    let step = contact / f64::from(steps);
    let mut errors = [0.0_f64; 3];
    for phase in 0..PHASES {
        let gap = (2.0 + f64::from(phase) / f64::from(PHASES)) * step;
        let (_, mut impact) = start(
            comm,
            &format!(
                "[body]\nyoung = 1e18\npoisson = 0.3\ndensity = 1e3\nsize = [1, 1, 1]\ncells = [1, 1, 1]\norder = 1\n\
                 [[support]]\nsurface = \"bottom\"\nkind = \"clamped\"\n[impactor]\nmass = 1.0\nradius = 0.05\n\
                 stiffness = {STIFFNESS:e}\nspeed = 1.0\ngap = {gap:e}\npoint = [0, 0, 0.5]\n\
                 [contact]\nlocalization = \"point\"\n[time]\nend = {:e}\nstep = {step:e}\n{scheme}",
                gap + 1.3 * contact
            ),
        );
        let series = run(&mut impact);
        let mut episodes = Episodes::default();
        series.iter().for_each(|step| episodes.push(step));
        let [episode] = episodes.all() else { panic!("one hit: {:?}", episodes.all()) };
        assert!(!episodes.is_open());
        let last = series.last().unwrap();
        // The impactor moves at 1 m/s towards the wall and away from it.
        let place = gap - (last.time - gap - contact);
        let found = [episode.start - gap, episode.end - gap - contact, last.impactor.position - place];
        errors.iter_mut().zip(found).for_each(|(most, error)| *most = most.max(error.abs()));
    }
    comm.collect_garbage().unwrap();
    errors
}

/// Each scheme keeps its order through both kinks, whose error terms Δt^{5/2} are of an order above two; a scheme of a
/// higher order would be limited by the kinks. The cubic through δ and δ̇ locates the touch to Δt^{7/2}, the error of
/// the first step, and the separation with the scheme's own order: neither is rounded to a time step.
fn orders_through_a_hit(session: &Session) {
    let world = session.world();
    let time = hertz::contact_time(STIFFNESS, 1.0, 1.0);
    for (scheme, order) in [
        ("scheme = \"newmark\"", 2.0),
        ("scheme = \"newmark\"\nbeta = 0.3025\ngamma = 0.6", 1.0),
        ("scheme = \"generalized-alpha\"\nrho_inf = 0.5", 2.0),
        ("scheme = \"energy\"", 2.0),
    ] {
        const STEPS: [u32; 3] = [32, 64, 128];
        let all = STEPS.map(|steps| errors(&world, scheme, steps).map(|error| error / time));
        let observed = [0, 1, 2].map(|kind| (all[1][kind] / all[2][kind]).log2());
        println!(
            "{}: touch, separation and place are off by {:?}",
            scheme.replace('\n', ", "),
            all[2].map(|error| format!("{error:.1e}"))
        );
        println!("  at {} steps a contact, orders {observed:.2?}", STEPS[2]);
        let [touch, separation, place] = observed;
        // The next term is of half an order more: some hundredths with these time steps. The first-order scheme has a
        // large second-order term.
        let slack = if order == 1.0 { 0.25 } else { 0.05 };
        assert!((touch - 3.5).abs() < 0.05, "{scheme}: {touch}");
        assert!((separation - order).abs() < slack && (place - order).abs() < slack, "{scheme}: {separation}, {place}");
        // The errors are much smaller than a time step.
        assert!(all[2][0] < 1e-5 / f64::from(STEPS[2]), "{scheme}");
        assert!(order == 1.0 || all[2][1] < 0.02 / f64::from(STEPS[2]), "{scheme}");
    }
}
