//! Time steps chosen by the error: they meet the tolerance, at lower cost than fixed time steps.

use mpi_test::{Test, tests};
use std::ops::ControlFlow;

use crate::glass::{plate, sides};
use crate::start::{run, start};
use petsc_wrap::{Comm, Session};
use ricochet::Error;
use ricochet::impact::checkpoint::Checkpoint;
use ricochet::impact::step::Step;
use ricochet::impact::{Observer, Reading, TimeIntegration as _};
use ricochet::record::episodes::{Episode, Episodes};

/// On one rank: other tests show that the series are the same on several.
pub const RANKS: &[usize] = &[1];
pub const TESTS: &[Test<Session>] =
    tests![the_tolerance_is_met_with_fewer_solves, an_interruption_between_steps_has_a_checkpoint];

/// The paper's plate of 0.04 m with a coarse mesh: only the error of the time steps matters here.
const PLATE: &str = "size = [1.5, 1.5, 0.04]\ncells = [10, 10, 1]\ngrading = [8, 8, 1]";

/// End of the whole run, s: three contacts, free or on springs.
const END: f64 = 0.02;

/// Time step of the reference, s, whose own error is then some 3e-5.
const FINE: f64 = 1e-6;

/// The impactor's acceleration in the first contact, and the cost of the run.
struct History {
    series: Vec<Step>,
    episodes: Vec<Episode>,
    solves: usize,
}

fn history(comm: &Comm, stiffness: f64, (end, steps): (f64, &str)) -> History {
    let (_, mut impact) = start(comm, &plate(PLATE, &format!("end = {end:e}\n{steps}"), &sides(stiffness, 0.0)));
    let series = run(&mut impact);
    let mut episodes = Episodes::default();
    series.iter().for_each(|step| episodes.push(step));
    let solves = impact.count.solves;
    drop(impact);
    comm.collect_garbage().unwrap();
    History { series, episodes: episodes.all().to_vec(), solves }
}

impl History {
    fn peak(&self) -> f64 {
        self.series.iter().map(|step| step.impactor.acceleration).fold(0.0, f64::max)
    }

    /// Acceleration interpolated between the time steps, m/s².
    fn at(&self, time: f64) -> f64 {
        let after = self.series.partition_point(|step| step.time < time).clamp(1, self.series.len() - 1);
        let [a, b] = [&self.series[after - 1], &self.series[after]];
        let part = (time - a.time) / (b.time - a.time);
        a.impactor.acceleration * (1.0 - part) + b.impactor.acceleration * part
    }

    /// Largest error over the peak, at the time steps within the reference's first contact.
    fn error(&self, reference: &Self) -> f64 {
        let first = reference.episodes[0];
        let within = self.series.iter().filter(|step| step.time <= first.end);
        let off = |step: &Step| (step.impactor.acceleration - reference.at(step.time)).abs();
        within.map(off).fold(0.0, f64::max) / reference.peak()
    }
}

/// The error in the first contact is within the tolerance, and fixed time steps with the same error need more solves in
/// the run.
fn the_tolerance_is_met_with_fewer_solves(session: &Session) {
    let world = session.world();
    for (stiffness, end) in [(0.0, 2e-3), (1e9, 3e-3)] {
        let fine = history(&world, stiffness, (end, &format!("step = {FINE:e}")));
        let fixed: Vec<(f64, f64)> = [2e-5, 1e-5, 5e-6, 2.5e-6]
            .map(|step| {
                let run = history(&world, stiffness, (end, &format!("step = {step:e}")));
                println!("k = {stiffness:e}, steps of {step:.1e} s: error {:.2e}", run.error(&fine));
                (step, run.error(&fine))
            })
            .to_vec();
        for tolerance in [1e-2, 1e-3] {
            let controlled = history(&world, stiffness, (END, &format!("[accuracy]\ntolerance = {tolerance:e}")));
            let error = controlled.error(&fine);
            // The fixed step with the same error, by interpolation between two of the table in logarithms.
            let pair = fixed.windows(2).find(|pair| pair[1].1 <= error).expect("a fixed step that is as good");
            let slope = (pair[0].1 / pair[1].1).ln() / (pair[0].0 / pair[1].0).ln();
            let step = pair[1].0 * (error / pair[1].1).powf(1.0 / slope);
            let solves = (END / step).ceil() as usize;
            println!(
                "k = {stiffness:e}, tolerance {tolerance:e}: error {error:.2e}, {} hits, {} solves; fixed steps of {step:.2e} s: {solves}",
                controlled.episodes.len(),
                controlled.solves,
            );
            assert!(fine.episodes[0].end < end && controlled.episodes.len() >= 3, "three hits, the first one compared");
            assert!(error <= tolerance, "k = {stiffness:e}, tolerance {tolerance:e}: {error:e}");
            assert!(controlled.solves < solves, "{} solves, {solves} by fixed steps", controlled.solves);
        }
    }
}

