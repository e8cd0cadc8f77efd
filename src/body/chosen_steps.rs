//! Modes of a body that relaxes in steps that are chosen by the error: more of them than steps of the size resolve.

use super::modes::{Closed, Spectrum};

/// The frequency up to which the modes of such a body move in chosen steps over that of others. (With six times the frequency, a laminate whose
/// interlayer falls to a thousandth is off by 1.3e-3 where it is 1.9e-2 off with twice. Given steps are unstable with modes that they do not
/// resolve.)
const FASTER: f64 = 6.0;

/// Modes over all of them from which on a body that relaxes takes all.
const MOST: f64 = 0.7;

impl Spectrum {
    /// The frequency up to which modes move in steps that are chosen, over that which the steps resolve: a mode that is left out as a spring
    /// has its modulus for good, so that of what relaxes only those are that are too fast for any steps.
    pub fn faster(&self) -> f64 {
        if self.relaxes { FASTER } else { 1.0 }
    }

    /// [`Self::count`] in steps that are chosen, which no mode makes unstable: a body that relaxes takes all of its modes where most of them take
    /// part. Finding modes is expensive; all of them can be used again for steps of another size.
    pub fn count_of_chosen_steps(&self, cutoff: f64, closed: &Closed) -> usize {
        let (count, all) = (self.count(cutoff, closed), self.squares.len());
        if self.relaxes && count as f64 >= MOST * all as f64 { all } else { count }
    }
}
