//! Products with a sparse matrix whose rows are runs of neighbouring columns, typical of splines on a grid.
//!
//! Entries are stored run by run, padded with zeros to full SIMD vectors. A product thus loads neighbouring values at
//! once and reads no column number for single entries.

use nalgebra_sparse::CsrMatrix;
use pulp::{Simd, WithSimd};

/// Number of entries multiplied at once (a lot): length of the widest SIMD vectors that this is compiled for.
const LANES: usize = 4;

/// Largest difference between the columns of neighbouring entries in one run; zeros fill the gap. The start of a run
/// costs as much as several lots. Measured on the matrices of a laminate: a gap of one lot takes 1.7 times the
/// instructions of a gap of four lots, and twelve lots take as many as four.
const GAP: usize = 4 * LANES;

/// Largest number of vectors multiplied at a time. The matrix entries are read once for all of them.
const MAX_VECTORS_AT_ONCE: usize = 8;

/// A run of neighbouring entries in a row.
struct Stretch {
    /// Column of the first entry.
    column: u32,
    /// Number of lots of [`LANES`] entries.
    lots: u32,
}

/// A square matrix in run format.
pub struct RunLengthMatrix {
    /// For each row, the end of its runs.
    ends: Vec<u32>,
    runs: Vec<Stretch>,
    /// Values of all runs, one run after the other.
    values: Vec<[f64; LANES]>,
}

impl RunLengthMatrix {
    /// Converts a matrix whose rows have their columns in ascending order.
    pub fn new(matrix: &CsrMatrix<f64>) -> Self {
        let mut all = Self { ends: Vec::with_capacity(matrix.nrows()), runs: Vec::new(), values: Vec::new() };
        all.values.reserve(matrix.nnz() / LANES + matrix.nnz() / (2 * LANES));
        for ends in matrix.row_offsets().windows(2) {
            let (columns, values) = (&matrix.col_indices()[ends[0]..ends[1]], &matrix.values()[ends[0]..ends[1]]);
            let mut begin = 0;
            while begin < columns.len() {
                let mut end = begin + 1;
                while end < columns.len() && columns[end] - columns[end - 1] <= GAP {
                    end += 1;
                }
                all.push(&columns[begin..end], &values[begin..end]);
                begin = end;
            }
            all.ends.push(all.runs.len() as u32);
        }
        all
    }

    fn push(&mut self, columns: &[usize], values: &[f64]) {
        let (first, start) = (columns[0], self.values.len());
        let lots = (columns[columns.len() - 1] - first) / LANES + 1;
        self.values.resize(start + lots, [0.0; LANES]);
        let places = self.values[start..].as_flattened_mut();
        columns.iter().zip(values).for_each(|(column, value)| places[column - first] = *value);
        self.runs.push(Stretch { column: first as u32, lots: lots as u32 });
    }

    /// Multiplies the matrix with columns, which are stored one after the other.
    pub fn multiply(&self, columns: &[f64]) -> Vec<f64> {
        let rows = self.ends.len();
        let mut product = vec![0.0; columns.len()];
        // Runs extend beyond the last column by less than one lot.
        let length = rows + LANES;
        let mut filled = vec![0.0; MAX_VECTORS_AT_ONCE.min(columns.len() / rows.max(1)) * length];
        let (mut columns, mut rest) = (columns, &mut product[..]);
        while !columns.is_empty() {
            let left = columns.len() / rows;
            let count = [MAX_VECTORS_AT_ONCE, 4, 2].into_iter().find(|count| *count <= left).unwrap_or(1);
            for (column, filled) in columns.chunks_exact(rows).take(count).zip(filled.chunks_exact_mut(length)) {
                filled[..rows].copy_from_slice(column);
            }
            let (product, after) = rest.split_at_mut(count * rows);
            pulp::Arch::new().dispatch(Multiplying { matrix: self, columns: &filled, product });
            (columns, rest) = (&columns[count * rows..], after);
        }
        product
    }

