//! What a body is made of: one material, layers of a box, or the physical volumes of a mesh.

use std::collections::BTreeMap;

use crate::form;
use crate::material::Material;

/// What a body is made of, and what of it is hit.
#[derive(Debug, Clone, PartialEq)]
pub struct Composition {
    /// Its materials, and where they are.
    pub parts: Parts,
    /// The elastic constants at t → 0, and the density, of the material that is hit: Hertz's law takes these.
    pub struck: form::Material,
    /// The number of that material's layer, where there are layers.
    pub struck_layer: usize,
}

/// Where the materials of a body are.
#[derive(Debug, Clone, PartialEq)]
pub enum Parts {
    /// One material in all of it.
    Whole(Material),
    /// Layers of a box across z, from the top down; their thicknesses add up to the box's.
    Layers(Vec<Layer>),
    /// Materials by the name of a physical volume of the mesh file.
    Volumes(BTreeMap<String, Material>),
}

/// A layer of a box.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// m.
    pub thickness: f64,
    /// What it is made of.
    pub material: Material,
}

impl Composition {
    /// One elastic material in all of the body.
    pub fn whole(constants: form::Material) -> Self {
        Self { parts: Parts::Whole(Material::elastic(constants)), struck: constants, struck_layer: 0 }
    }

    /// The materials, in no other order than that of layers.
    pub fn materials(&self) -> Vec<&Material> {
        match &self.parts {
            Parts::Whole(material) => vec![material],
            Parts::Layers(layers) => layers.iter().map(|layer| &layer.material).collect(),
            Parts::Volumes(volumes) => volumes.values().collect(),
        }
    }

    /// The same, to be changed.
    pub fn materials_mut(&mut self) -> Vec<&mut Material> {
        match &mut self.parts {
            Parts::Whole(material) => vec![material],
            Parts::Layers(layers) => layers.iter_mut().map(|layer| &mut layer.material).collect(),
            Parts::Volumes(volumes) => volumes.values_mut().collect(),
        }
    }

    /// The one material of a body whose parts are all alike, and elastic.
    pub fn uniform(&self) -> Option<&form::Material> {
        let first = self.materials().first().copied()?;
        (self.is_of_one_material() && first.shear.is_none()).then_some(&first.instantaneous)
    }

    /// Whether its parts are all alike, elastic or not.
    pub fn is_of_one_material(&self) -> bool {
        self.materials().windows(2).all(|pair| pair[0] == pair[1])
    }

    /// Whether a part of it is viscoelastic.
    pub fn is_viscoelastic(&self) -> bool {
        self.materials().iter().any(|material| material.shear.is_some())
    }

    /// What lies across the body along an axis, over a length (m), each with its own length: the layers across z, else what is hit.
    pub fn across(&self, axis: usize, length: f64) -> Vec<(f64, Material)> {
        match &self.parts {
            Parts::Layers(layers) if axis == 2 => {
                layers.iter().map(|layer| (layer.thickness, layer.material.clone())).collect()
            }
            _ => vec![(length, Material::elastic(self.struck))],
        }
    }

    /// The same with the elastic constants that its materials have a time (s) after a step of the strain.
    #[must_use]
    pub fn elastic_at(&self, time: f64) -> Self {
        let at = |material: &Material| Material::elastic(material.at(time));
        let parts = match &self.parts {
            Parts::Whole(material) => Parts::Whole(at(material)),
            Parts::Layers(layers) => {
                let of_layer = |layer: &Layer| Layer { thickness: layer.thickness, material: at(&layer.material) };
                Parts::Layers(layers.iter().map(of_layer).collect())
            }
            Parts::Volumes(volumes) => {
                Parts::Volumes(volumes.iter().map(|(name, material)| (name.clone(), at(material))).collect())
            }
        };
        Self { parts, ..self.clone() }
    }

    /// The density of a whole whose volume is that of its layers, kg/m³; `None` for a mesh of several densities.
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

    /// Where layers that differ end across z, m: ascending, from −H/2 to H/2 of their thickness H. Empty for a body of one material.
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
        // Exactly where the box ends.
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
            Layer { thickness, material }
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
        // Rounding of sums of thicknesses.
        assert!(found.len() == 4 && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-17), "{found:?}");
        let alike = layers(&[(0.01, 2500.0), (0.01, 2500.0)]);
        assert!(alike.uniform().is_some() && alike.interfaces().is_empty() && alike.density() == Some(2500.0));
    }
}
