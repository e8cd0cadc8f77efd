//! The largest frequency of a body, compared with dense eigenvalues.

use crate::parts::{FREE, HELD, KINDS, Kind, MASS, ON_PAD, Parts, SIDEWAYS, SIZE, largest, parts, peak_contact};
use mpi_test::{Test, tests};
use nalgebra::DMatrix;
use petsc_wrap::{Matrix, Session};
use ricochet::body::{LargestFrequency, LinearContact};

pub const RANKS: &[usize] = &[1, 2];
pub const TESTS: &[Test<Session>] = tests![largest_frequency_against_dense, spectrum_that_ends_densely, nothing_free];

/// The matrices of a body on one rank: the free unknowns, with the impactor's as the last one.
struct Dense {
    stiffness: DMatrix<f64>,
    mass: DMatrix<f64>,
}

impl Dense {
    fn new(parts: &mut Parts, consistent: bool, contact: Option<LinearContact>) -> Self {
        let Parts { body, lumped, .. } = parts;
        let mut stiffness = body.combination(0.0, 0.0).unwrap();
        if let Some(pads) = &mut body.pads {
            let mut pressed = body.terms.load.duplicate().unwrap();
            pressed.fill(-1.0).unwrap();
            pads.add_tangent(None, &pressed, 1.0, &mut stiffness).unwrap();
            stiffness.assemble().unwrap();
        }
        let free: Vec<usize> = (0..body.unknowns()).filter(|i| !body.clamps.rows.contains(&(*i as _))).collect();
        let choose = |matrix: DMatrix<f64>| matrix.select_rows(&free).select_columns(&free);
        let mut stiffness = choose(dense(&stiffness));
        let mut mass = choose(if consistent {
            dense(&body.mass)
        } else {
            DMatrix::from_diagonal(&lumped.mass.read().unwrap().to_vec().into())
        });
        if let Some(contact) = contact {
            let a = body.terms.contact.force.read().unwrap();
            let last = free.len();
            let hat: Vec<f64> = free.iter().map(|i| -a[*i]).chain([1.0]).collect();
            stiffness = stiffness.resize(last + 1, last + 1, 0.0);
            for (i, row) in hat.iter().enumerate() {
                for (j, column) in hat.iter().enumerate() {
                    stiffness[(i, j)] += contact.tangent * row * column;
                }
            }
            mass = mass.resize(last + 1, last + 1, 0.0);
            mass[(last, last)] = contact.mass;
        }
        Self { stiffness, mass }
    }

    /// ω_max of K x = ω² M x.
    fn largest_frequency(self) -> f64 {
        let factor = self.mass.cholesky().expect("M is positive definite").unpack();
        let half = factor.solve_lower_triangular(&self.stiffness).unwrap();
        let reduced = factor.solve_lower_triangular(&half.transpose()).unwrap();
        reduced.symmetric_eigenvalues().max().sqrt()
    }
}

/// A matrix on one rank, as a dense matrix.
pub fn dense(matrix: &Matrix) -> DMatrix<f64> {
    let mut dense = DMatrix::zeros(matrix.size().0, matrix.size().1);
    for row in matrix.row_range() {
        let entries = matrix.row(row).unwrap();
        for (column, value) in entries.columns.iter().zip(&entries.values) {
            dense[(row as usize, *column as usize)] = *value;
        }
    }
    dense
}

