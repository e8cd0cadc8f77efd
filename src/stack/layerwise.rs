//! The layerwise theory of plates: each layer a Reissner–Mindlin plate, with one deflection for all of them.
//!
//! Displacements along the plate are linear across each layer and continuous. In the wavenumber ξ they are u_r = ξφ(z) J₁ with φ_0 … φ_N
//! at the faces and interfaces, u_z = W J₀; layer i has the shear strain ξγ_i, γ_i = (φ_i − φ_{i−1})/h_i − W. With k = ξ² and
//! q_i = κ_i μ_i γ_i/k the energy is stationary where
//!
//! Σ E′_i ∫ φ δφ dz + Σ h_i q_i δγ_i + δW/k² = 0,   γ_i = k q_i/(κ_i μ_i),
//!
//! for a unit pressure. As in [`super::layer`], all unknowns are of one order in long waves. One layer is Mindlin's plate.
//!
//! A plate may be loaded and read by w + β M instead, with the sum of its bending moments M = ∫ E′ z ∇·u dz. By equilibrium M is 1/ξ² for
//! a unit pressure, whatever the layers do: so β adds 2β/ξ² to the response.

use nalgebra::{DMatrix, DVector};

use super::{Layer, Response, Stack};

/// The layerwise theory of a stack.
#[derive(Debug, Clone, PartialEq)]
pub struct Layerwise {
    stack: Stack,
    shear_factors: Vec<f64>,
    /// β, m/N.
    reading: f64,
}

/// The theory's solution at one wavenumber for a unit transform of the pressure.
#[derive(Debug, Clone)]
pub struct LayerwiseWave {
    wavenumber: f64,
    /// φ at the faces and interfaces, W; scaled as in the stack.
    unknowns: DVector<f64>,
}

impl Layerwise {
    /// With κ of each layer; `None` unless there is a positive one for each.
    pub fn new(stack: &Stack, shear_factors: &[f64]) -> Option<Self> {
        let is_whole = shear_factors.len() == stack.layers().len() && shear_factors.iter().all(|kappa| *kappa > 0.0);
        is_whole.then(|| Self { stack: stack.clone(), shear_factors: shear_factors.to_vec(), reading: 0.0 })
    }

    /// Loaded and read by w + β M, with β in m/N.
    #[must_use]
    pub fn with_reading(self, reading: f64) -> Self {
        Self { reading, ..self }
    }

    /// The layers.
    pub fn stack(&self) -> &Stack {
        &self.stack
    }

    /// β ∫ E′ z φ dz as weights of φ_0 … φ_N, scaled, with z from the stack's middle.
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

    /// Γ of the theory, m/Pa: what is read of a wave.
    pub fn read(&self, wave: &LayerwiseWave) -> f64 {
        let square = (wave.wavenumber * self.stack.thickness).powi(2);
        let moment: f64 = self.moments().iter().zip(&wave.unknowns).map(|(weight, phi)| weight * phi).sum();
        let deflection = wave.unknowns[wave.unknowns.len() - 1];
        self.stack.thickness / self.stack.layers[0].young * (deflection + square * moment)
    }

    /// The solution at a positive wavenumber, 1/m.
    pub fn wave(&self, wavenumber: f64) -> LayerwiseWave {
        let n = self.stack.scaled.len();
        let square = (wavenumber * self.stack.thickness).powi(2);
        // φ_0 … φ_N, W, q_1 … q_N.
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
        // The energy is definite: the system is regular.
        let unknowns = system.lu().solve(&load).unwrap_or_else(|| DVector::zeros(2 * n + 2));
        LayerwiseWave { wavenumber, unknowns: unknowns.rows(0, n + 2).into_owned() }
    }

    /// The field at a depth, m. σ_rz follows from equilibrium along the plate; σ_zz is neglected.
    pub fn response(&self, wave: &LayerwiseWave, depth: f64) -> Response {
        let (at, within) = self.stack.layer_at(depth);
        let unknowns = &wave.unknowns;
        let x = wave.wavenumber * self.stack.thickness;
        let phi = |i: usize, part: f64| unknowns[i] + part * (unknowns[i + 1] - unknowns[i]);
        // ∫ E′ φ dz down to the depth.
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
