//! Finds the points on the front of time against error, and the fastest methods at a given error.

use super::Point;

/// Levels of error at which methods are compared: the error of the acceleration in the first contact over its peak.
pub const LEVELS: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];

/// Indices of the points on the Pareto front of time and error, by ascending time. The function `error` selects the
/// error; points of peers are ignored.
pub fn front(points: &[Point], error: impl Fn(&Point) -> f64) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|n| !points[*n].is_foreign && error(&points[*n]).is_finite()).collect();
    order.sort_by(|a, b| points[*a].total().total_cmp(&points[*b].total()));
    let mut least = f64::INFINITY;
    order.retain(|n| {
        let is_better = error(&points[*n]) < least;
        if is_better {
            least = error(&points[*n]);
        }
        is_better
    });
    order
}

/// The fastest point of each method whose error in the first contact is at most `level`, in ascending order of time.
pub fn best(points: &[Point], level: f64) -> Vec<&Point> {
    let mut all: Vec<&Point> = points.iter().filter(|point| point.errors.history.first <= level).collect();
    all.sort_by(|a, b| a.total().total_cmp(&b.total()));
    let mut seen: Vec<&str> = Vec::new();
    all.retain(|point| {
        let is_new = !seen.contains(&point.method.as_str());
        seen.push(&point.method);
        is_new
    });
    all
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::Errors;
    use super::*;

    pub fn point(method: &str, seconds: f64, error: f64) -> Point {
        Point {
            method: method.into(),
            setting: format!("t={seconds}"),
            auto: None,
            is_foreign: method.starts_with("peer"),
            seconds: [0.25 * seconds, 0.75 * seconds],
            body: "mindlin".into(),
            solves: 10,
            estimate: None,
            errors: Errors::known(error, 2.0 * error),
        }
    }

    #[test]
    fn the_front_falls() {
        let points = [
            point("a", 1.0, 1e-2),
            point("a", 2.0, 1e-3),
            point("b", 0.5, 5e-2),
            point("b", 1.5, 2e-2),
            point("peer", 0.1, 1e-9),
            point("b", 4.0, f64::NAN),
        ];
        assert_eq!(front(&points, |point| point.errors.history.first), [2, 0, 1]);
        let best = best(&points, 1e-2);
        let found: Vec<_> = best.iter().map(|point| (point.method.as_str(), point.total())).collect();
        assert_eq!(found, [("peer", 0.1), ("a", 1.0)]);
    }
}
