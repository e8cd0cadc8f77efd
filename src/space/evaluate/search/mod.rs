//! The largest tensions of many steps at once, on the faces of a box that moves in few coordinates.
//!
//! At most steps all but a few points of a face are far below its largest tension. Therefore the stresses at all points are computed in
//! single precision, as one product of matrices for a block of steps, and in double precision at those points alone whose tension is
//! the largest or may be, by a bound of the rounding: what is found is what a search of all points in double precision finds.
//!
//! *The bound.* Coordinates w_i are scaled by ρ_i, the largest stress at any point for w_i = 1, and by S = Σ ρ_i |w_i|. Then each stress
//! over S is a sum of n products whose absolute values sum to 1 at most; in arithmetic of unit roundoff u it is off by (n + 4) u at most,
//! roundings of the factors included (Higham, Accuracy and Stability of Numerical Algorithms, §3.1). The principal stress m + √(d² + s²) is off by no more than the
//! errors of m, d and s together, and by its own few roundings.
//!
//! *The map.* The same values, times S, give the largest tension over time at each point, within the bound. At the point of a step's largest
//! tension on a face the one found in double precision counts, between the points too: the largest value of the map is that of the history.

mod local;
mod seen;

use nalgebra::{DMatrix, Dyn, MatrixView};

use super::faces::ALIKE;
use super::{ContactNow, FaceStresses, FaceTension, TensionMap};
use local::{LocalRows, parts};
use seen::{Peaks, Seen};

/// Steps whose stresses are computed at once: they stay in the cache.
const BLOCK: usize = 64;

/// Values of which the largest is kept together, a power of two for the processor's vectors.
const LANES: usize = 16;

/// Unit roundoff of single precision.
const ROUNDOFF: f64 = 0.5 * f32::EPSILON as f64;

/// Roundings of a principal stress of its three parts, with room.
const OF_PRINCIPAL: f64 = 32.0;

/// A search on all faces of a box.
pub struct TensionSearch<'a> {
    faces: &'a FaceStresses,
    /// What the local fields add at points near the hit, face by face.
    local: Vec<LocalRows>,
    /// How many coordinates there are.
    count: usize,
    /// Stresses a, b and ab at the sampled points for 1 of each coordinate, a row each.
    rows: Vec<f64>,
    /// ρ.
    scales: Vec<f64>,
    /// For 1/ρ of each coordinate, a column each: (a + b)/2 of all sampled points, then (a − b)/2, then ab.
    scaled: DMatrix<f32>,
}

/// What a search has found.
pub struct Searched {
    /// The largest tension on each face, step by step.
    pub steps: Vec<Vec<FaceTension>>,
    /// Of each face.
    peaks: Vec<Peaks>,
    /// Points of each face.
    counts: Vec<usize>,
}

impl Searched {
    /// The largest tension over all steps at each point, of the times of the steps, s.
    pub fn map(&self, times: &[f64]) -> TensionMap {
        let (mut tension, mut time) = (Vec::new(), Vec::new());
        for (peaks, &count) in self.peaks.iter().zip(&self.counts) {
            tension.extend_from_slice(&peaks.tension[..count]);
            time.extend(peaks.steps[..count].iter().map(|step| times[*step as usize]));
        }
        TensionMap::of_steps(tension, time)
    }
}

impl<'a> TensionSearch<'a> {
    /// Of stresses for 1 of each of `count` coordinates at the sampled points, a row for each component a, b and ab; `None` but for faces of
    /// a box.
    pub fn new(faces: &'a FaceStresses, count: usize, rows: Vec<f64>) -> Option<Self> {
        let local = faces.faces.iter().map(LocalRows::new).collect::<Option<Vec<_>>>()?;
        if faces.map.components() != 3 || count == 0 {
            return None;
        }
        let sampled = rows.len() / (3 * count);
        let of_point = |point: usize, coordinate: usize| {
            parts([0, 1, 2].map(|component| rows[(3 * point + component) * count + coordinate]))
        };
        let scale = |coordinate: usize| {
            let largest = (0..sampled).flat_map(|point| of_point(point, coordinate)).map(f64::abs);
            largest.fold(0.0, f64::max)
        };
        let scales: Vec<f64> = (0..count).map(scale).collect();
        let mut scaled = DMatrix::zeros(3 * sampled, count);
        for (coordinate, scale) in scales.iter().enumerate().filter(|(_, scale)| **scale > 0.0) {
            for point in 0..sampled {
                for (part, stress) in of_point(point, coordinate).into_iter().enumerate() {
                    scaled[(part * sampled + point, coordinate)] = (stress / scale) as f32;
                }
            }
        }
        Some(Self { faces, local, count, rows, scales, scaled })
    }

