//! Products of a sparse matrix of one process with some vectors at a time.

use std::ops::Range;

use nalgebra_sparse::CsrMatrix;

use super::columns::Columns;

/// Columns that a sparse matrix is multiplied with at a time: the numbers of a row of them fill a line of a cache.
const PANEL: usize = 8;

/// Sums of a product with one column that are made side by side, so that no addition waits for the last one.
const SUMS: usize = 4;

/// A product with several columns: compiled for the vectors of each kind of processor.
struct Multiplying<'a> {
    matrix: &'a CsrMatrix<f64>,
    columns: &'a Columns,
    product: &'a mut Columns,
}

impl pulp::NullaryFnOnce for Multiplying<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { matrix, columns, product } = self;
        // Numbers of one row side by side, so that each entry of the matrix is read once for all columns of a panel.
        let mut panel = vec![[0.0; PANEL]; columns.rows()];
        for begin in (0..columns.count()).step_by(PANEL) {
            let end = columns.count().min(begin + PANEL);
            for (k, number) in (begin..end).enumerate() {
                panel.iter_mut().zip(columns.get(number)).for_each(|(row, entry)| row[k] = *entry);
            }
            for (i, ends) in matrix.row_offsets().windows(2).enumerate().filter(|(_, ends)| ends[0] < ends[1]) {
                let sums = row_times(matrix, ends[0]..ends[1], &panel);
                (begin..end).for_each(|number| product.get_mut(number)[i] = sums[number - begin]);
            }
        }
    }
}

#[inline(always)]
fn row_times(matrix: &CsrMatrix<f64>, range: Range<usize>, panel: &[[f64; PANEL]]) -> [f64; PANEL] {
    let mut sums = [0.0; PANEL];
    for (column, value) in matrix.col_indices()[range.clone()].iter().zip(&matrix.values()[range]) {
        let row = &panel[*column];
        (0..PANEL).for_each(|k| sums[k] += value * row[k]);
    }
    sums
}

/// A X.
pub fn multiply(matrix: &CsrMatrix<f64>, columns: &Columns) -> Columns {
    if columns.count() == 1 {
        return columns.one(multiply_one(matrix, columns.get(0)));
    }
    let mut product = columns.zeros(columns.count());
    pulp::Arch::new().dispatch(Multiplying { matrix, columns, product: &mut product });
    product
}

fn multiply_one(matrix: &CsrMatrix<f64>, vector: &[f64]) -> Vec<f64> {
    let product = |ends: &[usize]| {
        let (columns, values) = (&matrix.col_indices()[ends[0]..ends[1]], &matrix.values()[ends[0]..ends[1]]);
        let (columns, values) = (columns.chunks_exact(SUMS), values.chunks_exact(SUMS));
        let rest = columns.remainder().iter().zip(values.remainder());
        let rest: f64 = rest.map(|(column, value)| value * vector[*column]).sum();
        let mut sums = [0.0; SUMS];
        for (columns, values) in columns.zip(values) {
            (0..SUMS).for_each(|k| sums[k] += values[k] * vector[columns[k]]);
        }
        sums.iter().sum::<f64>() + rest
    };
    matrix.row_offsets().windows(2).map(product).collect()
}
