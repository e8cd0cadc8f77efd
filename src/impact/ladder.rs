//! Steppers of several step sizes, each set up when it is first needed and kept.

use petsc_wrap::Comm;

use crate::body::Solid;
use crate::error::Result;
use crate::scene;
use crate::scheme::Implicit;

use super::implicit::Stepper;
use super::setting::Setting;

/// Steps of 2^level times a base.
pub struct Ladder {
    comm: Comm,
    setting: Setting,
    scheme: Implicit,
    newton: scene::Newton,
    /// What counts as zero in the full Newton's method, N.
    tolerance: f64,
    /// The step of level 0, s.
    base: f64,
    steppers: Vec<Option<Stepper>>,
}

impl Ladder {
    pub(super) fn new(
        comm: &Comm,
        setting: Setting,
        (scheme, newton): (Implicit, scene::Newton),
        tolerance: f64,
        base: f64,
    ) -> Self {
        Self { comm: comm.clone(), setting, scheme, newton, tolerance, base, steppers: Vec::new() }
    }

    /// The step of a level, s.
    pub(super) fn step(&self, level: usize) -> f64 {
        self.base * (1_u64 << level) as f64
    }

    /// The stepper of a level, set up if need be. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn at(&mut self, level: usize, body: &Solid) -> Result<&mut Stepper> {
        if self.steppers.len() <= level {
            self.steppers.resize_with(level + 1, || None);
        }
        let step = self.step(level);
        let slot = &mut self.steppers[level];
        if slot.is_none() {
            *slot =
                Some(Stepper::new(&self.comm, body, self.setting, (self.scheme, step), self.newton, self.tolerance)?);
        }
        Ok(slot.as_mut().expect("just set up"))
    }

    /// Another base, which forgets all steppers. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub(super) fn rebase(&mut self, base: f64) -> Result<()> {
        self.base = base;
        self.steppers.clear();
        Ok(self.comm.collect_garbage()?)
    }
}
