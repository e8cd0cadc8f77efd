//! Finds the lowest sign change of an expensive function from few evaluations.

/// A place on the search axis and the function's value there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    /// Place on the axis of the search.
    pub place: f64,
    /// Value of the function: negative before the root.
    pub function: f64,
}

/// Result of a scan.
#[derive(Debug)]
pub(super) struct Scan {
    /// Computed points, ascending, up to the first at which the function is not negative.
    pub points: Vec<Point>,
    /// Index of the first point at which the function is not negative; at least 1.
    pub crossing: Option<usize>,
    /// Number of places added to those of the grid.
    pub added: usize,
    /// Whether no interval before the crossing may still hide a lower root.
    pub is_complete: bool,
}

/// Safety factor on the curvature of the parabola through three points.
const SAFETY: f64 = 2.0;
/// Largest number of places added to those of the grid.
const MAX_ADDED: usize = 16;
/// Rise of a maximum above the interval's end points that may be missed, relative to the tolerance.
const UNSEEN: f64 = 0.25;
/// Range in which a place is added within an interval, as parts of its length from its beginning.
const WITHIN: [f64; 2] = [0.2, 0.8];

/// Scans a function that is negative at the first place. It is computed at the ascending places of a grid up to the
/// first change of sign, and then at places between them where the curvature allows a lower root.
///
/// # Errors
/// The first error of the function.
pub(super) fn scan<E>(
    grid: &[f64],
    tolerance: f64,
    function: &mut impl FnMut(f64) -> Result<f64, E>,
) -> Result<Scan, E> {
    let mut points: Vec<Point> = Vec::new();
    for place in grid {
        points.push(Point { place: *place, function: function(*place)? });
        if points.len() > 1 && is_crossed(points.last()) {
            break;
        }
    }
    let mut added = 0;
    while added < MAX_ADDED {
        let Some(place) = doubtful(&points, UNSEEN * tolerance) else { break };
        let at = points.partition_point(|point| point.place < place);
        points.insert(at, Point { place, function: function(place)? });
        added += 1;
        if is_crossed(points.get(at)) {
            points.truncate(at + 1);
        }
    }
    let is_complete = doubtful(&points, UNSEEN * tolerance).is_none();
    let crossing = (points.len() > 1 && is_crossed(points.last())).then(|| points.len() - 1);
    Ok(Scan { points, crossing, added, is_complete })
}

fn is_crossed(point: Option<&Point>) -> bool {
    point.is_some_and(|point| point.function >= 0.0)
}

/// A place in the interval of negative points whose curvature allows the highest maximum; `None` if no such maximum
/// reaches zero.
fn doubtful(points: &[Point], unseen: f64) -> Option<f64> {
    let highest = points.windows(2).enumerate().filter_map(|(number, pair)| {
        let [a, b] = [pair[0], pair[1]];
        if b.function >= 0.0 {
            return None;
        }
        let curvature = curvature(points, number);
        let highest = highest(a, b, SAFETY * curvature);
        let is_seen = highest <= a.function.max(b.function) + unseen;
        (highest >= 0.0 && !is_seen).then(|| (highest, vertex(a, b, curvature)))
    });
    highest.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, place)| place)
}

/// Largest downward curvature of the parabolas through an interval's ends and one neighbouring point; 0 if none bends
/// down.
fn curvature(points: &[Point], interval: usize) -> f64 {
    let of_three = |first: usize| {
        let three = points.get(first..first + 3)?;
        let slope = |a: Point, b: Point| (b.function - a.function) / (b.place - a.place);
        let change = slope(three[1], three[2]) - slope(three[0], three[1]);
        Some(-2.0 * change / (three[2].place - three[0].place))
    };
    [interval.checked_sub(1), Some(interval)].into_iter().flatten().filter_map(of_three).fold(0.0, f64::max)
}

/// Largest value between two points of the parabola through them with the given downward curvature.
fn highest(a: Point, b: Point, curvature: f64) -> f64 {
    let sagitta = curvature * (b.place - a.place).powi(2) / 8.0;
    let rise = b.function - a.function;
    if rise.abs() >= 4.0 * sagitta {
        return a.function.max(b.function);
    }
    0.5 * (a.function + b.function) + sagitta + rise * rise / (16.0 * sagitta)
}

/// Place of the parabola's largest value, kept away from both points by [`WITHIN`].
fn vertex(a: Point, b: Point, curvature: f64) -> f64 {
    let width = b.place - a.place;
    let part = 0.5 + (b.function - a.function) / (curvature * width * width);
    a.place + part.clamp(WITHIN[0], WITHIN[1]) * width
}
