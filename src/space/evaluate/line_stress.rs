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

    /// Computes the stresses at all crossings from the coefficients of all fields.
    fn stresses(&self, coefficients: &[Together], at_places: &mut [[Together; 3]], stresses: &mut [[Together; 3]]) {
        stresses.fill([[0.0; TOGETHER]; 3]);
        for flips in [[false, false], [false, true], [true, false], [true, true]] {
            if self.parts.iter().any(|part| part.flips == flips) {
                let face = self;
                pulp::Arch::new().dispatch(PartsOfSigns { face, flips, coefficients, at_places, stresses });
            }
        }
    }

    /// Sums the terms with the same signs at all coordinates.
    #[inline(always)]
    fn sum(&self, flips: [bool; 2], coefficients: &[Together], at_places: &mut [[Together; 3]]) {
        at_places.fill([[0.0; TOGETHER]; 3]);
        let mut across: Vec<Together> = Vec::new();
        for part in self.parts.iter().filter(|part| part.flips == flips) {
            let first: usize = self.fields[..part.field].iter().map(Range::len).sum();
            let of_field = &coefficients[first..first + self.fields[part.field].len()];
            let [a, b] = &part.along;
            for (of_line, at_a) in at_places.chunks_exact_mut(b.len()).zip(a) {
                across.clear();
                across.resize(part.functions, [0.0; TOGETHER]);
                for (row, value) in
                    of_field[at_a.first * part.functions..].chunks_exact(part.functions).zip(at_a.used())
                {
                    across.iter_mut().zip(row).for_each(|(sum, row)| add(sum, *value, row));
                }
                for (stresses, at_b) in of_line.iter_mut().zip(b) {
                    let mut sum = [0.0; TOGETHER];
                    across[at_b.first..].iter().zip(at_b.used()).for_each(|(few, value)| add(&mut sum, *value, few));
                    for (stress, factor) in stresses.iter_mut().zip(part.stresses) {
                        if factor != 0.0 {
                            add(stress, factor, &sum);
                        }
                    }
                }
            }
        }
    }

    /// Adds the values at the coordinates to the stresses on the lines.
    #[inline(always)]
    fn spread(&self, flips: [bool; 2], at_places: &[[Together; 3]], stresses: &mut [[Together; 3]]) {
        let [a, b] = &self.lines;
        let sign = |is_image: bool, flips: bool| if is_image && flips { -1.0 } else { 1.0 };
        for ((place_a, is_image_a), of_line) in a.lines.iter().zip(stresses.chunks_exact_mut(b.lines.len())) {
            let at_places = &at_places[place_a * b.places.len()..(place_a + 1) * b.places.len()];
            for ((place_b, is_image_b), stresses) in b.lines.iter().zip(of_line) {
                let sign = sign(*is_image_a, flips[0]) * sign(*is_image_b, flips[1]);
                stresses.iter_mut().zip(&at_places[*place_b]).for_each(|(stress, more)| add(stress, sign, more));
            }
        }
    }
}

/// Task that adds the terms with the same signs. It is compiled for the vector units of each kind of processor.
struct PartsOfSigns<'a> {
    face: &'a FaceLines,
    flips: [bool; 2],
    coefficients: &'a [Together],
    at_places: &'a mut [[Together; 3]],
    stresses: &'a mut [[Together; 3]],
}

impl pulp::NullaryFnOnce for PartsOfSigns<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.face.sum(self.flips, self.coefficients, self.at_places);
        self.face.spread(self.flips, self.at_places, self.stresses);
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
    (0..TOGETHER).for_each(|i| sum[i] += factor * more[i]);
}

impl Coefficients {
    /// Coefficients from a matrix, without its zero columns.
    fn new(coordinates: impl Iterator<Item = usize>, columns: &DMatrix<f64>) -> Self {
        let all: Vec<usize> = coordinates.collect();
        let used: Vec<usize> = (0..all.len()).filter(|k| columns.column(*k).amax() > 0.0).collect();
        Self { coordinates: used.iter().map(|k| all[*k]).collect(), columns: columns.select_columns(&used) }
    }

