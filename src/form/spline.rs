//! B-splines along a line, and integrals of their products.

use std::cmp::Ordering;

use nalgebra::{DMatrix, DVector};

use crate::element::gauss_legendre;

/// Maximum number of functions that are not zero in one cell: 6 for degree 5.
pub const WIDTH: usize = 6;

/// Piecewise polynomials on the cells between given breaks, represented by B-splines on open knots. At the start of the
/// line the first function is 1 and all others are 0; at the end the last function is 1 (de Boor, A Practical Guide to
/// Splines, 1978).
#[derive(Debug, Clone, PartialEq)]
pub struct Spline {
    degree: usize,
    breaks: Vec<f64>,
    /// Knots: the breaks, each repeated according to the smoothness there.
    knots: Vec<f64>,
    slopes: bool,
    parity: Option<Parity>,
}

/// Behaviour of a function on reflection of the line at its middle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parity {
    /// The function is unchanged.
    Even,
    /// The function changes its sign.
    Odd,
}

impl Spline {
    /// Splines of a degree from 1 to 5 with `smoothness` < degree continuous derivatives, on at least one cell between
    /// ascending breaks. An inner break may be listed twice, for fewer continuous derivatives there: one fewer if
    /// `smoothness` is degree − 1.
    pub fn new(breaks: &[f64], degree: usize, smoothness: usize) -> Self {
        Self::with_multiplicity(breaks, degree, |_| degree - smoothness)
    }

    /// Splines of degree 3 or more whose first two and last two coefficients are the value and the slope at the ends.
    /// At most degree − 2 derivatives are continuous at the inner end of each end cell, so that the function of the
    /// slope is zero outside the end cell.
    pub fn with_slopes(breaks: &[f64], degree: usize, smoothness: usize) -> Self {
        let beside_end = |i: usize| i == 1 || i + 2 == breaks.len();
        let times = |i: usize| (degree - smoothness).max(if beside_end(i) { 2 } else { 1 });
        Self { slopes: true, ..Self::with_multiplicity(breaks, degree, times) }
    }

    fn with_multiplicity(breaks: &[f64], degree: usize, times: impl Fn(usize) -> usize) -> Self {
        let times = |i: usize| if i == 0 || i + 1 == breaks.len() { degree + 1 } else { times(i) };
        let knots = breaks.iter().enumerate().flat_map(|(i, x)| std::iter::repeat_n(*x, times(i))).collect();
        Self { degree, breaks: breaks.to_vec(), knots, slopes: false, parity: None }
    }

    /// Splines of one parity, on breaks that are symmetric about their middle: sums or differences of a B-spline and
    /// its reflection. At most six functions are supported, which limits the number of cells. Only the last function is
    /// non-zero at the end, and no function is limited to a few cells.
    pub fn folded(self, parity: Parity) -> Self {
        let folded = Self { parity: Some(parity), ..self };
        debug_assert!(folded.functions() <= WIDTH && !folded.slopes);
        folded
    }

    /// Whether the functions have one parity, and each of them extends over all cells.
    pub fn is_folded(&self) -> bool {
        self.parity.is_some()
    }

    /// Ends of the cells, ascending.
    pub fn breaks(&self) -> &[f64] {
        &self.breaks
    }

    /// Number of functions.
    pub fn functions(&self) -> usize {
        match self.parity {
            None => self.unfolded(),
            Some(Parity::Even) => self.unfolded().div_ceil(2),
            Some(Parity::Odd) => self.unfolded() / 2,
        }
    }

