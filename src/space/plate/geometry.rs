//! Geometry of a box modelled as a plate: its middle plane, its thickness and its impact point.

use super::LEAST_DISC;
use crate::form::ContactArea;
use crate::scene::{Geometry, Scene, Symmetry, Vec3, faces};
use crate::space::parity::{ParityClass, classes};

pub(super) const NAMES: [&str; 3] = ["x", "y", "z"];

/// Geometry of a plate. The axes of the plate are two axes of the scene; the deflection is along the impactor's
/// direction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PlateGeometry {
    /// Axes of the scene in the plane, ascending.
    pub axes: [usize; 2],
    /// Axis of the scene normal to the plate.
    pub normal: usize,
    /// 1 if the impactor moves along the normal axis, −1 if it moves against it.
    pub sign: f64,
    /// Thickness h, m.
    pub thickness: f64,
    /// Edge lengths of the whole plate, m.
    pub edges: [f64; 2],
    /// Impact point relative to the centre, m.
    pub hit: [f64; 2],
    /// Area on which the contact presses, if it is given.
    pub area: Option<ContactArea>,
    /// Axes normal to planes of symmetry of the body; the part with positive coordinates is modelled.
    pub halved: [bool; 2],
    /// Whether the impact is symmetric about these planes too. Points are then reflected before they are evaluated.
    pub is_quarter: bool,
    /// Symmetry classes of the motion of the modelled part; together they describe the whole plate.
    pub classes: Vec<ParityClass>,
}

impl PlateGeometry {
    /// Geometry of the plate of a scene, or the reason why the body is not a plate.
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
            // Allow for equal lengths typed with different digits.
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
            area: scene.contact.area().copied(),
            halved,
            is_quarter,
            classes: classes(halved, hit.map(|x| x == 0.0)),
        })
    }

    /// The given area if it is at least as wide as the narrowest disc: the stresses and the short waves of a thin plate do not
    /// tell a narrower one from a point.
    pub fn wide_area(&self) -> Option<&ContactArea> {
        self.area.as_ref().filter(|area| area.equivalent_radius() >= LEAST_DISC * self.thickness)
    }

    /// Axes of the scene normal to planes of symmetry.
    pub fn mirrors(&self) -> Vec<usize> {
        (0..2).filter(|&i| self.halved[i]).map(|i| self.axes[i]).collect()
    }

    /// Symmetry multiplicity: number of times that the modelled part fits into the whole plate.
    pub fn multiplicity(&self) -> f64 {
        self.halved.iter().map(|&halved| if halved { 2.0 } else { 1.0 }).product()
    }

    /// Ends of the modelled part along an axis of the plane, m.
    pub fn ends(&self, axis: usize) -> [f64; 2] {
        let half = 0.5 * self.edges[axis];
        [if self.halved[axis] { 0.0 } else { -half }, half]
    }

    /// Impact point, or its mirror image in the modelled part, m.
    pub fn hit_in_part(&self) -> [f64; 2] {
        [0, 1].map(|i| if self.halved[i] { self.hit[i].abs() } else { self.hit[i] })
    }

    /// Lines of the modelled part along an axis of the plane. If the other half is evaluated separately (symmetry
    /// classes), their mirror images are included.
    pub fn lines_of_whole(&self, axis: usize, lines: &[f64]) -> Vec<f64> {
        if self.is_quarter || !self.halved[axis] {
            return lines.to_vec();
        }
        lines[1..].iter().rev().map(|x| -x).chain(lines.iter().copied()).collect()
    }

    /// Coordinates (m) along the normal axis of heights along the deflection, ascending.
    pub fn across_plate(&self, heights: &[f64]) -> Vec<f64> {
        let mut places: Vec<f64> = heights.iter().map(|height| self.sign * height).collect();
        places.sort_by(f64::total_cmp);
        places
    }

    /// Component of a vector along the deflection.
    pub fn across(&self, vector: Vec3) -> f64 {
        self.sign * vector[self.normal]
    }

    /// Components of a vector in the plane.
    pub fn in_plane(&self, vector: Vec3) -> [f64; 2] {
        self.axes.map(|axis| vector[axis])
    }

    /// Distance of the impact point from the nearest edge, m.
    pub fn distance_to_edge(&self) -> f64 {
        (0..2).map(|i| 0.5 * self.edges[i] - self.hit[i].abs()).fold(f64::INFINITY, f64::min)
    }
}