    /// Coefficients as a matrix with a column for each coefficient and a row for each step.
    fn of_steps(&self, (count, steps): (usize, usize), coordinates: &[f64]) -> Vec<f64> {
        let (rows, own) = (self.columns.nrows(), self.coordinates.len());
        let each = coordinates.chunks_exact(count).flat_map(|all| self.coordinates.iter().map(|k| all[*k]));
        let used: Vec<f64> = each.collect();
        let mut products = vec![0.0; rows * steps];
        let of_steps = MatRef::from_column_major_slice(&used, own, steps);
        let of_rows = MatRef::from_column_major_slice(self.columns.as_slice(), rows, own);
        let into = MatMut::from_column_major_slice_mut(&mut products, steps, rows);
        matmul(into, Accum::Replace, of_steps.transpose(), of_rows.transpose(), 1.0, Par::Seq);
        products
    }
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

    /// Calls `visit` with the number of steps and their stresses, for eight steps at a time; the last call may have
    /// fewer. `coordinates` holds the coordinates step by step.
    pub fn each(&self, coordinates: &[f64], mut visit: impl FnMut(usize, &[[Together; 3]])) {
        let steps = coordinates.len() / self.count.max(1);
        let of_steps = |field: &Coefficients| field.of_steps((self.count, steps), coordinates);
        let products: Vec<Vec<f64>> = self.coefficients.iter().map(of_steps).collect();
        let places = self.face.lines[0].places.len() * self.face.lines[1].places.len();
        let mut at_places = vec![[[0.0; TOGETHER]; 3]; places];
        let mut stresses = vec![[[0.0; TOGETHER]; 3]; self.crossings()];
        let mut together: Vec<Together> = Vec::new();
        for begin in (0..steps).step_by(TOGETHER) {
            let some = TOGETHER.min(steps - begin);
            together.clear();
            let of_rows = products.iter().flat_map(|products| products.chunks_exact(steps));
            together.extend(of_rows.map(|of_row| {
                let rest = &of_row[begin..];
                // A full chunk is copied without a function call.
                let few = || std::array::from_fn(|i| rest.get(i).copied().unwrap_or_default());
                rest.first_chunk().copied().unwrap_or_else(few)
            }));
            self.face.stresses(&together, &mut at_places, &mut stresses);
            for (crossing, rows) in &self.apart {
                for step in 0..some {
                    let own = &coordinates[(begin + step) * self.count..(begin + step + 1) * self.count];
                    for (component, row) in rows.row_iter().enumerate() {
                        stresses[*crossing][component][step] = row.iter().zip(own).map(|(a, b)| a * b).sum();
                    }
                }
            }
            visit(some, &stresses);
        }
    }

    /// The stresses as forms on the coordinates. The forms are zero at the crossings that are left out.
    pub fn dense(&self, left_out: &[bool]) -> Map {
        let count = self.count;
        let mut entries = vec![0.0; 3 * self.crossings() * count];
        let mut first = 0;
        self.each(DMatrix::<f64>::identity(count, count).as_slice(), |some, stresses| {
            let crossings = entries.chunks_exact_mut(3 * count).zip(stresses).zip(left_out);
            for ((rows, stresses), _) in crossings.filter(|(_, is_left_out)| !**is_left_out) {
                for (row, together) in rows.chunks_exact_mut(count).zip(stresses) {
                    row[first..first + some].copy_from_slice(&together[..some]);
                }
            }
            first += some;
        });
        Map::Dense(count, entries)
    }

    /// Stresses of one step, crossing by crossing.
    pub fn apply(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut all = Vec::with_capacity(3 * self.crossings());
        self.each(coordinates, |_, stresses| {
            all.extend(stresses.iter().flatten().map(|together| together[0]));
        });
        all
    }
}
