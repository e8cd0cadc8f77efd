//! Products with the matrix of a sum of forms on a rectangle, computed from its one-dimensional integrals along the
//! axes.
//!
//! Each form is a sum of terms A ⊗ B, with A along the first axis and B along the second. So K x takes a few products
//! with narrow band matrices along each axis. The full matrix has several times as many entries. This is sum
//! factorisation (S. A. Orszag, Spectral methods for problems in complex geometries, J. Comput. Phys. 37, 1980; for
//! splines: P. Antolin, A. Buffa, F. Calabrò, M. Martinelli & G. Sangalli, Comput. Methods Appl. Mech. Eng. 285, 2015).

use std::ops::Range;

use nalgebra::DMatrix;

use super::{Integrals, Square, Tensor};

/// Matrix of a sum of forms, stored as products along the axes.
#[derive(Debug)]
pub struct SumFactorised {
    /// Unknowns of each field.
    fields: Vec<Grid>,
    /// Products along the first axis.
    first: Vec<AlongFirst>,
    /// Sums of these products, each multiplied along the second axis.
    second: Vec<AlongSecond>,
}

/// Coefficients of a field; the functions along the second axis run fastest.
#[derive(Debug)]
struct Grid {
    unknowns: Range<usize>,
    functions: [usize; 2],
}

/// Product of a field's coefficients with integrals along the first axis.
#[derive(Debug)]
struct AlongFirst {
    field: usize,
    /// Number of the integrals in [`Integrals`].
    integrals: usize,
    band: Band,
}

/// Sum of products along the first axis, multiplied with integrals along the second axis and added to a field.
#[derive(Debug)]
struct AlongSecond {
    field: usize,
    /// Number of the integrals in [`Integrals`].
    integrals: usize,
    band: Band,
    /// Indices in [`SumFactorised::first`], with factors.
    terms: Vec<(usize, f64)>,
}

/// Band matrix, stored by its diagonals.
#[derive(Debug)]
struct Band {
    rows: usize,
    diagonals: Vec<Diagonal>,
}

/// Entries (i, i + offset) of consecutive rows i.
#[derive(Debug)]
struct Diagonal {
    first_row: usize,
    first_column: usize,
    values: Vec<f64>,
}

impl Band {
    /// Stores each diagonal from its first to its last non-zero entry.
    fn new(matrix: &DMatrix<f64>) -> Self {
        let (rows, columns) = matrix.shape();
        let diagonal = |start: usize| {
            // Diagonals from the lower left corner to the upper right corner.
            let (row, column) = (rows.saturating_sub(1 + start), (start + 1).saturating_sub(rows));
            let all: Vec<f64> =
                (0..(rows - row).min(columns - column)).map(|k| matrix[(row + k, column + k)]).collect();
            let begin = all.iter().position(|value| *value != 0.0)?;
            let end = all.iter().rposition(|value| *value != 0.0)?;
            let values = all[begin..=end].to_vec();
            Some(Diagonal { first_row: row + begin, first_column: column + begin, values })
        };
        Self { rows, diagonals: (0..(rows + columns).saturating_sub(1)).filter_map(diagonal).collect() }
    }

    fn entries(&self) -> usize {
        self.diagonals.iter().map(|diagonal| diagonal.values.len()).sum()
    }

    /// to ← A x, where x and `to` have rows of `length` entries each.
    #[inline(always)]
    fn of_rows(&self, length: usize, x: &[f64], to: &mut [f64]) {
        to.fill(0.0);
        for Diagonal { first_row, first_column, values } in &self.diagonals {
            let to = to[first_row * length..].chunks_exact_mut(length);
            for ((to, x), value) in to.zip(x[first_column * length..].chunks_exact(length)).zip(values) {
                to.iter_mut().zip(x).for_each(|(sum, x)| *sum += value * x);
            }
        }
    }

    /// to ← to + x Aᵀ, where x has rows of `length` entries each.
    #[inline(always)]
    fn add_within_rows(&self, length: usize, x: &[f64], to: &mut [f64]) {
        for (to, x) in to.chunks_exact_mut(self.rows).zip(x.chunks_exact(length)) {
            for Diagonal { first_row, first_column, values } in &self.diagonals {
                let products = to[*first_row..].iter_mut().zip(&x[*first_column..]).zip(values);
                products.for_each(|((sum, x), value)| *sum += value * x);
            }
        }
    }
}

