//! Tests of the search on functions with known roots.

use proptest::prelude::*;

use super::bracket::Point;
use super::root::{Target, narrow};
use super::{Found, Range, search};

const TOLERANCE: f64 = 1e-2;

/// Upper bound of the number of runs in a simple case.
const MAX_RUNS: usize = 15;

fn range(from: f64, to: f64) -> Range {
    Range { key: "key".to_owned(), from, to }
}

fn find(from: f64, to: f64, ratio: impl Fn(f64) -> f64) -> Found {
    let mut runs = 0;
    let found = search(&range(from, to), TOLERANCE, |value| {
        assert!((from..=to).contains(&value), "{value}");
        runs += 1;
        Ok::<_, ()>(ratio(value))
    });
    let found = found.unwrap();
    assert_eq!(found.samples.len(), runs);
    assert!(found.samples.is_sorted_by(|a, b| a.value < b.value));
    found
}

/// The root, and whether the ratio rises there.
fn root(found: &Found) -> (f64, bool) {
    let root = found.root.unwrap_or_else(|| panic!("{found:?}"));
    assert!(!root.is_jump && root.is_converged && found.is_complete, "{found:?}");
    assert!((root.at.ratio - 1.0).abs() <= TOLERANCE, "{root:?}");
    (root.at.value, root.is_rising)
}

fn is_near(value: f64, exact: f64, relative: f64) -> bool {
    (value - exact).abs() <= relative * exact.abs()
}

#[test]
fn one_root_of_a_power_takes_few_runs() {
    for (power, exact) in [(0.6, 0.28), (1.0, 0.74), (1.0, 9.9), (1.2, 0.11), (2.5, 3.0)] {
        let found = find(0.1, 10.0, |speed| (speed / exact).powf(power));
        let (value, is_rising) = root(&found);
        assert!(is_rising && is_near(value, exact, 1e-3) && found.samples.len() < MAX_RUNS, "{found:?}");
        let sensitivity = found.root.unwrap().sensitivity;
        assert!(is_near(sensitivity, exact / power, 0.5), "{sensitivity}");
    }
    // The ratio falls with the value, as it does with the thickness of a plate.
    let found = find(0.005, 0.05, |thickness| (thickness / 0.012).powi(-2));
    assert!(!root(&found).1 && is_near(root(&found).0, 0.012, 1e-3) && found.samples.len() < MAX_RUNS, "{found:?}");
}

#[test]
fn the_lowest_of_two_and_three_roots() {
    // A maximum between two values of the grid 0, 1, …, 6.
    let found = find(0.0, 6.0, |x| 1.02 - 0.1 * (x - 2.5).powi(2));
    assert!(is_near(root(&found).0, 2.5 - 0.2_f64.sqrt(), 1e-3), "{found:?}");
    // The ratio reaches 1 again beyond the maximum.
    let bump = |x: f64| 0.5 + 0.52 * (-(x - 1.5_f64).powi(2)).exp() + 0.1 * (x - 3.0).max(0.0).powi(2);
    let found = find(0.0, 6.0, bump);
    let exact = 1.5 - (0.52_f64 / 0.5).ln().sqrt();
    assert!(is_near(root(&found).0, exact, 1e-3) && found.samples.len() < 20, "{found:?}");
    // The reciprocal has a minimum there.
    let found = find(0.0, 6.0, |x| 1.0 / bump(x));
    assert!(!root(&found).1 && is_near(root(&found).0, exact, 1e-3), "{found:?}");
}

#[test]
fn a_maximum_that_stays_below_is_no_root() {
    let found = find(0.0, 6.0, |x| 0.5 + 0.49 * (-(x - 1.5_f64).powi(2)).exp() + 0.1 * (x - 3.0).max(0.0).powi(2));
    let (value, _) = root(&found);
    assert!(is_near(value, 3.0 + (5.0_f64 - 4.9 * (-5.0_f64).exp()).sqrt(), 0.02), "{found:?}");
}

#[test]
fn nowhere_and_everywhere() {
    let found = find(0.1, 10.0, |speed| 0.05 * speed);
    assert!(found.root.is_none() && found.is_complete && found.samples.len() == 7, "{found:?}");
    let found = find(0.1, 10.0, |speed| 20.0 * speed);
    assert!(found.root.is_none() && found.is_complete && found.samples.len() == 7, "{found:?}");
    // A key without effect, and an impact that misses the body.
    for constant in [0.0, 0.999, 1.5] {
        let found = find(0.0, 1.0, |_| constant);
        assert!(found.root.is_none() && found.is_complete && found.samples.len() == 7, "{found:?}");
    }
}

