//! Three-dimensional elasticity as forms on three fields, the components of the displacement.

use super::Lame;
use super::tensor::{Along, Derivative, Square};

/// Integration over the whole body.
pub const VOLUME: [Along; 3] = [Along::All; 3];

/// One component of the displacement, not differentiated.
pub const fn displacement(component: usize) -> Derivative<3> {
    Derivative { field: component, derivatives: [0; 3] }
}

/// ∂u_i/∂x_j.
fn gradient(i: usize, j: usize) -> Derivative<3> {
    let mut derivatives = [0; 3];
    derivatives[j] = 1;
    Derivative { field: i, derivatives }
}

/// Largest ratio λ/μ, that of ν = 0.45, for which the change of volume is not projected.
pub const COMPRESSIBLE: f64 = 9.0;

/// Part of λ (Pa) that acts on the projected change of volume. Splines of full smoothness cannot keep their volume
/// everywhere without becoming stiff. Quadratic splines along all axes restrict them as much as the exact solution.
pub fn projected_lambda(lame: Lame) -> f64 {
    let excess = lame.lambda - COMPRESSIBLE * lame.mu;
    // Rounding is no excess.
    if excess > 1e-9 * lame.lambda { excess } else { 0.0 }
}

/// Twice the elastic energy in the region `place`, ∫ λ (div u)² + 2 μ Σ ε_ii² + μ Σ_{i<j} (2 ε_ij)², by (4) and (5); with
/// the projected div u for [`projected_lambda`].
pub fn elastic(lame: Lame, place: [Along; 3]) -> Vec<Square<3>> {
    elastic_with(lame, projected_lambda(lame), place)
}

/// Same as [`elastic`], with a given part of λ (Pa) on the projected change of volume.
pub fn elastic_with(Lame { lambda, mu }: Lame, of_projection: f64, place: [Along; 3]) -> Vec<Square<3>> {
    let square = |factor: f64, parts: &[Derivative<3>]| Square::of_sum(factor, parts, place);
    let stretches = (0..3).map(|i| square(2.0 * mu, &[gradient(i, i)]));
    let shears = [(0, 1), (0, 2), (1, 2)].map(|(i, j)| square(mu, &[gradient(i, j), gradient(j, i)]));
    let divergence = [0, 1, 2].map(|i| gradient(i, i));
    let volume = square(lambda - of_projection, &divergence);
    let projected = Square::of_sum(of_projection, &divergence, place.map(Along::projected));
    stretches.chain(shears).chain([volume]).chain((of_projection > 0.0).then_some(projected)).collect()
}

/// Twice the kinetic energy in the region `place`, ∫ ρ u², with u as a velocity and the density in kg/m³.
pub fn mass(density: f64, place: [Along; 3]) -> Vec<Square<3>> {
    (0..3).map(|i| Square::of_sum(density, &[displacement(i)], place)).collect()
}
