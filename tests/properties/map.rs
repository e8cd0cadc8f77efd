//! The map of CONTRIBUTING.md is true: its folders are those of src/, and each uses only folders above it.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Folders and files that every module may use.
const BASE: [&str; 2] = ["agree", "error"];

/// Folders of the map, from above.
fn folders(root: &Path) -> Vec<String> {
    let text = fs::read_to_string(root.join("CONTRIBUTING.md")).unwrap();
    let map = text.split("## The map").nth(1).expect("a map").split("petsc-wrap/").next().unwrap();
    // Lines that begin with a name and a slash; those that go on are indented further.
    let name = |line: &str| {
        let (name, _) = line.strip_prefix("    ")?.split_once('/')?;
        name.chars().all(|letter| letter.is_ascii_lowercase()).then(|| name.to_owned())
    };
    map.lines().filter_map(name).collect()
}

/// Rust files of a folder, with their text without their own tests.
fn files(folder: &Path, found: &mut Vec<(String, String)>) {
    for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_dir() {
            files(&entry, found);
        } else if entry.extension().is_some_and(|ending| ending == "rs") && entry.file_name().unwrap() != "tests.rs" {
            let text = fs::read_to_string(&entry).unwrap();
            let own = text.split("#[cfg(test)]\nmod tests").next().unwrap();
            let code: Vec<&str> = own.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
            found.push((entry.display().to_string(), code.join("\n")));
        }
    }
}

#[test]
fn each_folder_uses_only_those_above_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let map = folders(root);
    let there: BTreeSet<String> = fs::read_dir(root.join("src"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_dir())
        .map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
        .collect();
    assert_eq!(map.iter().cloned().collect::<BTreeSet<_>>(), there);
    let mut wrong = Vec::new();
    for (place, folder) in map.iter().enumerate() {
        let mut all = Vec::new();
        files(&root.join("src").join(folder), &mut all);
        for (file, code) in all {
            for used in code.split("crate::").skip(1) {
                let name: String =
                    used.chars().take_while(|letter| letter.is_alphanumeric() || *letter == '_').collect();
                let is_above = map[..=place].contains(&name) || BASE.contains(&&*name);
                if !is_above && map.contains(&name) {
                    wrong.push(format!("{file} uses {name}/, which is below {folder}/"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}
