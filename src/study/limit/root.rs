//! Narrows a bracket by Chandrupatla's method (Advances in Engineering Software 28, 1997, 145–149): inverse quadratic
//! interpolation where it is safe, bisection where it is not. The first step is a secant step, because the logarithm of
//! a stress ratio is almost linear in the logarithm of a speed.

use super::Range;
use super::bracket::Point;

/// Stopping criteria of the root search.
pub(super) struct Target {
    /// Largest accepted absolute value of the function.
    pub function: f64,
    /// Relative accuracy of the value.
    pub relative: f64,
    /// Change of the function across a bracket of that accuracy above which it is a jump.
    pub jump: f64,
}

/// Result of narrowing a bracket.
pub(super) struct Narrowed {
    /// Place of the root; the function was computed there.
    pub place: f64,
    /// Whether the function jumps there.
    pub is_jump: bool,
    /// Whether the target was met within the largest number of iterations.
    pub is_converged: bool,
}

/// Smallest distance of a new place from the bracket's ends, relative to the bracket.
const MARGIN: f64 = 0.02;
/// Largest number of iterations. As halvings they make any bracket narrow; interpolations may make it narrow more slowly.
const MAX_ITERATIONS: usize = 60;

/// Narrows a bracket whose function is negative at its first end and not negative at its second.
///
/// # Errors
/// The first error of the function.
pub(super) fn narrow<E>(
    bracket: [Point; 2],
    target: &Target,
    range: &Range,
    function: &mut impl FnMut(f64) -> Result<f64, E>,
) -> Result<Narrowed, E> {
    // The newest point, the end on the other side of the root, and the previous point.
    let [mut before, mut newest] = bracket;
    let mut across = before;
    let mut part = secant(newest, across);
    let mut iterations = 0;
    loop {
        let best = if newest.function.abs() < across.function.abs() { newest } else { across };
        let slope = (newest.function - across.function) / (newest.place - across.place);
        let width = range.width(target.relative, best.place);
        let is_narrow = (newest.place - across.place).abs() <= width;
        let is_small = best.function.abs() <= target.function;
        let is_converged = is_narrow || is_small && best.function.abs() <= width * slope.abs();
        if is_converged || iterations == MAX_ITERATIONS {
            let is_jump = is_narrow && (newest.function - across.function).abs() > target.jump;
            // At a jump the returned place is the end at which the function is not negative.
            let passed = if newest.function >= 0.0 { newest } else { across };
            let place = if is_jump { passed.place } else { best.place };
            return Ok(Narrowed { place, is_jump, is_converged });
        }
        let place = newest.place + part.clamp(MARGIN, 1.0 - MARGIN) * (across.place - newest.place);
        let found = Point { place, function: function(place)? };
        if (found.function < 0.0) == (newest.function < 0.0) {
            before = newest;
        } else {
            before = across;
            across = newest;
        }
        newest = found;
        part = step(newest, across, before);
        iterations += 1;
    }
}

fn secant(a: Point, b: Point) -> f64 {
    a.function / (a.function - b.function)
}

/// Position of the next place in the bracket from `a` (newest) to `b`, as a part of its length.
fn step(a: Point, b: Point, c: Point) -> f64 {
    let xi = (a.place - b.place) / (c.place - b.place);
    let phi = (a.function - b.function) / (c.function - b.function);
    if !(phi * phi < xi && (1.0 - phi).powi(2) < 1.0 - xi) {
        return 0.5;
    }
    let first = a.function / (b.function - a.function) * c.function / (b.function - c.function);
    let second = (c.place - a.place) / (b.place - a.place) * a.function / (c.function - a.function) * b.function
        / (c.function - b.function);
    first + second
}
