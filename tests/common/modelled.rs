//! Runs of a scene with the model that it asks for.
#![allow(dead_code, reason = "not every test that shares this module uses all of it")]

use petsc_wrap::Comm;
use ricochet::impact::step::Step;
use ricochet::impact::{Reading, Until};
use ricochet::model::{Model, Simulation};
use ricochet::record::episodes::{Episode, Episodes};
use ricochet::record::stress::LargestTension;
use ricochet::scene::{Model as Theory, Scene};

/// Results of a run.
pub struct Ran {
    pub theory: Theory,
    pub steps: Vec<Step>,
    pub contacts: Vec<Episode>,
    /// Estimated error of the whole time history.
    pub error: f64,
    /// Estimated error of the deflection under the impactor.
    pub deflection_error: f64,
    pub unknowns: usize,
    pub vectors: Option<usize>,
}

/// Parses the text of a scene.
pub fn parse(text: &str) -> Scene {
    Scene::parse("test", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0
}

/// Runs the scene of a text. Collective.
pub fn run(comm: &Comm, text: &str) -> Ran {
    run_scene(comm, &parse(text))
}

/// Runs a scene. Collective.
pub fn run_scene(comm: &Comm, scene: &Scene) -> Ran {
    let model = make_model(comm, scene);
    let (theory, unknowns, vectors) = (model.theory, model.unknowns, model.vectors);
    let (mut steps, mut episodes) = (Vec::new(), Episodes::default());
    let simulation = watch(scene, model, |step, _| {
        steps.push(*step);
        episodes.push(step);
    });
    comm.collect_garbage().unwrap();
    let [error, deflection_error] =
        simulation.error().total().map_or([f64::NAN; 2], |errors| [errors.history, errors.deflection]);
    Ran { theory, steps, contacts: episodes.all().to_vec(), error, deflection_error, unknowns, vectors }
}

/// The model of a scene. Collective.
pub fn make_model(comm: &Comm, scene: &Scene) -> Model {
    Model::new(comm, scene).unwrap_or_else(|error| panic!("{error}"))
}

/// Runs a model to the end of its scene. The closure receives the steps with the values read from the body. Collective.
pub fn watch(scene: &Scene, model: Model, take: impl FnMut(&Step, &Reading)) -> Simulation {
    let mut simulation = Simulation::new(scene, model).unwrap_or_else(|error| panic!("{error}"));
    let flow = simulation.run_watched(&mut Until { interrupted: &|| false, take });
    assert!(flow.unwrap_or_else(|error| panic!("{error}")).is_continue());
    simulation
}

/// Largest tension of a run with its estimated error, and the name of its face. Collective.
pub fn find_largest_tension(comm: &Comm, scene: &Scene) -> (LargestTension, String) {
    let mut largest = LargestTension::default();
    let simulation =
        watch(scene, make_model(comm, scene), |step, reading| largest.take(step.time, &reading.faces, &[]));
    largest.error_estimate = simulation.error().total().map_or(f64::NAN, |errors| errors.stress);
    comm.collect_garbage().unwrap();
    let face = simulation.faces().get(largest.face).cloned().unwrap_or_default();
    (largest, face)
}

impl Ran {
    /// Peak of the impactor's acceleration, m/s².
    pub fn peak(&self) -> f64 {
        self.steps.iter().map(|step| step.impactor.acceleration).fold(0.0, f64::max)
    }

    /// Acceleration at a time, linear between time steps.
    pub fn at(&self, time: f64) -> f64 {
        let next = self.steps.partition_point(|step| step.time <= time).clamp(1, self.steps.len() - 1);
        let (a, b) = (&self.steps[next - 1], &self.steps[next]);
        let part = ((time - a.time) / (b.time - a.time)).clamp(0.0, 1.0);
        a.impactor.acceleration + part * (b.impactor.acceleration - a.impactor.acceleration)
    }

    /// Acceleration at a time by the cubic through two time steps on either side, if there is contact at these. The
    /// time steps in modal coordinates are so long that linear interpolation errs by up to 0.6% of the peak.
    pub fn between(&self, time: f64) -> f64 {
        let after = self.steps.partition_point(|step| step.time < time * (1.0 - 1e-12));
        let around = self.steps.get(after.wrapping_sub(2)..after + 2).unwrap_or_default();
        let is_smooth = around.iter().all(|step| step.impactor.acceleration > 0.0)
            && around.windows(2).all(|pair| pair[0].time < pair[1].time);
        if around.is_empty() || !is_smooth {
            return self.at(time);
        }
        let weight = |n: usize| {
            let others = around.iter().enumerate().filter(|(other, _)| *other != n);
            others.map(|(_, step)| (time - step.time) / (around[n].time - step.time)).product::<f64>()
        };
        around.iter().enumerate().map(|(n, step)| step.impactor.acceleration * weight(n)).sum()
    }

    /// Largest difference of the accelerations over this run's peak: in its first contact, and over all time.
    pub fn difference(&self, other: &Self) -> (f64, f64) {
        let (peak, end) = (self.peak(), self.contacts.first().map_or(0.0, |contact| contact.end));
        let (mut first, mut all) = (0.0_f64, 0.0_f64);
        for step in &self.steps {
            let off = (other.at(step.time) - step.impactor.acceleration).abs() / peak;
            all = all.max(off);
            if step.time <= end {
                first = first.max(off);
            }
        }
        (first, all)
    }
}
