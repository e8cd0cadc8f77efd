//! A bracket made narrow: Chandrupatla's method (Advances in Engineering Software 28, 1997, 145–149), which interpolates by an inverse
//! parabola where that is safe and halves the bracket where it is not. It begins with the secant, as the logarithm of a ratio over that of
//! a speed is almost a straight line.

use super::Range;
use super::bracket::Point;

/// When a root is found.
pub(super) struct Target {
    /// The function is at most this.
    pub function: f64,
    /// The value is known to this part of itself.
    pub relative: f64,
    /// A change of the function within that part that is a jump.
    pub jump: f64,
}

/// What came of it.
pub(super) struct Narrowed {
    /// The root; the function was computed there.
    pub place: f64,
    /// Whether the function jumps there.
    pub is_jump: bool,
}

/// Parts of the bracket that a step stays away from its ends.
const MARGIN: f64 = 0.02;
/// Halvings that make any bracket narrow.
const MOST: usize = 60;

/// Narrows a bracket: the function is negative at its first end and not at its second.
///
/// # Errors
/// The first one of the function.
pub(super) fn narrow<E>(
    bracket: [Point; 2],
    target: &Target,
    range: &Range,
    function: &mut impl FnMut(f64) -> Result<f64, E>,
) -> Result<Narrowed, E> {
    // The newest point, the end across the root from it, and the point before it.
    let [mut before, mut newest] = bracket;
    let mut across = before;
    let mut part = secant(newest, across);
    for _ in 0..MOST {
        let best = if newest.function.abs() < across.function.abs() { newest } else { across };
        let slope = (newest.function - across.function) / (newest.place - across.place);
        let width = range.width(target.relative, best.place);
        let is_narrow = (newest.place - across.place).abs() <= width;
        let is_small = best.function.abs() <= target.function;
        if is_narrow || is_small && best.function.abs() <= width * slope.abs() {
            let is_jump = is_narrow && (newest.function - across.function).abs() > target.jump;
            // At a jump the strength is passed on one side alone.
            let passed = if newest.function >= 0.0 { newest } else { across };
            return Ok(Narrowed { place: if is_jump { passed.place } else { best.place }, is_jump });
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
    }
    Ok(Narrowed { place: newest.place, is_jump: false })
}

fn secant(a: Point, b: Point) -> f64 {
    a.function / (a.function - b.function)
}

/// The part of the bracket from the newest point on.
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
