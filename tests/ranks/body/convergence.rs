//! Manufactured solutions: with elements, loads and supports the solution converges with the theoretical order.

use crate::bricks;
use mpi_test::{Test, tests};

use mpi::collective::SystemOperation;
use mpi::traits::CommunicatorCollectives;
use petsc_wrap::{Comm, Gather, Int, Session, Vector, mpi};
use ricochet::body::Body;
use ricochet::description::{Description, Extent};
use ricochet::element::{Element, Quadrature, Shape, Table};
use ricochet::form::{Lame, Material, SolidForms};
use ricochet::mesh::Mesh;
use ricochet::scene::Scene;
use ricochet::solve::linear::{Method, solver};
use ricochet::space::finite_element::{FacetRule, assemble, held, into_vector};

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![held_boundary, mixed_boundary];

const SIZE: [f64; 3] = [1.0, 0.8, 0.6];
const MATERIAL: Material = Material { young: 70e9, poisson: 0.3, density: 2500.0 };

/// u_i = sin(k_i·x + φ_i): the field has every term of div σ and no symmetry. A wavelength is at least seven cells.
const WAVES: [[f64; 3]; 3] = [[1.9, -1.2, 1.4], [1.3, 1.8, -2.1], [-1.6, 1.1, 2.2]];
const PHASES: [f64; 3] = [0.3, -0.8, 1.1];

fn angle(i: usize, x: [f64; 3]) -> f64 {
    (0..3).map(|j| WAVES[i][j] * x[j]).sum::<f64>() + PHASES[i]
}

fn displacement(x: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| angle(i, x).sin())
}

/// σ·n for n along the z axis: (4), (5).
fn stress_on_z(x: [f64; 3]) -> [f64; 3] {
    let Lame { lambda, mu } = MATERIAL.lame();
    let slope = |i: usize, j: usize| WAVES[i][j] * angle(i, x).cos();
    let divergence = slope(0, 0) + slope(1, 1) + slope(2, 2);
    [0, 1, 2].map(|i| mu * (slope(i, 2) + slope(2, i)) + if i == 2 { lambda * divergence } else { 0.0 })
}

/// −div σ = −(λ + μ) ∇ div u − μ Δu, the body force of the manufactured field.
fn body_force(x: [f64; 3]) -> [f64; 3] {
    let Lame { lambda, mu } = MATERIAL.lame();
    let curvature = |i: usize, j: usize, l: usize| -WAVES[i][j] * WAVES[i][l] * angle(i, x).sin();
    [0, 1, 2].map(|i| {
        let gradient: f64 = (0..3).map(|j| curvature(j, j, i)).sum();
        let laplacian: f64 = (0..3).map(|j| curvature(i, j, j)).sum();
        -(lambda + mu) * gradient - mu * laplacian
    })
}

/// Boundary conditions: supports and loads of the scene.
const HELD: &str = "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\n\
                    [[support]]\nsurface = \"top\"\nkind = \"clamped\"\n\
                    [[support]]\nsurface = \"bottom\"\nkind = \"clamped\"\n";

/// The springs are as stiff as the body, so that both sides of (11) matter.
const SPRING: [f64; 3] = [6e10, 9e10, 15e10];
const SPRING_DISPLACEMENT: [f64; 3] = [0.4, -0.7, 0.5];
const TRACTION: [f64; 3] = [3e10, -5e10, 7e10];
const BODY_FORCE: [f64; 3] = [-8e10, 6e10, 9e10];

fn mixed() -> String {
    format!(
        "[[support]]\nsurface = \"side\"\nkind = \"clamped\"\n\
         [[support]]\nsurface = \"bottom\"\nkind = \"elastic\"\nstiffness = {SPRING:?}\ndisplacement = {SPRING_DISPLACEMENT:?}\n\
         [load]\nbody_force = {BODY_FORCE:?}\n[[load.traction]]\nsurface = \"top\"\nvalue = {TRACTION:?}\n"
    )
}

/// A family of meshes: the body's geometry for a number of cells along each edge.
struct Family {
    name: &'static str,
    geometry: fn(usize, &std::path::Path) -> String,
}

const FAMILIES: [Family; 3] = [
    Family { name: "box", geometry: |n, _| format!("size = {SIZE:?}\ncells = {:?}", [n; 3]) },
    Family { name: "tetrahedra", geometry: |n, folder| file(Shape::Tetrahedron, n, 0.0, folder) },
    // Vertices are moved by up to a fifth of an edge on every mesh, so the cells do not tend to parallelepipeds.
    Family { name: "distorted hexahedra", geometry: |n, folder| file(Shape::Hexahedron, n, 0.2, folder) },
];

fn file(shape: Shape, n: usize, distortion: f64, folder: &std::path::Path) -> String {
    let path = folder.join(format!("{n}.msh"));
    std::fs::write(&path, bricks::bricks(shape, SIZE, [n; 3], distortion)).unwrap();
    format!("mesh = {path:?}")
}

fn held_boundary(session: &Session) {
    for family in &FAMILIES {
        study(session, family, HELD);
    }
}

fn mixed_boundary(session: &Session) {
    let mixed = mixed();
    for family in &FAMILIES {
        study(session, family, &mixed);
    }
}

/// Checks convergence of order p + 1 in L2 between two meshes, for elements of order p.
fn study(session: &Session, family: &Family, boundary: &str) {
    let folder = tempfile::tempdir().unwrap();
    let world = session.world();
    for (order, n) in [(1, 6), (2, 3)] {
        let error = |n: usize| {
            let geometry = (family.geometry)(n, folder.path());
            let error = solve(&world, &geometry, order, boundary);
            world.collect_garbage().unwrap();
            error
        };
        let (coarse, fine) = (error(n), error(2 * n));
        let observed = (coarse / fine).log2();
        if world.is_root() {
            println!("{:20} order {order}: L2 {coarse:.2e}, {fine:.2e}, observed order {observed:.2}", family.name);
        }
        // The next term of the error is a tenth of the first on these meshes, so the observed order may be lower by
        // 0.1.
        assert!(observed >= order as f64 + 0.9, "{} of order {order}: {observed}", family.name);
        // The error itself must be small too: a wrong field could converge with the right order.
        assert!(fine < 5e-3, "{} of order {order}: {fine:e}", family.name);
    }
}

