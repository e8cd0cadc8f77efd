//! Tensions at all points of a face at one step, in single precision.

use crate::space::evaluate::{ContactNow, Face};

use super::LANES;
use super::local::LocalRows;

/// Tensions over S at all points of a face, in single precision.
#[derive(Default)]
pub(super) struct Seen {
    /// √(d² + s²) at all sampled points, which faces share.
    roots: Vec<f32>,
    /// Filled up with −∞ to a multiple of [`LANES`].
    pub values: Vec<f32>,
    /// The largest of each [`SIFTED`] of them.
    tops: Vec<f32>,
    /// The largest of all.
    pub top: f32,
}

/// Values that are looked through together where one of them may be high, a multiple of [`LANES`].
const SIFTED: usize = 8 * LANES;

/// The larger one; the first where the second is NaN.
fn larger(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

impl Seen {
    /// Takes the stresses of a step.
    pub fn take(&mut self, column: &[f32]) {
        let sampled = column.len() / 3;
        let parts = column[sampled..2 * sampled].iter().zip(&column[2 * sampled..]);
        self.roots.clear();
        self.roots.extend(parts.map(|(d, s)| (d * d + s * s).sqrt()));
    }

    /// Looks at a face, whose stresses over the size S are parts of a column.
    pub fn look(&mut self, face: &Face, local: &LocalRows, (column, size): (&[f32], f64), contact: &ContactNow) {
        let (sampled, count) = (column.len() / 3, face.points.len());
        let [mean, half, shear] = [0, 1, 2].map(|part| &column[part * sampled + face.first..][..count]);
        let sign = face.sign as f32;
        self.values.clear();
        let roots = &self.roots[face.first..][..count];
        self.values.extend(mean.iter().zip(roots).map(|(m, root)| sign * m + root));
        if contact.force > 0.0 {
            for (point, more) in local.under(contact) {
                let of = |part: usize, stress: f32| f64::from(sign * stress) + more[part] / size;
                let [m, d, s] = [of(0, mean[point]), of(1, half[point]), of(2, shear[point])];
                let value = (m + (d * d + s * s).sqrt()) as f32;
                // What a small size takes out of range has all points looked at.
                self.values[point] = if value.is_nan() { f32::INFINITY } else { value };
            }
        }
        local.left_out.iter().for_each(|point| self.values[*point] = f32::NEG_INFINITY);
        self.values.resize(count.next_multiple_of(LANES), f32::NEG_INFINITY);
        self.tops.clear();
        self.tops.extend(self.values.chunks(SIFTED).map(top));
        self.top = self.tops.iter().copied().fold(f32::NEG_INFINITY, larger);
    }

    /// The points whose values are no lower than some value: few, where most are far below.
    pub fn from(&self, least: f32) -> Vec<usize> {
        let mut points = Vec::new();
        for (sift, many) in self.values.chunks(SIFTED).enumerate().filter(|(sift, _)| self.tops[*sift] >= least) {
            for (chunk, some) in many.chunks_exact(LANES).enumerate().filter(|(_, some)| top(some) >= least) {
                let those = some.iter().enumerate().filter(|(_, value)| **value >= least);
                points.extend(those.map(|(i, _)| SIFTED * sift + LANES * chunk + i));
            }
        }
        points
    }
}

/// The largest of values that are filled up to a multiple of [`LANES`]: side by side, for the processor's vectors.
fn top(values: &[f32]) -> f32 {
    let mut tops = [f32::NEG_INFINITY; LANES];
    for some in values.chunks_exact(LANES) {
        tops.iter_mut().zip(some).for_each(|(top, value)| *top = larger(*top, *value));
    }
    tops.into_iter().fold(f32::NEG_INFINITY, larger)
}

/// The largest tension at each point of a face over the steps so far, in single precision.
pub(super) struct Peaks {
    /// Pa, filled up as [`Seen::values`].
    pub tension: Vec<f32>,
    /// The numbers of the steps.
    pub steps: Vec<u32>,
}

impl Peaks {
    /// Of so many points, before the first step.
    pub fn new(count: usize) -> Self {
        let filled = count.next_multiple_of(LANES);
        Self { tension: vec![f32::NEG_INFINITY; filled], steps: vec![0; filled] }
    }

    /// Takes a step's tensions over a size, Pa.
    pub fn take(&mut self, values: &[f32], size: f32, step: u32) {
        for ((top, when), value) in self.tension.iter_mut().zip(&mut self.steps).zip(values) {
            let tension = value * size;
            // Both are written each time, so that the processor's vectors can.
            let is_larger = tension > *top;
            *when = if is_larger { step } else { *when };
            *top = if is_larger { tension } else { *top };
        }
    }

    /// Takes the tension at one point, Pa.
    pub fn raise(&mut self, point: usize, tension: f32, step: u32) {
        if tension > self.tension[point] {
            (self.tension[point], self.steps[point]) = (tension, step);
        }
    }
}
