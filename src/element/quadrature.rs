//! Quadrature rules on the reference cells, with points inside and positive weights.

use std::cell::RefCell;
use std::collections::BTreeMap;

use super::Shape;

/// Points and weights; the weights sum to the measure of the reference cell.
#[derive(Debug, Clone)]
pub struct Quadrature {
    /// Points on the reference cell; on a facet ζ = 0.
    pub points: Vec<[f64; 3]>,
    /// One weight per point.
    pub weights: Vec<f64>,
}

impl Quadrature {
    /// The smallest available rule that is exact for polynomials up to `degree`: the total degree on simplices, the
    /// degree in each coordinate on other shapes.
    ///
    /// On simplices these are symmetric rules up to degree 4 (triangle: Strang & Fix 1973, Dunavant 1985) and 5
    /// (tetrahedron: Walkington 2000), and collapsed products for higher degrees. On other shapes they are
    /// Gauss–Legendre products.
    pub fn exact(shape: Shape, degree: usize) -> Self {
        match (shape, degree) {
            (Shape::Quadrilateral | Shape::Hexahedron, _) => product(shape, degree),
            (Shape::Triangle, 0..=1) => symmetric(shape, &[(0.5, &[1. / 3.; 3])]),
            (Shape::Triangle, 2) => symmetric(shape, &[(1. / 6., &[2. / 3., 1. / 6., 1. / 6.])]),
            (Shape::Triangle, 3..=4) => triangle4(),
            (Shape::Tetrahedron, 0..=1) => symmetric(shape, &[(1. / 6., &[0.25; 4])]),
            (Shape::Tetrahedron, 2) => {
                let a = (5. - 5_f64.sqrt()) / 20.;
                symmetric(shape, &[(1. / 24., &[1. - 3. * a, a, a, a])])
            }
            (Shape::Tetrahedron, 3..=5) => tetrahedron5(),
            (Shape::Triangle | Shape::Tetrahedron, _) => collapsed(shape, degree),
        }
    }
}

/// The 6-point rule of degree 4 in closed form (a solution of the moment equations).
fn triangle4() -> Quadrature {
    let ten = 10_f64.sqrt();
    let a = (38. - 44. * 0.4_f64.sqrt()).sqrt();
    let w = (213_125. - 53_320. * ten).sqrt();
    let orbit = |a: f64| [1. - 2. * a, a, a];
    symmetric(
        Shape::Triangle,
        &[((620. - w) / 7440., &orbit((8. - ten - a) / 18.)), ((620. + w) / 7440., &orbit((8. - ten + a) / 18.))],
    )
}

/// Walkington's 14-point rule of degree 5.
fn tetrahedron5() -> Quadrature {
    let orbit = |a: f64| [1. - 3. * a, a, a, a];
    let (a, b, c) = (0.310_885_919_263_300_6, 0.092_735_250_310_891_23, 0.045_503_704_125_649_65);
    symmetric(
        Shape::Tetrahedron,
        &[
            (0.018_781_320_953_002_642, &orbit(a)),
            (0.012_248_840_519_393_658, &orbit(b)),
            (0.007_091_003_462_846_911, &[0.5 - c, 0.5 - c, c, c]),
        ],
    )
}

/// Rule from its orbits: a weight and barycentric coordinates, taken in every distinct order.
fn symmetric(shape: Shape, orbits: &[(f64, &[f64])]) -> Quadrature {
    let mut rule = Quadrature { points: Vec::new(), weights: Vec::new() };
    for &(weight, barycentric) in orbits {
        for l in arrangements(barycentric) {
            let mut point = [0.; 3];
            point[..shape.dimension()].copy_from_slice(&l[1..]);
            rule.points.push(point);
            rule.weights.push(weight);
        }
    }
    rule
}

/// All distinct orders of the values.
fn arrangements(values: &[f64]) -> Vec<Vec<f64>> {
    if values.is_empty() {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    for (i, &first) in values.iter().enumerate() {
        if values[..i].contains(&first) {
            continue;
        }
        let rest = [&values[..i], &values[i + 1..]].concat();
        for mut tail in arrangements(&rest) {
            tail.insert(0, first);
            all.push(tail);
        }
    }
    all
}

/// Gauss–Legendre product rule.
fn product(shape: Shape, degree: usize) -> Quadrature {
    let line = gauss_legendre(degree / 2 + 1);
    let mut rule = Quadrature { points: vec![[0.; 3]], weights: vec![1.] };
    for d in 0..shape.dimension() {
        let mut next = Quadrature { points: Vec::new(), weights: Vec::new() };
        for &(x, w) in &line {
            for (&point, &weight) in rule.points.iter().zip(&rule.weights) {
                let mut point = point;
                point[d] = x;
                next.points.push(point);
                next.weights.push(w * weight);
            }
        }
        rule = next;
    }
    rule
}

/// Product rule on the cube (square), collapsed onto the simplex (Duffy 1982).
fn collapsed(shape: Shape, degree: usize) -> Quadrature {
    let dimension = shape.dimension();
    // The collapse multiplies the integrand by at most (1−s)^(dimension−1).
    let (cube, degree) = match shape {
        Shape::Tetrahedron => (Shape::Hexahedron, degree + 2),
        _ => (Shape::Quadrilateral, degree + 1),
    };
    let mut rule = product(cube, degree);
    for (point, weight) in rule.points.iter_mut().zip(&mut rule.weights) {
        // Remaining edge length at this point; the Jacobian determinant is the product of these lengths.
        let mut left = 1.;
        for x in &mut point[..dimension] {
            let s = 0.5 * (1. + *x);
            *x = left * s;
            *weight *= 0.5 * left;
            left *= 1. - s;
        }
    }
    rule
}

thread_local! {
    /// Rules by their number of points, kept because computing a rule takes longer than many evaluations with it.
    static MADE: RefCell<BTreeMap<usize, Vec<(f64, f64)>>> = const { RefCell::new(BTreeMap::new()) };
}

/// Nodes and weights of the `n`-point Gauss–Legendre rule on \[−1, 1\].
pub fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    MADE.with_borrow_mut(|made| made.entry(n).or_insert_with(|| (0..n).map(|i| gauss_point(n, i)).collect()).clone())
}

