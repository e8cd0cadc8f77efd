//! Distributes the members of a sweep over the ranks as they become free.
//!
//! Rank 0 distributes the members, receives the results, and computes members too. It polls for messages between
//! members and, when a computation asks whether to stop, during a member. The other ranks always have one member in
//! reserve, so that they do not wait.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::rc::Rc;
use std::time::{Duration, Instant};

use mpi::point_to_point::MatchedReceiveVec;
use mpi::traits::{Communicator, Destination, Root, Source};
use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use crate::agree::{decoded, encoded};
use crate::error::{Error, Result};
use crate::record::sweep::Member;

/// Called on rank 0 with each received member, and at intervals with `None`.
pub type Kept = Box<dyn FnMut(Option<Member>) -> Result<()>>;

/// Computes the member with a given number; `None` if its callback told it to stop.
pub type Compute<'a> = dyn FnMut(usize, Rc<dyn Fn() -> bool>) -> Result<Option<Member>> + 'a;

/// Number of members assigned to a rank at once: one in work and one in reserve.
const MEMBERS_PER_RANK: usize = 2;
/// Interval between polls for messages while a member is computed.
const LOOK_EVERY: Duration = Duration::from_millis(2);
/// Interval between polls while a rank is idle.
const IDLE: Duration = Duration::from_micros(200);

/// Message from rank 0 to another rank.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
enum Order {
    /// Compute the member with this number.
    Compute(usize),
    /// Stop after the member in work.
    Stop,
}

/// Message from another rank to rank 0.
#[derive(Serialize, Deserialize)]
enum Report {
    /// A member is computed.
    Done(Box<Member>),
    /// The rank has received a signal.
    GivesUp,
    /// Last message of the rank.
    Bye,
}

/// MPI tag of these messages, which separates them from PETSc's.
const TAG: i32 = 1;

