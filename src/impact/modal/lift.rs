//! What unilateral foundations do in a step: λ, by which their springs pull too much where the body has lifted off, as forces beside
//! the contact's.
//!
//! Over a step each point's λ is, as the contact's force, the quadratic in time through its values at 0, h/2 and h, and at the latter two
//! it satisfies λ = k⟨−g⟩. Foundations are soft against what a body's mass resists in a step: the fixed point of forces and
//! displacements is found by turns, with the contact's own equations solved in each. Where that does not close in, the step is too large.

use nalgebra::{Complex, DVector};

use crate::body::{ModalFoundation, Modes};

use super::answer::{Answer, LOOKS, NODES, State, real_product};

/// Change of the forces in a turn over those of springs everywhere, at which they are found.
const FOUND: f64 = 1e-12;

/// Turns at most; and from which on each must halve the change.
const MOST: usize = 60;
const FIRST: usize = 4;

/// The foundations of a body on its way.
pub struct Lift<'a> {
    modes: &'a Modes,
    foundation: &'a ModalFoundation,
    /// λ less that in equilibrium, N, at the state reached.
    now: DVector<f64>,
    /// The same at the nodes of the last step, and its size, s.
    last: Option<([DVector<f64>; 3], f64)>,
}

/// A step's forces.
pub struct Pulled {
    /// λ less that in equilibrium at 0, h/2 and h, N.
    forces: [DVector<f64>; 3],
    /// What they drive the coordinates by; `None` where there are none.
    inputs: Option<[Vec<Complex<f64>>; 3]>,
    /// Energy that the step makes, with dampers, J: what potential the springs gain where they are none, and its work.
    pub made: f64,
}

impl<'a> Lift<'a> {
    /// At a state; `None` without foundations.
    pub fn new(modes: &'a Modes, state: &State) -> Option<Self> {
        let foundation = modes.foundation.as_ref()?;
        let now = foundation.points.pull(&foundation.points.penetration(&modes.places(&state.modes)));
        Some(Self { modes, foundation, now, last: None })
    }

    /// The energy that springs have, and foundations have not, J.
    pub fn energy(&self) -> f64 {
        self.foundation.points.energy(&self.now)
    }

    /// Solves a step from a state. `free` is δ at the looks without any force; `contact` finds what it wants to know and F at 0, h/2 and h
    /// from that δ under the foundations' forces. `None` where either is not found.
    pub fn solve<T>(
        &self,
        table: &Answer,
        state: &State,
        free: [f64; 4],
        mut contact: impl FnMut([f64; 4]) -> Option<(T, [f64; 3])>,
    ) -> Option<(T, Pulled)> {
        let points = &self.foundation.points;
        let alone = NODES.map(|look| table.left_alone(look, state));
        let [middle, end] = self.guess(table.step);
        let mut forces = [self.now.clone(), middle, end];
        let mut before = f64::INFINITY;
        for turn in 0..MOST {
            let inputs = self.inputs(&forces);
            let moved = |look: usize| inputs.as_ref().map_or(0.0, |inputs| self.moved(table, look, inputs));
            let (found, force) = contact([0, 1, 2, 3].map(|look| free[look] - moved(look)))?;
            let all = self.with_contact(inputs.as_ref(), force);
            let penetrations = [0, 1].map(|node| {
                let mut z = table.driven(NODES[node], &all);
                z.iter_mut().zip(&alone[node]).for_each(|(z, alone)| *z += alone);
                points.penetration(&self.modes.places(&z))
            });
            let pulls = penetrations.each_ref().map(|g| points.pull(g));
            let change = (&pulls[0] - &forces[1]).lp_norm(1) + (&pulls[1] - &forces[2]).lp_norm(1);
            let size: f64 = penetrations.iter().map(|g| points.stiffness.dot(&g.abs())).sum();
            if change <= FOUND * size {
                let made = self.made(table, state, &forces, &all);
                return Some((found, Pulled { forces, inputs, made }));
            }
            if !change.is_finite() || turn >= FIRST && change > 0.5 * before {
                return None;
            }
            before = change;
            let [middle, end] = pulls;
            (forces[1], forces[2]) = (middle, end);
        }
        None
    }

