//! Properties of the integrals over facets and of the linearisation of the contact.

use nalgebra::{DMatrix, DVector, Vector3};
use proptest::prelude::*;
use ricochet::contact::{Hertz, hertz};
use ricochet::description::Extent;
use ricochet::element::{Element, Quadrature, Shape};
use ricochet::form::{Foundation, PadElement, SurfaceElement};
use ricochet::space::finite_element::FacetRule;

const FACETS: [Shape; 2] = [Shape::Triangle, Shape::Quadrilateral];
const K: [f64; 3] = [2e9, 3e9, 5e9];

/// Four points, of which a triangle uses three: the corners of the square [−1, 1]², each moved by up to 0.2 in space.
fn points() -> impl Strategy<Value = Vec<[f64; 3]>> {
    prop::collection::vec(prop::array::uniform3(-0.2f64..0.2), 4).prop_map(|shifts| {
        let square = Shape::Quadrilateral.reference_vertices();
        let moved = square.iter().zip(shifts);
        moved.map(|(x, s)| [0, 1, 2].map(|d| x[d] + s[d])).collect()
    })
}

fn vertices(shape: Shape, points: &[[f64; 3]]) -> &[[f64; 3]] {
    &points[..shape.reference_vertices().len()]
}

/// The surface element of a whole facet.
fn facet(shape: Shape, order: usize, x: &[[f64; 3]]) -> SurfaceElement {
    FacetRule::new(shape, order).element(x, &Extent::All)
}

fn pad(facet: &SurfaceElement, normal: [f64; 3], displacement: [f64; 3]) -> PadElement {
    PadElement::new(facet, &Foundation { stiffness: K, normal, displacement })
}

fn spring(shape: Shape, order: usize, x: &[[f64; 3]], k: [f64; 3]) -> DMatrix<f64> {
    let facet = facet(shape, order, x);
    let size = facet.unknowns;
    let mut out = vec![f64::NAN; size * size];
    facet.spring(k, &mut out);
    DMatrix::from_row_slice(size, size, &out)
}

fn residual(pad: &PadElement, u: &DVector<f64>) -> DVector<f64> {
    let mut out = vec![f64::NAN; u.len()];
    pad.residual(None, u.as_slice(), &mut out);
    DVector::from_vec(out)
}

fn tangent(pad: &PadElement, u: &DVector<f64>) -> DMatrix<f64> {
    let mut out = vec![f64::NAN; u.len() * u.len()];
    pad.tangent(None, u.as_slice(), &mut out);
    DMatrix::from_row_slice(u.len(), u.len(), &out)
}

/// Derivative of `f` in every direction by central differences.
fn differences(u: &DVector<f64>, step: f64, f: impl Fn(&DVector<f64>) -> DVector<f64>) -> DMatrix<f64> {
    let columns: Vec<DVector<f64>> = (0..u.len())
        .map(|i| {
            let shifted = |sign: f64| {
                let mut u = u.clone();
                u[i] += sign * step;
                f(&u)
            };
            (shifted(1.) - shifted(-1.)) / (2. * step)
        })
        .collect();
    DMatrix::from_columns(&columns)
}

