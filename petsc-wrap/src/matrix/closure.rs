//! Operators that are Rust closures.

use std::cell::RefCell;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};

use petsc_sys as sys;

use super::Matrix;
use crate::comm::Comm;
use crate::error::{CLOSURE_ERROR, Result, check};
use crate::vector::{Vector, VectorView};

/// y ← A x; the arguments are x and y.
type Multiply = Box<dyn FnMut(&VectorView, &mut VectorView) -> Result<()>>;

/// A closure, and the communicator of its vectors.
struct Context {
    comm: Comm,
    /// Borrowed while it runs, because the closure may hold its own operator.
    multiply: RefCell<Multiply>,
}

impl Matrix {
    /// Creates a square operator with `local` rows and columns on this rank, defined by its products: `multiply(x, y)`
    /// writes y = A x, collectively. It is for [`MatrixView::mult`](super::MatrixView::mult) and
    /// [`KspView::set_closure`](crate::KspView::set_closure). The closure lives as long as something keeps the
    /// operator. An error or a panic in the closure ends the product with an error. A product by the same operator
    /// inside the closure is an error too. On several ranks, destroy the operator and everything that keeps it before
    /// the session ends: a dropped operator waits until PETSc collects it, and until then the closure's communicator
    /// keeps the session open. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
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
        // SAFETY: the function pointer is converted to the one type that PETSc takes for all operations; PETSc calls it
        // as a product.
        let product = Some(unsafe { std::mem::transmute(product) });
        // SAFETY: a matrix of type shell.
        check(unsafe { sys::MatShellSetOperation(raw, sys::MatOperation::MATOP_MULT, product) })?;
        let end: unsafe extern "C" fn(sys::Mat) -> sys::PetscErrorCode = release;
        // SAFETY: as above.
        let end = Some(unsafe { std::mem::transmute(end) });
        // SAFETY: as above; there is no context yet, which `release` allows.
        check(unsafe { sys::MatShellSetOperation(raw, sys::MatOperation::MATOP_DESTROY, end) })?;
        let context = Box::new(Context { comm: comm.clone(), multiply: RefCell::new(Box::new(multiply)) });
        // SAFETY: PETSc owns the box until `release`.
        check(unsafe { sys::MatShellSetContext(raw, Box::into_raw(context).cast::<c_void>()) })?;
        Ok(matrix)
    }
}

/// Returns the context of an operator; null if it has none.
///
/// # Safety
/// The matrix is valid and of type shell.
unsafe fn context(matrix: sys::Mat) -> *mut Context {
    let mut context: *mut c_void = std::ptr::null_mut();
    // SAFETY: PETSc writes a pointer to where this one points.
    unsafe { sys::MatShellGetContext(matrix, (&raw mut context).cast::<c_void>()) };
    context.cast::<Context>()
}

/// Frees the context.
///
/// # Safety
/// To be called by PETSc, when an operator of [`Matrix::closure`] is destroyed.
unsafe extern "C" fn release(matrix: sys::Mat) -> sys::PetscErrorCode {
    // SAFETY: guaranteed by the caller.
    let context = unsafe { context(matrix) };
    if !context.is_null() {
        // SAFETY: the box was made in `closure`, and nobody else has it.
        drop(unsafe { Box::from_raw(context) });
    }
    0
}

/// Calls the closure for a product.
///
/// # Safety
/// To be called by PETSc, on an operator of [`Matrix::closure`], with two vectors of its layout.
unsafe extern "C" fn call(matrix: sys::Mat, x: sys::Vec, y: sys::Vec) -> sys::PetscErrorCode {
    // SAFETY: guaranteed by the caller.
    let context = unsafe { context(matrix) };
    if context.is_null() || x == y {
        return CLOSURE_ERROR;
    }
    // SAFETY: the box lives until `release`, and all references to it are shared.
    let Context { comm, multiply } = unsafe { &*context };
    // A product by the operator inside its own product is an error.
    let Ok(mut multiply) = multiply.try_borrow_mut() else { return CLOSURE_ERROR };
    // SAFETY: PETSc's vectors are valid for the call.
    let from = unsafe { Vector::lent(x, comm) };
    // SAFETY: as above; it is another vector than `x`.
    let mut to = unsafe { Vector::lent(y, comm) };
    match catch_unwind(AssertUnwindSafe(|| multiply(&from, &mut to))) {
        Ok(Ok(())) => 0,
        _ => CLOSURE_ERROR,
    }
}
