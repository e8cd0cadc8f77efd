//! Solves in which PETSc itself fails. They have a process of their own, since their solvers are leaked on purpose.

use petsc_wrap::{Error, Insert, Int, Ksp, Matrix, Session, Snes, Tolerances, Vector};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let session = Session::start(&[]).ok_or("MPI has been started before")??;
    a_linear_solver_in_which_petsc_fails_is_not_used_again(&session);
    a_nonlinear_solver_in_which_petsc_fails_is_not_used_again(&session);
    admitted_types_stand_any_matrix(&session);
    // The leaked solvers do not keep the session.
    Ok(session.finish()?)
}

fn is_invalid<T>(outcome: petsc_wrap::Result<T>) -> bool {
    matches!(outcome, Err(Error::Invalid { .. }))
}

/// After an error of PETSc's own, here for a matrix of zeros, the destruction of the solver would crash.
fn a_linear_solver_in_which_petsc_fails_is_not_used_again(session: &Session) {
    let world = session.world();
    let first = 3 * world.rank() as Int;
    let zeros = Matrix::csr(&world, &[0, 1, 2, 3], &[first, first + 1, first + 2], &[0.0; 3]).unwrap();
    let mut b = Vector::new(&world, 3).unwrap();
    b.fill(1.0).unwrap();
    let mut x = b.duplicate().unwrap();
    for is_dropped in [true, false] {
        let mut ksp = Ksp::new(&world).unwrap();
        ksp.set_operators(&zeros, &zeros).unwrap();
        ksp.pc().unwrap().set_type("gamg").unwrap();
        assert!(matches!(ksp.solve(&b, &mut x), Err(Error::Petsc { .. })));
        assert!(is_invalid(ksp.solve(&b, &mut x)) && is_invalid(ksp.iterations()) && is_invalid(ksp.pc().map(drop)));
        assert!(is_invalid(ksp.set_operators(&zeros, &zeros)) && is_invalid(ksp.set_closure(&zeros, |_, _| ())));
        if !is_dropped {
            ksp.destroy().unwrap();
        }
    }
    // What the solver has used is whole.
    assert_eq!(zeros.trace().unwrap(), 0.0);
    x.copy_from(&b).unwrap();
}

/// An error of PETSc's own makes both solvers unusable: in a nonlinear solve, and in a solve with the linear solver
/// alone.
fn a_nonlinear_solver_in_which_petsc_fails_is_not_used_again(session: &Session) {
    let world = session.world();
    let mut b = Vector::new(&world, 3).unwrap();
    b.fill(1.0).unwrap();
    let zeros = || {
        let mut zeros = Matrix::aij(&world, (3, 3), &[1; 3], &[0; 3]).unwrap();
        for i in zeros.row_range() {
            zeros.set_values(&[i], &[i], &[0.0], Insert::Replace).unwrap();
        }
        zeros.assemble().unwrap();
        zeros
    };
    for is_linear in [true, false] {
        let mut x = b.duplicate().unwrap();
        let mut snes = Snes::new(&world).unwrap();
        snes.set_jacobian(zeros()).unwrap();
        snes.ksp().unwrap().pc().unwrap().set_type("gamg").unwrap();
        if is_linear {
            let mut ksp = snes.ksp().unwrap();
            ksp.set_operators(&zeros(), &zeros()).unwrap();
            assert!(matches!(ksp.solve(&b, &mut x), Err(Error::Petsc { .. })));
            assert!(is_invalid(ksp.solve(&b, &mut x)));
        } else {
            let outcome = snes.solve(&mut x, |_, f| Ok(f.fill(1.0)?), |_, _, _| Ok(()));
            assert!(matches!(outcome, Err(Error::Petsc { .. })), "{outcome:?}");
        }
        assert!(is_invalid(snes.solve(&mut x, |_, _| Ok(()), |_, _, _| Ok(()))) && is_invalid(snes.ksp().map(drop)));
        if is_linear {
            snes.destroy().unwrap();
        }
    }
}

/// No admitted type crashes for a matrix that is singular, indefinite, not symmetric, empty, infinite or undefined: each
/// solves twice, with the values of the matrix changed in between, or returns an error. (Valgrind sees more.)
fn admitted_types_stand_any_matrix(session: &Session) {
    let world = session.world();
    let entries: [fn(usize, usize) -> Option<f64>; 11] = [
        |i, j| Some(if i == j { 4.1 } else { -1.0 }),
        |i, j| Some(if i == j { -4.1 } else { 1.0 }),
        |i, j| Some(if i == j && i % 10 == 9 { 0.0 } else { 1.0 }),
        |i, j| (i == j).then_some(2.0),
        |i, j| (i >= j).then_some(1.0),
        |i, j| (i != j).then_some(1.0),
        |i, j| (i % 10 != 9).then_some(if i == j { 4.1 } else { -1.0 }),
        |_, _| None,
        |_, _| Some(0.0),
        |i, j| Some(if i == j { f64::NAN } else { 1.0 }),
        |i, j| Some(if i == j { f64::INFINITY } else { 1e308 }),
    ];
    let factors =
        [("lu", "petsc"), ("lu", "mumps"), ("cholesky", "petsc"), ("cholesky", "cholmod"), ("cholesky", "mumps")];
    let others = ["none", "jacobi", "bjacobi", "ilu", "redundant", "gamg"].map(|pc| (pc, "petsc"));
    let with_cg = others.iter().chain(&factors).map(|pc| ("cg", *pc));
    let methods = ["preonly", "minres", "gmres", "fgmres", "bcgs"].map(|ksp| (ksp, ("jacobi", "petsc")));
    let types: Vec<_> = with_cg.chain(methods).collect();
    for (local, entry) in entries.into_iter().map(|entry| (60, entry)).chain([(0, entries[0])]) {
        let (first, size) = (local * world.rank(), local * world.size());
        let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        for i in first..first + local {
            for j in (0..size).filter(|j| [0, 1, 3].contains(&i.abs_diff(*j))) {
                let value = entry(i, j);
                columns.extend(value.map(|_| j as Int));
                values.extend(value);
            }
            offsets.push(columns.len() as Int);
        }
        for (method, (preconditioner, package)) in &types {
            let mut matrix = Matrix::csr(&world, &offsets, &columns, &values).unwrap();
            matrix.set_block_size(3).unwrap();
            let mut ksp = Ksp::new(&world).unwrap();
            ksp.set_operators(&matrix, &matrix).unwrap();
            ksp.set_type(method).unwrap();
            ksp.pc().unwrap().set_type(preconditioner).unwrap();
            ksp.pc().unwrap().set_factor_package(package).unwrap();
            ksp.set_tolerances(Tolerances { iterations: Some(10), ..Default::default() }).unwrap();
            let mut b = Vector::new(&world, local).unwrap();
            b.fill(1.0).unwrap();
            let mut x = b.duplicate().unwrap();
            let _ = ksp.solve(&b, &mut x);
            let one = matrix.duplicate().unwrap();
            matrix.axpy(1.0, &one).unwrap();
            let _ = ksp.solve(&b, &mut x);
            ksp.destroy().unwrap();
        }
    }
}