/// u − ū at the quadrature points of the pad, component by component.
fn relative(shape: Shape, order: usize, u: &DVector<f64>, at: [f64; 3]) -> Vec<f64> {
    let element = Element::new(shape, order);
    let mut values = vec![0.; element.nodes()];
    let rule = Quadrature::exact(shape, 2 * order);
    rule.points
        .iter()
        .flat_map(|&xi| {
            element.values(xi, &mut values);
            [0, 1, 2].map(|c| (0..values.len()).map(|a| values[a] * u[3 * a + c]).sum::<f64>() - at[c])
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn spring_sums_to_stiffness_times_area_by_component(points in points()) {
        for shape in FACETS {
            let x = vertices(shape, &points);
            for order in [1, 2] {
                let area = facet(shape, order, x).area();
                let s = spring(shape, order, x, K);
                prop_assert!(s == s.transpose());
                prop_assert!(s.clone().cholesky().is_some());
                for (c, k) in K.into_iter().enumerate() {
                    let e = DVector::from_fn(s.nrows(), |i, _| f64::from(u8::from(i % 3 == c)));
                    let row = &s * &e;
                    prop_assert!((row.dot(&e) / (k * area) - 1.).abs() < 1e-13);
                    // Components are not coupled.
                    prop_assert!(row.iter().enumerate().all(|(i, &r)| i % 3 == c || r == 0.));
                }
            }
        }
    }

    /// The area of a flat polygon equals the area of its triangles.
    #[test]
    fn area_of_flat_facets(points in points(), lift in prop::array::uniform2(-1f64..1.)) {
        let flat: Vec<[f64; 3]> = points
            .iter()
            .map(|p| [p[0], p[1], lift[0] * p[0] + lift[1] * p[1]])
            .collect();
        let triangle = |v: [usize; 3]| {
            let [a, b, c] = v.map(|v| Vector3::from(flat[v]));
            (b - a).cross(&(c - a)).norm() / 2.
        };
        for (shape, exact) in [
            (Shape::Triangle, triangle([0, 1, 2])),
            (Shape::Quadrilateral, triangle([0, 1, 2]) + triangle([0, 2, 3])),
        ] {
            let area = facet(shape, 2, vertices(shape, &flat)).area();
            prop_assert!((area / exact - 1.).abs() < 1e-14);
        }
    }

    /// A traction that is a field of the space acts like springs stretched by that field.
    #[test]
    fn traction_of_a_linear_field(points in points()) {
        let field = |x: [f64; 3]| [1. + x[1], x[2] - 2. * x[0], 3. * x[1]];
        for shape in FACETS {
            let x = vertices(shape, &points);
            for order in [1, 2] {
                let facet = facet(shape, order, x);
                let mut out = vec![f64::NAN; facet.unknowns];
                facet.traction(field, &mut out);
                let nodal = Element::new(shape, order).node_vertices().iter().flat_map(|of| {
                    field([0, 1, 2].map(|d| of.iter().map(|&v| x[v][d]).sum::<f64>() / of.len() as f64))
                });
                let nodal = DVector::from_iterator(out.len(), nodal);
                let expected = spring(shape, order, x, [1.; 3]) * nodal;
                prop_assert!((DVector::from_vec(out) - expected).amax() < 1e-14);
            }
        }
    }

    #[test]
    fn pad_residual_is_the_gradient_of_the_potential_and_tangent_that_of_the_residual(
        points in points(),
        u in prop::collection::vec(-1f64..1., 27),
        normal in prop::array::uniform3(prop::sample::select(vec![-0.6, 0., 0.8])),
        at in prop::array::uniform3(-0.2f64..0.2),
    ) {
        for shape in FACETS {
            let x = vertices(shape, &points);
            for order in [1, 2] {
                let facet = facet(shape, order, x);
                let pad = pad(&facet, normal, at);
                let u = DVector::from_column_slice(&u[..facet.unknowns]);
                let step = 1e-5;
                // Away from the kink the potential is quadratic: differences are exact except for rounding over the
                // step. No shape function exceeds 1, so no point crosses its kink.
                if relative(shape, order, &u, at).iter().any(|g| g.abs() < 2. * step) {
                    continue;
                }
                let r = residual(&pad, &u);
                let slope = differences(&u, step, |u| {
                    DVector::from_element(1, pad.potential(u.as_slice()))
                });
                prop_assert!((slope.transpose() - &r).amax() < 1e-10 * K[2]);
                let slope = differences(&u, step, |u| residual(&pad, u));
                let t = tangent(&pad, &u);
                prop_assert!(t == t.transpose());
                prop_assert!((slope - t).amax() < 1e-10 * K[2]);
            }
        }
    }

    /// A pad that is pressed in everywhere is a spring. A pad that is open everywhere has no force. It acts only in
    /// components where n is not zero.
    #[test]
    fn pad_is_a_spring_or_nothing(
        points in points(),
        depth in prop::array::uniform3(0.1f64..1.),
        at in prop::array::uniform3(-0.2f64..0.2),
        sign in prop::array::uniform3(prop::sample::select(vec![-1f64, 1.])),
        absent in 0usize..3,
    ) {
        let mut normal = sign;
        normal[absent] = 0.;
        let acting = [0, 1, 2].map(|c| K[c] * normal[c].abs());
        for shape in FACETS {
            let x = vertices(shape, &points);
            for order in [1, 2] {
                let facet = facet(shape, order, x);
                let pad = pad(&facet, normal, at);
                let n = facet.unknowns / 3;
                let pressed = |by: f64| {
                    DVector::from_fn(3 * n, |i, _| at[i % 3] + by * sign[i % 3] * depth[i % 3])
                };
                let s = spring(shape, order, x, acting);
                let stretch = DVector::from_fn(3 * n, |i, _| sign[i % 3] * depth[i % 3]);
                let (u, off) = (pressed(1.), pressed(-1.));
                let force = &s * &stretch;
                prop_assert!((residual(&pad, &u) - &force).amax() < 1e-14 * K[2]);
                prop_assert!((tangent(&pad, &u) - &s).amax() < 1e-14 * K[2]);
                let mut of_pressed = DVector::from_element(3 * n, f64::NAN);
                pad.pressed(off.as_slice(), of_pressed.as_mut_slice());
                prop_assert!((of_pressed - &s * &off).amax() < 1e-14 * K[2], "pressed whatever u is");
                let energy = force.dot(&stretch) / 2.;
                prop_assert!((pad.potential(u.as_slice()) / energy - 1.).abs() < 1e-13);
                prop_assert_eq!(residual(&pad, &off).amax(), 0.);
                prop_assert_eq!(tangent(&pad, &off).amax(), 0.);
                prop_assert_eq!(pad.potential(off.as_slice()), 0.);
            }
        }
    }

    /// The paper's A = a aᵀ: the derivative of â F(âᵀU) is F′ â âᵀ.
    #[test]
    fn contact_matrix_is_the_derivative_of_the_contact_force(
        a in prop::collection::vec(-1f64..1., 6),
        u in prop::collection::vec(-1e-4f64..1e-4, 6),
        indentation in 1e-5f64..1e-3,
    ) {
        let law = Hertz { stiffness: hertz::stiffness(0.05, (70e9, 0.23), (210e9, 0.3)) };
        let mut localisation: Vec<f64> = a.iter().map(|a| -a).collect();
        localisation.push(1.);
        let localisation = DVector::from_vec(localisation);
        let mut state = DVector::from_vec([u, vec![0.]].concat());
        state[6] = indentation - localisation.dot(&state);
        let force = |u: &DVector<f64>| &localisation * law.force(localisation.dot(u));
        let matrix = &localisation * localisation.transpose() * law.tangent(indentation);
        // Error of the differences: (step/α)²/24, and rounding over step/α; below 1e-8 for α ≥ 1000 steps.
        let slope = differences(&state, 1e-5 * indentation, force);
        prop_assert!((slope - &matrix).amax() < 1e-8 * matrix.amax());
    }
}

/// Potential and resultant of a given field on the bottom of a plate of 0.5×0.5 m, with 10×10 squares divided into
/// triangles. The expected values are from the independent FEniCS solution for its pad case, where 526 of 1200 points
/// are loaded.
#[test]
fn pad_of_the_reference_plate() {
    let field = |x: f64, y: f64| 1e-3 * (x + 0.37 * y + 0.031);
    let foundation = Foundation { stiffness: [1e9; 3], normal: [0., 0., -1.], displacement: [0.; 3] };
    let element = Element::new(Shape::Triangle, 2);
    let (mut potential, mut resultant) = (0., 0.);
    for square in 0..100 {
        let at = |i: usize, j: usize| {
            let along = |i: usize| i as f64 * 0.05 - 0.25;
            [along(square % 10 + i), along(square / 10 + j), -0.01]
        };
        // The squares are divided like dolfin divides a box: along the diagonal of the first vertex.
        for x in [[at(0, 0), at(1, 1), at(1, 0)], [at(0, 0), at(0, 1), at(1, 1)]] {
            let nodal = element.node_vertices().iter().flat_map(|of| {
                let mean = |d: usize| of.iter().map(|&v| x[v][d]).sum::<f64>() / of.len() as f64;
                [0., 0., field(mean(0), mean(1))]
            });
            let u = DVector::from_iterator(18, nodal);
            let pad = PadElement::new(&facet(Shape::Triangle, 2, &x), &foundation);
            potential += pad.potential(u.as_slice());
            resultant -= residual(&pad, &u).sum();
        }
    }
    // Rounding of 526 terms.
    assert!((potential / 1.031_435_982_040_183_3 - 1.).abs() < 1e-13, "{potential}");
    assert!((resultant / 12_703.800_332_550_545 - 1.).abs() < 1e-13, "{resultant}");
}
