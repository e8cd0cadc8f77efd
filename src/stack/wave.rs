//! Solution for a stack at one wavenumber.
//!
//! The matrices from displacements to tractions at the interfaces, each for all layers below, are computed from the
//! free face up. Then the displacements follow from the loaded face down. No step overflows, and none subtracts large
//! numbers.

use nalgebra::{Matrix2, Vector2};

use super::layer::{Amplitudes, Field, Scaled};
use super::{Response, Stack};

/// Solution at one wavenumber for a unit transform of the pressure.
#[derive(Debug, Clone)]
pub struct Wave {
    /// Wavenumber ξ times the stack's thickness.
    x: f64,
    /// Factor from scaled displacements to displacements, m/Pa.
    compliance: f64,
    fields: Vec<Field>,
}

impl Wave {
    pub(super) fn new(layers: &[Scaled], x: f64, compliance: f64) -> Self {
        let mut below = Matrix2::zeros();
        let mut couplings = Vec::with_capacity(layers.len());
        for layer in layers.iter().rev() {
            // For a stable solid, no matrix is singular.
            let Some((above, coupling)) = layer.up(x, &below) else { break };
            couplings.push((above, coupling));
            below = above;
        }
        let pressure = Vector2::new(-1.0 / x.powi(4), 0.0);
        let mut displacements = below.try_inverse().unwrap_or_default() * pressure;
        let mut fields = Vec::with_capacity(layers.len());
        for (layer, (above, coupling)) in layers.iter().zip(couplings.iter().rev()) {
            let (field, lower) = layer.down(x, coupling, displacements, above);
            fields.push(field);
            displacements = lower;
        }
        Self { x, compliance, fields }
    }

    /// Field at a depth (m) in `stack`, which must be the stack of this wave.
    pub fn response(&self, stack: &Stack, depth: f64) -> Response {
        let (layer, within) = stack.layer_at(depth);
        self.response_in(stack, layer, within)
    }

    /// Field in a layer at a depth below its upper face (m), including both faces.
    pub fn response_in(&self, stack: &Stack, layer: usize, depth: f64) -> Response {
        let scaled = &stack.scaled[layer];
        let amplitudes = scaled.amplitudes(self.x, &self.fields[layer], depth / stack.thickness);
        self.of_amplitudes(scaled, amplitudes)
    }

    /// Field at a depth (m) in a half-space of the first layer's material.
    pub(super) fn half_space(&self, stack: &Stack, depth: f64) -> Response {
        let scaled = &stack.scaled[0];
        self.of_amplitudes(scaled, scaled.half_space(self.x, depth / stack.thickness))
    }

    /// Uses Hooke's law σ_rr + σ_θθ = E/(1 − ν) ξU + 2ν/(1 − ν) σ_zz, which has no division by 1 − 2ν, and
    /// σ_rr − σ_θθ = −2μ ξU.
    fn of_amplitudes(&self, layer: &Scaled, [u, w, sigma, tau]: Amplitudes) -> Response {
        let (strain, nu) = (self.x * u, layer.poisson);
        Response {
            u_r: self.compliance * u,
            u_z: self.compliance * w,
            sum: (layer.young * strain + 2.0 * nu * sigma) / (1.0 - nu),
            difference: -2.0 * layer.shear() * strain,
            sigma_zz: sigma,
            sigma_rz: tau,
        }
    }
}
