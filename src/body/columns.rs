//! Vectors of one length as the columns of a dense matrix, in one process or with their rows spread over ranks.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use nalgebra::DMatrix;
use petsc_wrap::Comm;
use std::ops::Range;

/// Vectors of a length, one after the other. Of distributed ones each rank has some rows; what sums over rows is collective then.
#[derive(Clone)]
pub struct Columns {
    /// Of this rank.
    rows: usize,
    count: usize,
    entries: Vec<f64>,
    /// Those that share the rows; `None` where this process has all.
    ranks: Option<Comm>,
}

impl Columns {
    /// None yet, with so many rows here.
    pub fn new(rows: usize, ranks: Option<&Comm>) -> Self {
        Self { rows, count: 0, entries: Vec::new(), ranks: ranks.cloned() }
    }

    /// One, laid out as these.
    pub fn one(&self, entries: Vec<f64>) -> Self {
        debug_assert_eq!(entries.len(), self.rows);
        self.with(1, entries)
    }

    /// Some that are zero, laid out as these.
    pub fn zeros(&self, count: usize) -> Self {
        self.with(count, vec![0.0; self.rows * count])
    }

    /// The same with each made of these all at once: entries one after the other, of this rank's rows.
    pub fn mapped(&self, map: impl FnOnce(&[f64]) -> Vec<f64>) -> Self {
        self.with(self.count, map(&self.entries))
    }

    fn with(&self, count: usize, entries: Vec<f64>) -> Self {
        Self { rows: self.rows, count, entries, ranks: self.ranks.clone() }
    }

    /// Rows of this rank.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// One of them, this rank's rows.
    pub fn get(&self, number: usize) -> &[f64] {
        &self.entries[number * self.rows..(number + 1) * self.rows]
    }

    /// One of them, to be changed.
    pub fn get_mut(&mut self, number: usize) -> &mut [f64] {
        &mut self.entries[number * self.rows..(number + 1) * self.rows]
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &[f64]> {
        (0..self.count).map(|number| self.get(number))
    }

    /// Adds one.
    pub fn push(&mut self, column: &[f64]) {
        debug_assert_eq!(column.len(), self.rows);
        self.entries.extend_from_slice(column);
        self.count += 1;
    }

    /// Adds all of others.
    pub fn append(&mut self, mut other: Self) {
        self.entries.append(&mut other.entries);
        self.count += other.count;
    }

    /// Some of them.
    pub fn range(&self, range: Range<usize>) -> Self {
        self.with(range.len(), self.entries[range.start * self.rows..range.end * self.rows].to_vec())
    }

    /// The rows of some of them that are named.
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

    /// selfᵀ other, of some of these. Collective.
    pub fn products_of(&self, range: Range<usize>, other: &Self) -> DMatrix<f64> {
        let mut products = DMatrix::zeros(range.len(), other.count);
        let into = MatMut::from_column_major_slice_mut(products.as_mut_slice(), range.len(), other.count);
        let (left, right) = (self.matrix(range), other.matrix(0..other.count));
        matmul(into, Accum::Replace, left.transpose(), right, 1.0, Par::Seq);
        self.sum(&mut products);
        products
    }

    /// selfᵀ other. Collective.
    pub fn products(&self, other: &Self) -> DMatrix<f64> {
        self.products_of(0..self.count, other)
    }

    /// selfᵀ other, of the first of these, where others have few rows that are not zero, as what supports do to vectors. Collective.
    pub fn products_with_few_rows(&self, count: usize, other: &Self) -> DMatrix<f64> {
        let is_met = |row: &usize| other.iter().any(|column| column[*row] != 0.0);
        let rows: Vec<usize> = (0..self.rows).filter(is_met).collect();
        if 2 * rows.len() > self.rows {
            return self.products_of(0..count, other);
        }
        self.few_rows(0..count, &rows).products(&other.few_rows(0..other.count, &rows))
    }

    /// Inner products with a vector. Collective.
    pub fn along(&self, vector: &[f64]) -> nalgebra::DVector<f64> {
        self.products(&self.one(vector.to_vec())).column(0).into_owned()
    }

    /// Inner product of the first one and another first one. Collective.
    pub fn dot(&self, other: &Self) -> f64 {
        self.products_of(0..1, other)[(0, 0)]
    }

    /// Sums over all ranks' rows. Collective.
    fn sum(&self, here: &mut DMatrix<f64>) {
        if let Some(ranks) = self.ranks.as_ref().filter(|ranks| ranks.size() > 1) {
            let mut all = DMatrix::zeros(here.nrows(), here.ncols());
            ranks.mpi().all_reduce_into(here.as_slice(), all.as_mut_slice(), SystemOperation::sum());
            *here = all;
        }
    }

    /// The largest entry's size. Collective.
    pub fn largest(&self) -> f64 {
        let here = self.entries.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        self.ranks.as_ref().map_or(here, |ranks| {
            let mut all = here;
            ranks.mpi().all_reduce_into(&here, &mut all, SystemOperation::max());
            all
        })
    }

    /// Makes numbers those of the first rank: sums over ranks may differ in their last digits, and with them the decisions that follow from
    /// them. Collective.
    pub fn agree(&self, numbers: &mut [f64]) {
        if let Some(ranks) = &self.ranks {
            ranks.broadcast_from_root(numbers);
        }
    }

    /// All rows of the first vectors on the first rank; on the others, none of distributed ones. Collective.
    pub fn whole(&self, count: usize) -> Vec<Vec<f64>> {
        let all = self.iter().take(count).map(|column| match &self.ranks {
            Some(ranks) => ranks.gather_to_root(column),
            None => column.to_vec(),
        });
        all.collect()
    }

    /// self ← self − others · parts, of some of the others.
    pub fn subtract_of(&mut self, others: &Self, range: Range<usize>, parts: &DMatrix<f64>) {
        let parts = MatRef::from_column_major_slice(parts.as_slice(), parts.nrows(), parts.ncols());
        matmul(self.matrix_mut(), Accum::Add, others.matrix(range), parts, -1.0, Par::Seq);
    }

    /// self ← self − others · parts.
    pub fn subtract(&mut self, others: &Self, parts: &DMatrix<f64>) {
        self.subtract_of(others, 0..others.count, parts);
    }

    /// self · parts, of the first of these.
    pub fn combined(&self, parts: &DMatrix<f64>) -> Self {
        let mut sums = self.zeros(parts.ncols());
        sums.subtract_of(self, 0..parts.nrows(), &-parts);
        sums
    }

    /// self ← self + factor · others.
    pub fn add(&mut self, factor: f64, others: &Self) {
        self.entries.iter_mut().zip(&others.entries).for_each(|(entry, other)| *entry += factor * other);
    }

    /// Multiplies all by a number.
    pub fn scale(&mut self, factor: f64) {
        self.entries.iter_mut().for_each(|entry| *entry *= factor);
    }

    /// Makes some rows zero.
    pub fn zero_rows(&mut self, rows: &[usize]) {
        for number in 0..self.count {
            let column = self.get_mut(number);
            rows.iter().for_each(|row| column[*row] = 0.0);
        }
    }

    /// The columns times L⁻ᵀ of a lower triangle L.
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
