//! Values at points of a face, interpolated to any position on the face.

use crate::scene::Vec3;

/// Values at points of a face, projected along the axis in which the face has its smallest extent.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Axes of the figure: horizontal (to the right) and vertical (upwards).
    pub axes: [usize; 2],
    /// Lowest and highest coordinate along each of the axes, including mirror images, m.
    pub ends: [(f64, f64); 2],
    /// Centre and radius, m, of the circle about the impact point in which values are interpolated; `None` if there is
    /// none.
    pub unread: Option<([f64; 2], f64)>,
    /// Whether there are mirror images at negative coordinates, for each of the axes.
    mirrored: [bool; 2],
    kind: Kind,
}

#[derive(Debug, Clone, PartialEq)]
enum Kind {
    /// Values on a grid of lines; the coordinate along the second axis varies fastest.
    Grid { lines: [Vec<f64>; 2], values: Vec<f64> },
    /// Position and value of each point, and the distance up to which its value applies.
    Scattered(Vec<([f64; 2], f64, f64)>),
}

/// Number of neighbours considered for a scattered point. Its value applies up to the fraction [`REACH`] of the
/// distance to the last one.
const NEIGHBOURS: usize = 4;
const REACH: f64 = 0.8;

impl Surface {
    /// Makes a surface from `points` (m) and their values, NaN where unknown. Values near the impact point `hit` may be
    /// unknown. `mirrored` tells along which axes there are mirror images. Returns `None` if all values are unknown.
    pub fn new(points: &[Vec3], values: &[f64], hit: Vec3, mirrored: [bool; 3]) -> Option<Self> {
        if values.iter().all(|value| value.is_nan()) {
            return None;
        }
        let range = |axis: usize| {
            let of = |(low, high): (f64, f64), x: &Vec3| (low.min(x[axis]), high.max(x[axis]));
            points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), of)
        };
        let extent = |axis: usize| range(axis).1 - range(axis).0;
        let across = (0..3).fold(0, |thin, axis| if extent(axis) < extent(thin) { axis } else { thin });
        let axes = [[1, 2], [0, 2], [0, 1]][across];
        let mirrored = axes.map(|axis| mirrored[axis]);
        let ends = [0, 1].map(|i| {
            let (low, high) = range(axes[i]);
            if mirrored[i] { (-high, high) } else { (low, high) }
        });
        let places: Vec<[f64; 2]> = points.iter().map(|x| axes.map(|axis| x[axis])).collect();
        let hit = axes.map(|axis| hit[axis]);
        let missing =
            places.iter().zip(values).filter(|(_, value)| value.is_nan()).map(|(place, _)| distance(place, &hit));
        let radius = missing.fold(0.0, f64::max);
        let (kind, unread) = match lines(&places) {
            Some(lines) => {
                let values = filled(&places, values, hit);
                (Kind::Grid { lines, values }, (radius > 0.0).then_some((hit, radius)))
            }
            None => (Kind::Scattered(scattered(&places, values)), None),
        };
        Some(Self { axes, ends, unread, mirrored, kind })
    }

    /// Value at a position along the two axes, m; `None` outside the face.
    pub fn at(&self, place: [f64; 2]) -> Option<f64> {
        let image = [0, 1].map(|i| if self.mirrored[i] { place[i].abs() } else { place[i] });
        match &self.kind {
            Kind::Grid { lines, values } => bilinear(lines, values, image),
            Kind::Scattered(points) => {
                let squared = |x: &[f64; 2]| (x[0] - image[0]).powi(2) + (x[1] - image[1]).powi(2);
                let (x, value, reach) =
                    points.iter().min_by(|one, other| squared(&one.0).total_cmp(&squared(&other.0)))?;
                (squared(x).sqrt() <= *reach).then_some(*value)
            }
        }
    }
}

/// Lines of the grid whose crossings are the points, if the second coordinate varies fastest; `None` if the points are
/// not a grid.
fn lines(places: &[[f64; 2]]) -> Option<[Vec<f64>; 2]> {
    let lines = [0, 1].map(|i| {
        let mut along: Vec<f64> = places.iter().map(|place| place[i]).collect();
        along.sort_by(f64::total_cmp);
        let same = 1e-9 * (along.last()? - along.first()?);
        along.dedup_by(|one, other| *one - *other <= same);
        (along.len() > 1).then_some(along)
    });
    let [Some(a), Some(b)] = lines else { return None };
    let near = |one: f64, other: f64, all: &[f64]| (one - other).abs() <= 1e-8 * (all[all.len() - 1] - all[0]);
    let is_grid = a.len() * b.len() == places.len()
        && places
            .iter()
            .enumerate()
            .all(|(n, place)| near(place[0], a[n / b.len()], &a) && near(place[1], b[n % b.len()], &b));
    is_grid.then_some([a, b])
}

fn distance(one: &[f64; 2], other: &[f64; 2]) -> f64 {
    (one[0] - other[0]).hypot(one[1] - other[1])
}

