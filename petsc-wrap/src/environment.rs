//! Environment variables, set before MPI reads them.

/// Sets those of the environment variables that are not set yet, where that is sound: as long as no thread but this one exists, none can read
/// the environment meanwhile. Otherwise, and where that cannot be seen (it is on Linux), nothing is set. Returns whether it was sound.
///
/// MPI libraries take settings from the environment when they start, so a program that has some of its own calls this before
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

/// Whether the process is seen to have one thread. Only that thread could start another.
fn is_only_thread() -> bool {
    std::fs::read_dir("/proc/self/task").is_ok_and(|tasks| tasks.count() == 1)
}
