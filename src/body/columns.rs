//! Dense matrix of column vectors, in one process or with its rows distributed over ranks.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use nalgebra::DMatrix;
use petsc_wrap::Comm;
use std::ops::Range;

use super::memory;
use crate::error::Result;

/// Vectors of equal length, stored one after the other. If distributed, each rank has some of the rows, and operations
/// that sum over rows are collective.
#[derive(Clone)]
pub struct Columns {
    /// Number of rows on this rank.
    rows: usize,
    count: usize,
    entries: Vec<f64>,
    /// Communicator of the ranks that share the rows; `None` if this process has all rows.
    ranks: Option<Comm>,
}

impl Columns {
    /// Creates an empty set with `rows` rows on this rank.
    pub fn new(rows: usize, ranks: Option<&Comm>) -> Self {
        Self { rows, count: 0, entries: Vec::new(), ranks: ranks.cloned() }
    }

    /// Creates a set of one vector with the same layout.
    pub fn one(&self, entries: Vec<f64>) -> Self {
        debug_assert_eq!(entries.len(), self.rows);
        self.with(1, entries)
    }

    /// Creates a set of zero vectors with the same layout.
    pub fn zeros(&self, count: usize) -> Self {
        self.with(count, vec![0.0; self.rows * count])
    }

    /// Applies a map to all vectors at once. The map gets this rank's rows of all columns, one column after the other.
    pub fn mapped(&self, map: impl FnOnce(&[f64]) -> Vec<f64>) -> Self {
        self.with(self.count, map(&self.entries))
    }

    fn with(&self, count: usize, entries: Vec<f64>) -> Self {
        Self { rows: self.rows, count, entries, ranks: self.ranks.clone() }
    }

    /// Checks that there is memory for so many more vectors, each with one of its length beside it.
    ///
    /// # Errors
    /// A fault of the scene, on all ranks.
    pub fn check_room(&self, vectors: usize) -> Result<()> {
        let what = format!("a basis of {} vectors", self.count + vectors);
        let help = "a larger accuracy.tolerance, body.model for a plate, coarser cells, or more machines";
        let bytes = 2.0 * (vectors * self.rows * size_of::<f64>()) as f64;
        memory::check(self.ranks.as_ref(), memory::Need { bytes, what: &what, key: "body.reduction", help })
    }

    /// Number of rows on this rank.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Returns this rank's rows of one column.
    pub fn get(&self, number: usize) -> &[f64] {
        &self.entries[number * self.rows..(number + 1) * self.rows]
    }

    /// Returns this rank's rows of one column for modification.
    pub fn get_mut(&mut self, number: usize) -> &mut [f64] {
        &mut self.entries[number * self.rows..(number + 1) * self.rows]
    }

    /// Iterates over all columns.
    pub fn iter(&self) -> impl Iterator<Item = &[f64]> {
        (0..self.count).map(|number| self.get(number))
    }

    /// Appends one column.
    pub fn push(&mut self, column: &[f64]) {
        debug_assert_eq!(column.len(), self.rows);
        self.entries.extend_from_slice(column);
        self.count += 1;
    }

    /// Appends all columns of another set.
    pub fn append(&mut self, mut other: Self) {
        self.entries.append(&mut other.entries);
        self.count += other.count;
    }

    /// Returns a copy of some columns.
    pub fn range(&self, range: Range<usize>) -> Self {
        self.with(range.len(), self.entries[range.start * self.rows..range.end * self.rows].to_vec())
    }

    /// Returns the listed rows of some columns.
    fn few_rows(&self, range: Range<usize>, rows: &[usize]) -> Self {
        let columns = range.clone().map(|number| self.get(number));
        let entries = columns.flat_map(|column| rows.iter().map(move |&row| column[row])).collect();
        Self { rows: rows.len(), count: range.len(), entries, ranks: self.ranks.clone() }
    }

