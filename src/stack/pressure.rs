//! Axisymmetric pressures of total force 1 on the loaded face: their transforms, and the integrals for an infinite thin
//! plate under them.
//!
//! With Q(r) the force within r, the integrals over wavenumbers for the stresses of a plate are elementary:
//!
//! ∫ P J₁(ξr) dξ = Q/r,   ∫ (P − P′) J₀(ξr)/ξ dξ = V − V′ with dV/dr = −Q/r,   ∫ P J₂(ξr)/ξ dξ = r⁻² ∫₀^r Q ρ dρ.

use std::f64::consts::{FRAC_PI_2, PI};

use super::Cylindrical;
use super::half_space::hertz;
use crate::form::{Spread, hertz_wave};

/// Distribution of a force of 1 N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pressure {
    /// A point force.
    Point,
    /// Hertz's pressure over a disc.
    Hertz {
        /// Radius of the disc, m; positive.
        radius: f64,
    },
    /// A smoother pressure over a larger disc with the same low moments as Hertz's pressure.
    Spread {
        /// Shape of the pressure.
        spread: Spread,
        /// Radius of the larger disc, m; positive.
        radius: f64,
    },
}

/// Values of a pressure at a radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Plane {
    /// Pressure p, 1/m².
    pub density: f64,
    /// Mean of p within r: Q/(πr²), 1/m².
    pub mean: f64,
    /// Potential V, which is −ln r (r in m) outside the disc.
    pub potential: f64,
    /// Average r⁻² ∫₀^r Q ρ dρ.
    pub average: f64,
}

impl Pressure {
    /// Pressure that is spread over a disc of a radius (m). A wide area is replaced by Hertz's pressure with the same second
    /// moment.
    pub fn of(spread: Spread, radius: f64) -> Self {
        spread.as_hertz().map_or(Self::Spread { spread, radius }, |radius| Self::Hertz { radius })
    }

    /// Hankel transform P at a wavenumber, 1/m.
    pub fn transform(&self, wavenumber: f64) -> f64 {
        match self {
            Self::Point => 1.0,
            Self::Hertz { radius } => hertz_wave(wavenumber * radius),
            Self::Spread { spread, radius } => spread.transform(wavenumber * radius),
        }
    }

    /// Radius (m) of the disc outside which the pressure is zero.
    pub fn radius(&self) -> f64 {
        match self {
            Self::Point => 0.0,
            Self::Hertz { radius } | Self::Spread { radius, .. } => *radius,
        }
    }

    /// Stresses in a half-space at a radius and a depth, m, by a quadrature rule on \[−1, 1\].
    ///
    /// A spread pressure is a superposition of Hertz's pressures over smaller discs, by Sonine's integral (DLMF
    /// 10.22.19). For a disc of radius R
    ///
    /// Λ_m(ξR) ∝ ∫ sin⁴θ cos^{2m−4}θ Λ_{3/2}(ξR sin θ) dθ from 0 to π/2,
    ///
    /// with a factor that makes Λ_m(0) = 1. On the surface, Hertz's stress has a square-root singularity if the edge of
    /// a smaller disc passes through the point. The quadrature points are clustered there.
    pub(super) fn half_space(&self, poisson: f64, r: f64, depth: f64, rule: &[(f64, f64)]) -> Cylindrical {
        let (spread, radius) = match self {
            Self::Point => return hertz(poisson, r, depth, 0.0),
            Self::Hertz { radius } => return hertz(poisson, r, depth, *radius),
            Self::Spread { spread, radius } => (spread, radius),
        };
        let mut sum = Cylindrical::default();
        let edge = (r / radius).min(1.0).asin();
        for length in [-edge, FRAC_PI_2 - edge] {
            for (at, weight) in rule {
                let s = 0.5 * (1.0 + at);
                let (sin, cos) = (edge + length * s * s).sin_cos();
                // ∫ sin⁴ cos² = π/32; the integral for m + 1 is (2m − 3)/(2m + 2) times the integral for m.
                let (mut whole, mut part) = (PI / 32.0, 0.0);
                for (m, of_part) in spread.parts() {
                    part += of_part * cos.powi(2 * m - 4) / whole;
                    whole *= f64::from(2 * m - 3) / f64::from(2 * m + 2);
                }
                sum = sum.plus(length.abs() * weight * s * sin.powi(4) * part, &hertz(poisson, r, depth, radius * sin));
            }
        }
        sum
    }

