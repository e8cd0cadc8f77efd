//! Properties of the integrals over cells: symmetry, null space, mass, energies of known fields, the patch test.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};
use proptest::prelude::*;
use ricochet::element::{Element, Quadrature, Shape};
use ricochet::form::{Lame, Material, SolidForms};

const GLASS: Material = Material { young: 70e9, poisson: 0.23, density: 2500. };

const CELLS: [Shape; 2] = [Shape::Tetrahedron, Shape::Hexahedron];

/// A distorted cell: the reference vertices are moved by up to 0.15 of an edge, then stretched, rotated and shifted.
fn cell(shape: Shape) -> impl Strategy<Value = Vec<[f64; 3]>> {
    let vertices = shape.reference_vertices();
    let shift = if shape == Shape::Hexahedron { 0.3 } else { 0.15 };
    let shifts = prop::collection::vec(prop::array::uniform3(-shift..shift), vertices.len());
    (shifts, affine()).prop_map(move |(shifts, (stretch, offset))| {
        let moved = vertices.iter().zip(shifts).map(|(&x, s)| Vector3::from(x) + Vector3::from(s));
        moved.map(|x| (stretch * x + offset).into()).collect()
    })
}

/// An affine map: edges stretched by 0.3 to 1, a rotation, an offset.
fn affine() -> impl Strategy<Value = (Matrix3<f64>, Vector3<f64>)> {
    let triple = |range: std::ops::Range<f64>| prop::array::uniform3(range);
    (triple(0.3..1.), triple(-3.0..3.), triple(-1.0..1.)).prop_map(|(stretch, angles, offset)| {
        let turn = Rotation3::from_euler_angles(angles[0], angles[1], angles[2]);
        (turn * Matrix3::from_diagonal(&stretch.into()), offset.into())
    })
}

/// Positions of the nodes, which are means of vertices.
fn nodes(shape: Shape, order: usize, x: &[[f64; 3]]) -> Vec<Vector3<f64>> {
    let mean = |of: &&[usize]| of.iter().map(|&v| Vector3::from(x[v])).sum::<Vector3<f64>>() / of.len() as f64;
    Element::new(shape, order).node_vertices().iter().map(mean).collect()
}

fn interpolate(points: &[Vector3<f64>], u: impl Fn(&Vector3<f64>) -> Vector3<f64>) -> DVector<f64> {
    DVector::from_iterator(3 * points.len(), points.iter().flat_map(|x| <[f64; 3]>::from(u(x))))
}

fn matrix(
    shape: Shape,
    order: usize,
    form: impl Fn(&mut SolidForms, &mut [f64]) -> Result<(), ricochet::form::Tangled>,
) -> DMatrix<f64> {
    let mut forms = SolidForms::new(shape, order, GLASS);
    let size = 3 * forms.nodes();
    // The forms overwrite their output: its earlier content must have no effect.
    let mut out = vec![f64::NAN; size * size];
    form(&mut forms, &mut out).expect("the cell is not tangled");
    DMatrix::from_row_slice(size, size, &out)
}

fn stiffness(shape: Shape, order: usize, x: &[[f64; 3]]) -> DMatrix<f64> {
    matrix(shape, order, |forms, out| forms.stiffness(x, out))
}

fn mass(shape: Shape, order: usize, x: &[[f64; 3]]) -> DMatrix<f64> {
    matrix(shape, order, |forms, out| forms.mass(x, out))
}

