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

use nalgebra::{DMatrix, Dyn, MatrixView};

use crate::form::stress::place;
use crate::stack::PointField;

use super::faces::ALIKE;
use super::{ContactNow, Face, FaceGrid, FaceStresses, FaceTension};

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

/// What the local field adds on a face, as polynomials of the contact's radius.
struct LocalRows {
    /// Contact radius up to which they hold, m.
    largest: f64,
    /// How many coefficients each has.
    terms: usize,
    /// By point the coefficients for 1 N of (a + b)/2, (a − b)/2 and ab, Pa.
    points: Vec<(usize, Vec<[f64; 3]>)>,
}

impl LocalRows {
    /// `None` where fields are no such polynomials.
    fn new(face: &Face) -> Option<Self> {
        let FaceGrid { axes: [a, b], .. } = face.grid.as_ref()?;
        let mut rows = Self { largest: 1.0, terms: 0, points: Vec::new() };
        for (point, local) in &face.local {
            let (largest, coefficients) = local.polynomial()?;
            if !rows.points.is_empty() && largest != rows.largest {
                return None;
            }
            rows.largest = largest;
            rows.terms = rows.terms.max(coefficients.len());
            let parts = coefficients.iter().map(|all| parts([all[*a], all[*b], all[place(*a, *b)]]));
            rows.points.push((*point, parts.collect()));
        }
        Some(rows)
    }

    /// What is added at its points under a contact, in their order.
    fn under(&self, contact: &ContactNow) -> impl Iterator<Item = (usize, [f64; 3])> {
        let t = PointField::variable(contact.radius, self.largest);
        let mut polynomials = vec![contact.force, contact.force * t];
        for k in 2..self.terms {
            polynomials.push(2.0 * t * polynomials[k - 1] - polynomials[k - 2]);
        }
        self.points.iter().map(move |(point, coefficients)| {
            let mut sum = [0.0; 3];
            for (factor, of_degree) in polynomials.iter().zip(coefficients) {
                (0..3).for_each(|i| sum[i] += factor * of_degree[i]);
            }
            (*point, sum)
        })
    }
}

/// (a + b)/2, (a − b)/2 and ab of a, b and ab.
fn parts([a, b, ab]: [f64; 3]) -> [f64; 3] {
    [0.5 * (a + b), 0.5 * (a - b), ab]
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
    pub fn tensions(&self, coordinates: &[f64], contacts: &[ContactNow]) -> Vec<Vec<FaceTension>> {
        let mut found = Vec::with_capacity(contacts.len());
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
                let column = column.as_slice();
                seen.take(column);
                let each = self.faces.faces.iter().zip(&self.local).map(|(face, local)| {
                    seen.look(face, local, (column, sizes[step]), contact);
                    let bound = self.bound(seen.top);
                    let value = |point: usize| face.value(point, &self.sampled(face.first + point, of_step), contact);
                    let is_read = |point: &usize| face.left_out.get(*point) == Some(&false);
                    if sizes[step] > f64::MIN_POSITIVE && seen.top.is_finite() {
                        face.largest(seen.from(seen.top - bound).filter(is_read), value)
                    } else {
                        // Without a size, as at rest, single precision tells nothing.
                        face.largest((0..face.points.len()).filter(is_read), value)
                    }
                });
                found.push(each.collect());
            }
        }
        found
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
        [0, 1, 2].map(|component| {
            let start = (3 * number + component) * self.count;
            product(&self.rows[start..start + self.count], coordinates)
        })
    }
}

/// Σ a_i b_i, four sums at a time for the processor's vectors.
fn product(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let ends = a.chunks_exact(4).remainder().iter().zip(b.chunks_exact(4).remainder());
    let rest: f64 = ends.map(|(a, b)| a * b).sum();
    for (a, b) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
        (0..4).for_each(|i| sums[i] += a[i] * b[i]);
    }
    sums[0] + sums[1] + (sums[2] + sums[3]) + rest
}

/// Tensions over S at all points of a face, in single precision.
#[derive(Default)]
struct Seen {
    /// √(d² + s²) at all sampled points, which faces share.
    roots: Vec<f32>,
    /// Filled up with −∞ to a multiple of [`LANES`].
    values: Vec<f32>,
    /// The largest of all.
    top: f32,
}

