//! Unilateral foundations in modal coordinates: a nonlinear force on the vibrations.

use nalgebra::DVector;

use super::{FoundationPoints, InternalForce, PadShapes};

/// Unilateral foundations in the real coordinates x of the vibrations. The modes that are left out do not move them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ModalFoundation {
    /// Foundation points. Their offsets s ū are reduced by the equilibrium displacement of the modes that are left out.
    points: FoundationPoints,
    /// The shapes in which each pad moves.
    shapes: Vec<PadShapes>,
}

impl ModalFoundation {
    pub fn new(points: FoundationPoints) -> Self {
        Self { shapes: points.pad_shapes(), points }
    }

    /// Returns the penetrations g at given coordinates x, m.
    fn penetrations(&self, x: &DVector<f64>) -> DVector<f64> {
        let mut penetrations = -&self.points.offsets;
        self.shapes.iter().for_each(|pad| pad.add_displacements(x, &mut penetrations));
        penetrations
    }

    /// Adds the generalised forces along x of forces on the points, N.
    fn add_forces(&self, at_points: &DVector<f64>, along: &mut DVector<f64>) {
        self.shapes.iter().for_each(|pad| pad.add_forces(at_points, along));
    }
}

impl InternalForce for ModalFoundation {
    fn add_force(&self, x: &DVector<f64>, force: &mut DVector<f64>) {
        self.add_forces(&-self.points.pull(&self.penetrations(x)), force);
    }

    fn scale(&self, x: &DVector<f64>) -> f64 {
        let mut along = DVector::zeros(x.len());
        self.add_forces(&self.points.stiffness.component_mul(&self.penetrations(x)), &mut along);
        along.lp_norm(1)
    }

    fn energy(&self, x: &DVector<f64>) -> f64 {
        -self.points.energy(&self.points.pull(&self.penetrations(x)))
    }

    fn force_at_rest(&self) -> DVector<f64> {
        let mut along = DVector::zeros(self.points.rows.ncols());
        self.add_forces(&-&self.points.resting, &mut along);
        along
    }
}