    fn matrix(&self, range: Range<usize>) -> MatRef<'_, f64> {
        let entries = &self.entries[range.start * self.rows..range.end * self.rows];
        MatRef::from_column_major_slice(entries, self.rows, range.len())
    }

    fn matrix_mut(&mut self) -> MatMut<'_, f64> {
        MatMut::from_column_major_slice_mut(&mut self.entries, self.rows, self.count)
    }

    /// Returns selfᵀ other for a range of the columns of `self`. Collective.
    pub fn products_of(&self, range: Range<usize>, other: &Self) -> DMatrix<f64> {
        let mut products = DMatrix::zeros(range.len(), other.count);
        let into = MatMut::from_column_major_slice_mut(products.as_mut_slice(), range.len(), other.count);
        let (left, right) = (self.matrix(range), other.matrix(0..other.count));
        matmul(into, Accum::Replace, left.transpose(), right, 1.0, Par::Seq);
        self.sum(&mut products);
        products
    }

    /// Returns selfᵀ other. Collective.
    pub fn products(&self, other: &Self) -> DMatrix<f64> {
        self.products_of(0..self.count, other)
    }

    /// Returns selfᵀ other for the first columns of `self`. It is fast if `other` has few nonzero rows, such as
    /// products with a support stiffness. Collective.
    pub fn products_with_few_rows(&self, count: usize, other: &Self) -> DMatrix<f64> {
        let is_met = |row: &usize| other.iter().any(|column| column[*row] != 0.0);
        let rows: Vec<usize> = (0..self.rows).filter(is_met).collect();
        if 2 * rows.len() > self.rows {
            return self.products_of(0..count, other);
        }
        self.few_rows(0..count, &rows).products(&other.few_rows(0..other.count, &rows))
    }

    /// Returns the inner products of all columns with a vector. Collective.
    pub fn along(&self, vector: &[f64]) -> nalgebra::DVector<f64> {
        self.products(&self.one(vector.to_vec())).column(0).into_owned()
    }

    /// Returns the inner products of vectors with few nonzero entries (rows) with all columns. Collective.
    pub fn along_sparse(&self, vectors: &[Vec<f64>]) -> DMatrix<f64> {
        let mut products = DMatrix::zeros(vectors.len(), self.count);
        for (row, vector) in vectors.iter().enumerate() {
            let entries: Vec<(usize, f64)> =
                vector.iter().copied().enumerate().filter(|(_, value)| *value != 0.0).collect();
            for (number, column) in self.iter().enumerate() {
                products[(row, number)] = entries.iter().map(|(place, value)| value * column[*place]).sum();
            }
        }
        self.sum(&mut products);
        products
    }

    /// Returns the inner product of the first columns of both sets. Collective.
    pub fn dot(&self, other: &Self) -> f64 {
        self.products_of(0..1, other)[(0, 0)]
    }

    /// Sums a matrix over all ranks. Collective.
    fn sum(&self, here: &mut DMatrix<f64>) {
        if let Some(ranks) = self.ranks.as_ref().filter(|ranks| ranks.size() > 1) {
            let mut all = DMatrix::zeros(here.nrows(), here.ncols());
            ranks.mpi().all_reduce_into(here.as_slice(), all.as_mut_slice(), SystemOperation::sum());
            *here = all;
        }
    }

    /// Returns the largest absolute value of all entries. Collective.
    pub fn largest(&self) -> f64 {
        let here = self.entries.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        self.ranks.as_ref().map_or(here, |ranks| {
            let mut all = here;
            ranks.mpi().all_reduce_into(&here, &mut all, SystemOperation::max());
            all
        })
    }

    /// Replaces numbers by the values of the first rank. Sums over ranks may differ in their last digits, so that ranks
    /// could decide differently. Collective.
    pub fn agree(&self, numbers: &mut [f64]) {
        if let Some(ranks) = &self.ranks {
            ranks.broadcast_from_root(numbers);
        }
    }

    /// Returns all rows of the first columns on the first rank. On other ranks, distributed columns are returned
    /// without rows. Collective.
    pub fn whole(&self, count: usize) -> Vec<Vec<f64>> {
        let all = self.iter().take(count).map(|column| match &self.ranks {
            Some(ranks) => ranks.gather_to_root(column),
            None => column.to_vec(),
        });
        all.collect()
    }

    /// Computes self ← self − others · parts, with a range of the columns of `others`.
    pub fn subtract_of(&mut self, others: &Self, range: Range<usize>, parts: &DMatrix<f64>) {
        let parts = MatRef::from_column_major_slice(parts.as_slice(), parts.nrows(), parts.ncols());
        matmul(self.matrix_mut(), Accum::Add, others.matrix(range), parts, -1.0, Par::Seq);
    }

    /// Computes self ← self − others · parts.
    pub fn subtract(&mut self, others: &Self, parts: &DMatrix<f64>) {
        self.subtract_of(others, 0..others.count, parts);
    }

    /// Returns self · parts, with the first columns of `self`.
    pub fn combined(&self, parts: &DMatrix<f64>) -> Self {
        let mut sums = self.zeros(parts.ncols());
        sums.subtract_of(self, 0..parts.nrows(), &-parts);
        sums
    }

    /// Computes self ← self + factor · others.
    pub fn add(&mut self, factor: f64, others: &Self) {
        self.entries.iter_mut().zip(&others.entries).for_each(|(entry, other)| *entry += factor * other);
    }

    /// Multiplies all entries by a number.
    pub fn scale(&mut self, factor: f64) {
        self.entries.iter_mut().for_each(|entry| *entry *= factor);
    }

    /// Sets some rows to zero.
    pub fn zero_rows(&mut self, rows: &[usize]) {
        for number in 0..self.count {
            let column = self.get_mut(number);
            rows.iter().for_each(|row| column[*row] = 0.0);
        }
    }

    /// Multiplies the columns by L⁻ᵀ from the right, with a lower triangle L.
    pub fn divide_by_triangle(&mut self, lower: &DMatrix<f64>) {
        for k in 0..self.count {
            let (earlier, others) = self.entries.split_at_mut(k * self.rows);
            let column = &mut others[..self.rows];
            for (i, other) in earlier.chunks_exact(self.rows.max(1)).enumerate() {
                let part = lower[(k, i)];
                column.iter_mut().zip(other).for_each(|(entry, other)| *entry -= part * other);
            }
            column.iter_mut().for_each(|entry| *entry /= lower[(k, k)]);
        }
    }
}
