//! Tests of uses that the types must rule out: code that must not compile, next to code that compiles and differs in
//! one line.
//!
//! Only nightly compilers compare the error codes; the variants that compile show that nothing else is wrong.
//!
//! An object that PETSc lends to a closure cannot be taken out of it:
//!
//! ```
//! use petsc_wrap::{Vector, VectorView};
//! fn residual(f: &mut VectorView, mine: &mut Vector) {
//!     f.copy_from(mine).unwrap();
//! }
//! ```
//!
//! ```compile_fail,E0277
//! use petsc_wrap::{Vector, VectorView};
//! fn residual(f: &mut VectorView, mine: &mut Vector) {
//!     std::mem::swap(f, &mut **mine);
//! }
//! ```
//!
//! The same holds for a Jacobian, and for the linear solver of a nonlinear solver:
//!
//! ```
//! use petsc_wrap::{Ksp, Matrix, MatrixView, Snes};
//! fn jacobian(j: &mut MatrixView, mine: &mut Matrix, snes: &mut Snes, ksp: &mut Ksp) {
//!     j.copy_from(mine).unwrap();
//!     snes.ksp().unwrap().set_type("cg").unwrap();
//! }
//! ```
//!
//! ```compile_fail,E0277
//! use petsc_wrap::{Ksp, Matrix, MatrixView, Snes};
//! fn jacobian(j: &mut MatrixView, mine: &mut Matrix, snes: &mut Snes, ksp: &mut Ksp) {
//!     std::mem::swap(j, &mut **mine);
//!     snes.ksp().unwrap().set_type("cg").unwrap();
//! }
//! ```
//!
//! ```compile_fail,E0277
//! use petsc_wrap::{Ksp, Matrix, MatrixView, Snes};
//! fn jacobian(j: &mut MatrixView, mine: &mut Matrix, snes: &mut Snes, ksp: &mut Ksp) {
//!     j.copy_from(mine).unwrap();
//!     std::mem::swap(&mut *snes.ksp().unwrap(), &mut **ksp);
//! }
//! ```
//!
//! A trial cannot outlive its call, nor be exchanged with the trial of an inner solve:
//!
//! ```
//! use petsc_wrap::{Snes, Trial, Vector};
//! fn solve(snes: &mut Snes, x: &mut Vector) {
//!     let mut kept: Option<f64> = None;
//!     let search = |trial: &mut Trial<'_>| { kept = Some(trial.slope(0.0)?); Ok(1.0) };
//!     snes.solve_with_search(x, |_, _| Ok(()), |_, _, _| Ok(()), search).unwrap();
//! }
//! ```
//!
//! ```compile_fail,E0521
//! use petsc_wrap::{Snes, Trial, Vector};
//! fn solve(snes: &mut Snes, x: &mut Vector) {
//!     let mut kept: Option<&mut Trial<'_>> = None;
//!     let search = |trial: &mut Trial<'_>| { kept = Some(trial); Ok(1.0) };
//!     snes.solve_with_search(x, |_, _| Ok(()), |_, _, _| Ok(()), search).unwrap();
//! }
//! ```
//!
//! ```
//! use petsc_wrap::{Snes, Trial, Vector};
//! fn solve(snes: &mut Snes, x: &mut Vector, inner: &mut Snes, y: &mut Vector) {
//!     snes.solve_with_search(x, |_, _| Ok(()), |_, _, _| Ok(()), |one: &mut Trial<'_>| {
//!         inner.solve_with_search(y, |_, _| Ok(()), |_, _, _| Ok(()), |two: &mut Trial<'_>| {
//!             one.slope(two.slope(0.0)?)?;
//!             Ok(1.0)
//!         })?;
//!         Ok(1.0)
//!     }).unwrap();
//! }
//! ```
//!
//! ```compile_fail
//! use petsc_wrap::{Snes, Trial, Vector};
//! fn solve(snes: &mut Snes, x: &mut Vector, inner: &mut Snes, y: &mut Vector) {
//!     snes.solve_with_search(x, |_, _| Ok(()), |_, _, _| Ok(()), |one: &mut Trial<'_>| {
//!         inner.solve_with_search(y, |_, _| Ok(()), |_, _, _| Ok(()), |two: &mut Trial<'_>| {
//!             std::mem::swap(one, two);
//!             Ok(1.0)
//!         })?;
//!         Ok(1.0)
//!     }).unwrap();
//! }
//! ```
//!
//! A closure cannot access the vector that its solver writes:
//!
//! ```compile_fail,E0502
//! use petsc_wrap::{Snes, Vector};
//! fn solve(snes: &mut Snes, x: &mut Vector) {
//!     snes.solve(x, |_, f| Ok(f.copy_from(x)?), |_, _, _| Ok(())).unwrap();
//! }
//! ```
//!
//! A vector cannot be written while it is being read:
//!
//! ```
//! fn write(x: &mut petsc_wrap::Vector) {
//!     let first = x.read().unwrap()[0];
//!     x.fill(1.0).unwrap();
//!     println!("{first}");
//! }
//! ```
//!
//! ```compile_fail,E0502
//! fn write(x: &mut petsc_wrap::Vector) {
//!     let seen = x.read().unwrap();
//!     x.fill(1.0).unwrap();
//!     println!("{}", seen[0]);
//! }
//! ```
//!
//! A preconditioner must be dropped before its solver changes, and the preconditioner of each rank before the method
//! changes:
//!
//! ```
//! fn choose(ksp: &mut petsc_wrap::Ksp) {
//!     let mut pc = ksp.pc().unwrap();
//!     pc.redundant_pc().unwrap().set_type("lu").unwrap();
//!     pc.set_type("jacobi").unwrap();
//! }
//! ```
//!
//! ```compile_fail,E0499
//! fn choose(ksp: &mut petsc_wrap::Ksp) {
//!     let mut pc = ksp.pc().unwrap();
//!     let mut each = pc.redundant_pc().unwrap();
//!     pc.set_type("jacobi").unwrap();
//!     each.set_type("lu").unwrap();
//! }
//! ```
//!
//! ```compile_fail,E0505
//! fn choose(mut ksp: petsc_wrap::Ksp) {
//!     let mut pc = ksp.pc().unwrap();
//!     drop(ksp);
//!     pc.set_type("jacobi").unwrap();
//! }
//! ```
//!
//! The entries of a product by component cannot be changed through the old matrix:
//!
//! ```compile_fail,E0382
//! fn product(mut matrix: petsc_wrap::Matrix) {
//!     let product = matrix.by_component(3).unwrap();
//!     matrix.assemble().unwrap();
//! }
//! ```
//!
//! Handles cannot be sent to or shared with another thread:
//!
//! ```compile_fail,E0277
//! fn send<T: Send>() {}
//! send::<petsc_wrap::Vector>();
//! ```
//!
//! ```compile_fail,E0277
//! fn share<T: Sync>() {}
//! share::<petsc_wrap::Session>();
//! ```
