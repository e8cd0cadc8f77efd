//! Fields of tensor-product splines on a rectangle or a box. Every integral with constant coefficients over the domain
//! or a face is a sum of products of one-dimensional integrals along the axes, so that no multi-dimensional quadrature
//! is needed.

mod rows;

use std::cmp::Ordering;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::CsrMatrix;

use super::spline::WIDTH;
use super::{Projection, Spline};
use rows::Rows;

/// A derivative of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Derivative<const D: usize> {
    /// Number of the field.
    pub field: usize,
    /// Order of the derivative along each axis.
    pub derivatives: [usize; D],
}

/// Part of the domain along one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Along {
    /// Integral over the whole axis.
    All,
    /// Integral over the part of the axis within an interval.
    Within([f64; 2]),
    /// Integral over the whole axis, with the second factor projected onto quadratic splines ([`Projection`]).
    Projected,
    /// Value at one coordinate.
    At(f64),
}

impl Along {
    /// The whole axis with projection; other parts of an axis stay as they are.
    pub fn projected(self) -> Self {
        if self == Self::All { Self::Projected } else { self }
    }
}

/// A symmetric bilinear form: factor · ∫ (Σ parts of u)(Σ parts of v), each part with its own factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Square<const D: usize> {
    /// Factor of the integral.
    pub factor: f64,
    /// Parts with their factors, which are summed, then squared.
    pub parts: Vec<(f64, Derivative<D>)>,
    /// Part of the domain: all of it, a face or a region of either.
    pub place: [Along; D],
}

impl<const D: usize> Square<D> {
    /// The form factor · ∫ (Σ parts of u)(Σ parts of v), with the factor 1 on all parts.
    pub fn of_sum(factor: f64, parts: &[Derivative<D>], place: [Along; D]) -> Self {
        Self { factor, parts: parts.iter().map(|part| (1.0, *part)).collect(), place }
    }
}

/// A linear form: factor · ∫ part of v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Linear<const D: usize> {
    /// Factor of the integral.
    pub factor: f64,
    /// Integrand.
    pub part: Derivative<D>,
    /// Part of the domain: all of it, a face or a region of either.
    pub place: [Along; D],
}

/// Fields on one rectangle or box. Each field has a spline along each axis, all on the same breaks.
///
/// Unknowns are numbered field by field; within a field the last axis runs fastest.
#[derive(Debug, Clone)]
pub struct Tensor<const D: usize> {
    fields: Vec<[Spline; D]>,
    /// For each field and axis, the number of the first field with the same spline along that axis.
    first_alike: Vec<[usize; D]>,
}

/// Product of two parts in a form.
struct Term<const D: usize> {
    /// Factor of the product.
    factor: f64,
    /// Number in [`Integrals`] of the products along each axis.
    axes: [usize; D],
}

/// Integrals along one axis of products of the functions of two fields.
#[derive(Debug)]
struct Products {
    /// One column for each function of the first field, one row for each function of the second.
    values: DMatrix<f64>,
    /// For each function of the first field: range of the functions of the second field from the first to the last that
    /// overlaps it.
    met: Vec<Range<usize>>,
}

/// Integrals of products along the axes of one [`Tensor`], with their factors. They are stored because forms share many
/// of them.
#[derive(Debug, Default)]
pub struct Integrals(Vec<(Factors, Products)>);

/// Factors of an integral along an axis: derivatives of the functions of two fields.
#[derive(Debug, PartialEq)]
struct Factors {
    axis: usize,
    place: Along,
    /// For each factor, the first field with the same spline along the axis.
    fields: [usize; 2],
    /// Order of the derivative of each field.
    derivatives: [usize; 2],
}

impl Integrals {
    fn products(&self, number: usize) -> &Products {
        &self.0[number].1
    }
}

impl<const D: usize> Tensor<D> {
    /// Tensor-product space of fields, numbered in this order.
    pub fn new(fields: Vec<[Spline; D]>) -> Self {
        let first = |field: usize, axis: usize| {
            (0..field).find(|other| fields[*other][axis] == fields[field][axis]).unwrap_or(field)
        };
        let first_alike = (0..fields.len()).map(|field| std::array::from_fn(|axis| first(field, axis))).collect();
        Self { fields, first_alike }
    }

    /// Number of unknowns of all fields.
    pub fn unknowns(&self) -> usize {
        self.first(self.fields.len())
    }

    /// Number of fields.
    pub fn fields(&self) -> usize {
        self.fields.len()
    }

    /// Splines of a field along all axes.
    pub fn splines(&self, field: usize) -> &[Spline; D] {
        &self.fields[field]
    }

