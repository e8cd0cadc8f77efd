//! A contact law through measured points, by monotone piecewise cubics (F. N. Fritsch & J. Butland, A method for
//! constructing local monotone piecewise cubic interpolants, SIAM J. Sci. Stat. Comput. 5, 1984).

use std::sync::Arc;

use super::force_law::{positive_part, zero};

/// Contact force F(α) through points that begin at (0, 0). It has a continuous slope, and it increases wherever the
/// points do. Beyond the last point it continues linearly, for iterations only.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// The points with slopes and potentials, shared by all parts of a body.
    knots: Arc<[Knot]>,
    /// Factor on the points' forces.
    factor: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Knot {
    /// Indentation α, m.
    indentation: f64,
    /// Force F, N.
    force: f64,
    /// Slope dF/dα, N/m.
    slope: f64,
    /// Potential ∫ F dα, J.
    potential: f64,
}

impl Table {
    /// Makes the law from points of indentation (m) and force (N).
    ///
    /// # Errors
    /// If the points are not a contact law; the message has the number of the faulty point.
    pub fn new(points: &[[f64; 2]]) -> Result<Self, String> {
        check(points)?;
        let slopes = slopes(points);
        let mut knots: Vec<Knot> = Vec::with_capacity(points.len());
        for ([indentation, force], slope) in points.iter().copied().zip(slopes) {
            let potential = knots.last().map_or(0.0, |last| {
                let width = indentation - last.indentation;
                last.potential + width * (0.5 * (last.force + force) + width * (last.slope - slope) / 12.0)
            });
            knots.push(Knot { indentation, force, slope, potential });
        }
        Ok(Self { knots: knots.into(), factor: 1.0 })
    }

    /// The interpolated points: indentation (m) and force (N), scaled by the factor of the law.
    pub fn points(&self) -> Vec<[f64; 2]> {
        self.knots.iter().map(|knot| [knot.indentation, self.factor * knot.force]).collect()
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self { knots: self.knots.clone(), factor: self.factor * factor }
    }

    /// The last indentation, m.
    pub fn end(&self) -> f64 {
        self.last().indentation
    }

    /// Energy that the law can store up to the last point, J.
    pub fn capacity(&self) -> f64 {
        self.factor * self.last().potential
    }

    pub(super) fn force(&self, indentation: f64) -> f64 {
        let [force, ..] = self.at(indentation);
        force
    }

    pub(super) fn tangent(&self, indentation: f64) -> f64 {
        let [_, slope, _] = self.at(indentation);
        slope
    }

    pub(super) fn potential(&self, indentation: f64) -> f64 {
        let [.., potential] = self.at(indentation);
        potential
    }

    /// F (N), dF/dα (N/m) and ∫ F dα (J) at an indentation (m).
    fn at(&self, indentation: f64) -> [f64; 3] {
        let x = positive_part(indentation);
        if x == 0.0 {
            return [0.0; 3];
        }
        let number = self.knots.partition_point(|knot| knot.indentation < x).max(1);
        let a = self.knots[number - 1];
        let Some(b) = self.knots.get(number) else {
            // Linear continuation beyond the last point.
            let over = x - a.indentation;
            let force = a.force + a.slope * over;
            return [force, a.slope, a.potential + 0.5 * (a.force + force) * over].map(|value| self.factor * value);
        };
        // With t from 0 to 1 across the interval: F = a.force + t (s + t (c2 + t c3)).
        let (width, t) = (b.indentation - a.indentation, (x - a.indentation) / (b.indentation - a.indentation));
        let (s, e, rise) = (a.slope * width, b.slope * width, b.force - a.force);
        let (c2, c3) = (3.0 * rise - 2.0 * s - e, s + e - 2.0 * rise);
        let force = a.force + t * (s + t * (c2 + t * c3));
        let slope = (s + t * (2.0 * c2 + t * 3.0 * c3)) / width;
        let potential = a.potential + width * t * (a.force + t * (s / 2.0 + t * (c2 / 3.0 + t * c3 / 4.0)));
        [force, slope, potential].map(|value| self.factor * value)
    }

    pub(super) fn indentation(&self, force: f64) -> f64 {
        let value = |x: f64| {
            let [found, slope, _] = self.at(x);
            (found - force, slope)
        };
        zero(0.0, self.beyond(|high| self.force(high) >= force), value)
    }

    pub(super) fn indentation_of_potential(&self, energy: f64) -> f64 {
        let value = |x: f64| {
            let [force, _, potential] = self.at(x);
            (potential - energy, force)
        };
        zero(0.0, self.beyond(|high| self.potential(high) >= energy), value)
    }

