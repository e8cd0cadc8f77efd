//! Tests of `ricochet chart`: methods are timed and their errors measured, results of other programs are compared, and
//! no run is done twice.

use mpi_test::{PlainTest, tests};
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use assert_cmd::Command;

pub const TESTS: &[PlainTest] =
    tests![errors_fall_and_peers_are_measured, a_killed_chart_goes_on, what_is_wrong_is_told, a_reference_may_be_given];
pub const LONG: &[PlainTest] = tests![errors_fall_with_the_tolerance];

/// A small free plate with one short contact.
const SCENE: &str = "title = \"Ball on a plate\"\n[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.2, 0.2, 0.01]\n\
    [impactor]\nmass = 0.05\nradius = 0.02\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n[time]\nend = 1.5e-4\n";

fn ricochet(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("ricochet").expect("the program");
    command.current_dir(folder).env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    command
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("ball.toml"), SCENE).unwrap();
    folder
}

/// Lines of a chart's table, with these columns: method, setting, first error, and everything except the times.
fn table(path: &Path) -> Vec<Line> {
    let mut table = csv::Reader::from_path(path.join("work-precision.csv")).unwrap();
    let head = table.headers().unwrap().clone();
    let line = |line: Result<csv::StringRecord, csv::Error>| {
        let line = line.unwrap();
        // Times, and the column that depends on them.
        let varies = |name: &str| ["build_s", "run_s", "total_s", "is_front"].contains(&name);
        let rest: Vec<&str> = head.iter().zip(&line).filter(|(name, _)| !varies(name)).map(|x| x.1).collect();
        (line[0].to_owned(), line[1].to_owned(), line[7].parse().unwrap(), rest.join(","))
    };
    table.records().map(line).collect()
}

/// A line of the table: method, setting, first error, and everything except the times.
type Line = (String, String, f64, String);

/// Errors fall, and a peer is measured. Kirchhoff's plate has an error of some per cent, so two references that agree
/// to a tenth of it are found quickly.
fn errors_fall_and_peers_are_measured() {
    let lines = charted("kirchhoff");
    let kirchhoff = errors(&lines, "kirchhoff");
    assert!(kirchhoff.len() >= 3 && kirchhoff.iter().all(|error| *error < 0.5), "{lines:?}");
}

/// Errors fall with the tolerance. Smaller tolerances, at which the solid takes minutes, are left out.
fn errors_fall_with_the_tolerance() {
    let lines = charted("mindlin,auto,newmark");
    let met = errors(&lines, "auto").into_iter().zip([1e-1, 1e-2, 1e-3, 1e-4]).all(|(error, most)| error <= most);
    assert!(met && !errors(&lines, "auto").is_empty(), "{lines:?}");
    let mindlin = errors(&lines, "mindlin");
    assert!(mindlin.len() >= 3 && mindlin[mindlin.len() - 1] < 0.1 * mindlin[0], "{mindlin:?}");
    // Newmark's method is of order two: from 20 to 60 and 200 time steps in a contact, at or above the theory's own
    // error.
    let stepped = errors(&lines, "mindlin/newmark");
    assert!(stepped[1] < 0.3 * stepped[0], "{stepped:?}");
}

fn errors(lines: &[Line], method: &str) -> Vec<f64> {
    lines.iter().filter(|line| line.0 == method).map(|line| line.2).collect()
}

/// Makes the chart of these methods and a peer, which is measured against the same reference; returns its table. The
/// chart's files must be readable.
fn charted(only: &str) -> Vec<Line> {
    let folder = folder();
    let path = folder.path();
    // The peer is a run of this program, multiplied so that its error is a twentieth of the peak.
    ricochet(path).args(["run", "ball.toml", "-o", "own.h5", "--set", "accuracy.tolerance=1e-3"]).assert().success();
    let history = ricochet::record::read::history(&path.join("own.h5")).unwrap();
    let rows: String =
        history.time.iter().zip(&history.parts[0].values).map(|(t, a)| format!("{t:e},{:e}\n", 1.05 * a)).collect();
    fs::write(path.join("peer.csv"), format!("time,acceleration\n{rows}")).unwrap();
    fs::write(path.join("peers.csv"), "name,setting,build,run,series\nPeer,\"5% more, slowly\",10,20,peer.csv\n")
        .unwrap();
    let chart = ["chart", "ball.toml", "-o", "chart", "--only", only, "--budget", "100", "--with", "peers.csv"];
    ricochet(path).args(chart).assert().success();
    let chart = path.join("chart");
    let lines = table(&chart);
    // The peer's error comes from the factor. The time-step errors of the run and of the reference are less than 1e-3.
    assert!((errors(&lines, "Peer")[0] - 0.05).abs() < 2e-3, "{lines:?}");
    let summary = fs::read_to_string(chart.join("summary.md")).unwrap();
    assert!(
        summary.contains("# Speed against accuracy: Ball on a plate") && summary.contains("Peer: 30.0 s"),
        "{summary}"
    );
    for name in ["work-precision.svg", "work-precision.png"] {
        assert!(fs::metadata(chart.join(name)).unwrap().len() > 10_000);
    }
    lines
}

