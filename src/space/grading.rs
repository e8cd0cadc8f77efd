//! Graded cells along an axis: of constant size near the impact point, then growing with the distance from it up to a
//! largest size.

/// Sizes of the cells.
#[derive(Debug, Clone, Copy)]
pub struct Sizes {
    /// Size at the impact point, m.
    pub hit: f64,
    /// Largest size, m.
    pub largest: f64,
    /// Ratio of the size to the distance from the impact point, between the two sizes above.
    pub growth: f64,
}

impl Sizes {
    /// Size at a distance from the impact point, m.
    pub fn at(&self, distance: f64) -> f64 {
        (self.growth * distance.abs()).max(self.hit).min(self.largest)
    }
}

/// Part of an axis on one side of the impact point.
#[derive(Debug, Clone, Copy)]
pub struct Side {
    /// Distance from the impact point to the end of the axis, m.
    pub length: f64,
    /// Sizes of its cells.
    pub sizes: Sizes,
}

impl Side {
    /// Number of cells up to a distance (m), not rounded: ∫ dx divided by the cell size at x. The cell size is the size
    /// at the impact point, then the distance times the growth, then the largest size.
    pub fn count(&self, distance: f64) -> f64 {
        let [(near, at_near), (far, at_far)] = self.turns();
        if distance <= near {
            return distance / self.sizes.hit.min(self.sizes.largest);
        }
        let grown = at_near + (distance.min(far) / near).ln() / self.sizes.growth;
        if distance <= far { grown } else { at_far + (distance - far) / self.sizes.largest }
    }

    /// Distance (m) for a number of cells: the inverse of [`Self::count`].
    pub fn distance(&self, count: f64) -> f64 {
        let [(near, at_near), (far, at_far)] = self.turns();
        if count <= at_near {
            count * self.sizes.hit.min(self.sizes.largest)
        } else if count <= at_far {
            near * (self.sizes.growth * (count - at_near)).exp()
        } else {
            far + (count - at_far) * self.sizes.largest
        }
    }

    /// Distances (m) at which the cell size begins and ceases to grow, each with the number of cells up to it.
    fn turns(&self) -> [(f64, f64); 2] {
        let Sizes { hit, largest, growth } = self.sizes;
        let near = hit.min(largest) / growth;
        let far = largest / growth;
        [(near, 1.0 / growth), (far, (1.0 + (far / near).ln()) / growth)]
    }

    /// Number of cells; none if the end is nearer to the impact point than half a cell.
    pub fn cells(&self) -> f64 {
        if self.length < 0.5 * self.sizes.hit.min(self.sizes.largest) {
            return 0.0;
        }
        // A remainder due to rounding must not add a cell.
        (self.count(self.length) * (1.0 - 1e-9)).ceil().max(1.0)
    }

    /// Distances (m) of the far ends of the cells from the impact point.
    pub fn lines(&self) -> Vec<f64> {
        let (cells, all) = (self.cells(), self.count(self.length));
        (1..=cells as usize).map(|i| self.distance(all * i as f64 / cells)).collect()
    }
}

/// Number of intervals in which the size of the cells between two lines is sampled.
const SAMPLES: usize = 400;

/// Largest number of cells in an interval: more than any grid has.
const MOST: usize = 10_000;

/// Lines within an interval (m) that divide it into cells of a wanted size (m) as a function of the coordinate, at most
/// [`MOST`].
pub fn divide([from, to]: [f64; 2], size: impl Fn(f64) -> f64) -> Vec<f64> {
    let width = (to - from) / SAMPLES as f64;
    // Number of cells up to the end of each interval.
    let mut counts = vec![0.0];
    for sample in 0..SAMPLES {
        counts.push(counts[sample] + width / size(from + (sample as f64 + 0.5) * width));
    }
    let all = counts[SAMPLES];
    let cells = ((all * (1.0 - 1e-9)).ceil().max(1.0) as usize).min(MOST);
    let line = |number: usize| {
        let wanted = all * number as f64 / cells as f64;
        let after = counts.partition_point(|count| *count < wanted).max(1);
        let part = (wanted - counts[after - 1]) / (counts[after] - counts[after - 1]);
        from + (after as f64 - 1.0 + part) * width
    };
    (1..cells).map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cell sizes follow the prescribed size, apart from the rounding to a whole number of cells.
    #[test]
    fn cells_follow_their_size() {
        let sizes = Sizes { hit: 0.01, largest: 0.1, growth: 0.5 };
        for length in [0.004, 0.02, 0.13, 0.7] {
            let side = Side { length, sizes };
            let lines = side.lines();
            assert_eq!(lines.is_empty(), length < 0.005, "{length}");
            let mut from = 0.0;
            for &to in &lines {
                let middle: f64 = 0.5 * (from + to);
                let size = (0.5 * middle).clamp(0.01, 0.1);
                let cells = side.count(length);
                // The prescribed size varies by half of itself within a cell.
                let ratio = (to - from) / size * cells.ceil() / cells;
                assert!((0.8..1.2).contains(&ratio) || lines.len() == 1, "{length}: {lines:?}");
                from = to;
            }
            if let Some(last) = lines.last() {
                assert!((last / length - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn count_and_distance_are_inverse() {
        for sizes in [(0.01, 0.1, 0.5), (0.2, 0.1, 0.5), (0.01, 10.0, 1.6)] {
            let sizes = Sizes { hit: sizes.0, largest: sizes.1, growth: sizes.2 };
            let side = Side { length: 1.0, sizes };
            for i in 1..200 {
                let x = f64::from(i) / 200.0;
                assert!((side.distance(side.count(x)) / x - 1.0).abs() < 1e-12, "{sizes:?} {x}");
            }
        }
    }
}