/// Computes the members `todo` (read on rank 0) with `compute`, each on one rank. `kept` receives the results on rank
/// 0. All ranks stop early if `signalled` returns true on any; the result is then `Break`. Collective.
///
/// # Errors
/// Same as `compute` and `kept`, on the rank where they fail.
pub fn schedule(
    comm: &Comm,
    todo: Vec<usize>,
    signalled: impl Fn() -> bool + 'static,
    compute: &mut Compute,
    kept: Kept,
) -> Result<ControlFlow<()>> {
    let mut broke_off = false;
    if comm.is_root() {
        broke_off = hand_out(Coordinator::new(comm, todo, Box::new(signalled), kept), compute)?;
    } else {
        take(Worker::new(comm, Box::new(signalled)), compute)?;
    }
    comm.mpi().process_at_rank(0).broadcast_into(&mut broke_off);
    Ok(if broke_off { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
}

/// Wraps `look`: it is called at most once every [`LOOK_EVERY`], and its last result is returned in between.
fn now_and_then(look: impl Fn() -> bool + 'static) -> Rc<dyn Fn() -> bool> {
    let last = RefCell::new((Instant::now(), false));
    Rc::new(move || {
        let mut last = last.borrow_mut();
        if !last.1 && last.0.elapsed() >= LOOK_EVERY {
            *last = (Instant::now(), look());
        }
        last.1
    })
}

/// Work of rank 0; returns whether the sweep was stopped early.
fn hand_out(mut coordinator: Coordinator, compute: &mut Compute) -> Result<bool> {
    let mut own = coordinator.next_for(0);
    let coordinator = Rc::new(RefCell::new(coordinator));
    coordinator.borrow_mut().begin();
    while let Some(index) = own {
        let seen = coordinator.clone();
        let member = compute(index, now_and_then(move || seen.borrow_mut().serve()))?;
        let mut coordinator = coordinator.borrow_mut();
        if let Some(member) = member {
            coordinator.keep(Some(member));
        }
        own = if coordinator.serve() { None } else { coordinator.next_for(0) };
    }
    while coordinator.borrow().is_waiting() {
        coordinator.borrow_mut().serve();
        std::thread::sleep(IDLE);
    }
    let mut coordinator = coordinator.borrow_mut();
    coordinator.failed.take().map_or(Ok(coordinator.stopped), Err)
}

/// State of the schedule on rank 0.
struct Coordinator {
    comm: Comm,
    /// Members not yet assigned, one queue per rank. Each queue has neighbouring members, which share most.
    queues: Vec<VecDeque<usize>>,
    signalled: Box<dyn Fn() -> bool>,
    kept: Kept,
    /// Number of members assigned to each rank and not yet returned.
    out: Vec<usize>,
    /// Whether each rank has been told to stop.
    dismissed: Vec<bool>,
    /// Number of ranks that have sent their last message.
    gone: usize,
    /// Whether the sweep is stopped early.
    stopped: bool,
    failed: Option<Error>,
}

impl Coordinator {
    fn new(comm: &Comm, todo: Vec<usize>, signalled: Box<dyn Fn() -> bool>, kept: Kept) -> Self {
        let (out, dismissed) = (vec![0; comm.size()], vec![false; comm.size()]);
        Self {
            comm: comm.clone(),
            queues: shares(todo, comm.size()),
            signalled,
            kept,
            out,
            dismissed,
            gone: 0,
            stopped: false,
            failed: None,
        }
    }

    /// The next member for a rank from its queue; if that is empty, the last member of the longest queue.
    fn next_for(&mut self, rank: usize) -> Option<usize> {
        let own = self.queues[rank].pop_front();
        own.or_else(|| self.queues.iter_mut().max_by_key(|queue| queue.len())?.pop_back())
    }

    /// Sends each other rank its first members, in turn.
    fn begin(&mut self) {
        for _ in 0..MEMBERS_PER_RANK {
            (1..self.comm.size()).for_each(|rank| self.order(rank));
        }
    }

    /// Sends a rank another member, or tells it to stop if it has none left.
    fn order(&mut self, rank: usize) {
        if self.dismissed[rank] {
            return;
        }
        let index = if self.stopped { None } else { self.next_for(rank) };
        match index {
            Some(index) => {
                self.send(rank, Order::Compute(index));
                self.out[rank] += 1;
            }
            None if self.out[rank] == 0 => self.dismiss(rank),
            None => {}
        }
    }

    fn dismiss(&mut self, rank: usize) {
        if !self.dismissed[rank] {
            self.send(rank, Order::Stop);
            self.dismissed[rank] = true;
        }
    }

    fn send(&self, rank: usize, order: Order) {
        self.comm.mpi().process_at_rank(rank as i32).send_with_tag(&encoded(&order)[..], TAG);
    }

    /// Processes all received messages; returns whether the sweep is stopped early.
    fn serve(&mut self) -> bool {
        let comm = self.comm.clone();
        while let Some(message) = comm.mpi().any_process().immediate_matched_probe_with_tag(TAG) {
            let (bytes, status) = message.matched_receive_vec::<u8>();
            let rank = status.source_rank() as usize;
            match decoded(&bytes) {
                Report::Done(member) => {
                    self.keep(Some(*member));
                    self.out[rank] -= 1;
                    self.order(rank);
                }
                Report::GivesUp => self.stop(),
                Report::Bye => self.gone += 1,
            }
        }
        self.keep(None);
        if (self.signalled)() {
            self.stop();
        }
        self.stopped
    }

    fn keep(&mut self, member: Option<Member>) {
        if self.failed.is_none()
            && let Err(error) = (self.kept)(member)
        {
            self.failed = Some(error);
            self.stop();
        }
    }

    fn stop(&mut self) {
        self.stopped = true;
        (1..self.comm.size()).for_each(|rank| self.dismiss(rank));
    }

    /// Whether a rank is still at work. After an error of rank 0 no rank is waited for, because that error ends them
    /// all.
    fn is_waiting(&self) -> bool {
        self.failed.is_none() && self.gone + 1 < self.comm.size()
    }
}

/// Splits the members, in their order, into parts of about equal length, one per rank.
fn shares(todo: Vec<usize>, ranks: usize) -> Vec<VecDeque<usize>> {
    let (count, mut rest) = (todo.len(), todo.into_iter());
    (0..ranks).map(|rank| rest.by_ref().take((rank + 1) * count / ranks - rank * count / ranks).collect()).collect()
}

/// Work of the other ranks.
fn take(worker: Worker, compute: &mut Compute) -> Result<()> {
    let comm = worker.comm.clone();
    let root = comm.mpi().process_at_rank(0);
    let worker = Rc::new(RefCell::new(worker));
    loop {
        let is_to_leave_off = worker.borrow_mut().look();
        if worker.borrow().stopped {
            root.send_with_tag(&encoded(&Report::Bye)[..], TAG);
            return Ok(());
        }
        let next = if is_to_leave_off { None } else { worker.borrow_mut().queue.pop_front() };
        let Some(index) = next else {
            std::thread::sleep(IDLE);
            continue;
        };
        let seen = worker.clone();
        if let Some(member) = compute(index, now_and_then(move || seen.borrow_mut().look()))? {
            root.send_with_tag(&encoded(&Report::Done(Box::new(member)))[..], TAG);
        }
    }
}

/// State of the schedule on another rank.
struct Worker {
    comm: Comm,
    queue: VecDeque<usize>,
    signalled: Box<dyn Fn() -> bool>,
    /// Whether rank 0 has told this rank to stop.
    stopped: bool,
    /// Whether rank 0 has been told of the signal.
    gave_up: bool,
}

impl Worker {
    fn new(comm: &Comm, signalled: Box<dyn Fn() -> bool>) -> Self {
        Self { comm: comm.clone(), queue: VecDeque::new(), signalled, stopped: false, gave_up: false }
    }

    /// Processes the orders of rank 0; returns whether to stop the current member.
    fn look(&mut self) -> bool {
        let root = self.comm.mpi().process_at_rank(0);
        while let Some(message) = root.immediate_matched_probe_with_tag(TAG) {
            match decoded(&message.matched_receive_vec::<u8>().0) {
                Order::Compute(index) => self.queue.push_back(index),
                Order::Stop => self.stopped = true,
            }
        }
        if !self.gave_up && (self.signalled)() {
            root.send_with_tag(&encoded(&Report::GivesUp)[..], TAG);
            self.gave_up = true;
        }
        self.stopped || self.gave_up
    }
}