    /// Number of the unknown for these functions of a field along the axes.
    pub fn unknown(&self, field: usize, functions: [usize; D]) -> usize {
        let axes = self.fields[field].iter().zip(functions);
        self.first(field) + axes.fold(0, |number, (spline, function)| number * spline.functions() + function)
    }

    /// Number of unknowns of the fields before `field`.
    fn first(&self, field: usize) -> usize {
        self.fields[..field].iter().map(|axes| axes.iter().map(Spline::functions).product::<usize>()).sum()
    }

    /// Assembles the matrix of a sum of forms, symmetric to the last bit. The sparsity pattern depends on the fields
    /// that the forms couple and on the places of the forms, but not on the derivatives.
    pub fn matrix(&self, forms: &[Square<D>]) -> CsrMatrix<f64> {
        self.matrix_sharing(forms, &mut Integrals::default())
    }

    /// Same as [`Tensor::matrix`] with the integrals of earlier forms. New integrals are added to them.
    pub fn matrix_sharing(&self, forms: &[Square<D>], integrals: &mut Integrals) -> CsrMatrix<f64> {
        let count = self.fields.len();
        let blocks: Vec<Vec<(usize, Vec<Term<D>>)>> = (0..count)
            .map(|f| {
                let terms = (f..count).map(|g| (g, self.terms([f, g], forms, integrals)));
                terms.filter(|(_, terms)| !terms.is_empty()).collect()
            })
            .collect();
        let entries = blocks.iter().flatten().map(|(_, terms)| coupled(terms, integrals)).sum();
        let mut upper = Rows::with_capacity(self.unknowns(), entries);
        let mut line = Vec::new();
        for (f, blocks) in blocks.iter().enumerate() {
            for functions in indices(self.fields[f].each_ref().map(|spline| 0..spline.functions())) {
                let row = self.unknown(f, functions);
                for (g, terms) in blocks {
                    self.add_row((row, functions), (*g, terms), integrals, (&mut line, &mut upper));
                }
                upper.ends.push(upper.columns.len());
            }
        }
        upper.mirrored()
    }

    /// Terms that couple two fields in a sum of forms. Terms with the same integrals along the last axis are
    /// consecutive.
    fn terms(&self, [f, g]: [usize; 2], forms: &[Square<D>], integrals: &mut Integrals) -> Vec<Term<D>> {
        let mut terms: Vec<Term<D>> = Vec::new();
        for form in forms {
            for ((of_a, a), (of_b, b)) in form.parts.iter().flat_map(|a| form.parts.iter().map(move |b| (a, b))) {
                if (a.field, b.field) != (f, g) {
                    continue;
                }
                let factor = form.factor * (of_a * of_b);
                let axes = std::array::from_fn(|axis| self.along(axis, form.place[axis], [*a, *b], integrals));
                match terms.iter_mut().find(|term| term.axes == axes) {
                    Some(term) => term.factor += factor,
                    None => terms.push(Term { factor, axes }),
                }
            }
        }
        terms.sort_by_key(|term| term.axes[D - 1]);
        terms
    }

    /// Number of the products of two parts along one axis in `integrals`; computes them if necessary.
    fn along(&self, axis: usize, place: Along, parts: [Derivative<D>; 2], integrals: &mut Integrals) -> usize {
        let derivatives = parts.map(|part| part.derivatives[axis]);
        let factors =
            Factors { axis, place, fields: parts.map(|part| self.first_alike[part.field][axis]), derivatives };
        if let Some(number) = integrals.0.iter().position(|(of, _)| *of == factors) {
            return number;
        }
        let [s, t] = parts.map(|part| &self.fields[part.field][axis]);
        let [d, e] = derivatives;
        let values = match place {
            Along::All => t.products(e, s, d),
            Along::Within(ends) => t.products_within(ends, e, s, d),
            Along::Projected => Projection::new(s).products((t, e), (s, d)),
            Along::At(x) => t.values(x, e) * s.values(x, d).transpose(),
        };
        let met = match place {
            // Functions of one parity all overlap.
            Along::All | Along::Projected if s.is_folded() => vec![0..t.functions(); s.functions()],
            // No function changes its sign, so two functions overlap if and only if the integral of their product is
            // not zero. The first and last products with a projection have a single part, which is not zero either.
            Along::All | Along::Within(_) | Along::Projected if derivatives != [0, 0] => {
                let values = parts.map(|part| Derivative { derivatives: [0; D], ..part });
                let number = self.along(axis, place, values, integrals);
                integrals.products(number).met.clone()
            }
            _ => values.column_iter().map(|column| within_ends(column.as_slice())).collect(),
        };
        integrals.0.push((factors, Products { values, met }));
        integrals.0.len() - 1
    }

