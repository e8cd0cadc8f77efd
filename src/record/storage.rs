//! HDF5 files: how they are created and opened, and how texts and datasets are read from them.
//!
//! A result may come from somebody else, and may be damaged. So texts have a fixed length (the library crashes on a damaged
//! heap of texts of variable length), nothing outside the file is read, and a dataset larger than the file is refused.

use std::path::Path;

use hdf5_metno as hdf5;
use hdf5_metno::plist::dataset_create::Layout;
use hdf5_metno::plist::file_access::LibraryVersion;
use hdf5_metno::types::{FixedUnicode, TypeDescriptor};
use hdf5_metno::{Dataset, File, FileBuilder, Group, H5Type, LinkType, Location, LocationType, Result};

/// Most bytes of a text in an attribute; HDF5's limit is 64 KiB with the attribute's name and type.
const LONGEST: usize = 60_000;

/// Most bytes of a word in a list of words.
const LONGEST_WORD: usize = 1000;

/// Memory that a dataset may take however small its file is, bytes.
const ROOM: u64 = 64 << 20;

/// Depth of groups in a file beyond which it is not one of this program.
const DEEPEST: usize = 8;

/// Alignment in a file of objects of at least [`LEAST_ALIGNED`] bytes, bytes: a part of a page. The header of a dataset takes
/// 268. A kill may end a write at the border of two pages, where a header would lose its checksum.
const ALIGNMENT: u64 = 512;
const LEAST_ALIGNED: u64 = 256;

/// Names of the links from a result to the fields beside it, which no command follows.
const LINKS: [&str; 2] = ["VTKHDF", "fields"];

/// How files are opened: the format of HDF5 1.8, whose headers carry checksums. Later formats mark a file that is open
/// for writing, and would not open it again after a kill.
fn options() -> FileBuilder {
    let mut builder = File::with_options();
    builder.with_fapl(|access| {
        access.libver_bounds(LibraryVersion::V18, LibraryVersion::V18).alignment(LEAST_ALIGNED, ALIGNMENT);
        // Without blocks for small objects, whose unused rest is cut off later: a kill between the cut and the note of the
        // new length would leave a file that is too short.
        access.meta_block_size(0).small_data_block_size(0)
    });
    builder
}

/// Creates a file, or replaces it.
pub(super) fn create(path: &Path) -> Result<File> {
    options().create(path)
}

/// Opens a file for writing.
pub(super) fn open_to_write(path: &Path) -> Result<File> {
    options().open_rw(path)
}

/// Opens a file for reading. A file with links to others is refused.
pub(super) fn open(path: &Path) -> Result<File> {
    let file = options().open(path)?;
    check_links(&file, DEEPEST)?;
    Ok(file)
}

fn check_links(group: &Group, depth: usize) -> Result<()> {
    if depth == 0 {
        return Err("its groups are nested too deeply".into());
    }
    let (is_root, mut inner) = (depth == DEEPEST, Vec::new());
    group.iter_visit_default(|name, link| {
        match link.link_type {
            LinkType::Hard => {
                let object = group.loc_info_by_name(name)?;
                // With several names for one group, a small file could have any number of paths.
                if object.num_links > 1 {
                    return Err(format!("its {name:?} has a second hard link").into());
                }
                if object.loc_type == LocationType::Group {
                    inner.push(name.to_owned());
                }
            }
            _ if is_root && LINKS.contains(&name) => {}
            _ => return Err(format!("its {name:?} is a link, which is not followed").into()),
        }
        Ok(())
    })?;
    inner.into_iter().try_for_each(|name| check_links(&group.group(&name)?, depth - 1))
}

fn is_group(group: &Group, name: &str) -> bool {
    group.loc_info_by_name(name).is_ok_and(|info| info.loc_type == LocationType::Group)
}

/// Whether a file has a group that lies in the file itself.
pub(super) fn has_group(file: &File, name: &str) -> bool {
    let is_own = |link: &str, info: hdf5::LinkInfo| Ok((link == name).then_some(info.link_type == LinkType::Hard));
    let is_own = file.find_link(hdf5::IndexType::default(), hdf5::IterationOrder::default(), is_own);
    is_own.ok().flatten().unwrap_or_default() && is_group(file, name)
}

/// Reads a dataset, row by row.
pub(super) fn read<T: H5Type>(group: &Group, path: &str) -> Result<Vec<T>> {
    values(&group.dataset(path)?)
}

