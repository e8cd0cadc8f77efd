//! `scripts/ricochet.py` reads what the program writes, and the example notebook runs as it stands.

use mpi_test::{PlainTest, tests};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::program::BOX;
use crate::results;
use crate::results::{column, folder, good};
use crate::sweeps::{numbers, supported};

pub const TESTS: &[PlainTest] = tests![
    runs_are_read_as_they_are_written,
    a_run_that_was_killed_is_read_up_to_its_last_whole_row,
    sweeps_and_their_parts_are_read,
    sweeps_are_drawn_as_curves_and_maps,
    files_of_the_other_kind_are_refused
];
pub const NOTEBOOK: &[PlainTest] = tests![the_notebook_runs];

const SERIES: [&str; 16] = [
    "contact/force",
    "contact/indentation",
    "contact/surface_displacement",
    "energy/contact",
    "energy/dissipated",
    "energy/elastic",
    "energy/external",
    "energy/impactor",
    "energy/kinetic",
    "energy/numerical",
    "energy/support",
    "energy/total",
    "impactor/acceleration",
    "impactor/position",
    "impactor/velocity",
    "time",
];

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// What Python answers to some lines, the module at hand and `bits` to tell numbers exactly; its last line on standard error where it fails.
fn python(folder: &Path, lines: &str) -> Result<Vec<String>, String> {
    let head = "import matplotlib\nmatplotlib.use('agg')\nimport matplotlib.pyplot as plt, numpy as np, ricochet\n\
        def bits(values): return np.asarray(values, '<f8').tobytes().hex()\n";
    // Debian's Python: the one that the packages are installed for.
    let output = Command::new("/usr/bin/python3")
        .args(["-c", &format!("{head}{lines}")])
        .current_dir(folder)
        .env("PYTHONPATH", repository().join("scripts"))
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).lines().map(str::to_owned).collect::<Vec<_>>();
    if output.status.success() {
        return Ok(text(&output.stdout));
    }
    Err(text(&output.stderr).pop().unwrap_or_default())
}

fn bits(values: &[f64]) -> String {
    values.iter().flat_map(|value| value.to_le_bytes()).map(|byte| format!("{byte:02x}")).collect()
}

fn runs_are_read_as_they_are_written() {
    let folder = folder(BOX);
    good(&folder, 0, "run scene.toml");
    let told = python(
        folder.path(),
        "run = ricochet.Run('scene.h5')\n\
         print(*sorted(run.series))\n\
         print(run.attributes['title'], run.attributes['complete'], run.units['impactor/acceleration'], run.units['impulse'])\n\
         for name in sorted(run.series): print(bits(run.series[name]))\n\
         for name in ricochet.CONTACT: print(bits(run.contacts[name]))\n\
         axes = run.plot('contact/force')\n\
         print(axes.get_xlabel(), '|', axes.get_ylabel(), '|', bits(axes.lines[0].get_ydata()), len(axes.patches))",
    );
    let told = told.unwrap();
    assert_eq!(told[0], SERIES.join(" "));
    assert_eq!(told[1], "Small plate True m/s2 N s");
    let path = folder.path().join("scene.h5");
    for (name, told) in SERIES.iter().zip(&told[2..]) {
        assert_eq!(*told, bits(&column(&path, name)), "{name}");
    }
    for (name, told) in ["start", "end", "peak_force", "peak_time", "impulse"].iter().zip(&told[18..]) {
        let contacts = numbers(&path, &format!("contacts/{name}"));
        assert!(!contacts.is_empty());
        assert_eq!(*told, bits(&contacts), "{name}");
    }
    let contacts = numbers(&path, "contacts/start").len();
    let drawn = format!("time (ms) | contact force (N) | {} {contacts}", bits(&column(&path, "contact/force")));
    assert_eq!(told[23], drawn);
}

/// As a kill within a flush leaves it: the time, which is written last, is shorter than the rest, and so is a column of the contacts.
fn a_run_that_was_killed_is_read_up_to_its_last_whole_row() {
    let folder = folder(BOX);
    good(&folder, 0, "run scene.toml");
    let path = folder.path().join("scene.h5");
    results::change(&path, |file| {
        file.dataset("series/time").unwrap().resize((30,)).unwrap();
        file.dataset("contacts/impulse").unwrap().resize((0,)).unwrap();
    });
    let told = python(
        folder.path(),
        "run = ricochet.Run('scene.h5')\n\
         print({len(values) for values in run.series.values()}, len(run.contacts))\n\
         print(bits(run.series['contact/force']))",
    );
    let force = column(&path, "contact/force");
    assert_eq!(force.len(), 51);
    assert_eq!(told.unwrap(), ["{30} 0".to_owned(), bits(&force[..30])]);
}

