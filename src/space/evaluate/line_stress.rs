//! Stresses at the crossings of lines on a face, computed from spline coefficients, which are several times fewer than
//! the stresses.
//!
//! A spline is a product of functions along the axes; only a few functions are non-zero at a position. The coordinates
//! of the body give the coefficients by matrix products, and the coefficients give the stresses axis by axis. If the
//! lines lie on both sides of a plane of symmetry, a term of the stresses is the same on both sides up to its sign, and
//! is computed on one side only.

use std::ops::Range;
use std::rc::Rc;

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::DMatrix;

use crate::form::spline::WIDTH;

use super::Map;

/// Number of steps whose stresses are computed together; their values are adjacent in memory.
pub const TOGETHER: usize = 8;

/// Number of steps whose coefficients are computed at once. The matrix from coordinates to coefficients is larger than
/// the cache, and is read once for all of them.
const BLOCK: usize = 256;

/// Distance of the columns of coefficients. At distances that are powers of two, columns compete for the same places of
/// the cache.
const STRIDE: usize = BLOCK + TOGETHER;

/// Values of several steps that are computed together.
pub type Together = [f64; TOGETHER];

/// Functions of an axis that are non-zero at a position; their numbers are consecutive.
#[derive(Debug, Clone, Copy)]
pub struct AtPlace {
    /// Number of the first function.
    pub first: usize,
    /// Number of functions.
    pub count: usize,
    /// Values of the functions or of a derivative.
    pub values: [f64; WIDTH],
}

/// Lines normal to an axis.
#[derive(Debug, Clone, Default)]
pub struct Lines {
    /// Coordinates at which splines are evaluated, m.
    pub places: Vec<f64>,
    /// For each line, the number of its coordinate in `places`, and whether the line is the mirror image of that
    /// coordinate.
    pub lines: Vec<(usize, bool)>,
}

/// A derivative of a field, and its contribution to the stresses.
#[derive(Debug, Clone)]
pub struct LinePart {
    /// Number of the coefficients of the field in [`FaceLines::fields`].
    pub field: usize,
    /// Number of functions of the field along the second axis, whose index varies fastest.
    pub functions: usize,
    /// Functions at each coordinate along both axes.
    pub along: [Vec<AtPlace>; 2],
    /// Axes along which the value at a mirror image has the opposite sign.
    pub flips: [bool; 2],
    /// Factors in σ_a, σ_b and σ_ab, Pa.
    pub stresses: [f64; 3],
}

/// Stresses σ_a, σ_b and σ_ab at the crossings of lines along the axes a and b of a face, as functions of the unknowns
/// of a body. Crossings are numbered with the second axis fastest.
#[derive(Debug, Clone)]
pub struct FaceLines {
    /// Unknowns that are the coefficients of each field.
    pub fields: Vec<Range<usize>>,
    /// Terms of the stresses.
    pub parts: Vec<LinePart>,
    /// Lines along both axes.
    pub lines: [Lines; 2],
}

/// Stresses on lines as functions of the coordinates of a body.
#[derive(Clone)]
pub struct LineStresses {
    face: Rc<FaceLines>,
    /// Number of coordinates.
    count: usize,
    /// Coefficients of each field.
    coefficients: Vec<Coefficients>,
    /// Crossings whose stresses are evaluated separately; for each, a matrix with a row for each stress component and a
    /// column for each coordinate.
    apart: Vec<(usize, DMatrix<f64>)>,
}

/// Coefficients of a field as functions of the coordinates.
#[derive(Clone)]
struct Coefficients {
    /// Coordinates of one symmetry class, on which they depend.
    coordinates: Vec<usize>,
    /// A column of coefficients for a unit value of each of these coordinates.
    columns: DMatrix<f64>,
}

impl Lines {
    /// Lines at some coordinates, m. If `is_mirrored`, those below 0 are mirror images.
    pub fn new(at: &[f64], is_mirrored: bool) -> Self {
        let mut all = Self::default();
        for &x in at {
            let is_image = is_mirrored && x < 0.0;
            let place = if is_image { -x } else { x };
            let known = all.places.iter().position(|known| *known == place);
            if known.is_none() {
                all.places.push(place);
            }
            all.lines.push((known.unwrap_or(all.places.len() - 1), is_image));
        }
        all
    }
}

impl FaceLines {
    fn crossings(&self) -> usize {
        self.lines[0].lines.len() * self.lines[1].lines.len()
    }