#[test]
fn ends_may_be_roots() {
    assert!(is_near(root(&find(1.0, 10.0, |x| x / 10.0)).0, 10.0, 1e-3));
    // The strength is reached exactly at the lower end and exceeded everywhere else: there is no change of sign.
    assert!(find(1.0, 10.0, |x| x).root.is_none());
}

#[test]
fn a_jump_is_told() {
    let found = find(1.0, 2.0, |x| if x < 1.37 { 0.8 * x / 1.37 } else { 1.3 });
    let root = found.root.unwrap();
    assert!(root.is_jump && root.at.ratio > 1.0 && is_near(root.at.value, 1.37, 1e-3), "{found:?}");
}

/// At zero there is no relative accuracy of the value. The search has to end all the same, after few runs.
#[test]
fn a_jump_at_zero_is_told() {
    let found = find(-1.0, 1.1, |x| if x < 0.0 { 0.8 } else { 1.3 });
    let root = found.root.unwrap();
    assert!(root.is_jump && root.is_converged && root.at.ratio > 1.0, "{found:?}");
    assert!(root.at.value.abs() < 1e-5 && found.samples.len() < 30, "{found:?}");
}

/// A target that no number of iterations reaches: the best point is returned, and it is said that it is not accurate.
#[test]
fn a_search_without_convergence_is_told() {
    let target = Target { function: 0.0, relative: 0.0, jump: 1e-2 };
    let bracket = [(0.2, -2.0), (0.9, 0.5)].map(|(place, function)| Point { place, function });
    let mut function = |place: f64| Ok::<_, ()>(if place < 0.3 { -2.0 } else { 0.5 });
    let narrowed = narrow(bracket, &target, &range(1.0, 2.0), &mut function).unwrap();
    assert!(!narrowed.is_converged && narrowed.place >= 0.3, "{}", narrowed.place);
}

#[test]
fn the_first_error_ends_it() {
    let mut runs = 0;
    let failed = search(&range(0.0, 1.0), TOLERANCE, |_| {
        runs += 1;
        if runs == 3 { Err("third") } else { Ok(0.5) }
    });
    assert_eq!((failed, runs), (Err("third"), 3));
}

/// Noise between −1 and 1, like the rounding, basis and discretisation errors of runs.
fn noise(value: f64) -> f64 {
    (1e6 * value).sin()
}

proptest! {
    /// Any power law takes few runs, also with noise.
    #[test]
    fn powers(exact in 0.11..9.9_f64, power in 0.3..3.0_f64, rises: bool, amplitude in 0.0..1e-4_f64) {
        let power = if rises { power } else { -power };
        let found = find(0.1, 10.0, |x| (x / exact).powf(power) * (1.0 + amplitude * noise(x)));
        let (value, is_rising) = root(&found);
        prop_assert_eq!(is_rising, rises);
        prop_assert!(is_near(value, exact, 1e-3) && found.samples.len() < MAX_RUNS, "{:?}", found);
    }

    /// A noisy plateau below the strength hides no root and does not cost many runs.
    #[test]
    fn plateaus(height in 0.9..0.999_f64, edge in 2.0..5.0_f64) {
        let ratio = |x: f64| (height + (x - edge).max(0.0).powi(2)) * (1.0 + 1e-4 * noise(x));
        let found = find(0.0, 6.0, ratio);
        let exact = edge + (1.0 - height).sqrt();
        prop_assert!(is_near(root(&found).0, exact, 5e-3) && found.samples.len() < 25, "{:?}", found);
    }

    /// The lowest of many roots of a wave that is long compared with the grid.
    #[test]
    fn waves(phase in 0.0..6.2_f64, length in 4.0..9.0_f64, mean in 0.75..0.95_f64) {
        let ratio = |x: f64| mean + 0.3 * (x * std::f64::consts::TAU / length + phase).sin();
        let found = find(0.0, 6.0, ratio);
        let below = ratio(0.0) < 1.0;
        let fine = (0..=60_000).map(|n| 1e-4 * f64::from(n)).find(|x| (ratio(*x) < 1.0) != below);
        match (fine, found.root) {
            (Some(exact), Some(root)) => prop_assert!((root.at.value - exact).abs() < 0.02, "{} {:?}", exact, found),
            (None, None) => {}
            // A maximum within a quarter of the tolerance of 1 may be missed.
            (Some(exact), None) => {
                let top = mean + 0.3;
                prop_assert!(top < 1.0 + 0.25 * TOLERANCE || exact > 5.8, "{} {:?}", exact, found);
            }
            (None, Some(_)) => prop_assert!(false, "{:?}", found),
        }
    }
}