impl Tensor<2> {
    /// Matrix of a sum of forms, the same as [`Tensor::matrix_sharing`], for products only.
    pub fn factorised(&self, forms: &[Square<2>], integrals: &mut Integrals) -> SumFactorised {
        let grid = |field: usize| Grid {
            unknowns: self.first(field)..self.first(field + 1),
            functions: self.fields[field].each_ref().map(super::Spline::functions),
        };
        let count = self.fields.len();
        let mut all = SumFactorised { fields: (0..count).map(grid).collect(), first: Vec::new(), second: Vec::new() };
        for (to, from) in (0..count).flat_map(|to| (0..count).map(move |from| (to, from))) {
            // The matrices of the terms have a column for each function of the first field in the pair.
            for term in self.terms([from, to], forms, integrals) {
                let [along_first, along_second] = term.axes;
                let same = |one: &AlongFirst| (one.field, one.integrals) == (from, along_first);
                let number = all.first.iter().position(same).unwrap_or_else(|| {
                    let band = Band::new(&integrals.products(along_first).values);
                    all.first.push(AlongFirst { field: from, integrals: along_first, band });
                    all.first.len() - 1
                });
                let same = |one: &AlongSecond| (one.field, one.integrals) == (to, along_second);
                match all.second.iter_mut().find(|one| same(one)) {
                    Some(sum) => sum.terms.push((number, term.factor)),
                    None => {
                        let band = Band::new(&integrals.products(along_second).values);
                        let terms = vec![(number, term.factor)];
                        all.second.push(AlongSecond { field: to, integrals: along_second, band, terms });
                    }
                }
            }
        }
        all
    }
}

impl SumFactorised {
    fn unknowns(&self) -> usize {
        self.fields.last().map_or(0, |grid| grid.unknowns.end)
    }

    /// Number of multiplications for a product with one column.
    pub fn multiplications(&self) -> usize {
        let of_first = |one: &AlongFirst| one.band.entries() * self.fields[one.field].functions[1];
        let of_second = |one: &AlongSecond| {
            (one.band.entries() + one.terms.len() * one.band.rows) * self.fields[one.field].functions[0]
        };
        self.first.iter().map(of_first).sum::<usize>() + self.second.iter().map(of_second).sum::<usize>()
    }

    /// Multiplies the matrix with columns that are stored one after the other, each with one entry per unknown.
    pub fn multiply(&self, columns: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; columns.len()];
        pulp::Arch::new().dispatch(Multiplying { matrix: self, columns, product: &mut product });
        product
    }

    #[inline(always)]
    fn multiply_into(&self, columns: &[f64], product: &mut [f64]) {
        let size = |one: &AlongFirst| one.band.rows * self.fields[one.field].functions[1];
        let mut along_first: Vec<Vec<f64>> = self.first.iter().map(|one| vec![0.0; size(one)]).collect();
        let mut sum: Vec<f64> = Vec::new();
        let count = self.unknowns().max(1);
        for (column, product) in columns.chunks_exact(count).zip(product.chunks_exact_mut(count)) {
            for (one, to) in self.first.iter().zip(&mut along_first) {
                let from = &self.fields[one.field];
                one.band.of_rows(from.functions[1], &column[from.unknowns.clone()], to);
            }
            for one in &self.second {
                let [(first, factor), rest @ ..] = &one.terms[..] else { continue };
                sum.clear();
                sum.extend(along_first[*first].iter().map(|x| factor * x));
                for (more, factor) in rest {
                    sum.iter_mut().zip(&along_first[*more]).for_each(|(sum, x)| *sum += factor * x);
                }
                let to = &self.fields[one.field];
                let length = sum.len() / to.functions[0];
                one.band.add_within_rows(length, &sum, &mut product[to.unknowns.clone()]);
            }
        }
    }
}

/// Product with columns, compiled for the vector instructions of each kind of processor.
struct Multiplying<'a> {
    matrix: &'a SumFactorised,
    columns: &'a [f64],
    product: &'a mut [f64],
}

impl pulp::NullaryFnOnce for Multiplying<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.matrix.multiply_into(self.columns, self.product);
    }
}