    /// Adds the entries of a row in the columns of one field, from the diagonal on. The row is given by its number and
    /// functions; `line` is a buffer.
    fn add_row(
        &self,
        (row, functions): (usize, [usize; D]),
        (field, terms): (usize, &[Term<D>]),
        integrals: &Integrals,
        (line, rows): (&mut Vec<f64>, &mut Rows),
    ) {
        let met = |term: &Term<D>| -> [Range<usize>; D] {
            std::array::from_fn(|axis| integrals.products(term.axes[axis]).met[functions[axis]].clone())
        };
        let is_present = |term: &&Term<D>| met(term).iter().all(|range| !range.is_empty());
        let Some(hull) = terms.iter().filter(is_present).map(met).reduce(|hull, range| {
            std::array::from_fn(|axis| hull[axis].start.min(range[axis].start)..hull[axis].end.max(range[axis].end))
        }) else {
            return;
        };
        // Rows of entries along the last axis.
        let last = hull[D - 1].clone();
        let mut starts = hull;
        starts[D - 1] = last.start..last.start + 1;
        line.resize(last.len(), 0.0);
        for start in indices(starts) {
            let column = self.unknown(field, start);
            if column + line.len() <= row {
                continue;
            }
            line.fill(0.0);
            for same in terms.chunk_by(|one, other| one.axes[D - 1] == other.axes[D - 1]) {
                // A term that is not present has products of zero along an axis.
                let before = |term: &Term<D>| -> f64 {
                    let along = (0..D - 1)
                        .map(|axis| integrals.products(term.axes[axis]).values[(start[axis], functions[axis])]);
                    along.fold(term.factor, |product, value| product * value)
                };
                let factor: f64 = same.iter().map(before).sum();
                if factor != 0.0 {
                    let values = &integrals.products(same[0].axes[D - 1]).values;
                    let first = functions[D - 1] * values.nrows();
                    let values = &values.as_slice()[first + last.start..first + last.end];
                    line.iter_mut().zip(values).for_each(|(sum, v)| *sum += factor * v);
                }
            }
            let skipped = row.saturating_sub(column);
            rows.columns.extend(column + skipped..column + line.len());
            rows.values.extend_from_slice(&line[skipped..]);
        }
    }

    /// Assembles the vector of a sum of linear forms.
    pub fn vector(&self, forms: &[Linear<D>]) -> Vec<f64> {
        let mut sum = vec![0.0; self.unknowns()];
        for Linear { factor, part, place } in forms {
            let values = std::array::from_fn(|axis| {
                let (spline, derivative) = (&self.fields[part.field][axis], part.derivatives[axis]);
                match place[axis] {
                    Along::All | Along::Projected => spline.integrals(derivative),
                    Along::Within(ends) => spline.integrals_within(ends, derivative),
                    Along::At(at) => spline.values(at, derivative),
                }
            });
            self.add(part.field, *factor, &values, &mut sum);
        }
        sum
    }

    /// Adds factor · x ⊗ y ⊗ … to the entries of a field.
    fn add(&self, field: usize, factor: f64, values: &[DVector<f64>; D], sum: &mut [f64]) {
        let outer = |list: Vec<f64>, values: &DVector<f64>| -> Vec<f64> {
            list.iter().flat_map(|a| values.iter().map(move |b| a * b)).collect()
        };
        let product = values.iter().fold(vec![factor], outer);
        sum[self.first(field)..].iter_mut().zip(product).for_each(|(sum, value)| *sum += value);
    }

    /// Calls `visit` with the non-zero entries of factor · x ⊗ y ⊗ … for a field, each with its unknown.
    pub fn each_product(
        &self,
        field: usize,
        values: &[DVector<f64>; D],
        factor: f64,
        mut visit: impl FnMut(usize, f64),
    ) {
        for functions in indices(values.each_ref().map(|values| within_ends(values.as_slice()))) {
            let product = (0..D).fold(factor, |product, axis| product * values[axis][functions[axis]]);
            visit(self.unknown(field, functions), product);
        }
    }

    /// Coefficients with which a field is 1 everywhere and the others are zero.
    pub fn one(&self, field: usize) -> Vec<f64> {
        let mut sum = vec![0.0; self.unknowns()];
        self.add(field, 1.0, &self.fields[field].each_ref().map(Spline::one), &mut sum);
        sum
    }

    /// Adds weight · (part of v at a point) to a vector.
    pub fn add_point(&self, part: Derivative<D>, point: [f64; D], weight: f64, sum: &mut [f64]) {
        self.each_at(part, point, weight, |first, values| {
            sum[first..].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        });
    }

