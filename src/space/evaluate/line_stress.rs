//! Stresses at the crossings of lines on a face, from coefficients of splines: of these there are several times fewer than stresses.
//!
//! A spline is a product of functions along the axes, of which few are not zero at a place. So a body's coordinates give the coefficients,
//! by products of matrices, and the coefficients give the stresses axis by axis. Where the lines lie on both sides of a plane of symmetry, a
//! part of the stresses is the same on both but for its sign: it is computed on one.

use std::ops::Range;
use std::rc::Rc;

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::DMatrix;

use crate::form::spline::WIDTH;

use super::Map;

/// Steps whose stresses follow from their coefficients together: their numbers lie side by side.
pub const TOGETHER: usize = 8;

/// Numbers of steps that go together.
pub type Together = [f64; TOGETHER];

/// The functions of an axis at a place: those that are not zero there, from a first one on.
#[derive(Debug, Clone, Copy)]
pub struct AtPlace {
    /// The first one's number.
    pub first: usize,
    /// How many there are.
    pub count: usize,
    /// Their values, or those of a derivative.
    pub values: [f64; WIDTH],
}

/// Lines across an axis.
#[derive(Debug, Clone, Default)]
pub struct Lines {
    /// Where splines are to be known, m.
    pub places: Vec<f64>,
    /// Each line's place by its number, and whether the line is that place's image.
    pub lines: Vec<(usize, bool)>,
}

/// A derivative of a field, and what it adds to the stresses.
#[derive(Debug, Clone)]
pub struct LinePart {
    /// The number of the field's coefficients among [`FaceLines::fields`].
    pub field: usize,
    /// Functions of the field along the second axis, which is the fastest.
    pub functions: usize,
    /// Of each place along both axes.
    pub along: [Vec<AtPlace>; 2],
    /// Along which axes images have the opposite sign.
    pub flips: [bool; 2],
    /// What it is multiplied with in σ_a, σ_b and σ_ab, Pa.
    pub stresses: [f64; 3],
}

/// How the stresses σ_a, σ_b and σ_ab at the crossings of lines along a face's axes a and b, the second's fastest, come of a body's unknowns.
#[derive(Debug, Clone)]
pub struct FaceLines {
    /// The unknowns that are the coefficients of each field.
    pub fields: Vec<Range<usize>>,
    /// What the stresses are sums of.
    pub parts: Vec<LinePart>,
    /// The lines along both axes.
    pub lines: [Lines; 2],
}

/// Such stresses of a body's coordinates.
#[derive(Clone)]
pub struct LineStresses {
    face: Rc<FaceLines>,
    /// How many coordinates there are.
    count: usize,
    /// Of each field.
    coefficients: Vec<Coefficients>,
    /// Crossings whose stresses are read otherwise, with these for 1 of each coordinate, a row each.
    apart: Vec<(usize, DMatrix<f64>)>,
}

/// The coefficients of a field.
#[derive(Clone)]
struct Coefficients {
    /// The coordinates that they depend on: those of one class of motions.
    coordinates: Vec<usize>,
    /// For 1 of each of these, a column each.
    columns: DMatrix<f64>,
}

impl Lines {
    /// At some places, m; `is_mirrored` where those below 0 are images.
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

    /// Sets the stresses at all crossings, from the coefficients of all fields.
    fn stresses(&self, coefficients: &[Together], at_places: &mut [[Together; 3]], stresses: &mut [[Together; 3]]) {
        stresses.fill([[0.0; TOGETHER]; 3]);
        for flips in [[false, false], [false, true], [true, false], [true, true]] {
            if self.parts.iter().any(|part| part.flips == flips) {
                let face = self;
                pulp::Arch::new().dispatch(PartsOfSigns { face, flips, coefficients, at_places, stresses });
            }
        }
    }

    /// The sum of the parts of the same signs at all places.
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

    /// Adds what is at the places to the stresses on the lines.
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

/// Adds the parts of the same signs: compiled for the vectors of each kind of processor.
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
    /// Of a matrix without the columns that are zero.
    fn new(coordinates: impl Iterator<Item = usize>, columns: &DMatrix<f64>) -> Self {
        let all: Vec<usize> = coordinates.collect();
        let used: Vec<usize> = (0..all.len()).filter(|k| columns.column(*k).amax() > 0.0).collect();
        Self { coordinates: used.iter().map(|k| all[*k]).collect(), columns: columns.select_columns(&used) }
    }

    /// A column for each coefficient, a row for each of some steps.
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
    /// On a basis: vector by vector the values of all unknowns; `apart` are crossings that are read by forms on that basis, three each.
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

    /// How many coordinates there are.
    pub fn coordinates(&self) -> usize {
        self.count
    }

    /// How many crossings there are.
    pub fn crossings(&self) -> usize {
        self.face.crossings()
    }

    /// The same of other coordinates, a column each of what they are of these ones.
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

    /// Hands over the stresses of some steps, of their coordinates one step after the other: eight steps at a time, of which
    /// the last ones may be fewer.
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
                // (Whole ones are copied without a call.)
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

    /// As forms on the coordinates, which are zero at the crossings that are left out.
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

    /// The stresses of one step, crossing by crossing.
    pub fn apply(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut all = Vec::with_capacity(3 * self.crossings());
        self.each(coordinates, |_, stresses| {
            all.extend(stresses.iter().flatten().map(|together| together[0]));
        });
        all
    }
}
