//! Symmetric sparse matrices assembled from their upper triangle.

use nalgebra_sparse::CsrMatrix;

/// Upper triangle of a symmetric matrix, row by row, with ascending columns.
#[derive(Default)]
pub struct Rows {
    /// End of each row in `columns` and `values`.
    pub ends: Vec<usize>,
    /// Column of each entry.
    pub columns: Vec<usize>,
    /// Value of each entry.
    pub values: Vec<f64>,
}

impl Rows {
    /// Returns the full matrix, with the lower triangle added.
    pub fn mirrored(self) -> CsrMatrix<f64> {
        let Self { ends, columns, values } = self;
        let count = ends.len();
        let row = |i: usize| if i == 0 { 0..ends[0] } else { ends[i - 1]..ends[i] };
        let mut offsets = vec![0; count + 1];
        for i in 0..count {
            offsets[i + 1] += row(i).len();
            columns[row(i)].iter().filter(|j| **j != i).for_each(|j| offsets[j + 1] += 1);
        }
        for i in 0..count {
            offsets[i + 1] += offsets[i];
        }
        let mut next = offsets[..count].to_vec();
        let total = offsets[count];
        let (mut all_columns, mut all_values) = (vec![0; total], vec![0.0; total]);
        // When row i is reached, its lower part is complete: the rows before it have filled it in ascending order of
        // columns.
        for i in 0..count {
            let (own, values) = (&columns[row(i)], &values[row(i)]);
            let place = next[i]..next[i] + own.len();
            all_columns[place.clone()].copy_from_slice(own);
            all_values[place].copy_from_slice(values);
            for (&j, &value) in own.iter().zip(values).skip_while(|(j, _)| **j == i) {
                (all_columns[next[j]], all_values[next[j]]) = (i, value);
                next[j] += 1;
            }
        }
        CsrMatrix::try_from_csr_data(count, count, offsets, all_columns, all_values)
            .expect("rows in order, columns ascending")
    }
}
