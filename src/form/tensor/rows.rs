//! Symmetric sparse matrices assembled from their upper triangle.

use nalgebra_sparse::CsrMatrix;

/// Upper triangle of a symmetric matrix, row by row, with ascending columns.
pub struct Rows {
    /// End of each row in `columns` and `values`.
    pub ends: Vec<usize>,
    /// Column of each entry.
    pub columns: Vec<usize>,
    /// Value of each entry.
    pub values: Vec<f64>,
}

impl Rows {
    /// No rows yet, with reserved capacity.
    pub fn with_capacity(rows: usize, entries: usize) -> Self {
        Self {
            ends: Vec::with_capacity(rows),
            columns: Vec::with_capacity(entries),
            values: Vec::with_capacity(entries),
        }
    }

    /// Returns the full matrix, with the lower triangle added.
    pub fn mirrored(self) -> CsrMatrix<f64> {
        let Self { ends, columns, values } = self;
        let count = ends.len();
        let row = |i: usize| if i == 0 { 0..ends[0] } else { ends[i - 1]..ends[i] };
        let right_of_diagonal = |i: usize| {
            let row = row(i);
            let has_diagonal = columns[row.clone()].first() == Some(&i);
            row.start + usize::from(has_diagonal)..row.end
        };
        let mut offsets = vec![0; count + 1];
        for i in 0..count {
            offsets[i + 1] += row(i).len();
            columns[right_of_diagonal(i)].iter().for_each(|j| offsets[j + 1] += 1);
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
            let place = next[i]..next[i] + row(i).len();
            all_columns[place.clone()].copy_from_slice(&columns[row(i)]);
            all_values[place].copy_from_slice(&values[row(i)]);
            let right = right_of_diagonal(i);
            for (&j, &value) in columns[right.clone()].iter().zip(&values[right]) {
                let below = &mut next[j];
                (all_columns[*below], all_values[*below]) = (i, value);
                *below += 1;
            }
        }
        CsrMatrix::try_from_csr_data(count, count, offsets, all_columns, all_values)
            .expect("rows in order, columns ascending")
    }
}