    /// Values of the pressure and its integrals at a radius, m; for a point force the radius must be positive.
    pub(super) fn plane(&self, r: f64) -> Plane {
        let unit = |radius: f64| PI * radius * radius;
        match self {
            Self::Point => Plane { density: 0.0, mean: 1.0 / unit(r), potential: -r.ln(), average: 0.5 },
            Self::Hertz { radius } => {
                let v = (1.0 - (r / radius).powi(2)).max(0.0).sqrt();
                if v == 0.0 {
                    return outside(r, *radius, 2.5);
                }
                Plane {
                    density: 1.5 * v / unit(*radius),
                    mean: (1.0 + v + v * v) / (1.0 + v) / unit(*radius),
                    potential: v + v.powi(3) / 3.0 - v.ln_1p() - radius.ln(),
                    average: 0.5 - 0.2 * (1.0 + v + v * v + v.powi(3) + v.powi(4)) / (1.0 + v),
                }
            }
            Self::Spread { spread, radius } => {
                let of_parts = |f: &dyn Fn(i32) -> f64| spread.parts().iter().map(|(m, w)| w * f(*m)).sum::<f64>();
                let q = (r / radius).powi(2);
                if q >= 1.0 {
                    // The weights w_m sum to 1; Σ w_m/(m + 1) determines the second moment.
                    return outside(r, *radius, 1.0 / of_parts(&|m| 1.0 / f64::from(m + 1)));
                }
                let inside = 1.0 - q;
                let geometric = |m: i32| (0..m).map(|j| inside.powi(j)).sum::<f64>();
                let logarithmic = |m: i32| (1..=m).map(|j| inside.powi(j) / f64::from(j)).sum::<f64>();
                Plane {
                    density: of_parts(&|m| f64::from(m) * inside.powi(m - 1)) / unit(*radius),
                    mean: of_parts(&geometric) / unit(*radius),
                    potential: 0.5 * of_parts(&logarithmic) - radius.ln(),
                    average: 0.5 - 0.5 * of_parts(&|m| geometric(m + 1) / f64::from(m + 1)),
                }
            }
        }
    }
}

/// Values outside a disc, over which ∫ (1 − Q) ρ dρ = R²/(2n).
fn outside(r: f64, radius: f64, n: f64) -> Plane {
    let q = (r / radius).powi(2);
    Plane { density: 0.0, mean: 1.0 / (PI * r * r), potential: -r.ln(), average: 0.5 - 0.5 / (n * q) }
}

/// Transform (1 + ξa) e^{−ξa} of the pressure p = 3a³/(2π (r² + a²)^{5/2}), with x = ξa. The pressure is smooth, and
/// both functions are elementary.
pub(super) fn smooth_transform(x: f64) -> f64 {
    (1.0 + x) * (-x).exp()
}

/// V and r⁻² ∫ Q ρ dρ of the pressure of [`smooth_transform`].
pub(super) fn smooth_plane(r: f64, a: f64) -> (f64, f64) {
    let rho = r.hypot(a);
    (a / rho - (a + rho).ln(), 0.5 - a * a / (rho * (rho + a)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::adaptive;

    /// The integrals agree with quadratures of the transforms times Bessel functions, and of p: inside, outside and at
    /// the centre.
    #[test]
    fn integrals_are_those_of_the_transform() {
        let discs = [
            Pressure::Spread { spread: Spread::new(0.0), radius: 2.0 },
            Pressure::Spread { spread: Spread::new(0.6), radius: 1.5 },
            Pressure::Hertz { radius: 1.2 },
        ];
        for pressure in discs {
            for r in [1e-9, 0.3, 1.1, 1.9, 3.0] {
                let found = pressure.plane(r);
                let (smooth_potential, smooth_average) = smooth_plane(r, 1.0);
                let [force, moment] = adaptive((0.0, r), 1e-13, &mut |s| {
                    let force = 2.0 * PI * s * pressure.plane(s).density;
                    [force, force * (r * r - s * s) / 2.0]
                });
                let [potential, average] = adaptive((0.0, 300.0), 1e-9, &mut |x| {
                    let apart = (pressure.transform(x) - smooth_transform(x)) / x;
                    let j2 = 2.0 * libm::j1(x * r) / (x * r) - libm::j0(x * r);
                    [apart * libm::j0(x * r), apart * j2]
                });
                if r > 1e-6 {
                    assert!((found.mean * PI * r * r - force).abs() < 1e-11, "{pressure:?} {r}: {found:?} {force}");
                    assert!((found.average * r * r - moment).abs() < 1e-11, "{pressure:?} {r}: {found:?} {moment}");
                }
                // Contribution beyond 300: P decreases as x⁻² for Hertz's pressure.
                let tail = 3e-5;
                assert!((found.potential - smooth_potential - potential).abs() < tail, "{pressure:?} {r} {potential}");
                assert!((found.average - smooth_average - average).abs() < tail, "{pressure:?} {r}: {average}");
            }
        }
    }
}