    /// Adds factor · Σ weight · (part of v) to a vector, for coordinates and weights on a line through a point along an
    /// axis.
    pub fn add_line(
        &self,
        (part, factor): (Derivative<D>, f64),
        (point, axis): ([f64; D], usize),
        line: &[(f64, f64)],
        sum: &mut [f64],
    ) {
        let splines = &self.fields[part.field];
        // Number of the first function, and the values of this and the next functions.
        let along: [(usize, Vec<f64>); D] = std::array::from_fn(|i| {
            let (spline, derivative) = (&splines[i], part.derivatives[i]);
            if i != axis {
                let (first, values) = spline.at(point[i], derivative);
                return (first, values[..WIDTH.min(spline.functions() - first)].to_vec());
            }
            let mut values = vec![0.0; spline.functions()];
            for (place, weight) in line {
                let (first, at) = spline.at(*place, derivative);
                values[first..].iter_mut().zip(at).for_each(|(sum, value)| *sum += factor * weight * value);
            }
            (0, values)
        });
        for functions in indices(along.each_ref().map(|(first, values)| *first..first + values.len())) {
            let value: f64 = (0..D).map(|i| along[i].1[functions[i] - along[i].0]).product();
            if value != 0.0 {
                sum[self.unknown(part.field, functions)] += value;
            }
        }
    }

    /// Non-zero entries of weight · (part of v at a point), by ascending unknown.
    pub fn at_point(&self, part: Derivative<D>, point: [f64; D], weight: f64) -> Vec<(usize, f64)> {
        let mut entries = Vec::with_capacity(WIDTH.pow(D as u32));
        self.each_at(part, point, weight, |first, values| {
            entries.extend((first..).zip(values.iter().copied()).filter(|(_, value)| *value != 0.0));
        });
        entries
    }

    /// Calls `visit` with runs of consecutive entries of weight · (part of v at a point), each with its first unknown.
    pub fn each_at(&self, part: Derivative<D>, point: [f64; D], weight: f64, mut visit: impl FnMut(usize, &[f64])) {
        let splines = &self.fields[part.field];
        let values: [(usize, [f64; WIDTH]); D] =
            std::array::from_fn(|axis| splines[axis].at(point[axis], part.derivatives[axis]));
        let of_field = self.first(part.field);
        // Loops over the functions of all axes but the last; the functions of the last axis are one run.
        let (last, count) = (&values[D - 1], splines[D - 1].functions());
        for before in indices::<D>(std::array::from_fn(|axis| 0..if axis + 1 < D { WIDTH } else { 1 })) {
            let (mut number, mut factor) = (0, weight);
            for (axis, place) in before.into_iter().enumerate().take(D - 1) {
                number = number * splines[axis].functions() + values[axis].0 + place;
                factor *= values[axis].1[place];
            }
            if factor != 0.0 {
                let line = last.1.map(|value| factor * value);
                visit(of_field + number * count + last.0, &line[..WIDTH.min(count - last.0)]);
            }
        }
    }
}

/// Number of pairs of functions that terms couple: exact if all terms couple the same ones, otherwise an estimate.
fn coupled<const D: usize>(terms: &[Term<D>], integrals: &Integrals) -> usize {
    let along = |axis: usize| {
        let of_term = |term: &Term<D>| integrals.products(term.axes[axis]).met.iter().map(Range::len).sum::<usize>();
        terms.iter().map(of_term).max().unwrap_or(0)
    };
    (0..D).map(along).product()
}

/// All indices within ranges; the last index runs fastest.
fn indices<const D: usize>(ranges: [Range<usize>; D]) -> impl Iterator<Item = [usize; D]> {
    let first = ranges.each_ref().map(|range| range.start);
    let mut next = ranges.iter().all(|range| !range.is_empty()).then_some(first);
    std::iter::from_fn(move || {
        let index = next?;
        next = (0..D).rev().find(|axis| index[*axis] + 1 < ranges[*axis].end).map(|raised| {
            std::array::from_fn(|axis| match axis.cmp(&raised) {
                Ordering::Less => index[axis],
                Ordering::Equal => index[axis] + 1,
                Ordering::Greater => first[axis],
            })
        });
        Some(index)
    })
}

/// Range from the first to the last non-zero value.
fn within_ends(values: &[f64]) -> Range<usize> {
    let first = values.iter().position(|v| *v != 0.0);
    first.map_or(0..0, |first| first..values.iter().rposition(|v| *v != 0.0).unwrap_or(first) + 1)
}

#[cfg(test)]
mod tests;