/// ∫ f dx over a cell with a quadrature rule of degree 8, computed independently of the forms.
fn integral(shape: Shape, x: &[[f64; 3]], f: impl Fn(Vector3<f64>) -> f64) -> f64 {
    let geometry = Element::new(shape, 1);
    let rule = Quadrature::exact(shape, 8);
    let (mut values, mut gradients) = ([0.; 8], [[0.; 3]; 8]);
    let mut sum = 0.;
    for (&xi, weight) in rule.points.iter().zip(&rule.weights) {
        geometry.values(xi, &mut values);
        geometry.gradients(xi, &mut gradients);
        let mut at = Vector3::zeros();
        let mut columns = [Vector3::zeros(); 3];
        for (v, &vertex) in x.iter().enumerate() {
            let vertex = Vector3::from(vertex);
            at += vertex * values[v];
            for d in 0..3 {
                columns[d] += vertex * gradients[v][d];
            }
        }
        sum += weight * columns[0].dot(&columns[1].cross(&columns[2])) * f(at);
    }
    sum
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn matrices_are_symmetric_to_the_last_bit(
        tetrahedron in cell(Shape::Tetrahedron), hexahedron in cell(Shape::Hexahedron),
    ) {
        for (shape, x) in CELLS.into_iter().zip([&tetrahedron, &hexahedron]) {
            for order in [1, 2] {
                for a in [stiffness(shape, order, x), mass(shape, order, x)] {
                    prop_assert!(a == a.transpose());
                }
            }
        }
    }

    #[test]
    fn stiffness_lets_rigid_motions_free_and_nothing_else(
        tetrahedron in cell(Shape::Tetrahedron), hexahedron in cell(Shape::Hexahedron),
    ) {
        for (shape, x) in CELLS.into_iter().zip([&tetrahedron, &hexahedron]) {
            for order in [1, 2] {
                let k = stiffness(shape, order, x);
                let points = nodes(shape, order, x);
                for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                    let shift = interpolate(&points, |_| axis);
                    let turn = interpolate(&points, |x| axis.cross(x));
                    // Rounding of a row sum relative to the largest entry, for fields of size 1.
                    prop_assert!((&k * shift).amax() < 1e-13 * k.amax());
                    prop_assert!((&k * turn).amax() < 1e-13 * k.amax());
                }
                let eigenvalues = k.symmetric_eigenvalues();
                let zero = 1e-12 * eigenvalues.max();
                prop_assert!(eigenvalues.min() > -zero);
                prop_assert_eq!(eigenvalues.iter().filter(|&&e| e < zero).count(), 6);
            }
        }
    }

    #[test]
    fn mass_is_positive_definite_and_sums_to_three_masses(
        tetrahedron in cell(Shape::Tetrahedron), hexahedron in cell(Shape::Hexahedron),
    ) {
        for (shape, x) in CELLS.into_iter().zip([&tetrahedron, &hexahedron]) {
            let expected = 3. * GLASS.density * integral(shape, x, |_| 1.);
            for order in [1, 2] {
                let m = mass(shape, order, x);
                prop_assert!((m.sum() / expected - 1.).abs() < 1e-13);
                prop_assert!(m.cholesky().is_some());
            }
        }
    }

    /// u = (xy, yz, zx) is in the quadratic spaces of affine cells: its energies are exact.
    #[test]
    fn energies_of_a_quadratic_field_on_affine_cells((stretch, offset) in affine()) {
        let Lame { lambda, mu } = GLASS.lame();
        let field = |x: &Vector3<f64>| Vector3::new(x.x * x.y, x.y * x.z, x.z * x.x);
        let elastic = |x: Vector3<f64>| {
            let g = Matrix3::new(x.y, x.x, 0., 0., x.z, x.y, x.z, 0., x.x);
            let strain = (g + g.transpose()) / 2.;
            lambda * g.trace().powi(2) + 2. * mu * strain.norm_squared()
        };
        for shape in CELLS {
            let x: Vec<[f64; 3]> = shape
                .reference_vertices()
                .iter()
                .map(|&x| (stretch * Vector3::from(x) + offset).into())
                .collect();
            let u = interpolate(&nodes(shape, 2, &x), field);
            let energy = u.dot(&(stiffness(shape, 2, &x) * &u));
            prop_assert!((energy / integral(shape, &x, elastic) - 1.).abs() < 1e-12);
            let inertia = u.dot(&(mass(shape, 2, &x) * &u));
            let exact = GLASS.density * integral(shape, &x, |x| field(&x).norm_squared());
            prop_assert!((inertia / exact - 1.).abs() < 1e-12);
        }
    }

    /// For a force density that is a field of the space, the load is the mass matrix times the field, over the density.
    /// The sum of the load is the resultant.
    #[test]
    fn load_of_a_linear_force(
        tetrahedron in cell(Shape::Tetrahedron), hexahedron in cell(Shape::Hexahedron),
    ) {
        let force = |x: &Vector3<f64>| Vector3::new(1. + x.y, x.z - 2. * x.x, 3. * x.y);
        for (shape, x) in CELLS.into_iter().zip([&tetrahedron, &hexahedron]) {
            for order in [1, 2] {
                let forms = SolidForms::new(shape, order, GLASS);
                let mut out = vec![f64::NAN; 3 * forms.nodes()];
                forms.load(x, |x| force(&x.into()).into(), &mut out).expect("not tangled");
                let out = DVector::from_vec(out);
                let by_mass = mass(shape, order, x) * interpolate(&nodes(shape, order, x), force);
                prop_assert!((&out - by_mass / GLASS.density).amax() < 1e-13 * out.amax());
                let resultant: f64 = out.iter().skip(1).step_by(3).sum();
                let exact = integral(shape, x, |x| force(&x).y);
                prop_assert!((resultant - exact).abs() < 1e-12 * out.lp_norm(1));
            }
        }
    }

    #[test]
    fn a_mirrored_or_flat_cell_is_refused(
        tetrahedron in cell(Shape::Tetrahedron), hexahedron in cell(Shape::Hexahedron),
    ) {
        for (shape, x) in CELLS.into_iter().zip([&tetrahedron, &hexahedron]) {
            for (factor, order) in [(-1., 1), (-1., 2), (0., 1), (0., 2), (f64::NAN, 2)] {
                let x: Vec<[f64; 3]> = x.iter().map(|x| [x[0], x[1], factor * x[2]]).collect();
                let mut forms = SolidForms::new(shape, order, GLASS);
                let mut out = vec![0.; 9 * forms.nodes() * forms.nodes()];
                let refused = [
                    forms.stiffness(&x, &mut out),
                    forms.mass(&x, &mut out),
                    forms.load(&x, |_| [1.; 3], &mut out),
                ];
                for result in refused {
                    let found = result.map_err(|tangled| tangled.determinant);
                    prop_assert!(found.is_err_and(|d| d <= 0. || d.is_nan()));
                }
            }
        }
    }

    /// Patch test with distorted cells around inner nodes: a linear displacement prescribed on the boundary is
    /// reproduced exactly inside.
    #[test]
    fn patch_test(
        shifts in prop::collection::vec(prop::array::uniform3(-0.15f64..0.15), 27),
        gradient in prop::array::uniform9(-1f64..1.),
    ) {
        let gradient = Matrix3::from_row_slice(&gradient);
        let vertices: Vec<[f64; 3]> = (0..27)
            .map(|v| [v % 3, v / 3 % 3, v / 9])
            .zip(&shifts)
            .map(|(grid, shift)| [0, 1, 2].map(|d| grid[d] as f64 + shift[d]))
            .collect();
        for shape in CELLS {
            for order in [1, 2] {
                let error = patch_error(shape, order, &vertices, gradient);
                // Rounding times the condition number of the inner block, about 1e2.
                prop_assert!(error < 1e-12, "{:?} {}: {:e}", shape, order, error);
            }
        }
    }
}

