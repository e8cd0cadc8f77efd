//! Exact propagation of a linear system in modal coordinates under a force that is quadratic in time.
//!
//! Each coordinate satisfies ż = λ z + b F(t) + g with constant λ, b, g. Over a step h, with F the quadratic through
//! its values at 0, h/2 and h,
//!
//! z(τh) = e^{λτh} z(0) + b h Σ_j w_j(λh, τ) F_j + g τh φ₁(λτh),
//!
//! where w_j are the weights of the three values. They consist of φ_k(y) = ∫₀¹ e^{y(1−s)} s^{k−1}/(k−1)! ds (M.
//! Hochbruck & A. Ostermann, Exponential integrators, Acta Numerica 19, 2010). The linear part is exact at any step
//! size; the only error is the interpolation of the force.

use nalgebra::Complex;

/// Coefficients of the Lagrange quadratics through 0, 1/2 and 1, by powers of the variable.
const QUADRATICS: [[f64; 3]; 3] = [[1.0, -3.0, 2.0], [0.0, 4.0, -4.0], [0.0, -1.0, 2.0]];

/// Limits of |y|² below which φ_k is summed as a power series, with the number of terms needed.
const SUMMED: [(f64, i32); 4] = [(1e-2, 9), (0.09, 12), (0.25, 14), (1.0, 18)];

/// Returns φ₁, φ₂, φ₃ of y.
pub fn phi(y: Complex<f64>) -> [Complex<f64>; 3] {
    let size = y.norm_sqr();
    if let Some((_, terms)) = SUMMED.iter().find(|(limit, _)| size < *limit) {
        // Sums φ₃ = Σ y^m/(m+3)! and applies φ_k = y φ_{k+1} + 1/k!, which avoids the cancellation of the closed forms.
        let mut third = Complex::new(0.0, 0.0);
        for m in (0..*terms).rev() {
            third = (third * y + 1.0) * INVERSE[m as usize];
        }
        let third = third * 0.5;
        let second = y * third + 0.5;
        return [y * second + 1.0, second, third];
    }
    let inverse = y.inv();
    let first = (y.exp() - 1.0) * inverse;
    let second = (first - 1.0) * inverse;
    [first, second, (second - 0.5) * inverse]
}

/// Factors 1/(m + 3) of the power series.
const INVERSE: [f64; 18] = {
    let mut inverse = [0.0; 18];
    let mut m = 0;
    while m < 18 {
        inverse[m] = 1.0 / (m + 3) as f64;
        m += 1;
    }
    inverse
};

/// Returns φ_k of 2y from φ_k of y, without division (N. J. Higham, Functions of Matrices, 2008, section 10.7.4).
pub fn doubled([first, second, third]: [Complex<f64>; 3], y: Complex<f64>) -> [Complex<f64>; 3] {
    [
        first * (y * first * 0.5 + 1.0),
        (first * first + second * 2.0) * 0.25,
        (first * second + third * 2.0 + second) * 0.125,
    ]
}

/// Returns φ_k of 3y from φ_k of y (`of_one`) and of 2y (`of_two`).
pub fn tripled(of_one: [Complex<f64>; 3], of_two: [Complex<f64>; 3], y: Complex<f64>) -> [Complex<f64>; 3] {
    // ψ_k(t) = t^k φ_k(ty) satisfies ψ_k(s + t) = e^{ty} ψ_k(s) + Σ_{j=1}^k ψ_j(t) s^{k−j}/(k−j)!. Here s = 1 and
    // t = 2.
    let [first, second, third] = of_two;
    let growth = y * first * 2.0 + 1.0;
    [
        (growth * of_one[0] + first * 2.0) * (1.0 / 3.0),
        (growth * of_one[1] + second * 4.0 + first * 2.0) * (1.0 / 9.0),
        (growth * of_one[2] + third * 8.0 + second * 4.0 + first) * (1.0 / 27.0),
    ]
}

/// Returns w_0, w_1, w_2 at the fraction τ of the step, from φ_k(τy) with y = λh.
pub fn weights(phi: [Complex<f64>; 3], tau: f64) -> [Complex<f64>; 3] {
    let powers = [phi[0] * tau, phi[1] * (tau * tau), phi[2] * (2.0 * tau * tau * tau)];
    QUADRATICS.map(|c| powers[0] * c[0] + powers[1] * c[1] + powers[2] * c[2])
}

/// Integrals ∫₀^τ and double integrals ∫₀^τ∫ of the three quadratics. They are the weights of the force values in the
/// velocity and the displacement of a free mass.
pub fn free_weights(tau: f64) -> ([f64; 3], [f64; 3]) {
    let (t2, t3, t4) = (tau * tau, tau.powi(3), tau.powi(4));
    (
        QUADRATICS.map(|c| c[0] * tau + c[1] * t2 / 2.0 + c[2] * t3 / 3.0),
        QUADRATICS.map(|c| c[0] * t2 / 2.0 + c[1] * t3 / 6.0 + c[2] * t4 / 12.0),
    )
}

