//! Unilateral foundations in a step. The modes contain two-way springs; where the body has lifted off, the excess pull
//! λ of these springs is applied as an additional force.
//!
//! Over a step, λ of each point is a quadratic in time through its values at 0, h/2 and h, like the contact force. At
//! h/2 and h it satisfies λ = k⟨−g⟩. A foundation is soft compared with the inertia of the body in a step, so forces
//! and displacements are found by fixed-point iteration. The contact's own equations are solved in each iteration. If
//! the iteration does not converge, the step is too large.

use nalgebra::{Complex, DVector};

use crate::body::{ModalFoundation, Modes};

use super::step_response::{NODES, SAMPLE_POINTS, State, StepResponse, real_product};

/// Convergence tolerance: estimated change of the forces in the next iteration, relative to the forces of springs at
/// all points.
const FOUND: f64 = 1e-11;

/// Largest number of iterations; and the iteration from which on each must halve the change.
const MAX_ITERATIONS: usize = 60;
const FIRST_CHECKED_ITERATION: usize = 4;

/// Safety factor on the convergence ratio of the last step, when it is used for the first iteration of a step.
const CAUTION: f64 = 10.0;

/// State of the unilateral foundations of a body in motion.
pub struct FoundationState<'a> {
    modes: &'a Modes,
    foundation: &'a ModalFoundation,
    /// Forces at the state reached.
    now: ForceState,
    last: Option<Last>,
}

/// Forces of a foundation.
#[derive(Clone)]
struct ForceState {
    /// Excess pull λ of the points minus its value in equilibrium, N.
    at_points: DVector<f64>,
    /// Generalised forces on the vibrations.
    along: DVector<f64>,
}

/// Results of the last step, which serve as the first guess for the next.
struct Last {
    /// Forces at 0, h/2 and h.
    pulls: [ForceState; 3],
    /// Step size h, s.
    step: f64,
    /// Convergence ratio: change in the last iteration over the change in the one before.
    ratio: Option<f64>,
}

/// Foundation forces of a step.
pub struct FoundationForces {
    /// Forces at h/2 and h.
    pulls: [ForceState; 2],
    ratio: Option<f64>,
    /// Numerical energy of the step, J, for bodies with dampers (otherwise 0): −Δ(½ λ²/k) minus the work of λ.
    pub made: f64,
}

impl ForceState {
    fn new(foundation: &ModalFoundation, at_points: DVector<f64>) -> Self {
        let along = -foundation.forces(&at_points);
        Self { at_points, along }
    }

    /// Linear combination Σ w p of three sets of forces.
    fn sum(weights: [f64; 3], pulls: [&Self; 3]) -> Self {
        let of = |part: fn(&Self) -> &DVector<f64>| {
            let mut sum = part(pulls[0]) * weights[0];
            sum.axpy(weights[1], part(pulls[1]), 1.0);
            sum.axpy(weights[2], part(pulls[2]), 1.0);
            sum
        };
        Self { at_points: of(|pull| &pull.at_points), along: of(|pull| &pull.along) }
    }
}

impl<'a> FoundationState<'a> {
    /// Sets up the foundations at a state; `None` if there are none.
    pub fn new(modes: &'a Modes, state: &State) -> Option<Self> {
        let foundation = modes.foundation.as_ref()?;
        let penetrations = foundation.penetrations(&modes.places(&state.modes));
        let now = ForceState::new(foundation, foundation.points.pull(&penetrations));
        Some(Self { modes, foundation, now, last: None })
    }

    /// Energy of the springs that the foundations do not have where the body has lifted off, J.
    pub fn energy(&self) -> f64 {
        self.foundation.points.energy(&self.now.at_points)
    }