/// The larger one; the first where the second is NaN.
fn larger(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

impl Seen {
    /// Takes the stresses of a step.
    fn take(&mut self, column: &[f32]) {
        let sampled = column.len() / 3;
        let parts = column[sampled..2 * sampled].iter().zip(&column[2 * sampled..]);
        self.roots.clear();
        self.roots.extend(parts.map(|(d, s)| (d * d + s * s).sqrt()));
    }

    /// Looks at a face, whose stresses over the size S are parts of a column.
    fn look(&mut self, face: &Face, local: &LocalRows, (column, size): (&[f32], f64), contact: &ContactNow) {
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
        let left_out = face.left_out.iter().zip(&mut self.values).filter(|(is_left_out, _)| **is_left_out);
        left_out.for_each(|(_, value)| *value = f32::NEG_INFINITY);
        self.values.resize(count.next_multiple_of(LANES), f32::NEG_INFINITY);
        // Side by side, for the processor's vectors.
        let mut tops = [f32::NEG_INFINITY; LANES];
        for some in self.values.chunks_exact(LANES) {
            tops.iter_mut().zip(some).for_each(|(top, value)| *top = larger(*top, *value));
        }
        self.top = tops.into_iter().fold(f32::NEG_INFINITY, larger);
    }

    /// The points whose values are no lower than some value.
    fn from(&self, least: f32) -> impl Iterator<Item = usize> {
        let has_one = move |some: &[f32]| some.iter().fold(false, |found, value| found | (*value >= least));
        let chunks = self.values.chunks_exact(LANES).enumerate().filter(move |(_, some)| has_one(some));
        chunks.flat_map(move |(chunk, some)| {
            let those = some.iter().enumerate().filter(move |(_, value)| **value >= least);
            those.map(move |(i, _)| LANES * chunk + i)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::Spread;
    use crate::space::evaluate::{LocalPoint, Map, StressMap};
    use crate::stack::{Carrier, Layer, LocalField, Pressure, Stack};

    /// Numbers between −1 and 1 without any order.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
        }
    }

    const COUNT: usize = 37;
    const LINES: usize = 19;

    /// A plate of bending stresses that vary over a face, hit at the corner of its quarter; stresses are symmetric in x and y, so that
    /// points that mirror each other have the same tension but for rounding.
    fn plate() -> (FaceStresses, Vec<f64>) {
        let lines: Vec<f64> = (0..LINES).map(|i| 0.05 * i as f64).collect();
        let points: Vec<[f64; 3]> = lines.iter().flat_map(|a| lines.iter().map(move |b| [*a, *b, 0.05])).collect();
        let layer = Layer { thickness: 0.1, young: 70e9, poisson: 0.23 };
        let pressure = Pressure::Spread { spread: Spread::new(0.0), radius: 0.1 };
        let carrier = Carrier::Plate { pressure, reading: 0.0 };
        let field = LocalField::new(Stack::new(&[layer]).expect("an elastic layer"), carrier, 0.04);
        let near = |point: &[f64; 3], depth: f64| {
            let radius = point[0].hypot(point[1]);
            let radial = if radius > 0.0 { [point[0] / radius, point[1] / radius, 0.0] } else { [1.0, 0.0, 0.0] };
            (radius < 0.2).then(|| LocalPoint::new(field.at(radius, depth), radial, [0.0, 0.0, -1.0]).without_ring())
        };
        let mut numbers = Numbers(7);
        let waves: Vec<[f64; 3]> =
            (0..COUNT).map(|_| [8.0 * numbers.next(), 8.0 * numbers.next(), 1e9 * numbers.next()]).collect();
        let row = |x: &[f64; 3], component: usize| -> Vec<f64> {
            let of_wave = |[p, q, size]: &[f64; 3]| {
                let along = |a: f64, b: f64| (p * a).cos() * (q * b).cos();
                let twist = (p * x[0]).sin() * (q * x[1]).sin() + (p * x[1]).sin() * (q * x[0]).sin();
                match component {
                    0 => size * (along(x[0], x[1]) + 0.3 * along(x[1], x[0])),
                    1 => size * (along(x[1], x[0]) + 0.3 * along(x[0], x[1])),
                    _ => 0.4 * size * twist,
                }
            };
            waves.iter().map(of_wave).collect()
        };
        let rows: Vec<f64> = points.iter().flat_map(|x| (0..3).flat_map(|c| row(x, c)).collect::<Vec<_>>()).collect();
        let face = |name: &str, sign: f64, depth: f64| Face {
            name: name.to_owned(),
            first: 0,
            local: points.iter().enumerate().filter_map(|(i, x)| Some((i, near(x, depth)?))).collect(),
            left_out: points.iter().map(|x| (0.0..0.08).contains(&(x[0].hypot(x[1]) - 1e-9))).collect(),
            sign,
            grid: Some(FaceGrid { axes: [0, 1], lines: [lines.clone(), lines.clone()], is_mirrored: [true; 2] }),
            points: points.clone(),
        };
        let faces = vec![face("upper", -1.0, 0.0), face("lower", 1.0, 0.1)];
        let map = StressMap::Forms { map: Map::Dense(COUNT, rows.clone()), components: 3 };
        (FaceStresses { columns: Vec::new(), map, faces }, rows)
    }

    /// Coordinates of steps: of all sizes, nothing at all, and one alone; under forces from nothing to most of the stress.
    fn steps() -> (Vec<f64>, Vec<ContactNow>) {
        let mut numbers = Numbers(11);
        let (mut coordinates, mut contacts) = (Vec::new(), Vec::new());
        for step in 0..300 {
            let size = match step % 7 {
                0 => 0.0,
                1 => 1e-60,
                2 => 1e-9,
                _ => 1.0,
            };
            for coordinate in 0..COUNT {
                let is_there = step % 7 != 3 || coordinate == step % COUNT;
                // (A coordinate's number is drawn whether it counts or not.)
                let number = numbers.next() / (1.0 + coordinate as f64);
                coordinates.push(if is_there { size * number } else { 0.0 });
            }
            let force = if step % 3 == 0 { 0.0 } else { 1e6 * (1.0 + numbers.next()) };
            contacts.push(ContactNow { force, radius: 0.02 * (1.0 + 1.2 * numbers.next().abs()) });
        }
        (coordinates, contacts)
    }

    /// The search of all points in double precision finds the same.
    #[test]
    fn what_is_found_is_what_a_search_of_all_points_finds() {
        let (faces, rows) = plate();
        let (coordinates, contacts) = steps();
        let search = TensionSearch::new(&faces, COUNT, rows).expect("faces of a box");
        let found = search.tensions(&coordinates, &contacts);
        assert_eq!(found.len(), contacts.len());
        let mut places = std::collections::BTreeSet::new();
        for (step, (found, contact)) in found.iter().zip(&contacts).enumerate() {
            let of_step = &coordinates[step * COUNT..(step + 1) * COUNT];
            let all = faces.tensions(&faces.map.apply(of_step), contact);
            for (one, other) in found.iter().zip(&all) {
                // Sums of some forty products in another order.
                let rounding = 1e-13 * search.scales.iter().zip(of_step).map(|(s, w)| (s * w).abs()).sum::<f64>();
                let rounding = rounding + 1e-13 * other.largest.abs();
                assert!((one.largest - other.largest).abs() <= rounding, "{step}: {one:?} {other:?}");
                let apart = (0..3).map(|i| (one.point[i] - other.point[i]).abs()).fold(0.0, f64::max);
                assert!(apart < 1e-9, "{step}: {one:?} {other:?}");
                places.insert(one.point.map(|x| (x * 20.0).round() as i64));
            }
        }
        // Else the steps would show nothing.
        assert!(places.len() > 30, "{}", places.len());
    }

    /// Tensions in single precision are off by less than half of the bound, and not by so little that the bound would say nothing.
    #[test]
    fn single_precision_keeps_its_bound() {
        let (faces, rows) = plate();
        let (coordinates, contacts) = steps();
        let search = TensionSearch::new(&faces, COUNT, rows).expect("faces of a box");
        let (mut seen, mut worst) = (Seen::default(), 0.0_f64);
        for (step, contact) in contacts.iter().enumerate() {
            let of_step = &coordinates[step * COUNT..(step + 1) * COUNT];
            let size: f64 = of_step.iter().zip(&search.scales).map(|(w, scale)| (w * scale).abs()).sum();
            if size < 1e-30 {
                continue;
            }
            let scaled = of_step.iter().zip(&search.scales).map(|(w, scale)| (w * scale / size) as f32);
            let column = &search.scaled * nalgebra::DVector::from_iterator(COUNT, scaled);
            seen.take(column.as_slice());
            for (face, local) in faces.faces.iter().zip(&search.local) {
                seen.look(face, local, (column.as_slice(), size), contact);
                let bound = f64::from(search.bound(seen.top));
                for point in (0..face.points.len()).filter(|point| !face.left_out[*point]) {
                    let exact = face.value(point, &search.sampled(point, of_step), contact) / size;
                    let off = (f64::from(seen.values[point]) - exact).abs();
                    // (Below the top there is no need for it: a value that is lower than it may not count.)
                    let room = 0.5 * bound * exact.abs().max(1.0) / f64::from(seen.top.abs()).max(1.0);
                    worst = worst.max(off / room.max(0.5 * bound));
                    assert!(off < room.max(0.5 * bound), "{step} {point}: {off:e} {bound:e}");
                }
            }
        }
        assert!(worst > 1e-3, "{worst:e}");
    }
}
