//! Settings of the C library's allocator, so that freed memory is used again.

/// Largest block, in bytes, that is taken from the heap and not mapped anew from the system. This is the C library's
/// own upper limit.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const LARGEST_KEPT: libc::c_int = 32 << 20;

/// Free memory at the end of the heap, in bytes, that is not returned to the system.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const KEPT: libc::c_int = 256 << 20;

/// Memory in bytes by which the heap grows in addition to the requested size.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const GROWTH: libc::c_int = 4 << 20;

/// First part of the heap, in bytes, which is placed in huge pages as far as it is used: the system clears and maps 2
/// MB at once instead of 4 kB. The unused part is only reserved.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const IN_HUGE_PAGES: libc::c_int = 64 << 20;

/// Alignment, in bytes, of the start of the advised pages: a multiple of any system's page size.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const SMALL_PAGE: usize = 64 << 10;

/// Size, in bytes, of a block for which the heap must grow.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const MORE: usize = 1 << 20;

/// Makes the C library keep freed memory, up to some hundred megabytes. By default it returns blocks of more than 128
/// kB to the system at once. The system would then clear the next block of that size page by page again, which takes
/// longer than filling it.
///
/// Call this at the start of a program: it does nothing if the process has other threads, or without the GNU C library
/// on Linux.
pub fn keep_freed_memory() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    if std::fs::read_dir("/proc/self/task").is_ok_and(|threads| threads.count() == 1) {
        // SAFETY: `mallopt` sets numbers of the allocator, which no other thread reads meanwhile: there is none.
        unsafe {
            libc::mallopt(libc::M_MMAP_THRESHOLD, LARGEST_KEPT);
            libc::mallopt(libc::M_TRIM_THRESHOLD, KEPT);
            libc::mallopt(libc::M_TOP_PAD, IN_HUGE_PAGES);
        }
        ask_for_huge_pages();
        // SAFETY: as before.
        unsafe { libc::mallopt(libc::M_TOP_PAD, GROWTH) };
    }
}

/// Grows the heap and asks the system for huge pages there. The system may have none.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn ask_for_huge_pages() {
    // SAFETY: the block is freed unused. Only the heap lies between the block and the heap's end, and its contents stay
    // the same with any kind of pages. A block from elsewhere lies beyond that end, or so far below it that it is not
    // part of the heap's growth.
    unsafe {
        let block = libc::malloc(MORE);
        let (start, end) = ((block as usize).next_multiple_of(SMALL_PAGE), libc::sbrk(0) as usize);
        if !block.is_null() && start < end && end - start <= MORE + 2 * IN_HUGE_PAGES as usize {
            libc::madvise(start as *mut libc::c_void, end - start, libc::MADV_HUGEPAGE);
        }
        libc::free(block);
    }
}

/// Address space, in bytes, that PETSc and its libraries need. With less, OpenBLAS asks for memory again and again, for
/// ever.
const LEAST_ADDRESS_SPACE: u64 = 1000 << 20;

/// Returns an error, a sentence, if the system limits the process to less address space than PETSc needs.
pub(crate) fn check_address_space() -> Result<(), String> {
    for (resource, name) in [(libc::RLIMIT_AS, "address space"), (libc::RLIMIT_DATA, "data segment")] {
        let mut limit = libc::rlimit { rlim_cur: libc::RLIM_INFINITY, rlim_max: libc::RLIM_INFINITY };
        // SAFETY: the structure is valid; if the call fails, it stays as it is.
        unsafe { libc::getrlimit(resource, &raw mut limit) };
        if limit.rlim_cur < LEAST_ADDRESS_SPACE {
            return Err(format!(
                "the {name} of this process is limited to {} MB, and PETSc needs {} MB: see ulimit, or the memory asked for in a batch job",
                limit.rlim_cur >> 20,
                LEAST_ADDRESS_SPACE >> 20
            ));
        }
    }
    Ok(())
}
