//! The elastic body: theory, reduction, materials, geometry, elements and symmetry.

use super::{Composition, Parts, Vec3};
use crate::form;

/// The elastic body: theory, reduction, materials, geometry, elements and symmetry.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Theory of the body.
    pub model: Model,
    /// Reduction of a linear body before the time integration.
    pub reduction: Reduction,
    /// Materials and where they are. Relaxation times are shifted to the temperature of the body.
    pub composition: Composition,
    /// Temperature, °C. `None`: relaxation times are used as given.
    pub temperature: Option<f64>,
    /// Origin of the mesh.
    pub geometry: Geometry,
    /// Polynomial degree of the elements: 1 or 2.
    pub order: usize,
    /// Part of the body that is solved.
    pub symmetry: Symmetry,
}

impl Body {
    /// Elastic constants at t → 0 and density of the impacted material.
    pub fn struck(&self) -> form::Material {
        self.composition.struck
    }

    /// Largest instantaneous Young's modulus of the materials, Pa.
    pub fn stiffest(&self) -> f64 {
        self.composition.materials().iter().map(|material| material.instantaneous.young).fold(0.0, f64::max)
    }

    /// Mass of a box, kg; `None` for a mesh file.
    pub fn mass(&self) -> Option<f64> {
        let Geometry::Box { size, .. } = &self.geometry else { return None };
        Some(self.composition.density()? * size.iter().product::<f64>())
    }

    /// Number of unknowns of the modelled part of a box on its grid of finite elements; `None` for a mesh file.
    pub fn grid_unknowns(&self) -> Option<f64> {
        let Geometry::Box { planes, .. } = &self.geometry else { return None };
        let nodes = |axis: usize| ((planes[axis].len() - 1) * self.order + 1) as f64;
        let part = if matches!(self.symmetry, Symmetry::Quarter { .. }) { 0.25 } else { 1.0 };
        Some(part * 3.0 * (0..3).map(nodes).product::<f64>())
    }

    /// Length over which the body resembles a half-space of the impacted material, m: the thickness of the impacted
    /// layer if the layers differ, else `thickness`, the thickness of the whole body along the impact. Never more than
    /// `thickness`. If a side is hit, the impacted layer is a strip of the face, and its thickness is the strip's width.
    pub fn struck_thickness(&self, thickness: f64) -> f64 {
        match (&self.composition.parts, self.composition.uniform()) {
            (Parts::Layers(layers), None) => layers[self.composition.struck_layer].thickness.min(thickness),
            _ => thickness,
        }
    }
}

/// Theory of a body, from the simplest to the most complete.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Model {
    /// The simplest theory that meets the tolerance of the scene.
    Auto,
    /// Local indentation by Hertz's law only; the body does not bend.
    HalfSpace,
    /// Bending waves without reflections (Zener 1941).
    InfinitePlate,
    /// Bending of a thin plate.
    Kirchhoff,
    /// Bending with shear deformation and rotary inertia (Reissner 1945, Mindlin 1951).
    Mindlin,
    /// Bending with shear deformation and rotary inertia in each layer, with bonded layers.
    Layerwise,
    /// Three-dimensional elasticity.
    Solid,
}

/// Reduction of a linear body before the time integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reduction {
    /// With modal coordinates: a Krylov basis as large as the tolerance requires. Otherwise no reduction.
    Auto,
    /// No reduction.
    None,
    /// A Krylov basis with this number of vectors.
    Vectors(usize),
}

/// Part of the body that is solved.
#[derive(Debug, Clone, PartialEq)]
pub enum Symmetry {
    /// The whole body.
    None {
        /// Why the body was not cut, if the scene asked to cut it where possible.
        reason: Option<String>,
    },
    /// The quarter of a box where both coordinates along `axes` are positive. The planes where one of them is zero are
    /// planes of symmetry of the whole scene.
    Quarter {
        /// Axes normal to the two planes, ascending.
        axes: [usize; 2],
    },
    /// The whole body. The body, its supports and its loads are symmetric about planes; the impact is not. On splines,
    /// the motion is the sum of symmetric and antisymmetric motions, each computed on a part of the body.
    Parts {
        /// Axes normal to the planes, ascending: one or two.
        axes: Vec<usize>,
        /// Why the impact is not symmetric.
        reason: String,
    },
}

/// Origin of the mesh.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// A box centred on the origin, cut into hexahedra.
    Box {
        /// Edge lengths, m.
        size: Vec3,
        /// Coordinates of the grid planes across each axis, m, from −size/2 to size/2. Cells lie between them.
        planes: [Vec<f64>; 3],
        /// Whether the scene gives the number of cells, their grading or their order.
        is_given: bool,
    },
    /// A Gmsh file (2.2 or 4.1), with surfaces by their physical names. The path is relative to the folder of the scene
    /// file.
    Gmsh(std::path::PathBuf),
}
