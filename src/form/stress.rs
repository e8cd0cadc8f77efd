//! Stresses at a point, as six components xx, yy, zz, yz, xz, xy; shear strains are γ = 2ε.

use nalgebra::Matrix3;

use super::{Lame, Material};

/// Index of component (i, j) of a symmetric tensor among the six components.
pub fn place(i: usize, j: usize) -> usize {
    if i == j { i } else { 6 - i - j }
}

/// Returns the principal values of a stress, the largest first; tension is positive.
pub fn principal([xx, yy, zz, yz, xz, xy]: [f64; 6]) -> [f64; 3] {
    let mut values: [f64; 3] = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz).symmetric_eigenvalues().into();
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// Returns the largest principal value of a stress.
///
/// Uses the trigonometric solution of the characteristic equation (O. K. Smith, Commun. ACM 4, 1961). Its error is
/// about 1e-8 of the stress where two principal values coincide, which is enough for a maximum. It takes a tenth of the
/// time of an eigenvalue solver.
pub fn largest_principal([xx, yy, zz, yz, xz, xy]: [f64; 6]) -> f64 {
    let mean = (xx + yy + zz) / 3.0;
    let (a, b, c) = (xx - mean, yy - mean, zz - mean);
    let shear = yz * yz + xz * xz + xy * xy;
    let size = ((a * a + b * b + c * c + 2.0 * shear) / 6.0).sqrt();
    if size == 0.0 {
        return mean;
    }
    let determinant = a * (b * c - yz * yz) - xy * (xy * c - yz * xz) + xz * (xy * yz - b * xz);
    let angle = (0.5 * determinant / size.powi(3)).clamp(-1.0, 1.0).acos() / 3.0;
    mean + 2.0 * size * angle.cos()
}

/// Returns the larger principal value of a plane stress with the components a, b and ab.
pub fn largest_in_plane([a, b, ab]: [f64; 3]) -> f64 {
    0.5 * (a + b) + (0.25 * (a - b) * (a - b) + ab * ab).sqrt()
}

/// Returns the largest principal value of a stress with the in-plane components a, b, ab and the transverse components
/// az, bz, zz.
pub fn with_shear([a, b, ab]: [f64; 3], [az, bz, zz]: [f64; 3]) -> f64 {
    largest_principal([a, b, zz, bz, az, ab])
}

impl Material {
    /// Hooke's law (4) as a matrix, Pa: one row for each stress, one column for each ∂u_i/∂x_j (column 3i + j).
    pub fn stress_of_gradient(&self) -> [[f64; 9]; 6] {
        let Lame { lambda, mu } = self.lame();
        let mut rows = [[0.; 9]; 6];
        for i in 0..3 {
            for j in 0..3 {
                rows[i][4 * j] += lambda;
                // σ_ij = λ δ_ij div u + μ (∂u_i/∂x_j + ∂u_j/∂x_i). For i ≠ j the loop visits both terms; for i = j they
                // are equal.
                rows[place(i, j)][3 * i + j] += if i == j { 2. * mu } else { mu };
            }
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_values_are_known() {
        // A plane stress, rotated by 30° about z and then by 50° about x.
        let (a, b) = (30_f64.to_radians(), 50_f64.to_radians());
        let z = Matrix3::new(a.cos(), -a.sin(), 0., a.sin(), a.cos(), 0., 0., 0., 1.);
        let x = Matrix3::new(1., 0., 0., 0., b.cos(), -b.sin(), 0., b.sin(), b.cos());
        let turn = x * z;
        let s = turn * Matrix3::from_diagonal(&[40., -7., 3.].into()) * turn.transpose();
        let found = principal([s[(0, 0)], s[(1, 1)], s[(2, 2)], s[(1, 2)], s[(0, 2)], s[(0, 1)]]);
        // Rounding of a few products.
        assert!(found.iter().zip([40., 3., -7.]).all(|(a, b)| (a - b).abs() < 1e-13), "{found:?}");
        let largest = largest_principal([s[(0, 0)], s[(1, 1)], s[(2, 2)], s[(1, 2)], s[(0, 2)], s[(0, 1)]]);
        assert!((largest - 40.0).abs() < 1e-12, "{largest}");
        // Two equal principal values, and three.
        assert!((largest_principal([5., 5., 1., 0., 0., 0.]) - 5.0).abs() < 1e-7);
        assert_eq!(largest_principal([3., 3., 3., 0., 0., 0.]), 3.0);
        // (a + b)/2 ± √(((a − b)/2)² + ab²)
        assert!((largest_in_plane([1., 7., 4.]) - 9.0).abs() < 1e-14);
    }

    /// A stretch with the lateral contraction ν causes uniaxial stress; a rotation causes none.
    #[test]
    fn hookes_law() {
        let material = Material { young: 70., poisson: 0.23, density: 1. };
        let rows = material.stress_of_gradient();
        let of = |gradient: [f64; 9]| rows.map(|row| row.iter().zip(gradient).map(|(a, g)| a * g).sum::<f64>());
        let stretched = of([-0.23, 0., 0., 0., 1., 0., 0., 0., -0.23]);
        let sheared = of([0., 0.5, 0., 1.5, 0., 0., 0., 0., 0.]);
        let turned = of([0., 1., -2., -1., 0., 3., 2., -3., 0.]);
        let near = |found: [f64; 6], exact: [f64; 6]| found.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-13);
        assert!(near(stretched, [0., 70., 0., 0., 0., 0.]), "{stretched:?}");
        assert!(near(sheared, [0., 0., 0., 0., 0., 2. * material.lame().mu]), "{sheared:?}");
        assert!(near(turned, [0.; 6]), "{turned:?}");
    }
}
