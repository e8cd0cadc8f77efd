//! Tests of kills at any moment: the result is always readable, and the continued run ends like one that was not
//! killed.

use crate::results;
use mpi_test::{PlainTest, tests};
use std::path::Path;
use std::process::Child;
use std::time::{Duration, Instant};

use crate::program::{BOX, LIMIT, children, ricochet, send, start};
use crate::results::{column, folder, good, is_complete, words};

pub const TESTS: &[PlainTest] = tests![kills_cost_nothing, kills_of_a_rank_cost_nothing];
pub const LONG: &[PlainTest] = tests![a_hundred_kills_cost_nothing, more_kills_of_a_rank_cost_nothing];

/// Same as [`BOX`] with the condensed Newton's method, up to a time `end` (s): a run of some tenths of a second with
/// frequent checkpoints.
fn scene(end: &str) -> String {
    BOX.replace("newton = \"full\"", "newton = \"condensed\"").replace("end = 1e-3", &format!("end = {end}"))
        + "\n[output]\ncheckpoint_steps = 60\nfields = 70\nprobes = [{ name = \"under\", point = [0.05, 0, -0.01] }]\n"
}

/// Pseudo-random numbers, the same in every run of the test.
struct Random(u64);

impl Random {
    /// The next number, in 0..`end`.
    fn next(&mut self, end: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end
    }
}

const SERIES: [&str; 5] =
    ["impactor/velocity", "contact/force", "energy/total", "probe/under/velocity", "probe/under/principal_stress"];

const FIELDS: [&str; 2] = ["PointData/displacement", "PointData/principal_stress"];

/// The compared content of a result: its times, its series, and the times and fields of its frames.
struct Content {
    time: Vec<f64>,
    series: Vec<Vec<f64>>,
    frames: Vec<f64>,
    fields: Vec<Vec<f64>>,
}

impl Content {
    fn read(path: &Path) -> Self {
        let file = results::open(path);
        let of_fields = |name: &str| file.dataset(&format!("fields/{name}")).unwrap().read_raw().unwrap();
        Self {
            time: column(path, "time"),
            series: SERIES.map(|name| column(path, name)).into(),
            frames: of_fields("Steps/Values"),
            fields: FIELDS.map(of_fields).into(),
        }
    }

    /// Checks that this is the beginning of the whole run, to a fraction of the largest value of each series.
    fn check_begins(&self, whole: &Self, tolerance: f64) {
        let check = |part: &[f64], whole: &[f64], name: &str| {
            let scale = whole.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            assert!(part.len() <= whole.len(), "{name}: {} values", part.len());
            // False for NaN.
            let alike = part.iter().zip(whole).all(|(a, b)| (a - b).abs() <= tolerance * scale);
            assert!(alike, "{name}");
        };
        check(&self.time, &whole.time, "time");
        check(&self.frames, &whole.frames, "frames");
        for (n, name) in SERIES.into_iter().enumerate() {
            let columns = if name.starts_with("probe") { 3 } else { 1 };
            let rows = columns * self.time.len();
            assert!(self.series[n].len() >= rows, "{name}: {} values", self.series[n].len());
            check(&self.series[n][..rows], &whole.series[n], name);
        }
        for (n, name) in FIELDS.into_iter().enumerate() {
            let each = whole.fields[n].len() / whole.frames.len();
            assert!(self.fields[n].len() >= each * self.frames.len(), "{name}: {} values", self.fields[n].len());
            check(&self.fields[n][..each * self.frames.len()], &whole.fields[n], name);
        }
    }
}

/// Settings of a test: number of kills, and the runs that are killed.
struct Plan {
    /// Number of ranks under mpirun, where one rank is killed and its end stops the others; 0 is the program alone.
    ranks: usize,
    kills: usize,
    /// End time of the scene, s.
    end: &'static str,
    /// Allowed difference from the run that was not killed, over its largest value.
    tolerance: f64,
}

/// Waits for the moment of the next kill. Every second kill comes soon after a new checkpoint. The others come at any
/// time from before the first row to after the end of a run that takes `time`.
fn wait_for_moment(number: usize, random: &mut Random, (checkpoint, time): (&Path, Duration), child: &mut Child) {
    if number.is_multiple_of(2) {
        return std::thread::sleep(time.mul_f64(1.2e-6 * random.next(1_000_000) as f64));
    }
    let written = || checkpoint.metadata().and_then(|data| data.modified()).ok();
    let before = written();
    while written() == before && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    std::thread::sleep(Duration::from_micros(random.next(20_000)));
}

