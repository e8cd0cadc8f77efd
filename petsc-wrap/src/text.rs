//! Strings and integers between Rust and C.

use std::ffi::{CStr, CString, c_char};

use crate::Int;
use crate::error::{Error, Result, require};

/// A string for C, without the NULs that would end it early.
pub(crate) fn to_c(text: &str) -> CString {
    CString::new(text.replace('\0', "")).unwrap_or_default()
}

/// The name of an option, or the beginning of one, for C.
///
/// # Errors
/// [`Error::Invalid`] for a name that is long, or has more numbers between underscores, than PETSc (options.c) has room for: it does not
/// check. It adds to a prefix some names of its own.
pub(crate) fn option_name(name: &str) -> Result<CString> {
    const LONGEST: usize = 200;
    const MOST_NUMBERS: usize = 8;
    let numbers = name.split('_').filter(|part| part.starts_with(|c: char| c.is_ascii_digit())).count();
    require(
        name.len() <= LONGEST && numbers <= MOST_NUMBERS,
        "the name of an option is longer than PETSc has room for",
    )?;
    Ok(to_c(name))
}

/// A copy of a string of C; empty for null.
///
/// # Safety
/// `text` is null, or ends in NUL and is valid during the call.
pub(crate) unsafe fn from_c(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: by the caller.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

/// A count as one of PETSc's integers.
///
/// # Errors
/// [`Error::TooLarge`]: a count that wraps would be a size that PETSc takes for another.
pub(crate) fn int(count: usize) -> Result<Int> {
    Int::try_from(count).map_err(|_| Error::TooLarge { number: count })
}