    /// The largest tension on each face at some steps, of their coordinates, one step after the other, and contacts.
    pub fn tensions(&self, coordinates: &[f64], contacts: &[ContactNow]) -> Searched {
        let mut steps = Vec::with_capacity(contacts.len());
        let mut peaks: Vec<Peaks> = self.faces.faces.iter().map(|face| Peaks::new(face.points.len())).collect();
        let mut seen = Seen::default();
        for (coordinates, contacts) in coordinates.chunks(BLOCK * self.count).zip(contacts.chunks(BLOCK)) {
            let (mut sizes, mut scaled) = (Vec::with_capacity(BLOCK), Vec::with_capacity(coordinates.len()));
            for of_step in coordinates.chunks(self.count) {
                let size: f64 = of_step.iter().zip(&self.scales).map(|(w, scale)| (w * scale).abs()).sum();
                let over = if size > 0.0 { size } else { 1.0 };
                scaled.extend(of_step.iter().zip(&self.scales).map(|(w, scale)| (w * scale / over) as f32));
                sizes.push(size);
            }
            let all = &self.scaled * MatrixView::<f32, Dyn, Dyn>::from_slice(&scaled, self.count, contacts.len());
            for (step, contact) in contacts.iter().enumerate() {
                let of_step = &coordinates[step * self.count..(step + 1) * self.count];
                let column = all.column(step);
                let (step, number) = ((column.as_slice(), sizes[step]), steps.len() as u32);
                seen.take(step.0);
                let faces = self.faces.faces.iter().zip(&self.local).zip(&mut peaks);
                let each = faces.map(|((face, local), peaks)| {
                    seen.look(face, local, step, contact);
                    let value = |point: usize| match face.left_out[point] {
                        true => f64::NAN,
                        false => face.value(point, &self.sampled(face.first + point, of_step), contact),
                    };
                    let size = step.1;
                    let (point, found) = if size > f64::MIN_POSITIVE && seen.top.is_finite() {
                        peaks.take(&seen.values, size as f32, number);
                        let bound = self.bound(seen.top);
                        // (Points that are left out have no tension.)
                        face.largest(seen.from(seen.top - bound).into_iter(), value)
                    } else {
                        // Without a size, as at rest, single precision tells nothing.
                        let values: Vec<f64> = (0..face.points.len()).map(value).collect();
                        values.iter().enumerate().for_each(|(point, value)| peaks.raise(point, *value as f32, number));
                        face.largest(face.read_points(), |point| values[point])
                    };
                    peaks.raise(point, found.largest as f32, number);
                    found
                });
                steps.push(each.collect());
            }
        }
        let counts = self.faces.faces.iter().map(|face| face.points.len()).collect();
        Searched { steps, peaks, counts }
    }

    /// By how much a tension over S that was the largest may lie below the highest one seen.
    fn bound(&self, top: f32) -> f32 {
        let error = (3.0 * (self.count as f64 + 4.0) + OF_PRINCIPAL) * ROUNDOFF;
        // Both may be off; and points count as alike that differ by a part.
        let of_top = (2.0 * ALIKE + OF_PRINCIPAL * ROUNDOFF) * f64::from(top.abs()).max(1.0);
        (2.0 * error + of_top) as f32
    }

    /// Stresses at a sampled point in double precision.
    fn sampled(&self, number: usize, coordinates: &[f64]) -> [f64; 3] {
        let rows = &self.rows[3 * number * self.count..3 * (number + 1) * self.count];
        let [a, rest] = [&rows[..self.count], &rows[self.count..]];
        products([a, &rest[..self.count], &rest[self.count..]], coordinates)
    }
}

/// Σ a_i b_i of three rows, two sums each for the processor's vectors.
fn products(rows: [&[f64]; 3], b: &[f64]) -> [f64; 3] {
    rows.map(|row| {
        let (pairs, ends) = row.as_chunks::<2>();
        let (pairs_of_b, ends_of_b) = b.as_chunks::<2>();
        let mut sums = [0.0; 2];
        for (a, b) in pairs.iter().zip(pairs_of_b) {
            (0..2).for_each(|k| sums[k] += a[k] * b[k]);
        }
        let end: f64 = ends.iter().zip(ends_of_b).map(|(a, b)| a * b).sum();
        sums[0] + sums[1] + end
    })
}

#[cfg(test)]
mod tests;
