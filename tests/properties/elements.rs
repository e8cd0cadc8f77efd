//! Properties of the elements on their reference cells, and of the geometry of facets.

use nalgebra::Vector3;
use proptest::prelude::*;
use ricochet::element::{Element, Shape, closest, normal};

const SHAPES: [Shape; 4] = [Shape::Triangle, Shape::Tetrahedron, Shape::Quadrilateral, Shape::Hexahedron];

fn elements() -> impl Iterator<Item = Element> {
    SHAPES.into_iter().flat_map(|shape| [1, 2].map(|order| Element::new(shape, order)))
}

fn values(element: &Element, xi: [f64; 3]) -> Vec<f64> {
    let mut out = vec![f64::NAN; element.nodes()];
    element.values(xi, &mut out);
    out
}

fn gradients(element: &Element, xi: [f64; 3]) -> Vec<[f64; 3]> {
    let mut out = vec![[f64::NAN; 3]; element.nodes()];
    element.gradients(xi, &mut out);
    out
}

/// Σ shape function values × vertex coordinates.
fn position(shape: Shape, x: &[[f64; 3]], xi: [f64; 3]) -> Vector3<f64> {
    values(&Element::new(shape, 1), xi).iter().zip(x).map(|(value, &vertex)| *value * Vector3::from(vertex)).sum()
}

/// A point of the box around the reference cell; ζ = 0 for a facet.
fn within(shape: Shape, xi: [f64; 3]) -> [f64; 3] {
    if shape.dimension() == 2 { [xi[0], xi[1], 0.] } else { xi }
}

/// Vertices of a facet: the reference vertices, each moved by up to `shift` in space.
fn facet(shape: Shape, shift: f64) -> impl Strategy<Value = Vec<[f64; 3]>> {
    let vertices = shape.reference_vertices();
    prop::collection::vec(prop::array::uniform3(-shift..shift), vertices.len()).prop_map(move |shifts| {
        vertices.iter().zip(shifts).map(|(x, shift)| [0, 1, 2].map(|d| x[d] + shift[d])).collect()
    })
}

#[test]
fn number_of_nodes() {
    let counts: Vec<usize> = elements().map(|element| element.nodes()).collect();
    assert_eq!(counts, [3, 6, 4, 10, 4, 9, 8, 27]);
}

#[test]
fn shape_functions_are_1_at_their_node_and_0_at_the_others() {
    for element in elements() {
        for (i, &node) in element.reference_nodes().iter().enumerate() {
            for (j, value) in values(&element, node).into_iter().enumerate() {
                // The coordinates of the nodes and their products are exact in binary.
                assert_eq!(value, if i == j { 1. } else { 0. }, "{element:?} {i} {j}");
            }
        }
    }
}

#[test]
fn nodes_are_the_means_of_their_vertices_and_vertices_come_first() {
    for element in elements() {
        let vertices = element.shape().reference_vertices();
        let sizes: Vec<usize> = element.node_vertices().iter().map(|of| of.len()).collect();
        assert!(sizes.is_sorted());
        for (i, vertex) in vertices.iter().enumerate() {
            assert_eq!(element.node_vertices()[i], [i]);
            assert_eq!(element.reference_nodes()[i], *vertex);
        }
        for (node, of) in element.reference_nodes().iter().zip(element.node_vertices()) {
            let mean = [0, 1, 2].map(|d| of.iter().map(|&v| vertices[v][d]).sum::<f64>() / of.len() as f64);
            assert_eq!(*node, mean);
        }
    }
}

/// Vertices of the faces, in either orientation.
fn faces(shape: Shape) -> &'static [&'static [usize]] {
    match shape {
        Shape::Tetrahedron => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]],
        _ => &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]],
    }
}

