//! Area of the surface on which a contact presses, where the scene gives it, and the pressure there.

use std::f64::consts::{PI, SQRT_2};
use std::fmt;

/// Shape of the area, and the pressure on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AreaShape {
    /// p = 3/(2π a²) √(1 − r²/a²) on a disc.
    HertzDisc,
    /// Constant pressure on a disc.
    EvenDisc,
    /// Constant pressure on a square with sides along the axes of the face.
    EvenSquare,
}

/// Area of the surface on which a contact presses; the total of its pressure is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactArea {
    /// Shape and pressure.
    pub shape: AreaShape,
    /// Radius of the disc, or half the side of the square, m.
    pub half_width: f64,
}

impl ContactArea {
    /// Radius (m) of the disc on which Hertz's pressure has the same mean square distance from the centre, 2/5 r². Bodies
    /// respond to waves longer than the area by this moment alone.
    pub fn equivalent_radius(&self) -> f64 {
        let over_half_width = match self.shape {
            AreaShape::HertzDisc => 1.0,
            AreaShape::EvenDisc => 1.25_f64.sqrt(),
            AreaShape::EvenSquare => (5.0_f64 / 3.0).sqrt(),
        };
        over_half_width * self.half_width
    }

    /// Mean displacement of a half-space, weighted by the pressure, over that under Hertz's pressure on a disc of the same half
    /// width: 0.6 (1 − ν²)/(E a) for Hertz's pressure, 16/(3π²) (1 − ν²)/(E a) for a constant one on a disc, and
    /// (2/π) (arsinh 1 − (√2 − 1)/3) (1 − ν²)/(E a) on a square (Boussinesq's solution, averaged).
    pub fn dent_over_hertz(&self) -> f64 {
        match self.shape {
            AreaShape::HertzDisc => 1.0,
            AreaShape::EvenDisc => 80.0 / (9.0 * PI * PI),
            AreaShape::EvenSquare => (1.0_f64.asinh() - (SQRT_2 - 1.0) / 3.0) / (0.3 * PI),
        }
    }
}

impl fmt::Display for ContactArea {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { shape, half_width } = self;
        match shape {
            AreaShape::HertzDisc => write!(f, "with Hertz's pressure on a disc of radius {half_width} m"),
            AreaShape::EvenDisc => write!(f, "evenly on a disc of radius {half_width} m"),
            AreaShape::EvenSquare => write!(f, "evenly on a square of {} m", 2.0 * half_width),
        }
    }
}