    /// Coefficients of the field of a part.
    fn of_field<'a>(&self, part: &LinePart, coefficients: &'a [Together]) -> &'a [Together] {
        let first: usize = self.fields[..part.field].iter().map(Range::len).sum();
        &coefficients[first..first + self.fields[part.field].len()]
    }

    /// Writes the stresses at all crossings.
    #[inline(always)]
    fn write_stresses(&self, coefficients: &[Together], all: &mut [[Together; 3]]) {
        let [a, b] = &self.lines;
        // The terms with the same signs at mirror images are summed first.
        let flips = [[false, false], [false, true], [true, false], [true, true]];
        let flips: Vec<[bool; 2]> =
            flips.into_iter().filter(|flips| self.parts.iter().any(|part| part.flips == *flips)).collect();
        let places = b.places.len();
        let mut sums = vec![[[0.0; TOGETHER]; 3]; flips.len() * places];
        let mut across: Vec<Together> = Vec::new();
        for place in 0..a.places.len() {
            sums.fill([[0.0; TOGETHER]; 3]);
            for (flips, sums) in flips.iter().zip(sums.chunks_exact_mut(places)) {
                for part in self.parts.iter().filter(|part| part.flips == *flips) {
                    part.add(place, self.of_field(part, coefficients), &mut across, sums);
                }
            }
            for (line, (_, is_image)) in a.lines.iter().enumerate().filter(|(_, (of, _))| *of == place) {
                let of_line = &mut all[line * b.lines.len()..][..b.lines.len()];
                for ((place, is_image_b), stresses) in b.lines.iter().zip(of_line) {
                    let mut sum = [[0.0; TOGETHER]; 3];
                    for (flips, sums) in flips.iter().zip(sums.chunks_exact(places)) {
                        let sign = sign(*is_image, flips[0]) * sign(*is_image_b, flips[1]);
                        for (sum, more) in sum.iter_mut().zip(&sums[*place]) {
                            add(sum, sign, more);
                        }
                    }
                    *stresses = sum;
                }
            }
        }
    }
}

/// Sign of a term at a mirror image.
#[inline(always)]
fn sign(is_image: bool, flips: bool) -> f64 {
    if is_image && flips { -1.0 } else { 1.0 }
}

impl LinePart {
    /// Adds the contribution to the stresses at all coordinates along the second axis, for one along the first.
    #[inline(always)]
    fn add(&self, place: usize, of_field: &[Together], across: &mut Vec<Together>, sums: &mut [[Together; 3]]) {
        let at_a = &self.along[0][place];
        let of_rows = &of_field[at_a.first * self.functions..][..at_a.count * self.functions];
        across.clear();
        for function in 0..self.functions {
            let mut sum = [0.0; TOGETHER];
            for (row, value) in of_rows.chunks_exact(self.functions).zip(at_a.used()) {
                add(&mut sum, *value, &row[function]);
            }
            across.push(sum);
        }
        for (stresses, at_b) in sums.iter_mut().zip(&self.along[1]) {
            let mut sum = [0.0; TOGETHER];
            for (few, value) in across[at_b.first..].iter().zip(at_b.used()) {
                add(&mut sum, *value, few);
            }
            for (stress, factor) in stresses.iter_mut().zip(self.stresses) {
                if factor != 0.0 {
                    add(stress, factor, &sum);
                }
            }
        }
    }
}

