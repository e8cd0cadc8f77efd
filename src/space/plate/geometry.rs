//! A box seen as a plate: its middle plane, its thickness, and where it is hit.

use crate::scene::{Geometry, Scene, Symmetry, Vec3, faces};
use crate::space::parity::{ParityClass, classes};

pub(super) const NAMES: [&str; 3] = ["x", "y", "z"];

/// The plate's axes are two of the scene's; the deflection is along the impactor's direction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PlateGeometry {
    /// Scene's axes in the plane, ascending.
    pub axes: [usize; 2],
    /// Scene's axis across the plate.
    pub normal: usize,
    /// 1 where the impactor moves along the normal axis, −1 where against it.
    pub sign: f64,
    /// h, m.
    pub thickness: f64,
    /// Edge lengths of the whole plate, m.
    pub edges: [f64; 2],
    /// Where it is hit, from its centre, m.
    pub hit: [f64; 2],
    /// Axes across planes of symmetry of the body, of which the part with positive coordinates is modelled.
    pub halved: [bool; 2],
    /// Whether these are planes of the impact too, across which points are reflected before they are read.
    pub is_quarter: bool,
    /// The motions of that part which together are the plate's.
    pub classes: Vec<ParityClass>,
}

impl PlateGeometry {
    /// Why the body is no plate.
    pub fn new(scene: &Scene) -> Result<Self, String> {
        let Geometry::Box { size, .. } = &scene.body.geometry else {
            return Err("the body is from a mesh file, not a box".into());
        };
        let direction = scene.impactor.direction;
        let mut along = (0..3).filter(|&axis| direction[axis] != 0.0);
        let (Some(normal), None) = (along.next(), along.next()) else {
            return Err("the impactor does not move along the normal of a face".into());
        };
        let axes = faces::along(normal);
        for axis in axes {
            // Equal lengths typed in different digits.
            if size[axis] < size[normal] * (1.0 - 1e-9) {
                let [across, along] = [normal, axis].map(|axis| NAMES[axis]);
                return Err(format!("the body is not thin along {across}: its edge along {along} is shorter"));
            }
        }
        let hit = axes.map(|axis| scene.impactor.point[axis]);
        let (halved, is_quarter) = match &scene.body.symmetry {
            Symmetry::None { .. } => ([false; 2], false),
            Symmetry::Quarter { .. } => ([true; 2], true),
            Symmetry::Parts { axes: planes, .. } => (axes.map(|axis| planes.contains(&axis)), false),
        };
        Ok(Self {
            axes,
            normal,
            sign: direction[normal].signum(),
            thickness: size[normal],
            edges: axes.map(|axis| size[axis]),
            hit,
            halved,
            is_quarter,
            classes: classes(halved, hit.map(|x| x == 0.0)),
        })
    }

    /// Scene's axes across planes of symmetry.
    pub fn mirrors(&self) -> Vec<usize> {
        (0..2).filter(|&i| self.halved[i]).map(|i| self.axes[i]).collect()
    }

    /// How many modelled parts make the whole.
    pub fn copies(&self) -> f64 {
        self.halved.iter().map(|&halved| if halved { 2.0 } else { 1.0 }).product()
    }

    /// The ends of the modelled part along an axis of the plane, m.
    pub fn ends(&self, axis: usize) -> [f64; 2] {
        let half = 0.5 * self.edges[axis];
        [if self.halved[axis] { 0.0 } else { -half }, half]
    }

    /// The hit, or its mirror image in the modelled part, m.
    pub fn hit_in_part(&self) -> [f64; 2] {
        [0, 1].map(|i| if self.halved[i] { self.hit[i].abs() } else { self.hit[i] })
    }

    /// Lines of the modelled part along an axis of the plane, with their mirror images where these are another part of what is read.
    pub fn lines_of_whole(&self, axis: usize, lines: &[f64]) -> Vec<f64> {
        if self.is_quarter || !self.halved[axis] {
            return lines.to_vec();
        }
        lines[1..].iter().rev().map(|x| -x).chain(lines.iter().copied()).collect()
    }

    /// Coordinates across the plate of heights along the deflection, ascending, m.
    pub fn across_plate(&self, heights: &[f64]) -> Vec<f64> {
        let mut places: Vec<f64> = heights.iter().map(|height| self.sign * height).collect();
        places.sort_by(f64::total_cmp);
        places
    }

    /// A vector's component along the deflection.
    pub fn across(&self, vector: Vec3) -> f64 {
        self.sign * vector[self.normal]
    }

    /// A vector's components in the plane.
    pub fn in_plane(&self, vector: Vec3) -> [f64; 2] {
        self.axes.map(|axis| vector[axis])
    }

    /// How far the hit is from the nearest edge, m.
    pub fn distance_to_edge(&self) -> f64 {
        (0..2).map(|i| 0.5 * self.edges[i] - self.hit[i].abs()).fold(f64::INFINITY, f64::min)
    }
}
