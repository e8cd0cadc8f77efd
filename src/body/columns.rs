//! Vectors of one length as the columns of a dense matrix, and products of a sparse matrix with some of them at a time.

use std::ops::Range;

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::DMatrix;
use petsc_wrap::{Int, Matrix, Row};

use crate::error::Result;

/// Columns that a sparse matrix is multiplied with at a time: the numbers of a row of them fill a line of a cache.
const PANEL: usize = 8;

/// Sums of a product with one column that are made side by side, so that no addition waits for the last one.
const SUMS: usize = 4;

/// Columns that are projected at a time.
const PROJECTED: usize = 64;

/// Vectors of a length, one after the other.
#[derive(Debug, Clone, Default)]
pub struct Columns {
    rows: usize,
    entries: Vec<f64>,
}

impl Columns {
    /// None yet, of a length.
    pub fn new(rows: usize) -> Self {
        Self { rows, entries: Vec::new() }
    }

    /// One.
    pub fn of(entries: Vec<f64>) -> Self {
        Self { rows: entries.len(), entries }
    }

    /// Some that are zero.
    pub fn zeros(rows: usize, count: usize) -> Self {
        Self { rows, entries: vec![0.0; rows * count] }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.entries.len() / self.rows.max(1)
    }

    /// One of them.
    pub fn get(&self, number: usize) -> &[f64] {
        &self.entries[number * self.rows..(number + 1) * self.rows]
    }

    /// One of them, to be changed.
    pub fn get_mut(&mut self, number: usize) -> &mut [f64] {
        &mut self.entries[number * self.rows..(number + 1) * self.rows]
    }

    /// Adds one.
    pub fn push(&mut self, column: &[f64]) {
        self.entries.extend_from_slice(column);
    }

    /// Adds all of others.
    pub fn append(&mut self, mut other: Self) {
        self.entries.append(&mut other.entries);
    }

    /// Some of them, from one to before another.
    pub fn range(&self, begin: usize, end: usize) -> Self {
        Self { rows: self.rows, entries: self.entries[begin * self.rows..end * self.rows].to_vec() }
    }

    /// As a dense matrix.
    pub fn matrix(&self) -> MatRef<'_, f64> {
        self.leading(self.count())
    }

    /// As a dense matrix, to be changed.
    pub fn matrix_mut(&mut self) -> MatMut<'_, f64> {
        let count = self.count();
        MatMut::from_column_major_slice_mut(&mut self.entries, self.rows, count)
    }

    fn leading(&self, count: usize) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.entries[..count * self.rows], self.rows, count)
    }

    /// firstᵀ other, of the first ones.
    pub fn leading_products(&self, count: usize, other: &Self) -> DMatrix<f64> {
        let mut products = DMatrix::zeros(count, other.count());
        let into = MatMut::from_column_major_slice_mut(products.as_mut_slice(), count, other.count());
        matmul(into, Accum::Replace, self.leading(count).transpose(), other.matrix(), 1.0, Par::Seq);
        products
    }

    /// selfᵀ other.
    pub fn products(&self, other: &Self) -> DMatrix<f64> {
        self.leading_products(self.count(), other)
    }

    /// self ← self − others · parts.
    pub fn subtract(&mut self, others: &Self, parts: &DMatrix<f64>) {
        let parts = MatRef::from_column_major_slice(parts.as_slice(), parts.nrows(), parts.ncols());
        matmul(self.matrix_mut(), Accum::Add, others.matrix(), parts, -1.0, Par::Seq);
    }

    /// Inner products with a vector, a row each.
    pub fn along(&self, vector: &[f64]) -> DMatrix<f64> {
        self.products(&Self::of(vector.to_vec()))
    }

    /// Divides all by a number.
    pub fn divide(&mut self, divisor: f64) {
        self.entries.iter_mut().for_each(|entry| *entry /= divisor);
    }

    /// Makes some rows zero.
    pub fn zero_rows(&mut self, rows: &[usize]) {
        for column in self.entries.chunks_exact_mut(self.rows.max(1)) {
            rows.iter().for_each(|row| column[*row] = 0.0);
        }
    }

    /// The columns times L⁻ᵀ of a lower triangle L.
    pub fn divide_by_triangle(&mut self, lower: &DMatrix<f64>) {
        for k in 0..self.count() {
            let (earlier, others) = self.entries.split_at_mut(k * self.rows);
            let column = &mut others[..self.rows];
            for (i, other) in earlier.chunks_exact(self.rows).enumerate() {
                let part = lower[(k, i)];
                column.iter_mut().zip(other).for_each(|(entry, other)| *entry -= part * other);
            }
            column.iter_mut().for_each(|entry| *entry /= lower[(k, k)]);
        }
    }
}

/// A product with several columns: compiled for the vectors of each kind of processor.
struct Multiplying<'a> {
    matrix: &'a SparseRows,
    columns: &'a Columns,
    product: &'a mut Columns,
}

