//! Frequency of the flexural waves of an infinite stack in three-dimensional elasticity.
//!
//! A straight-crested wave u = U(z) sin ξx, w = W(z) cos ξx has the energies of a problem in one dimension. U and W are
//! continuous piecewise polynomials across the layers. A polynomial of degree p has an error proportional to (ξh)^{2p} in the square of the frequency.

use nalgebra::{DMatrix, DVector};

use super::Layer;
use crate::element::gauss_legendre;

/// Degree of the polynomials in each layer. For ξh up to 3 the relative error of the frequency is below 1e-5.
const DEGREE: usize = 5;

/// Relative change of the squared frequency at which the iteration ends.
const ROUNDING: f64 = 1e-11;

/// Largest number of iterations.
const ITERATIONS: usize = 20;

/// Circular frequency of the flexural wave with a wavenumber ξ (1/m), for layers with their densities (kg/m³), rad/s. It
/// is the frequency nearest to the estimate `near`. It need not be the lowest one: the shear waves within a soft
/// interlayer are slow.
pub fn flexural_frequency(layers: &[(Layer, f64)], wavenumber: f64, near: f64) -> f64 {
    let [stiffness, mass] = energies(layers, wavenumber);
    // Inverse iteration with the shift `near`² from the translation, which is nearly the wave.
    let mut square = near * near;
    let factor = (&stiffness - &mass * square).lu();
    let half = mass.nrows() / 2;
    let mut wave = DVector::from_fn(2 * half, |i, _| if i < half { 0.0 } else { 1.0 });
    for _ in 0..ITERATIONS {
        // The matrix is singular if the estimate is exact.
        let Some(next) = factor.solve(&(&mass * &wave)) else { return near };
        wave = &next / next.amax();
        let found = wave.dot(&(&stiffness * &wave)) / wave.dot(&(&mass * &wave));
        let is_settled = (found / square - 1.0).abs() < ROUNDING;
        square = found;
        if is_settled {
            break;
        }
    }
    square.sqrt()
}

/// Matrices of twice the elastic and twice the kinetic energy in the coefficients of U, then of W.
fn energies(layers: &[(Layer, f64)], wavenumber: f64) -> [DMatrix<f64>; 2] {
    let functions = layers.len() * DEGREE + 1;
    let [mut stiffness, mut mass] = [0, 1].map(|_| DMatrix::zeros(2 * functions, 2 * functions));
    let rule: Vec<(f64, f64, [Shape; DEGREE + 1])> =
        gauss_legendre(DEGREE + 1).into_iter().map(|(s, weight)| (s, weight, shapes(s))).collect();
    for (number, (layer, density)) in layers.iter().enumerate() {
        let (Layer { thickness, poisson, .. }, shear) = (*layer, layer.shear());
        let lambda = 2.0 * shear * poisson / (1.0 - 2.0 * poisson);
        let across = lambda + 2.0 * shear;
        let half = 0.5 * thickness;
        for (_, weight, shapes) in &rule {
            for (a, one) in shapes.iter().enumerate() {
                for (b, other) in shapes.iter().enumerate() {
                    let [u, w] = [number * DEGREE + a, functions + number * DEGREE + a];
                    let [v, z] = [number * DEGREE + b, functions + number * DEGREE + b];
                    let weight = half * weight;
                    let value = weight * one.value * other.value;
                    let slope = weight * one.slope * other.slope / (half * half);
                    let mixed = weight * one.value * other.slope / half * wavenumber;
                    stiffness[(u, v)] += across * wavenumber * wavenumber * value + shear * slope;
                    stiffness[(w, z)] += across * slope + shear * wavenumber * wavenumber * value;
                    // λ ξU W′ and −μ U′ ξW.
                    stiffness[(u, z)] += lambda * mixed;
                    stiffness[(z, u)] += lambda * mixed;
                    stiffness[(v, w)] -= shear * mixed;
                    stiffness[(w, v)] -= shear * mixed;
                    mass[(u, v)] += density * value;
                    mass[(w, z)] += density * value;
                }
            }
        }
    }
    [stiffness, mass]
}

/// Value and slope of a function on \[−1, 1\].
#[derive(Debug, Clone, Copy)]
struct Shape {
    value: f64,
    slope: f64,
}

/// Shape functions of a layer at s in \[−1, 1\]: the first and the last are linear and 1 at the upper and the lower
/// face, the others are integrals of Legendre polynomials (P_{k+1} − P_{k−1}) and vanish on both faces.
fn shapes(s: f64) -> [Shape; DEGREE + 1] {
    let mut legendre = [0.0; DEGREE + 1];
    (legendre[0], legendre[1]) = (1.0, s);
    for k in 1..DEGREE {
        let degree = k as f64;
        legendre[k + 1] = ((2.0 * degree + 1.0) * s * legendre[k] - degree * legendre[k - 1]) / (degree + 1.0);
    }
    std::array::from_fn(|i| match i {
        0 => Shape { value: 0.5 * (1.0 - s), slope: -0.5 },
        DEGREE => Shape { value: 0.5 * (1.0 + s), slope: 0.5 },
        // The derivative of P_{k+1} − P_{k−1} is (2k + 1) P_k.
        k => Shape { value: legendre[k + 1] - legendre[k - 1], slope: (2 * k + 1) as f64 * legendre[k] },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::plate::Section;

    /// The wave of one layer satisfies the Rayleigh–Lamb equation of antisymmetric waves, tan(qh/2)/tan(ph/2) =
    /// −(q² − ξ²)²/(4 ξ² p q), with p² = ω²/c_l² − ξ² and q² = ω²/c_t² − ξ². Both are imaginary.
    #[test]
    fn one_layer_has_lambs_waves() {
        let (thickness, young, poisson, density) = (0.02, 70e9, 0.23, 2500.0);
        let shear = 0.5 * young / (1.0 + poisson);
        let squares = [2.0 * shear * (1.0 - poisson) / (1.0 - 2.0 * poisson), shear].map(|modulus| modulus / density);
        for x in [0.1, 0.5, 1.0, 2.0, 3.0] {
            let wavenumber = x / thickness;
            // The estimate is that of Mindlin's plate.
            let section = Section { thickness, young, poisson, density };
            let [bending, shear] = [section.rigidity() * wavenumber.powi(4), 5.0 / (6.0 - poisson) * section.shear()];
            let near = (bending / (density * thickness * (1.0 + bending / (shear * wavenumber.powi(2))))).sqrt();
            let frequency = flexural_frequency(&[(Layer { thickness, young, poisson }, density)], wavenumber, near);
            let residual = |factor: f64| {
                let square = (factor * frequency).powi(2);
                let [a, b] = squares.map(|of| (wavenumber * wavenumber - square / of).sqrt());
                // With p = i a and q = i b.
                4.0 * wavenumber * wavenumber * a * b * (0.5 * b * thickness).tanh()
                    - (b * b + wavenumber * wavenumber).powi(2) * (0.5 * a * thickness).tanh()
            };
            // The residual changes its sign within the error of the frequency.
            let around = [1.0 - 1e-5, 1.0 + 1e-5].map(residual);
            assert!(around[0] * around[1] < 0.0, "{x}: {frequency} {around:?}");
        }
    }
}