/// Node and weight `i` of the `n`-point Gauss–Legendre rule.
fn gauss_point(n: usize, i: usize) -> (f64, f64) {
    let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
    // From this start, Newton's method converges to all digits in at most five steps for any n.
    for _ in 0..6 {
        let (p, slope) = legendre(n, x);
        x -= p / slope;
    }
    let (_, slope) = legendre(n, x);
    (x, 2. / ((1. - x * x) * slope * slope))
}

/// The Legendre polynomial of degree `n` ≥ 1 and its slope, for |x| < 1.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut p) = (1., x);
    for k in 2..=n {
        let k = k as f64;
        (before, p) = (p, ((2. * k - 1.) * x * p - (k - 1.) * before) / k);
    }
    (p, n as f64 * (before - x * p) / (1. - x * x))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SHAPES: [Shape; 4] = [Shape::Triangle, Shape::Tetrahedron, Shape::Quadrilateral, Shape::Hexahedron];

    /// ∫ ξ^a η^b ζ^c over the reference cell: a! b! c! / (a+b+c+dimension)! on a simplex.
    fn exact_integral(shape: Shape, powers: [usize; 3]) -> f64 {
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        let dimension = shape.dimension();
        match shape {
            Shape::Triangle | Shape::Tetrahedron => {
                powers.iter().map(|&n| factorial(n)).product::<f64>()
                    / factorial(powers.iter().sum::<usize>() + dimension)
            }
            _ => powers[..dimension].iter().map(|&n| if n % 2 == 0 { 2. / (n as f64 + 1.) } else { 0. }).product(),
        }
    }

    #[test]
    fn rules_are_positive_inside_and_exact() {
        for shape in SHAPES {
            let simplex = matches!(shape, Shape::Triangle | Shape::Tetrahedron);
            for degree in 0..=12 {
                let rule = Quadrature::exact(shape, degree);
                assert!(rule.weights.iter().all(|&w| w > 0.));
                for p in &rule.points {
                    let inside = if simplex {
                        p.iter().all(|&x| x >= 0.) && p.iter().sum::<f64>() <= 1.
                    } else {
                        p.iter().all(|&x| x.abs() < 1.)
                    };
                    assert!(inside, "{shape:?} degree {degree}: {p:?}");
                }
                let top = if shape.dimension() == 3 { degree } else { 0 };
                for a in 0..=degree {
                    for b in 0..=degree {
                        for c in 0..=top {
                            if simplex && a + b + c > degree {
                                continue;
                            }
                            let sum: f64 = rule
                                .points
                                .iter()
                                .zip(&rule.weights)
                                .map(|(p, w)| w * p[0].powi(a as i32) * p[1].powi(b as i32) * p[2].powi(c as i32))
                                .sum();
                            let exact = exact_integral(shape, [a, b, c]);
                            let error = (sum - exact).abs() / exact_integral(shape, [0; 3]);
                            // Rounding of up to 7³ terms, whose absolute values sum to the measure.
                            assert!(error < 1.5e-15, "{shape:?} degree {degree}, {a} {b} {c}: {error:e}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn small_rules_have_their_known_size() {
        let size = |shape, degree| Quadrature::exact(shape, degree).weights.len();
        let sizes = |shape| [0, 1, 2, 3, 4, 5].map(|degree| size(shape, degree));
        assert_eq!(sizes(Shape::Triangle)[..5], [1, 1, 3, 6, 6]);
        assert_eq!(sizes(Shape::Tetrahedron), [1, 1, 4, 14, 14, 14]);
        assert_eq!(sizes(Shape::Hexahedron), [1, 1, 8, 8, 27, 27]);
    }

    /// Digits of the 6-point rule as published (Dunavant 1985, degree 4), with weights relative to the area.
    #[test]
    fn triangle_of_degree_4_is_the_symmetric_one() {
        let rule = Quadrature::exact(Shape::Triangle, 4);
        for (l, w, q) in
            [(0.816_847_572_980_459, 0.109_951_743_655_322, 0), (0.108_103_018_168_070, 0.223_381_589_678_011, 3)]
        {
            for q in q..q + 3 {
                let [x, y, _] = rule.points[q];
                let nearest = [x, y, 1. - x - y].map(|b| (b - l).abs()).into_iter().fold(1., f64::min);
                assert!(nearest < 1e-15 && (2. * rule.weights[q] - w).abs() < 1e-15);
            }
        }
    }
}