    /// Takes a step whose other forces the state has already.
    pub fn advance(&mut self, table: &Answer, state: &mut State, pulled: Pulled) {
        if let Some(inputs) = &pulled.inputs {
            let driven = table.driven(NODES[1], inputs);
            state.modes.iter_mut().zip(driven).for_each(|(z, driven)| *z += driven);
        }
        self.now.copy_from(&pulled.forces[2]);
        self.last = Some((pulled.forces, table.step));
    }

    /// λ at the middle and the end of a step, by the last step's carried on.
    fn guess(&self, step: f64) -> [DVector<f64>; 2] {
        let Some(([a, b, c], last)) = &self.last else { return [self.now.clone(), self.now.clone()] };
        [0.5, 1.0].map(|part| {
            let tau = part * step / last;
            let mut guess = c.clone();
            guess.axpy(tau * (3.0 + 2.0 * tau), c, 1.0);
            guess.axpy(-4.0 * tau * (1.0 + tau), b, 1.0);
            guess.axpy(tau * (1.0 + 2.0 * tau), a, 1.0);
            guess.zip_apply(&self.foundation.points.resting, |pull, resting| *pull = pull.max(-resting));
            guess
        })
    }

    /// What the forces drive the coordinates by; `None` where there are none.
    fn inputs(&self, forces: &[DVector<f64>; 3]) -> Option<[Vec<Complex<f64>>; 3]> {
        let points = &self.foundation.points;
        if forces.iter().all(|forces| forces.amax() == 0.0) {
            return None;
        }
        Some(forces.each_ref().map(|forces| {
            let along = -points.rows.tr_mul(forces);
            match &self.foundation.inputs {
                None => along.iter().map(|f| Complex::new(*f, 0.0)).collect(),
                Some(inputs) => (inputs * along.map(|f| Complex::new(f, 0.0))).as_slice().to_vec(),
            }
        }))
    }

    /// The same with those of the contact.
    fn with_contact(&self, inputs: Option<&[Vec<Complex<f64>>; 3]>, force: [f64; 3]) -> [Vec<Complex<f64>>; 3] {
        [0, 1, 2].map(|node| {
            let of_contact = self.modes.modes.iter().map(|mode| mode.input * force[node]);
            match inputs {
                Some(inputs) => of_contact.zip(&inputs[node]).map(|(contact, other)| contact + other).collect(),
                None => of_contact.collect(),
            }
        })
    }

    /// How far inputs move the surface away from the impactor at a look, m.
    fn moved(&self, table: &Answer, look: usize, inputs: &[Vec<Complex<f64>>; 3]) -> f64 {
        let driven = table.driven(look, inputs);
        self.modes.modes.iter().zip(driven).map(|(mode, z)| real_product(mode.output, z)).sum()
    }

    /// −Δ(½ λ²/k) less the work of λ over a step, J, where dampers leave no other account of it.
    fn made(
        &self,
        table: &Answer,
        state: &State,
        forces: &[DVector<f64>; 3],
        inputs: &[Vec<Complex<f64>>; 3],
    ) -> f64 {
        let points = &self.foundation.points;
        if self.modes.forms.damped.is_none() {
            return 0.0;
        }
        let at = |look: usize| {
            let mut z = table.left_alone(look, state);
            z.iter_mut().zip(table.driven(look, inputs)).for_each(|(z, driven)| *z += driven);
            self.modes.places(&z)
        };
        let places: Vec<DVector<f64>> =
            std::iter::once(self.modes.places(&state.modes)).chain((0..LOOKS.len()).map(at)).collect();
        let [a, b, c] = forces.each_ref().map(|forces| points.rows.tr_mul(forces));
        // ∫λ ġ dt = [λ g] − ∫λ̇ g dt: λ̇ is linear, g by Boole's rule.
        let weights = [7.0, 32.0, 12.0, 32.0, 7.0];
        let slope = |tau: f64| (&b * 4.0 - &a * 3.0 - &c) + (&a * 2.0 - &b * 4.0 + &c * 2.0) * (2.0 * tau);
        let inside: f64 = (0..5).map(|k| weights[k] / 90.0 * slope(0.25 * k as f64).dot(&places[k])).sum();
        let work = c.dot(&places[4]) - a.dot(&places[0]) - inside;
        let resting = points.rows.tr_mul(&points.resting).dot(&(&places[4] - &places[0]));
        points.energy(&forces[0]) - points.energy(&forces[2]) - resting - work
    }
}
