//! Adaptive quadrature of vector-valued functions on an interval.

/// Non-negative nodes of the 15-point Kronrod rule on \[−1, 1\], each with its Kronrod weight and its weight in the
/// 7-point Gauss rule. Every second node belongs to the Gauss rule (Piessens et al., QUADPACK, 1983, QK15).
const KRONROD: [(f64, f64, f64); 8] = [
    (0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.),
    (0.949_107_912_342_758_5, 0.063_092_092_629_978_55, 0.129_484_966_168_869_7),
    (0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.),
    (0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_64),
    (0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.),
    (0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9),
    (0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.),
    (0., 0.209_482_141_084_727_82, 0.417_959_183_673_469_4),
];

/// Maximum number of successive bisections; the remaining piece is then negligible.
const DEEPEST: usize = 50;

/// Computes ∫ f over an interval. The interval is bisected until the rules of 7 and 15 points agree to the absolute
/// tolerance on every piece, in every component. The result is computed with 15 points, whose error is far smaller
/// where f is smooth.
pub fn adaptive<const N: usize>(
    (begin, end): (f64, f64),
    tolerance: f64,
    f: &mut impl FnMut(f64) -> [f64; N],
) -> [f64; N] {
    let mut sum = [0.; N];
    add((begin, end), tolerance, DEEPEST, f, &mut sum);
    sum
}

fn add<const N: usize>(
    (begin, end): (f64, f64),
    tolerance: f64,
    depth: usize,
    f: &mut impl FnMut(f64) -> [f64; N],
    sum: &mut [f64; N],
) {
    let (middle, half) = (0.5 * (begin + end), 0.5 * (end - begin));
    let (mut fine, mut coarse) = ([0.; N], [0.; N]);
    for (node, kronrod, gauss) in KRONROD {
        for x in [middle - half * node, middle + half * node].into_iter().take(1 + usize::from(node > 0.)) {
            for ((fine, coarse), value) in fine.iter_mut().zip(&mut coarse).zip(f(x)) {
                *fine += half * kronrod * value;
                *coarse += half * gauss * value;
            }
        }
    }
    let apart = fine.iter().zip(&coarse).fold(0., |most: f64, (fine, coarse)| most.max((fine - coarse).abs()));
    if apart > tolerance && depth > 0 {
        add((begin, middle), tolerance, depth - 1, f, sum);
        add((middle, end), tolerance, depth - 1, f, sum);
        return;
    }
    for (sum, fine) in sum.iter_mut().zip(fine) {
        *sum += fine;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The Kronrod rule is exact up to degree 23, and the Gauss rule up to 13; up to there, no piece is bisected.
    #[test]
    fn rules_have_their_degree() {
        for degree in 0..=23 {
            let [fine] = adaptive((-1., 1.), f64::INFINITY, &mut |x| [x.powi(degree)]);
            let exact = if degree % 2 == 0 { 2. / (f64::from(degree) + 1.) } else { 0. };
            // The weights sum to 2; rounding of the weights and of 15 terms.
            assert!((fine - exact).abs() < 1e-15, "degree {degree}: {fine}");
            let mut calls = 0;
            adaptive((-1., 1.), 1e-15, &mut |x: f64| {
                calls += 1;
                [x.powi(degree)]
            });
            assert_eq!(calls == 15, degree <= 13 || degree % 2 == 1, "degree {degree}");
        }
    }

    /// ∫ √x, ∫ x^{3/2} and a near pole: similar singularities occur at a disc's rim and at an edge near the centre.
    #[test]
    fn ends_with_roots_and_near_poles_are_resolved() {
        let near = 1e-6;
        let [root, cube, pole] =
            adaptive((0., 1.), 1e-14, &mut |x: f64| [x.sqrt(), x.powf(1.5), near / (near * near + x * x)]);
        // Up to 50 pieces with an error of 1e-14 each.
        assert!((root - 2. / 3.).abs() < 1e-13, "{root}");
        assert!((cube - 0.4).abs() < 1e-13, "{cube}");
        assert!((pole - (1. / near).atan()).abs() < 1e-12, "{pole}");
    }
}
