//! What is read of the body at every step, besides the surface under the impactor, and kept until the step is told.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use petsc_wrap::{Gather, Int, Vector};

use crate::body::Body;
use crate::error::Result;
use crate::form::stress::principal;
use crate::scene::Vec3;
use crate::space::evaluate::Map;

use super::state::State;

/// What is to be read, in the coordinates in which a body moves. One rank has all of it, the others nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Readout {
    /// Where there are probes, the coordinates that they need, and nine forms on these a probe: displacement, m, and stress, Pa.
    pub probes: Option<(Vec<Int>, Map)>,
    /// Where there are fields, after how many steps, and the coordinates: all of them.
    pub fields: Option<(usize, Vec<Int>)>,
}

impl Readout {
    /// Whether it is this rank that has it.
    pub(super) fn is_here(&self) -> bool {
        let probes = self.probes.as_ref().is_some_and(|(_, map)| !map.is_empty());
        probes || self.fields.as_ref().is_some_and(|(_, columns)| !columns.is_empty())
    }
}

/// What a probe reads.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Probe {
    /// m.
    pub displacement: Vec3,
    /// m/s.
    pub velocity: Vec3,
    /// The largest first, tension positive, Pa.
    pub principal_stress: Vec3,
}

/// What was read at one step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// Number of the step.
    pub number: usize,
    /// Of each probe.
    pub probes: Vec<Probe>,
    /// All coordinates and their rates, where the step's fields are wanted.
    pub coordinates: Option<[Vec<f64>; 2]>,
}

/// Readings of steps that are not told yet. A step may be taken back: then one of its number, or of a smaller one, follows.
#[derive(Debug, Clone, Default)]
pub struct Tape(Rc<RefCell<VecDeque<Reading>>>);

impl Tape {
    /// Adds a step's, in the place of what follows it.
    pub(super) fn put(&self, reading: Reading) {
        let mut all = self.0.borrow_mut();
        while all.back().is_some_and(|last| last.number >= reading.number) {
            all.pop_back();
        }
        all.push_back(reading);
    }

    /// Takes that of a step off, and those before it.
    pub fn take(&self, number: usize) -> Option<Reading> {
        let mut all = self.0.borrow_mut();
        while all.front().is_some_and(|first| first.number < number) {
            all.pop_front();
        }
        if all.front().is_some_and(|first| first.number == number) { all.pop_front() } else { None }
    }

    /// How many of those that are there have fields.
    pub fn fields(&self) -> usize {
        self.0.borrow().iter().filter(|reading| reading.coordinates.is_some()).count()
    }
}

/// Reads a body that is stepped in its unknowns.
pub struct Reader {
    probes: Option<(Gather, Map)>,
    fields: Option<(usize, Gather)>,
    /// Whether this rank is the one that reads.
    is_here: bool,
    tape: Tape,
}

impl Reader {
    /// Of a body. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn new(body: &Body, readout: &Readout, tape: Tape) -> Result<Self> {
        let gather = |columns: &[Int]| Gather::new(&body.load, columns);
        Ok(Self {
            probes: match &readout.probes {
                Some((columns, map)) => Some((gather(columns)?, map.clone())),
                None => None,
            },
            fields: match &readout.fields {
                Some((every, columns)) => Some((*every, gather(columns)?)),
                None => None,
            },
            is_here: readout.is_here(),
            tape,
        })
    }

    /// Reads a step's state. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn read(&mut self, number: usize, state: &State) -> Result<()> {
        let fetched = |gather: &mut Gather, of: &Vector| Ok::<_, crate::Error>(gather.fetch(of)?.to_vec());
        let mut reading = Reading { number, ..Reading::default() };
        if let Some((gather, map)) = &mut self.probes {
            let [u, v] = [fetched(gather, &state.u)?, fetched(gather, &state.v)?];
            reading.probes = probes(&map.apply(&u), &map.apply(&v));
        }
        if let Some((every, gather)) = &mut self.fields
            && number.is_multiple_of(*every)
        {
            reading.coordinates = Some([fetched(gather, &state.u)?, fetched(gather, &state.v)?]);
        }
        // On the other ranks nobody takes it off.
        if self.is_here {
            self.tape.put(reading);
        }
        Ok(())
    }
}

/// What probes read of the values of their nine forms, and of the rates of these.
pub(super) fn probes(values: &[f64], rates: &[f64]) -> Vec<Probe> {
    let one = |(value, rate): (&[f64], &[f64])| Probe {
        displacement: [value[0], value[1], value[2]],
        velocity: [rate[0], rate[1], rate[2]],
        principal_stress: principal([value[3], value[4], value[5], value[6], value[7], value[8]]),
    };
    values.chunks_exact(9).zip(rates.chunks_exact(9)).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Steps that are taken back leave nothing behind; what is told is told of the step that stood in the end.
    #[test]
    fn readings_are_of_the_steps_that_stand() {
        let tape = Tape::default();
        let put = |number: usize, mark: f64| {
            let probes = vec![Probe { displacement: [mark; 3], ..Probe::default() }];
            tape.put(Reading { number, probes, coordinates: None });
        };
        put(0, 0.0);
        assert_eq!(tape.take(0).map(|reading| reading.number), Some(0));
        (1..=6).for_each(|number| put(number, 1.0));
        // Two steps back, and then all of it anew.
        put(5, 2.0);
        (1..=3).for_each(|number| put(number, 3.0));
        put(4, 4.0);
        let told: Vec<_> = (1..=5).map(|n| tape.take(n).map(|r| (r.number, r.probes[0].displacement[0]))).collect();
        assert_eq!(told, [Some((1, 3.0)), Some((2, 3.0)), Some((3, 3.0)), Some((4, 4.0)), None]);
    }
}
