//! Static field of an infinite elastic stack of layers under an axisymmetric pressure on its upper face, and the local
//! field that the computed stresses of a body lack under the impactor.
//!
//! [`Stack`] is the exact three-dimensional solution for one wavenumber: bonded layers of any stiffness with a free
//! lower face. [`Section`] is the same field in thin-plate theory, [`Layerwise`] in the layerwise plate theory.
//! [`Transverse`] has the shear and the thickness strain of that theory, and [`flexural_frequency`] belongs to moving
//! stacks. [`SphereOnStack`] is the contact with a [`Sphere`]. [`LocalField`] sums over the wavenumbers. It contains the stresses that are missing in a discretised body, if the
//! body carries the force on a disc other than the contact disc or is modelled as a plate. [`half_space`] is Hertz's
//! field.
//!
//! Coordinates are cylindrical about the line of the force: the radius r, and the depth z from the upper face into the
//! body. A pressure with the Hankel transform P(ξ) = 2π ∫ p J₀(ξr) r dr causes
//!
//! u_z, σ_zz, σ_rr + σ_θθ = (1/2π) ∫ ξ P · (…) J₀(ξr) dξ,   u_r, σ_rz by J₁,   σ_rr − σ_θθ by J₂,
//!
//! with the transforms of [`Response`] for (…). Tension is positive.
//!
//! This module does not depend on scenes or meshes.

mod flexural_wave;
pub mod half_space;
mod indentation;
mod layer;
mod layerwise;
mod level;
mod local;
mod point;
mod pressure;
mod resultants;
mod section;
mod transverse;
mod wave;

pub use flexural_wave::flexural_frequency;
pub use indentation::{ContactLaw, ContactPoint, Sphere, SphereOnStack};
pub use layerwise::{Layerwise, LayerwiseWave};
pub use level::Level;
pub use local::{Carrier, LEAST_DEPTH_OVER_CONTACT, LocalField, Sections};
pub use point::{Cylindrical, PointField};
pub use pressure::Pressure;
pub use resultants::on_parabola;
pub use section::Section;
pub use transverse::{ShearStrain, Transverse, interlayers};
pub use wave::Wave;

use crate::form::Material;

/// Homogeneous, isotropic, elastic layer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Thickness h, m.
    pub thickness: f64,
    /// Young's modulus E, Pa.
    pub young: f64,
    /// Poisson's ratio ν, above −1 and below ½; tested up to 0.4999.
    pub poisson: f64,
}

impl Layer {
    /// Layer of a thickness (m) and a material.
    pub fn of(thickness: f64, material: &Material) -> Self {
        Self { thickness, young: material.young, poisson: material.poisson }
    }

    /// Shear modulus μ, Pa.
    pub fn shear(&self) -> f64 {
        0.5 * self.young / (1.0 + self.poisson)
    }
}

/// Bonded layers of infinite extent, from the loaded face down; the lower face is free.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    layers: Vec<Layer>,
    /// Layers in scaled units: the stack's thickness and the first layer's E are 1.
    scaled: Vec<layer::Scaled>,
    thickness: f64,
}

/// Field of one wavenumber at a depth, divided by the transform of the pressure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
    /// Radial displacement u_r, with J₁, m/Pa.
    pub u_r: f64,
    /// Displacement u_z, positive into the body, with J₀, m/Pa.
    pub u_z: f64,
    /// Stress sum σ_rr + σ_θθ, with J₀.
    pub sum: f64,
    /// Stress difference σ_rr − σ_θθ, with J₂.
    pub difference: f64,
    /// Normal stress σ_zz, with J₀.
    pub sigma_zz: f64,
    /// Shear stress σ_rz, with J₁.
    pub sigma_rz: f64,
}

impl Stack {
    /// Stack of layers from the loaded face down; `None` if there are no layers or a layer is not a stable elastic
    /// solid.
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

    /// Total thickness H, m.
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Solution at a positive wavenumber ξ, 1/m.
    pub fn wave(&self, wavenumber: f64) -> Wave {
        Wave::new(&self.scaled, wavenumber * self.thickness, self.thickness / self.layers[0].young)
    }

    /// Number of the layer at a depth, and the depth within it, m; an interface belongs to the upper layer.
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
