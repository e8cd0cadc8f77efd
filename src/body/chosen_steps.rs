//! Selection of modes when the time steps are chosen by error control. Viscoelastic bodies then need more modes than
//! the time steps resolve.

use super::modes::{Closed, Spectrum};

/// Factor on the cutoff frequency of the modes of a viscoelastic body when the time steps are chosen. For a laminate
/// with an interlayer that relaxes to a thousandth, a factor of six gives an error of 1.3e-3, and a factor of two gives
/// 1.9e-2. Prescribed time steps are unstable with modes that they do not resolve.
const FASTER: f64 = 6.0;

/// Fraction of all modes above which a viscoelastic body takes all of them.
const ALL_MODES_FRACTION: f64 = 0.7;

/// Largest number of modes that are all kept when the time steps are chosen. So few modes lie far apart. Two time step
/// lengths would then leave out the same modes, and their difference would not show the resulting error.
pub const FEW_MODES: usize = 15;

impl Spectrum {
    /// Returns the ratio of the cutoff frequency of the modes to the frequency that the chosen time steps resolve. A
    /// mode that is replaced by a spring keeps its modulus for good. In a viscoelastic body, therefore, only modes too
    /// fast for any time step are replaced.
    pub fn cutoff_ratio(&self) -> f64 {
        if self.relaxes { FASTER } else { 1.0 }
    }

    /// Returns the number of modes for chosen time steps, which no mode makes unstable. It is [`Self::count`], except
    /// that all modes are taken if there are few, or if most modes of a viscoelastic body take part. Computing these
    /// modes is expensive, and the full set can be reused for other time steps.
    pub fn count_of_chosen_steps(&self, cutoff: f64, closed: &Closed) -> usize {
        let (count, all) = (self.count(cutoff, closed), self.count_of_all());
        let takes_all = all <= FEW_MODES || (self.relaxes && count as f64 >= ALL_MODES_FRACTION * all as f64);
        if takes_all { all } else { count }
    }
}
