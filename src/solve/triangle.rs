//! Solution with a dense Cholesky factor, for one right-hand side at a time.
//!
//! Four columns are processed together: each number of the right-hand side is read and written once for four columns,
//! so that half of the instructions are multiplications.

use faer::MatRef;
use pulp::{Simd, WithSimd};

/// Number of columns processed together.
pub(super) const TOGETHER: usize = 4;

/// Factor L of A = L Lᵀ, stored by columns, each from its diagonal on.
pub struct DenseCholesky {
    count: usize,
    entries: Vec<f64>,
}

impl DenseCholesky {
    /// Copies a factor; its upper triangle is not read.
    pub fn new(factor: MatRef<'_, f64>) -> Self {
        let count = factor.ncols();
        let mut entries = Vec::with_capacity(count * (count + 1) / 2);
        for (j, column) in factor.col_iter().enumerate() {
            entries.extend(column.iter().skip(j));
        }
        Self { count, entries }
    }

    /// Computes x ← A⁻¹ x.
    pub fn solve_in_place(&self, x: &mut [f64]) {
        pulp::Arch::new().dispatch(Solving { factor: self, x });
    }

    /// Column `j` from its diagonal on.
    #[inline(always)]
    fn column(&self, j: usize) -> &[f64] {
        // The columns before it have count, count − 1, … entries.
        let start = j * self.count - j * j.saturating_sub(1) / 2;
        &self.entries[start..start + self.count - j]
    }

    /// Computes x ← L⁻¹ x.
    #[inline(always)]
    fn forward<S: Simd>(&self, simd: S, x: &mut [f64]) {
        let whole = self.count - self.count % TOGETHER;
        for j in (0..whole).step_by(TOGETHER) {
            let columns: [&[f64]; TOGETHER] = std::array::from_fn(|k| self.column(j + k));
            let mut found = [0.0; TOGETHER];
            for k in 0..TOGETHER {
                found[k] = (0..k).fold(x[j + k], |sum, i| sum - columns[i][k - i] * found[i]) / columns[k][0];
            }
            x[j..j + TOGETHER].copy_from_slice(&found);
            subtract(simd, &mut x[j + TOGETHER..], std::array::from_fn(|k| &columns[k][TOGETHER - k..]), found);
        }
        for j in whole..self.count {
            let column = self.column(j);
            let (first, below) = x[j..].split_first_mut().expect("a row of each column");
            *first /= column[0];
            below.iter_mut().zip(&column[1..]).for_each(|(x, entry)| *x -= entry * *first);
        }
    }

    /// Computes x ← L⁻ᵀ x.
    #[inline(always)]
    fn backward<S: Simd>(&self, simd: S, x: &mut [f64]) {
        let whole = self.count - self.count % TOGETHER;
        for j in (whole..self.count).rev() {
            let column = self.column(j);
            let sum: f64 = column[1..].iter().zip(&x[j + 1..]).map(|(entry, x)| entry * x).sum();
            x[j] = (x[j] - sum) / column[0];
        }
        for j in (0..whole).step_by(TOGETHER).rev() {
            let columns: [&[f64]; TOGETHER] = std::array::from_fn(|k| self.column(j + k));
            let sums = products(simd, std::array::from_fn(|k| &columns[k][TOGETHER - k..]), &x[j + TOGETHER..]);
            let mut found = [0.0; TOGETHER];
            for k in (0..TOGETHER).rev() {
                let others = (k + 1..TOGETHER).fold(sums[k], |sum, i| sum + columns[k][i - k] * found[i]);
                found[k] = (x[j + k] - others) / columns[k][0];
            }
            x[j..j + TOGETHER].copy_from_slice(&found);
        }
    }
}

/// Subtracts columns times numbers from a vector.
#[inline(always)]
pub(super) fn subtract<S: Simd>(simd: S, x: &mut [f64], columns: [&[f64]; TOGETHER], numbers: [f64; TOGETHER]) {
    let columns = columns.map(|column| &column[..x.len()]);
    let factors = numbers.map(|number| simd.splat_f64s(-number));
    let (lots, rest) = S::as_mut_simd_f64s(x);
    let of_lots = columns.map(|column| &S::as_simd_f64s(column).0[..lots.len()]);
    for (number, lot) in lots.iter_mut().enumerate() {
        for (column, factor) in of_lots.iter().zip(factors) {
            *lot = simd.mul_add_e_f64s(column[number], factor, *lot);
        }
    }
    let after = columns[0].len() - rest.len();
    for (i, entry) in rest.iter_mut().enumerate() {
        columns.iter().zip(numbers).for_each(|(column, number)| *entry -= column[after + i] * number);
    }
}

/// Computes the inner products of columns with a vector.
#[inline(always)]
pub(super) fn products<S: Simd>(simd: S, columns: [&[f64]; TOGETHER], x: &[f64]) -> [f64; TOGETHER] {
    let columns = columns.map(|column| &column[..x.len()]);
    let (lots, rest) = S::as_simd_f64s(x);
    let of_lots = columns.map(|column| &S::as_simd_f64s(column).0[..lots.len()]);
    let mut sums = [simd.splat_f64s(0.0); TOGETHER];
    for (number, lot) in lots.iter().enumerate() {
        for (sum, column) in sums.iter_mut().zip(&of_lots) {
            *sum = simd.mul_add_e_f64s(column[number], *lot, *sum);
        }
    }
    let after = x.len() - rest.len();
    std::array::from_fn(|k| {
        let of_rest: f64 = columns[k][after..].iter().zip(rest).map(|(entry, x)| entry * x).sum();
        simd.reduce_sum_f64s(sums[k]) + of_rest
    })
}

/// Forward and backward substitution, compiled for the vector instructions of each kind of processor.
struct Solving<'a> {
    factor: &'a DenseCholesky,
    x: &'a mut [f64],
}

impl WithSimd for Solving<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { factor, x } = self;
        factor.forward(simd, x);
        factor.backward(simd, x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::{Mat, Side};

    /// The solution of A x = b is recovered, for numbers of rows that are and are not multiples of [`TOGETHER`].
    #[test]
    fn solves_with_the_matrix() {
        for count in [1, 3, 4, 7, 8, 18, 33] {
            let entry = |i: usize, j: usize| {
                let (low, high) = (i.min(j), i.max(j));
                ((3 * low + 5 * high) % 7) as f64 - 3.0 + if i == j { 10.0 * count as f64 } else { 0.0 }
            };
            let matrix = Mat::from_fn(count, count, entry);
            let factor = matrix.llt(Side::Lower).expect("a positive definite matrix");
            let exact: Vec<f64> = (0..count).map(|i| (i as f64 * 0.7).sin() + 1.0).collect();
            let mut x: Vec<f64> = (0..count).map(|i| (0..count).map(|j| entry(i, j) * exact[j]).sum()).collect();
            DenseCholesky::new(factor.L()).solve_in_place(&mut x);
            // The condition number is below ten.
            x.iter().zip(&exact).for_each(|(x, exact)| assert!((x - exact).abs() < 1e-13, "{count}: {x} {exact}"));
        }
    }
}