/// Receives the time steps, and the checkpoint if the run is interrupted.
#[derive(Default)]
struct Keeper {
    series: Vec<Step>,
    kept: Option<Checkpoint>,
    /// Number of times that the run has asked whether to continue, after time steps and between them.
    asked: usize,
    /// Number of the question at which the run is to end; 0 for never.
    end: usize,
}

impl Keeper {
    fn ends(&mut self) -> bool {
        self.asked += 1;
        self.asked == self.end
    }
}

impl Observer for Keeper {
    fn step(&mut self, step: &Step, _: &Reading) -> Result<ControlFlow<()>, Error> {
        self.series.push(*step);
        Ok(if self.ends() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
    }

    fn is_interrupted(&mut self) -> bool {
        self.ends()
    }

    fn settled(
        &mut self,
        interrupted: bool,
        checkpoint: &mut dyn FnMut() -> Result<Checkpoint, Error>,
    ) -> Result<(), Error> {
        if interrupted {
            assert!(self.kept.replace(checkpoint()?).is_none(), "one end, one checkpoint");
        }
        Ok(())
    }
}

/// If a run is ended, after a time step or between two, it delivers a checkpoint of the last step that it has reported,
/// and continues from there bit for bit. There is no checkpoint while the first contact may still be repeated.
fn an_interruption_between_steps_has_a_checkpoint(session: &Session) {
    let world = session.world();
    let new = || start(&world, &plate(PLATE, "end = 8e-3", &sides(1e9, 0.0))).1;
    // Ends at the n-th question.
    let watched = |resumed: Option<&Checkpoint>, end: usize| {
        let (mut impact, mut keeper) = (new(), Keeper { end, ..Keeper::default() });
        if let Some(checkpoint) = resumed {
            impact.resume(checkpoint).unwrap();
        }
        let flow = impact.run_watched(&mut keeper).unwrap();
        drop(impact);
        world.collect_garbage().unwrap();
        (flow, keeper)
    };
    let (flow, whole) = watched(None, 0);
    assert!(flow.is_continue() && whole.kept.is_none());
    let all = whole.asked;
    let mut gone_on = 0;
    for part in 1..12 {
        let (flow, Keeper { mut series, kept, .. }) = watched(None, all * part / 12);
        assert!(flow.is_break() && series.len() < whole.series.len());
        let Some(checkpoint) = kept else { continue };
        let (flow, rest) = watched(Some(&checkpoint), 0);
        assert!(flow.is_continue());
        series.extend(rest.series);
        assert_eq!(series.len(), whole.series.len(), "interrupted at {part}/12");
        let peak = whole.series.iter().map(|step| step.contact.force).fold(0.0, f64::max);
        let apart = series.iter().zip(&whole.series).map(|(own, right)| {
            ((own.contact.force - right.contact.force) / peak).abs().max((own.time / right.time - 1.0).abs())
        });
        let apart = apart.fold(0.0, f64::max);
        // Equal, but for libraries that factorise the same matrix with another rounding each time (Debian 13), which later
        // contacts amplify. A state that lacks something is apart by 1e-3.
        assert!(apart < 1e-8, "interrupted at {part}/12: {apart:e}");
        gone_on += 1;
    }
    println!("{gone_on} of 11 gone on, asked {all} times over {} steps", whole.series.len());
    // The first contact, repeated with smaller time steps, is the longer part.
    assert!(gone_on >= 4, "{gone_on}");
}
