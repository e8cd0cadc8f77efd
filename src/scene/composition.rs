//! Materials of a body: one material, layers of a box, or the physical volumes of a mesh.

use std::collections::BTreeMap;

use crate::form::{self, Lame};
use crate::material::Material;

/// Materials of a body, and the impacted one.
#[derive(Debug, Clone, PartialEq)]
pub struct Composition {
    /// Materials and where they are.
    pub parts: Parts,
    /// Elastic constants at t → 0 and density of the impacted material. Hertz's law uses them.
    pub struck: form::Material,
    /// Index of the impacted layer; 0 without layers.
    pub struck_layer: usize,
}

/// Arrangement of the materials in a body.
#[derive(Debug, Clone, PartialEq)]
pub enum Parts {
    /// One material in the whole body.
    Whole(Material),
    /// Layers of a box across z, from the top down. Their thicknesses add up to the thickness of the box.
    Layers(Vec<Layer>),
    /// Materials by the names of the physical volumes of the mesh file.
    Volumes(BTreeMap<String, Material>),
}

/// A layer of a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Thickness, m.
    pub thickness: f64,
    /// Name of the material in the scene.
    pub name: String,
    /// Material of the layer.
    pub material: Material,
}

impl Composition {
    /// One elastic material in the whole body.
    pub fn whole(constants: form::Material) -> Self {
        Self { parts: Parts::Whole(Material::elastic(constants)), struck: constants, struck_layer: 0 }
    }

    /// All materials. Those of layers are in the order of the layers; a material may occur more than once.
    pub fn materials(&self) -> Vec<&Material> {
        match &self.parts {
            Parts::Whole(material) => vec![material],
            Parts::Layers(layers) => layers.iter().map(|layer| &layer.material).collect(),
            Parts::Volumes(volumes) => volumes.values().collect(),
        }
    }

    /// Mutable access to all materials, in the order of [`Self::materials`].
    pub fn materials_mut(&mut self) -> Vec<&mut Material> {
        match &mut self.parts {
            Parts::Whole(material) => vec![material],
            Parts::Layers(layers) => layers.iter_mut().map(|layer| &mut layer.material).collect(),
            Parts::Volumes(volumes) => volumes.values_mut().collect(),
        }
    }

    /// The material of a body if all its parts have the same one and it is elastic; otherwise `None`.
    pub fn uniform(&self) -> Option<&form::Material> {
        let first = self.materials().first().copied()?;
        (self.is_of_one_material() && first.shear.is_none()).then_some(&first.instantaneous)
    }

    /// Whether all parts have the same material, elastic or viscoelastic.
    pub fn is_of_one_material(&self) -> bool {
        self.materials().windows(2).all(|pair| pair[0] == pair[1])
    }

    /// Whether a part of it is viscoelastic.
    pub fn is_viscoelastic(&self) -> bool {
        self.materials().iter().any(|material| material.shear.is_some())
    }

    /// Layers across the body along an axis, each with its thickness (m). Without layers across this axis: one layer of
    /// the impacted material with the given length (m).
    pub fn across(&self, axis: usize, length: f64) -> Vec<(f64, Material)> {
        match &self.parts {
            Parts::Layers(layers) if axis == 2 => {
                layers.iter().map(|layer| (layer.thickness, layer.material.clone())).collect()
            }
            _ => vec![(length, Material::elastic(self.struck))],
        }
    }

    /// Compliance across the thickness along an axis, m³/N: h/E of one layer with a total thickness (m), or the sum over
    /// layers, each confined along its faces, of h/(K + 4G/3) with the long-term G.
    pub fn compliance_across(&self, axis: usize, thickness: f64) -> f64 {
        let confined = |(thickness, material): (f64, Material)| {
            let Lame { lambda, mu } = material.relaxed();
            thickness / (lambda + 2.0 * mu)
        };
        match self.uniform() {
            Some(material) => thickness / material.young,
            None => self.across(axis, thickness).into_iter().map(confined).sum(),
        }
    }

    /// The composition with elastic materials in place of the viscoelastic ones, with their secant moduli at a time, s.
    #[must_use]
    pub fn with_secant_moduli(&self, time: f64) -> Self {
        let at = |material: &Material| Material::elastic(material.secant(time));
        let parts = match &self.parts {
            Parts::Whole(material) => Parts::Whole(at(material)),
            Parts::Layers(layers) => {
                let of_layer = |layer: &Layer| Layer { material: at(&layer.material), ..layer.clone() };
                Parts::Layers(layers.iter().map(of_layer).collect())
            }
            Parts::Volumes(volumes) => {
                Parts::Volumes(volumes.iter().map(|(name, material)| (name.clone(), at(material))).collect())
            }
        };
        Self { parts, ..self.clone() }
    }

    /// Mean density of a body whose layers fill its volume, kg/m³; `None` for a mesh with several densities.
    pub fn density(&self) -> Option<f64> {
        let densities: Vec<f64> = self.materials().iter().map(|material| material.instantaneous.density).collect();
        let first = densities.first().copied()?;
        match &self.parts {
            _ if densities.iter().all(|density| *density == first) => Some(first),
            Parts::Layers(layers) => {
                let thickness: f64 = layers.iter().map(|layer| layer.thickness).sum();
                let mass: f64 = layers.iter().zip(&densities).map(|(layer, density)| layer.thickness * density).sum();
                Some(mass / thickness)
            }
            _ => None,
        }
    }

    /// Coordinates z of the faces of all layers, m: ascending, from −H/2 to H/2 for the total thickness H. Empty
    /// without layers, and for layers of one elastic material.
    pub fn interfaces(&self) -> Vec<f64> {
        let Parts::Layers(layers) = &self.parts else { return Vec::new() };
        if self.uniform().is_some() {
            return Vec::new();
        }
        let thickness: f64 = layers.iter().map(|layer| layer.thickness).sum();
        let mut depth = 0.0;
        let mut heights: Vec<f64> = layers
            .iter()
            .map(|layer| {
                depth += layer.thickness;
                0.5 * thickness - depth
            })
            .collect();
        heights.reverse();
        // The ends of the box, without rounding.
        heights[0] = -0.5 * thickness;
        heights.push(0.5 * thickness);
        heights
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layers(parts: &[(f64, f64)]) -> Composition {
        let layer = |&(thickness, density): &(f64, f64)| {
            let material = Material::elastic(form::Material { young: 70e9, poisson: 0.23, density });
            Layer { thickness, name: "glass".to_owned(), material }
        };
        let layers: Vec<Layer> = parts.iter().map(layer).collect();
        let struck = layers[0].material.instantaneous;
        Composition { parts: Parts::Layers(layers), struck, struck_layer: 0 }
    }

    #[test]
    fn densities_and_interfaces() {
        let laminate = layers(&[(0.01, 2500.0), (0.002, 1000.0), (0.008, 2500.0)]);
        assert!((laminate.density().expect("a density") / 2350.0 - 1.0).abs() < 1e-15);
        assert!(laminate.uniform().is_none() && !laminate.is_viscoelastic());
        let expected = [-0.01, -0.002, 0.0, 0.01];
        let found = laminate.interfaces();
        // Tolerance: rounding of sums of thicknesses.
        assert!(found.len() == 4 && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-17), "{found:?}");
        let alike = layers(&[(0.01, 2500.0), (0.01, 2500.0)]);
        assert!(alike.uniform().is_some() && alike.interfaces().is_empty() && alike.density() == Some(2500.0));
    }
}