    /// Least indentation (m) from which the tangent is above a value (N/m); infinite if it never is.
    pub(super) fn indentation_of_tangent(&self, tangent: f64) -> f64 {
        let passes = |pair: &[Knot]| Slope::between(pair[0], pair[1]).passes(tangent / self.factor);
        self.knots.windows(2).find_map(passes).unwrap_or(f64::INFINITY)
    }

    /// Largest tangent up to an indentation (m), N/m.
    pub(super) fn steepest(&self, indentation: f64) -> f64 {
        let before = self.knots.windows(2).take_while(|pair| pair[0].indentation < indentation);
        let steepest = before.map(|pair| Slope::between(pair[0], pair[1]).largest(indentation));
        self.factor * steepest.fold(0.0, f64::max)
    }

    /// The end of the table, or a place beyond it where `is_far` holds. If the table ends with zero slope, there may be
    /// no such place.
    fn beyond(&self, is_far: impl Fn(f64) -> bool) -> f64 {
        let mut high = self.end();
        while !is_far(high) && high < f64::MAX / 4.0 {
            high *= 2.0;
        }
        high
    }

    fn last(&self) -> &Knot {
        self.knots.last().expect("a table has points")
    }
}

/// Slope of the cubic between two points: start + t (p + t q) with t from 0 to 1, N/m.
struct Slope {
    /// Indentation at t = 0, m.
    from: f64,
    /// Distance of the points, m.
    width: f64,
    start: f64,
    p: f64,
    q: f64,
}

impl Slope {
    fn between(a: Knot, b: Knot) -> Self {
        let width = b.indentation - a.indentation;
        let rise = (b.force - a.force) / width;
        let p = 6.0 * rise - 4.0 * a.slope - 2.0 * b.slope;
        Self { from: a.indentation, width, start: a.slope, p, q: 3.0 * (a.slope + b.slope) - 6.0 * rise }
    }

    fn at(&self, t: f64) -> f64 {
        self.start + t * (self.p + t * self.q)
    }

    /// Largest slope up to an indentation (m), N/m.
    fn largest(&self, indentation: f64) -> f64 {
        let end = ((indentation - self.from) / self.width).min(1.0);
        let vertex = -0.5 * self.p / self.q;
        let between = if (0.0..end).contains(&vertex) { self.at(vertex) } else { 0.0 };
        self.start.max(self.at(end)).max(between)
    }

    /// First indentation (m) at which the slope passes a value (N/m).
    fn passes(&self, value: f64) -> Option<f64> {
        if self.start > value {
            return Some(self.from);
        }
        let (left, root) = (value - self.start, self.p * self.p + 4.0 * self.q * (value - self.start));
        // The smaller root, without cancellation; p is negative if the slope decreases first.
        let t = if root >= 0.0 { 2.0 * left / (self.p + root.sqrt()) } else { f64::NAN };
        let within = (0.0..1.0).contains(&t).then_some(self.from + t * self.width);
        within.or((self.at(1.0) > value).then_some(self.from + self.width))
    }
}

/// Checks that points are a contact law.
fn check(points: &[[f64; 2]]) -> Result<(), String> {
    let [first, second, ..] = points else {
        return Err(format!("a table needs two points at least, and has {}", points.len()));
    };
    if let Some(number) = points.iter().position(|point| point.iter().any(|value| !value.is_finite())) {
        return Err(format!("point {} is not made of finite numbers", number + 1));
    }
    if *first != [0.0, 0.0] {
        return Err(format!("the first point is {}, {}: a law of contact begins at 0, 0", first[0], first[1]));
    }
    for (number, pair) in points.windows(2).enumerate() {
        let ([x0, f0], [x1, f1]) = (pair[0], pair[1]);
        if x1 <= x0 {
            return Err(format!("the indentation does not rise from point {} to point {}", number + 1, number + 2));
        }
        if f1 < f0 {
            return Err(format!("the force falls from point {} to point {}", number + 1, number + 2));
        }
    }
    if second[1] == 0.0 && points.iter().all(|point| point[1] == 0.0) {
        return Err("all forces are 0".to_owned());
    }
    Ok(())
}

