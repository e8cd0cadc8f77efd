//! Step length along a Newton direction.

/// Accepted slope, relative to the slope at the start; the next Newton direction removes the rest.
const ACCEPTED_SLOPE: f64 = 0.5;

/// Returns the full step unless it overshoots. Otherwise the zero of the slope is bracketed and found by the Illinois
/// rule (Dowell & Jarratt, A modified regula falsi method, BIT 11, 1971).
///
/// `slope(λ)` is the derivative of a convex potential along the direction, at λ times the direction.
///
/// # Errors
/// Any error of `slope`.
pub(super) fn step_length<E>(mut slope: impl FnMut(f64) -> Result<f64, E>) -> Result<f64, E> {
    let before = slope(0.0)?;
    let full = slope(1.0)?;
    // NaN is passed on; the caller reports it.
    if before >= 0.0 || full.is_nan() || full <= ACCEPTED_SLOPE * -before {
        return Ok(1.0);
    }
    let ((mut low, mut slope_low), (mut high, mut slope_high)) = ((0.0, before), (1.0, full));
    for _ in 0..30 {
        let length = (low * slope_high - high * slope_low) / (slope_high - slope_low);
        let slope = slope(length)?;
        if slope.abs() <= ACCEPTED_SLOPE * -before {
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