impl AtPlace {
    #[inline(always)]
    fn used(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

#[inline(always)]
fn add(sum: &mut Together, factor: f64, more: &Together) {
    for (sum, more) in sum.iter_mut().zip(more) {
        *sum += factor * more;
    }
}

impl Coefficients {
    /// Coefficients from a matrix, without its zero columns.
    fn new(coordinates: impl Iterator<Item = usize>, columns: &DMatrix<f64>) -> Self {
        let all: Vec<usize> = coordinates.collect();
        let used: Vec<usize> = (0..all.len()).filter(|k| columns.column(*k).amax() > 0.0).collect();
        Self { coordinates: used.iter().map(|k| all[*k]).collect(), columns: columns.select_columns(&used) }
    }

    /// Computes the coefficients of at most [`BLOCK`] steps from `count` coordinates each.
    fn of_steps(&self, count: usize, coordinates: &[f64], into: &mut Products) {
        let Products { used, columns } = into;
        let (steps, rows, own) = (coordinates.len() / count, self.columns.nrows(), self.coordinates.len());
        used.clear();
        for of_step in coordinates.chunks_exact(count) {
            used.extend(self.coordinates.iter().map(|k| of_step[*k]));
        }
        columns.resize(rows * STRIDE, 0.0);
        let of_steps = MatRef::from_column_major_slice(used, own, steps);
        let of_rows = MatRef::from_column_major_slice(self.columns.as_slice(), rows, own);
        let product = MatMut::from_column_major_slice_with_stride_mut(columns, steps, rows, STRIDE);
        matmul(product, Accum::Replace, of_steps.transpose(), of_rows.transpose(), 1.0, Par::Seq);
    }
}

/// Coefficients of a field at some steps.
#[derive(Default)]
struct Products {
    /// Coordinates on which they depend, step by step.
    used: Vec<f64>,
    /// A column for each coefficient, with a row for each step; the columns begin [`STRIDE`] entries apart.
    columns: Vec<f64>,
}

impl LineStresses {
    /// Stresses for the coordinates of a basis. Each basis vector holds the values of all unknowns. `apart` lists
    /// crossings that are evaluated by three forms on that basis.
    pub fn new(face: FaceLines, apart: Vec<(usize, Map)>, basis: &[Vec<f64>]) -> Self {
        let of_field = |field: &Range<usize>| {
            let columns = DMatrix::from_fn(field.len(), basis.len(), |row, vector| basis[vector][field.start + row]);
            Coefficients::new(0..basis.len(), &columns)
        };
        let coefficients = face.fields.iter().map(of_field).collect();
        let dense = |(crossing, map)| match map {
            Map::Dense(count, entries) => Some((crossing, DMatrix::from_row_slice(3, count, &entries))),
            Map::Sparse(_) => None,
        };
        let apart = apart.into_iter().filter_map(dense).collect();
        Self { face: Rc::new(face), count: basis.len(), coefficients, apart }
    }

    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.count
    }

    /// Number of crossings.
    pub fn crossings(&self) -> usize {
        self.face.crossings()
    }

    /// The same stresses as functions of new coordinates. Each column of `shapes` holds the present coordinates for a
    /// unit value of a new one.
    pub fn mapped(&self, shapes: &DMatrix<f64>) -> Self {
        let of_field = |Coefficients { coordinates, columns }: &Coefficients| {
            let shapes = Coefficients::new(0..shapes.ncols(), &shapes.select_rows(coordinates));
            Coefficients { columns: columns * shapes.columns, coordinates: shapes.coordinates }
        };
        Self {
            face: self.face.clone(),
            count: shapes.ncols(),
            coefficients: self.coefficients.iter().map(of_field).collect(),
            apart: self.apart.iter().map(|(crossing, rows)| (*crossing, rows * shapes)).collect(),
        }
    }

    /// Calls `visit` with up to eight steps at a time. `coordinates` holds the coordinates step by step.
    pub fn each(&self, coordinates: &[f64], mut visit: impl FnMut(&StepsTogether)) {
        let count = self.count.max(1);
        let mut products: Vec<Products> = self.coefficients.iter().map(|_| Products::default()).collect();
        let mut coefficients: Vec<Together> = Vec::new();
        for coordinates in coordinates.chunks(BLOCK * count) {
            for (field, products) in self.coefficients.iter().zip(&mut products) {
                field.of_steps(count, coordinates, products);
            }
            for (begin, coordinates) in coordinates.chunks(TOGETHER * count).enumerate() {
                coefficients.clear();
                for Products { columns, .. } in &products {
                    // Beyond the last step, columns hold no values.
                    let of_column =
                        |column: &[f64]| column[TOGETHER * begin..].first_chunk().copied().unwrap_or_default();
                    coefficients.extend(columns.chunks_exact(STRIDE).map(of_column));
                }
                visit(&StepsTogether { lines: self, coordinates, coefficients: &coefficients });
            }
        }
    }

    /// Writes the stresses at some of the crossings as forms on the coordinates. `rows` holds three forms for each
    /// crossing.
    pub fn write_forms(&self, is_wanted: impl Fn(usize) -> bool, rows: &mut [f64]) {
        let (count, mut first) = (self.count, 0);
        self.each(DMatrix::<f64>::identity(count, count).as_slice(), |together| {
            let (some, stresses) = (together.steps(), together.stresses());
            let crossings = rows.chunks_exact_mut(3 * count).zip(&stresses).enumerate();
            for (_, (rows, stresses)) in crossings.filter(|(crossing, _)| is_wanted(*crossing)) {
                for (row, together) in rows.chunks_exact_mut(count).zip(stresses) {
                    row[first..first + some].copy_from_slice(&together[..some]);
                }
            }
            first += some;
        });
    }

    /// Stresses of one step, crossing by crossing.
    pub fn apply(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut all = Vec::with_capacity(3 * self.crossings());
        self.each(coordinates, |together| {
            all.extend(together.stresses().iter().flatten().map(|together| together[0]));
        });
        all
    }
}

/// Up to eight steps whose stresses on lines are computed together.
pub struct StepsTogether<'a> {
    lines: &'a LineStresses,
    /// Coordinates of the steps, step by step.
    coordinates: &'a [f64],
    /// Coefficients of all fields.
    coefficients: &'a [Together],
}

impl StepsTogether<'_> {
    /// Number of steps.
    pub fn steps(&self) -> usize {
        self.coordinates.len() / self.lines.count.max(1)
    }

    /// Coordinates of each step.
    pub fn coordinates(&self) -> impl Iterator<Item = &[f64]> {
        self.coordinates.chunks_exact(self.lines.count.max(1))
    }

    /// Stresses at all crossings, Pa. If there are fewer than eight steps, the values of the others have no meaning.
    pub fn stresses(&self) -> Vec<[Together; 3]> {
        let mut all = vec![[[0.0; TOGETHER]; 3]; self.lines.crossings()];
        // Compiled for the vector units of each kind of processor.
        pulp::Arch::new().dispatch(|| self.lines.face.write_stresses(self.coefficients, &mut all));
        for (crossing, rows) in &self.lines.apart {
            for (step, own) in self.coordinates().enumerate() {
                products(rows, own).into_iter().enumerate().for_each(|(i, stress)| all[*crossing][i][step] = stress);
            }
        }
        all
    }
}

/// Products of the three rows of a matrix with coordinates.
fn products(rows: &DMatrix<f64>, coordinates: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|component| rows.row(component).iter().zip(coordinates).map(|(a, b)| a * b).sum())
}
