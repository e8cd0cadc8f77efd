//! Layerwise plate theory for one wavenumber: in-plane displacements are linear across each layer, and the shear strains
//! and the deflection are those of [`Transverse`].
//!
//! In-plane displacements are continuous. At the wavenumber ξ they are u_r = ξφ(z) J₁ with φ_0 … φ_N at the faces and
//! interfaces, and the mean deflection is u_z = W J₀. Since ∇·u = ξ²φ J₀, the shear strain of layer i is ξγ_i with γ_i =
//! Σ (a_j − ξ² b_j) φ_j − W. With k = ξ² and q_i = S_i γ_i/(k t_i), where S_i γ_i² is twice the shear energy and t_i a
//! thickness, the energy is stationary if
//!
//! Σ E′_i ∫ φ δφ dz + Σ t_i q_i δγ_i + δ(W + k Σ r_j φ_j)/k² = 0,   γ_i = k t_i q_i/S_i,
//!
//! for a unit pressure on the loaded face, where the deflection is W + k Σ r_j φ_j. As in [`super::layer`], all unknowns
//! have the same order of magnitude for long waves.

use nalgebra::{DMatrix, DVector};

use super::{Layer, Response, Stack, Transverse};

/// Layerwise theory of a stack.
#[derive(Debug, Clone, PartialEq)]
pub struct Layerwise {
    stack: Stack,
    transverse: Transverse,
}

/// Solution of the layerwise theory at one wavenumber for a unit transform of the pressure.
#[derive(Debug, Clone)]
pub struct LayerwiseWave {
    wavenumber: f64,
    /// Unknowns φ at the faces and interfaces, then W, in the scaled units of the stack.
    unknowns: DVector<f64>,
}

impl Layerwise {
    /// Theory of a stack, with its transverse shear and thickness strain.
    pub fn new(stack: &Stack) -> Self {
        Self { stack: stack.clone(), transverse: Transverse::new(stack) }
    }

    /// Theory of a stack whose deflection is constant across the thickness and whose stiff layers, chosen by `is_rigid`,
    /// do not shear ([`Transverse::thin`]).
    pub fn thin(stack: &Stack, is_rigid: impl Fn(&Layer) -> bool) -> Self {
        Self { stack: stack.clone(), transverse: Transverse::thin(stack, is_rigid) }
    }

    /// Stack of layers.
    pub fn stack(&self) -> &Stack {
        &self.stack
    }

    /// Shear strains and deflections of the layers.
    pub fn transverse(&self) -> &Transverse {
        &self.transverse
    }

    /// Deflection of the loaded face, m/Pa.
    pub fn face_deflection(&self, wave: &LayerwiseWave) -> f64 {
        let thickness = self.stack.thickness;
        let square = (wave.wavenumber * thickness).powi(2);
        let faces = self.transverse.face_deflection.iter().zip(&wave.unknowns);
        let beyond_mean: f64 = faces.map(|(factor, phi)| factor / thickness * phi).sum();
        let mean = wave.unknowns[wave.unknowns.len() - 1];
        thickness / self.stack.layers[0].young * (mean + square * beyond_mean)
    }

    /// Solution at a positive wavenumber, 1/m.
    pub fn wave(&self, wavenumber: f64) -> LayerwiseWave {
        let (n, height) = (self.stack.scaled.len(), self.stack.thickness);
        let square = (wavenumber * height).powi(2);
        // Unknowns φ_0 … φ_N, W, q_1 … q_N.
        let deflection = n + 1;
        let mut system = DMatrix::zeros(2 * n + 2, 2 * n + 2);
        for (i, (layer, strain)) in self.stack.scaled.iter().zip(&self.transverse.shear).enumerate() {
            let (h, shear) = (layer.thickness, n + 2 + i);
            let sixth = layer.young / (1.0 - layer.poisson.powi(2)) * h / 6.0;
            for (a, b, value) in [(i, i, 2.0), (i, i + 1, 1.0), (i + 1, i, 1.0), (i + 1, i + 1, 2.0)] {
                system[(a, b)] += sixth * value;
            }
            let of_faces = strain.of_displacements.iter().zip(&strain.of_dilatations);
            let rows = of_faces.map(|(a, b)| h * (a * height - square * b / height)).chain([-h]);
            for (place, value) in rows.enumerate() {
                system[(place, shear)] = value;
                system[(shear, place)] = value;
            }
            system[(shear, shear)] = -h * h * square * height / (strain.factor * layer.shear());
        }
        let mut load = DVector::zeros(2 * n + 2);
        load[deflection] = 1.0 / (square * square);
        let faces = self.transverse.face_deflection.iter().enumerate();
        faces.for_each(|(j, factor)| load[j] = factor / height / square);
        // The energy is positive definite, so the system is not singular.
        let unknowns = system.lu().solve(&load).unwrap_or_else(|| DVector::zeros(2 * n + 2));
        LayerwiseWave { wavenumber, unknowns: unknowns.rows(0, n + 2).into_owned() }
    }

    /// Field at a depth, m. u_z is the mean deflection, σ_rz follows from in-plane equilibrium, and σ_zz is neglected.
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