/// Of two keys, one of words, the second of three parts: members that are missing are NaN.
fn sweeps_and_their_parts_are_read() {
    let folder = folder(&supported());
    let vary = "--vary support.0.stiffness=1e7..1e11:3 --vary time.scheme=newmark,energy --log --series -o s.h5";
    let line = format!("sweep scene.toml --set time.end=4e-3 {vary}");
    good(&folder, 0, &line);
    good(&folder, 0, &format!("{line} --shard 2/3"));
    let told = python(
        folder.path(),
        "sweep, part = ricochet.Sweep('s.h5'), ricochet.Sweep('s.2-of-3.h5')\n\
         print(sweep.keys, sweep.logarithmic, *sweep.varied['time.scheme'], sweep.units['support.0.stiffness'])\n\
         print(bits(sweep.varied['support.0.stiffness']))\n\
         print(bits(sweep.members['peak_force']))\n\
         print(bits(sweep.contacts['member']), bits(sweep.contacts['start']))\n\
         print(*sweep.grid('peak_force').shape, bits(sweep.grid('peak_force')[2, 0]), sweep.done.all())\n\
         print(bits(sweep.series(5)['contact/force']))\n\
         print(part.done.astype(int), np.isnan(part.members['peak_force']).astype(int), set(part.contacts['member']))\n\
         print(bits(part.members['peak_force'][[1, 4]]))",
    );
    let told = told.unwrap();
    let whole = folder.path().join("s.h5");
    let read = |name: &str| bits(&numbers(&whole, name));
    let words = "newmark energy newmark energy newmark energy";
    assert_eq!(told[0], format!("['support.0.stiffness', 'time.scheme'] ['support.0.stiffness'] {words} N/m3"));
    assert_eq!(told[1], bits(&[1e7, 1e7, 1e9, 1e9, 1e11, 1e11]));
    assert_eq!(told[2], read("members/peak_force"));
    assert_eq!(told[3], format!("{} {}", read("contacts/member"), read("contacts/start")));
    let peaks = numbers(&whole, "members/peak_force");
    assert_eq!(told[4], format!("3 2 {} True", bits(&peaks[4..5])));
    assert_eq!(told[5], read("series/5/contact/force"));
    assert_eq!(told[6], "[0 1 0 0 1 0] [1 0 1 1 0 1] {1, 4}");
    assert_eq!(told[7], bits(&[peaks[1], peaks[4]]));
}

fn sweeps_are_drawn_as_curves_and_maps() {
    let folder = folder(&supported());
    good(&folder, 0, "sweep scene.toml --vary support.0.stiffness=1e7..1e11:3 --log -o k.h5");
    good(
        &folder,
        0,
        "sweep scene.toml --vary impactor.speed=0.5,1 --vary support.0.stiffness=1e7..1e11:3 --log -o both.h5",
    );
    let told = python(
        folder.path(),
        "axes = ricochet.Sweep('k.h5').plot()\n\
         print(axes.get_xscale(), '|', axes.get_xlabel(), '|', axes.get_ylabel(), '|', bits(axes.lines[0].get_ydata()))\n\
         axes = ricochet.Sweep('both.h5').plot('peak_force', plt.figure().gca())\n\
         print(axes.get_xlabel(), '|', axes.get_ylabel(), '|', bits(axes.collections[0].get_array().ravel()))\n\
         print(np.allclose(axes.get_xlim(), (1e6, 1e12)), np.allclose(axes.get_ylim(), (0.5 / 2**0.5, 2**0.5)))",
    );
    let read = |file: &str, name: &str| bits(&numbers(&folder.path().join(file), &format!("members/{name}")));
    assert_eq!(
        told.unwrap(),
        [
            format!(
                "log | support.0.stiffness (N/m3) | peak acceleration (m/s2) | {}",
                read("k.h5", "peak_acceleration")
            ),
            format!("support.0.stiffness (N/m3) | impactor.speed (m/s) | {}", read("both.h5", "peak_force")),
            // Cells reach half a step beyond the values, on both logarithmic axes.
            "True True".to_owned(),
        ]
    );
}

fn files_of_the_other_kind_are_refused() {
    let folder = folder(&supported());
    good(&folder, 0, "run scene.toml -o run.h5");
    good(&folder, 0, "sweep scene.toml --vary support.0.stiffness=1e8,1e9 -o sweep.h5");
    for (line, message) in [
        ("ricochet.Run('sweep.h5')", "ValueError: sweep.h5 is not a run of ricochet"),
        ("ricochet.Sweep('run.h5')", "ValueError: run.h5 is not a sweep of ricochet"),
        ("ricochet.Sweep('sweep.h5').series(1)", "has no series of member 1: is it done, and was --series given?"),
    ] {
        let error = python(folder.path(), line).unwrap_err();
        assert!(error.contains(message), "{error}");
    }
}

/// Each cell runs, the figures are there, and the momentum that the notebook works out is that of the contacts.
fn the_notebook_runs() {
    let program = Path::new(env!("CARGO_BIN_EXE_ricochet")).parent().unwrap();
    let path = std::env::join_paths(
        std::iter::once(program.to_owned()).chain(std::env::split_paths(&std::env::var_os("PATH").unwrap())),
    );
    let output = Command::new("scripts/example").current_dir(repository()).env("PATH", path.unwrap()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let written: PathBuf = repository().join(String::from_utf8(output.stdout).unwrap().lines().last().unwrap());
    let notebook: serde_json::Value = serde_json::from_slice(&std::fs::read(written).unwrap()).unwrap();
    let outputs: Vec<&serde_json::Value> =
        notebook["cells"].as_array().unwrap().iter().filter_map(|cell| cell["outputs"].as_array()).flatten().collect();
    assert_eq!(outputs.iter().filter(|output| output["data"]["image/png"].is_string()).count(), 5);
    let said: String = outputs.iter().map(|output| output["text"].to_string()).collect();
    let momentum =
        said.split(" N s").take(2).map(|part| part.rsplit(['"', ' ']).next().unwrap().parse::<f64>().unwrap());
    let momentum: Vec<f64> = momentum.collect();
    // In modal coordinates the impulse of a step is the momentum given, to rounding.
    assert!((momentum[0] - momentum[1]).abs() < 1e-9 * momentum[1] && momentum[1] > 52.0, "{momentum:?}");
}
