//! Threads of the libraries that PETSc computes with.

use std::ffi::{CStr, c_int, c_void};

use crate::session::Session;

/// Functions of one `int` that set a library's number of threads from now on: OpenBLAS's, OpenMP's (CHOLMOD's, for example) and MKL's.
const SETTERS: [&CStr; 3] = [c"openblas_set_num_threads", c"omp_set_num_threads", c"MKL_Set_Num_Threads"];

/// Limits BLAS and OpenMP to this many threads a rank, at least one, where a library that can be told so is loaded.
///
/// By default these libraries take a thread for every core, whatever the number of ranks. The variables `OMP_NUM_THREADS`,
/// `OPENBLAS_NUM_THREADS` and `MKL_NUM_THREADS`, which they read as they are loaded, do not matter any more after this call.
pub fn limit_threads(_session: &Session, threads: usize) {
    let threads = c_int::try_from(threads.max(1)).unwrap_or(c_int::MAX);
    for name in SETTERS {
        // SAFETY: a C string; no library is loaded.
        let found = unsafe { libc::dlsym(libc::RTLD_DEFAULT, name.as_ptr()) };
        if found.is_null() {
            continue;
        }
        // SAFETY: this is what the library that owns the name declares: `void name(int)`.
        let set = unsafe { std::mem::transmute::<*mut c_void, unsafe extern "C" fn(c_int)>(found) };
        // SAFETY: any positive number is valid, and no call into these libraries is under way: handles do not leave this thread.
        unsafe { set(threads) };
    }
}
