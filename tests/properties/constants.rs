//! The table of fitted constants is true.

use std::fs;
use std::path::Path;

/// Each constant of docs/constants.md has its value in its file, and each test or script named there exists.
#[test]
fn the_table_of_fitted_constants_is_true() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(root.join("docs/constants.md")).unwrap();
    let rows: Vec<Vec<&str>> = page
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| line.split('|').map(str::trim).filter(|cell| !cell.is_empty()).collect())
        .collect();
    for row in &rows {
        let [name, file, value, _, tests] = row[..] else { panic!("{row:?}") };
        let [name, file, value] = [name, file, value].map(|cell| cell.trim_matches('`'));
        let text = fs::read_to_string(root.join("src").join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
        let start = format!("const {name}: ");
        let is_here = |line: &str| line.contains(&start) && line.ends_with(&format!("= {value};"));
        assert!(text.lines().any(is_here), "{file}: {name} = {value}");
        for test in tests.split(", ").filter(|test| *test != "*cost*").map(|test| test.trim_matches('`')) {
            let places = [test.to_owned(), format!("tests/{test}"), format!("src/{test}")];
            assert!(places.iter().any(|place| root.join(place).exists()), "{name}: {test}");
        }
    }
    // The list may only become shorter.
    assert!((1..=45).contains(&rows.len()), "{} constants", rows.len());
}
