//! Verdict on a scheme and time step, drawn from one run.

use std::fmt;

use super::history::Measured;

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Ending {
    /// The run reached its end.
    Whole,
    /// The energy gate stopped the run, for this reason.
    Unstable(String),
    /// A step was not solved or the range of the contact law was left, for this reason.
    Unsolved(String),
}

/// Verdict on a scheme and time step.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// The errors of energy and contact force are within the tolerance.
    Holds,
    /// The force in the first contact episode differs by more than the tolerance, or more than the tolerance of the
    /// energy is lost.
    Inaccurate,
    /// The energy grows by more than the tolerance, relative to the initial energy.
    Gains,
    /// The motion grows without bound; the reason why the run was stopped.
    Grows(String),
    /// The run could not be completed; the reason.
    Refused(String),
    /// The run was not made because the study was interrupted or its time budget was used up.
    LeftOut,
}

impl Verdict {
    /// Judges a run. `tolerance` is relative to the initial energy, and to the peak of the reference's acceleration.
    pub(super) fn new(ending: Ending, measured: &Measured, tolerance: f64) -> Self {
        let gains = measured.growth - 1.0 > tolerance;
        match ending {
            Ending::Unstable(reason) => Self::Grows(reason),
            Ending::Unsolved(reason) if gains => Self::Grows(reason),
            Ending::Unsolved(reason) => Self::Refused(reason),
            Ending::Whole if gains => Self::Gains,
            Ending::Whole if measured.energy_error <= tolerance && measured.first_error <= tolerance => Self::Holds,
            Ending::Whole => Self::Inaccurate,
        }
    }

    /// Reason why the run was stopped, if it was.
    pub fn reason(&self) -> Option<&str> {
        match self {
            Self::Grows(reason) | Self::Refused(reason) => Some(reason),
            _ => None,
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Holds => "holds",
            Self::Inaccurate => "inaccurate",
            Self::Gains => "gains energy",
            Self::Grows(_) => "grows",
            Self::Refused(_) => "refused",
            Self::LeftOut => "left out",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_follow_from_the_ending_the_energy_and_the_force() {
        let of = |ending: &Ending, growth: f64, energy_error: f64, first_error: f64| {
            let measured =
                Measured { steps: 10, time: 1.0, energy_error, growth, first_error, whole_error: first_error };
            Verdict::new(ending.clone(), &measured, 1e-2).to_string()
        };
        let (whole, stopped) = (Ending::Whole, Ending::Unsolved("why".into()));
        assert_eq!(of(&whole, 1.001, 1e-3, 9e-3), "holds");
        assert_eq!(of(&whole, 1.0, 1e-3, 2e-2), "inaccurate");
        assert_eq!(of(&whole, 1.0, 0.1, 1e-3), "inaccurate");
        assert_eq!(of(&whole, 1.0, 1e-3, f64::NAN), "inaccurate");
        assert_eq!(of(&whole, 1.1, 0.1, 1e-3), "gains energy");
        assert_eq!(of(&Ending::Unstable("why".into()), 1.0, 0.0, 0.0), "grows");
        assert_eq!(of(&stopped, 1.5, 0.5, 0.1), "grows");
        assert_eq!(of(&stopped, 1.0, 1e-3, 0.1), "refused");
    }
}
