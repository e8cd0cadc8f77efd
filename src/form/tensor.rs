//! Fields of tensor-product splines on a rectangle. Every integral of constant coefficients over it, or along an edge, is a sum
//! of products of integrals along the axes, so that no quadrature in two dimensions is needed.

use nalgebra::{DMatrix, DVector};

use super::Spline;

/// A sparse matrix: row, column, value, every row and column once.
pub type Entries = Vec<(usize, usize, f64)>;

/// A derivative of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    /// Number of the field.
    pub field: usize,
    /// How often it is differentiated along each axis.
    pub derivatives: [usize; 2],
}

/// Where along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Along {
    /// Integrated over all of it.
    All,
    /// At one place.
    At(f64),
}

/// Over the whole rectangle.
pub const AREA: [Along; 2] = [Along::All; 2];

/// A symmetric bilinear form: factor · ∫ (Σ parts of u)(Σ parts of v).
#[derive(Debug, Clone, PartialEq)]
pub struct Square {
    /// In front of the integral.
    pub factor: f64,
    /// Summed, then squared.
    pub parts: Vec<Part>,
    /// The place: area, edge or point.
    pub place: [Along; 2],
}

/// A linear form: factor · ∫ part of v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear {
    /// In front of the integral.
    pub factor: f64,
    /// What is integrated.
    pub part: Part,
    /// The place: area, edge or point.
    pub place: [Along; 2],
}

/// Fields on one rectangle, each with its splines along both axes, on the same breaks.
///
/// Unknowns: field by field; within a field the second axis runs fastest.
#[derive(Debug, Clone)]
pub struct Tensor {
    fields: Vec<[Spline; 2]>,
}

impl Tensor {
    /// The fields by number.
    pub fn new(fields: Vec<[Spline; 2]>) -> Self {
        Self { fields }
    }

    /// Number of unknowns of all fields.
    pub fn unknowns(&self) -> usize {
        self.first(self.fields.len())
    }

    /// A field's splines along both axes.
    pub fn splines(&self, field: usize) -> &[Spline; 2] {
        &self.fields[field]
    }

    /// Number of the unknown with these functions of a field along the axes.
    pub fn unknown(&self, field: usize, functions: [usize; 2]) -> usize {
        self.first(field) + functions[0] * self.fields[field][1].functions() + functions[1]
    }

    fn first(&self, field: usize) -> usize {
        self.fields[..field].iter().map(|[x, y]| x.functions() * y.functions()).sum()
    }

    /// The matrix of a sum of forms, symmetric to the last bit.
    pub fn matrix(&self, forms: &[Square]) -> Entries {
        let mut entries = Entries::new();
        for f in 0..self.fields.len() {
            for g in f..self.fields.len() {
                self.block([f, g], forms, &mut entries);
            }
        }
        entries
    }

    /// The entries of two fields, f ≤ g, and their mirror images.
    fn block(&self, [f, g]: [usize; 2], forms: &[Square], entries: &mut Entries) {
        let mut terms: Vec<[DMatrix<f64>; 2]> = Vec::new();
        for form in forms {
            for (a, b) in form.parts.iter().flat_map(|a| form.parts.iter().map(move |b| (a, b))) {
                if (a.field, b.field) == (f, g) {
                    let [x, y] = [0, 1].map(|axis| self.along(axis, form.place[axis], *a, *b));
                    terms.push([x * form.factor, y]);
                }
            }
        }
        if terms.is_empty() {
            return;
        }
        let [x, y] = [0, 1].map(|axis| overlaps(&self.fields[f][axis], &self.fields[g][axis]));
        for &(i, k) in &x {
            for &(j, l) in &y {
                let (row, column) = (self.unknown(f, [i, j]), self.unknown(g, [k, l]));
                if row > column {
                    continue;
                }
                let value: f64 = terms.iter().map(|[x, y]| x[(i, k)] * y[(j, l)]).sum();
                if value != 0.0 {
                    entries.push((row, column, value));
                    if row != column {
                        entries.push((column, row, value));
                    }
                }
            }
        }
    }

    /// Products of two parts along one axis.
    fn along(&self, axis: usize, place: Along, a: Part, b: Part) -> DMatrix<f64> {
        let [(s, d), (t, e)] = [a, b].map(|part| (&self.fields[part.field][axis], part.derivatives[axis]));
        match place {
            Along::All => s.products(d, t, e),
            Along::At(x) => s.values(x, d) * t.values(x, e).transpose(),
        }
    }

    /// The vector of a sum of linear forms.
    pub fn vector(&self, forms: &[Linear]) -> Vec<f64> {
        let mut sum = vec![0.0; self.unknowns()];
        for Linear { factor, part, place } in forms {
            let [x, y] = [0, 1].map(|axis| {
                let (spline, derivative) = (&self.fields[part.field][axis], part.derivatives[axis]);
                match place[axis] {
                    Along::All => spline.integrals(derivative),
                    Along::At(at) => spline.values(at, derivative),
                }
            });
            self.add(part.field, *factor, &x, &y, &mut sum);
        }
        sum
    }

    /// Adds factor · x yᵀ to the entries of a field.
    fn add(&self, field: usize, factor: f64, x: &DVector<f64>, y: &DVector<f64>, sum: &mut [f64]) {
        let block = sum[self.first(field)..].chunks_exact_mut(y.len());
        for (row, x) in block.zip(x) {
            row.iter_mut().zip(y).for_each(|(sum, y)| *sum += factor * x * y);
        }
    }

    /// Coefficients of a field that is 1 everywhere, the others zero.
    pub fn one(&self, field: usize) -> Vec<f64> {
        let mut sum = vec![0.0; self.unknowns()];
        let [x, y] = &self.fields[field];
        self.add(field, 1.0, &x.one(), &y.one(), &mut sum);
        sum
    }

    /// Adds weight · (part of v at a point) to a vector.
    pub fn add_point(&self, part: Part, point: [f64; 2], weight: f64, sum: &mut [f64]) {
        let [x, y] = &self.fields[part.field];
        let (i, of_x) = x.at(point[0], part.derivatives[0]);
        let (j, of_y) = y.at(point[1], part.derivatives[1]);
        for (k, x) in of_x.iter().enumerate().filter(|(_, x)| **x != 0.0) {
            let row = self.unknown(part.field, [i + k, j]);
            let entries = sum[row..].iter_mut().take(y.functions() - j);
            entries.zip(of_y).for_each(|(sum, y)| *sum += weight * x * y);
        }
    }
}

/// Pairs of functions that have a cell in common: none of them changes its sign, so that their product's integral tells.
fn overlaps(a: &Spline, b: &Spline) -> Vec<(usize, usize)> {
    let products = a.products(0, b, 0);
    let pairs = (0..products.nrows()).flat_map(|i| (0..products.ncols()).map(move |j| (i, j)));
    pairs.filter(|&at| products[at] != 0.0).collect()
}
