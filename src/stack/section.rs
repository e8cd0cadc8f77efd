//! Long-wave limit of the stack: the field of a thin plate.
//!
//! With u_r = −(z − z_n) ∂w/∂r, each layer has the in-plane strain ε_rr + ε_θθ = −(z − z_n) Δw, where z_n is the depth
//! of the neutral plane. At the wavenumber ξ a unit pressure causes the deflection W = 1/(Dξ⁴). Hence
//!
//! σ_rr + σ_θθ = E/(1 − ν) (z − z_n)/(Dξ²),   σ_rr − σ_θθ = −2μ (z − z_n)/(Dξ²),
//! σ_rz = (1/Dξ) ∫₀^z E/(1 − ν²) (z′ − z_n) dz′,
//!
//! where σ_rz follows from equilibrium and σ_zz is neglected. The bending moments and shear forces of a
//! Reissner–Mindlin plate are the same, since shear deformation does not change the equilibrium under a given
//! axisymmetric load. For one layer, σ_rr + σ_θθ = 6(1 + ν)/(ξh)² on the lower face, as in Kirchhoff's theory.

use super::{Response, Stack};

/// Cross-section of a stack in thin-plate theory.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Flexural rigidity D, N m.
    pub rigidity: f64,
    /// Depth z_n of the neutral plane of bending, m.
    pub neutral_depth: f64,
}

/// Stresses of a thin plate at a depth, without their powers of the wavenumber, for a unit transform of the pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bending {
    /// Stress sum ξ² (σ_rr + σ_θθ), 1/m².
    pub sum: f64,
    /// Stress difference ξ² (σ_rr − σ_θθ), 1/m².
    pub difference: f64,
    /// Shear stress ξ σ_rz, 1/m.
    pub shear: f64,
}

impl Section {
    /// Computes the section of a stack.
    pub fn new(stack: &Stack) -> Self {
        // ∫ E/(1 − ν²) (z − z_0)^n dz about the upper face, then about the neutral depth.
        let (mut above, mut stretch, mut first) = (0.0, 0.0, 0.0);
        for layer in stack.layers() {
            let part = layer.young / (1.0 - layer.poisson.powi(2)) * layer.thickness;
            stretch += part;
            first += part * (above + 0.5 * layer.thickness);
            above += layer.thickness;
        }
        let neutral_depth = first / stretch;
        let (mut above, mut rigidity) = (0.0, 0.0);
        for layer in stack.layers() {
            let part = layer.young / (1.0 - layer.poisson.powi(2)) * layer.thickness;
            let arm = above + 0.5 * layer.thickness - neutral_depth;
            rigidity += part * (arm * arm + layer.thickness.powi(2) / 12.0);
            above += layer.thickness;
        }
        Self { rigidity, neutral_depth }
    }

    /// ξ σ_rz at a depth (m) for a unit transform of the pressure, 1/m.
    pub fn shear(&self, stack: &Stack, depth: f64) -> f64 {
        self.bending(stack, depth).shear
    }

    /// Response of a thin plate at a wavenumber (1/m) and a depth (m).
    pub fn response(&self, stack: &Stack, wavenumber: f64, depth: f64) -> Response {
        let bending = self.bending(stack, depth);
        let square = wavenumber * wavenumber;
        let u_z = 1.0 / (self.rigidity * square * square);
        Response {
            u_r: (depth - self.neutral_depth) * wavenumber * u_z,
            u_z,
            sum: bending.sum / square,
            difference: bending.difference / square,
            sigma_zz: 0.0,
            sigma_rz: bending.shear / wavenumber,
        }
    }

    /// Stresses at a depth; an interface belongs to the upper layer.
    pub(super) fn bending(&self, stack: &Stack, depth: f64) -> Bending {
        let (at, _) = stack.layer_at(depth);
        let (mut above, mut shear) = (0.0, 0.0);
        for (i, layer) in stack.layers()[..=at].iter().enumerate() {
            let below = if i == at { depth } else { above + layer.thickness };
            let middle = 0.5 * (above + below) - self.neutral_depth;
            shear += layer.young / (1.0 - layer.poisson.powi(2)) * (below - above) * middle;
            above = below;
        }
        let layer = stack.layers()[at];
        let stretch = layer.young * (depth - self.neutral_depth) / self.rigidity;
        Bending {
            sum: stretch / (1.0 - layer.poisson),
            difference: -stretch / (1.0 + layer.poisson),
            shear: shear / self.rigidity,
        }
    }
}