/// The cells of a grid of 2×2×2 cubes with 3×3×3 vertices, as vertex numbers.
fn grid_cells(shape: Shape) -> Vec<Vec<usize>> {
    let number = |[x, y, z]: [usize; 3]| x + 3 * y + 9 * z;
    let cubes = (0..8).map(|c| [c % 2, c / 2 % 2, c / 4]);
    match shape {
        Shape::Hexahedron => {
            let corners = shape.reference_vertices();
            let corner = |cube: [usize; 3], x: &[f64; 3]| number([0, 1, 2].map(|d| cube[d] + usize::from(x[d] > 0.)));
            cubes.map(|cube| corners.iter().map(|x| corner(cube, x)).collect()).collect()
        }
        // Kuhn's six tetrahedra, one for each order of the edges. An odd permutation is reversed for a positive volume.
        _ => cubes
            .flat_map(|cube| {
                [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]].map(|order| {
                    let mut at = cube;
                    let mut path = vec![number(at)];
                    for d in order {
                        at[d] += 1;
                        path.push(number(at));
                    }
                    if order[1] != (order[0] + 1) % 3 {
                        path.swap(2, 3);
                    }
                    path
                })
            })
            .collect(),
    }
}

/// Largest error of the displacement of the inner nodes.
fn patch_error(shape: Shape, order: usize, vertices: &[[f64; 3]], gradient: Matrix3<f64>) -> f64 {
    let element = Element::new(shape, order);
    // A node is identified by the vertices whose mean it is.
    let mut numbers: BTreeMap<Vec<usize>, usize> = BTreeMap::new();
    let mut points: Vec<Vector3<f64>> = Vec::new();
    let mut inner: Vec<usize> = Vec::new();
    let mut blocks = Vec::new();
    for cell in grid_cells(shape) {
        let x: Vec<[f64; 3]> = cell.iter().map(|&v| vertices[v]).collect();
        let places = nodes(shape, order, &x);
        let mut unknowns = Vec::new();
        for (of, place) in element.node_vertices().iter().zip(places) {
            let mut key: Vec<usize> = of.iter().map(|&v| cell[v]).collect();
            key.sort_unstable();
            let on_boundary =
                [1, 3, 9].iter().any(|stride| [0, 2].iter().any(|side| key.iter().all(|v| v / stride % 3 == *side)));
            let number = *numbers.entry(key).or_insert_with(|| {
                points.push(place);
                if !on_boundary {
                    inner.extend((0..3).map(|c| 3 * (points.len() - 1) + c));
                }
                points.len() - 1
            });
            unknowns.extend((0..3).map(|c| 3 * number + c));
        }
        blocks.push((unknowns, stiffness(shape, order, &x)));
    }
    let mut k = DMatrix::<f64>::zeros(3 * points.len(), 3 * points.len());
    for (unknowns, block) in blocks {
        for (i, &row) in unknowns.iter().enumerate() {
            for (j, &column) in unknowns.iter().enumerate() {
                k[(row, column)] += block[(i, j)];
            }
        }
    }
    assert!(!inner.is_empty());
    let exact = interpolate(&points, |x| gradient * x);
    let mut held = exact.clone();
    for &i in &inner {
        held[i] = 0.;
    }
    let load = -(&k * held).select_rows(&inner);
    let solution = k
        .select_rows(&inner)
        .select_columns(&inner)
        .cholesky()
        .expect("the inner block is positive definite")
        .solve(&load);
    (solution - exact.select_rows(&inner)).amax()
}

