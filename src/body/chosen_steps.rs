//! Modes of a body that relaxes in steps that are chosen by the error: more of them than steps of the size resolve.

use super::modes::{Closed, Spectrum};

/// The frequency up to which the modes of such a body move in chosen steps over that of others. (With six times the frequency, a laminate whose
/// interlayer falls to a thousandth is off by 1.3e-3 where it is 1.9e-2 off with twice. Given steps are unstable with modes that they do not
/// resolve.)
const FASTER: f64 = 6.0;

/// Modes over all of them from which on a body that relaxes takes all.
const MOST: f64 = 0.7;

/// Modes of a body that all move in chosen steps: so few lie far apart, so that steps of two lengths leave out the same ones, and their difference does not
/// show what that changes.
pub const FEW_MODES: usize = 15;

impl Spectrum {
    /// The frequency up to which modes move in steps that are chosen, over that which the steps resolve: a mode that is left out as a spring
    /// has its modulus for good, so that of what relaxes only those are that are too fast for any steps.
    pub fn faster(&self) -> f64 {
        if self.relaxes { FASTER } else { 1.0 }
    }

    /// [`Self::count`] in steps that are chosen, which no mode makes unstable: a body with few modes takes all of them, and so does one that relaxes where most of them take
    /// part. Finding modes is expensive; all of them can be used again for steps of another size.
    pub fn count_of_chosen_steps(&self, cutoff: f64, closed: &Closed) -> usize {
        let (count, all) = (self.count(cutoff, closed), self.squares.len());
        let takes_all = all <= FEW_MODES || (self.relaxes && count as f64 >= MOST * all as f64);
        if takes_all { all } else { count }
    }
}
