//! Nonlinear internal forces ([`InternalForce`]) in a step.
//!
//! Over a step, the force is a quadratic in time through its values at 0, h/2 and h, like the contact force. At h/2 and h it
//! is the force at the displacements there. Such a force is soft compared with the inertia of the body in a step, so forces
//! and displacements are found by fixed-point iteration. The contact's own equations are solved in each iteration. If the
//! iteration does not converge, the step is too large.

use nalgebra::{Complex, DVector};

use crate::body::{InternalForce, Modes};

use super::step_response::{NODES, SAMPLE_POINTS, State, StepResponse, real_product};

/// Convergence tolerance: estimated change of the force in the next iteration, relative to its scale.
const FOUND: f64 = 1e-11;

/// Largest number of iterations; and the iteration from which on each must halve the change.
const MAX_ITERATIONS: usize = 60;
const FIRST_CHECKED_ITERATION: usize = 4;

/// Safety factor on the convergence ratio of the last step, when it is used for the first iteration of a step.
const CAUTION: f64 = 10.0;

/// Internal force of a body in motion.
pub struct InternalForceState<'a> {
    modes: &'a Modes,
    law: &'a dyn InternalForce,
    /// Generalised force at the state reached, N.
    now: DVector<f64>,
    last: Option<Last>,
}

/// Results of the last step, which serve as the first guess for the next.
struct Last {
    /// Forces at 0, h/2 and h, N.
    forces: [DVector<f64>; 3],
    /// Step size h, s.
    step: f64,
    /// Convergence ratio: change in the last iteration over the change in the one before.
    ratio: Option<f64>,
}

/// Internal force in a step.
pub struct ForceInStep {
    /// Forces at h/2 and h, N.
    forces: [DVector<f64>; 2],
    ratio: Option<f64>,
    /// Numerical energy of the step, J, for bodies with dampers (otherwise 0): the change of the force's energy, and its work.
    pub made: f64,
}

/// Linear combination Σ w p of three forces.
fn sum(weights: [f64; 3], [a, b, c]: [&DVector<f64>; 3]) -> DVector<f64> {
    let mut sum = a * weights[0];
    sum.axpy(weights[1], b, 1.0);
    sum.axpy(weights[2], c, 1.0);
    sum
}

impl<'a> InternalForceState<'a> {
    /// Sets up the force at a state; `None` if the body has none.
    pub fn new(modes: &'a Modes, state: &State) -> Option<Self> {
        let law = modes.internal_force()?;
        Some(Self { modes, law, now: law.force(&modes.places(&state.modes)), last: None })
    }

    /// Energy of the force at a state, J.
    pub fn energy(&self, state: &State) -> f64 {
        self.law.energy(&self.modes.places(&state.modes))
    }

    /// Solves a step from a state. `free` is δ at [`SAMPLE_POINTS`] without any force. `contact` receives δ at [`SAMPLE_POINTS`] under
    /// the internal force; it returns a result of its own and F at 0, h/2 and h. `None` if either is not found.
    pub fn solve<T>(
        &self,
        table: &StepResponse,
        state: &State,
        free: [f64; 4],
        mut contact: impl FnMut([f64; 4]) -> Option<(T, [f64; 3])>,
    ) -> Option<(T, ForceInStep)> {
        let alone = NODES.map(|sample| table.left_alone(sample, state));
        let mut forces = self.guess(table.step);
        let mut ratio = self.last.as_ref().and_then(|last| {
            let longer = (table.step / last.step).max(1.0);
            last.ratio.map(|ratio| CAUTION * ratio * longer * longer)
        });
        let mut before = f64::INFINITY;
        for turn in 0..MAX_ITERATIONS {
            let inputs = self.inputs([&self.now, &forces[0], &forces[1]]);
            let moved = [0, 1, 2, 3].map(|sample| self.moved(table, sample, &inputs));
            let (found, force) = contact([0, 1, 2, 3].map(|sample| free[sample] - moved[sample]))?;
            let all = self.with_contact(&inputs, force);
            let places = [0, 1].map(|node| {
                let mut z = table.driven(NODES[node], &all);
                z.iter_mut().zip(&alone[node]).for_each(|(z, alone)| *z += alone);
                self.modes.places(&z)
            });
            let next = places.each_ref().map(|x| self.law.force(x));
            let change: f64 = next.iter().zip(&forces).map(|(next, force)| (next - force).lp_norm(1)).sum();
            let size: f64 = places.iter().map(|x| self.law.scale(x)).sum();
            if turn > 0 {
                ratio = Some(change / before);
            }
            if change == 0.0 || ratio.is_some_and(|ratio| ratio * change <= FOUND * size) {
                let made = self.made(table, state, [&self.now, &forces[0], &forces[1]], &all);
                let ratio = if turn > 0 { ratio } else { self.last.as_ref().and_then(|last| last.ratio) };
                return Some((found, ForceInStep { forces: next, ratio, made }));
            }
            if !change.is_finite() || turn >= FIRST_CHECKED_ITERATION && change > 0.5 * before {
                return None;
            }
            before = change;
            forces = next;
        }
        None
    }

