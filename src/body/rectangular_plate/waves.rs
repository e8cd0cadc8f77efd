//! Bending waves of a plate.

use nalgebra::Complex;

use super::LayeredWaves;

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

    /// Returns the group velocity dω/dξ at a wavenumber ξ (1/m), m/s.
    pub fn group_velocity(&self, wavenumber: f64) -> f64 {
        let [more, less] = [1.0 + STEP, 1.0 - STEP].map(|factor| factor * wavenumber);
        (self.frequency(more) - self.frequency(less)) / (more - less)
    }

    /// Returns the frequency of the thickness-shear mode, rad/s. Above it, other waves propagate too.
    pub fn thickness_shear(&self) -> f64 {
        (self.shear / self.rotary).sqrt()
    }

    /// Returns the plate with the bending stiffness for which the bending wave of a wavenumber (1/m) has this frequency
    /// (rad/s).
    pub fn with_frequency(&self, wavenumber: f64, frequency: f64) -> Self {
        // From the characteristic equation (S ξ² − m ω²) (D ξ² + S − J ω²) = S² ξ².
        let [square, of_time] = [wavenumber, frequency].map(|value| value * value);
        let Self { mass, shear, rotary, .. } = *self;
        let turned = shear * shear * square / (shear * square - mass * of_time);
        Self { rigidity: (turned - shear + rotary * of_time) / square, ..*self }
    }
}

/// Bending waves of a plate of one layer or of several.
#[derive(Debug, Clone, PartialEq)]
pub enum PlateWaves {
    /// One layer, by Mindlin's theory.
    Mindlin(BendingWaves),
    /// Several layers.
    Layered(LayeredWaves),
}

impl PlateWaves {
    /// Returns the Mindlin plate whose bending wave of a wavenumber (1/m) has the same frequency.
    pub fn equivalent_mindlin(&self, wavenumber: f64) -> BendingWaves {
        match self {
            Self::Mindlin(waves) => *waves,
            Self::Layered(waves) => waves.equivalent_mindlin(wavenumber),
        }
    }

    /// Returns the frequency of the wave with a wavenumber (1/m), rad/s. Viscoelastic layers have their moduli at the
    /// rate of the table.
    pub fn frequency(&self, wavenumber: f64) -> f64 {
        match self {
            Self::Mindlin(waves) => waves.frequency(wavenumber),
            Self::Layered(waves) => waves.frequency(wavenumber),
        }
    }

    /// Returns the eigenvalue λ of the free vibration with a wavenumber (1/m), 1/s.
    pub fn eigenvalue(&self, wavenumber: f64) -> Complex<f64> {
        match self {
            Self::Mindlin(waves) => Complex::new(0.0, waves.frequency(wavenumber)),
            Self::Layered(waves) => waves.eigenvalue(wavenumber),
        }
    }

    /// Returns the frequency up to which the bending waves are known and other waves within a layer do not propagate, rad/s.
    pub fn largest(&self) -> f64 {
        match self {
            Self::Mindlin(waves) => waves.thickness_shear(),
            Self::Layered(waves) => waves.largest(),
        }
    }
}