/// The relative L2 error of the solution on a mesh.
fn solve(comm: &Comm, geometry: &str, order: usize, boundary: &str) -> f64 {
    let Material { young, poisson, density } = MATERIAL;
    let text = format!(
        "[body]\nyoung = {young:e}\npoisson = {poisson}\ndensity = {density:e}\nsymmetry = \"none\"\n\
         order = {order}\n{geometry}\n{boundary}\
         [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\npoint = [0.0, 0.0, {}]\n\
         [time]\nend = 1e-3\nstep = 1e-5\n\
         [contact]\nlocalization = \"point\"\n[solver]\nnewton = \"full\"\n",
        SIZE[2] / 2.0
    );
    let (scene, _) = Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let mesh = Mesh::new(comm, &scene.body).unwrap();
    let body = Body::solid(&scene, &mesh).unwrap();
    let clamps = held(&mesh, &Description::new(&scene).clamps, |_, x| displacement(x)).unwrap();

    // Loads: the constant ones of the scene, plus the difference to the loads of the field.
    let mut load = body.terms.load.duplicate().unwrap();
    load.copy_from(&body.terms.load).unwrap();
    load.axpy(1.0, &body.terms.support_load).unwrap();
    let given = scene.load.body_force;
    add_body_force(&mesh, &mut load, |x| minus(body_force(x), given));
    if let [traction] = &scene.load.traction[..] {
        add_traction(&mesh, "top", &mut load, |x| minus(stress_on_z(x), traction.value));
        // The added traction is σ·n + k (u − ū), n = −e_z.
        add_traction(&mesh, "bottom", &mut load, |x| {
            let (u, stress) = (displacement(x), stress_on_z(x));
            [0, 1, 2].map(|i| -stress[i] + SPRING[i] * (u[i] - SPRING_DISPLACEMENT[i]))
        });
    }
    load.assemble().unwrap();

    // u = u_D + w, with the prescribed values u_D: K w = f − K u_D on the free unknowns.
    let mut stiffness = body.combination(0.0, 0.0).unwrap();
    let mut product = load.duplicate().unwrap();
    stiffness.mult(&clamps.displacement, &mut product).unwrap();
    load.axpy(-1.0, &product).unwrap();
    clamps.zero(&mut load).unwrap();
    stiffness.zero_rows_columns(&clamps.rows, young).unwrap();
    stiffness.declare_positive_definite().unwrap();
    let mut u = load.duplicate().unwrap();
    solver(comm, "", &stiffness, Method::Cholesky).unwrap().solve(&load, &mut u).unwrap();
    u.axpy(1.0, &clamps.displacement).unwrap();
    error(&mesh, &u)
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn add_body_force(mesh: &Mesh, load: &mut Vector, f: impl Fn([f64; 3]) -> [f64; 3]) {
    let forms = SolidForms::new(mesh.cells.shape, mesh.cells.order, MATERIAL);
    let kernel = |_: usize, x: &[[f64; 3]], block: &mut [f64]| forms.load(x, &f, block);
    let size = 3 * mesh.cells.nodes_each();
    assert!(assemble(&mesh.cells, 0..mesh.cells.len(), size, kernel, into_vector(load)).is_ok());
}

fn add_traction(mesh: &Mesh, surface: &str, load: &mut Vector, f: impl Fn([f64; 3]) -> [f64; 3]) {
    let rule = FacetRule::new(mesh.facets.shape, mesh.facets.order);
    let kernel = |_: usize, x: &[[f64; 3]], block: &mut [f64]| {
        rule.element(x, &Extent::All).traction(&f, block);
        Ok(())
    };
    let chosen = mesh.surfaces[surface].iter().copied();
    assert!(assemble(&mesh.facets, chosen, 3 * mesh.facets.nodes_each(), kernel, into_vector(load)).is_ok());
}

/// ‖u_h − u‖ / ‖u‖ in L2, by a quadrature rule whose own error is of a higher order.
fn error(mesh: &Mesh, solution: &Vector) -> f64 {
    let cells = &mesh.cells;
    let table =
        Table::new(&Element::new(cells.shape, cells.order), &Quadrature::exact(cells.shape, 2 * cells.order + 3));
    let indices: Vec<Int> =
        (0..cells.len()).flat_map(|i| cells.nodes(i)).flat_map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect();
    let mut gather = Gather::new(solution, &indices).unwrap();
    let values = gather.fetch(solution).unwrap();
    let mut sums = [0.0; 2];
    for (i, u) in values.chunks_exact(3 * cells.nodes_each()).enumerate() {
        for q in 0..table.points() {
            let volume = table.weight(q) * table.jacobian(q, cells.x(i)).determinant();
            let exact = displacement(table.position(q, cells.x(i)));
            for c in 0..3 {
                let value: f64 = table.values(q).iter().zip(u.chunks_exact(3)).map(|(phi, u)| phi * u[c]).sum();
                sums[0] += volume * (value - exact[c]).powi(2);
                sums[1] += volume * exact[c].powi(2);
            }
        }
    }
    let mut all = [0.0_f64; 2];
    mesh.comm.mpi().all_reduce_into(&sums, &mut all, SystemOperation::sum());
    (all[0] / all[1]).sqrt()
}
