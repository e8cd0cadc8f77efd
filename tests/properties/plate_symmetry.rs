//! Parts of a plate between planes of symmetry, and mirror images of a plate, give the same results as the whole plate.

use nalgebra::DVector;
use ricochet::space::evaluate::PointEvaluator;

use crate::plates::{Operator, THEORIES, a, answer, elastic, held, plate, scene};

/// Symmetric supports: springs, dampers, a foundation and clamps.
const SYMMETRIC: [&str; 3] = [
    "[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [2e9, 1e9, 3e9]\ndamping = [2e4, 1e4, 3e5]\n",
    "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\ncomponents = [\"z\"]\n\
     [[support]]\nsurface = \"bottom\"\nkind = \"elastic\"\nstiffness = [0, 0, 1e9]\n",
    "[[support]]\nsurface = \"x-min\"\nkind = \"clamped\"\n[[support]]\nsurface = \"x-max\"\nkind = \"clamped\"\n",
];

/// A quarter gives the same results as the whole, statically and at a Laplace parameter s (1/s).
#[test]
fn a_quarter_answers_as_the_whole() {
    for (rest, theory) in SYMMETRIC.iter().flat_map(|rest| THEORIES.map(|theory| (rest, theory))) {
        let [quarter, whole] = ["quarter", "none"].map(|symmetry| {
            let body = format!("size = [0.6, 0.4, 0.03]\nsymmetry = \"{symmetry}\"");
            let pressure = "[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -1]\n";
            plate(&scene(&body, "", &format!("{rest}{pressure}")), theory, 0.7)
        });
        assert_eq!((quarter.system.terms.multiplicity, whole.system.terms.multiplicity), (4.0, 1.0));
        for rate in [0.0, 1e3, 1e4] {
            let [one, other] = [&quarter, &whole].map(|plate| answer(plate, rate));
            // The discretisation error of the cells at the impact point, which differs between the two. It is largest
            // for a point force and for fast waves.
            assert!((one / other - 1.0).abs() < 1e-3, "{theory:?} {rate}: {one:e} {other:e}");
            let [one, other] = [&quarter, &whole]
                .map(|plate| a(plate).dot(&Operator::new(plate, rate).solve(plate, &plate.system.terms.load)));
            // The field is smooth, with splines of degree 5 on different cells: some cells of the whole plate at the
            // impact point have half the size.
            assert!((one / other - 1.0).abs() < 1e-5, "{theory:?} {rate}: {one:e} {other:e}");
        }
    }
}

