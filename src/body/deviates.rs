//! Pseudo-random numbers that are equal on any number of ranks.

/// Returns an integer key for a node's position. Positions that differ only by rounding have the same key.
pub fn place(x: [f64; 3], diameter: f64) -> u64 {
    // The quantum is far above rounding and far below any cell size. Nodes lie at round numbers, so the boundaries
    // between quanta are shifted to other positions.
    let (quantum, seam) = (1e-9 * diameter, 0.381_966);
    x.iter().fold(0, |key, x| mix(key ^ ((x / quantum + seam).floor() as i64 as u64)))
}

/// Returns a normal deviate for a key (Box & Muller 1958).
pub fn normal(key: u64) -> f64 {
    let uniform = |key: u64| (mix(key) >> 11) as f64 / (1_u64 << 53) as f64;
    let (radius, angle) = (1.0 - uniform(key), uniform(!key));
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
}

/// Mixes a key so that every bit of the result depends on every bit of the input: the generator SplitMix64 (Steele, Lea
/// & Flood 2014).
fn mix(key: u64) -> u64 {
    let key = key.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let key = (key ^ (key >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let key = (key ^ (key >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    key ^ (key >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// On a grid, mean, variance and correlation of neighbours agree with independent normal deviates within four
    /// standard errors.
    #[test]
    fn deviates_on_a_grid_are_normal_and_independent() {
        let key = |i: usize| place([0.1 * (i % 100) as f64, 0.1 * (i / 100) as f64, 0.0], 10.0);
        let n = 10_000;
        let values: Vec<f64> =
            (0..n).flat_map(|i| [0, 1, 2].map(|component| normal(key(i).wrapping_add(component)))).collect();
        let chance = 4.0 / (values.len() as f64).sqrt();
        let mean_product = |lag: usize| {
            values.iter().zip(&values[lag..]).map(|(one, other)| one * other).sum::<f64>() / values.len() as f64
        };
        assert!((values.iter().sum::<f64>() / values.len() as f64).abs() < chance);
        // The variance of the square of a deviate is 2.
        assert!((mean_product(0) - 1.0).abs() < chance * 2_f64.sqrt());
        for lag in [1, 2, 3, 300] {
            assert!(mean_product(lag).abs() < chance, "{lag}");
        }
    }

    #[test]
    fn a_place_bears_rounding() {
        for x in [[0.1 + 0.2, -0.5, 1.0 / 3.0], [0.0, 1e-3, 0.25]] {
            let rounded = x.map(|x| x * (1.0 + f64::EPSILON) - 1e-17);
            assert_eq!(place(x, 2.0), place(rounded, 2.0));
            assert_ne!(place(x, 2.0), place([x[0] + 1e-6, x[1], x[2]], 2.0));
        }
    }
}
