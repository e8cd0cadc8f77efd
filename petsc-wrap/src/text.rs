//! Conversion of strings and integers between Rust and C.

use std::ffi::{CStr, CString, c_char};

use crate::Int;
use crate::error::{Error, Result, require};

/// Returns a C string, without the NULs that would end it early.
pub(crate) fn to_c(text: &str) -> CString {
    CString::new(text.replace('\0', "")).unwrap_or_default()
}

/// Returns the C string of an option's name, or of a prefix of such names.
///
/// # Errors
/// [`Error::Invalid`] if the name is longer, or has more numbers between underscores, than the buffers of PETSc
/// (options.c) can hold. PETSc does not check this, and appends some names to a prefix.
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

/// Returns the C string of the name of one of PETSc's types.
///
/// # Errors
/// [`Error::Invalid`] if the type is not in the list. Others crash in PETSc for some matrices, for instance for those
/// with rows without entries, or after a change of the type.
pub(crate) fn type_name(name: &str, admitted: &[&str]) -> Result<CString> {
    require(admitted.contains(&name), &format!("{name:?} is not admitted, only {}", admitted.join(", ")))?;
    Ok(to_c(name))
}

/// Returns a copy of a C string; empty for null.
///
/// # Safety
/// `text` is null, or ends in NUL and is valid during the call.
pub(crate) unsafe fn from_c(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: guaranteed by the caller.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}

/// Converts a count to PETSc's integer type.
///
/// # Errors
/// [`Error::TooLarge`] if it does not fit: a wrapped count would be another size for PETSc.
pub(crate) fn int(count: usize) -> Result<Int> {
    Int::try_from(count).map_err(|_| Error::TooLarge { number: count })
}
