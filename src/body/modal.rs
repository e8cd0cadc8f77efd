//! A body in modal coordinates, for modal time integration.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use super::modes::{Closed, Modes, Spectrum};
use super::{BodyTerms, ContactPort, Projection};
use crate::contact::Footprint;
use crate::error::{Error, Result};
use crate::material::Maxwell;

/// Number of recent sets of modes that are stored, for runs of one scene that need them again.
const KEPT: usize = 4;

/// Modes of a body, with its data for the contact law.
pub struct ModalBody {
    source: Source,
    /// Reduced body that the modes are computed from; only for a viscoelastic body.
    relaxing: Option<Box<Projection>>,
    /// Recently requested modes of a viscoelastic body.
    known: RefCell<VecDeque<Known>>,
    /// Local compliance c_l of the contact law, m/N, of the modelled part.
    pub compliance: f64,
    /// Number of such parts that form the whole.
    pub multiplicity: f64,
    /// Distribution of the contact force on the surface.
    pub footprint: Footprint,
}

/// Modes of a viscoelastic body. They are expensive, and runs of one scene often need the same ones.
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
    /// Creates a body from given modes, all of which are used.
    pub fn given(modes: Modes) -> Self {
        let source = Source::Given(Rc::new(modes));
        Self {
            source,
            relaxing: None,
            known: RefCell::default(),
            compliance: 0.0,
            multiplicity: 1.0,
            footprint: Footprint::Point,
        }
    }

    /// Creates a body from its projection onto a basis.
    pub fn of(projection: &Projection) -> Self {
        let relaxing = (!projection.terms.relaxations.is_empty()).then(|| Box::new(projection.clone()));
        Self { relaxing, ..Self::of_spectrum(Spectrum::new(projection), projection) }
    }

    /// Creates a body from its projection onto a basis, with the frequency ω (rad/s) of each vibration multiplied by
    /// `ratio` of it. Viscoelastic parts have their moduli at the shift of the basis.
    pub fn retuned(projection: &Projection, ratio: impl Fn(f64) -> f64) -> Self {
        Self::of_spectrum(Spectrum::new(projection).retuned(ratio), projection)
    }

    fn of_spectrum(spectrum: Spectrum, projection: &Projection) -> Self {
        let BodyTerms { multiplicity, contact: ContactPort { compliance, footprint, .. }, .. } = projection.terms;
        let source = Source::Spectrum(Box::new(spectrum));
        Self { source, relaxing: None, known: RefCell::default(), compliance, multiplicity, footprint }
    }

    /// Returns the body with other Prony series for its viscoelastic parts, in the same order, on the same basis.
    /// `None` if the series are equal to the present ones.
    ///
    /// # Errors
    /// [`Error::Solve`] if the numbers of series and of viscoelastic parts differ. This happens because two materials
    /// may have equal series at one temperature only.
    pub fn with_chains(&self, chains: &[Maxwell]) -> Result<Option<Self>> {
        let own =
            self.relaxing.iter().flat_map(|projection| projection.terms.relaxations.iter().map(|part| &part.chain));
        let count = own.clone().count();
        if count != chains.len() {
            let message = format!("a basis for {count} relaxing materials does not serve {}", chains.len());
            return Err(Error::Solve(message));
        }
        let is_another = !own.eq(chains);
        Ok(self.relaxing.iter().find(|_| is_another).map(|projection| Self::of(&projection.with_chains(chains))))
    }

    /// Highest frequency of the modes that unilateral foundations stiffen, rad/s. Time steps must resolve it, because
    /// the body can lift off the foundations.
    pub fn stiffened(&self) -> f64 {
        match &self.source {
            Source::Given(_) => 0.0,
            Source::Spectrum(spectrum) => spectrum.stiffened(),
        }
    }

    /// Whether loads act on the body.
    pub fn is_loaded(&self) -> bool {
        matches!(&self.source, Source::Spectrum(spectrum) if spectrum.is_loaded())
    }

    /// Returns all modes. They are for motions without a contact: in steps that do not resolve them, a contact would be
    /// unstable.
    ///
    /// # Errors
    /// Same as [`Self::modes`].
    pub fn all_modes(&self, closed: &Closed) -> Result<Rc<Modes>> {
        self.counted(closed, Spectrum::count_of_all)
    }

    /// Ratio of the cutoff frequency of the modes to the frequency that chosen time steps resolve.
    pub fn cutoff_ratio(&self) -> f64 {
        match &self.source {
            Source::Given(_) => 1.0,
            Source::Spectrum(spectrum) => spectrum.cutoff_ratio(),
        }
    }

    /// Returns the modes up to a frequency (rad/s) during contact. The other modes are replaced by their static
    /// response.
    ///
    /// # Errors
    /// [`crate::Error::Solve`] if dampers leave the body without independent modes.
    pub fn modes(&self, cutoff: f64, closed: &Closed) -> Result<Rc<Modes>> {
        self.counted(closed, |spectrum| spectrum.count(cutoff, closed))
    }

    /// Same as [`Self::modes`] for chosen time steps ([`Spectrum::count_of_chosen_steps`]).
    ///
    /// # Errors
    /// Same as [`Self::modes`].
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
        // (Only exact matches are reused: a result must not depend on earlier requests.)
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
