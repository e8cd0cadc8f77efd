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

/// The heap's first memory, which is taken in huge pages as far as it is used, bytes: the system clears and maps 2 MB at once in the place of
/// 4 kB. What is not used is reserved alone.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const IN_HUGE_PAGES: libc::c_int = 64 << 20;

/// Where advice on pages may begin, bytes: a multiple of any system's page.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const SMALL_PAGE: usize = 64 << 10;

/// A block that the heap does not have before it grows, bytes.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const MORE: usize = 1 << 20;

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
            libc::mallopt(libc::M_TOP_PAD, IN_HUGE_PAGES);
        }
        ask_for_huge_pages();
        // SAFETY: as before.
        unsafe { libc::mallopt(libc::M_TOP_PAD, GROWTH) };
    }
}

/// Grows the heap, and asks the system for huge pages there: it may have none.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn ask_for_huge_pages() {
    // SAFETY: the block is given back unused. Between it and the heap's end there is the heap alone, which stays what it is, whatever its pages; a block
    // from elsewhere lies beyond that end, or so far below that it is not the heap's growth.
    unsafe {
        let block = libc::malloc(MORE);
        let (start, end) = ((block as usize).next_multiple_of(SMALL_PAGE), libc::sbrk(0) as usize);
        if !block.is_null() && start < end && end - start <= MORE + 2 * IN_HUGE_PAGES as usize {
            libc::madvise(start as *mut libc::c_void, end - start, libc::MADV_HUGEPAGE);
        }
        libc::free(block);
    }
}
