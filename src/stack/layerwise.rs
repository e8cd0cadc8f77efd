//! Layerwise plate theory for one wavenumber: each layer is a Reissner–Mindlin plate, and all layers have the same
//! deflection.
//!
//! In-plane displacements are linear across each layer and continuous. At the wavenumber ξ they are u_r = ξφ(z) J₁ with
//! φ_0 … φ_N at the faces and interfaces, and u_z = W J₀. The shear strain of layer i is ξγ_i with
//! γ_i = (φ_i − φ_{i−1})/h_i − W. With k = ξ² and q_i = κ_i μ_i γ_i/k the energy is stationary if
//!
//! Σ E′_i ∫ φ δφ dz + Σ h_i q_i δγ_i + δW/k² = 0,   γ_i = k q_i/(κ_i μ_i),
//!
//! for a unit pressure. As in [`super::layer`], all unknowns have the same order of magnitude for long waves. For one
//! layer this is Mindlin's plate.
//!
//! The load may act on w + β M instead of w, with the sum of the bending moments M = ∫ E′ z ∇·u dz. The response is
//! then evaluated in the same way. By equilibrium M is 1/ξ² for a unit pressure, independent of the layers. So β adds
//! 2β/ξ² to the response.

use nalgebra::{DMatrix, DVector};

use super::{Layer, Response, Stack};

/// Layerwise theory of a stack.
#[derive(Debug, Clone, PartialEq)]
pub struct Layerwise {
    stack: Stack,
    shear_factors: Vec<f64>,
    /// Coefficient β of the moment in w + β M, m/N.
    reading: f64,
}

/// Solution of the layerwise theory at one wavenumber for a unit transform of the pressure.
#[derive(Debug, Clone)]
pub struct LayerwiseWave {
    wavenumber: f64,
    /// Unknowns φ at the faces and interfaces, then W, in the scaled units of the stack.
    unknowns: DVector<f64>,
}

impl Layerwise {
    /// Theory with the shear factor κ of each layer; `None` unless each layer has a positive one.
    pub fn new(stack: &Stack, shear_factors: &[f64]) -> Option<Self> {
        let is_whole = shear_factors.len() == stack.layers().len() && shear_factors.iter().all(|kappa| *kappa > 0.0);
        is_whole.then(|| Self { stack: stack.clone(), shear_factors: shear_factors.to_vec(), reading: 0.0 })
    }

    /// Uses w + β M, with β in m/N, as the displacement that is conjugate to the load.
    #[must_use]
    pub fn with_reading(self, reading: f64) -> Self {
        Self { reading, ..self }
    }

    /// Stack of layers.
    pub fn stack(&self) -> &Stack {
        &self.stack
    }

    /// Weights of φ_0 … φ_N in β ∫ E′ z φ dz, in scaled units, with z from the middle of the stack.
    fn moments(&self) -> Vec<f64> {
        let mut moments = vec![0.0; self.stack.scaled.len() + 1];
        let reading = self.reading * self.stack.layers[0].young * self.stack.thickness;
        let mut above = -0.5;
        for (i, layer) in self.stack.scaled.iter().enumerate() {
            let (h, below) = (layer.thickness, above + layer.thickness);
            let sixth = reading * layer.young / (1.0 - layer.poisson.powi(2)) * h / 6.0;
            moments[i] += sixth * (2.0 * above + below);
            moments[i + 1] += sixth * (above + 2.0 * below);
            above = below;
        }
        moments
    }

    /// Response Γ of the theory, m/Pa: w + β M of a wave.
    pub fn read(&self, wave: &LayerwiseWave) -> f64 {
        let square = (wave.wavenumber * self.stack.thickness).powi(2);
        let moment: f64 = self.moments().iter().zip(&wave.unknowns).map(|(weight, phi)| weight * phi).sum();
        let deflection = wave.unknowns[wave.unknowns.len() - 1];
        self.stack.thickness / self.stack.layers[0].young * (deflection + square * moment)
    }

    /// Solution at a positive wavenumber, 1/m.
    pub fn wave(&self, wavenumber: f64) -> LayerwiseWave {
        let n = self.stack.scaled.len();
        let square = (wavenumber * self.stack.thickness).powi(2);
        // Unknowns φ_0 … φ_N, W, q_1 … q_N.
        let deflection = n + 1;
        let mut system = DMatrix::zeros(2 * n + 2, 2 * n + 2);
        for (i, (layer, kappa)) in self.stack.scaled.iter().zip(&self.shear_factors).enumerate() {
            let (h, shear) = (layer.thickness, n + 2 + i);
            let sixth = layer.young / (1.0 - layer.poisson.powi(2)) * h / 6.0;
            for (a, b, value) in [(i, i, 2.0), (i, i + 1, 1.0), (i + 1, i, 1.0), (i + 1, i + 1, 2.0)] {
                system[(a, b)] += sixth * value;
            }
            for (place, value) in [(i, -1.0), (i + 1, 1.0), (deflection, -h)] {
                system[(place, shear)] = value;
                system[(shear, place)] = value;
            }
            system[(shear, shear)] = -h * square / (kappa * layer.shear());
        }
        let mut load = DVector::zeros(2 * n + 2);
        load[deflection] = 1.0 / (square * square);
        self.moments().into_iter().enumerate().for_each(|(i, moment)| load[i] = moment / square);
        // The energy is positive definite, so the system is not singular.
        let unknowns = system.lu().solve(&load).unwrap_or_else(|| DVector::zeros(2 * n + 2));
        LayerwiseWave { wavenumber, unknowns: unknowns.rows(0, n + 2).into_owned() }
    }

    /// Field at a depth, m. σ_rz follows from in-plane equilibrium; σ_zz is neglected.
    pub fn response(&self, wave: &LayerwiseWave, depth: f64) -> Response {
        let (at, within) = self.stack.layer_at(depth);
        let unknowns = &wave.unknowns;
        let x = wave.wavenumber * self.stack.thickness;
        let phi = |i: usize, part: f64| unknowns[i] + part * (unknowns[i + 1] - unknowns[i]);
        // ∫ E′ φ dz from the loaded face to the depth.
        let mut shear = 0.0;
        for (i, layer) in self.stack.scaled[..=at].iter().enumerate() {
            let part = if i == at { within / self.stack.layers[i].thickness } else { 1.0 };
            shear += layer.young / (1.0 - layer.poisson.powi(2)) * layer.thickness * part * phi(i, 0.5 * part);
        }
        let Layer { thickness, young, poisson } = self.stack.layers[at];
        let phi = phi(at, within / thickness);
        let compliance = self.stack.thickness / self.stack.layers[0].young;
        let strain = x * x * phi * young / self.stack.layers[0].young;
        Response {
            u_r: compliance * x * phi,
            u_z: compliance * unknowns[unknowns.len() - 1],
            sum: strain / (1.0 - poisson),
            difference: -strain / (1.0 + poisson),
            sigma_zz: 0.0,
            sigma_rz: x.powi(3) * shear,
        }
    }
}
