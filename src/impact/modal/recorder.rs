//! The steps of a run for observers.
//!
//! Energies, probes and fields follow from the displacements and velocities of the vibrations: products of the modal
//! coordinates with matrices that may be large. These products are formed for many steps at a time.

use nalgebra::{DMatrix, DVectorView};

use crate::body::Modes;
use crate::contact::Law;
use crate::impact::ImpactParameters;
use crate::impact::observer::Observed;
use crate::impact::reading::{Reading, Readout};
use crate::impact::step::{Contact, Energy, Motion as ImpactorMotion, Step};

use super::energy_balance::{EnergyBalance, Exchanged, StrainEnergies};
use super::motion::{Motion, Taken};
use super::reading::{FacesOfSteps, Reader};
use super::step_response::State;

/// Number of steps whose products are formed together.
const AT_ONCE: usize = 128;

/// Records the steps of one run.
pub struct Recorder<'a> {
    modes: &'a Modes,
    parameters: &'a ImpactParameters,
    /// Energies exchanged so far, and the values at t = 0 to which the balance refers; `None` if energies are not
    /// computed.
    energies: Option<(Exchanged, EnergyBalance)>,
    reader: Option<Reader<'a>>,
    /// Steps that are not complete yet.
    moments: Vec<Moment>,
    steps: Vec<Observed>,
}

/// A step without its energies and readings, and the data from which they follow.
pub struct Moment {
    /// The step; its energies are zero.
    pub step: Step,
    /// State of the motion.
    pub state: State,
    /// Contact force on the modelled part, N.
    pub force: f64,
    /// Its rate, N/s.
    pub rise: f64,
    /// Potential of the contact, J.
    pub potential: f64,
    /// Energy of the internal force, J. That of foundations is the negative energy of their springs where the body has
    /// lifted off, which the modes contain.
    pub internal: f64,
    /// Energies exchanged since t = 0, J, for the modelled part.
    exchanged: Exchanged,
}

/// Displacements x and velocities v of the vibrations, one column for each step.
pub struct Vibrations {
    /// Displacements x.
    pub places: DMatrix<f64>,
    /// Velocities v.
    pub speeds: DMatrix<f64>,
}

impl Vibrations {
    /// The vibrations at some moments.
    fn new(modes: &Modes, moments: &[Moment]) -> Self {
        if let Some([places, speeds]) = &modes.forms.damped {
            let states: Vec<_> = moments.iter().map(|moment| &moment.state.modes[..]).collect();
            let [places, speeds] = [places, speeds].map(|matrix| matrix.real_parts_of(&states));
            return Self { places, speeds };
        }
        // The coordinates of short waves, after those of the vibrations, are not part of x and v.
        let frequencies = &modes.forms.frequencies;
        let of = |part: &dyn Fn(usize, usize) -> f64| DMatrix::from_fn(frequencies.len(), moments.len(), part);
        Self {
            places: of(&|i, k| moments[k].state.modes[i].im / frequencies[i]),
            speeds: of(&|i, k| moments[k].state.modes[i].re),
        }
    }

    /// Vibrations without values for a number of moments, if none are needed.
    fn none(moments: usize) -> Self {
        let none = DMatrix::zeros(0, moments);
        Self { places: none.clone(), speeds: none }
    }

    /// Displacements x and velocities v at the moment with this number.
    fn at(&self, number: usize) -> [DVectorView<'_, f64>; 2] {
        [&self.places, &self.speeds].map(|all| all.column(number))
    }
}

impl<'a> Recorder<'a> {
    /// Begins a record of a run with these modes.
    pub fn new(
        modes: &'a Modes,
        parameters: &'a ImpactParameters,
        has_energies: bool,
        readout: Option<&'a Readout>,
    ) -> Self {
        Self {
            modes,
            parameters,
            energies: has_energies.then(Default::default),
            reader: readout.map(|readout| Reader::new(readout, modes)),
            moments: Vec::new(),
            steps: Vec::new(),
        }
    }

    /// Accounts for the energy exchanged in a step; `before` is the approach at its beginning, m.
    pub fn account(&mut self, taken: &Taken, motion: &Motion, before: f64) {
        if let Some((exchanged, _)) = &mut self.energies {
            let law = motion.law();
            exchanged.account(taken, law, law.potential(motion.approach) - law.potential(before));
        }
    }

    /// Records the present step.
    pub fn record(&mut self, number: usize, motion: &Motion) {
        let exchanged = self.energies.as_ref().map_or_else(Exchanged::default, |(exchanged, _)| *exchanged);
        self.moments.push(self.moment(number, motion, exchanged));
        if self.moments.len() == AT_ONCE {
            self.complete();
        }
    }

    /// Returns all steps, and the data for the stresses on the faces.
    pub fn finish(mut self) -> (Vec<Observed>, Option<FacesOfSteps>) {
        self.complete();
        (self.steps, self.reader.and_then(Reader::finish))
    }

    fn moment(&self, number: usize, motion: &Motion, exchanged: Exchanged) -> Moment {
        let (modes, parameters) = (self.modes, self.parameters);
        let (state, force, rise) = (motion.state.clone(), motion.force, motion.rise());
        // The true approach is δ = δ_modes − r F, where r is the static compliance of the modes left out.
        let law: &Law = motion.law();
        let surface = state.surface(modes) + modes.residual * force + state.settled * modes.rest;
        let step = Step {
            number,
            time: state.time,
            impactor: ImpactorMotion {
                position: state.impactor[0],
                velocity: state.impactor[1],
                acceleration: force / parameters.mass,
            },
            contact: Contact {
                force: parameters.multiplicity * force,
                indentation: law.indentation(motion.approach, force),
                surface_displacement: parameters.surface(surface, force),
                approach: motion.approach - modes.residual * force,
                rate: motion.rate() - modes.residual * rise,
                impulse: parameters.impulse(state.impactor[1], state.time),
            },
            energy: Energy::default(),
        };
        let potential = law.potential(motion.approach) - 0.5 * modes.residual * force * force;
        Moment { step, state, force, rise, potential, internal: motion.internal_energy(), exchanged }
    }

    /// Completes all steps recorded so far.
    fn complete(&mut self) {
        let moments = std::mem::take(&mut self.moments);
        let reads = self.reader.as_ref().is_some_and(Reader::needs_vibrations);
        let vibrations = match reads || self.energies.is_some() {
            true => Vibrations::new(self.modes, &moments),
            false => Vibrations::none(moments.len()),
        };
        let bent = self.energies.as_ref().map(|_| {
            let states: Vec<_> = moments.iter().map(|moment| &moment.state.modes[..]).collect();
            StrainEnergies::new(&self.modes.forms, &vibrations, &states)
        });
        for (k, mut moment) in moments.into_iter().enumerate() {
            let vibration = vibrations.at(k);
            if let (Some((_, balance)), Some(bent)) = (&mut self.energies, &bent) {
                let of_step = (self.modes, self.parameters);
                moment.step.energy = balance.energy(of_step, &moment, vibration, bent.at(k), moment.exchanged);
            }
            let reading = self.reader.as_mut().map_or_else(Reading::default, |reader| reader.read(&moment, vibration));
            self.steps.push(Observed { step: moment.step, reading });
        }
    }
}