/// A chart that is killed halfway and started again gives the same table, and no run is done twice.
fn a_killed_chart_goes_on() {
    let folder = folder();
    let path = folder.path();
    // The errors of this run do not matter here.
    ricochet(path).args(["run", "ball.toml", "-o", "own.h5", "--set", "body.model=mindlin"]).assert().success();
    let only = "kirchhoff,mindlin/newmark";
    let arguments = |output| ["chart", "ball.toml", "-o", output, "--only", only, "--reference", "own.h5"];
    ricochet(path).args(arguments("whole")).assert().success();

    let program = assert_cmd::cargo::cargo_bin("ricochet");
    let mut child = std::process::Command::new(program)
        .args(arguments("killed"))
        .current_dir(path)
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .stderr(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let runs = path.join("killed/runs");
    let kept = || -> Vec<std::path::PathBuf> {
        let builds = fs::read_dir(&runs).into_iter().flatten().flatten();
        let all = builds.flat_map(|build| fs::read_dir(build.path()).unwrap().flatten()).map(|entry| entry.path());
        all.filter(|path| !path.file_name().unwrap().to_string_lossy().starts_with('.')).collect()
    };
    let begin = Instant::now();
    while kept().len() < 3 {
        assert!(begin.elapsed() < Duration::from_secs(60) && child.try_wait().unwrap().is_none(), "{:?}", kept());
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    // The last file may be incomplete.
    let before: Vec<_> =
        kept().into_iter().map(|path| (fs::metadata(&path).unwrap().modified().unwrap(), path)).collect();
    assert!(!path.join("killed/work-precision.csv").exists());
    ricochet(path).args(arguments("killed")).assert().success();
    let again = before.iter().filter(|(when, path)| fs::metadata(path).unwrap().modified().unwrap() != *when).count();
    assert!(again <= 1, "{again} of {} runs were done twice", before.len());
    // Everything is compared except the times, which have separate columns, and the front, which depends on them.
    let [whole, killed] = ["whole", "killed"].map(|name| table(&path.join(name)));
    assert_eq!(whole.len(), killed.len());
    for (whole, killed) in whole.iter().zip(&killed) {
        // A factorisation by several threads may round in another way: 1e-12 of a peak, whose errors are down to 1e-5.
        let is_same = |(one, other): (&str, &str)| match (one.parse::<f64>(), other.parse::<f64>()) {
            (Ok(one), Ok(other)) if one.is_finite() => (one - other).abs() <= 1e-6 * one.abs(),
            _ => one == other,
        };
        assert!(whole.3.split(',').count() == killed.3.split(',').count());
        assert!(whole.3.split(',').zip(killed.3.split(',')).all(is_same), "{whole:?} {killed:?}");
    }
}

fn what_is_wrong_is_told() {
    let folder = folder();
    let path = folder.path();
    fs::write(path.join("bad.csv"), "name,seconds,error\nA,fast,1\n").unwrap();
    fs::write(path.join("short.csv"), "time,acceleration\n0,1\n").unwrap();
    let other = ["run", "ball.toml", "-o", "other.h5", "--set", "impactor.speed=2", "--set", "body.model=half-space"];
    ricochet(path).args(other).assert().success();
    // Files in the folder that are not from this program stay.
    fs::create_dir(path.join("full")).unwrap();
    fs::write(path.join("full/summary.md"), "my notes").unwrap();
    for (arguments, status, part) in [
        (vec!["--only", "minlin"], 2, "--only minlin: no method of this scene; there are auto, half-space"),
        (vec!["--budget", "-1"], 2, "--budget -1: expected a number of seconds above 0"),
        (vec!["--budget", "0"], 2, "--budget 0: expected a number of seconds above 0"),
        (vec!["--with", "bad.csv"], 4, "bad.csv"),
        (vec!["--with", "none.csv"], 4, "none.csv"),
        (vec!["--reference", "none.h5"], 4, "none.h5"),
        (vec!["--reference", "short.csv"], 4, "short.csv: has 1 rows, and a history at least two"),
        (vec!["--reference", "other.h5"], 4, "other.h5: is of another impact: other values of impactor.speed"),
        (vec!["--set", "body.young=-1"], 2, "body.young"),
        (vec!["-o", "full"], 4, "full: has a file summary.md that is not of this program"),
    ] {
        let output = if arguments[0] == "-o" { vec![] } else { vec!["-o", "chart"] };
        let all = ["chart", "ball.toml"].into_iter().chain(output).chain(arguments.iter().copied());
        let assert = ricochet(path).args(all).assert().code(status);
        let text = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(text.contains(part), "{arguments:?}: {text}");
    }
}

/// A given reference is the only one used. Bodies without modes are integrated with time steps.
fn a_reference_may_be_given() {
    let folder = folder();
    let path = folder.path();
    let pad = "[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nstiffness = 1e9\nnormal = [0, 0, -1]\n";
    fs::write(
        path.join("pad.toml"),
        format!("{SCENE}{pad}").replace("[time]", "[contact]\nlocalization = \"point\"\n[time]"),
    )
    .unwrap();
    let cells = ["--set", "body.cells=[6,6,1]"];
    let fine = ["run", "pad.toml", "-o", "fine.h5", "--set", "time.step=2.5e-7", "--set", "time.scheme=energy"];
    ricochet(path).args(fine).args(cells).assert().success();
    let chart = ["chart", "pad.toml", "-o", "chart", "--only", "solid/energy", "--reference", "fine.h5"];
    ricochet(path).args(chart).args(cells).assert().success();
    // The same folder cannot be used for another scene.
    let other = ricochet(path).args(chart).args(["--set", "body.cells=[4,4,1]"]).assert().code(4);
    assert!(String::from_utf8_lossy(&other.get_output().stderr).contains("holds results of another scene"));
    let lines = table(&path.join("chart"));
    assert!(lines.len() >= 4 && lines.iter().all(|line| line.0 == "solid/energy"), "{lines:?}");
    // Order two, until the error of the reference's own time steps is reached.
    assert!(lines[2].2 < 0.3 * lines[0].2, "{lines:?}");
    assert!(fs::read_to_string(path.join("chart/summary.md")).unwrap().contains("Reference: fine.h5."));
    let build = fs::read_dir(path.join("chart/runs")).unwrap().next().unwrap().unwrap();
    assert_eq!(fs::read_dir(build.path()).unwrap().count(), lines.len());
}
