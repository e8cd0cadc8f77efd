//! A body for steps in modal coordinates.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use super::Projection;
use super::modes::{Closed, Modes, Spectrum};
use crate::contact::Patch;
use crate::error::{Error, Result};
use crate::material::Maxwell;

/// Sets of modes that are kept: those that runs of one scene ask for again.
const KEPT: usize = 4;

/// Modes, with what the contact law needs of the body.
pub struct ModalBody {
    source: Source,
    /// What it was made of, where it relaxes.
    relaxing: Option<Box<Projection>>,
    /// The modes that were asked for last, where it relaxes.
    known: RefCell<VecDeque<Known>>,
    /// c_l of the contact law, m/N, of the modelled part.
    pub compliance: f64,
    /// How many such parts make the whole.
    pub copies: f64,
    /// The patch, where there is one.
    pub patch: Option<Patch>,
}

/// Modes of a body that relaxes, which take long: runs of one scene often ask for the same.
struct Known {
    count: usize,
    accuracy: f64,
    end: f64,
    modes: Rc<Modes>,
}

enum Source {
    Given(Rc<Modes>),
    Spectrum(Box<Spectrum>),
}

impl ModalBody {
    /// A body of given modes, all of which take part.
    pub fn given(modes: Modes) -> Self {
        let source = Source::Given(Rc::new(modes));
        Self { source, relaxing: None, known: RefCell::default(), compliance: 0.0, copies: 1.0, patch: None }
    }

    /// A body on a basis.
    pub fn of(projection: &Projection) -> Self {
        let Projection { compliance, copies, patch, .. } = *projection;
        let source = Source::Spectrum(Box::new(Spectrum::new(projection)));
        let relaxing = (!projection.relaxations.is_empty()).then(|| Box::new(projection.clone()));
        Self { source, relaxing, known: RefCell::default(), compliance, copies, patch }
    }

    /// The body whose relaxing parts have other chains, in their order, on the same basis; `None` where it has them already.
    ///
    /// # Errors
    /// [`Error::Solve`] where there are as many relaxing parts as chains no more: two materials may relax alike at one temperature only.
    pub fn with_chains(&self, chains: &[Maxwell]) -> Result<Option<Self>> {
        let own = self.relaxing.iter().flat_map(|projection| projection.relaxations.iter().map(|part| &part.chain));
        let count = own.clone().count();
        if count != chains.len() {
            let message = format!("a basis for {count} relaxing materials does not serve {}", chains.len());
            return Err(Error::Solve(message));
        }
        let is_another = !own.eq(chains);
        Ok(self.relaxing.iter().find(|_| is_another).map(|projection| Self::of(&projection.with_chains(chains))))
    }

    /// The frequency up to which steps must resolve the motion, since unilateral foundations let go of it, rad/s.
    pub fn stiffened(&self) -> f64 {
        match &self.source {
            Source::Given(_) => 0.0,
            Source::Spectrum(spectrum) => spectrum.stiffened(),
        }
    }

    /// The frequency up to which modes move in chosen steps over that which these resolve.
    pub fn faster(&self) -> f64 {
        match &self.source {
            Source::Given(_) => 1.0,
            Source::Spectrum(spectrum) => spectrum.faster(),
        }
    }

    /// The modes up to a frequency (rad/s) in contact, the others by their static answer.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] where dampers leave the body without independent modes.
    pub fn modes(&self, cutoff: f64, closed: &Closed) -> Result<Rc<Modes>> {
        self.counted(closed, |spectrum| spectrum.count(cutoff, closed))
    }

    /// The same for steps that are chosen ([`Spectrum::count_of_chosen_steps`]).
    ///
    /// # Errors
    /// As [`Self::modes`].
    pub fn modes_of_chosen_steps(&self, cutoff: f64, closed: &Closed) -> Result<Rc<Modes>> {
        self.counted(closed, |spectrum| spectrum.count_of_chosen_steps(cutoff, closed))
    }

    fn counted(&self, closed: &Closed, count: impl Fn(&Spectrum) -> usize) -> Result<Rc<Modes>> {
        let spectrum = match &self.source {
            Source::Given(modes) => return Ok(Rc::clone(modes)),
            Source::Spectrum(spectrum) => spectrum,
        };
        let (count, Closed { accuracy, end, .. }) = (count(spectrum), *closed);
        let mut known = self.known.borrow_mut();
        // (Others that would serve do not: an answer must not depend on what was asked before.)
        if let Some(same) =
            known.iter().find(|known| (known.count, known.accuracy, known.end) == (count, accuracy, end))
        {
            return Ok(Rc::clone(&same.modes));
        }
        let modes = Rc::new(spectrum.modes(count, accuracy, end)?);
        if self.relaxing.is_some() {
            known.truncate(KEPT - 1);
            known.push_front(Known { count, accuracy, end, modes: Rc::clone(&modes) });
        }
        Ok(modes)
    }
}
