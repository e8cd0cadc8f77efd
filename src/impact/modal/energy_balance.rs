//! Energy balance in modal coordinates.
//!
//! The linear part is exact: the energy of body and impactor changes by the work of the quadratic force F, −∫F δ̇ dt,
//! to rounding. The numerical energy of a step is therefore ΔV + ∫F_d δ̇ dt − ∫F δ̇ dt, where V is the potential of the
//! contact and F_d its damping force.

use nalgebra::{Complex, DVectorView};

use crate::body::{Forms, Modes};
use crate::contact::Law;
use crate::impact::ImpactParameters;
use crate::impact::step::Energy;
use crate::scheme::modal::{quadratic, slopes};

use super::motion::Taken;
use super::recorder::{Moment, Vibrations};

/// Sums of the exchanged energy since t = 0, J, for the modelled part.
#[derive(Debug, Clone, Copy, Default)]
pub struct Exchanged {
    numerical: f64,
    /// Energy dissipated by the damping of the contact.
    of_contact: f64,
}

/// Values at t = 0 to which the balance refers, J, for the modelled part; set by the first step.
#[derive(Debug, Clone, Copy, Default)]
pub struct EnergyBalance {
    initial: Option<f64>,
    /// Product of the loads with the displacement.
    before: Option<f64>,
}

/// Energies stored in a vibrating body at some moments, J, for the modelled part.
pub struct StrainEnergies {
    /// Energy of the body with its supports.
    whole: Vec<f64>,
    /// Energy of the supports as if they were at rest.
    support: Vec<f64>,
}

impl StrainEnergies {
    /// The energies at the moments of these vibrations, with their modal coordinates.
    pub fn new(forms: &Forms, vibrations: &Vibrations, states: &[&[Complex<f64>]]) -> Self {
        let places = &vibrations.places;
        let of_squares = |x: nalgebra::DVectorView<f64>| -> f64 {
            0.5 * forms.squares.iter().zip(x.iter()).map(|(square, x)| square * x * x).sum::<f64>()
        };
        let whole = match &forms.relaxing {
            None => places.column_iter().map(of_squares).collect(),
            Some(relaxing) => relaxing.energies(places, states),
        };
        let support = forms.support.squared_norms_of_products(places).into_iter().map(|square| 0.5 * square).collect();
        Self { whole, support }
    }

    /// Energy of the body with its supports, and of the supports alone, at a moment.
    pub fn at(&self, moment: usize) -> [f64; 2] {
        [self.whole[moment], self.support[moment]]
    }
}

impl Exchanged {
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
}

impl EnergyBalance {
    /// Returns the energies of the whole body at a moment with the displacements x and velocities v of its vibrations.
    /// `bent` are the energies of [`StrainEnergies::at`].
    pub fn energy(
        &mut self,
        (modes, parameters): (&Modes, &ImpactParameters),
        moment: &Moment,
        [x, v]: [DVectorView<'_, f64>; 2],
        [bent, of_support]: [f64; 2],
        exchanged: Exchanged,
    ) -> Energy {
        let forms = &modes.forms;
        let Moment { state, force, potential: contact, internal, .. } = moment;
        let support = of_support - forms.support_load.dot(&x) + forms.support_offset + internal;
        let elastic = bent - of_support + 0.5 * modes.residual * force * force + state.settled * forms.rest;
        let free = modes.free;
        let (impulse, t) = (state.impulse, state.time);
        let moving = free.mobility * impulse * impulse + 2.0 * free.load * impulse * t + free.square * t * t;
        let kinetic = 0.5 * (v.norm_squared() + moving);
        let impactor = 0.5 * parameters.mass * state.impactor[1] * state.impactor[1];
        let of_weight = parameters.weight * state.impactor[0];
        let external = forms.load.dot(&x) - *self.before.get_or_insert_with(|| forms.load.dot(&x))
            + free.load * state.way
            + 0.5 * free.square * t * t
            + of_weight;
        let total = kinetic + elastic + support + impactor + contact;
        let initial = *self.initial.get_or_insert(total - external);
        // Without dampers, viscoelastic parts and outgoing waves, the residual of the balance is the numerical energy.
        let off = total - external - initial;
        let (dissipated, numerical) = match forms.damped.is_some() || forms.is_open {
            false => (exchanged.of_contact, off + exchanged.of_contact),
            true => (exchanged.numerical - off, exchanged.numerical),
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
