//! The local field on bodies at rest: theories that differ without it agree with it.

use nalgebra::{DMatrix, DVector};
use ricochet::body::System;
use ricochet::form::Spread;
use ricochet::scene::Scene;
use ricochet::space::evaluate::PointEvaluator;
use ricochet::space::plate::{self, Plate, PlateTheory};
use ricochet::space::spline::{self, SplineSolid};
use ricochet::stack::{Carrier, Layer, LocalField, Pressure, Stack};

/// A quarter of the paper's plate on springs, h = 0.1 m.
const SCENE: &str = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [1.5, 1.5, 0.1]\nsymmetry = \"quarter\"\n\
                     [impactor]\nmass = 52.0\nradius = 0.05\nstiffness = 2e10\nspeed = 1.0\n[time]\nend = 1e-3\n\
                     [[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = [1e9, 1e9, 1e9]\n";

/// The static displacement under a force of 1 N on the whole plate.
fn at_rest(system: &System) -> Vec<f64> {
    let n = system.terms.contact.force.len();
    let mut stiffness = DMatrix::zeros(n, n);
    for matrix in [Some(&system.terms.elastic), system.terms.support.as_ref()].into_iter().flatten() {
        matrix.triplet_iter().for_each(|(i, j, value)| stiffness[(i, j)] += value);
    }
    let mut force = DVector::from_iterator(n, system.terms.contact.force.iter().map(|a| a / system.terms.multiplicity));
    for &(i, _) in &system.held {
        stiffness.row_mut(i).fill(0.0);
        stiffness.column_mut(i).fill(0.0);
        (stiffness[(i, i)], force[i]) = (1.0, 0.0);
    }
    stiffness.cholesky().expect("a plate that is held").solve(&force).iter().copied().collect()
}

/// σ_rr and σ_θθ on the lower face, with and without the local field of a contact of radius h/25, times h².
fn tensions(points: &dyn PointEvaluator, system: &System, carrier: Carrier, r: f64) -> [[f64; 2]; 2] {
    let h = 0.1;
    let stack = Stack::new(&[Layer { thickness: h, young: 70e9, poisson: 0.23 }]).expect("an elastic layer");
    let local = LocalField::new(stack, carrier, 0.02).at(r, h).stress(0.004);
    let (u, forms) = (at_rest(system), points.at([r, 0.0, -0.5 * h]));
    let body = [0, 1].map(|i| h * h * forms.stress[i].iter().map(|(j, value)| u[*j] * value).sum::<f64>());
    [[body[0] + h * h * local.rr, body[1] + h * h * local.tt], body]
}

/// Without local fields, the tension under the impact point is a sixth lower for a plate with shear than for splines,
/// which carry the bending only; both are loaded by wide discs. With their local fields they agree within 1.5%. This is
/// the discretisation error of both: cells of half the size change them by 0.6% and 0.3%.
#[test]
fn plates_and_solids_agree_under_the_hit() {
    let scene = Scene::parse("test", SCENE, &[]).expect("a scene").0;
    let settings = plate::Settings { cell_size_factor: 0.4, ..Default::default() };
    let plate = Plate::new(&scene, PlateTheory::Layerwise, &settings).expect("a plate");
    let solid =
        SplineSolid::new(&scene, &spline::Settings { cell_size_factor: 0.8, part_cell_factor: 1.0 }).expect("a box");
    let pressure = Pressure::Spread { spread: Spread::new(0.0), radius: 0.2 };
    let theory = plate.layers().theory();
    for (r, apart) in [(0.0, 0.15), (0.05, 0.0), (0.1, 0.0), (0.3, 0.0)] {
        let carrier = Carrier::Layerwise { pressure, theory: theory.clone(), smoothing: None };
        let [of_plate, plain] = tensions(&plate.points, &plate.system, carrier, r);
        let [of_solid, plain_solid] = tensions(&solid.points, &solid.system, Carrier::BentSolid { pressure }, r);
        println!("{r}: {of_plate:?} {of_solid:?}, without {plain:?} {plain_solid:?}");
        assert!((0..2).all(|i| (of_plate[i] - of_solid[i]).abs() < 0.015 * 2.4), "{r}: {of_plate:?} {of_solid:?}");
        assert!(plain[0] < plain_solid[0] * (1.0 - apart) || apart == 0.0, "{r}: {plain:?} {plain_solid:?}");
    }
}
