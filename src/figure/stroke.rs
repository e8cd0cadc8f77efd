//! Strokes of curves, and the reduction of their points for drawing.

use plotters::style::RGBColor;

/// A point on the canvas, in pixels of the backend.
pub(super) type Point = (i32, i32);

/// Colours that colour-blind readers can distinguish: Okabe and Ito (2008) without yellow, and grey.
pub(super) const COLOURS: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(0, 0, 0),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(127, 127, 127),
];

/// Alternating lengths of dashes and gaps, in widths of the line; a solid line has none.
const DASHES: [&[f64]; 4] = [&[], &[6.0, 2.5], &[1.2, 2.2], &[6.0, 2.0, 1.2, 2.0]];

/// Up to this number of curves, colours alone distinguish them. More curves also differ in dashes and width, so that
/// they can be distinguished in print.
const CURVES_BY_COLOUR: usize = 5;

/// Largest number of curves with different strokes.
pub(super) const MAX_STROKES: usize = COLOURS.len() * DASHES.len();

/// Stroke of a curve. `width` is in pixels of the figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stroke {
    pub colour: RGBColor,
    pub width: f64,
    pub dashes: &'static [f64],
}

/// Stroke of a limit with which curves are compared.
pub(super) const LIMIT: Stroke = Stroke { colour: RGBColor(180, 20, 20), width: 4.0, dashes: DASHES[1] };

/// Number of the colour of a total, which no other curve of its figure has.
const TOTAL_COLOUR: usize = 4;

/// Stroke of the sum of other curves.
pub(super) const TOTAL: Stroke = Stroke { colour: COLOURS[TOTAL_COLOUR], width: 7.0, dashes: DASHES[1] };

/// Whether curve `n` has the colour of a total.
pub(super) fn is_like_total(n: usize) -> bool {
    n % COLOURS.len() == TOTAL_COLOUR
}

/// Stroke of curve `n` of `of`. Of every eight curves, the last four are thinner. After every eight curves, the dashes
/// are shifted against the colours.
pub(super) fn stroke(n: usize, of: usize) -> Stroke {
    if of <= CURVES_BY_COLOUR {
        return Stroke { colour: COLOURS[n], width: 4.0, dashes: DASHES[0] };
    }
    Stroke {
        colour: COLOURS[n % COLOURS.len()],
        width: if n % 8 < 4 { 4.5 } else { 2.5 },
        dashes: DASHES[(n + n / 8) % DASHES.len()],
    }
}

/// Removes points that do not change the drawing: keeps the first, lowest, highest and last point of each pixel column.
pub(super) fn thinned(points: impl Iterator<Item = Point>) -> Vec<Point> {
    let mut thin: Vec<Point> = Vec::new();
    let mut column: Vec<Point> = Vec::new();
    let mut close = |column: &mut Vec<Point>| {
        let places = 0..column.len();
        let low = places.clone().min_by_key(|&n| column[n].1);
        let high = places.max_by_key(|&n| column[n].1);
        let mut kept = [Some(0), low, high, column.len().checked_sub(1)];
        kept.sort_unstable();
        let mut before = None;
        for n in kept.into_iter().flatten() {
            if before != Some(n) {
                thin.extend(column.get(n));
            }
            before = Some(n);
        }
        column.clear();
    };
    for point in points {
        if column.last().is_some_and(|last| last.0 != point.0) {
            close(&mut column);
        }
        column.push(point);
    }
    close(&mut column);
    thin.dedup();
    thin
}

/// Cuts the line through `points` into dashes. `lengths` are the alternating lengths of dashes and gaps, in pixels of
/// the backend.
pub(super) fn dashed(points: &[Point], lengths: &[f64]) -> Vec<Vec<Point>> {
    let mut pieces = vec![Vec::new()];
    let (mut phase, mut left) = (0, lengths[0]);
    for pair in points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let (dx, dy) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
        let length = dx.hypot(dy);
        let at = |s: f64| {
            let part = s / length;
            let along = |a: i32, d: f64| a + (part * d).round() as i32;
            (along(from.0, dx), along(from.1, dy))
        };
        let mut s = 0.0;
        while s < length {
            let drawn = phase % 2 == 0;
            let cut = s + left;
            let end = cut.min(length);
            if let Some(piece) = pieces.last_mut().filter(|_| drawn) {
                if piece.is_empty() {
                    piece.push(at(s));
                }
                piece.push(at(end));
            }
            if cut > length {
                left = cut - length;
            } else {
                phase = (phase + 1) % lengths.len();
                left = lengths[phase];
                if drawn {
                    pieces.push(Vec::new());
                }
            }
            s = end;
        }
    }
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_look_is_its_own() {
        let looks: std::collections::HashSet<_> = (0..MAX_STROKES)
            .map(|n| {
                let s = stroke(n, MAX_STROKES);
                let RGBColor(r, g, b) = s.colour;
                (r, g, b, s.dashes.len(), s.dashes.first().map(|d| d.to_bits()))
            })
            .collect();
        assert_eq!(looks.len(), MAX_STROKES);
    }

    #[test]
    fn thinning_keeps_the_ends_and_extremes_of_each_column() {
        let wave = (0..100_000).map(|n| (n / 1000, (n * 7919) % 1013));
        let thin = thinned(wave.clone());
        assert!(thin.len() <= 400, "{}", thin.len());
        for column in 0..100 {
            let of = |points: &[Point]| {
                let mut y: Vec<i32> = points.iter().filter(|p| p.0 == column).map(|p| p.1).collect();
                let ends = (y[0], y[y.len() - 1]);
                y.sort_unstable();
                (ends, y[0], y[y.len() - 1])
            };
            assert_eq!(of(&thin), of(&wave.clone().collect::<Vec<_>>()));
        }
    }

    #[test]
    fn dashes_cover_their_share_of_the_length_around_corners() {
        // A staircase of 10 × (30 + 40) pixels. Dashes of 8 with gaps of 4 cover two thirds of it.
        let mut points = vec![(0, 0)];
        for n in 0..10 {
            points.push((30 * (n + 1), 40 * n));
            points.push((30 * (n + 1), 40 * (n + 1)));
        }
        let pieces = dashed(&points, &[8.0, 4.0]);
        let length = |piece: &Vec<Point>| -> i32 {
            let side = |p: &[Point]| (p[1].0 - p[0].0).abs() + (p[1].1 - p[0].1).abs();
            piece.windows(2).map(side).sum()
        };
        // 700 is 58 periods of 12, plus 4 of the next dash. Every cut falls on a pixel.
        let lengths: Vec<i32> = pieces.iter().map(length).collect();
        assert_eq!(lengths.len(), 59);
        assert!(lengths[..58].iter().all(|&l| l == 8) && lengths[58] == 4);
    }
}
