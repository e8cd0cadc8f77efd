//! PETSc's error codes as Rust errors that contain PETSc's message and stack.

use std::cell::RefCell;
use std::ffi::{c_char, c_int, c_void};
use std::fmt;
use std::panic::Location;

use petsc_sys as sys;

use crate::text::from_c;

/// Result with [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

/// Error of PETSc, or of a closure that PETSc called.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A call returned an error code.
    #[error("{message} (PETSc error {code} in {}, called at {location})", function(frames))]
    Petsc {
        /// PETSc's error code; 8383 if a closure has failed.
        code: i32,
        /// PETSc's message.
        message: String,
        /// PETSc's stack, innermost first.
        frames: Vec<Frame>,
        /// Location of the call in the Rust source.
        location: &'static Location<'static>,
    },
    /// PETSc's library, or one that it needs, is no longer where it was when the program was built.
    #[error("{0}")]
    NotLoaded(String),
    /// An index beyond the size of a vector or matrix. It is checked here, since PETSc does so in debugging builds
    /// only.
    #[error("index {index} is out of range: the size is {size}")]
    OutOfRange {
        /// The index.
        index: i64,
        /// Number of entries, rows or columns.
        size: usize,
    },
    /// A number that does not fit in PETSc's integer type.
    #[error("{number} does not fit PETSc's integers of {} bits", crate::Int::BITS)]
    TooLarge {
        /// The number.
        number: usize,
    },
    /// Arguments that PETSc would use unchecked: layouts that differ, a matrix that is not assembled or of another
    /// type, ….
    #[error("{message} (called at {location})")]
    Invalid {
        /// Description of the error.
        message: String,
        /// Location of the call in the Rust source.
        location: &'static Location<'static>,
    },
    /// A mesh file that PETSc must not read.
    #[error("{}: {message}", path.display())]
    MeshFile {
        /// The file.
        path: std::path::PathBuf,
        /// Description of the error, with the line of a text file or the byte of a binary one.
        message: String,
    },
    /// An iterative method stopped without convergence.
    #[error(transparent)]
    Diverged(#[from] Diverged),
    /// A closure called by PETSc returned this error.
    #[error(transparent)]
    Callback(Box<dyn std::error::Error>),
}

/// Reason and state of a solver that did not converge.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{solver} did not converge: {reason} after {iterations} iterations, residual norm {norm:.3e}")]
pub struct Diverged {
    /// "KSP" or "SNES".
    pub solver: &'static str,
    /// PETSc's name of the reason, and the linear solver's reason if that is the cause.
    pub reason: String,
    /// Number of iterations done.
    pub iterations: usize,
    /// Norm of the last residual.
    pub norm: f64,
}

/// One frame of PETSc's stack.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Frame {
    /// Name of the C function.
    pub function: String,
    /// Source file.
    pub file: String,
    /// Line in the source file.
    pub line: i32,
}

impl fmt::Display for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}() at {}:{}", self.function, self.file, self.line)
    }
}

fn function(frames: &[Frame]) -> &str {
    frames.first().map_or("PETSc", |frame| &frame.function)
}

#[derive(Default)]
struct Trace {
    message: String,
    frames: Vec<Frame>,
}

thread_local! {
    static TRACE: RefCell<Trace> = RefCell::default();
}

/// The code that PETSc receives for an error in a closure, and passes on. It is none of PETSc's own.
pub(crate) const CLOSURE_ERROR: sys::PetscErrorCode = 8383;

/// Turns a return code into a result; an error takes the recorded message and frames with it.
#[track_caller]
pub(crate) fn check(code: sys::PetscErrorCode) -> Result<()> {
    if code == 0 {
        return Ok(());
    }
    let trace = TRACE.take();
    let message = if trace.message.is_empty() { generic(code) } else { trace.message };
    Err(Error::Petsc { code, message, frames: trace.frames, location: Location::caller() })
}

/// Returns an error if an index is outside 0..size.
pub(crate) fn check_indices(indices: &[crate::Int], size: usize) -> Result<()> {
    match indices.iter().find(|&&index| usize::try_from(index).map_or(true, |index| index >= size)) {
        Some(&index) => Err(Error::OutOfRange { index: index as i64, size }),
        None => Ok(()),
    }
}

/// Returns [`Error::Invalid`] if the condition does not hold.
#[track_caller]
pub(crate) fn require(holds: bool, message: &str) -> Result<()> {
    if holds { Ok(()) } else { Err(Error::Invalid { message: message.to_owned(), location: Location::caller() }) }
}

/// PETSc's one-line text for a code.
fn generic(code: sys::PetscErrorCode) -> String {
    if code == CLOSURE_ERROR {
        return "a closure that PETSc called has failed".to_owned();
    }
    let mut text = std::ptr::null();
    // SAFETY: the out-pointer is valid.
    unsafe { sys::PetscErrorMessage(code, &raw mut text, std::ptr::null_mut()) };
    // SAFETY: the text is static or null.
    unsafe { from_c(text) }
}

/// PETSc's error handler, which records errors instead of printing them. The session installs it.
///
/// # Safety
/// To be called by PETSc: the strings are null or end in NUL.
pub(crate) unsafe extern "C" fn record(
    _comm: mpi::ffi::MPI_Comm,
    line: c_int,
    function: *const c_char,
    file: *const c_char,
    code: sys::PetscErrorCode,
    kind: sys::PetscErrorType,
    message: *const c_char,
    _context: *mut c_void,
) -> sys::PetscErrorCode {
    // SAFETY: PETSc's strings, which live at least for this call.
    let [function, file, message] = [function, file, message].map(|text| unsafe { from_c(text) });
    let frame = Frame { function, file, line };
    // try_with: if the thread-local storage is already destroyed, the error is still returned by its code.
    let _ = TRACE.try_with(|trace| {
        let mut trace = trace.borrow_mut();
        if kind == sys::PetscErrorType::PETSC_ERROR_INITIAL {
            *trace = Trace { message: message.trim().to_owned(), frames: Vec::new() };
        }
        trace.frames.push(frame);
    });
    code
}
