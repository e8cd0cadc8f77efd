//! Coordinates of the grid planes across one edge of a box, in m: ascending, from −edge/2 to edge/2 exactly.
//!
//! Each side of the impact point is laid out by the distance from the point, so that equal sides are mirror images to
//! the last bit.

/// Grid planes at equal distances.
pub(super) fn uniform(edge: f64, cells: usize) -> Vec<f64> {
    let n = cells as f64;
    (0..=cells).map(|i| 0.5 * edge * ((2.0 * i as f64 - n) / n)).collect()
}

/// A given number of cells that grow by a constant factor from the plane through `at` to both ends. The largest cell is
/// `ratio` times the smallest. If an end is nearer to `at` than half of the smallest cell, the cells grow from that
/// end. A ratio of 1 is uniform.
///
/// The cells are divided between the two sides so that the two cells at the plane are as equal as possible. If the
/// distance from `at` to an end is itself the smallest cell, the ratio may become larger.
pub(super) fn geometric(edge: f64, at: f64, cells: usize, ratio: f64) -> Vec<f64> {
    if ratio == 1.0 || cells == 1 {
        return uniform(edge, cells);
    }
    let (target, all) = (ratio.ln(), cells as f64);
    let rate = target / (all - 1.0);
    let (at, [below, above]) = sides(edge, at, edge * part(1.0, all, rate));
    let (count, rate) = match (below > 0.0, above > 0.0) {
        (false, _) => (0, rate),
        (_, false) => (cells, rate),
        _ => share([below, above], cells, target),
    };
    let ends = |length: f64, cells: usize| -> Vec<f64> {
        (1..=cells).map(|k| length * part(k as f64, cells as f64, rate)).collect()
    };
    join(edge, at, &ends(below, count), &ends(above, cells - count))
}

/// Cells of at most `smallest` at the plane through `at` that grow by the factor `growth` up to `largest`; as few as
/// fill the edge. If an end is nearer to `at` than half of the smallest cell, the cells grow from that end.
pub(super) fn growing(edge: f64, at: f64, smallest: f64, growth: f64, largest: f64) -> Vec<f64> {
    let (at, sides) = sides(edge, at, smallest);
    let [below, above] = sides.map(|length| grown(length, smallest, growth, largest));
    join(edge, at, &below, &above)
}

/// Coordinate of the plane from which the cells grow, and the lengths below and above it.
fn sides(edge: f64, at: f64, smallest: f64) -> (f64, [f64; 2]) {
    let half = 0.5 * edge;
    let lengths = [half + at, half - at];
    match lengths.map(|length| length < 0.5 * smallest) {
        [true, _] => (-half, [0.0, edge]),
        [_, true] => (half, [edge, 0.0]),
        _ => (at, lengths),
    }
}

/// Distances of the cells' far ends from the plane, scaled down to fit the length.
fn grown(length: f64, smallest: f64, growth: f64, largest: f64) -> Vec<f64> {
    let (mut ends, mut end, mut cell) = (Vec::new(), 0.0, smallest.min(largest));
    // A remainder from rounding is not a cell.
    while end < length * (1.0 - 1e-9) {
        end += cell;
        ends.push(end);
        cell = (cell * growth).min(largest);
    }
    ends.iter().map(|e| length * (e / end)).collect()
}

/// Joins the planes below and above `at` to one list.
fn join(edge: f64, at: f64, below: &[f64], above: &[f64]) -> Vec<f64> {
    let half = 0.5 * edge;
    let lower = below.iter().rev().map(|end| at - end);
    let mut planes: Vec<f64> = lower.chain([at]).chain(above.iter().map(|end| at + end)).collect();
    // Both ends, without the rounding of a difference.
    let last = planes.len() - 1;
    (planes[0], planes[last]) = (-half, half);
    planes
}

/// Fraction of a side covered by the first k of its n cells, each exp(rate) times as long as the previous one.
fn part(k: f64, n: f64, rate: f64) -> f64 {
    if rate == 0.0 { k / n } else { (k * rate).exp_m1() / (n * rate).exp_m1() }
}

