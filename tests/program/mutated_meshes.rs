//! Tests with randomly damaged mesh files: `ricochet check` always ends, soon, and with one of its own exit statuses.

use mpi_test::{PlainTest, tests};
use std::fs;
use std::time::Duration;

use crate::bad_meshes::{TWO, binary_two, sample};
use crate::program::{ricochet, start};
use proptest::prelude::*;
use proptest::test_runner::TestCaseError;

pub const TESTS: &[PlainTest] =
    tests![tetrahedra_old_format, tetrahedra_new_format, hexahedra, binary, undamaged_files_are_read];

/// Number of runs for each mesh. A run takes half a second, mostly for the start of MPI.
const CASES: u32 = 16;

const SCENE: &str = r#"[body]
young = 70e9
poisson = 0.23
density = 2500
mesh = "mesh.msh"
order = 2
[[support]]
surface = "top"
kind = "clamped"
[impactor]
mass = 52
radius = 0.05
young = 210e9
poisson = 0.3
speed = 1
point = [0.1, 0.1, 0.5]
[time]
end = 1e-4
step = 2e-5
[contact]
localization = "point"
[solver]
newton = "full"
"#;

/// A kind of damage. Its place is given as a fraction of the whole file.
#[derive(Debug, Clone)]
enum Damage {
    CutOff(f64),
    Byte(f64, u8),
    Word(f64, &'static str),
    LineTwice(f64),
    NoLine(f64),
    LinesSwapped(f64, f64),
}

fn damage() -> impl Strategy<Value = Damage> {
    use Damage::*;
    let part = 0.0..1.0f64;
    let words = ["0", "-1", "1", "2", "4", "7", "99", "1000000", "99999999999", "-2147483648", "nan", "1e308", "x", ""];
    // Half of the replacements are other digits or numbers, which keep the grammar valid and make references wrong.
    prop_oneof![
        part.clone().prop_map(CutOff),
        (part.clone(), any::<u8>()).prop_map(|(at, byte)| Byte(at, byte)),
        (part.clone(), b'0'..=b'9').prop_map(|(at, byte)| Byte(at, byte)),
        (part.clone(), prop::sample::select(words.to_vec())).prop_map(|(at, word)| Word(at, word)),
        part.clone().prop_map(LineTwice),
        part.clone().prop_map(NoLine),
        (part.clone(), part).prop_map(|(a, b)| LinesSwapped(a, b)),
    ]
}

fn damaged(good: &[u8], damage: &Damage) -> Vec<u8> {
    let place = |part: f64, size: usize| (part * size as f64) as usize;
    let mut lines: Vec<Vec<u8>> = good.split(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
    let count = lines.len();
    match *damage {
        Damage::CutOff(at) => return good[..place(at, good.len())].to_vec(),
        Damage::Byte(at, byte) => {
            let mut bytes = good.to_vec();
            bytes[place(at, good.len())] = byte;
            return bytes;
        }
        Damage::Word(at, word) => {
            let line = &mut lines[place(at, count)];
            let mut words: Vec<&[u8]> = line.split(|byte| *byte == b' ').collect();
            // The fractional part of the line position selects the word in the line.
            let n = place((at * count as f64).fract(), words.len());
            words[n] = word.as_bytes();
            *line = words.join(&b' ');
        }
        Damage::LineTwice(at) => {
            let line = lines[place(at, count)].clone();
            lines.insert(place(at, count), line);
        }
        Damage::NoLine(at) => {
            lines.remove(place(at, count));
        }
        Damage::LinesSwapped(a, b) => lines.swap(place(a, count), place(b, count)),
    }
    lines.join(&b'\n')
}

fn check(good: &[u8]) {
    let config = ProptestConfig { cases: CASES, max_shrink_iters: 20, failure_persistence: None, ..Default::default() };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    proptest!(config, |(damage in damage())| {
        fs::write(folder.path().join("mesh.msh"), damaged(good, &damage)).unwrap();
        // Exceeding the time limit is a panic, and so a failure.
        let outcome = start(ricochet(folder.path(), 0).args(["check", "scene.toml"])).wait(Duration::from_secs(5));
        let known = matches!(outcome.status, Some(0 | 2 | 3 | 4));
        let messages = outcome.stderr.lines().filter(|line| line.starts_with("error: ") || line.starts_with("  × ")).count();
        let told = messages == usize::from(outcome.status != Some(0));
        if !known || !told || outcome.stderr.contains("panicked") || outcome.stderr.contains("PETSC ERROR") {
            return Err(TestCaseError::fail(format!("{outcome:#?}")));
        }
    });
}

fn tetrahedra_old_format() {
    check(sample("block-tet22.msh").as_bytes());
}

fn tetrahedra_new_format() {
    check(sample("block-tet41.msh").as_bytes());
}

fn hexahedra() {
    check(sample("block-hex.msh").as_bytes());
}

fn binary() {
    check(&binary_two());
}

/// The undamaged files are good: text and binary give the same answer, except for the file's name.
fn undamaged_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let mut answers = Vec::new();
    for good in
        [TWO.as_bytes().to_vec(), binary_two(), sample("block-hex.msh").into(), sample("block-tet41.msh").into()]
    {
        fs::write(folder.path().join("mesh.msh"), good).unwrap();
        let depth = if answers.len() < 2 { 2.0 } else { 0.5 };
        fs::write(folder.path().join("scene.toml"), SCENE.replace("0.5]", &format!("{depth}]"))).unwrap();
        let outcome = start(ricochet(folder.path(), 0).args(["check", "scene.toml"])).wait(Duration::from_secs(20));
        assert_eq!(outcome.status, Some(0), "{outcome:#?}");
        answers.push(outcome.stdout);
    }
    assert_eq!(answers[0], answers[1]);
    assert!(answers[0].contains("solid: 2 cells of order 2, 135 unknowns"), "{}", answers[0]);
}
