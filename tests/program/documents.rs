//! Tests that the commands and outputs in README and docs match the program.

use std::fs;
use std::path::Path;
use std::process::Command;

use mpi_test::{PlainTest, tests};
use regex_lite::Regex;

use crate::program::run;

pub const TESTS: &[PlainTest] =
    tests![consoles_say_what_the_program_says, the_scene_of_the_readme_is_the_one_that_ships];

/// Relative tolerance for numbers. Digits of error estimates may differ between versions of PETSc and processors; peaks
/// and times have five digits.
const TOLERANCE: f64 = 0.02;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// README and all pages of docs.
fn pages() -> Vec<(String, String)> {
    let docs = fs::read_dir(root().join("docs")).unwrap().map(|entry| entry.unwrap().path());
    let pages =
        docs.filter(|path| path.extension().is_some_and(|ending| ending == "md")).chain([root().join("README.md")]);
    pages.map(|path| (path.display().to_string(), fs::read_to_string(&path).unwrap())).collect()
}

/// The text in ``` blocks of a kind.
fn blocks<'a>(page: &'a str, kind: &str) -> Vec<&'a str> {
    let start = format!("```{kind}\n");
    page.split(start.as_str()).skip(1).map(|rest| rest.split("```").next().unwrap()).collect()
}

/// Words of a line; each number is a separate word.
fn words(line: &str) -> Vec<String> {
    let number = Regex::new(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?").unwrap();
    let mut words = Vec::new();
    let mut end = 0;
    for found in number.find_iter(line) {
        words.extend(line[end..found.start()].split_whitespace().map(str::to_owned));
        words.push(found.as_str().to_owned());
        end = found.end();
    }
    words.extend(line[end..].split_whitespace().map(str::to_owned));
    words
}

fn is_alike(expected: &str, said: &str) -> bool {
    let (expected, said) = (words(expected), words(said));
    expected.len() == said.len()
        && expected.iter().zip(&said).all(|(expected, said)| match (expected.parse::<f64>(), said.parse::<f64>()) {
            (Ok(expected), Ok(said)) => (expected - said).abs() <= TOLERANCE * expected.abs(),
            _ => expected == said,
        })
}

/// Checks blocks of `$ ricochet …` followed by the program's standard output, line by line; … stands for any number of
/// lines.
fn consoles_say_what_the_program_says() {
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink(root().join("scenes"), folder.path().join("scenes")).unwrap();
    let mut commands = 0;
    for (path, page) in pages() {
        for console in blocks(&page, "console") {
            for one in console.split("$ ricochet ").skip(1) {
                let mut lines = one.lines();
                let line = lines.next().unwrap();
                let outcome = run(Command::new(env!("CARGO_BIN_EXE_ricochet"))
                    .args(line.split_whitespace())
                    .current_dir(folder.path()));
                assert_eq!(outcome.status, Some(0), "{path}: {line}: {outcome:#?}");
                let mut said = outcome.stdout.lines();
                let mut is_open = false;
                for expected in lines {
                    if expected == "…" {
                        is_open = true;
                        continue;
                    }
                    let found = if is_open { said.find(|said| is_alike(expected, said)) } else { said.next() };
                    let found = found.unwrap_or_default();
                    assert!(
                        is_alike(expected, found),
                        "{path}: {line}\nexpected {expected}\nsaid     {found}\n{}",
                        outcome.stdout
                    );
                    is_open = false;
                }
                commands += 1;
            }
        }
    }
    assert!(commands >= 3, "{commands} commands");
}

fn the_scene_of_the_readme_is_the_one_that_ships() {
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let shipped = fs::read_to_string(root().join("scenes/pane.toml")).unwrap();
    let scene = blocks(&readme, "toml")[0];
    assert!(shipped.contains(scene), "{scene}");
}