fn kill(plan: &Plan) {
    let Plan { ranks, kills: many, end, tolerance } = *plan;
    let whole = folder(&scene(end));
    let begin = Instant::now();
    good(&whole, ranks, "run scene.toml -o out.h5");
    // Kill times scale with the measured duration of a run, which is longer on a busy machine.
    let time = begin.elapsed();
    let whole = Content::read(&whole.path().join("out.h5"));
    let mut random = Random(4711);
    let (mut kills, mut runs, mut gone_on, mut unread) = (0, 0, 0, 0);
    // Also continue until at least one run has resumed: a few kills at random moments may all come before a checkpoint
    // or after the end.
    while kills < many || gone_on == 0 && kills < 10 * many {
        let folder = folder(&scene(end));
        let [out, checkpoint] = ["out.h5", "out.checkpoint.h5"].map(|name| folder.path().join(name));
        runs += 1;
        loop {
            let line = if out.exists() { "run scene.toml --restart out.h5" } else { "run scene.toml -o out.h5" };
            // (If a run was killed after its last row, its checkpoint may still be there.)
            let had_checkpoint = checkpoint.exists() && !(out.exists() && is_complete(&out));
            let mut started = start(ricochet(folder.path(), ranks).args(words(line)));
            wait_for_moment(kills, &mut random, (&checkpoint, time), &mut started.child);
            match ranks {
                0 => drop(started.child.kill()),
                ranks => {
                    let processes = children(started.child.id());
                    let rank = random.next(ranks as u64) as usize;
                    processes.get(rank).into_iter().for_each(|process| send("KILL", process));
                }
            }
            let outcome = started.wait(LIMIT);
            if outcome.status == Some(0) {
                // A checkpoint is never lost: if there was one, the run that reaches its end has continued from it.
                assert_eq!(outcome.stderr.contains("continuing from t = "), had_checkpoint, "{outcome:#?}");
                gone_on += usize::from(had_checkpoint);
                break;
            }
            assert!(ranks > 0 || outcome.signal == Some(9), "{outcome:#?}");
            assert!(!outcome.stderr.contains("error: "), "{outcome:#?}");
            kills += 1;
            if !out.exists() {
                unread += 1;
                continue;
            }
            let part = Content::read(&out);
            assert!(!part.time.is_empty() && !is_complete(&out) || part.time.len() == whole.time.len());
            part.check_begins(&whole, tolerance);
        }
        let part = Content::read(&out);
        assert!(is_complete(&out));
        assert_eq!((part.time.len(), part.frames.len()), (whole.time.len(), whole.frames.len()));
        part.check_begins(&whole, tolerance);
        let mut left: Vec<String> = std::fs::read_dir(folder.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        left.sort();
        assert_eq!(left, ["out.h5", "out.vtkhdf", "out.xdmf", "scene.toml"]);
    }
    println!("{kills} kills in {runs} runs, {gone_on} of runs that had gone on, {unread} before the first row");
    assert!(gone_on > 0 && unread < kills, "every second kill waits for a checkpoint: {gone_on}, {unread}");
}

/// Without mpirun, the continued run is equal bit for bit.
fn kills_cost_nothing() {
    kill(&Plan { ranks: 0, kills: 16, end: "0.02", tolerance: 0.0 });
}

fn a_hundred_kills_cost_nothing() {
    kill(&Plan { ranks: 0, kills: 100, end: "0.06", tolerance: 0.0 });
}

/// Kills of one of two ranks. The order of the sums over ranks is not guaranteed, so the tolerance covers the rounding
/// of some hundred time steps.
const OF_A_RANK: Plan = Plan { ranks: 2, kills: 4, end: "0.008", tolerance: 1e-9 };

fn kills_of_a_rank_cost_nothing() {
    kill(&OF_A_RANK);
}

fn more_kills_of_a_rank_cost_nothing() {
    kill(&Plan { kills: 20, end: "0.016", ..OF_A_RANK });
}
