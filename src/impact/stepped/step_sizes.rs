//! Steppers for several step sizes; each is set up when it is first needed, and kept.

use petsc_wrap::Comm;

use crate::body::Body;
use crate::error::Result;
use crate::scene;
use crate::scheme::Implicit;

use super::energy_balance::Exchange;
use super::explicit::ExplicitStepper;
use super::implicit::ImplicitStepper;
use super::state::Moment;
use crate::impact::checkpoint::Visitor;
use crate::impact::parameters::ImpactParameters;

/// A scheme at one step size.
pub trait Stepper {
    /// Takes a step and writes the state at its end. Returns the energies exchanged over it, and the number of Newton
    /// iterations. Collective.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] if the step cannot be solved; if a PETSc call fails.
    fn advance(
        &mut self,
        body: &mut Body,
        parameters: &ImpactParameters,
        from: &Moment,
        to: &mut Moment,
    ) -> Result<(Exchange, usize)>;

    /// Saves the memory of previous steps to a checkpoint or restores it.
    fn visit(&mut self, _visitor: &mut Visitor) -> Result<()> {
        Ok(())
    }
}

/// Steppers with step sizes of 2^level times a base step.
pub struct StepSizes {
    comm: Comm,
    parameters: ImpactParameters,
    scheme: scene::Scheme,
    newton: scene::Newton,
    /// Residual that counts as zero in Newton's method, N.
    tolerance: f64,
    /// Step size of level 0, s.
    base: f64,
    steppers: Vec<Option<Box<dyn Stepper>>>,
}

impl StepSizes {
    pub(super) fn new(
        comm: &Comm,
        parameters: ImpactParameters,
        (scheme, newton): (scene::Scheme, scene::Newton),
        tolerance: f64,
        base: f64,
    ) -> Self {
        Self { comm: comm.clone(), parameters, scheme, newton, tolerance, base, steppers: Vec::new() }
    }

    /// Step size of a level, s.
    pub(super) fn step(&self, level: usize) -> f64 {
        self.base * (1_u64 << level) as f64
    }

    /// Returns the stepper of a level; sets it up if necessary. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub(super) fn at(&mut self, level: usize, body: &Body) -> Result<&mut dyn Stepper> {
        if self.steppers.len() <= level {
            self.steppers.resize_with(level + 1, || None);
        }
        let step = self.step(level);
        let slot = &mut self.steppers[level];
        if slot.is_none() {
            *slot = Some(match Implicit::new(self.scheme) {
                Some(scheme) => {
                    let newton = (self.newton, self.tolerance);
                    Box::new(ImplicitStepper::new(&self.comm, body, &self.parameters, (scheme, step), newton)?)
                }
                None => Box::new(ExplicitStepper::new(body, step)?),
            });
        }
        Ok(&mut **slot.as_mut().expect("just set up"))
    }

    /// Saves the base step and the memory of the steppers to a checkpoint or restores them; on restoring, missing
    /// steppers are set up. Collective.
    ///
    /// # Errors
    /// Same as [`Visitor`]; if a PETSc call fails.
    pub(super) fn visit(&mut self, visitor: &mut Visitor, body: &Body) -> Result<()> {
        let mut base = self.base;
        visitor.number("base", &mut base)?;
        if base != self.base {
            self.rebase(base)?;
        }
        let mut levels = self.steppers.len();
        visitor.count("levels", &mut levels)?;
        for level in 0..levels.min(64) {
            let mut is_set_up = usize::from(self.steppers.get(level).is_some_and(Option::is_some));
            visitor.count(&format!("{level}"), &mut is_set_up)?;
            if is_set_up != 0 {
                visitor.within(&format!("{level}"), |visitor| self.at(level, body)?.visit(visitor))?;
            }
        }
        Ok(())
    }

    /// Changes the base step, which removes all steppers. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub(super) fn rebase(&mut self, base: f64) -> Result<()> {
        self.base = base;
        self.steppers.clear();
        Ok(self.comm.collect_garbage()?)
    }
}
