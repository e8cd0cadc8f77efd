//! `ricochet plot`: results to a figure.

use crate::error::Result;
use crate::figure::history::{Curve, draw};
use crate::record::read::history;
use std::path::{Path, PathBuf};

/// Draws the acceleration histories of the results `files` to `out`, one curve a file.
///
/// # Errors
/// As of [`history`] and [`draw`].
pub fn plot(files: &[PathBuf], out: &Path) -> Result<()> {
    let histories = files.iter().map(|file| history(file)).collect::<Result<Vec<_>>>()?;
    let titles: Vec<&str> = histories.iter().map(|h| h.title.trim()).collect();
    let labels = labels(files, &titles);
    let curves: Vec<Curve> = histories
        .into_iter()
        .zip(labels)
        .map(|(history, label)| Curve {
            label,
            time: history.time,
            acceleration: history.acceleration,
            contacts: history.contacts,
        })
        .collect();
    draw(&curves, out)
}

/// The title of each file, with the file's name where there is no title or another file has the same, and with its
/// path where the name too is that of another.
fn labels(files: &[PathBuf], titles: &[&str]) -> Vec<String> {
    let names: Vec<String> =
        files.iter().map(|file| file.file_name().unwrap_or_default().to_string_lossy().into_owned()).collect();
    (0..files.len())
        .map(|n| {
            let title = titles[n];
            let alike = titles.iter().filter(|other| **other == title).count() > 1;
            let name = match names.iter().filter(|other| **other == names[n]).count() {
                1 => names[n].clone(),
                _ => files[n].display().to_string(),
            };
            match (title.is_empty(), alike) {
                (true, _) => name,
                (false, true) => format!("{title} ({name})"),
                (false, false) => title.to_owned(),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::labels;
    use std::path::PathBuf;

    #[test]
    fn labels_name_the_file_where_titles_do_not_tell() {
        let files: Vec<PathBuf> = ["a/1.h5", "a/2.h5", "b/2.h5", "3.h5"].map(PathBuf::from).into();
        assert_eq!(
            labels(&files, &["plate", "plate", "plate", ""]),
            ["plate (1.h5)", "plate (a/2.h5)", "plate (b/2.h5)", "3.h5"]
        );
        assert_eq!(labels(&files[..2], &["x", "y"]), ["x", "y"]);
    }
}