/// ω_max lies between the Ritz value and the bound, which are close and the same on any number of ranks; contact
/// increases it.
fn largest_frequency_against_dense(session: &Session) {
    let (world, alone) = (session.world(), session.alone());
    let [mut error, mut width, mut difference] = [0.0_f64; 3];
    for kind in KINDS {
        for supports in [FREE, HELD, ON_PAD] {
            let mut here = parts(&alone, kind, SIZE, 0.15, supports);
            let mut shared = parts(&world, kind, SIZE, 0.15, supports);
            // So stiff that it has an effect on these coarse meshes.
            let contact = LinearContact { tangent: 1e3 * peak_contact(&here.scene).tangent, mass: MASS };
            for consistent in [false, true] {
                let [apart, touching] = [None, Some(contact)].map(|contact| {
                    let name = format!("{kind:?}, {supports:?}, consistent {consistent}, {contact:?}");
                    let expected = Dense::new(&mut here, consistent, contact).largest_frequency();
                    let found = largest(&mut shared, consistent, contact);
                    // Rounding of the dense eigenvalues is 1e-16 times the ratio of the largest to the smallest mass.
                    assert!(found.ritz <= expected * (1.0 + 1e-12), "{name}: {found:?} instead of {expected}");
                    assert!(found.bound >= expected * (1.0 - 1e-12), "{name}: {found:?} instead of {expected}");
                    assert!(found.ritz > expected * (1.0 - 1e-3), "{name}: {found:?} instead of {expected}");
                    assert!(found.bound < expected * (1.0 + 5e-3), "{name}: {found:?} instead of {expected}");
                    error = error.max(1.0 - found.ritz / expected);
                    width = width.max(found.bound / expected - 1.0);
                    let by_one = largest(&mut here, consistent, contact);
                    assert_eq!(by_one.vectors, found.vectors, "{name}");
                    difference = difference.max((by_one.ritz / found.ritz - 1.0).abs());
                    difference = difference.max((by_one.bound / found.bound - 1.0).abs());
                    expected
                });
                // If the support's springs determine ω_max, contact elsewhere adds almost nothing.
                assert!(
                    touching > if supports == FREE { 1.01 * apart } else { apart },
                    "{kind:?}: {apart}, {touching}"
                );
            }
            drop((here, shared));
            world.collect_garbage().unwrap();
        }
    }
    // The order of sums differs; full orthogonalisation keeps this error from growing.
    assert!(difference < 1e-6, "{difference:e}");
    if world.is_root() {
        println!("ω_max: Ritz value low by {error:.1e}, bound high by {width:.1e}, ranks differ by {difference:.1e}");
    }
}

/// A column of many equal cells has many frequencies close to the largest. The Ritz value is then less accurate, and
/// the bound still holds.
fn spectrum_that_ends_densely(session: &Session) {
    let world = session.world();
    let (kind, size) = (Kind { cells: [1, 1, 60], ..KINDS[0] }, [0.1, 0.1, 6.0]);
    let expected = Dense::new(&mut parts(&session.alone(), kind, size, 0.0, SIDEWAYS), false, None).largest_frequency();
    let found = largest(&mut parts(&world, kind, size, 0.0, SIDEWAYS), false, None);
    let [low, high] = [1.0 - found.ritz / expected, found.bound / expected - 1.0];
    // Both are promised to half a percent.
    assert!((-1e-12..1e-3).contains(&low) && (1e-6..5e-3).contains(&high), "{found:?} instead of {expected}");
    if world.is_root() {
        println!(
            "ω_max at a dense end: Ritz value low by {low:.1e}, bound high by {high:.1e}, {} vectors",
            found.vectors
        );
    }
}

/// A body that is constrained everywhere has no frequency of its own; with the impactor in contact there is one.
fn nothing_free(session: &Session) {
    let surfaces = ["side", "top", "bottom"];
    let held = surfaces.map(|name| format!("[[support]]\nsurface = \"{name}\"\nkind = \"clamped\"\n")).concat();
    let kind = Kind { cells: [1, 1, 1], ..KINDS[0] };
    let mut parts = parts(&session.world(), kind, SIZE, 0.0, &held);
    for consistent in [false, true] {
        let none = largest(&mut parts, consistent, None);
        assert_eq!(none, LargestFrequency { ritz: 0.0, bound: 0.0, vectors: 0 });
        let contact = LinearContact { tangent: 8.0, mass: 2.0 };
        let one = largest(&mut parts, consistent, Some(contact));
        assert!((one.ritz - 2.0).abs() < 1e-14 && (one.bound - 2.0).abs() < 1e-7 && one.vectors == 1, "{one:?}");
    }
}
