//! A complex matrix stored in blocks, one for each class of coupled modes.

use nalgebra::{Complex, DMatrix, DVector};

use super::real_parts::real_parts;

/// A complex matrix that is zero outside some blocks. No two blocks share a row or a column.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct BlockMatrix {
    rows: usize,
    columns: usize,
    blocks: Vec<Block>,
}

/// Entries of a [`BlockMatrix`] in some of its rows and columns.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Block {
    /// Row indices in the whole matrix.
    pub rows: Vec<usize>,
    /// Column indices in the whole matrix.
    pub columns: Vec<usize>,
    /// Entries in these rows and columns.
    pub entries: DMatrix<Complex<f64>>,
}

impl BlockMatrix {
    /// Creates a matrix of a given shape from its blocks.
    pub fn new([rows, columns]: [usize; 2], blocks: Vec<Block>) -> Self {
        Self { rows, columns, blocks }
    }

    /// Creates a matrix of one block.
    pub fn whole(entries: DMatrix<Complex<f64>>) -> Self {
        let (rows, columns) = entries.shape();
        Self::new([rows, columns], vec![Block { rows: (0..rows).collect(), columns: (0..columns).collect(), entries }])
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Returns the blocks as parts of a larger matrix, in which `rows` and `columns` are the numbers of this matrix's
    /// rows and columns.
    pub fn into_blocks_of<'a>(self, rows: &'a [usize], columns: &'a [usize]) -> impl Iterator<Item = Block> + 'a {
        let renumbered = |own: &[usize], numbers: &[usize]| own.iter().map(|&i| numbers[i]).collect();
        self.blocks.into_iter().map(move |block| Block {
            rows: renumbered(&block.rows, rows),
            columns: renumbered(&block.columns, columns),
            entries: block.entries,
        })
    }

    /// Returns the matrix, extended by zero columns to a number of columns.
    pub fn with_columns(self, columns: usize) -> Self {
        Self { columns, ..self }
    }

    /// Returns Re(A z).
    pub fn real_parts(&self, z: &[Complex<f64>]) -> DVector<f64> {
        let mut parts = DVector::zeros(self.rows);
        for Block { rows, columns, entries } in &self.blocks {
            let z: Vec<_> = columns.iter().map(|&column| z[column]).collect();
            rows.iter().zip(&real_parts(entries, &z)).for_each(|(&row, part)| parts[row] = *part);
        }
        parts
    }

    /// Returns Re(A z) for several z, one column for each. This takes less time than one z after the other.
    pub fn real_parts_of(&self, several: &[&[Complex<f64>]]) -> DMatrix<f64> {
        let mut parts = DMatrix::zeros(self.rows, several.len());
        for Block { rows, columns, entries } in &self.blocks {
            let own = columns.len();
            // Re(A z) = [Re A, −Im A] [Re z; Im z].
            let matrix = DMatrix::from_fn(rows.len(), 2 * own, |i, j| match j.checked_sub(own) {
                None => entries[(i, j)].re,
                Some(j) => -entries[(i, j)].im,
            });
            let z = DMatrix::from_fn(2 * own, several.len(), |j, k| match j.checked_sub(own) {
                None => several[k][columns[j]].re,
                Some(j) => several[k][columns[j]].im,
            });
            let product = matrix * z;
            for (i, &row) in rows.iter().enumerate() {
                parts.row_mut(row).copy_from(&product.row(i));
            }
        }
        parts
    }

    /// Returns A x for a real x.
    pub fn times(&self, x: &DVector<f64>) -> Vec<Complex<f64>> {
        let mut product = vec![Complex::new(0.0, 0.0); self.rows];
        for Block { rows, columns, entries } in &self.blocks {
            let x = x.select_rows(columns).map(|x| Complex::new(x, 0.0));
            rows.iter().zip(&(entries * x)).for_each(|(&row, entry)| product[row] = *entry);
        }
        product
    }

    /// Returns R A for a real R.
    pub fn times_from_left(&self, r: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
        let mut product = DMatrix::zeros(r.nrows(), self.columns);
        for Block { rows, columns, entries } in &self.blocks {
            let of_block = real_times_complex(&r.select_columns(rows), entries);
            columns.iter().enumerate().for_each(|(i, &column)| product.set_column(column, &of_block.column(i)));
        }
        product
    }

    /// Returns all entries.
    pub fn dense(&self) -> DMatrix<Complex<f64>> {
        self.times_from_left(&DMatrix::identity(self.rows, self.rows))
    }
}

/// Returns A B for a real matrix A.
pub(super) fn real_times_complex(a: &DMatrix<f64>, b: &DMatrix<Complex<f64>>) -> DMatrix<Complex<f64>> {
    let (real, imaginary) = (a * b.map(|entry| entry.re), a * b.map(|entry| entry.im));
    real.zip_map(&imaginary, Complex::new)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All products agree with those of the dense matrix, up to rounding of sums in another order.
    #[test]
    fn products_are_those_of_the_dense_matrix() {
        let entries = |rows, columns| {
            DMatrix::from_fn(rows, columns, |i, j| Complex::new((i + 2 * j + 1) as f64, (3 * i) as f64 - j as f64))
        };
        let block = |rows: &[usize], columns: &[usize]| Block {
            rows: rows.to_vec(),
            columns: columns.to_vec(),
            entries: entries(rows.len(), columns.len()),
        };
        // Row 3 and column 4 belong to no block.
        let matrix = BlockMatrix::new([6, 7], vec![block(&[0, 2, 5], &[1, 3]), block(&[4, 1], &[0, 2, 5, 6])]);
        let mut dense = DMatrix::zeros(6, 7);
        for Block { rows, columns, entries } in &matrix.blocks {
            for (i, &row) in rows.iter().enumerate() {
                columns.iter().enumerate().for_each(|(j, &column)| dense[(row, column)] = entries[(i, j)]);
            }
        }
        assert_eq!(matrix.dense(), dense);
        assert_eq!(BlockMatrix::whole(dense.clone()).dense(), dense);
        let z = DVector::from_fn(7, |j, _| Complex::new(0.3 * j as f64 - 1.0, 0.7 + j as f64));
        let product = (&dense * &z).map(|entry| entry.re);
        assert!((matrix.real_parts(z.as_slice()) - &product).amax() < 1e-12);
        let other = z.map(|z| z * 0.5 - 1.0);
        let both = matrix.real_parts_of(&[z.as_slice(), other.as_slice()]);
        assert!((both.column(0) - &product).amax() < 1e-12);
        assert!((both.column(1) - (&dense * &other).map(|entry| entry.re)).amax() < 1e-12);
        let x = z.map(|z| z.re);
        let product = &dense * x.map(|x| Complex::new(x, 0.0));
        assert!((DVector::from_vec(matrix.times(&x)) - product).camax() < 1e-12);
        let left = DMatrix::from_fn(2, 6, |i, j| i as f64 - 0.5 * j as f64);
        let product = left.map(|entry| Complex::new(entry, 0.0)) * &dense;
        assert!((matrix.times_from_left(&left) - product).camax() < 1e-12);
    }
}