    /// Completes a step: adds the effect of the internal force to a state that already contains the effect of the other
    /// forces.
    pub fn advance(&mut self, table: &StepResponse, state: &mut State, in_step: ForceInStep) {
        let ForceInStep { forces: [middle, end], ratio, .. } = in_step;
        let driven = table.driven(NODES[1], &self.inputs([&self.now, &middle, &end]));
        state.modes.iter_mut().zip(driven).for_each(|(z, driven)| *z += driven);
        let begin = std::mem::replace(&mut self.now, end.clone());
        self.last = Some(Last { forces: [begin, middle, end], step: table.step, ratio });
    }

    /// First guess of the forces at the middle and the end of a step: extrapolation of the last step's quadratic.
    fn guess(&self, step: f64) -> [DVector<f64>; 2] {
        let Some(Last { forces, step: last, .. }) = &self.last else { return [self.now.clone(), self.now.clone()] };
        [0.5, 1.0].map(|part| {
            let tau = part * step / last;
            let weights = [tau * (1.0 + 2.0 * tau), -4.0 * tau * (1.0 + tau), 1.0 + tau * (3.0 + 2.0 * tau)];
            sum(weights, forces.each_ref())
        })
    }

    /// Inputs of the modal coordinates due to internal forces.
    fn inputs(&self, forces: [&DVector<f64>; 3]) -> [Vec<Complex<f64>>; 3] {
        forces.map(|force| match &self.modes.force_inputs {
            None => force.iter().map(|f| Complex::new(*f, 0.0)).collect(),
            Some(inputs) => inputs.times(force),
        })
    }

    /// Inputs due to the internal force and the contact force.
    fn with_contact(&self, inputs: &[Vec<Complex<f64>>; 3], force: [f64; 3]) -> [Vec<Complex<f64>>; 3] {
        [0, 1, 2].map(|node| {
            let both = self.modes.modes.iter().zip(&inputs[node]);
            both.map(|(mode, input)| mode.input * force[node] + input).collect()
        })
    }

    /// Displacement of the surface away from the impactor due to inputs, at a point of [`SAMPLE_POINTS`], m.
    fn moved(&self, table: &StepResponse, sample: usize, inputs: &[Vec<Complex<f64>>; 3]) -> f64 {
        let driven = table.driven(sample, inputs);
        self.modes.modes.iter().zip(driven).map(|(mode, z)| real_product(mode.output, z)).sum()
    }

    /// Numerical energy ΔU + ∫ f·ẋ dt over a step, J, where the force f is a quadratic in time. It is needed only with
    /// dampers; without them the residual of the energy balance contains it.
    fn made(
        &self,
        table: &StepResponse,
        state: &State,
        [a, b, c]: [&DVector<f64>; 3],
        inputs: &[Vec<Complex<f64>>; 3],
    ) -> f64 {
        if self.modes.forms.damped.is_none() {
            return 0.0;
        }
        let at = |sample: usize| {
            let mut z = table.left_alone(sample, state);
            z.iter_mut().zip(table.driven(sample, inputs)).for_each(|(z, driven)| *z += driven);
            self.modes.places(&z)
        };
        let places: Vec<DVector<f64>> =
            std::iter::once(self.modes.places(&state.modes)).chain((0..SAMPLE_POINTS.len()).map(at)).collect();
        // ∫f ẋ dt = [f x] − ∫ḟ x dt, where ḟ is linear and x is integrated by Boole's rule.
        let weights = [7.0, 32.0, 12.0, 32.0, 7.0];
        let slope = |tau: f64| (b * 4.0 - a * 3.0 - c) + (a * 2.0 - b * 4.0 + c * 2.0) * (2.0 * tau);
        let inside: f64 = (0..5).map(|k| weights[k] / 90.0 * slope(0.25 * k as f64).dot(&places[k])).sum();
        let work = c.dot(&places[4]) - a.dot(&places[0]) - inside;
        let at_rest = self.law.force_at_rest().dot(&(&places[4] - &places[0]));
        self.law.energy(&places[4]) - self.law.energy(&places[0]) + at_rest + work
    }
}
