//! Sets environment variables before MPI reads them.

/// Sets the given environment variables that are not set yet, if this is sound. It is sound as long as this is the only
/// thread, since no other thread can then read the environment at the same time. Otherwise nothing is set; the same
/// holds where the number of threads is unknown (Linux tells it). Returns whether it was sound.
///
/// MPI libraries read settings from the environment when they start. A program with its own settings calls this before
/// [`crate::Session::start`].
///
/// ```
/// // A program that nobody launched needs no daemon of Open MPI.
/// petsc_wrap::set_default_environment(&[("OMPI_MCA_ess_singleton_isolated", "1")]);
/// ```
pub fn set_default_environment(variables: &[(&str, &str)]) -> bool {
    if !is_only_thread() {
        return false;
    }
    for (name, value) in variables {
        let is_valid = !name.is_empty() && !name.contains(['=', '\0']) && !value.contains('\0');
        if is_valid && std::env::var_os(name).is_none() {
            // SAFETY: the process has one thread, which is here: none reads or writes the environment meanwhile.
            unsafe { std::env::set_var(name, value) };
        }
    }
    true
}

/// Whether the process is known to have one thread. Only that thread could start another.
fn is_only_thread() -> bool {
    std::fs::read_dir("/proc/self/task").is_ok_and(|tasks| tasks.count() == 1)
}
