//! Local field at one depth.

use std::f64::consts::PI;

use super::local::{Carrier, END, HERTZ_DEPTH_FRACTION, LocalField};
use super::point::{HertzPoint, PointField};
use super::pressure::{Pressure, smooth_plane};
use super::resultants::along_section;
use super::section::Bending;
use super::{Cylindrical, Response, Wave};

/// Local field at one depth of a stack, with the amplitudes of each wavenumber.
#[derive(Debug, Clone)]
pub struct Level<'a> {
    local: &'a LocalField,
    depth: f64,
    bending: Bending,
    /// Amplitudes of the field under the contact, then of the body's field: σ_rr + σ_θθ, σ_rr − σ_θθ, σ_zz, σ_rz for
    /// each wavenumber, times ξ dξ/(2π).
    waves: Vec<([f64; 4], [f64; 4])>,
}

/// Signs of the stresses mirrored from the depth H − z in pure bending, which is antisymmetric.
const ANTISYMMETRIC: [f64; 4] = [-1.0, -1.0, -1.0, 1.0];

impl LocalField {
    /// Whether the half-space's part is separated at a depth (m).
    fn is_shallow(&self, depth: f64) -> bool {
        depth < HERTZ_DEPTH_FRACTION * self.stack.layers()[0].thickness
    }

    /// Length d (m) in the decay factor e^{−ξd} of waves at a depth.
    fn decay(&self, depth: f64) -> f64 {
        if self.is_shallow(depth) { 2.0 * self.stack.layers()[0].thickness - depth } else { depth }
    }

    /// Amplitudes of a wave at a depth, without the half-space's part where it is separated.
    fn rest(&self, wave: &Wave, depth: f64) -> [f64; 4] {
        let mut rest = components(&wave.response(&self.stack, depth));
        if self.is_shallow(depth) {
            let half_space = components(&wave.half_space(&self.stack, depth));
            (0..4).for_each(|i| rest[i] -= half_space[i]);
        }
        rest
    }

    /// Half-space's part of the body's field; zero where it is not separated.
    fn half_space(&self, radius: f64, depth: f64) -> Cylindrical {
        if !self.is_shallow(depth) {
            return Cylindrical::default();
        }
        self.carrier.pressure().half_space(self.stack.layers()[0].poisson, radius, depth, &self.rule)
    }
}

impl<'a> Level<'a> {
    pub(super) fn new(local: &'a LocalField, depth: f64) -> Self {
        let height = local.stack.thickness();
        let depth = depth.clamp(0.0, height);
        let bending = local.section.bending(&local.stack, depth);
        let mut decay = local.decay(depth);
        match &local.carrier {
            Carrier::Plate { .. } => decay = decay.min(height),
            // The terms decay only with the transform of the pressure, so all wavenumbers are summed.
            Carrier::Layerwise { .. } | Carrier::Sections { .. } => decay = 0.0,
            Carrier::BentSolid { .. } => decay = decay.min(local.decay(height - depth)),
            Carrier::Solid { .. } => {}
        }
        let waves = local.nodes.iter().take_while(|node| node.wavenumber * decay < END).map(|node| {
            let rest = local.rest(&node.wave, depth);
            let of_body = match &local.carrier {
                Carrier::Plate { .. } => {
                    let smooth = node.smooth / (node.wavenumber * node.wavenumber);
                    [bending.sum * smooth, bending.difference * smooth, 0.0, 0.0]
                }
                Carrier::Layerwise { theory, .. } => {
                    let response = node.layerwise.as_ref().map(|wave| components(&theory.response(wave, depth)));
                    response.unwrap_or_default().map(|a| a * node.carried)
                }
                Carrier::Sections { body, .. } => along_section(local, node, depth, *body).map(|a| a * node.carried),
                Carrier::Solid { .. } => rest.map(|a| a * node.carried),
                Carrier::BentSolid { .. } => {
                    let other = local.rest(&node.wave, height - depth);
                    std::array::from_fn(|i| 0.5 * (rest[i] + ANTISYMMETRIC[i] * other[i]) * node.carried)
                }
            };
            (rest.map(|a| a * node.weight), of_body.map(|a| a * node.weight))
        });
        Self { local, depth, bending, waves: waves.collect() }
    }

