//! `ricochet plot`: results to a figure.

use crate::error::{Error, Result};
use crate::figure::history::{Curve, draw};
use crate::figure::sweep as figure;
use crate::record::read::history;
use crate::record::sweep::{Key, Quantity, Status, Sweep, Values, is_sweep};
use std::path::{Path, PathBuf};

/// Draws the acceleration histories of the results `files` to `out`, one curve a file; or a single sweep.
///
/// # Errors
/// As of [`history`] and [`draw`]; [`Error::Usage`] for a sweep among other files, or one that no figure shows.
pub fn plot(files: &[PathBuf], out: &Path) -> Result<()> {
    for file in files {
        match is_sweep(file)? {
            true if files.len() == 1 => return plot_sweep(file, out),
            true => return Err(Error::Usage(format!("{}: a sweep has a figure of its own", file.display()))),
            false => {}
        }
    }
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

fn plot_sweep(file: &Path, out: &Path) -> Result<()> {
    let sweep = Sweep::read(file)?;
    let refuse = |why: String| Err(Error::Usage(format!("{}: {why}", file.display())));
    let Sweep { header, status, .. } = &sweep;
    let is_done = |member: &usize| status[*member] == Status::Done;
    if !(0..status.len()).any(|member| is_done(&member)) {
        return refuse("no member of the sweep is done".into());
    }
    let (title, peaks) = (header.title.clone(), sweep.quantity(Quantity::PeakAcceleration));
    let axis = |key: &Key| figure::Key {
        label: key.path.clone(),
        unit: key.units.replace('2', "\u{b2}").replace('3', "\u{b3}").trim_matches('1').to_owned(),
        is_log: key.is_log,
    };
    let numbers = |key: &Key| match &key.values {
        Values::Numbers(numbers) => Some(numbers.clone()),
        Values::Words(_) => None,
    };
    let values: Option<Vec<Vec<f64>>> = header.keys.iter().map(numbers).collect();
    match (header.keys.as_slice(), values.as_deref()) {
        ([key], Some([values])) => {
            let contacts = |index: usize| {
                let from = sweep.contacts.partition_point(|(member, _)| *member < index);
                let own = sweep.contacts[from..].iter().take_while(move |(member, _)| *member == index);
                own.map(|(_, contact)| (contact.start, contact.end, contact.peak_force)).collect()
            };
            let member = |n: usize| figure::Member { value: values[n], peak: peaks[n], contacts: contacts(n) };
            let members = (0..status.len()).filter(is_done).map(member).collect();
            figure::draw_curve(&figure::Curve { title, key: axis(key), members }, out)
        }
        ([slow, fast], Some([down, along])) => {
            let members = (0..status.len()).map(|n| ([along[n], down[n]], peaks[n])).collect();
            figure::draw_field(&figure::Field { title, keys: [axis(fast), axis(slow)], members }, out)
        }
        (keys, _) => {
            let paths: Vec<&str> = keys.iter().map(|key| key.path.as_str()).collect();
            refuse(format!("a figure shows a sweep over the numbers of one or two keys, not over {}", paths.join(", ")))
        }
    }
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