/// Slopes at the points for which each piece is monotone.
fn slopes(points: &[[f64; 2]]) -> Vec<f64> {
    let widths: Vec<f64> = points.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
    let rises: Vec<f64> =
        points.windows(2).zip(&widths).map(|(pair, width)| (pair[1][1] - pair[0][1]) / width).collect();
    let count = widths.len();
    if count == 1 {
        return vec![rises[0]; 2];
    }
    // At the ends: the slope of the parabola through three points, limited to the range from zero to three times the
    // slope of the first piece.
    let end =
        |h: [f64; 2], d: [f64; 2]| (((2.0 * h[0] + h[1]) * d[0] - h[0] * d[1]) / (h[0] + h[1])).clamp(0.0, 3.0 * d[0]);
    let inner = |i: usize| {
        let (h0, h1, d0, d1) = (widths[i - 1], widths[i], rises[i - 1], rises[i]);
        if d0 == 0.0 || d1 == 0.0 {
            return 0.0;
        }
        // Inside: the weighted harmonic mean.
        let (w0, w1) = (2.0 * h1 + h0, h1 + 2.0 * h0);
        (w0 + w1) / (w0 / d0 + w1 / d1)
    };
    let mut slopes = vec![end([widths[0], widths[1]], [rises[0], rises[1]])];
    slopes.extend((1..count).map(inner));
    slopes.push(end([widths[count - 1], widths[count - 2]], [rises[count - 1], rises[count - 2]]));
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a cubic give its potential with third order or better. The force increases everywhere and passes
    /// through the points.
    #[test]
    fn it_meets_its_points_and_rises() {
        let error = |count: i32| {
            let points: Vec<[f64; 2]> =
                (0..=count).map(|i| f64::from(i) / f64::from(count)).map(|x| [x, x * x * x]).collect();
            let table = Table::new(&points).unwrap();
            for [x, force] in points {
                assert!((table.force(x) - force).abs() < 1e-15);
            }
            (table.potential(1.0) - 0.25).abs()
        };
        let order = (error(16) / error(32)).log2();
        assert!(order > 2.9, "{order}");
        let rough = Table::new(&[[0.0, 0.0], [1.0, 5.0], [1.1, 5.0], [4.0, 5.1], [4.1, 90.0]]).unwrap();
        let forces: Vec<f64> = (0..=4200).map(|i| rough.force(1e-3 * f64::from(i))).collect();
        assert!(forces.windows(2).all(|pair| pair[1] >= pair[0]));
        assert_eq!(rough.force(1.05), 5.0);
    }

    /// Below the returned indentation the tangent is nowhere above the value, and there it equals the value.
    #[test]
    fn the_steepest_place_is_not_missed() {
        let table = Table::new(&[[0.0, 0.0], [1.0, 1.0], [2.0, 8.0], [3.0, 9.0], [4.0, 9.5]]).unwrap();
        for tangent in [0.5, 2.0, 6.0, 20.0] {
            let place = table.indentation_of_tangent(tangent);
            let before = (0..4000).map(|i| 1e-3 * f64::from(i)).filter(|x| *x < place);
            assert!(before.clone().all(|x| table.tangent(x) <= tangent * (1.0 + 1e-12)));
            if place.is_finite() && place > 0.0 {
                assert!((table.tangent(place) / tangent - 1.0).abs() < 1e-9, "{tangent}: {place}");
            }
        }
        for x in [0.4, 1.3, 2.0, 3.9] {
            let most = (0..=1000).map(|i| table.tangent(1e-3 * x * f64::from(i))).fold(0.0, f64::max);
            // Between two of the places a slope with a curvature of 50 rises by 50 (1e-3 x/2)²/2.
            let more = table.steepest(x) - most;
            assert!((-1e-12..1e-4).contains(&more), "{x}: {most}, {more:e}");
        }
        assert_eq!(table.indentation_of_tangent(20.0), f64::INFINITY);
    }

    #[test]
    fn what_is_no_law_is_told() {
        for (points, word) in [
            (vec![], "two points"),
            (vec![[0.0, 0.0]], "two points"),
            (vec![[0.0, 1.0], [1.0, 2.0]], "begins at 0, 0"),
            (vec![[0.0, 0.0], [1.0, 2.0], [2.0, 1.0]], "the force falls from point 2"),
            (vec![[0.0, 0.0], [1.0, 2.0], [1.0, 3.0]], "does not rise from point 2"),
            (vec![[0.0, 0.0], [1.0, f64::NAN]], "point 2"),
            (vec![[0.0, 0.0], [1.0, 0.0]], "all forces are 0"),
        ] {
            let error = Table::new(&points).unwrap_err();
            assert!(error.contains(word), "{error}");
        }
    }
}
