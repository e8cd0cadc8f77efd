//! The elastic body: theory, material, geometry, what is made of it.

use super::{Composition, Parts, Vec3};
use crate::form;

/// The elastic body: theory, material, geometry, elements.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// What is taken into account.
    pub model: Model,
    /// What is made of a linear body before it is stepped.
    pub reduction: Reduction,
    /// What it is made of, relaxation times being those at its temperature.
    pub composition: Composition,
    /// Its temperature, °C; `None` where relaxation times are taken as they are given.
    pub temperature: Option<f64>,
    /// Where the mesh comes from.
    pub geometry: Geometry,
    /// Polynomial degree of the elements: 1 or 2.
    pub order: usize,
    /// What part of it is solved.
    pub symmetry: Symmetry,
    /// The shortest flexural waves that the cells of a layerwise plate are made for, m: those of bodies that share a basis. `None` for those of its own
    /// contact.
    pub wavelength: Option<f64>,
}

impl Body {
    /// The elastic constants at t → 0, and the density, of what is hit.
    pub fn struck(&self) -> form::Material {
        self.composition.struck
    }

    /// The largest Young's modulus of its materials, Pa.
    pub fn stiffest(&self) -> f64 {
        self.composition.materials().iter().map(|material| material.instantaneous.young).fold(0.0, f64::max)
    }

    /// Mass of a box, kg; `None` for a mesh file.
    pub fn mass(&self) -> Option<f64> {
        let Geometry::Box { size, .. } = &self.geometry else { return None };
        Some(self.composition.density()? * size.iter().product::<f64>())
    }

    /// The thickness that a hit along z, or against it, meets first, m: that of the layer that is hit where the layers differ. `thickness` is
    /// that of the whole.
    pub fn struck_thickness(&self, thickness: f64) -> f64 {
        match (&self.composition.parts, self.composition.uniform()) {
            (Parts::Layers(layers), None) => layers[self.composition.struck_layer].thickness.min(thickness),
            _ => thickness,
        }
    }
}

/// What a body's theory takes into account, the least first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Model {
    /// The least that the scene's tolerance allows.
    Auto,
    /// Its dent alone, which Hertz's law holds.
    HalfSpace,
    /// Bending waves without echoes (Zener 1941).
    InfinitePlate,
    /// Bending of a thin plate.
    Kirchhoff,
    /// Bending with shear and rotary inertia (Reissner 1945, Mindlin 1951).
    Mindlin,
    /// The same in each layer of its own, bonded to the next.
    Layerwise,
    /// Elasticity in three dimensions.
    Solid,
}

/// What is made of a linear body before it is stepped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reduction {
    /// A Krylov basis as large as the tolerance asks for where the scheme is modal, otherwise nothing.
    Auto,
    /// Nothing.
    None,
    /// A Krylov basis of so many vectors.
    Vectors(usize),
}

/// What part of the body is solved.
#[derive(Debug, Clone, PartialEq)]
pub enum Symmetry {
    /// The whole.
    None {
        /// Why it was not cut, where a cut was to be made if possible.
        reason: Option<String>,
    },
    /// The part of a box where the coordinates of both axes are positive. The planes where one of them is zero are planes of
    /// symmetry of the whole scene.
    Quarter {
        /// The axes normal to those planes, ascending.
        axes: [usize; 2],
    },
    /// The whole. The body, its supports and its loads are symmetric about planes that the impact is not symmetric about: of splines, the
    /// motion is the sum of symmetric and antisymmetric ones, each of them that of a part.
    Parts {
        /// The axes normal to the planes, ascending: one or two.
        axes: Vec<usize>,
        /// Why the impact is not symmetric.
        reason: String,
    },
}

/// Where the mesh comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// A box centred on the origin, cut into hexahedra.
    Box {
        /// Edge lengths, m.
        size: Vec3,
        /// Coordinates of the grid planes across each axis, m, ascending from −size/2 to size/2; the cells lie between them.
        planes: [Vec<f64>; 3],
        /// Whether the scene gives cells or their order.
        is_given: bool,
    },
    /// A Gmsh file (2.2 or 4.1), surfaces by physical name; relative to the scene file.
    Gmsh(std::path::PathBuf),
}
