//! Splits a sweep into parts for separate jobs; each part has a file next to the file of the whole sweep.

use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Part i of `n`, `1 ≤ i ≤ n`: the members i − 1, i − 1 + n, …
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// Number of the part, from 1.
    pub i: usize,
    /// Number of parts.
    pub n: usize,
}

impl FromStr for Shard {
    type Err = String;

    /// Parses `i/n`.
    fn from_str(given: &str) -> Result<Self, String> {
        between(given, "/").ok_or_else(|| "a shard is i/n with whole numbers 1 ≤ i ≤ n, as 2/4".to_owned())
    }
}

fn between(text: &str, separator: &str) -> Option<Shard> {
    let (i, n) = text.split_once(separator)?;
    let (i, n) = (i.parse().ok()?, n.parse().ok()?);
    (1 <= i && i <= n).then_some(Shard { i, n })
}

impl Shard {
    /// File of the part: `OUT.i-of-n.h5` for `OUT.h5`.
    pub fn path(self, whole: &Path) -> PathBuf {
        let (stem, ending) = names(whole);
        whole.with_file_name(format!("{stem}{}-of-{}{ending}", self.i, self.n))
    }
}

/// The text before and after `i-of-n` in the file name of a part.
fn names(whole: &Path) -> (String, String) {
    let stem = whole.file_stem().unwrap_or_default().to_string_lossy();
    let ending = whole.extension().map_or(String::new(), |ending| format!(".{}", ending.to_string_lossy()));
    (format!("{stem}."), ending)
}

/// The files next to `whole` that are named as parts of it, sorted by name.
pub fn parts(whole: &Path) -> Vec<PathBuf> {
    let (stem, ending) = names(whole);
    let folder = whole.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let is_part = |name: &String| {
        let middle = name.strip_prefix(&stem).and_then(|rest| rest.strip_suffix(&ending));
        middle.is_some_and(|middle| between(middle, "-of-").is_some())
    };
    // A folder that cannot be listed counts as empty.
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
    let mut parts: Vec<PathBuf> = names.filter(is_part).map(|name| whole.with_file_name(name)).collect();
    parts.sort();
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_i_of_n() {
        assert_eq!("2/4".parse(), Ok(Shard { i: 2, n: 4 }));
        for wrong in ["", "2", "0/4", "5/4", "/4", "2/", "-1/4", "1.5/4", "2/4/8", "a/b"] {
            assert!(wrong.parse::<Shard>().unwrap_err().contains("1 ≤ i ≤ n"), "{wrong}");
        }
    }

    #[test]
    fn parts_are_found_by_their_names() {
        let folder = tempfile::tempdir().unwrap();
        let whole = folder.path().join("k.sweep.h5");
        assert_eq!(Shard { i: 2, n: 3 }.path(&whole), folder.path().join("k.sweep.2-of-3.h5"));
        assert_eq!(Shard { i: 1, n: 2 }.path(Path::new("bare")), Path::new("bare.1-of-2"));
        for name in [
            "k.sweep.h5",
            "k.sweep.2-of-3.h5",
            "k.sweep.1-of-3.h5",
            "k.sweep.4-of-3.h5",
            "k.1-of-3.h5",
            "k.sweep.1-of-3.csv",
        ] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let found = parts(&whole);
        assert_eq!(found, [1, 2].map(|i| Shard { i, n: 3 }.path(&whole)));
        assert!(parts(&folder.path().join("no/k.h5")).is_empty());
    }
}
