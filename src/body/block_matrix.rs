//! A complex matrix stored in blocks, one for each class of coupled modes.

use nalgebra::allocator::Allocator;
use nalgebra::{Complex, DMatrix, DVector, DefaultAllocator, Dim, Dyn, OMatrix};

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
    /// [Re A, −Im A] of these rows and columns: Re(A z) = [Re A, −Im A] [Re z; Im z].
    parts: DMatrix<f64>,
}

impl Block {
    /// Creates a block from its entries.
    pub fn new(rows: Vec<usize>, columns: Vec<usize>, entries: &DMatrix<Complex<f64>>) -> Self {
        let mut parts = DMatrix::zeros(rows.len(), 2 * columns.len());
        parts.columns_mut(0, columns.len()).copy_from(&entries.map(|entry| entry.re));
        parts.columns_mut(columns.len(), columns.len()).copy_from(&entries.map(|entry| -entry.im));
        Self { rows, columns, parts }
    }
}

impl BlockMatrix {
    /// Creates a matrix of a given shape from its blocks.
    pub fn new([rows, columns]: [usize; 2], blocks: Vec<Block>) -> Self {
        Self { rows, columns, blocks }
    }

    /// Returns the matrix, extended by zero columns to a number of columns.
    pub fn with_columns(self, columns: usize) -> Self {
        Self { columns, ..self }
    }

    /// Returns Re(A z).
    pub fn real_parts(&self, z: &[Complex<f64>]) -> DVector<f64> {
        self.real_parts_of(&[z]).column(0).into_owned()
    }

    /// Returns Re(A z) for several z, one column for each. This takes less time than one z after the other.
    pub fn real_parts_of(&self, several: &[&[Complex<f64>]]) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.rows, several.len());
        for Block { rows, columns, parts } in &self.blocks {
            let z = DMatrix::from_fn(2 * columns.len(), several.len(), |j, k| match j.checked_sub(columns.len()) {
                None => several[k][columns[j]].re,
                Some(j) => several[k][columns[j]].im,
            });
            let product = parts * z;
            rows.iter().enumerate().for_each(|(i, &row)| all.row_mut(row).copy_from(&product.row(i)));
        }
        all
    }

    /// Returns A x for a real x.
    pub fn times(&self, x: &DVector<f64>) -> Vec<Complex<f64>> {
        let mut product = vec![Complex::new(0.0, 0.0); self.rows];
        for Block { rows, columns, parts } in &self.blocks {
            let x = x.select_rows(columns);
            let [real, negative] = [0, columns.len()].map(|first| parts.columns(first, columns.len()) * &x);
            rows.iter().enumerate().for_each(|(i, &row)| product[row] = Complex::new(real[i], -negative[i]));
        }
        product
    }

    /// Returns R A for a real R.
    pub fn times_from_left(&self, r: &DMatrix<f64>) -> DMatrix<Complex<f64>> {
        let mut product = DMatrix::zeros(r.nrows(), self.columns);
        for Block { rows, columns, parts } in &self.blocks {
            let of_block = r.select_columns(rows) * parts;
            for (j, &column) in columns.iter().enumerate() {
                let (real, negative) = (of_block.column(j), of_block.column(columns.len() + j));
                product.set_column(column, &real.zip_map(&negative, |real, negative| Complex::new(real, -negative)));
            }
        }
        product
    }

    /// Returns all entries.
    pub fn dense(&self) -> DMatrix<Complex<f64>> {
        self.times_from_left(&DMatrix::identity(self.rows, self.rows))
    }
}

/// Returns A B for a real matrix A.
pub(super) fn real_times_complex<C: Dim>(
    a: &DMatrix<f64>,
    b: &OMatrix<Complex<f64>, Dyn, C>,
) -> OMatrix<Complex<f64>, Dyn, C>
where
    DefaultAllocator: Allocator<Dyn, C>,
{
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
        // Row 3 and column 4 belong to no block.
        let places = [(vec![0, 2, 5], vec![1, 3]), (vec![4, 1], vec![0, 2, 5, 6])];
        let mut dense = DMatrix::zeros(6, 7);
        let mut block = |(rows, columns): (Vec<usize>, Vec<usize>)| {
            let entries = entries(rows.len(), columns.len());
            for (i, &row) in rows.iter().enumerate() {
                columns.iter().enumerate().for_each(|(j, &column)| dense[(row, column)] = entries[(i, j)]);
            }
            Block::new(rows, columns, &entries)
        };
        let blocks = places.map(&mut block).to_vec();
        let matrix = BlockMatrix::new([6, 7], blocks);
        assert_eq!(matrix.dense(), dense);
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
