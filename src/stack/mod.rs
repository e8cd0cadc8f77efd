//! The static field of an infinite elastic stack of layers under an axisymmetric pressure on its upper face, and the part of it
//! that a body's own stresses lack under the impactor.
//!
//! [`Stack`] is the exact three-dimensional solution for one wavenumber: layers of any stiffness, bonded, free below. [`Section`] is
//! what the theory of thin plates has in its place, [`Layerwise`] that of plates that are bonded. [`LocalField`] adds up the wavenumbers: the stresses that are missing where a
//! discretised body carries the force on another disc than the contact's own, or bends as a plate. [`half_space`] has Hertz's field.
//!
//! Coordinates are cylindrical about the line of the force: the radius r, and the depth z from the upper face into the body. A
//! pressure of the Hankel transform P(ξ) = 2π ∫ p J₀(ξr) r dr causes
//!
//! u_z, σ_zz, σ_rr + σ_θθ = (1/2π) ∫ ξ P · (…) J₀(ξr) dξ,   u_r, σ_rz by J₁,   σ_rr − σ_θθ by J₂,
//!
//! with the transforms of [`Response`] for (…). Tension is positive.
//!
//! Nothing here knows a scene or a mesh.

pub mod half_space;
mod layer;
mod layerwise;
mod level;
mod local;
mod point;
mod pressure;
mod resultants;
mod section;
mod wave;

pub use layerwise::{Layerwise, LayerwiseWave};
pub use level::Level;
pub use local::{Carrier, LocalField, Sections};
pub use point::{Cylindrical, PointField};
pub use pressure::Pressure;
pub use resultants::on_parabola;
pub use section::Section;
pub use wave::Wave;

/// A homogeneous, isotropic, elastic layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// h, m.
    pub thickness: f64,
    /// E, Pa.
    pub young: f64,
    /// ν, above −1 and below ½; up to 0.4999 is tested.
    pub poisson: f64,
}

/// Bonded layers of infinite extent, from the loaded face down; the other face is free.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    layers: Vec<Layer>,
    /// The same with the stack's thickness and the first layer's E for units.
    scaled: Vec<layer::Scaled>,
    thickness: f64,
}

/// The field of one wavenumber over the transform of the pressure: amplitudes at a depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// u_r, with J₁, m/Pa.
    pub u_r: f64,
    /// u_z, positive into the body, with J₀, m/Pa.
    pub u_z: f64,
    /// σ_rr + σ_θθ, with J₀.
    pub sum: f64,
    /// σ_rr − σ_θθ, with J₂.
    pub difference: f64,
    /// σ_zz, with J₀.
    pub sigma_zz: f64,
    /// σ_rz, with J₁.
    pub sigma_rz: f64,
}

impl Stack {
    /// Layers from the loaded face down; `None` without any, or where one is no stable elastic solid.
    pub fn new(layers: &[Layer]) -> Option<Self> {
        let is_positive = |x: f64| x > 0.0 && x.is_finite();
        let is_stable = |layer: &Layer| {
            is_positive(layer.thickness) && is_positive(layer.young) && layer.poisson > -1.0 && layer.poisson < 0.5
        };
        let first = layers.first().filter(|_| layers.iter().all(is_stable))?;
        let thickness = layers.iter().map(|layer| layer.thickness).sum();
        let scaled = layers.iter().map(|layer| layer::Scaled::new(layer, thickness, first.young)).collect();
        Some(Self { layers: layers.to_vec(), scaled, thickness })
    }

    /// The layers, from the loaded face down.
    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// H, m: of all layers.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// The solution at a positive wavenumber ξ, 1/m.
    pub fn wave(&self, wavenumber: f64) -> Wave {
        Wave::new(&self.scaled, wavenumber * self.thickness, self.thickness / self.layers[0].young)
    }

    /// The layer at a depth and the depth within it, m; an interface is the upper layer's.
    fn layer_at(&self, depth: f64) -> (usize, f64) {
        let mut above = 0.0;
        let last = self.layers.len() - 1;
        for (i, layer) in self.layers[..last].iter().enumerate() {
            if depth <= above + layer.thickness {
                return (i, depth - above);
            }
            above += layer.thickness;
        }
        (last, depth - above)
    }
}
