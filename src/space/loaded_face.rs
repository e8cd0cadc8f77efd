//! Loaded face of a stack of layers, compared with a half-space of the impacted layer, and integrals over its waves.

use std::f64::consts::FRAC_PI_2;

use crate::element::gauss_legendre;
use crate::stack::Stack;

/// Value of ξh, h the thickness of the impacted layer, above which a stack responds like the half-space. The difference
/// is proportional to (ξh)² e^{−2ξh}.
const HALF_SPACE: f64 = 22.0;

/// Value of x = ξR above which the square of a spread pressure's transform, which decreases as x⁻⁷, is below 1e-9.
pub(super) const END: f64 = 60.0;

/// Largest number of panels that are integrated as one interval.
const MOST_PANELS: f64 = 10.0;

/// Value of ξR, R the radius of the disc, above which the square of the pressure's transform is at most 1e-6, so that its
/// oscillations need no narrow panels.
const SMOOTH: f64 = 60.0;

/// Width of the panels over the wavenumber, above [`SMOOTH`].
const PANEL_OVER_WAVENUMBER: f64 = 0.25;

/// Loaded face of a stack under a pressure on a disc.
pub(super) struct LoadedFace<'a> {
    stack: &'a Stack,
    /// Radius of the disc, m.
    radius: f64,
    /// Width of the panels of integrals over wavenumbers, 1/m.
    panel: f64,
}

impl<'a> LoadedFace<'a> {
    /// Face of a stack under a pressure on a disc of a radius (m).
    pub fn new(stack: &'a Stack, radius: f64) -> Self {
        Self { stack, radius, panel: (FRAC_PI_2 / radius).min(1.0 / stack.layers()[0].thickness) }
    }

    /// Response Γ − H to a pressure of the wavenumber ξ (1/m), beyond the response H of the half-space, m/Pa.
    pub fn beyond_half_space(&self, wavenumber: f64) -> f64 {
        self.stack.wave(wavenumber).response(self.stack, 0.0).u_z - self.half_space(wavenumber)
    }

    /// Response H of the half-space, m/Pa.
    pub fn half_space(&self, wavenumber: f64) -> f64 {
        let struck = self.stack.layers()[0];
        2.0 * (1.0 - struck.poisson.powi(2)) / (struck.young * wavenumber)
    }

    /// Wavenumber (1/m) above which the stack responds like the half-space.
    pub fn half_space_from(&self) -> f64 {
        HALF_SPACE / self.stack.layers()[0].thickness
    }

    /// ∫ f dξ between two positive wavenumbers, 1/m. The intervals grow with the wavenumber, since a soft layer begins to
    /// slide far below ξ = 1/H, H being the thickness of the stack.
    pub fn integrate(&self, mut from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
        let mut sum = 0.0;
        // A thin layer responds like the half-space from very short waves on only.
        let widest = 1.0 / self.stack.layers()[0].thickness;
        while from < to {
            let is_smooth = from * self.radius > SMOOTH;
            let panel = if is_smooth { self.panel.max((PANEL_OVER_WAVENUMBER * from).min(widest)) } else { self.panel };
            let end = (2.0 * from).min(from + MOST_PANELS * panel).min(to);
            sum += integrate(from, end, panel, &f);
            from = end;
        }
        sum
    }
}

/// ∫ f dt between two ends, by Gauss's rule of 10 points on each of several panels of at most a given width.
pub(super) fn integrate(from: f64, to: f64, width: f64, f: impl Fn(f64) -> f64) -> f64 {
    let rule = gauss_legendre(10);
    let count = ((to - from) / width).ceil().max(1.0);
    let half = 0.5 * (to - from) / count;
    let panel = |i: usize| {
        let middle = from + (2.0 * i as f64 + 1.0) * half;
        rule.iter().map(|(x, weight)| half * weight * f(middle + half * x)).sum::<f64>()
    };
    (0..count as usize).map(panel).sum()
}
