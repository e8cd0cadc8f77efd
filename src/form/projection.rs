//! Projection onto quadratic splines along a line, for the change of volume of nearly incompressible bodies.

use nalgebra::{DMatrix, DVector};

use super::Spline;

/// Degree of the splines onto which functions are projected.
const DEGREE: usize = 2;

/// Projection Πf = Σ_ij b_i S_ij ∫ b_j f onto quadratic splines b with the lines of other splines.
///
/// S is the approximate dual of smallest support (C. K. Chui, W. He & J. Stöckler, Nonstationary tight wavelet frames,
/// I: Bounded intervals, Appl. Comput. Harmon. Anal. 17, 2004). Like the inverse of ∫ b_i b_j, it is symmetric and
/// positive definite and leaves quadratic functions unchanged, so that ∫ f Πg differs from ∫ f g by O(h⁶). But it is a
/// band matrix, so that distant functions stay uncoupled.
#[derive(Debug, Clone)]
pub struct Projection {
    target: Spline,
    dual: DMatrix<f64>,
}

impl Projection {
    /// Projection of functions of `spline`.
    pub fn new(spline: &Spline) -> Self {
        let target = Spline::new(spline.breaks(), DEGREE, DEGREE - 1);
        let dual = approximate_dual(&target);
        Self { target, dual }
    }

    /// Coefficients of the projections of a derivative of the functions of a spline on the same line: one column for each
    /// function.
    pub fn coefficients(&self, spline: &Spline, derivative: usize) -> DMatrix<f64> {
        &self.dual * self.target.products(0, spline, derivative)
    }

    /// Integrals of f Πg, with a derivative of the functions of one spline as f (rows) and of another as g (columns).
    pub fn products(&self, (f, of_f): (&Spline, usize), (g, of_g): (&Spline, usize)) -> DMatrix<f64> {
        self.target.products(0, f, of_f).tr_mul(&self.coefficients(g, of_g))
    }

    /// Values at `x` of functions that are given by their `coefficients`.
    pub fn values(&self, x: f64, coefficients: &DMatrix<f64>) -> DVector<f64> {
        coefficients.tr_mul(&self.target.values(x, 0))
    }
}

/// S = Σ Dₖᵀ diag(uₖ) Dₖ for k = 0, 1, 2. The rows of Dₖ take moments ∫ b_j f to means of the k-th derivative of f, so that
/// they vanish for polynomials of lower degree. The weights uₖ follow one by one, since S is exact for xᵏ.
fn approximate_dual(target: &Spline) -> DMatrix<f64> {
    let (n, mass) = (target.functions(), target.products(0, target, 0));
    let (from, to) = (target.breaks()[0], target.breaks()[target.breaks().len() - 1]);
    let factor = mass.clone().cholesky().expect("splines are independent");
    let (mut dual, mut differences) = (DMatrix::zeros(n, n), DMatrix::identity(n, n));
    for k in 0..=DEGREE {
        let moments = target.moments(|x| ((2.0 * x - from - to) / (to - from)).powi(k as i32));
        let scales = &differences * &moments;
        differences.row_iter_mut().zip(scales.iter()).for_each(|(mut row, scale)| row /= *scale);
        let defect = factor.solve(&moments) - &dual * &moments;
        let triangle = differences.columns(0, n - k).transpose();
        let weights = triangle.solve_lower_triangular(&defect.rows(0, n - k)).expect("no difference is empty");
        dual += differences.transpose() * DMatrix::from_diagonal(&weights) * &differences;
        differences = differences.rows(1, n - k - 1) - differences.rows(0, n - k - 1);
    }
    dual
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quadratic functions are unchanged, where cells have any sizes and lines are repeated. The eigenvalues of the
    /// projection are positive, so that no change of volume is free, and at most 1. S is a band matrix.
    #[test]
    fn projections_are_of_quadratics() {
        let graded: Vec<f64> = (0..30).map(|i| 1.3_f64.powi(i)).collect();
        for lines in [vec![-1.0, 2.0], vec![0.0, 0.01, 0.02, 0.1, 0.3, 0.3, 1.0, 4.0], graded] {
            let spline = Spline::new(&lines, 4, 3);
            let projection = Projection::new(&spline);
            let n = projection.target.functions();
            let own = projection.coefficients(&projection.target, 0);
            let values = own.complex_eigenvalues();
            assert!(values.iter().all(|value| value.re > 0.3 && value.re < 1.0 + 1e-9 && value.im.abs() < 1e-9));
            let is_beyond = |i: usize, j: usize| i.abs_diff(j) > DEGREE;
            assert!(
                (0..n * n).map(|k| (k / n, k % n)).all(|(i, j)| !is_beyond(i, j) || projection.dual[(i, j)] == 0.0)
            );
            let (mass, end) =
                (spline.products(0, &spline, 0).cholesky().expect("a mass matrix"), lines[lines.len() - 1]);
            for k in 0..=2 {
                let power = mass.solve(&spline.moments(|x| x.powi(k)));
                for x in (0..=20).map(|i| lines[0] + (end - lines[0]) * f64::from(i) / 20.0) {
                    let found = projection.values(x, &projection.coefficients(&spline, 0)).dot(&power);
                    // Rounding of the coefficients of the power.
                    assert!((found - x.powi(k)).abs() < 1e-10 * end.powi(k), "{k} {x}: {found}");
                }
            }
        }
    }
}
