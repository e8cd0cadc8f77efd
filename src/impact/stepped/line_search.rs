//! How far to go along a Newton direction.

/// The slope left over that a next Newton direction will remove anyway.
const ENOUGH: f64 = 0.5;

/// The full step, unless it overshoots: then the zero of the slope, bracketed, by the Illinois rule (Dowell & Jarratt, A
/// modified regula falsi method, BIT 11, 1971).
///
/// `slope(λ)` is the derivative of a convex potential along the direction, at λ times it.
///
/// # Errors
/// The slope's.
pub(super) fn step_length<E>(mut slope: impl FnMut(f64) -> Result<f64, E>) -> Result<f64, E> {
    let before = slope(0.0)?;
    let full = slope(1.0)?;
    // NaN is passed on, for the caller to report.
    if before >= 0.0 || full.is_nan() || full <= ENOUGH * -before {
        return Ok(1.0);
    }
    let ((mut low, mut slope_low), (mut high, mut slope_high)) = ((0.0, before), (1.0, full));
    for _ in 0..30 {
        let length = (low * slope_high - high * slope_low) / (slope_high - slope_low);
        let slope = slope(length)?;
        if slope.abs() <= ENOUGH * -before {
            return Ok(length);
        }
        if slope < 0.0 {
            (low, slope_low) = (length, slope);
            slope_high /= 2.0;
        } else {
            (high, slope_high) = (length, slope);
            slope_low /= 2.0;
        }
    }
    Ok(low)
}