impl pulp::NullaryFnOnce for Multiplying<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.matrix.multiply_into(self.columns, self.product);
    }
}

/// A sparse matrix by rows.
pub struct SparseRows {
    starts: Vec<usize>,
    columns: Vec<u32>,
    values: Vec<f64>,
}

impl SparseRows {
    /// A matrix of one rank.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(matrix: &Matrix, rows: usize) -> Result<Self> {
        let mut all = Self { starts: vec![0], columns: Vec::new(), values: Vec::new() };
        let mut row = Row::default();
        for i in 0..rows {
            matrix.row_into(i as Int, &mut row)?;
            let entries = row.columns.iter().zip(&row.values).filter(|(_, value)| **value != 0.0);
            for (column, value) in entries {
                all.columns.push(*column as u32);
                all.values.push(*value);
            }
            all.starts.push(all.values.len());
        }
        Ok(all)
    }

    /// A X.
    pub fn multiply(&self, columns: &Columns) -> Columns {
        let (rows, count) = (columns.rows, columns.count());
        if count == 1 {
            return Columns::of(self.multiply_one(columns.get(0)));
        }
        let mut product = Columns::zeros(rows, count);
        pulp::Arch::new().dispatch(Multiplying { matrix: self, columns, product: &mut product });
        product
    }

    #[inline(always)]
    fn multiply_into(&self, columns: &Columns, product: &mut Columns) {
        let (rows, count) = (columns.rows, columns.count());
        // Numbers of one row side by side, so that each entry of the matrix is read once for all columns of a panel.
        let mut panel = vec![[0.0; PANEL]; rows];
        for begin in (0..count).step_by(PANEL) {
            let end = count.min(begin + PANEL);
            for (k, number) in (begin..end).enumerate() {
                panel.iter_mut().zip(columns.get(number)).for_each(|(row, entry)| row[k] = *entry);
            }
            for (i, ends) in self.starts.windows(2).enumerate().filter(|(_, ends)| ends[0] < ends[1]) {
                let sums = self.row_times(ends[0]..ends[1], &panel);
                (begin..end).for_each(|number| product.entries[number * rows + i] = sums[number - begin]);
            }
        }
    }

    #[inline(always)]
    fn row_times(&self, range: Range<usize>, panel: &[[f64; PANEL]]) -> [f64; PANEL] {
        let mut sums = [0.0; PANEL];
        for (column, value) in self.columns[range.clone()].iter().zip(&self.values[range]) {
            let row = &panel[*column as usize];
            (0..PANEL).for_each(|k| sums[k] += value * row[k]);
        }
        sums
    }

    fn multiply_one(&self, vector: &[f64]) -> Vec<f64> {
        let product = |ends: &[usize]| {
            let (columns, values) = (&self.columns[ends[0]..ends[1]], &self.values[ends[0]..ends[1]]);
            let (columns, values) = (columns.chunks_exact(SUMS), values.chunks_exact(SUMS));
            let rest = columns.remainder().iter().zip(values.remainder());
            let rest: f64 = rest.map(|(column, value)| value * vector[*column as usize]).sum();
            let mut sums = [0.0; SUMS];
            for (columns, values) in columns.zip(values) {
                (0..SUMS).for_each(|k| sums[k] += values[k] * vector[columns[k] as usize]);
            }
            sums.iter().sum::<f64>() + rest
        };
        self.starts.windows(2).map(product).collect()
    }

    /// Vᵀ A V of a symmetric A; the first rows and columns are known.
    pub fn project(&self, vectors: &Columns, known: &DMatrix<f64>) -> DMatrix<f64> {
        let count = vectors.count();
        let mut gram = known.clone().resize(count, count, 0.0);
        // Of supports few rows have entries: the others are passed over.
        let is_filled = |row: &usize| self.starts[*row] < self.starts[row + 1];
        let rows: Vec<usize> = (0..vectors.rows).filter(is_filled).collect();
        let is_sparse = 2 * rows.len() < vectors.rows;
        let of_rows = |columns: &Columns, count: usize| Columns {
            rows: rows.len(),
            entries: (0..count).flat_map(|n| rows.iter().map(move |&i| columns.get(n)[i])).collect(),
        };
        let few = if is_sparse { of_rows(vectors, count) } else { Columns::default() };
        for begin in (known.nrows()..count).step_by(PROJECTED) {
            let end = count.min(begin + PROJECTED);
            let images = self.multiply(&vectors.range(begin, end));
            let products = if is_sparse {
                few.leading_products(end, &of_rows(&images, end - begin))
            } else {
                vectors.leading_products(end, &images)
            };
            for (j, column) in (begin..end).zip(products.column_iter()) {
                for i in 0..=j {
                    gram[(i, j)] = column[i];
                    gram[(j, i)] = column[i];
                }
            }
        }
        gram
    }
}
