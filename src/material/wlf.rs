//! Time and temperature.

/// The shift of Williams, Landel & Ferry (J. Am. Chem. Soc. 77, 1955): log₁₀ a_T = −C1 (T − T0)/(C2 + T − T0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wlf {
    /// C1.
    pub c1: f64,
    /// C2, K.
    pub c2: f64,
    /// T0, °C: the temperature at which the relaxation times are given.
    pub reference: f64,
}

/// C2 from the glass transition, K, and the width of the range above it for which the formula was found: Williams, Landel & Ferry (1955).
const FROM_TRANSITION: f64 = 51.6;
const RANGE: f64 = 100.0;

impl Wlf {
    /// Temperatures (°C) between which the formula usually holds: the glass transition, which follows from the pole, and 100 K above, and
    /// the reference and 100 K above, at which the times were measured.
    pub fn usual_range(&self) -> [f64; 2] {
        let transition = self.pole() + FROM_TRANSITION;
        [transition.min(self.reference), transition.max(self.reference) + RANGE]
    }

    /// The temperature at which the formula has its pole, °C. It holds above.
    pub fn pole(&self) -> f64 {
        self.reference - self.c2
    }

    /// log₁₀ a_T at a temperature (°C); `None` at the pole and below.
    pub fn log_shift(&self, temperature: f64) -> Option<f64> {
        let difference = temperature - self.reference;
        (temperature > self.pole()).then(|| -self.c1 * difference / (self.c2 + difference))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The constants that hold for many polymers about the glass transition, and values computed by hand.
    #[test]
    fn known_shifts() {
        let wlf = Wlf { c1: 17.44, c2: 51.6, reference: 20.0 };
        assert_eq!(wlf.log_shift(20.0), Some(0.0));
        assert!((wlf.usual_range()[0] - 20.0).abs() < 1e-12 && (wlf.usual_range()[1] - 120.0).abs() < 1e-12);
        let [warm, cold] = [71.6, -5.8].map(|t| wlf.log_shift(t).expect("above the pole"));
        // −17.44/2, and −17.44 · (−25.8)/25.8; rounding of the differences.
        assert!((warm + 8.72).abs() < 1e-12 && (cold - 17.44).abs() < 1e-12);
        assert_eq!((wlf.log_shift(-31.6), wlf.log_shift(-40.0)), (None, None));
    }
}