/// Fills unknown values near the impact point: linear along each radius from the value at the impact point to a mean of
/// the surrounding values, weighted by distance⁻⁴.
fn filled(places: &[[f64; 2]], values: &[f64], hit: [f64; 2]) -> Vec<f64> {
    let known: Vec<(&[f64; 2], f64)> =
        places.iter().zip(values.iter().copied()).filter(|(_, value)| !value.is_nan()).collect();
    if known.len() == places.len() {
        return values.to_vec();
    }
    let size = places.iter().map(|place| distance(place, &hit)).fold(0.0, f64::max);
    let (at_hit, around): (Vec<_>, Vec<_>) =
        known.into_iter().partition(|(place, _)| distance(place, &hit) < 1e-9 * size);
    let least = around.iter().map(|(place, _)| distance(place, &hit)).fold(f64::INFINITY, f64::min);
    let fill = |place: &[f64; 2]| {
        let weight = |other: &[f64; 2]| distance(place, other).powi(-4);
        let (sum, weights) = around
            .iter()
            .fold((0.0, 0.0), |(sum, weights), (other, value)| (sum + weight(other) * value, weights + weight(other)));
        let (outer, part) = (sum / weights, (distance(place, &hit) / least).min(1.0));
        at_hit.first().map_or(outer, |(_, inner)| inner + part * (outer - inner))
    };
    let each = places.iter().zip(values);
    each.map(|(place, value)| if value.is_nan() { fill(place) } else { *value }).collect()
}

/// The points with known values, each with the distance up to which its value applies.
fn scattered(places: &[[f64; 2]], values: &[f64]) -> Vec<([f64; 2], f64, f64)> {
    let known = || places.iter().zip(values).filter(|(_, value)| !value.is_nan());
    let reach = |place: &[f64; 2]| {
        let mut nearest = [f64::INFINITY; NEIGHBOURS];
        for (other, _) in known().filter(|(other, _)| *other != place) {
            let mut distance = (place[0] - other[0]).hypot(place[1] - other[1]);
            for one in &mut nearest {
                if distance < *one {
                    std::mem::swap(&mut distance, one);
                }
            }
        }
        REACH * nearest.into_iter().filter(|distance| distance.is_finite()).fold(0.0, f64::max)
    };
    known().map(|(place, value)| (*place, *value, reach(place))).collect()
}

/// Bilinear interpolation between the lines of a grid; `None` outside the grid.
fn bilinear(lines: &[Vec<f64>; 2], values: &[f64], place: [f64; 2]) -> Option<f64> {
    let mut cell = [(0, 0.0); 2];
    for i in 0..2 {
        let line = &lines[i];
        let (low, high) = (*line.first()?, *line.last()?);
        let slack = 1e-9 * (high - low);
        if place[i] < low - slack || place[i] > high + slack {
            return None;
        }
        let after = line.partition_point(|x| *x < place[i]).clamp(1, line.len() - 1);
        let part = (place[i] - line[after - 1]) / (line[after] - line[after - 1]);
        cell[i] = (after - 1, part.clamp(0.0, 1.0));
    }
    let [(a, s), (b, t)] = cell;
    let value = |i: usize, j: usize| values[(a + i) * lines[1].len() + b + j];
    Some((1.0 - s) * ((1.0 - t) * value(0, 0) + t * value(0, 1)) + s * ((1.0 - t) * value(1, 0) + t * value(1, 1)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The grid of a quarter model with unknown values around the impact point. Bilinear functions are reproduced
    /// exactly where all values are known. Mirror images have the same values as the modelled part. The filled values
    /// lie between the value at the impact point and the surrounding values.
    #[test]
    fn grids_are_read_between_their_lines() {
        let line = [0.0, 0.1, 0.25, 0.5, 1.0];
        let points: Vec<Vec3> = line.iter().flat_map(|y| line.iter().map(move |z| [0.02, *y, *z])).collect();
        let exact = |y: f64, z: f64| 3.0 - y - 0.5 * z + 0.2 * y * z;
        let value = |x: &Vec3| {
            let is_left_out = x[1] + x[2] > 0.0 && x[1].hypot(x[2]) < 0.2;
            if is_left_out { f64::NAN } else { exact(x[1], x[2]) }
        };
        let values: Vec<f64> = points.iter().map(value).collect();
        let surface = Surface::new(&points, &values, [0.02, 0.0, 0.0], [false, true, true]).expect("values");
        assert_eq!((surface.axes, surface.ends), ([1, 2], [(-1.0, 1.0); 2]));
        for [y, z] in [[0.3, 0.7], [0.9, 0.6], [1.0, 1.0], [0.0, 0.0]] {
            for signs in [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                let found = surface.at([signs[0] * y, signs[1] * z]).expect("within");
                assert!((found - exact(y, z)).abs() < 1e-12, "{y} {z}: {found}");
            }
        }
        let hole = surface.at([0.1, 0.1]).expect("within");
        assert!(hole < 3.0 && hole > exact(0.5, 0.5), "{hole}");
        assert_eq!(surface.at([1.2, 0.0]), None);
        // The radius reaches to the farthest grid point with an unknown value.
        let (middle, radius) = surface.unread.expect("a hole");
        assert!(middle == [0.0; 2] && (radius - 0.1 * 2.0_f64.sqrt()).abs() < 1e-15, "{radius}");
        assert_eq!(Surface::new(&points, &vec![f64::NAN; points.len()], [0.0; 3], [false; 3]), None);
    }

    /// Scattered points: the value of the nearest point applies, and there is no value far from all points.
    #[test]
    fn scattered_points_count_as_far_as_they_lie_apart() {
        let ring = |n: usize| 0.4 * (n as f64);
        let points: Vec<Vec3> =
            (0..200).map(|n| [ring(n).cos() * 0.01 * n as f64, ring(n).sin() * 0.01 * n as f64, 0.0]).collect();
        let values: Vec<f64> = (0..200).map(f64::from).collect();
        let surface = Surface::new(&points, &values, [0.0; 3], [false; 3]).expect("values");
        for n in [3, 50, 199] {
            assert_eq!(surface.at([points[n][0], points[n][1]]), Some(n as f64));
        }
        assert_eq!(surface.at([1.9, 1.9]), None);
    }
}
