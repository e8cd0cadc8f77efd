//! Static tensile stresses on the faces of layers: solids of splines on coarse and on finer cells, and the layerwise
//! plate.

use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};
use ricochet::body::System;
use ricochet::scene::{Scene, Vec3};
use ricochet::space::evaluate::{ContactNow, Evaluator, HitBody, PointEvaluator};
use ricochet::space::plate::{self, Plate, PlateTheory};
use ricochet::space::spline::{self, SplineSolid};
use ricochet::stack::{Carrier, LocalField};

/// A quarter of a small pane on springs: 10 mm of glass, a soft interlayer, 10 mm of glass.
const SCENE: &str = "[body]\nsize = [0.16, 0.16]\nsymmetry = \"quarter\"\n\
    [[body.layer]]\nthickness = 0.01\nmaterial = \"glass\"\n[[body.layer]]\nthickness = 0.00076\nmaterial = \"interlayer\"\n\
    [[body.layer]]\nthickness = 0.01\nmaterial = \"glass\"\n[material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
    [material.interlayer]\nbulk = 2e9\nshear = 1e7\ndensity = 1100.0\n\
    [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [0.0, 0.0, 1e9]\n\
    [time]\nend = 1e-3\n[impactor]\nmass = 5.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n";

/// The same pane, hit on its other face.
const FROM_BELOW: &str = "point = [0.0, 0.0, -0.01038]\ndirection = [0.0, 0.0, 1.0]\n";

/// Heights, m, of the lower face of the ply that is hit and of the lowest face, for an impact from above. Points at the
/// first height belong to the ply.
const FACES: [f64; 2] = [0.00038, -0.01038];

/// Radius of the contact, m.
const CONTACT: f64 = 0.0025;

fn scene(rest: &str) -> Scene {
    Scene::parse("test", &format!("{SCENE}{rest}"), &[]).expect("a scene").0
}

/// The static displacement under a force of 1 N on the whole body.
fn at_rest(system: &System) -> Vec<f64> {
    let n = system.terms.contact.force.len();
    let held: Vec<bool> = (0..n).map(|i| system.held.iter().any(|(j, _)| *j == i)).collect();
    let mut entries: Vec<Triplet<usize, usize, f64>> =
        (0..n).filter(|i| held[*i]).map(|i| Triplet::new(i, i, 1.0)).collect();
    for matrix in [Some(&system.terms.elastic), system.terms.support.as_ref()].into_iter().flatten() {
        let free = matrix.triplet_iter().filter(|(i, j, _)| !held[*i] && !held[*j]);
        entries.extend(free.map(|(i, j, value)| Triplet::new(i, j, *value)));
    }
    let stiffness = SparseColMat::try_new_from_triplets(n, n, &entries).expect("a matrix");
    let force = |i: usize| if held[i] { 0.0 } else { system.terms.contact.force[i] / system.terms.multiplicity };
    let u = stiffness.sp_cholesky(Side::Lower).expect("a body that is held").solve(Mat::from_fn(n, 1, |i, _| force(i)));
    (0..n).map(|i| u[(i, 0)]).collect()
}

/// Tension of a displacement at a point, Pa.
fn tension(forms: &[(usize, f64)], u: &[f64]) -> f64 {
    forms.iter().map(|(j, value)| u[*j] * value).sum()
}

/// Tensions under the impact point on faces at these heights, for 1 N, as the program evaluates them, Pa.
fn read(scene: &Scene, points: impl PointEvaluator + 'static, u: &[f64], heights: [f64; 2]) -> [f64; 2] {
    let evaluator = Evaluator::of_grid(scene, points);
    heights.map(|z| {
        let forms = evaluator.at([0.0, 0.0, z]).expect("a point of the body");
        let local = forms.local.expect("the local field").stress(&ContactNow { force: 1.0, radius: CONTACT });
        local[0] + tension(&forms.stress[0], u)
    })
}

fn solid(scene: &Scene, cell_size_factor: f64) -> (SplineSolid, Vec<f64>) {
    let solid = SplineSolid::new(scene, &spline::Settings { cell_size_factor, part_cell_factor: 1.0 }).expect("a box");
    let u = at_rest(&solid.system);
    (solid, u)
}

/// With one cell through each layer, the tension agrees with cells of two thirds of the size to 0.5%, and with the
/// layerwise plate to 1%, because it is evaluated from the section forces and moments of each layer. Evaluated at a
/// point in these cells it is 11% too high on the face next to the soft layer.
#[test]
fn faces_beside_a_soft_layer_are_read_as_means() {
    let scene = scene("");
    let (coarse, u) = solid(&scene, 1.6);
    let (fine, fine_u) = solid(&scene, 1.0);
    assert!(coarse.cells[2] == 3 && fine.cells[2] > 3, "{:?} {:?}", coarse.cells, fine.cells);
    let found = read(&scene, coarse.points.clone(), &u, FACES);
    let finer = read(&scene, fine.points, &fine_u, FACES);
    let settings = plate::Settings::new(1e-2, PlateTheory::Layerwise);
    let Plate { system, points, .. } = Plate::new(&scene, PlateTheory::Layerwise, &settings).expect("a plate");
    let plate = read(&scene, points, &at_rest(&system), FACES);
    let hit = coarse.points.hit().expect("a hit");
    let HitBody::Layers(stack) = hit.body else { panic!("layers") };
    let local = LocalField::new(stack, Carrier::Solid { pressure: hit.pressure }, 0.02);
    let inside: Vec3 = [0.0, 0.0, FACES[0] + 1e-11];
    let at_point = local.at(0.0, 0.01 - 1e-11).stress(CONTACT).rr + tension(&coarse.points.at(inside).stress[0], &u);
    println!("{found:?}, finer {finer:?}, plate {plate:?}, at a point {at_point}");
    for (i, tension) in found.iter().enumerate() {
        assert!((tension / finer[i] - 1.0).abs() < 5e-3, "{found:?} {finer:?}");
        assert!((tension / plate[i] - 1.0).abs() < 1e-2, "{found:?} {plate:?}");
    }
    assert!(at_point / finer[0] > 1.08, "{at_point} {finer:?}");
}

/// A symmetric pane has the same tensions if it is hit from below, also at points between layers.
#[test]
fn faces_of_layers_hit_from_below() {
    let [above, below] = [("", 1.0), (FROM_BELOW, -1.0)].map(|(rest, sign)| {
        let scene = scene(rest);
        let (solid, u) = solid(&scene, 1.6);
        read(&scene, solid.points, &u, FACES.map(|z| sign * z))
    });
    for (above, below) in above.iter().zip(&below) {
        // Rounding, amplified by a factorisation.
        assert!((above / below - 1.0).abs() < 1e-6, "{above} {below}");
    }
}