/// The bottom of the cube is turned by 180°: the determinant is ζ², which is positive at the Gauss points of order 1,
/// but the cell is tangled.
#[test]
fn a_hexahedron_twisted_by_half_a_turn_is_tangled() {
    let mut x: Vec<[f64; 3]> = Shape::Hexahedron.reference_vertices().to_vec();
    x[..4].rotate_left(2);
    let material = Material { young: 1.0, poisson: 0.3, density: 1.0 };
    for order in [1, 2] {
        let mut forms = SolidForms::new(Shape::Hexahedron, order, material);
        let mut out = vec![0.0; (3 * forms.nodes()).pow(2)];
        assert!(forms.stiffness(&x, &mut out).is_err(), "order {order}");
    }
}

/// Total 1 and second moments of the pressures on an area, over facets and over a grid of lines that cut it: Hertz's on a disc
/// has ∫ p x² = 1/5, an even one 1/4, and a square 1/3, ∫ p x²y² = 1/9.
#[test]
fn areas_have_their_moments() {
    use ricochet::form::{AreaShape, ContactArea, PressureForms, Spread};
    let moments = [
        (AreaShape::HertzDisc, 0.2, 1.0 / 35.0),
        (AreaShape::EvenDisc, 0.25, 1.0 / 24.0),
        (AreaShape::EvenSquare, 1.0 / 3.0, 1.0 / 9.0),
    ];
    for (shape, square, mixed) in moments {
        let forms = PressureForms::new(Shape::Quadrilateral, 2, shape);
        let element = Element::new(Shape::Quadrilateral, 2);
        let mut sum = [0.0; 3];
        for (i, j) in (-4..4).flat_map(|i| (-4..4).map(move |j| (i, j))) {
            // Sheared cells across the rim and the corners.
            let at = |i: i32, j: i32| {
                let (x, y) = (0.43 * f64::from(i) + 0.11, 0.43 * f64::from(j) - 0.07);
                [x + 0.2 * y, y - 0.1 * x]
            };
            let x = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            let mut load = vec![0.0; element.nodes()];
            forms.load(&x, &mut load);
            for (load, of) in load.iter().zip(element.node_vertices()) {
                let place = [0, 1].map(|axis| of.iter().map(|&v| x[v][axis]).sum::<f64>() / of.len() as f64);
                sum[0] += load;
                sum[1] += load * place[0] * place[0];
                sum[2] += load * place[0] * place[1];
            }
        }
        // Quadratic elements interpolate x² exactly. The adaptive quadrature is less accurate in cells that a corner of the
        // square cuts, where the pressure jumps.
        let exact = [1.0, square, 0.0];
        assert!(sum.iter().zip(exact).all(|(sum, exact)| (sum - exact).abs() < 1e-9), "{shape:?} {sum:?}");
        let area = ContactArea { shape, half_width: 0.5 };
        let (spread, radius) = Spread::of_area(&area, 0.1);
        assert_eq!(radius, 0.5);
        let lines = [&[-9.0, 0.9, 1.3, 1.31, 9.0][..], &[-9.0, -0.4, 0.0, 0.01, 9.0][..]];
        let mut sum = [0.0; 3];
        for (x, line) in spread.strips([1.0, 0.2], radius, lines) {
            for (y, weight) in line {
                let [x, y] = [(x - 1.0) / radius, (y - 0.2) / radius];
                sum.iter_mut().zip([1.0, x * x, x * x * y * y]).for_each(|(sum, value)| *sum += weight * value);
            }
        }
        assert!(
            sum.iter().zip([1.0, square, mixed]).all(|(sum, exact)| (sum - exact).abs() < 1e-10),
            "{shape:?} {sum:?}"
        );
        // Its compliance agrees with that of Hertz's pressure with the same second moment within 2%.
        let equivalent = area.half_width / area.equivalent_radius();
        assert!((area.dent_over_hertz() / equivalent - 1.0).abs() < 0.02);
    }
}
