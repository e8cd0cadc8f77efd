//! A hundred kills at any moment: the result is readable each time, and the run that goes on from it ends as one that nobody killed.

#[path = "common/program.rs"]
mod program;
#[path = "common/results.rs"]
mod results;

use std::time::Instant;

use program::{BOX, LIMIT, ricochet, start};
use results::{column, folder, good, is_complete, words};

/// Kills in all.
const KILLS: usize = 100;

/// As [`BOX`] with the condensed step: half a second with its checkpoints, which come often.
fn scene() -> String {
    BOX.replace("newton = \"full\"", "newton = \"condensed\"").replace("end = 1e-3", "end = 0.06")
        + "\n[output]\ncheckpoint_steps = 60\n"
}

/// Numbers that look random, the same in every run of the test.
struct Random(u64);

impl Random {
    /// Below `end`.
    fn next(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end
    }
}

#[test]
fn a_hundred_kills_cost_nothing() {
    let whole = folder(&scene());
    let begin = Instant::now();
    good(&whole, 0, "run scene.toml -o out.h5");
    // On a busy machine everything takes longer, and kills come later.
    let time = begin.elapsed();
    let names = ["time", "impactor/velocity", "contact/force", "energy/total"];
    let wanted = names.map(|name| column(&whole.path().join("out.h5"), name));
    let mut random = Random(4711);
    let (mut kills, mut runs, mut gone_on, mut unread) = (0, 0, 0, 0);
    while kills < KILLS {
        let folder = folder(&scene());
        let out = folder.path().join("out.h5");
        runs += 1;
        loop {
            let line = if out.exists() { "run scene.toml --restart out.h5" } else { "run scene.toml -o out.h5" };
            let mut started = start(ricochet(folder.path(), 0).args(words(line)));
            // From before the first row to beyond the end.
            std::thread::sleep(time.mul_f64(1.2e-6 * random.next(1_000_000) as f64));
            let _ = started.child.kill();
            let outcome = started.wait(LIMIT);
            gone_on += usize::from(outcome.stderr.contains("on from t = "));
            if outcome.status == Some(0) {
                break;
            }
            assert_eq!(outcome.signal, Some(9), "{outcome:#?}");
            kills += 1;
            if !out.exists() {
                unread += 1;
                continue;
            }
            // Readable, and the beginning of the whole run, bit for bit.
            let time = column(&out, "time");
            assert!(!time.is_empty() && !is_complete(&out) || time.len() == wanted[0].len());
            for (name, wanted) in names.iter().zip(&wanted) {
                let part = column(&out, name);
                assert!(part.len() >= time.len() && part[..time.len()] == wanted[..time.len()], "{name} after {line}");
            }
        }
        for (name, wanted) in names.iter().zip(&wanted) {
            assert!(column(&out, name) == *wanted, "{name}");
        }
        assert!(is_complete(&out));
        let left: Vec<String> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| name != "out.h5" && name != "scene.toml")
            .collect();
        assert!(left.is_empty(), "{left:?}");
    }
    println!("{kills} kills in {runs} runs, {gone_on} of runs that had gone on, {unread} before the first row");
    assert!(gone_on > KILLS / 10 && unread < KILLS / 2, "the moments are not spread: {gone_on}, {unread}");
}
