//! Tests that every fault in a scene is refused with a message that names the key and the line and states what would be
//! right.

use crate::bad_scenes::{BadScene, GOOD, MESH, QUARTER, SMALL, layers, table};
use ricochet::scene::{Scene, SceneError};
use ricochet::{Error, Result};

fn refusal(bad: &BadScene) -> SceneError {
    match Scene::parse("bad.toml", &bad.text, &bad.overrides) {
        Err(error) => error,
        Ok(_) => panic!("{}: this scene was accepted", bad.name),
    }
}

fn report(error: SceneError) -> String {
    Error::from(error).report(false)
}

#[test]
fn the_scenes_that_the_table_edits_are_good() -> Result<()> {
    for text in [GOOD, MESH, SMALL, QUARTER, layers::LAMINATE] {
        Scene::parse("good.toml", text, &[])?;
    }
    Ok(())
}

#[test]
fn every_bad_scene_is_refused_by_key_and_line() {
    let table = table();
    assert!(table.len() >= 45);
    let mut wrong = Vec::new();
    for bad in &table {
        let error = refusal(bad);
        let text = error.to_string();
        let place = format!(":{}: {}: ", bad.line, bad.key);
        let named = error.key() == bad.key && error.line() == bad.line && text.contains(&place);
        let report = report(error);
        let missing = bad.fragments.iter().find(|part| !report.contains(*part));
        if !named || missing.is_some() {
            let BadScene { name, key, line, .. } = bad;
            wrong.push(format!("{name}: expected {key} in line {line} and {missing:?}\n{report}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_refusal_says_what_would_be_right() {
    for bad in table() {
        let error = refusal(&bad);
        assert!(!error.advice().is_empty() && !error.message().is_empty(), "{}", bad.name);
    }
}

#[test]
fn names_of_the_table_are_unique() {
    let mut names: Vec<_> = table().iter().map(|bad| bad.name).collect();
    names.sort_unstable();
    assert!(names.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn a_report_without_colours_is_plain_text() {
    for bad in table() {
        let text = report(refusal(&bad));
        assert!(!text.contains('\u{1b}'), "{}: {text:?}", bad.name);
    }
}

#[test]
fn the_look_of_reports() {
    for name in [
        "surface misspelled",
        "key missing",
        "off the surface",
        "override of an unknown key",
        "override past the end",
        "not a number",
    ] {
        let all = table();
        let Some(bad) = all.iter().find(|bad| bad.name == name) else {
            panic!("no bad scene has the name {name}");
        };
        insta::assert_snapshot!(name.replace(' ', "_"), report(refusal(bad)));
    }
}

#[test]
fn a_scene_file_that_cannot_be_read_is_a_wrong_command_line() -> std::io::Result<()> {
    let folder = tempfile::tempdir()?;
    let missing = folder.path().join("missing.toml");
    let binary = folder.path().join("binary.toml");
    std::fs::write(&binary, b"title = \"a\"\n\xff\xfe")?;
    for (path, part) in [(&missing, "missing.toml"), (&binary, "line 2")] {
        match Scene::read(path, &[]) {
            Err(error) => {
                assert_eq!(error.status(), 2);
                assert!(error.report(false).contains(part), "{error}");
            }
            Ok(_) => panic!("{} was read", path.display()),
        }
    }
    Ok(())
}
