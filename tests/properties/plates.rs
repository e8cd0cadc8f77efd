//! Plates as small linear systems: exact solutions, symmetries, sums, and scenes that cannot be modelled as plates.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use nalgebra_sparse::CsrMatrix;
use ricochet::contact::{ForceLaw, Hertz};
use ricochet::scene::Scene;
use ricochet::space::plate::{Disc, Plate, PlateTheory, Settings, admits};

const YOUNG: f64 = 70e9;
const POISSON: f64 = 0.23;
const DENSITY: f64 = 2500.0;
pub const THEORIES: [PlateTheory; 2] = [PlateTheory::Kirchhoff, PlateTheory::Layerwise];

pub fn scene(body: &str, impactor: &str, rest: &str) -> Scene {
    let text = format!(
        "[body]\nyoung = {YOUNG:e}\npoisson = {POISSON}\ndensity = {DENSITY}\n{body}\n[impactor]\nmass = 52.0\nradius = 0.05\n\
         young = 210e9\npoisson = 0.3\nspeed = 1.0\n{impactor}\n[time]\nend = 1e-3\n{rest}"
    );
    Scene::parse("test", &text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}")).0
}

pub fn plate(scene: &Scene, theory: PlateTheory, cell_size_factor: f64) -> Plate {
    let settings = Settings { cell_size_factor, ..Settings::default() };
    Plate::new(scene, theory, &settings).unwrap_or_else(|error| panic!("{error}"))
}

pub fn rigidity(thickness: f64) -> f64 {
    YOUNG * thickness.powi(3) / (12.0 * (1.0 - POISSON * POISSON))
}

fn dense(entries: &CsrMatrix<f64>, n: usize) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(n, n);
    for (i, j, &value) in entries.triplet_iter() {
        assert_eq!(matrix[(i, j)], 0.0, "an entry stands twice");
        matrix[(i, j)] = value;
    }
    assert_eq!(matrix, matrix.transpose());
    matrix
}

/// K + C/T + M/T² with constrained unknowns, and its factorisation.
pub struct Operator {
    matrix: DMatrix<f64>,
    free: Vec<usize>,
}

impl Operator {
    pub fn new(plate: &Plate, rate: f64) -> Self {
        let n = plate.system.terms.load.len();
        let mut matrix = dense(&plate.system.terms.elastic, n) + rate * rate * dense(&plate.system.mass, n);
        plate.system.terms.support.iter().for_each(|support| matrix += dense(support, n));
        plate.system.terms.damping.iter().for_each(|damping| matrix += rate * dense(damping, n));
        let free = (0..n).filter(|&i| plate.system.held.iter().all(|(held, _)| *held != i)).collect();
        Self { matrix, free }
    }

    /// The displacement under a load, with the constrained unknowns at their values.
    pub fn solve(&self, plate: &Plate, load: &[f64]) -> DVector<f64> {
        let mut u = DVector::zeros(plate.system.terms.load.len());
        plate.system.held.iter().for_each(|(i, value)| u[*i] = *value);
        let load = DVector::from_column_slice(load) - &self.matrix * &u;
        let inner = self.matrix.select_rows(&self.free).select_columns(&self.free);
        let found = inner.cholesky().expect("positive definite").solve(&load.select_rows(&self.free));
        self.free.iter().zip(found.iter()).for_each(|(i, value)| u[*i] = *value);
        u
    }
}

pub fn a(plate: &Plate) -> DVector<f64> {
    DVector::from_column_slice(&plate.system.terms.contact.force)
}

/// Displacement average under a unit force on the whole plate.
pub fn answer(plate: &Plate, rate: f64) -> f64 {
    a(plate).dot(&Operator::new(plate, rate).solve(plate, &plate.system.terms.contact.force))
        / plate.system.terms.multiplicity
}

pub fn held(surface: &str, components: &str) -> String {
    format!("[[support]]\nsurface = \"{surface}\"\nkind = \"clamped\"\ncomponents = {components}\n")
}