    /// Solves a step from a state. `free` is δ at [`SAMPLE_POINTS`] without any force. `contact` receives δ at [`SAMPLE_POINTS`] under
    /// the foundation forces; it returns a result of its own and F at 0, h/2 and h. `None` if either is not found.
    pub fn solve<T>(
        &self,
        table: &StepResponse,
        state: &State,
        free: [f64; 4],
        mut contact: impl FnMut([f64; 4]) -> Option<(T, [f64; 3])>,
    ) -> Option<(T, FoundationForces)> {
        let points = &self.foundation.points;
        let alone = NODES.map(|sample| table.left_alone(sample, state));
        let mut pulls = self.guess(table.step);
        let mut ratio = self.last.as_ref().and_then(|last| {
            let longer = (table.step / last.step).max(1.0);
            last.ratio.map(|ratio| CAUTION * ratio * longer * longer)
        });
        let mut before = f64::INFINITY;
        for turn in 0..MAX_ITERATIONS {
            let inputs = self.inputs([&self.now, &pulls[0], &pulls[1]]);
            let moved = [0, 1, 2, 3].map(|sample| self.moved(table, sample, &inputs));
            let (found, force) = contact([0, 1, 2, 3].map(|sample| free[sample] - moved[sample]))?;
            let all = self.with_contact(&inputs, force);
            let penetrations = [0, 1].map(|node| {
                let mut z = table.driven(NODES[node], &all);
                z.iter_mut().zip(&alone[node]).for_each(|(z, alone)| *z += alone);
                self.foundation.penetrations(&self.modes.places(&z))
            });
            let next = penetrations.each_ref().map(|g| points.pull(g));
            let change: f64 = next.iter().zip(&pulls).map(|(next, pull)| (next - &pull.at_points).lp_norm(1)).sum();
            let size: f64 = penetrations.iter().map(|g| points.stiffness.dot(&g.abs())).sum();
            if turn > 0 {
                ratio = Some(change / before);
            }
            if change == 0.0 || ratio.is_some_and(|ratio| ratio * change <= FOUND * size) {
                let made = self.made(table, state, [&self.now, &pulls[0], &pulls[1]], &all);
                if change > 0.0 {
                    pulls = next.map(|next| ForceState::new(self.foundation, next));
                }
                let ratio = if turn > 0 { ratio } else { self.last.as_ref().and_then(|last| last.ratio) };
                return Some((found, FoundationForces { pulls, ratio, made }));
            }
            if !change.is_finite() || turn >= FIRST_CHECKED_ITERATION && change > 0.5 * before {
                return None;
            }
            before = change;
            pulls = next.map(|next| ForceState::new(self.foundation, next));
        }
        None
    }

    /// Completes a step: adds the effect of the foundation forces to a state that already contains the effect of the
    /// other forces.
    pub fn advance(&mut self, table: &StepResponse, state: &mut State, pulled: FoundationForces) {
        let FoundationForces { pulls: [middle, end], ratio, .. } = pulled;
        let driven = table.driven(NODES[1], &self.inputs([&self.now, &middle, &end]));
        state.modes.iter_mut().zip(driven).for_each(|(z, driven)| *z += driven);
        let begin = std::mem::replace(&mut self.now, end.clone());
        self.last = Some(Last { pulls: [begin, middle, end], step: table.step, ratio });
    }

    /// First guess of the forces at the middle and the end of a step: extrapolation of the last step's quadratic.
    fn guess(&self, step: f64) -> [ForceState; 2] {
        let Some(Last { pulls, step: last, .. }) = &self.last else { return [self.now.clone(), self.now.clone()] };
        [0.5, 1.0].map(|part| {
            let tau = part * step / last;
            let weights = [tau * (1.0 + 2.0 * tau), -4.0 * tau * (1.0 + tau), 1.0 + tau * (3.0 + 2.0 * tau)];
            ForceState::sum(weights, pulls.each_ref())
        })
    }

    /// Inputs of the modal coordinates due to the foundation forces.
    fn inputs(&self, pulls: [&ForceState; 3]) -> [Vec<Complex<f64>>; 3] {
        pulls.map(|pull| match &self.foundation.inputs {
            None => pull.along.iter().map(|f| Complex::new(*f, 0.0)).collect(),
            Some(inputs) => inputs.times(&pull.along),
        })
    }

    /// Inputs due to the foundation forces and the contact force.
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

    /// Numerical energy −Δ(½ λ²/k) minus the work of λ over a step, J. It is needed only with dampers; without them the
    /// residual of the energy balance contains it.
    fn made(
        &self,
        table: &StepResponse,
        state: &State,
        pulls: [&ForceState; 3],
        inputs: &[Vec<Complex<f64>>; 3],
    ) -> f64 {
        let points = &self.foundation.points;
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
        let [a, b, c] = pulls.map(|pull| -&pull.along);
        // ∫λ ġ dt = [λ g] − ∫λ̇ g dt, where λ̇ is linear and g is integrated by Boole's rule.
        let weights = [7.0, 32.0, 12.0, 32.0, 7.0];
        let slope = |tau: f64| (&b * 4.0 - &a * 3.0 - &c) + (&a * 2.0 - &b * 4.0 + &c * 2.0) * (2.0 * tau);
        let inside: f64 = (0..5).map(|k| weights[k] / 90.0 * slope(0.25 * k as f64).dot(&places[k])).sum();
        let work = c.dot(&places[4]) - a.dot(&places[0]) - inside;
        let resting = self.foundation.forces(&points.resting).dot(&(&places[4] - &places[0]));
        points.energy(&pulls[0].at_points) - points.energy(&pulls[2].at_points) - resting - work
    }
}