    /// Number of B-splines before folding.
    fn unfolded(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// Number of functions that are not zero in a cell.
    fn width(&self) -> usize {
        if self.is_folded() { self.functions() } else { self.degree + 1 }
    }

    /// Coefficients of the constant 1, or zeros if the space does not contain constants.
    pub fn one(&self) -> DVector<f64> {
        let constant = if self.parity == Some(Parity::Odd) { 0.0 } else { 1.0 };
        let mut one = DVector::from_element(self.functions(), constant);
        if self.slopes {
            let n = one.len();
            (one[1], one[n - 2]) = (0.0, 0.0);
        }
        one
    }

    /// Values of a derivative of the functions at `x`: number of the first function that is not zero in the cell, then
    /// the values of this function and the next ones. A break belongs to the cell above it.
    pub fn at(&self, x: f64, derivative: usize) -> (usize, [f64; WIDTH]) {
        let span = self.knots.partition_point(|t| *t <= x).clamp(self.degree + 1, self.unfolded()) - 1;
        let mut values = match self.degree {
            5 => self.recurred::<5>(span, x, derivative),
            4 => self.recurred::<4>(span, x, derivative),
            3 => self.recurred::<3>(span, x, derivative),
            2 => self.recurred::<2>(span, x, derivative),
            _ => self.recurred::<1>(span, x, derivative),
        };
        let first = span - self.degree;
        if self.slopes {
            self.to_slopes(first, &mut values);
        }
        match self.parity {
            None => (first, values),
            Some(parity) => (0, self.fold(parity, first, &values)),
        }
    }

    /// Values of a derivative of the B-splines of degree P at `x` between the knots `span` and `span + 1`, by de Boor's
    /// recurrence.
    fn recurred<const P: usize>(&self, span: usize, x: f64, derivative: usize) -> [f64; WIDTH] {
        let mut values = [0.0; WIDTH];
        values[0] = if derivative > P { 0.0 } else { 1.0 };
        // Knots below x and above it where functions of the cell begin and end.
        let below: [f64; P] = std::array::from_fn(|i| self.knots[span + 1 - P + i]);
        let above: [f64; P] = std::array::from_fn(|i| self.knots[span + 1 + i]);
        let (from_below, to_above) = (below.map(|knot| x - knot), above.map(|knot| knot - x));
        // Raises the degree from q − 1 to q: recurrence of the values first, of the derivatives last. Unlike `for`, both
        // loops are unrolled by the compiler, which saves a third of the time.
        let mut q = 1;
        while q <= P {
            let is_of_values = q + derivative <= P;
            // Contribution of the previous function to the next one.
            let (mut left, mut j) = (0.0, 0);
            while j < q {
                let part = values[j] / (above[j] - below[P - q + j]);
                let (rises, falls) =
                    if is_of_values { (from_below[P - q + j], to_above[j]) } else { (q as f64, -(q as f64)) };
                values[j] = left + falls * part;
                left = rises * part;
                j += 1;
            }
            values[q] = left;
            q += 1;
        }
        values
    }

    /// Transforms values of B-splines from number `first` on to sums or differences with their reflections.
    fn fold(&self, parity: Parity, first: usize, values: &[f64; WIDTH]) -> [f64; WIDTH] {
        let (last, mut folded) = (self.unfolded() - 1, [0.0; WIDTH]);
        for (i, value) in (first..=first + self.degree).zip(values) {
            match (i.cmp(&(last - i)), parity) {
                (Ordering::Less, Parity::Odd) => folded[i] -= value,
                (Ordering::Equal, Parity::Odd) => {}
                (Ordering::Greater, _) => folded[last - i] += value,
                (_, Parity::Even) => folded[i] += value,
            }
        }
        // The function that is not zero at the end is put last, as in the unfolded case.
        folded[..self.functions()].reverse();
        folded
    }

    /// Replaces the first two B-splines B0, B1 by B0 + B1, with value 1 and slope 0, and by B1 scaled to the slope 1.
    /// The last two are treated in the same way.
    fn to_slopes(&self, first: usize, values: &mut [f64; WIDTH]) {
        let (p, n) = (self.degree as f64, self.functions());
        let [first_cell, last_cell] = [1, self.breaks.len() - 1].map(|i| self.breaks[i] - self.breaks[i - 1]);
        for j in 0..=self.degree {
            match first + j {
                0 => values[j] += values[j + 1],
                1 => values[j] *= first_cell / p,
                i if i == n - 1 => {
                    values[j] += values[j - 1];
                    values[j - 1] *= -last_cell / p;
                }
                _ => {}
            }
        }
    }

    /// Values of a derivative of all functions at `x`.
    pub fn values(&self, x: f64, derivative: usize) -> DVector<f64> {
        let mut all = DVector::zeros(self.functions());
        let (first, values) = self.at(x, derivative);
        for (j, value) in values.iter().enumerate().take(self.width()) {
            all[first + j] = *value;
        }
        all
    }

    /// Integrals of a derivative of all functions along the line.
    pub fn integrals(&self, derivative: usize) -> DVector<f64> {
        self.integrals_within([f64::NEG_INFINITY, f64::INFINITY], derivative)
    }

    /// Same as [`Spline::integrals`], over the part of the line within an interval.
    pub fn integrals_within(&self, ends: [f64; 2], derivative: usize) -> DVector<f64> {
        let mut sums = DVector::zeros(self.functions());
        for (x, weight) in self.rule(self.degree, ends) {
            let (first, values) = self.at(x, derivative);
            for (j, value) in values.iter().enumerate().take(self.width()) {
                sums[first + j] += weight * value;
            }
        }
        sums
    }

    /// Integrals of the functions times a polynomial of at most their degree.
    pub fn moments(&self, polynomial: impl Fn(f64) -> f64) -> DVector<f64> {
        let rule = self.rule(2 * self.degree, [f64::NEG_INFINITY, f64::INFINITY]);
        rule.fold(DVector::zeros(self.functions()), |sum, (x, weight)| sum + weight * polynomial(x) * self.values(x, 0))
    }

    /// Integrals of products of a derivative of these functions (rows) with a derivative of the functions of `other`
    /// (columns) on the same breaks.
    pub fn products(&self, derivative: usize, other: &Self, of_other: usize) -> DMatrix<f64> {
        self.products_within([f64::NEG_INFINITY, f64::INFINITY], derivative, other, of_other)
    }

    /// Same as [`Spline::products`], over the part of the line within an interval.
    pub fn products_within(&self, ends: [f64; 2], derivative: usize, other: &Self, of_other: usize) -> DMatrix<f64> {
        let mut sums = DMatrix::zeros(self.functions(), other.functions());
        for (x, weight) in self.rule(self.degree + other.degree, ends) {
            let (row, rows) = self.at(x, derivative);
            let (column, columns) = other.at(x, of_other);
            for j in 0..other.width() {
                for i in 0..self.width() {
                    sums[(row + i, column + j)] += weight * rows[i] * columns[j];
                }
            }
        }
        sums
    }

    /// Points and weights that integrate polynomials of a degree exactly, on the part of each cell within an interval.
    fn rule(&self, degree: usize, [start, end]: [f64; 2]) -> impl Iterator<Item = (f64, f64)> {
        let rule = gauss_legendre(degree / 2 + 1);
        let cells = self.breaks.windows(2).map(move |cell| [cell[0].max(start), cell[1].min(end)]);
        cells.filter(|[from, to]| from < to).flat_map(move |[from, to]| {
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            rule.clone().into_iter().map(move |(x, weight)| (middle + half * x, half * weight))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BREAKS: [f64; 5] = [-0.3, 0.1, 0.25, 1.0, 1.4];

    fn splines() -> Vec<Spline> {
        let smooth = (1..=5).flat_map(|p| (0..p).map(move |s| Spline::new(&BREAKS, p, s)));
        let ends = [(3, 1), (3, 2), (4, 3), (5, 2)].map(|(p, s)| Spline::with_slopes(&BREAKS, p, s));
        let single = [Spline::new, Spline::with_slopes].map(|new| new(&BREAKS[..2], 3, 2));
        smooth.chain(ends).chain(single).collect()
    }

    #[test]
    fn they_sum_to_one_and_their_derivatives_are_those_of_differences() {
        for spline in splines() {
            let (start, end) = (spline.breaks[0], spline.breaks[spline.breaks.len() - 1]);
            for k in 0..=60 {
                let x = start + (end - start) * f64::from(k) / 60.0;
                // Rounding of some ten terms.
                assert!((spline.one().dot(&spline.values(x, 0)) - 1.0).abs() < 1e-14);
                let step = 1e-5 * (end - start);
                if spline.breaks.iter().any(|b| (b - x).abs() <= step) {
                    continue;
                }
                for d in 0..=spline.degree {
                    let slope = (spline.values(x + step, d) - spline.values(x - step, d)) / (2.0 * step);
                    let next = spline.values(x, d + 1);
                    // (step/cell)², and rounding divided by step/cell.
                    assert!((&slope - &next).amax() <= 1e-7 * next.amax().max(spline.values(x, d).amax() / step));
                }
            }
        }
    }

    /// Values and slopes at the ends are single coefficients.
    #[test]
    fn ends_are_single_coefficients() {
        for spline in splines() {
            let n = spline.functions();
            let unit = |i: usize| DVector::from_fn(n, |j, _| if i == j { 1.0 } else { 0.0 });
            let (start, end) = (spline.breaks[0], spline.breaks[spline.breaks.len() - 1]);
            let mut expected = vec![(start, 0, unit(0)), (end, 0, unit(n - 1))];
            if spline.slopes {
                expected.extend([(start, 1, unit(1)), (end, 1, unit(n - 2))]);
            }
            for (x, derivative, unit) in expected {
                assert!((spline.values(x, derivative) - unit).amax() < 1e-14, "{x} {derivative}");
            }
        }
    }

    /// Folded functions have their parity and are independent. Together there are as many as B-splines.
    #[test]
    fn folding_leaves_what_is_of_a_parity() {
        for (breaks, degree) in [(vec![-1.0, 1.0], 4), (vec![-1.0, 0.0, 1.0], 3), (vec![-1.0, -0.2, 0.2, 1.0], 5)] {
            let whole = Spline::new(&breaks, degree, degree - 1);
            let [even, odd] = [Parity::Even, Parity::Odd].map(|parity| whole.clone().folded(parity));
            assert_eq!(even.functions() + odd.functions(), whole.functions());
            let ((mass, even_mass), odd_mass) =
                ((whole.products(0, &whole, 0), even.products(0, &even, 0)), odd.products(0, &odd, 0));
            for x in [0.0, 0.1, 0.3, 0.7, 1.0] {
                for d in 0..3 {
                    let sign = if d % 2 == 0 { 1.0 } else { -1.0 };
                    // Derivatives are at most 2 degree² times the values; the rest is rounding.
                    assert!((even.values(x, d) - sign * even.values(-x, d)).amax() < 1e-12);
                    assert!((odd.values(x, d) + sign * odd.values(-x, d)).amax() < 1e-12);
                }
                assert!((even.one().dot(&even.values(x, 0)) - 1.0).abs() < 1e-14 && odd.one().amax() == 0.0);
                // The projection of a delta function at x is the sum of its even and odd projections.
                let delta = |s: &Spline, m: &DMatrix<f64>| {
                    let v = s.values(x, 0);
                    v.dot(&m.clone().cholesky().expect("a mass matrix").solve(&v))
                };
                let parts = delta(&even, &even_mass) + delta(&odd, &odd_mass);
                assert!((delta(&whole, &mass) / parts - 1.0).abs() < 1e-10);
            }
            let [even_end, odd_end] = [even, odd].map(|s| s.values(1.0, 0));
            assert!((even_end[even_end.len() - 1], odd_end[odd_end.len() - 1]) == (1.0, 1.0));
            assert!(even_end.sum() == 1.0 && odd_end.sum() == 1.0);
        }
    }

    /// Derivatives are continuous across a break up to the requested smoothness and no further.
    #[test]
    fn smoothness_is_that_asked_for() {
        for (degree, smoothness) in [(3, 1), (3, 2), (4, 3), (2, 0)] {
            let spline = Spline::new(&BREAKS, degree, smoothness);
            for derivative in 0..=smoothness + 1 {
                let jump = spline.values(0.25 - 1e-12, derivative) - spline.values(0.25, derivative);
                let part = jump.amax() / spline.values(0.25, derivative).amax();
                // Slopes times 1e-12 of a cell.
                assert_eq!(part < 1e-9, derivative <= smoothness, "{degree} {smoothness} {derivative}: {part:e}");
            }
        }
    }

    /// A break listed twice reduces the number of continuous derivatives by one and is not a cell.
    #[test]
    fn double_breaks_take_a_derivative() {
        let (mut breaks, degree) = (BREAKS.to_vec(), 4);
        breaks.insert(2, BREAKS[2]);
        let [smooth, spline] = [&BREAKS[..], &breaks].map(|breaks| Spline::new(breaks, degree, degree - 1));
        assert_eq!(spline.functions(), smooth.functions() + 1);
        for derivative in 0..=3 {
            let jump = spline.values(0.25 - 1e-12, derivative) - spline.values(0.25, derivative);
            let part = jump.amax() / spline.values(0.25, derivative).amax();
            // Slopes times 1e-12 of a cell.
            assert_eq!(part < 1e-9, derivative <= 2, "{derivative}: {part:e}");
        }
        // The space contains splines of lower degree on the same breaks; their integrals agree.
        let mass = spline.products(0, &spline, 0).cholesky().expect("a mass matrix");
        let shared = spline.products(0, &Spline::new(&breaks, 2, 1), 0);
        assert!(
            (mass.solve(&shared).transpose() * spline.integrals(0) - Spline::new(&breaks, 2, 1).integrals(0)).amax()
                < 1e-13
        );
    }

    /// Integration by parts: ∫ u'v + ∫ uv' = [uv].
    #[test]
    fn products_are_integrated_exactly() {
        for spline in splines() {
            let other = Spline::new(&spline.breaks, 2, 1);
            let (start, end) = (spline.breaks[0], spline.breaks[spline.breaks.len() - 1]);
            let sum = spline.products(1, &other, 0) + spline.products(0, &other, 1);
            let at = |x: f64| spline.values(x, 0) * other.values(x, 0).transpose();
            assert!((sum - (at(end) - at(start))).amax() < 1e-13);
            let along = spline.products(0, &other, 0) * other.one();
            assert!((along - spline.integrals(0)).amax() < 1e-14);
        }
    }

    /// Derivatives of splines of degree p are splines of degree p − 1 with one continuous derivative fewer.
    #[test]
    fn slopes_lie_in_the_space_below() {
        for p in 2..=5 {
            let (spline, below) = (Spline::new(&BREAKS, p, p - 1), Spline::new(&BREAKS, p - 1, p - 2));
            let mass = below.products(0, &below, 0).cholesky().expect("a mass matrix");
            let projected = mass.solve(&below.products(0, &spline, 1));
            let defect = spline.products(1, &spline, 1) - spline.products(1, &below, 0) * projected;
            assert!(defect.amax() < 1e-11 * spline.products(1, &spline, 1).amax(), "{p}: {:e}", defect.amax());
        }
    }
}
