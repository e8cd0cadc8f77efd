//! Texts in HDF5 files: attributes of a fixed length.

use hdf5_metno as hdf5;
use hdf5_metno::types::{FixedUnicode, TypeDescriptor};

/// A text with the largest length of an attribute.
type Text = FixedUnicode<60_000>;

/// A text attribute.
pub fn text(at: &hdf5::Location, name: &str) -> String {
    let text = at.attr(name).unwrap().read_scalar::<Text>().unwrap();
    String::from_utf8(text.as_bytes().to_vec()).unwrap()
}

/// Creates a text attribute, or replaces it.
pub fn set_text(at: &hdf5::Location, name: &str, text: &str) {
    if at.attr(name).is_ok() {
        at.delete_attr(name).unwrap();
    }
    let kind = TypeDescriptor::FixedUnicode(text.len().max(1));
    let attribute = at.new_attr_builder().empty_as(&kind).create(name).unwrap();
    attribute.write_scalar(&text.parse::<Text>().unwrap()).unwrap();
}
