//! Cells along an axis: of one size around the hit, growing with the distance from it up to a largest.

/// Sizes of cells.
#[derive(Debug, Clone, Copy)]
pub struct Sizes {
    /// At the hit, m.
    pub hit: f64,
    /// Far from it, m.
    pub largest: f64,
    /// Size over the distance from the hit, between the two.
    pub growth: f64,
}

/// One side of the hit along an axis.
#[derive(Debug, Clone, Copy)]
pub struct Side {
    /// From the hit to the end, m.
    pub length: f64,
    /// Of its cells.
    pub sizes: Sizes,
}

impl Side {
    /// ∫ dx over the size of the cell at x, up to a distance: the size is that at the hit, then the distance times the growth, then
    /// the largest.
    pub fn count(&self, distance: f64) -> f64 {
        let [(near, at_near), (far, at_far)] = self.turns();
        if distance <= near {
            return distance / self.sizes.hit.min(self.sizes.largest);
        }
        let grown = at_near + (distance.min(far) / near).ln() / self.sizes.growth;
        if distance <= far { grown } else { at_far + (distance - far) / self.sizes.largest }
    }

    /// The inverse.
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

    /// Where the size begins to grow and where it ends to, with the counts there.
    fn turns(&self) -> [(f64, f64); 2] {
        let Sizes { hit, largest, growth } = self.sizes;
        let near = hit.min(largest) / growth;
        let far = largest / growth;
        [(near, 1.0 / growth), (far, (1.0 + (far / near).ln()) / growth)]
    }

    /// How many cells there are: none where an end is nearer to the hit than half a cell.
    pub fn cells(&self) -> f64 {
        if self.length < 0.5 * self.sizes.hit.min(self.sizes.largest) {
            return 0.0;
        }
        // What rounding leaves is no cell.
        (self.count(self.length) * (1.0 - 1e-9)).ceil().max(1.0)
    }

    /// Distances of the cells' far ends from the hit.
    pub fn lines(&self) -> Vec<f64> {
        let (cells, all) = (self.cells(), self.count(self.length));
        (1..=cells as usize).map(|i| self.distance(all * i as f64 / cells)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes are between those at the hit and the largest, within what a whole number of cells asks for, and grow as they should.
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
                // The size varies by a half within a cell.
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
