//! How memory that is freed is used again.

/// Blocks up to this size come from memory that the process has, bytes: the C library's own limit for them.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const LARGEST_KEPT: libc::c_int = 32 << 20;

/// Free memory at the end of the heap that is not given back, bytes.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const KEPT: libc::c_int = 256 << 20;

/// What the heap grows by beyond what is asked for, bytes.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const GROWTH: libc::c_int = 4 << 20;

/// Has the C library keep what is freed, some hundred megabytes, in the place of giving blocks of more than 128 kB back to the system
/// at once: the next block of that size would be cleared by the system page by page again, which takes longer than to fill it.
///
/// This is for the start of a program: where the process has other threads, and elsewhere than with the GNU C library on Linux, it does nothing.
pub fn keep_freed_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    if std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1) {
        // SAFETY: `mallopt` sets numbers of the allocator, which no other thread reads meanwhile: there is none.
        unsafe {
            libc::mallopt(libc::M_MMAP_THRESHOLD, LARGEST_KEPT);
            libc::mallopt(libc::M_TRIM_THRESHOLD, KEPT);
            libc::mallopt(libc::M_TOP_PAD, GROWTH);
        }
    }
}