    /// Computes the field at a radius from the line of the force, m.
    pub fn at(&self, radius: f64) -> PointField {
        let local = self.local;
        let reach = local.reach();
        let factor = if radius > reach { (reach / radius).powi(2) } else { 1.0 };
        let radius = radius.min(reach);
        let mut first = self.closed(radius).map(|a| -a);
        let mut coefficients = vec![[0.0; 4]; local.nodes.first().map_or(0, |node| node.contact.len())];
        for (node, (of_contact, of_body)) in local.nodes.iter().zip(&self.waves) {
            let [j0, j1, j2] = bessel(node.wavenumber * radius);
            let bessel = [j0, j2, j0, j1];
            (0..4).for_each(|i| first[i] -= of_body[i] * bessel[i]);
            let amplitude: [f64; 4] = std::array::from_fn(|i| of_contact[i] * bessel[i]);
            for (to, part) in coefficients.iter_mut().zip(&node.contact) {
                (0..4).for_each(|i| to[i] += amplitude[i] * part);
            }
        }
        if let Some(to) = coefficients.first_mut() {
            (0..4).for_each(|i| to[i] += first[i]);
        }
        coefficients.iter_mut().flatten().for_each(|a| *a *= factor);
        let poisson = local.stack.layers()[0].poisson;
        let hertz = local.is_shallow(self.depth).then_some(HertzPoint { poisson, radius, depth: self.depth, factor });
        PointField { hertz, coefficients, largest: local.largest }
    }

    /// Part of the body's field that is not in the sum over wavenumbers, in closed form.
    fn closed(&self, radius: f64) -> [f64; 4] {
        let Self { local, depth, bending, .. } = self;
        let height = local.stack.thickness();
        let own = || local.half_space(radius, *depth).by_bessel();
        match &local.carrier {
            Carrier::Layerwise { .. } | Carrier::Sections { .. } => [0.0; 4],
            Carrier::Plate { pressure } => {
                let radius = if *pressure == Pressure::Point { radius.max(1e-9 * height) } else { radius };
                let (plane, (potential, average)) = (pressure.plane(radius), smooth_plane(radius, height));
                let sum = plane.potential - potential;
                let difference = plane.average - average;
                [
                    bending.sum * sum / (2.0 * PI),
                    bending.difference * difference / (2.0 * PI),
                    0.0,
                    0.5 * bending.shear * radius * plane.mean,
                ]
            }
            Carrier::Solid { .. } => own(),
            Carrier::BentSolid { .. } => {
                let (own, other) = (own(), local.half_space(radius, height - depth).by_bessel());
                std::array::from_fn(|i| 0.5 * (own[i] + ANTISYMMETRIC[i] * other[i]))
            }
        }
    }
}

/// Stresses σ_rr + σ_θθ, σ_rr − σ_θθ, σ_zz, σ_rz.
pub(super) fn components(response: &Response) -> [f64; 4] {
    [response.sum, response.difference, response.sigma_zz, response.sigma_rz]
}

impl Cylindrical {
    fn by_bessel(&self) -> [f64; 4] {
        [self.rr + self.tt, self.rr - self.tt, self.zz, self.rz]
    }
}

/// Bessel functions J₀, J₁, J₂.
fn bessel(x: f64) -> [f64; 3] {
    let (j0, j1) = (libm::j0(x), libm::j1(x));
    // J₂ = x²/8 − …, rounded to 1e-16 of 1.
    [j0, j1, if x > 1e-6 { 2.0 * j1 / x - j0 } else { 0.0 }]
}
