//! Choice of the iterative method for the time steps of a body that is too large for a factorisation.

use mpi_test::{Test, tests};
use petsc_wrap::{FactorEstimate, Session};
use ricochet::body::Krylov;
use ricochet::solve::linear::{Method, solver};

use super::iterative::{COARSE, MULTIGRID, solid, with_options};

pub const RANKS: &[usize] = &[1, 2, 3];
pub const TESTS: &[Test<Session>] = tests![choice_for_steps, a_basis_takes_a_factor_that_fits];

/// The method for a time step depends on the ratio of stiffness to mass, which grows as the square of the step: an
/// incomplete factorisation for short steps, multigrid for long ones. Both solve, also with options in their place.
fn choice_for_steps(session: &Session) {
    let world = session.world();
    let mut body = solid(&world, COARSE, "");
    let tolerance = 1e-10;
    body.method = Method::Multigrid { tolerance };
    let mut exact = body.terms.load.duplicate().unwrap();
    for (step, method, most) in [
        (2e-6, Method::Incomplete { tolerance }, 20),
        (2e-5, Method::Incomplete { tolerance }, 20),
        (2e-2, Method::Multigrid { tolerance }, 70),
    ] {
        let c2 = 4.0 / (step * step);
        assert_eq!(body.step_method(c2).unwrap(), method, "{step:e}");
        let b = &body.terms.contact.force;
        let matrix = body.operator(0.0, c2).unwrap();
        solver(&world, "", &matrix, Method::Cholesky).unwrap().solve(b, &mut exact).unwrap();
        for chosen in [&[][..], MULTIGRID] {
            let mut ksp = with_options(session, chosen, || body.step_solver(step, 0.0, c2).unwrap());
            let mut x = b.duplicate().unwrap();
            ksp.solve(b, &mut x).unwrap();
            x.axpy(-1.0, &exact).unwrap();
            let error = x.norm().unwrap() / exact.norm().unwrap();
            let iterations = ksp.iterations().unwrap();
            if world.is_root() {
                println!("step {step:e} s, {chosen:?}: {iterations} iterations, error {error:.1e}");
            }
            // Iterations seen: 4, 7 and 13 in the shortest time step on one to three ranks (16 with multigrid), 7, 12
            // and 15 (10) in the next, 54 to 58 in the longest. The error is the tolerance times the effect of the
            // condition number.
            assert!(error < 1e-8 && (1..=most).contains(&iterations), "{step:e} {chosen:?}: {iterations}, {error:e}");
        }
    }
    body.method = Method::Cholesky;
    assert_eq!(body.step_method(1.0).unwrap(), Method::Cholesky, "a factor stays a factor");
}

/// The basis of a large body is computed with a factorisation if it fits in memory. It equals the basis of a small
/// body, although the iterations of the large one would stop early.
fn a_basis_takes_a_factor_that_fits(session: &Session) {
    let world = session.world();
    let mut body = solid(&world, COARSE, "");
    let [exact, large] = [Method::Cholesky, Method::Multigrid { tolerance: 1e-1 }].map(|method| {
        body.method = method;
        let mut krylov = Krylov::new(&body, 1e4).unwrap();
        krylov.grow(&body, 8).unwrap();
        krylov.projection(&body).unwrap().terms.elastic
    });
    // Two factorisations of one matrix: rounding times its condition number.
    let off = (&large - &exact).amax() / exact.amax();
    assert!(off < 1e-7, "{off:e}");
    let multigrid = Method::Multigrid { tolerance: 1e-1 };
    let expected = |memory| Some(FactorEstimate { entries: 0.0, operations: 0.0, memory });
    assert_eq!(multigrid.for_basis(expected(1e9)), Method::Cholesky);
    assert_eq!([expected(1e11), None].map(|factor| multigrid.for_basis(factor)), [multigrid; 2]);
}
