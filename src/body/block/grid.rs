//! The cells of a block.

/// Sizes of cells, m.
#[derive(Debug, Clone, Copy)]
pub struct Sizes {
    /// At the hit.
    pub hit: f64,
    /// At the ends.
    pub end: f64,
    /// Largest.
    pub largest: f64,
    /// Growth a unit of length.
    pub growth: f64,
}

/// Lines along one axis from −edge/2 to edge/2, through `at`.
pub fn lines(edge: f64, at: f64, sizes: Sizes) -> Vec<f64> {
    let half = 0.5 * edge;
    let [below, above] = [half + at, half - at];
    let least = 0.5 * sizes.hit;
    let (at, below, above) = match (below < least, above < least) {
        (true, _) => (-half, 0.0, edge),
        (_, true) => (half, edge, 0.0),
        _ => (at, below, above),
    };
    let mut lines: Vec<f64> = side(below, sizes).iter().rev().map(|d| at - d).collect();
    lines.push(at);
    lines.extend(side(above, sizes).iter().map(|d| at + d));
    let last = lines.len() - 1;
    (lines[0], lines[last]) = (-half, half);
    lines
}

/// Distances of the cells' far ends from the hit.
fn side(length: f64, Sizes { hit, end, largest, growth }: Sizes) -> Vec<f64> {
    if length <= 0.0 {
        return Vec::new();
    }
    let size = |d: f64| (growth * d).max(hit).min((growth * (length - d)).max(end)).min(largest);
    const N: usize = 20000;
    let mut sums = vec![0.0];
    for i in 0..N {
        let d = length * (i as f64 + 0.5) / N as f64;
        sums.push(sums[i] + length / N as f64 / size(d));
    }
    let total = sums[N];
    let cells = (total * (1.0 - 1e-9)).ceil().max(1.0);
    (1..=cells as usize)
        .map(|i| {
            let n = total * i as f64 / cells;
            let j = sums.partition_point(|s| *s < n).clamp(1, N);
            length * ((j - 1) as f64 + (n - sums[j - 1]) / (sums[j] - sums[j - 1])) / N as f64
        })
        .collect()
}
