//! Displacements and stresses at points of bodies: exact fields, static bars and plates, order of recovered stresses.

use crate::bricks;
use crate::glass;
use mpi_test::{Test, tests};
use std::f64::consts::PI;

use crate::field::interpolate;
use petsc_wrap::{Comm, Gather, Int, Session, Vector};
use ricochet::body::{Body, System};
use ricochet::element::Shape;
use ricochet::form::stress::{place, principal};
use ricochet::form::{Lame, Material};
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;
use ricochet::solve::linear::{Method, solver};
use ricochet::space::evaluate::{ContactNow, ContactSize, Evaluator, FieldSampler, Fields, Form, Forms};
use ricochet::space::plate::{self, Plate, PlateTheory};
use ricochet::space::spline::{self, SplineSolid};

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![
    linear_fields_are_exact,
    order_of_recovered_stresses,
    a_bar_under_tension,
    naviers_plate_under_pressure,
    points_outside_are_none
];

const SIZE: [f64; 3] = [1.0, 0.8, 0.6];
const KINDS: [(Shape, usize); 4] =
    [(Shape::Hexahedron, 1), (Shape::Hexahedron, 2), (Shape::Tetrahedron, 1), (Shape::Tetrahedron, 2)];

fn material() -> Material {
    let (young, poisson, density) = glass::GLASS;
    Material { young, poisson, density }
}

fn parse(text: &str) -> Scene {
    Scene::parse("test", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0
}

/// A box divided into bricks or tetrahedra, which are distorted by a fraction of their edges. Collective.
fn bricked(comm: &Comm, (shape, order): (Shape, usize), cells: [usize; 3], distortion: f64) -> (Scene, Mesh) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bricks.msh");
    std::fs::write(&path, bricks::bricks(shape, SIZE, cells, distortion)).unwrap();
    let body = format!("mesh = {path:?}\norder = {order}");
    let scene = parse(
        &glass::plate(&format!("{body}\nreduction = \"none\""), "end = 1e-3", "")
            .replace("speed = 1.0", "speed = 1.0\npoint = [0, 0, 0.3]"),
    );
    let mesh = Mesh::new(comm, &scene.body).unwrap();
    (scene, mesh)
}

/// All unknowns of a vector on the ranks that request them. Collective.
fn gathered(vector: &Vector, wanted: bool) -> Vec<f64> {
    let all: Vec<Int> = if wanted { (0..vector.len() as Int).collect() } else { Vec::new() };
    Gather::new(vector, &all).unwrap().fetch(vector).unwrap().to_vec()
}

fn value(form: &Form, u: &[f64]) -> f64 {
    form.iter().map(|(unknown, value)| value * u[*unknown]).sum()
}

fn read(forms: &Forms, u: &[f64]) -> ([f64; 3], [f64; 6]) {
    (forms.displacement.each_ref().map(|form| value(form, u)), forms.stress.each_ref().map(|form| value(form, u)))
}

/// Stresses from the gradient of a displacement.
fn hooke(slope: impl Fn(usize, usize) -> f64) -> [f64; 6] {
    let Lame { lambda, mu } = material().lame();
    let divergence: f64 = (0..3).map(|i| slope(i, i)).sum();
    let mut stress = [0.0; 6];
    for (i, j) in [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)] {
        stress[place(i, j)] = mu * (slope(i, j) + slope(j, i)) + if i == j { lambda * divergence } else { 0.0 };
    }
    stress
}

