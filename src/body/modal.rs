//! A body for steps in modal coordinates.

use std::cell::RefCell;
use std::rc::Rc;

use super::Projection;
use super::modes::{Closed, Modes, Spectrum};
use crate::contact::Patch;
use crate::error::{Error, Result};
use crate::material::Maxwell;

/// Numbers of modes that are known and serve, over that which is asked for. (What relaxes has modes up to six times as fast as its steps
/// resolve, of which the last ones are no matter.)
const ENOUGH: [f64; 2] = [0.95, 1.25];

/// Modes, with what the contact law needs of the body.
pub struct ModalBody {
    source: Source,
    /// What it was made of, where it relaxes.
    relaxing: Option<Box<Projection>>,
    /// The modes that were asked for, where it relaxes.
    made: RefCell<Vec<Made>>,
    /// c_l of the contact law, m/N, of the modelled part.
    pub compliance: f64,
    /// How many such parts make the whole.
    pub copies: f64,
    /// The patch, where there is one.
    pub patch: Option<Patch>,
}

/// Modes of a body that relaxes, which take long: steps of different sizes often ask for the same.
struct Made {
    count: usize,
    accuracy: f64,
    modes: Rc<Modes>,
}

enum Source {
    Given(Box<Modes>),
    Spectrum(Box<Spectrum>),
}

impl ModalBody {
    /// A body of given modes, all of which take part.
    pub fn given(modes: Modes) -> Self {
        let source = Source::Given(Box::new(modes));
        Self { source, relaxing: None, made: RefCell::default(), compliance: 0.0, copies: 1.0, patch: None }
    }

    /// A body on a basis.
    pub fn of(projection: &Projection) -> Self {
        let Projection { compliance, copies, patch, .. } = *projection;
        let source = Source::Spectrum(Box::new(Spectrum::new(projection)));
        let relaxing = (!projection.relaxations.is_empty()).then(|| Box::new(projection.clone()));
        Self { source, relaxing, made: RefCell::default(), compliance, copies, patch }
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
        self.modes_within(cutoff, closed, [1.0; 2])
    }

    /// The same, or about as many where these are known and what relaxes makes them dear: for steps that are chosen, and stable with faster modes.
    ///
    /// # Errors
    /// As [`ModalBody::modes`].
    pub fn modes_or_more(&self, cutoff: f64, closed: &Closed) -> Result<Rc<Modes>> {
        self.modes_within(cutoff, closed, if self.faster() > 1.0 { ENOUGH } else { [1.0; 2] })
    }

    fn modes_within(&self, cutoff: f64, closed: &Closed, enough: [f64; 2]) -> Result<Rc<Modes>> {
        let spectrum = match &self.source {
            Source::Given(modes) => return Ok(Rc::new((**modes).clone())),
            Source::Spectrum(spectrum) => spectrum,
        };
        let (count, accuracy) = (spectrum.count(cutoff, closed), closed.accuracy);
        let [least, most] = enough.map(|part| part * count as f64);
        let serves = |made: &&Made| (least..=most).contains(&(made.count as f64)) && made.accuracy <= accuracy;
        if let Some(made) = self.made.borrow().iter().find(serves) {
            return Ok(Rc::clone(&made.modes));
        }
        let modes = Rc::new(spectrum.modes(count, accuracy)?);
        if self.relaxing.is_some() {
            self.made.borrow_mut().push(Made { count, accuracy, modes: Rc::clone(&modes) });
        }
        Ok(modes)
    }
}