    #[inline(always)]
    fn multiply_some<S: Simd, const N: usize>(&self, simd: S, columns: &[f64], product: &mut [f64]) {
        const { assert!(LANES.is_multiple_of(S::F64_LANES), "wider vectors would leave out ends of runs") };
        let rows = self.ends.len();
        let columns: [&[f64]; N] = std::array::from_fn(|k| &columns[k * (rows + LANES)..(k + 1) * (rows + LANES)]);
        let (mut first_run, mut values) = (0, &self.values[..]);
        for (i, end) in self.ends.iter().enumerate() {
            let mut sums = [simd.splat_f64s(0.0); N];
            for run in &self.runs[first_run..*end as usize] {
                let (of_run, rest) = values.split_at(run.lots as usize);
                add_run(simd, of_run, columns.map(|column| &column[run.column as usize..]), &mut sums);
                values = rest;
            }
            sums.iter().enumerate().for_each(|(k, sum)| product[k * rows + i] = simd.reduce_sum_f64s(*sum));
            first_run = *end as usize;
        }
    }
}

/// Adds the products of a run with the entries of columns, which start at the first column of the run.
#[inline(always)]
fn add_run<S: Simd, const N: usize>(simd: S, run: &[[f64; LANES]], columns: [&[f64]; N], sums: &mut [S::f64s; N]) {
    // (The length of a SIMD vector divides the length of a lot.)
    let run = S::as_simd_f64s(run.as_flattened()).0;
    let columns = columns.map(|column| &S::as_simd_f64s(column).0[..run.len()]);
    if let ([sum], [column]) = (&mut sums[..], &columns[..]) {
        // Two separate sums, so that additions wait less for the previous result.
        let mut other = simd.splat_f64s(0.0);
        let (pairs, last) = run.as_chunks::<2>();
        let (of_pairs, of_last) = column.as_chunks::<2>();
        for ([a, b], [x, y]) in pairs.iter().zip(of_pairs) {
            *sum = simd.mul_add_e_f64s(*a, *x, *sum);
            other = simd.mul_add_e_f64s(*b, *y, other);
        }
        for (a, x) in last.iter().zip(of_last) {
            *sum = simd.mul_add_e_f64s(*a, *x, *sum);
        }
        *sum = simd.add_f64s(*sum, other);
        return;
    }
    for (number, entries) in run.iter().enumerate() {
        for (sum, column) in sums.iter_mut().zip(&columns) {
            *sum = simd.mul_add_e_f64s(*entries, column[number], *sum);
        }
    }
}

/// Product with some columns, compiled for the SIMD instructions of each kind of processor.
struct Multiplying<'a> {
    matrix: &'a RunLengthMatrix,
    /// Columns with padding after each.
    columns: &'a [f64],
    product: &'a mut [f64],
}

impl WithSimd for Multiplying<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { matrix, columns, product } = self;
        match product.len() / matrix.ends.len().max(1) {
            1 => matrix.multiply_some::<S, 1>(simd, columns, product),
            2 => matrix.multiply_some::<S, 2>(simd, columns, product),
            4 => matrix.multiply_some::<S, 4>(simd, columns, product),
            _ => matrix.multiply_some::<S, MAX_VECTORS_AT_ONCE>(simd, columns, product),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows without entries, short and long gaps, and numbers of columns below and above `MAX_VECTORS_AT_ONCE`.
    #[test]
    fn products_are_those_of_the_entries() {
        const ROWS: usize = 23;
        let is_there =
            |i: usize, j: usize| i % 7 != 3 && (i + 2 * j) % 5 < 3 && (!(6..=15).contains(&j) || i.is_multiple_of(2));
        let value = |i: usize, j: usize| ((3 * i + 7 * j) % 11) as f64 - 4.5;
        let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for i in 0..ROWS {
            for j in (0..ROWS).filter(|j| is_there(i, *j)) {
                columns.push(j);
                values.push(value(i, j));
            }
            offsets.push(columns.len());
        }
        let matrix = CsrMatrix::try_from_csr_data(ROWS, ROWS, offsets, columns, values).expect("a matrix");
        let runs = RunLengthMatrix::new(&matrix);
        for count in [0, 1, 2, 3, 7, 17] {
            let x: Vec<f64> = (0..count * ROWS).map(|number| (number % 13) as f64 - 6.25).collect();
            let found = runs.multiply(&x);
            for (k, i) in (0..count).flat_map(|k| (0..ROWS).map(move |i| (k, i))) {
                let exact: f64 = (0..ROWS).filter(|j| is_there(i, *j)).map(|j| value(i, j) * x[k * ROWS + j]).sum();
                assert_eq!(found[k * ROWS + i], exact, "column {k}, row {i}");
            }
        }
    }
}