/// Linear fields are exact on any mesh, also with a single layer of cells: inside, on faces, edges and corners, and at
/// all nodes.
fn linear_fields_are_exact(session: &Session) {
    let comm = session.world();
    const SLOPE: [[f64; 3]; 3] = [[1e-4, 3e-5, -2e-5], [7e-5, -5e-5, 1e-5], [4e-5, 6e-5, 2e-4]];
    let linear = |x: [f64; 3]| [0, 1, 2].map(|i| (0..3).map(|j| SLOPE[i][j] * x[j]).sum::<f64>() + 1e-4 * i as f64);
    let exact = hooke(|i, j| SLOPE[i][j]);
    for (kind, cells) in KINDS.into_iter().flat_map(|kind| [[4, 3, 3], [5, 4, 1]].map(|cells| (kind, cells))) {
        let (scene, mesh) = bricked(&comm, kind, cells, 0.2);
        let mut u = Vector::new(&comm, 3 * mesh.owned_nodes).unwrap();
        interpolate(&mesh, &mut u, linear);
        let whole = mesh.gather();
        assert_eq!(whole.is_some(), comm.is_root());
        let u = gathered(&u, comm.is_root());
        let Some(whole) = whole else { continue };
        let evaluator = Evaluator::of_mesh(&scene, whole, None);
        for point in [[0.0; 3], [0.123, -0.31, 0.07], [0.5, 0.1, -0.2], [-0.5, 0.4, 0.3], [0.5, -0.4, 0.3]] {
            let (moved, stress) = read(&evaluator.at(point).expect("a point of the box"), &u);
            let off = (0..3).map(|i| (moved[i] - linear(point)[i]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-16, "{kind:?} {cells:?} {point:?}: {off:e}");
            // Rounding of displacements of 2e-4 over cells of 0.2, multiplied by the modulus.
            let off = stress.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / exact[2];
            assert!(off < 1e-11, "{kind:?} {cells:?} {point:?}: {stress:?}, not {exact:?}");
        }
        let sampler = FieldSampler::new(&evaluator, ContactSize::default(), None);
        let Fields { displacement, velocity, principal_stress } = sampler.fields([&u, &u], &ContactNow::default());
        assert_eq!(displacement, velocity);
        let exact = principal(exact);
        for (n, x) in sampler.grid().points.iter().enumerate() {
            assert!((0..3).all(|i| (displacement[3 * n + i] - linear(*x)[i]).abs() < 1e-16));
            assert!(
                (0..3).all(|i| (principal_stress[3 * n + i] - exact[i]).abs() < 1e-11 * exact[0]),
                "{kind:?} {x:?}"
            );
        }
    }
}

/// u_i = sin(k_i·x + φ_i), about a quarter of a wavelength along each edge.
const WAVES: [[f64; 3]; 3] = [[1.9, -1.2, 1.4], [1.3, 1.8, -2.1], [-1.6, 1.1, 2.2]];
const PHASES: [f64; 3] = [0.3, -0.8, 1.1];

fn angle(i: usize, x: [f64; 3]) -> f64 {
    (0..3).map(|j| WAVES[i][j] * x[j]).sum::<f64>() + PHASES[i]
}

/// Stresses recovered from the nodal values of a smooth field are compared with the exact ones at all nodes. Gradients
/// in the cells converge with the order of the elements. Hexahedra have Gauss points where the order is one higher, and
/// so do elements of order 1 in symmetric patches. On the faces, elements of order 1 use linear extrapolation from the
/// neighbouring cells.
fn order_of_recovered_stresses(session: &Session) {
    let comm = session.world();
    for (kind, distortion, least) in [
        ((Shape::Hexahedron, 1), 0.0, [1.8, 0.9]),
        ((Shape::Hexahedron, 2), 0.0, [2.7, 2.7]),
        ((Shape::Hexahedron, 2), 0.1, [2.7, 2.7]),
        ((Shape::Tetrahedron, 1), 0.0, [1.8, 0.9]),
        ((Shape::Tetrahedron, 2), 0.0, [1.9, 1.9]),
    ] {
        let errors = [6, 12].map(|n| {
            let (scene, mesh) = bricked(&comm, kind, [n; 3], distortion);
            let mut u = Vector::new(&comm, 3 * mesh.owned_nodes).unwrap();
            interpolate(&mesh, &mut u, |x| [0, 1, 2].map(|i| angle(i, x).sin()));
            let whole = mesh.gather();
            let u = gathered(&u, comm.is_root());
            let sampler = FieldSampler::new(&Evaluator::of_mesh(&scene, whole?, None), ContactSize::default(), None);
            let found = sampler.fields([&u, &u], &ContactNow::default()).principal_stress;
            let mut errors = [0.0_f64; 2];
            for (n, x) in sampler.grid().points.iter().enumerate() {
                let exact = principal(hooke(|i, j| WAVES[i][j] * angle(i, *x).cos()));
                let is_outer = (0..3).any(|i| (x[i].abs() - 0.5 * SIZE[i]).abs() < 1e-9);
                let off = (0..3).map(|i| (found[3 * n + i] - exact[i]).abs()).fold(0.0, f64::max);
                errors[usize::from(is_outer)] = errors[usize::from(is_outer)].max(off / material().young);
            }
            Some(errors)
        });
        let [Some(coarse), Some(fine)] = errors else { continue };
        for (of, where_) in ["inside", "on the faces"].into_iter().enumerate() {
            let order = (coarse[of] / fine[of]).log2();
            println!(
                "{kind:?}, distorted by {distortion}, {where_}: {:.1e}, {:.1e}, order {order:.2}",
                coarse[of], fine[of]
            );
            assert!(order > least[of], "{kind:?} {where_}: order {order}, {coarse:?} {fine:?}");
        }
    }
}

/// The static displacement under the body's loads. Collective.
fn at_rest(body: &Body) -> Vector {
    let (mut right, mut u) = (body.terms.load.duplicate().unwrap(), body.terms.load.duplicate().unwrap());
    right.copy_from(&body.terms.load).unwrap();
    body.clamps.zero(&mut right).unwrap();
    solver(body.comm(), "", &body.operator(0.0, 0.0).unwrap(), Method::Cholesky)
        .unwrap()
        .solve(&right, &mut u)
        .unwrap();
    u
}

fn of_system(session: &Session, system: &System) -> Vec<f64> {
    gathered(&at_rest(&Body::of(&session.alone(), system).unwrap()), true)
}

/// The exact solution is in the spaces of splines and elements: σ = p along x only, u = (p/E) (x + a/2, −ν (y + b/2),
/// −ν (z + c/2)).
fn a_bar_under_tension(session: &Session) {
    let comm = session.world();
    let held = |face: &str, axis: &str| {
        format!("[[support]]\nsurface = \"{face}\"\nkind = \"clamped\"\ncomponents = [\"{axis}\"]\n")
    };
    let rest = held("x-min", "x")
        + &held("y-min", "y")
        + &held("z-min", "z")
        + "[[load.traction]]\nsurface = \"x-max\"\nvalue = [3e6, 0, 0]\n";
    let text = |more: &str| {
        glass::plate(
            &format!("model = \"solid\"\nsize = [0.9, 0.3, 0.2]\nsymmetry = \"none\"\n{more}"),
            "end = 1e-3",
            &rest,
        )
    };
    let (scene, meshed) = (parse(&text("")), parse(&text("reduction = \"none\"\ncells = [5, 3, 2]\ngrading = 2")));
    let block = SplineSolid::new(&scene, &spline::Settings { cell_size_factor: 2.0, part_cell_factor: 1.0 }).unwrap();
    let mesh = Mesh::new(&comm, &meshed.body).unwrap();
    let of_mesh = gathered(&at_rest(&Body::solid(&meshed, &mesh).unwrap()), comm.is_root());
    let splines = (Evaluator::of_grid(&scene, block.points), of_system(session, &block.system));
    let all =
        mesh.gather().map(|whole| (Evaluator::of_mesh(&meshed, whole, None), of_mesh)).into_iter().chain([splines]);
    let (young, poisson, _) = glass::GLASS;
    for (name, (evaluator, u)) in ["mesh", "splines"].into_iter().rev().zip(all.collect::<Vec<_>>().into_iter().rev()) {
        for x in [[0.0; 3], [0.2, -0.1, 0.03], [0.45, 0.15, 0.1], [-0.45, -0.15, -0.1], [0.45, 0.0, -0.1]] {
            let (moved, stress) = read(&evaluator.at(x).unwrap(), &u);
            let exact = [x[0] + 0.45, -poisson * (x[1] + 0.15), -poisson * (x[2] + 0.1)].map(|x| 3e6 / young * x);
            // Rounding times the condition number of the operator.
            assert!(
                (0..3).all(|i| (moved[i] - exact[i]).abs() < 1e-9 * 4e-5),
                "{name} {x:?}: {moved:?}, not {exact:?}"
            );
            let off = (0..6).map(|i| (stress[i] - if i == 0 { 3e6 } else { 0.0 }).abs()).fold(0.0, f64::max);
            assert!(off < 1e-8 * 3e6, "{name} {x:?}: {stress:?}");
            assert!((principal(stress)[0] / 3e6 - 1.0).abs() < 1e-8);
        }
    }
}

/// Navier's series for a pressure on a plate whose sides constrain w and the rotation along the side. Both theories
/// have the same moments, since Mindlin's rotations here are Kirchhoff's −∇w; the shear deflection has a separate
/// series. The sums are over the sine waves of p.
fn naviers_plate_under_pressure(session: &Session) {
    let (edges, h, pressure) = ([1.2, 0.9], 0.04_f64, 1e4);
    let held = |surface: &str, components: &str| {
        format!("[[support]]\nsurface = \"{surface}\"\nkind = \"clamped\"\ncomponents = {components}\n")
    };
    let rest = ["x-min", "x-max"].map(|side| held(side, r#"["y", "z"]"#)).concat()
        + &["y-min", "y-max"].map(|side| held(side, r#"["x", "z"]"#)).concat()
        + &format!("[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -{pressure:e}]\n");
    let (young, nu, _) = glass::GLASS;
    let rigidity = young * h.powi(3) / (12.0 * (1.0 - nu * nu));
    for (theory, symmetry) in
        [PlateTheory::Kirchhoff, PlateTheory::Layerwise].into_iter().flat_map(|t| ["quarter", "none"].map(|s| (t, s)))
    {
        let scene =
            parse(&glass::plate(&format!("size = [1.2, 0.9, {h}]\nsymmetry = \"{symmetry}\""), "end = 1e-3", &rest));
        let settings = plate::Settings { cell_size_factor: 0.6, ..plate::Settings::default() };
        let plate = Plate::new(&scene, theory, &settings).unwrap();
        let has_shear = theory == PlateTheory::Layerwise;
        let shear = if has_shear { 5.0 / 6.0 * 0.5 * young / (1.0 + nu) * h } else { f64::INFINITY };
        let u = of_system(session, &plate.system);
        let evaluator = Evaluator::of_grid(&scene, plate.points);
        for x in [[0.0, 0.0, -0.02], [0.35, -0.2, -0.02], [-0.35, -0.2, 0.01], [-0.41, 0.3, 0.02], [0.2, 0.35, 0.0]] {
            let (moved, stress) = read(&evaluator.at(x).unwrap(), &u);
            // Downward deflection and its gradient; curvatures κ = −∂²w of Kirchhoff's part; shear forces D ∂ Δw.
            let (mut w, mut slope, mut curved, mut force) = (0.0, [0.0; 2], [0.0; 3], [0.0; 2]);
            for (m, n) in (1..400).step_by(2).flat_map(|m| (1..400).step_by(2).map(move |n| (m, n))) {
                let (k, l) = (PI * f64::from(m) / edges[0], PI * f64::from(n) / edges[1]);
                let xi = k * k + l * l;
                let load = 16.0 * pressure / (PI * PI * f64::from(m) * f64::from(n));
                let bent = load / (rigidity * xi * xi);
                let [[sx, cx], [sy, cy]] =
                    [(k, 0), (l, 1)].map(|(k, i)| (k * (x[i] + 0.5 * edges[i])).sin_cos()).map(|(s, c)| [s, c]);
                w += (bent + load / (shear * xi)) * sx * sy;
                slope = [slope[0] + bent * k * cx * sy, slope[1] + bent * l * sx * cy];
                curved = [
                    curved[0] + bent * k * k * sx * sy,
                    curved[1] + bent * l * l * sx * sy,
                    curved[2] - bent * k * l * cx * cy,
                ];
                force = [force[0] + load / xi * k * cx * sy, force[1] + load / xi * l * sx * cy];
            }
            // A plate that bends downwards is stretched below the middle plane.
            let height = -x[2];
            let exact = [-height * slope[0], -height * slope[1], -w];
            let largest = exact.iter().fold(0.0_f64, |m, u| m.max(u.abs()));
            // The remainder of the series, and the discretisation error of splines of degree 5.
            assert!(
                (0..3).all(|i| (moved[i] - exact[i]).abs() < 1e-5 * largest),
                "{theory:?} {x:?}: {moved:?}, not {exact:?}"
            );
            let plane = young / (1.0 - nu * nu) * height;
            let exact = [
                plane * (curved[0] + nu * curved[1]),
                plane * (curved[1] + nu * curved[0]),
                young / (1.0 + nu) * height * curved[2],
            ];
            let scale = young * 0.02 * (curved[0].abs() + curved[1].abs());
            let found = [stress[0], stress[1], stress[place(0, 1)]];
            let off = (0..3).map(|i| (found[i] - exact[i]).abs()).fold(0.0, f64::max) / scale;
            assert!(off < 1e-3, "{theory:?} {symmetry} {x:?}: {found:?}, not {exact:?}: {off:e}");
            assert_eq!(stress[2], 0.0);
            // The shear stress is taken as a parabola across the thickness, whose mean follows from the shear
            // force. Upwards, w is negative.
            let parabola = if has_shear { 1.5 / h * (1.0 - (2.0 * height / h).powi(2)) } else { 0.0 };
            for i in 0..2 {
                let (found, exact) = (stress[place(i, 2)], -parabola * force[i]);
                // The series of the shear forces converges by one power more slowly than the series of the moments.
                assert!((found - exact).abs() < 3e-3 * pressure / h, "{theory:?} {x:?}: {found}, not {exact}");
            }
        }
    }
}

/// Points outside a mesh are recognised, and return no value.
fn points_outside_are_none(session: &Session) {
    let comm = session.world();
    for kind in [KINDS[1], KINDS[2]] {
        let (scene, mesh) = bricked(&comm, kind, [3, 2, 2], 0.2);
        let Some(whole) = mesh.gather() else { continue };
        let evaluator = Evaluator::of_mesh(&scene, whole, None);
        for (x, is_in) in [
            ([0.5, 0.4, 0.3], true),
            ([0.5 + 1e-8, 0.0, 0.0], true),
            ([0.5 + 1e-5, 0.0, 0.0], false),
            ([0.0, 0.0, -0.31], false),
            ([3.0, 0.0, 0.0], false),
        ] {
            assert_eq!(evaluator.at(x).is_some(), is_in, "{kind:?} {x:?}");
        }
    }
}