/// Reads a dataset that is open.
pub(super) fn values<T: H5Type>(dataset: &Dataset) -> Result<Vec<T>> {
    let plist = dataset.create_plist()?;
    if plist.layout() == Layout::Virtual || !plist.external().is_empty() || plist.has_filters() {
        return Err("its values are compressed, or in another file, as this program does not write them".into());
    }
    let bytes = |each: usize| dataset.shape().iter().try_fold(each, |all, n| all.checked_mul(*n));
    let available = dataset.file()?.size();
    let is_within = |bytes: Option<usize>, most: u64| bytes.is_some_and(|bytes| bytes as u64 <= most);
    // In memory, a word takes as much as the longest one may.
    if !is_within(bytes(dataset.dtype()?.size()), available) || !is_within(bytes(size_of::<T>()), available.max(ROOM)) {
        return Err("it is larger than the file, or needs more memory than one of this size should".into());
    }
    dataset.read_raw()
}

/// Creates an attribute with a text, of which [`LONGEST`] bytes are stored.
pub(super) fn write_text(at: &Location, name: &str, text: &str) -> Result<()> {
    write_text_with_room(at, name, text, text.len())
}

/// Creates an attribute with a text, and with room for one of so many bytes.
pub(super) fn write_text_with_room(at: &Location, name: &str, text: &str, room: usize) -> Result<()> {
    // HDF5 has no text of length 0.
    let kind = TypeDescriptor::FixedUnicode(room.clamp(1, LONGEST));
    at.new_attr_builder().empty_as(&kind).create(name)?;
    update_text(at, name, text)
}

/// Overwrites a text attribute in place; what exceeds its room is left out.
pub(super) fn update_text(at: &Location, name: &str, text: &str) -> Result<()> {
    let attribute = at.attr(name)?;
    let room = attribute.dtype()?.size();
    attribute.write_scalar(&*fixed::<LONGEST>(cut(text, room))?)
}

/// The beginning of a text, of at most so many bytes.
pub(super) fn cut(text: &str, bytes: usize) -> &str {
    let end = (0..=bytes.min(text.len())).rev().find(|end| text.is_char_boundary(*end));
    &text[..end.unwrap_or_default()]
}

fn fixed<const N: usize>(text: &str) -> Result<Box<FixedUnicode<N>>> {
    let fits = text.parse().ok().filter(|_| !text.contains('\0'));
    fits.map(Box::new).ok_or_else(|| format!("{text:?} holds a NUL character, or is too long").into())
}

/// Reads a text attribute.
pub(super) fn text(at: &Location, name: &str) -> Result<String> {
    let attribute = at.attr(name)?;
    match attribute.dtype()?.to_descriptor()? {
        TypeDescriptor::FixedUnicode(size) if size <= LONGEST => {
            decoded(attribute.read_scalar::<FixedUnicode<LONGEST>>()?.as_bytes())
        }
        _ => Err(format!("its attribute {name} is not a text of fixed length").into()),
    }
}

/// The text of bytes in UTF-8.
pub(super) fn decoded(bytes: &[u8]) -> Result<String> {
    String::from_utf8(bytes.to_vec()).map_err(|_| "a text is not in UTF-8".into())
}

/// Stores a text of any length: an attribute or, beyond an attribute's limit, a dataset of bytes.
pub(super) fn write_long_text(group: &Group, name: &str, text: &str) -> Result<()> {
    if text.len() <= LONGEST {
        return write_text(group, name, text);
    }
    if text.contains('\0') {
        return Err(format!("the text of {name} holds a NUL character").into());
    }
    group.new_dataset_builder().with_data(text.as_bytes()).create(name).map(|_| ())
}

/// Reads a text that [`write_long_text`] has stored.
pub(super) fn long_text(group: &Group, name: &str) -> Result<String> {
    if group.link_exists(name) { decoded(&read::<u8>(group, name)?) } else { text(group, name) }
}

/// Creates a dataset of words.
pub(super) fn write_words<'a>(group: &Group, path: &str, words: impl Iterator<Item = &'a str>) -> Result<Dataset> {
    let words = words.map(|word| fixed::<LONGEST_WORD>(word).map(|word| *word)).collect::<Result<Vec<_>>>()?;
    let longest = words.iter().map(|word| word.len()).max().unwrap_or_default();
    let kind = TypeDescriptor::FixedUnicode(longest.max(1));
    group.new_dataset_builder().with_data_as(&words, &kind).create(path)
}

/// Reads a dataset of words; `None` if it does not hold words.
pub(super) fn words(dataset: &Dataset) -> Result<Option<Vec<String>>> {
    match dataset.dtype()?.to_descriptor()? {
        TypeDescriptor::FixedUnicode(size) if size <= LONGEST_WORD => {
            let words = values::<FixedUnicode<LONGEST_WORD>>(dataset)?;
            words.iter().map(|word| decoded(word.as_bytes())).collect::<Result<_>>().map(Some)
        }
        _ => Ok(None),
    }
}

