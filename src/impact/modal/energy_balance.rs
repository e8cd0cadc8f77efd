//! Energy balance in modal coordinates.
//!
//! The linear part is exact: the energy of body and impactor changes by the work of the quadratic force F, −∫F δ̇ dt,
//! to rounding. The numerical energy of a step is therefore ΔV + ∫F_d δ̇ dt − ∫F δ̇ dt, where V is the potential of the
//! contact and F_d its damping force.

use nalgebra::DVector;

use crate::body::{Modes, real_parts};
use crate::contact::Law;
use crate::impact::ImpactParameters;
use crate::impact::step::Energy;
use crate::scheme::modal::{quadratic, slopes};

use super::motion::Taken;
use super::step_response::State;

/// Sums of the exchanged energy since t = 0, J, for the modelled part.
#[derive(Debug, Clone, Copy, Default)]
pub struct EnergyBalance {
    numerical: f64,
    /// Energy dissipated by the damping of the contact.
    of_contact: f64,
    initial: Option<f64>,
    /// Product of the loads with the displacement at t = 0.
    before: Option<f64>,
}

impl EnergyBalance {
    /// Accounts for a step; `potential` is the change of the contact law's potential, J.
    pub fn account(&mut self, taken: &Taken, law: &Law, potential: f64) {
        // ∫F δ̇ dt = [F δ] − ∫Ḟ δ dt. Since δ is the quartic through its five values and Ḟ is linear, Boole's rule is
        // exact.
        let [a, b, c] = taken.force;
        let slope = |tau: f64| 4.0 * b - 3.0 * a - c + 2.0 * tau * (2.0 * a - 4.0 * b + 2.0 * c);
        let weights = [7.0, 32.0, 12.0, 32.0, 7.0];
        let inside: f64 = (0..5).map(|k| weights[k] / 90.0 * slope(0.25 * k as f64) * taken.approach[k]).sum();
        let ends = quadratic(taken.force, 1.0) * taken.approach[4] - a * taken.approach[0];
        let mut damped = 0.0;
        if law.damping > 0.0 {
            let rates = slopes(taken.approach, taken.step);
            let power = |k: usize| {
                let at = law.damped(taken.approach[k], rates[k]);
                (at.force - at.elastic) * rates[k]
            };
            damped = (0..5).map(|k| weights[k] / 90.0 * power(k)).sum::<f64>() * taken.step;
        }
        self.of_contact += damped;
        self.numerical += potential + damped - (ends - inside) + taken.made;
    }

    /// Returns the energies of the whole body at a state with its vibration. The last argument is the contact force
    /// (N), the potential of the contact (J) and the energy of springs that lifted-off foundations do not have (J).
    pub fn energy(
        &mut self,
        (modes, parameters): (&Modes, &ImpactParameters),
        state: &State,
        (x, v): &Vibration,
        (force, contact, absent): (f64, f64, f64),
    ) -> Energy {
        let forms = &modes.forms;
        let of_support = 0.5 * forms.support.squared_norm_of_product(x);
        let support = of_support - forms.support_load.dot(x) + forms.support_offset - absent;
        let bent = match &forms.relaxing {
            None => 0.5 * forms.squares.iter().zip(x).map(|(square, x)| square * x * x).sum::<f64>(),
            Some(relaxing) => relaxing.energy(x, &state.modes),
        };
        let elastic = bent - of_support + 0.5 * modes.residual * force * force + state.settled * forms.rest;
        let free = modes.free;
        let (impulse, t) = (state.impulse, state.time);
        let moving = free.mobility * impulse * impulse + 2.0 * free.load * impulse * t + free.square * t * t;
        let kinetic = 0.5 * (v.norm_squared() + moving);
        let impactor = 0.5 * parameters.mass * state.impactor[1] * state.impactor[1];
        let of_weight = parameters.weight * state.impactor[0];
        let external = forms.load.dot(x) - *self.before.get_or_insert_with(|| forms.load.dot(x))
            + free.load * state.way
            + 0.5 * free.square * t * t
            + of_weight;
        let total = kinetic + elastic + support + impactor + contact;
        let initial = *self.initial.get_or_insert(total - external);
        // Without dampers, viscoelastic parts and outgoing waves, the residual of the balance is the numerical energy.
        let off = total - external - initial;
        let (dissipated, numerical) = match forms.damped.is_some() || forms.is_open {
            false => (self.of_contact, off + self.of_contact),
            true => (self.numerical - off, self.numerical),
        };
        let n = parameters.multiplicity;
        Energy {
            kinetic: n * kinetic,
            elastic: n * elastic,
            support: n * support,
            impactor: n * impactor,
            contact: n * contact,
            dissipated: n * dissipated,
            external: n * external,
            numerical: n * numerical,
            total: n * total,
        }
    }
}

/// Displacements x and velocities v of the vibrations.
pub(super) type Vibration = (DVector<f64>, DVector<f64>);

/// Returns the vibration of a state.
pub(super) fn coordinates(modes: &Modes, state: &State) -> Vibration {
    let z = &state.modes;
    if let Some([places, speeds]) = &modes.forms.damped {
        return (real_parts(places, z), real_parts(speeds, z));
    }
    // The coordinates of short waves, after those of the vibrations, are not part of x and v.
    let count = modes.forms.frequencies.len();
    let speeds = DVector::from_iterator(count, z.iter().take(count).map(|z| z.re));
    (modes.places(z), speeds)
}