fn sorted(vertices: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut vertices: Vec<usize> = vertices.collect();
    vertices.sort_unstable();
    vertices
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn values_sum_to_1_and_gradients_to_0(xi in prop::array::uniform3(-1f64..1.)) {
        for element in elements() {
            let xi = within(element.shape(), xi);
            // Rounding of up to 27 terms of size 1 (simplices: the box extends beyond the cell, terms up to 20).
            prop_assert!((values(&element, xi).iter().sum::<f64>() - 1.).abs() < 1e-13);
            for d in 0..3 {
                let sum: f64 = gradients(&element, xi).iter().map(|g| g[d]).sum();
                prop_assert!(sum.abs() < 1e-13);
            }
        }
    }

    #[test]
    fn gradients_are_those_of_the_values(xi in prop::array::uniform3(-1f64..1.)) {
        let step = 1e-4;
        for element in elements() {
            let xi = within(element.shape(), xi);
            let exact = gradients(&element, xi);
            for d in 0..element.shape().dimension() {
                let shifted = |sign: f64| {
                    let mut xi = xi;
                    xi[d] += sign * step;
                    values(&element, xi)
                };
                // Central differences are exact for quadratics: the error is rounding, 1e-15, divided by the step.
                for ((forward, back), exact) in shifted(1.).iter().zip(shifted(-1.)).zip(&exact) {
                    prop_assert!(((forward - back) / (2. * step) - exact[d]).abs() < 1e-10);
                }
            }
        }
    }

    /// The shape functions of a cell on a face equal the functions of the facet's element. The localisation vector
    /// relies on this.
    #[test]
    fn functions_of_a_facet_are_the_trace_of_the_cells(xi in prop::array::uniform2(0f64..0.5)) {
        for (cell, facet) in [
            (Shape::Tetrahedron, Shape::Triangle),
            (Shape::Hexahedron, Shape::Quadrilateral),
        ] {
            let xi = [xi[0], xi[1], 0.];
            for order in [1, 2] {
                let (cell, facet) = (Element::new(cell, order), Element::new(facet, order));
                for face in faces(cell.shape()) {
                    let corners: Vec<_> =
                        face.iter().map(|&v| cell.shape().reference_vertices()[v]).collect();
                    let on_face = values(&facet, xi);
                    let inside = values(&cell, position(facet.shape(), &corners, xi).into());
                    for (of, value) in cell.node_vertices().iter().zip(inside) {
                        let key = sorted(of.iter().copied());
                        let same = facet
                            .node_vertices()
                            .iter()
                            .position(|of| sorted(of.iter().map(|&v| face[v])) == key);
                        let expected = same.map_or(0., |i| on_face[i]);
                        prop_assert!((value - expected).abs() < 1e-14);
                    }
                }
            }
        }
    }

    /// A point at a distance along the facet's normal, less than the radius of curvature, is projected back to the foot
    /// of the normal.
    #[test]
    fn closest_point_is_found_back(
        triangle in facet(Shape::Triangle, 0.2),
        quadrilateral in facet(Shape::Quadrilateral, 0.2),
        foot in prop::array::uniform2(0.02f64..0.48),
        height in -0.05f64..0.05,
    ) {
        for (shape, x) in [(Shape::Triangle, &triangle), (Shape::Quadrilateral, &quadrilateral)] {
            let foot = [foot[0], foot[1], 0.];
            let p = position(shape, x, foot) + height * Vector3::from(normal(shape, x, foot));
            let (xi, distance) = closest(shape, x, p.into());
            // Conditioning of slender triangles: 1e2 times rounding.
            prop_assert!((Vector3::from(xi) - Vector3::from(foot)).norm() < 1e-13);
            prop_assert!((distance - height.abs()).abs() < 1e-14);
        }
    }

    #[test]
    fn normal_is_a_right_handed_unit_vector(
        triangle in facet(Shape::Triangle, 0.2),
        quadrilateral in facet(Shape::Quadrilateral, 0.2),
        xi in prop::array::uniform2(0f64..0.5),
    ) {
        for (shape, x) in [(Shape::Triangle, &triangle), (Shape::Quadrilateral, &quadrilateral)] {
            let step = 1e-3;
            let along = |d: usize| {
                let mut end = [xi[0], xi[1], 0.];
                end[d] += step;
                (position(shape, x, end) - position(shape, x, [xi[0], xi[1], 0.])) / step
            };
            // The map is linear in each coordinate, so its differences are its tangents.
            let (one, other) = (along(0), along(1));
            let n = Vector3::from(normal(shape, x, [xi[0], xi[1], 0.]));
            prop_assert!((n.norm() - 1.).abs() < 1e-14);
            prop_assert!(n.dot(&one).abs() < 1e-12 && n.dot(&other).abs() < 1e-12);
            prop_assert!(n.dot(&one.cross(&other)) > 0.);
        }
    }
}

proptest! {
    // For a warped quadrilateral, one start may end in the farther of two minima. This is rare: it takes hundreds of
    // cases to meet one.
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn closest_point_of_a_triangle_beats_every_sample(
        x in facet(Shape::Triangle, 0.8),
        p in prop::array::uniform3(-2f64..2.),
    ) {
        beats_every_sample(Shape::Triangle, &x, p)?;
    }

    #[test]
    fn closest_point_of_a_quadrilateral_beats_every_sample(
        x in facet(Shape::Quadrilateral, 0.7),
        p in prop::array::uniform3(-3f64..3.),
    ) {
        beats_every_sample(Shape::Quadrilateral, &x, p)?;
    }
}

/// The distance of a point from a patch equals the radius of curvature, to a thousandth, so the minimum is nearly flat.
/// An iteration that ignores the curvature of the patch reduces the error by only a few per cent in a step.
#[test]
fn a_nearly_flat_minimum_is_found() {
    let x = [
        [-0.9375782267847436, -0.8891324524609358, 0.4951566526372369],
        [0.49498072088681333, -0.4696389643601271, -0.28428309878914326],
        [0.5848539729508343, 1.355590266844008, 0.6041870280572129],
        [-1.4097304402682085, 0.8041174353689367, 0.3990365152421126],
    ];
    let p = [1.0443553207103025, -0.6590020816873277, 2.834091991156122];
    let (xi, distance) = closest(Shape::Quadrilateral, &x, p);
    beats_every_sample(Shape::Quadrilateral, &x, p).unwrap_or_else(|e| panic!("{xi:?} {distance}: {e}"));
}

fn beats_every_sample(shape: Shape, x: &[[f64; 3]], p: [f64; 3]) -> Result<(), TestCaseError> {
    const SAMPLES: usize = 40;
    let (xi, distance) = closest(shape, x, p);
    let p = Vector3::from(p);
    let triangle = shape == Shape::Triangle;
    let inside = |[a, b, _]: [f64; 3]| {
        if triangle { a >= 0. && b >= 0. && a + b <= 1. + 1e-15 } else { a.abs() <= 1. && b.abs() <= 1. }
    };
    prop_assert!(inside(xi), "{:?}", xi);
    prop_assert!(((position(shape, x, xi) - p).norm() - distance).abs() < 1e-14);
    for i in 0..=SAMPLES {
        for j in 0..=if triangle { SAMPLES - i } else { SAMPLES } {
            let [s, t] = [i, j].map(|k| k as f64 / SAMPLES as f64);
            let sample = if triangle { [s, t, 0.] } else { [2. * s - 1., 2. * t - 1., 0.] };
            let sampled = (position(shape, x, sample) - p).norm();
            prop_assert!(distance <= sampled + 1e-13, "{:?} at {:?}: {} < {}", xi, sample, sampled, distance);
        }
    }
    Ok(())
}