/// Number of cells below the plane, and growth rate on both sides. The logarithm of the ratio becomes `target`, and the
/// two cells at the plane are as equal as possible.
fn share(sides: [f64; 2], cells: usize, target: f64) -> (usize, f64) {
    let mut best = ([f64::INFINITY; 2], 1, 0.0);
    for count in 1..cells {
        let counts = [count, cells - count].map(|n| n as f64);
        let rate = rate(sides, counts, target);
        let excess = spread(sides, counts, rate) - target;
        let [below, above] = [0, 1].map(|i| sides[i] * part(1.0, counts[i], rate));
        // A ratio that is too large counts first, apart from the rounding of the bisection.
        let fault = [if excess > 1e-9 { excess } else { 0.0 }, (below / above).ln().abs()];
        if fault < best.0 {
            best = (fault, count, rate);
        }
    }
    (best.1, best.2)
}

/// Growth rate for which the spread is `target`; 0 if the spread is already larger without growth. The spread increases
/// with the rate.
fn rate(sides: [f64; 2], counts: [f64; 2], target: f64) -> f64 {
    if spread(sides, counts, 0.0) >= target {
        return 0.0;
    }
    // On one side alone, the ratio is exp((n − 1) rate). There are at least three cells, because the spread of two is
    // fixed.
    let longest = counts[0].max(counts[1]);
    let (mut low, mut high) = (0.0, target / (longest - 1.0).max(1.0));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if spread(sides, counts, middle) < target {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// Logarithm of the ratio of the largest to the smallest cell.
fn spread(sides: [f64; 2], counts: [f64; 2], rate: f64) -> f64 {
    let first = [0, 1].map(|i| (sides[i] * part(1.0, counts[i], rate)).ln());
    let last = [0, 1].map(|i| first[i] + (counts[i] - 1.0) * rate);
    last[0].max(last[1]) - first[0].min(first[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn edges(planes: &[f64]) -> Vec<f64> {
        planes.windows(2).map(|pair| pair[1] - pair[0]).collect()
    }

    fn ratio(planes: &[f64]) -> f64 {
        let edges = edges(planes);
        edges.iter().fold(0.0f64, |m, e| m.max(*e)) / edges.iter().fold(f64::INFINITY, |m, e| m.min(*e))
    }

    fn mirrored(planes: &[f64]) -> Vec<f64> {
        planes.iter().rev().map(|x| -x).collect()
    }

    #[test]
    fn uniform_planes_are_symmetric_and_end_at_the_faces() {
        for cells in 1..100 {
            let planes = uniform(0.3, cells);
            assert_eq!((planes[0], planes[cells]), (-0.15, 0.15));
            assert_eq!(planes, mirrored(&planes));
            // Tolerance: rounding of the coordinates over an edge.
            assert!(ratio(&planes) - 1.0 < 1e-15 * cells as f64);
        }
    }

    #[test]
    fn from_a_face_cells_grow_to_the_other() {
        let planes = geometric(2.0, 1.0, 3, 4.0);
        // 1 + 2 + 4 = 7 parts of the length 2. Tolerance: rounding of three additions.
        for (found, expected) in edges(&planes).iter().zip([8.0 / 7.0, 4.0 / 7.0, 2.0 / 7.0]) {
            assert!((found - expected).abs() < 1e-15);
        }
        assert_eq!(geometric(2.0, -1.0, 3, 4.0), mirrored(&planes));
        // A point nearer to the face than half a cell does not create a thin cell.
        assert_eq!(geometric(2.0, 0.9, 3, 4.0), planes);
    }

    #[test]
    fn cells_that_grow_reach_the_largest_and_stay() {
        let planes = growing(10.0, 0.0, 0.5, 2.0, 1.5);
        // 0.5 + 1 + 1.5 + 1.5 is less than 5, so a fifth cell is needed: the sum of 6 is scaled to 5.
        let expected = [0.5, 1.5, 3.0, 4.5, 6.0].map(|end| end / 6.0 * 5.0);
        assert_eq!(planes[6..], expected);
        assert_eq!(planes, mirrored(&planes));
        // From a face: 0.25 + 0.5 + 1 is scaled to 1.
        let planes = growing(1.0, 0.5, 0.25, 2.0, 1.0);
        assert_eq!(planes.len(), 4);
        for (found, expected) in planes.iter().zip([-0.5, 1.0 / 14.0, 5.0 / 14.0, 0.5]) {
            assert!((found - expected).abs() < 1e-15);
        }
    }

    proptest! {
        #[test]
        fn geometric_planes_keep_their_number_ratio_and_growth(
            edge in 1e-3..1e3f64, place in -0.999..0.999f64, cells in 4..80usize, ratio_wanted in 1.001..1e4f64,
        ) {
            let at = 0.5 * edge * place;
            let planes = geometric(edge, at, cells, ratio_wanted);
            let edges = edges(&planes);
            prop_assert_eq!(edges.len(), cells);
            prop_assert_eq!((planes[0], planes[cells]), (-0.5 * edge, 0.5 * edge));
            prop_assert!(edges.iter().all(|edge| *edge > 0.0));
            // Tolerance: rounding of the coordinates over the smallest edge.
            let rounding = 1e-15 * edge / edges.iter().fold(f64::INFINITY, |m, e| m.min(*e));
            let found = ratio(&planes);
            let through = planes.iter().position(|x| (x - at).abs() <= 1e-15 * edge);
            let smallest = if place > 0.0 { edges[cells - 1] } else { edges[0] };
            match through {
                // The point is at an end, or less than half a cell away from it.
                None | Some(0) => prop_assert!(0.5 * edge - at.abs() < 0.5 * smallest),
                Some(through) if found > ratio_wanted * (1.0 + 1e-6) => {
                    // Only possible if the point leaves a side no choice: its single cell is the smallest or the
                    // largest, or uniform cells on both sides already differ by more.
                    let [low, high] = [(0.5 * edge + at) / through as f64, (0.5 * edge - at) / (cells - through) as f64];
                    let alike = low.max(high) / low.min(high);
                    prop_assert!([1, cells - 1].contains(&through) || alike > ratio_wanted);
                }
                Some(through) => {
                    prop_assert!((found / ratio_wanted - 1.0).abs() < 1e-6 + 2.0 * rounding, "{}", found);
                    let growth: Vec<f64> = edges[..through].windows(2).map(|pair| pair[0] / pair[1])
                        .chain(edges[through..].windows(2).map(|pair| pair[1] / pair[0])).collect();
                    for pair in growth.windows(2) {
                        prop_assert!((pair[0] / pair[1] - 1.0).abs() < 1e-9 + 8.0 * rounding, "{:?}", growth);
                    }
                }
            }
        }

        #[test]
        fn a_hit_in_the_middle_gives_two_mirrored_halves(
            edge in 1e-3..1e3f64, half in 1..40usize, ratio_wanted in 1.0..1e4f64, growth in 1.0..3.0f64,
        ) {
            let planes = geometric(edge, 0.0, 2 * half, ratio_wanted);
            prop_assert_eq!(&planes, &mirrored(&planes));
            prop_assert_eq!(planes[half], 0.0);
            let planes = growing(edge, 0.0, 0.01 * edge, growth, 0.1 * edge);
            prop_assert_eq!(&planes, &mirrored(&planes));
        }

        #[test]
        fn growing_cells_keep_to_their_bounds(
            edge in 1e-3..1e3f64, place in -1.0..=1.0f64, smallest in 1e-3..0.5f64, growth in 1.0..3.0f64, more in 1.0..50.0f64,
        ) {
            let (at, smallest, largest) = (0.5 * edge * place, smallest * edge, smallest * more * edge);
            let planes = growing(edge, at, smallest, growth, largest);
            prop_assert_eq!((planes[0], *planes.last().unwrap_or(&0.0)), (-0.5 * edge, 0.5 * edge));
            let edges = edges(&planes);
            // Tolerance: a remainder of up to 1e-9 of the length is not a cell.
            let room = 1.0 + 1e-8;
            prop_assert!(edges.iter().all(|edge| *edge > 0.0 && *edge <= largest * room));
            // The cells grow from the point, or from an end less than half a cell away.
            let start = planes.iter().position(|x| *x == at);
            prop_assert!(start.is_some() || 0.5 * edge - at.abs() < 0.5 * smallest);
            let start = start.unwrap_or(if at < 0.0 { 0 } else { planes.len() - 1 });
            for beside in [start.checked_sub(1), Some(start)].into_iter().flatten().filter_map(|i| edges.get(i)) {
                prop_assert!(*beside <= smallest * room);
            }
            for pair in edges[..start].windows(2).map(|p| p[0] / p[1]).chain(edges[start..].windows(2).map(|p| p[1] / p[0])) {
                prop_assert!(pair <= growth * room && pair >= 1.0 / room);
            }
        }
    }
}
