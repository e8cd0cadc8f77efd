//! Operators that are Rust closures.

use std::cell::RefCell;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};

use petsc_sys as sys;

use super::Matrix;
use crate::comm::Comm;
use crate::error::{Result, USER_ERROR, check};
use crate::vector::{Vector, VectorView};

/// y ← A x; the arguments are x and y.
type Multiply = Box<dyn FnMut(&VectorView, &mut VectorView) -> Result<()>>;

/// A closure, and the ranks of its vectors.
struct Context {
    comm: Comm,
    /// Borrowed while it runs: it may hold its own operator.
    multiply: RefCell<Multiply>,
}

impl Matrix {
    /// A square operator with `local` rows and columns of this rank, known by its products: `multiply(x, y)` writes y = A x, collectively. It is
    /// for [`MatrixView::mult`](super::MatrixView::mult) and [`KspView::set_closure`](crate::KspView::set_closure), and keeps the closure as
    /// long as something keeps it. An error or a panic in the closure ends the product with an error, and so does a product by the same operator
    /// within it. On several ranks destroy it, and what keeps it, before the session ends: what is only dropped waits for PETSc to collect it, and the
    /// closure's ranks keep the session meanwhile. Collective.
    ///
    /// # Errors
    /// PETSc's.
    #[allow(
        clippy::missing_transmute_annotations,
        reason = "the type of any operation's function differs between PETSc's versions"
    )]
    pub fn closure(
        comm: &Comm,
        local: usize,
        multiply: impl FnMut(&VectorView, &mut VectorView) -> Result<()> + 'static,
    ) -> Result<Self> {
        let matrix = Self::create(comm, (local, local), c"shell")?;
        let raw = matrix.raw();
        // SAFETY: sizes and type are set.
        check(unsafe { sys::MatSetUp(raw) })?;
        let product: unsafe extern "C" fn(sys::Mat, sys::Vec, sys::Vec) -> sys::PetscErrorCode = call;
        // SAFETY: a pointer to a function becomes one of the type that PETSc takes for all operations; it calls it as a product.
        let product = Some(unsafe { std::mem::transmute(product) });
        // SAFETY: a matrix of type shell.
        check(unsafe { sys::MatShellSetOperation(raw, sys::MatOperation::MATOP_MULT, product) })?;
        let end: unsafe extern "C" fn(sys::Mat) -> sys::PetscErrorCode = release;
        // SAFETY: as above.
        let end = Some(unsafe { std::mem::transmute(end) });
        // SAFETY: as above; there is no context yet, which `release` knows.
        check(unsafe { sys::MatShellSetOperation(raw, sys::MatOperation::MATOP_DESTROY, end) })?;
        let context = Box::new(Context { comm: comm.clone(), multiply: RefCell::new(Box::new(multiply)) });
        // SAFETY: the box is PETSc's until `release`.
        check(unsafe { sys::MatShellSetContext(raw, Box::into_raw(context).cast::<c_void>()) })?;
        Ok(matrix)
    }
}

/// The context of an operator; null where there is none.
///
/// # Safety
/// The matrix is valid and of type shell.
unsafe fn context(matrix: sys::Mat) -> *mut Context {
    let mut context: *mut c_void = std::ptr::null_mut();
    // SAFETY: PETSc writes a pointer to where this one points.
    unsafe { sys::MatShellGetContext(matrix, (&raw mut context).cast::<c_void>()) };
    context.cast::<Context>()
}

/// # Safety
/// For PETSc to call, on an operator of [`Matrix::closure`] that goes.
unsafe extern "C" fn release(matrix: sys::Mat) -> sys::PetscErrorCode {
    // SAFETY: by the caller.
    let context = unsafe { context(matrix) };
    if !context.is_null() {
        // SAFETY: the box of `closure`, which nobody else has.
        drop(unsafe { Box::from_raw(context) });
    }
    0
}

/// # Safety
/// For PETSc to call, on an operator of [`Matrix::closure`], with two vectors of its layout.
unsafe extern "C" fn call(matrix: sys::Mat, x: sys::Vec, y: sys::Vec) -> sys::PetscErrorCode {
    // SAFETY: by the caller.
    let context = unsafe { context(matrix) };
    if context.is_null() || x == y {
        return USER_ERROR;
    }
    // SAFETY: the box lives until `release`, and nobody has it but by shared references.
    let Context { comm, multiply } = unsafe { &*context };
    // A product within its own product is an error.
    let Ok(mut multiply) = multiply.try_borrow_mut() else { return USER_ERROR };
    // SAFETY: PETSc's vectors are valid for the call.
    let from = unsafe { Vector::lent(x, comm) };
    // SAFETY: as above; it is not the other one.
    let mut to = unsafe { Vector::lent(y, comm) };
    match catch_unwind(AssertUnwindSafe(|| multiply(&from, &mut to))) {
        Ok(Ok(())) => 0,
        _ => USER_ERROR,
    }
}
