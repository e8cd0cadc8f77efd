//! Time–temperature shift of viscoelastic materials.

/// Shift function of Williams, Landel & Ferry (J. Am. Chem. Soc. 77, 1955): log₁₀ a_T = −C1 (T − T0)/(C2 + T − T0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wlf {
    /// Constant C1.
    pub c1: f64,
    /// Constant C2, K.
    pub c2: f64,
    /// Reference temperature T0 for which the relaxation times are given, °C.
    pub reference: f64,
}

/// Constant C2 for a reference at the glass transition, K (Williams, Landel & Ferry, 1955).
const FROM_TRANSITION: f64 = 51.6;
/// Width of the temperature range above the glass transition in which the formula was established, K (same source).
const RANGE: f64 = 100.0;

impl Wlf {
    /// Temperatures (°C) between which the formula usually holds. The range is 100 K from the glass transition up,
    /// which follows from the pole, and is extended to the reference temperature and 100 K above it, where the times
    /// were measured.
    pub fn usual_range(&self) -> [f64; 2] {
        let transition = self.pole() + FROM_TRANSITION;
        [transition.min(self.reference), transition.max(self.reference) + RANGE]
    }

    /// Temperature of the formula's pole, °C. The formula holds above it.
    pub fn pole(&self) -> f64 {
        self.reference - self.c2
    }

    /// Returns log₁₀ a_T at a temperature (°C); `None` at the pole and below.
    pub fn log_shift(&self, temperature: f64) -> Option<f64> {
        let difference = temperature - self.reference;
        (temperature > self.pole()).then(|| -self.c1 * difference / (self.c2 + difference))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Constants that hold for many polymers near the glass transition, and values computed by hand.
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