/// Creates an attribute with one value.
pub(super) fn write_scalar<T: H5Type>(at: &Location, name: &str, value: T) -> Result<()> {
    at.new_attr::<T>().create(name)?.write_scalar(&value)
}

/// Reads an attribute with a few values.
pub(super) fn read_list<T: H5Type>(at: &Location, name: &str) -> Result<Vec<T>> {
    let attribute = at.attr(name)?;
    if attribute.size() > LONGEST {
        return Err(format!("its attribute {name} is too long").into());
    }
    attribute.read_raw()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_and_words_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("texts.h5");
        let long = "ä scene\n".repeat(20_000);
        let words = ["", "a", "ä long word ".repeat(20).leak()];
        let file = create(&path).unwrap();
        for (name, text) in [("empty", ""), ("one", "x"), ("German", "Öl über Glas\n")] {
            write_text(&file, name, text).unwrap();
        }
        write_text_with_room(&file, "later", "", 5).unwrap();
        update_text(&file, "later", "abcdäf").unwrap();
        write_long_text(&file, "scene", &long).unwrap();
        write_words(&file, "words", words.into_iter()).unwrap();
        assert!(write_text(&file, "NUL", "a\0b").is_err());
        drop(file);
        let file = open(&path).unwrap();
        let read = |name: &str| text(&file, name).unwrap();
        assert_eq!((read("empty"), read("one"), read("German")), (String::new(), "x".into(), "Öl über Glas\n".into()));
        assert_eq!(read("later"), "abcd", "a letter of two bytes is not cut");
        assert_eq!(long_text(&file, "scene").unwrap(), long);
        assert_eq!(super::words(&file.dataset("words").unwrap()).unwrap().unwrap(), words);
    }

    /// What is not in the file, or is no text of this program, is an error.
    #[test]
    fn what_others_put_into_a_file_is_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("secret"), [7_u8; 80]).unwrap();
        let file = create(&path("other.h5")).unwrap();
        file.new_dataset_builder().with_data(&[1.0, 2.0]).create("values").unwrap();
        drop(file);
        let made = |name: &str, with: &dyn Fn(&File)| {
            let file = create(&path(name)).unwrap();
            with(&file);
            file.close().unwrap();
            open(&path(name))
        };
        let other = path("other.h5");
        let other = other.to_str().unwrap();
        assert!(made("soft.h5", &|file| file.link_soft("/nowhere", "a").unwrap()).is_err());
        assert!(made("far.h5", &|file| file.link_external(other, "/values", "a").unwrap()).is_err());
        let inner = |file: &File| file.create_group("b").unwrap().link_external(other, "/", "c").unwrap();
        assert!(made("inner.h5", &inner).is_err());
        assert!(made("loop.h5", &|file| file.create_group("b").unwrap().link_hard("/b", "c").unwrap()).is_err());
        let twice = |file: &File| {
            file.create_group("b").unwrap();
            file.link_hard("/b", "c").unwrap();
        };
        assert!(made("twice.h5", &twice).is_err());
        let empty = |file: &File| {
            let kind = TypeDescriptor::FixedUnicode(1);
            file.new_dataset_builder().empty_as(&kind).shape(1 << 17).create("words").map(|_| ()).unwrap();
            file.new_dataset_builder().with_data(&[0_u8; 1 << 17]).create("filling").map(|_| ()).unwrap();
        };
        assert!(super::words(&made("words.h5", &empty).unwrap().dataset("words").unwrap()).is_err());
        let secret = path("secret");
        let stored = |file: &File| {
            let builder = file.new_dataset::<f64>().external(secret.to_str().unwrap(), 0, 80);
            builder.shape(10).create("values").map(|_| ()).unwrap();
        };
        assert!(read::<f64>(&made("stored.h5", &stored).unwrap(), "values").is_err());
        let huge = |file: &File| {
            file.new_dataset::<f64>().shape((1_usize << 40,)).chunk((8,)).create("values").map(|_| ()).unwrap();
        };
        assert!(read::<f64>(&made("huge.h5", &huge).unwrap(), "values").is_err());
        let variable = |file: &File| {
            let word: hdf5::types::VarLenUnicode = "x".parse().unwrap();
            write_scalar(file, "title", word).unwrap();
        };
        assert!(text(&made("variable.h5", &variable).unwrap(), "title").is_err());
    }
}
