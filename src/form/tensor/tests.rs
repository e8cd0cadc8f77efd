//! Tests of sums over tensor products against numerical quadrature and exact values.

use super::*;
use crate::element::gauss_legendre;

const BREAKS: [&[f64]; 3] = [&[-0.3, 0.1, 0.25, 1.0], &[0.0, 0.4, 1.0], &[-0.1, 0.1]];

/// Two fields of different degrees on a box.
fn tensor() -> Tensor<3> {
    let field = |degrees: [usize; 3]| [0, 1, 2].map(|axis| Spline::new(BREAKS[axis], degrees[axis], degrees[axis] - 1));
    Tensor::new(vec![field([2, 3, 1]), field([3, 2, 2])])
}

/// Quadrature points and weights of a place, exact up to degree 9.
fn points(place: [Along; 3]) -> Vec<([f64; 3], f64)> {
    let axes = [0, 1, 2].map(|axis| match place[axis] {
        Along::At(x) => vec![(x, 1.0)],
        Along::All | Along::Within(_) | Along::Projected => BREAKS[axis]
            .windows(2)
            .map(|cell| match place[axis] {
                Along::Within([start, end]) => [cell[0].max(start), cell[1].min(end)],
                _ => [cell[0], cell[1]],
            })
            .filter(|[from, to]| from < to)
            .flat_map(|cell| {
                let (middle, half) = (0.5 * (cell[0] + cell[1]), 0.5 * (cell[1] - cell[0]));
                gauss_legendre(5).into_iter().map(move |(x, w)| (middle + half * x, half * w))
            })
            .collect(),
    });
    indices(axes.each_ref().map(|axis| 0..axis.len()))
        .map(|index| {
            let at = [0, 1, 2].map(|axis| axes[axis][index[axis]]);
            (at.map(|(x, _)| x), at.iter().map(|(_, w)| w).product())
        })
        .collect()
}

const PLACES: [[Along; 3]; 5] = [
    [Along::All; 3],
    [Along::At(1.0), Along::All, Along::All],
    [Along::All, Along::At(0.3), Along::At(-0.1)],
    [Along::At(-0.3), Along::All, Along::All],
    [Along::All, Along::Within([-0.1, 0.2]), Along::All],
];

/// The assembled integrals are equal to a quadrature with values at points.
#[test]
fn integrals_are_those_by_quadrature() {
    let tensor = tensor();
    let n = tensor.unknowns();
    let part = |field, derivatives| Derivative { field, derivatives };
    let squares: Vec<Square<3>> = PLACES
        .iter()
        .zip([
            vec![part(0, [1, 0, 0]), part(1, [0, 1, 0]), part(0, [0, 2, 1])],
            vec![part(1, [0, 0, 1]), part(0, [0, 0, 0])],
            vec![part(0, [0, 0, 0])],
            vec![part(1, [2, 1, 0])],
        ])
        .zip([1.5, -0.3, 2.0, 0.7])
        .map(|((&place, parts), factor)| Square {
            factor,
            parts: [0.4, -1.0, 1.3].into_iter().zip(parts).collect(),
            place,
        })
        .collect();
    let (mut exact, mut vector) = (DMatrix::zeros(n, n), DVector::zeros(n));
    let mut linear = Vec::new();
    for Square { factor, parts, place } in &squares {
        linear.push(Linear { factor: *factor, part: parts[0].1, place: *place });
        for (point, weight) in points(*place) {
            let mut sums = [vec![0.0; n], vec![0.0; n]];
            parts.iter().for_each(|(weight, part)| tensor.add_point(*part, point, *weight, &mut sums[0]));
            tensor.add_point(parts[0].1, point, 1.0, &mut sums[1]);
            let [all, first] = sums.map(DVector::from_vec);
            exact += factor * weight * &all * all.transpose();
            vector += factor * weight * first;
        }
    }
    let matrix = DMatrix::from(&tensor.matrix(&squares));
    assert_eq!(matrix, matrix.transpose());
    // Rounding of some hundred terms.
    assert!((&matrix - &exact).amax() < 1e-12 * exact.amax());
    assert!((DVector::from_vec(tensor.vector(&linear)) - &vector).amax() < 1e-13 * vector.amax());
}

/// The vector of a line is the sum of the vectors of its points.
#[test]
fn lines_are_sums_of_points() {
    let tensor = tensor();
    let part = Derivative { field: 1, derivatives: [1, 0, 1] };
    for axis in 0..3 {
        let (mut sums, point) = ([0, 1].map(|_| vec![0.0; tensor.unknowns()]), [0.2, 0.5, 0.03]);
        let line = [(0.05, 0.3), (0.07, -1.5), (0.09, 2.0)];
        tensor.add_line((part, 0.7), (point, axis), &line, &mut sums[0]);
        for (place, weight) in line {
            let mut point = point;
            point[axis] = place;
            tensor.add_point(part, point, 0.7 * weight, &mut sums[1]);
        }
        let [of_line, of_points] = sums.map(DVector::from_vec);
        // Rounding of three terms.
        assert!((of_line - &of_points).amax() < 1e-14 * of_points.amax(), "{axis}");
    }
}

/// For all derivatives and places, the non-zero entries are among the non-zero entries of the undifferentiated
/// products.
#[test]
fn patterns_are_nested() {
    let tensor = tensor();
    let matrix = |parts: &[Derivative<3>], place| tensor.matrix(&[Square::of_sum(1.0, parts, place)]);
    let fields = [0, 1].map(|field| Derivative { field, derivatives: [0; 3] });
    let all = DMatrix::from(&matrix(&fields, [Along::All; 3]));
    for place in PLACES {
        let rough = [0, 1].map(|field| Derivative { field, derivatives: [1, 0, 1] });
        for (i, j, _) in matrix(&rough, place).triplet_iter() {
            assert!(all[(i, j)] != 0.0, "{place:?}: {i} {j}");
        }
    }
}

/// Unknowns are numbered by field and function, and the functions of a field sum to 1.
#[test]
fn numbers_and_ones() {
    let tensor = tensor();
    let numbers: Vec<usize> = (0..2)
        .flat_map(|field| {
            let counts = tensor.splines(field).each_ref().map(|spline| 0..spline.functions());
            indices(counts).map(|functions| tensor.unknown(field, functions)).collect::<Vec<_>>()
        })
        .collect();
    assert_eq!(numbers, (0..tensor.unknowns()).collect::<Vec<_>>());
    let mut values = vec![0.0; tensor.unknowns()];
    tensor.add_point(Derivative { field: 1, derivatives: [0; 3] }, [0.2, 0.7, 0.03], 3.0, &mut values);
    let sum: f64 = values.iter().zip(tensor.one(1)).map(|(v, one)| v * one).sum();
    assert!((sum - 3.0).abs() < 1e-14);
}
