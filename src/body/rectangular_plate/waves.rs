//! Bending waves of Mindlin's plate.

/// Relative change of a wavenumber for the derivative of the frequency.
const STEP: f64 = 1e-5;

/// Bending waves of Mindlin's plate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BendingWaves {
    /// Mass per area ρh, kg/m².
    pub mass: f64,
    /// Bending stiffness D, N m.
    pub rigidity: f64,
    /// Shear stiffness κμh, N/m.
    pub shear: f64,
    /// Rotary inertia ρh³/12, kg.
    pub rotary: f64,
    /// Poisson's ratio.
    pub poisson: f64,
}

impl BendingWaves {
    /// Returns the frequencies of the bending wave and of the thickness-shear wave with a wavenumber (1/m), rad/s.
    pub fn frequencies(&self, wavenumber: f64) -> [f64; 2] {
        let Self { mass, rigidity, shear, rotary, .. } = *self;
        let square = wavenumber * wavenumber;
        // Roots of the characteristic equation; the smaller one from the product of both.
        let half = 0.5 * (shear * square / mass + (rigidity * square + shear) / rotary);
        let product = shear * rigidity * square * square / (mass * rotary);
        let upper = half + (half * half - product).sqrt();
        [(product / upper).sqrt(), upper.sqrt()]
    }

    /// Returns the frequency of the bending wave with a wavenumber (1/m), rad/s.
    pub fn frequency(&self, wavenumber: f64) -> f64 {
        self.frequencies(wavenumber)[0]
    }

    /// Returns the frequency of the thickness-shear mode, rad/s. Above it, other waves propagate too.
    pub fn thickness_shear(&self) -> f64 {
        (self.shear / self.rotary).sqrt()
    }

    /// Returns the group velocity dω/dξ at a wavenumber ξ (1/m), m/s.
    pub fn group_velocity(&self, wavenumber: f64) -> f64 {
        let [more, less] = [1.0 + STEP, 1.0 - STEP].map(|factor| factor * wavenumber);
        (self.frequency(more) - self.frequency(less)) / (more - less)
    }
}
