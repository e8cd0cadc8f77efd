//! Ranks that each compute the whole plate take the same decisions, also if their rounding differs.

use std::cell::Cell;
use std::ops::ControlFlow;

use crate::glass::{plate, sides};
use crate::modelled::parse;
use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use mpi_test::{Test, tests};
use petsc_wrap::{Comm, Session};
use ricochet::Result;
use ricochet::agree::of_root;
use ricochet::model::watch::{Stage, Watch, of_first};
use ricochet::model::{Model, ModelContext, Simulation};
use ricochet::scene::Scene;

pub const RANKS: &[usize] = &[2, 3];
pub const TESTS: &[Test<Session>] = tests![all_ranks_come_to_the_same_stages, all_ranks_receive_the_same_steps];

/// Counts the stages that a rank reaches.
struct Counted {
    comm: Comm,
    stages: Cell<usize>,
}

impl Watch for Counted {
    fn at(&self, _: Stage) -> Result<()> {
        self.stages.set(self.stages.get() + 1);
        Ok(())
    }

    fn agreed(&self, mine: f64) -> f64 {
        of_first(&self.comm, mine)
    }
}

/// Different tolerances on the ranks stand for different processors: alone, the ranks would use bases of different
/// sizes.
fn all_ranks_come_to_the_same_stages(session: &Session) {
    let comm = session.world();
    let scene = parse(&plate("size = [1.5, 1.5, 0.04]", "end = 2e-3", &sides(1e9, 0.0)));
    for [tolerance, finer] in [[1e-2, 5e-3], [3e-3, 1.5e-3]] {
        let [scene, finer] = [tolerance, finer].map(|tolerance| Scene { tolerance, ..scene.clone() });
        let alone = |scene: &Scene| Model::new(&session.alone(), scene).unwrap().vectors;
        assert_ne!(alone(&scene), alone(&finer));
        let own = if comm.is_root() { &scene } else { &finer };
        let watch = Counted { comm: comm.clone(), stages: Cell::new(0) };
        let vectors = Model::made(&ModelContext::new(&comm, &watch), own).unwrap().vectors.unwrap();
        let count = [vectors, watch.stages.get()];
        let (mut least, mut most) = ([0; 2], [0; 2]);
        comm.mpi().all_reduce_into(&count, &mut least, SystemOperation::min());
        comm.mpi().all_reduce_into(&count, &mut most, SystemOperation::max());
        assert_eq!(least, most);
    }
}

/// Bodies that differ in their modulus stand for bodies that differ in their rounding: alone, the ranks would take other
/// steps. All ranks receive the first rank's steps, and its estimates decide.
fn all_ranks_receive_the_same_steps(session: &Session) {
    let comm = session.world();
    let young = if comm.is_root() { "young = 7e10" } else { "young = 4e10" };
    for body in ["size = [0.5, 0.5, 0.02]", "size = [1.5, 1.5, 0.04]\nmodel = \"mindlin\""] {
        let scene = parse(&plate(body, "end = 2e-3", &sides(1e9, 0.0)).replace("young = 7e10", young));
        let mut simulation = Simulation::new(&scene, Model::new(&comm, &scene).unwrap()).unwrap();
        let mut rows = Vec::new();
        let flow = simulation.run(|step| {
            rows.extend([step.time, step.contact.force, step.impactor.position, step.energy.total]);
            Ok(ControlFlow::Continue(()))
        });
        assert!(flow.unwrap().is_continue() && rows.len() > 100);
        let own = (rows, simulation.count().solves, simulation.count().error);
        assert_eq!(of_root(&comm, Some(own.clone())), own, "{body}");
        drop(simulation);
        comm.collect_garbage().unwrap();
    }
}
