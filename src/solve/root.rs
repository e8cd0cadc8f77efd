//! Root of a continuous function of one variable between two arguments.

/// Largest number of evaluations.
const MAX_EVALUATIONS: usize = 60;

/// Search for a root of a function that is negative below it and positive above it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RootSearch {
    /// Arguments between which the root is.
    pub bracket: [f64; 2],
    /// First guess of the root.
    pub guess: f64,
    /// First guess of the slope there.
    pub slope: f64,
    /// The search ends when the argument changes by at most this.
    pub change: f64,
}

impl RootSearch {
    /// Returns the root. The search takes secant steps, and halves the bracket where a secant leaves it. After 60
    /// evaluations it returns the last argument; where the function is NaN, that argument.
    pub fn root(self, value: impl Fn(f64) -> f64) -> f64 {
        let Self { bracket: [mut low, mut high], guess, mut slope, change } = self;
        let within = |at: f64, [low, high]: [f64; 2]| if low < at && at < high { at } else { 0.5 * (low + high) };
        let mut at = within(guess, [low, high]);
        let mut found = value(at);
        for evaluations in 1..MAX_EVALUATIONS {
            if found == 0.0 || found.is_nan() {
                break;
            }
            *(if found < 0.0 { &mut low } else { &mut high }) = at;
            let next = within(at - found / slope, [low, high]);
            // The guessed slope may be much too steep.
            if (next - at).abs() <= change && (evaluations > 1 || next == at) {
                return next;
            }
            let there = value(next);
            slope = (there - found) / (next - at);
            (at, found) = (next, there);
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Finds the root of a function in `[0, 2]`; returns it with the number of evaluations.
    fn found(guess: f64, slope: f64, value: impl Fn(f64) -> f64) -> (f64, usize) {
        let evaluations = Cell::new(0);
        let search = RootSearch { bracket: [0.0, 2.0], guess, slope, change: 1e-12 };
        let root = search.root(|x| {
            evaluations.set(evaluations.get() + 1);
            value(x)
        });
        (root, evaluations.get())
    }

    /// From a good guess, a root is found in few evaluations. The last secant is far more accurate than its change.
    #[test]
    fn a_smooth_root_takes_few_evaluations() {
        let (root, evaluations) = found(1.3, 1.0, |x| x.powi(3) - 2.0);
        assert!((root - 2.0_f64.cbrt()).abs() < 1e-15 && evaluations <= 7, "{root} {evaluations}");
    }

    /// The root is found from wrong guesses, at a steep step, and where the function is flat.
    #[test]
    fn a_root_is_found_from_any_guess() {
        for guess in [-7.0, 0.1, 1.9, 40.0] {
            for slope in [1e-3, 1.0, 1e13] {
                let (step, _) = found(guess, slope, |x| (1e4 * (x - 1.2)).tanh());
                assert!((step - 1.2).abs() < 1e-11, "{step}");
                let (flat, _) = found(guess, slope, |x| (x - 0.7).powi(3));
                // Secants at a triple root shrink the error by a factor of 0.75 each.
                assert!((flat - 0.7).abs() < 1e-5, "{flat}");
            }
        }
    }

    /// The search ends where the function has no value.
    #[test]
    fn a_search_ends_where_there_is_no_value() {
        let (at, evaluations) = found(1.0, 1.0, |x| if x > 0.9 { f64::NAN } else { x - 1.5 });
        assert_eq!((at, evaluations), (1.0, 1));
    }
}