/// The symmetric and antisymmetric motions of a part add up to the motion of the whole, under the impact point and at
/// points on all sides of the planes, at a Laplace parameter s. There is one plane or both, with the impact point on
/// one of them or on none.
#[test]
fn classes_of_motions_answer_as_the_whole() {
    let one_plane = "[[support]]\nsurface = \"x-min\"\nkind = \"clamped\"\n";
    let pressure = "[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -1]\n";
    let cases = [
        (SYMMETRIC[0], [0.13, -0.06], (4.0, 4)),
        (SYMMETRIC[1], [-0.13, 0.0], (4.0, 2)),
        (SYMMETRIC[2], [0.02, 0.06], (4.0, 4)),
        (one_plane, [0.1, -0.08], (2.0, 2)),
        (one_plane, [0.1, 0.0], (2.0, 1)),
    ];
    for ((rest, [x, y], (multiplicity, classes)), theory) in
        cases.into_iter().flat_map(|case| THEORIES.map(|theory| (case, theory)))
    {
        let [parts, whole] = ["auto", "none"].map(|symmetry| {
            let body = format!("size = [0.6, 0.4, 0.03]\nsymmetry = \"{symmetry}\"");
            let impactor = format!("point = [{x}, {y}, 0.015]");
            plate(&scene(&body, &impactor, &format!("{rest}{pressure}")), theory, 0.6)
        });
        assert_eq!((parts.system.terms.multiplicity, parts.system.classes), (multiplicity, classes));
        assert_eq!((whole.system.terms.multiplicity, whole.system.classes), (1.0, 1));
        {
            let rate = 1e4;
            let moved = [&parts, &whole].map(|plate| {
                let operator = Operator::new(plate, rate);
                let of_load = operator.solve(plate, &plate.system.terms.load);
                let force: Vec<f64> =
                    plate.system.terms.contact.force.iter().map(|a| a / plate.system.terms.multiplicity).collect();
                (operator.solve(plate, &force), of_load)
            });
            // The discretisation error of the cells at the impact point, which differs between the two; it is largest
            // for a point force.
            let [one, other] = [0, 1].map(|i| a([&parts, &whole][i]).dot(&moved[i].0));
            assert!((one / other - 1.0).abs() < 1e-3, "{theory:?} {rate}: {one:e} {other:e}");
            // Elsewhere the field is smooth.
            for point in [[0.2, 0.15, 0.015], [-0.2, 0.1, -0.015], [0.25, -0.1, 0.005], [-0.05, -0.17, 0.01]] {
                let at = |i: usize, u: &DVector<f64>| {
                    let forms = [&parts, &whole][i].points.at(point);
                    let read = |form: &[(usize, f64)]| form.iter().map(|(n, value)| value * u[*n]).sum::<f64>();
                    (forms.displacement.map(|form| read(&form)), forms.stress.map(|form| read(&form)))
                };
                for of in
                    [|m: &(DVector<f64>, DVector<f64>)| m.0.clone(), |m: &(DVector<f64>, DVector<f64>)| m.1.clone()]
                {
                    let [(one, of_one), (other, of_other)] = [0, 1].map(|i| at(i, &of(&moved[i])));
                    let [deflection, stress] = [&other[..], &of_other[..]]
                        .map(|values| values.iter().fold(0.0_f64, |most, value| most.max(value.abs())));
                    for i in 0..3 {
                        assert!((one[i] - other[i]).abs() < 2e-3 * deflection, "{theory:?} {rate}: {one:?} {other:?}");
                    }
                    for i in 0..6 {
                        assert!((of_one[i] - of_other[i]).abs() < 2e-2 * stress, "{of_one:?} {of_other:?}");
                    }
                }
            }
        }
    }
}

/// Mirror images, and the same plate along other axes or hit from below, give the same results.
#[test]
fn images_answer_alike() {
    let support = |names: [&str; 2]| held(names[0], r#"["x", "y", "z"]"#) + &elastic(names[1], "[2e9, 2e9, 2e9]");
    let cases = [
        ([0.6, 0.4, 0.03], [0.11, 0.05, 0.015], [0, 0, -1], ["x-min", "y-max"]),
        ([0.6, 0.4, 0.03], [-0.11, 0.05, 0.015], [0, 0, -1], ["x-max", "y-max"]),
        ([0.6, 0.4, 0.03], [-0.11, -0.05, -0.015], [0, 0, 1], ["x-max", "y-min"]),
        ([0.4, 0.6, 0.03], [0.05, 0.11, 0.015], [0, 0, -1], ["y-min", "x-max"]),
        ([0.03, 0.6, 0.4], [0.015, 0.11, 0.05], [-1, 0, 0], ["y-min", "z-max"]),
        ([0.4, 0.03, 0.6], [-0.05, -0.015, 0.11], [0, 1, 0], ["z-min", "x-min"]),
    ];
    for theory in THEORIES {
        let answers = cases.map(|(size, point, direction, names)| {
            let impactor = format!("point = {point:?}\ndirection = {direction:?}");
            answer(&plate(&scene(&format!("size = {size:?}"), &impactor, &support(names)), theory, 1.5), 1e3)
        });
        for answer in answers {
            // Rounding times the condition number of the operator.
            assert!((answer / answers[0] - 1.0).abs() < 1e-9, "{theory:?}: {answers:?}");
        }
    }
}
