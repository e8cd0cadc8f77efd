//! Nonlinear forces of a body in addition to its linear stiffness.

use nalgebra::DVector;

/// Conservative force of a body in the real coordinates x of its vibrations, which the linear stiffness of its modes does not
/// contain. Unilateral foundations are one: the modes have two-way springs, whose pull is taken off where the body has lifted
/// off. The time integration ([`crate::impact`]) needs no more of it.
pub trait InternalForce {
    /// Adds the generalised force −∂U/∂x (N) at some coordinates (m) to `force`, minus the one in the equilibrium from which
    /// the motion starts.
    fn add_force(&self, x: &DVector<f64>, force: &mut DVector<f64>);

    /// Largest sum of the magnitudes of the generalised forces at some coordinates, N: changes far below it are rounding.
    fn scale(&self, x: &DVector<f64>) -> f64;

    /// Energy U at some coordinates, J.
    fn energy(&self, x: &DVector<f64>) -> f64;

    /// Generalised force in the equilibrium from which the motion starts, N; zero if it starts undeformed.
    fn force_at_rest(&self) -> DVector<f64>;

    /// Force at some coordinates, as [`Self::add_force`] adds it.
    fn force(&self, x: &DVector<f64>) -> DVector<f64> {
        let mut force = DVector::zeros(x.len());
        self.add_force(x, &mut force);
        force
    }
}
