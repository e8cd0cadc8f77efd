//! The real part of a complex matrix's product with a vector.

use nalgebra::{Complex, DMatrix, DVector};

/// Number of columns whose products are added at a time.
const SIDE_BY_SIDE: usize = 4;

/// Returns Re(A z). A must have as many columns as z has entries.
pub(crate) fn real_parts(matrix: &DMatrix<Complex<f64>>, z: &[Complex<f64>]) -> DVector<f64> {
    debug_assert_eq!(matrix.ncols(), z.len());
    let mut parts = DVector::zeros(matrix.nrows());
    if !parts.is_empty() {
        // Compiled for the SIMD instructions of each kind of processor.
        pulp::Arch::new().dispatch(|| add(matrix.as_slice(), z, parts.as_mut_slice()));
    }
    parts
}

/// Adds Re(A z) to `parts`.
#[inline(always)]
fn add(matrix: &[Complex<f64>], z: &[Complex<f64>], parts: &mut [f64]) {
    let rows = parts.len();
    let product = |entry: &Complex<f64>, z: &Complex<f64>| entry.re * z.re - entry.im * z.im;
    let columns = matrix.chunks(SIDE_BY_SIDE * rows);
    for (columns, z) in columns.zip(z.chunks(SIDE_BY_SIDE)) {
        if let [first, second, third, fourth] = z {
            let (head, tail) = columns.split_at(2 * rows);
            let [(a, b), (c, d)] = [head, tail].map(|two| two.split_at(rows));
            for (i, part) in parts.iter_mut().enumerate() {
                *part +=
                    product(&a[i], first) + product(&b[i], second) + product(&c[i], third) + product(&d[i], fourth);
            }
        } else {
            for (column, z) in columns.chunks(rows).zip(z) {
                parts.iter_mut().zip(column).for_each(|(part, entry)| *part += product(entry, z));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The result is the real part of the complex product, up to rounding of sums in another order.
    #[test]
    fn real_parts_of_products() {
        for columns in 0..10 {
            let matrix =
                DMatrix::from_fn(5, columns, |i, j| Complex::new((i + 2 * j) as f64, (3 * i) as f64 - j as f64));
            let z = DVector::from_fn(columns, |j, _| Complex::new(0.3 * j as f64 - 1.0, 0.7 + j as f64));
            let exact = (&matrix * &z).map(|entry| entry.re);
            assert!((real_parts(&matrix, z.as_slice()) - exact).amax() < 1e-12, "{columns}");
        }
    }
}