pub fn elastic(surface: &str, stiffness: &str) -> String {
    format!("[[support]]\nsurface = \"{surface}\"\nkind = \"elastic\"\nstiffness = {stiffness}\n")
}

/// Edge supports for Navier's series: w and the rotation along the edge are constrained.
pub fn navier() -> String {
    held("x-min", r#"["y", "z"]"#)
        + &held("x-max", r#"["y", "z"]"#)
        + &held("y-min", r#"["x", "z"]"#)
        + &held("y-max", r#"["x", "z"]"#)
}

/// Navier's series for a force in the centre: 4/(ab) Σ of the infinite plate's response over odd waves.
pub fn series(edges: [f64; 2], waves: usize, response: impl Fn(f64) -> f64) -> f64 {
    let numbers = || (1..waves).step_by(2).map(|m| m as f64);
    let sum: f64 = numbers()
        .flat_map(|m| numbers().map(move |n| (PI * m / edges[0]).hypot(PI * n / edges[1])))
        .map(response)
        .sum();
    4.0 / (edges[0] * edges[1]) * sum
}

/// Kirchhoff's deflection at the loaded point: the error is proportional to the square of the cell size there.
#[test]
fn navier_kirchhoff() {
    let scene = scene("size = [1.2, 0.9, 0.04]", "", &navier());
    let bending = rigidity(0.04);
    // The sum is cut off at waves of 1/2000 of the edges; the remainder is 1e-7.
    let exact = series([1.2, 0.9], 2000, |xi| 1.0 / (bending * xi.powi(4)));
    let errors = [1.0, 0.5].map(|cell_size_factor| {
        let plate = plate(&scene, PlateTheory::Kirchhoff, cell_size_factor);
        assert_eq!((plate.system.terms.multiplicity, plate.system.terms.contact.compliance), (4.0, 0.0));
        1.0 - answer(&plate, 0.0) / exact
    });
    let order = (errors[0] / errors[1]).log2();
    assert!(errors[0] < 2e-4 && order > 1.7, "{errors:?}, order {order}");
}

/// A plate of one layer with shear under a disc load, with the average of ∇·θ in the load and in the displacement:
/// P² [(1 + s h²ξ²)²/(D ξ⁴) + 6/(5 μ h ξ²)] with s = −ν/(10 (1 − ν)).
#[test]
fn navier_with_shear() {
    let h = 0.04;
    let scene = scene("size = [1.2, 0.9, 0.04]", "", &navier());
    for settings in [Settings::default(), Settings { disc: 1.0, ..Settings::default() }] {
        let errors = [2.0, 1.0, 0.35].map(|cell_size_factor| {
            let settings = Settings { cell_size_factor, ..settings };
            let plate = Plate::new(&scene, PlateTheory::Layerwise, &settings).unwrap();
            let Disc { spread, radius } = plate.layers().disc.unwrap();
            assert_eq!(plate.system.terms.contact.compliance, -4.0 * plate.layers().compliance);
            let shear = 5.0 / 6.0 * YOUNG / (2.0 * (1.0 + POISSON)) * h;
            let reading = -0.1 * POISSON / (1.0 - POISSON);
            let exact = series([1.2, 0.9], 1200, |xi| {
                let pressure = spread.square(xi * radius);
                let bending = (1.0 + reading * (h * xi).powi(2)).powi(2) / (rigidity(h) * xi.powi(4));
                pressure * (bending + 1.0 / (shear * xi * xi))
            });
            1.0 - answer(&plate, 0.0) / exact
        });
        // Cell sizes are one and a half, three quarters, and a quarter of the disc radius, growing towards the edges.
        let bounds = [2e-3, 2e-4, 4e-5];
        assert!(errors.iter().zip(bounds).all(|(error, bound)| (-1e-7..bound).contains(error)), "{errors:?}");
    }
}

/// A free plate has exactly three motions without energy in the whole spline space.
#[test]
fn a_free_plate_has_three_rigid_motions() {
    let scene = scene("size = [0.4, 0.3, 0.03]\nsymmetry = \"none\"", "point = [0.05, 0.02, 0.015]", "");
    for theory in THEORIES {
        let plate = plate(&scene, theory, 1.5);
        assert!(
            plate.system.held.is_empty()
                && plate.system.terms.support.is_none()
                && plate.system.terms.damping.is_none()
        );
        let n = plate.system.terms.load.len();
        let inverse = dense(&plate.system.mass, n).cholesky().unwrap().l().try_inverse().unwrap();
        let elastic = &inverse * dense(&plate.system.terms.elastic, n) * inverse.transpose();
        let mut squares: Vec<f64> = SymmetricEigen::new(elastic).eigenvalues.iter().copied().collect();
        squares.sort_by(f64::total_cmp);
        let (first, last) = (squares[3], squares[n - 1]);
        // Rounding is relative to the largest eigenvalue.
        assert!(squares[2].abs() < 1e-12 * last && first > 0.0, "{theory:?}: {:?} {last:e}", &squares[..4]);
        assert!(first > 100.0 * squares[2].abs(), "{theory:?}: {:?}", &squares[..4]);
    }
}

/// For every plate and a translation: the product with the localisation vector a is 1, K gives zero, and M gives the
/// mass.
#[test]
fn a_translation_is_a_translation() {
    let scenes = [
        scene("size = [1.5, 1.5, 0.1]", "", ""),
        scene("size = [1.5, 0.6, 0.02]", "point = [0.31, -0.2, 0.01]", ""),
        scene("size = [0.3, 0.01, 0.01]", "", ""),
        scene("size = [0.02, 0.9, 0.6]", "point = [-0.01, 0.1, 0.2]\ndirection = [1, 0, 0]", ""),
    ];
    for (scene, theory) in scenes.iter().flat_map(|scene| THEORIES.map(|theory| (scene, theory))) {
        let plate = plate(scene, theory, 1.0);
        let n = plate.system.terms.load.len();
        let translation = DVector::from_column_slice(&plate.system.terms.translation);
        // Rounding of a thousand terms.
        assert!((a(&plate).dot(&translation) - 1.0).abs() < 1e-11, "{theory:?}");
        let elastic = dense(&plate.system.terms.elastic, n);
        assert!((&elastic * &translation).amax() < 1e-12 * elastic.amax(), "{theory:?}");
        let ricochet::scene::Geometry::Box { size, .. } = &scene.body.geometry else { panic!("no box") };
        let mass = plate.system.terms.multiplicity * translation.dot(&(dense(&plate.system.mass, n) * &translation));
        assert!((mass / (DENSITY * size.iter().product::<f64>()) - 1.0).abs() < 1e-12, "{theory:?}: {mass}");
    }
}

/// Deflections of a clamped plate under pressure tend to Kirchhoff's as the plate becomes thin, with the same number of
/// cells: there is no locking.
#[test]
fn thin_plates_do_not_lock() {
    let mut errors = Vec::new();
    for thickness in [1e-1, 1e-2, 1e-3, 1e-4] {
        let point = 0.5 * thickness;
        // The contact is so soft that the impact's waves do not require finer cells.
        let text = format!("point = [0, 0, {point:e}]");
        let rest = held("side", r#"["x", "y", "z"]"#) + "[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -1]\n";
        let mut scene = scene(&format!("size = [1, 1, {thickness:e}]"), &text, &rest);
        scene.impactor.stiffness = 1e-6;
        scene.impactor.force_law = ForceLaw::Hertz(Hertz { stiffness: 1e-6 });
        // Taylor & Govindjee, Solution of clamped rectangular plate problems, Commun. Numer. Methods Eng. 20, 2004.
        let exact = 1.265_319_087e-3 / rigidity(thickness);
        let [kirchhoff, mindlin] = THEORIES.map(|theory| {
            let plate = plate(&scene, theory, 1.0);
            a(&plate).dot(&Operator::new(&plate, 0.0).solve(&plate, &plate.system.terms.load)) / exact - 1.0
        });
        assert!(kirchhoff.abs() < 1e-6, "{thickness}: {kirchhoff:e}");
        errors.push(mindlin);
    }
    // Shear adds a part proportional to (h/L)², and the clamps, which hold the strain of the thickness, take off some 0.04
    // h/L; at 1e-4 both are less than the discretisation error of 2e-5, which does not depend on the thickness.
    assert!(errors[0] > 0.1 && errors[0] < 0.3, "{errors:?}");
    assert!((errors[0] / errors[1]).log10() > 1.8 && errors[2].abs() < 6e-5, "{errors:?}");
    assert!(errors[3].abs() < 2.5e-5, "{errors:?}");
}

/// Resultants over edges and faces, of quarters and whole plates.
#[test]
fn resultants() {
    let rest = "[load]\nbody_force = [0, 0, -2e4]\n[[load.traction]]\nsurface = \"top\"\nvalue = [0, 0, -3e3]\n\
        [[load.traction]]\nsurface = \"side\"\nvalue = [0, 0, 5e3]\n\
        [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [0, 0, 1e9]\ndisplacement = [0, 0, -1e-3]\n\
        [[support]]\nsurface = \"bottom\"\nkind = \"elastic\"\nstiffness = [0, 0, 1e7]\ndamping = [0, 0, 4e5]\n";
    for (symmetry, theory) in ["quarter", "none"].iter().flat_map(|s| THEORIES.map(|theory| (s, theory))) {
        let body = format!("size = [0.6, 0.4, 0.03]\nsymmetry = \"{symmetry}\"");
        let plate = plate(&scene(&body, "", rest), theory, 1.0);
        let (perimeter, area, h) = (2.0, 0.24, 0.03);
        let one = DVector::from_column_slice(&plate.system.terms.translation);
        let of_vector = |v: &[f64]| plate.system.terms.multiplicity * one.dot(&DVector::from_column_slice(v));
        let of_matrix = |m: &Option<CsrMatrix<f64>>| {
            let matrix = dense(m.as_ref().expect("a matrix"), plate.system.terms.load.len());
            plate.system.terms.multiplicity * one.dot(&(matrix * &one))
        };
        let line = perimeter * h;
        for (found, exact) in [
            (of_vector(&plate.system.terms.load), 2e4 * area * h + 3e3 * area - 5e3 * line),
            (of_vector(&plate.system.terms.support_load), 1e9 * 1e-3 * line),
            (plate.system.terms.multiplicity * plate.system.terms.support_offset, 0.5 * 1e9 * 1e-6 * line),
            (of_matrix(&plate.system.terms.support), 1e9 * line + 1e7 / (1.0 + 1e7 * 0.5 * h / 70e9) * area),
            (of_matrix(&plate.system.terms.damping), 4e5 * area),
        ] {
            // Rounding of a thousand terms.
            assert!((found / exact - 1.0).abs() < 1e-11, "{symmetry} {theory:?}: {found} {exact}");
        }
    }
}

/// Stiff springs act like clamps: springs against w like a simple support, and springs also against rotations like a
/// clamped edge.
#[test]
fn stiff_springs_tend_to_clamps() {
    let body = "size = [0.6, 0.4, 0.03]";
    for theory in THEORIES {
        for (stiffness, components) in [("[0, 0, 1e18]", r#"["z"]"#), ("[1e18, 1e18, 1e18]", r#"["x", "y", "z"]"#)] {
            let [sprung, clamped] = [elastic("side", stiffness), held("side", components)]
                .map(|rest| answer(&plate(&scene(body, "", &rest), theory, 1.0), 0.0));
            let off = sprung / clamped - 1.0;
            if theory == PlateTheory::Layerwise && components.contains('x') {
                // A clamp also holds the strain of the thickness: some 0.04 h/L of the deflection, with h/L from 0.05 to 0.075.
                assert!((5e-4..4e-3).contains(&off), "{off:e}");
            } else {
                // E/(k h) = 2e-6 of the plate's own stiffness, and rounding times 1e9.
                assert!(off.abs() < 2e-5, "{theory:?}: {sprung:e} {clamped:e}");
            }
        }
    }
}

/// The prescribed displacement of a clamp moves the whole plate. Where two clamps differ, the later one holds.
#[test]
fn displaced_clamps_carry_the_plate() {
    let rest = held("side", r#"["x", "y", "z"]"#) + &held("side", r#"["z"]"#) + "displacement = [0, 0, -2e-3]\n";
    for (symmetry, theory) in ["quarter", "none"].iter().flat_map(|s| THEORIES.map(|theory| (s, theory))) {
        let scene = scene(&format!("size = [0.6, 0.4, 0.03]\nsymmetry = \"{symmetry}\""), "", &rest);
        let plate = plate(&scene, theory, 1.0);
        let u = Operator::new(&plate, 0.0).solve(&plate, &vec![0.0; plate.system.terms.load.len()]);
        let translation = DVector::from_column_slice(&plate.system.terms.translation);
        assert!((u - 2e-3 * translation).amax() < 1e-10, "{theory:?} {symmetry}");
    }
}

/// Every reason why a scene cannot be modelled as a plate.
#[test]
fn scenes_that_are_no_plates() {
    const BODY: &str = "size = [0.6, 0.4, 0.03]";
    let pad = "[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nstiffness = 1e9\nnormal = [0.1, 0, -1]\n";
    let displaced = held("x-min", r#"["x"]"#) + "displacement = [1e-3, 0, 0]\n";
    let cases = [
        ("mesh = \"x.msh\"", "point = [0, 0, 0]", "", "the body is from a mesh file"),
        (BODY, "direction = [0.1, 0, -1]", "", "the impactor does not move along the normal"),
        (BODY, "direction = [-1, 0, 0]", "", "the body is not thin along x: its edge along y is shorter"),
        (BODY, "", pad, "support.0 on \"bottom\" is a pad that acts along the plate"),
        (BODY, "", &held("bottom", r#"["z"]"#), "support.0 on \"bottom\" holds a face"),
        (
            BODY,
            "",
            &elastic("bottom", "1e9"),
            "support.0 on \"bottom\" is on a face of the plate and acts not along z alone",
        ),
        (BODY, "", &displaced, "support.0 on \"x-min\" has a displacement in the plate's plane"),
        (BODY, "", "[[load.traction]]\nsurface = \"side\"\nvalue = [1, 0, 0]\n", "load.traction.0 has a part in"),
        (BODY, "", "[load]\nbody_force = [0, 1, 0]\n", "load.body_force has a part in"),
    ];
    for (body, impactor, rest, reason) in cases {
        for theory in THEORIES {
            let scene = scene(body, impactor, rest);
            let found = admits(&scene, theory).expect_err(reason);
            assert!(found.starts_with(reason), "{found}");
            let error = Plate::new(&scene, theory, &Settings::default()).expect_err(reason);
            assert!(error.to_string().contains(reason) && error.status() == 2, "{error}");
        }
    }
    let along_edge = scene(BODY, "", &held("side", r#"["x"]"#));
    let near_edge = scene(BODY, "point = [0.29, 0, 0.015]", "");
    let reasons = THEORIES.map(|theory| (admits(&along_edge, theory).err(), admits(&near_edge, theory).err()));
    let [(Some(along), None), (None, Some(near))] = reasons else { panic!("{reasons:?}") };
    assert!(along.starts_with("a side across y is held along x and not along z"), "{along}");
    assert!(near.starts_with("the hit is 1.000e-2 m from an edge"), "{near}");
    for cell_size_factor in [0.0, -1.0, f64::NAN, 1e-3] {
        let settings = Settings { cell_size_factor, ..Settings::default() };
        let error = Plate::new(&scene(BODY, "", ""), PlateTheory::Layerwise, &settings).expect_err("no cells");
        assert!(error.to_string().contains("cells along an edge"), "{error}");
    }
}