/// Value at τ of the quadratic through three values.
pub fn quadratic(values: [f64; 3], tau: f64) -> f64 {
    let [a, b, c] = values;
    a + tau * (4.0 * b - 3.0 * a - c + tau * (2.0 * a - 4.0 * b + 2.0 * c))
}

/// Derivatives at five equidistant points of the quartic through the values there; `length` is the distance from the
/// first point to the last.
pub fn slopes(values: [f64; 5], length: f64) -> [f64; 5] {
    SLOPES.map(|row| (0..5).map(|k| row[k] * values[k]).sum::<f64>() / (3.0 * length))
}

/// Twelve times the derivatives of the Lagrange quartics through 0 to 4: one row for each point.
pub const SLOPES: [[f64; 5]; 5] = [
    [-25.0, 48.0, -36.0, 16.0, -3.0],
    [-3.0, -10.0, 18.0, -6.0, 1.0],
    [1.0, -8.0, 0.0, 8.0, -1.0],
    [-1.0, 6.0, -18.0, 10.0, 3.0],
    [3.0, -16.0, 36.0, -48.0, 25.0],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares both branches with Simpson's rule on the definition of φ_k: where the branches meet and far along the
    /// imaginary axis.
    #[test]
    fn phi_is_its_integral() {
        for y in [(0.0, 0.0), (0.3, -0.4), (0.0, 0.9999), (0.0, 1.0001), (-2.0, 3.0), (0.0, 20.0)] {
            let y = Complex::new(y.0, y.1);
            let n = 4000;
            for (k, value) in phi(y).into_iter().enumerate() {
                let at = |i: usize| {
                    let s = i as f64 / n as f64;
                    (y * (1.0 - s)).exp() * s.powi(k as i32) / if k == 2 { 2.0 } else { 1.0 }
                };
                let sum: Complex<f64> = (0..n).step_by(2).map(|i| at(i) + at(i + 1) * 4.0 + at(i + 2)).sum();
                // Error of Simpson's rule: |y|⁴/(180 n⁴).
                assert!(
                    (sum / (3.0 * n as f64) - value).norm() < 1e-13 + y.norm().powi(4) / 180.0 / (n as f64).powi(4),
                    "{y} {k}"
                );
            }
        }
    }

    /// The slopes of x⁴ − 2x³ + 3x − 1 are exact to rounding.
    #[test]
    fn slopes_are_those_of_a_quartic() {
        let length = 0.8;
        let at = |k: usize| 0.25 * length * k as f64;
        let found = slopes([0, 1, 2, 3, 4].map(|k| at(k).powi(4) - 2.0 * at(k).powi(3) + 3.0 * at(k) - 1.0), length);
        for (k, slope) in found.into_iter().enumerate() {
            assert!((slope - (4.0 * at(k).powi(3) - 6.0 * at(k).powi(2) + 3.0)).abs() < 1e-13, "{k}: {slope}");
        }
    }

    #[test]
    fn doubling_and_tripling_are_the_same_function() {
        for y in [(0.0, 0.3), (0.0, 1.7), (-1.0, 2.0), (-30.0, 0.0), (-0.4, 0.0)] {
            let y = Complex::new(y.0, y.1);
            let two = doubled(phi(y), y);
            let pairs = two.into_iter().zip(phi(y * 2.0)).chain(tripled(phi(y), two, y).into_iter().zip(phi(y * 3.0)));
            for (one, other) in pairs {
                // Rounding of numbers of order one: the closed form divides by |2y| ≥ 0.6 three times.
                assert!((one - other).norm() < 1e-14, "{y} {one} {other}");
            }
        }
    }

    /// A mode under F = t² has the closed solution z = −(t² + 2t/λ + 2/λ²)/λ + (2/λ³) e^{λt}.
    #[test]
    fn a_quadratic_force_is_followed_exactly() {
        let lambda = Complex::new(-3.0, 40.0);
        let h = 0.2;
        for tau in [0.25, 0.5, 1.0] {
            let w = weights(phi(lambda * h * tau), tau);
            let force = [0.0, 0.25 * h * h, h * h];
            let z: Complex<f64> = (0..3).map(|j| w[j] * force[j] * h).sum();
            let t = tau * h;
            let inverse = lambda.inv();
            let exact = (lambda * t).exp() * inverse.powi(3) * 2.0
                - inverse * (inverse * (2.0 * t) + inverse * inverse * 2.0 + t * t);
            // Rounding of terms of size h²/|λ|.
            assert!((z - exact).norm() < 1e-15, "{z} {exact}");
            let (velocity, way) = free_weights(tau);
            let sum = |w: [f64; 3]| (0..3).map(|j| w[j] * force[j]).sum::<f64>();
            assert!((h * sum(velocity) - t.powi(3) / 3.0).abs() < 1e-17);
            assert!((h * h * sum(way) - t.powi(4) / 12.0).abs() < 1e-17);
            assert!((quadratic(force, tau) - t * t).abs() < 1e-17);
        }
    }
}
