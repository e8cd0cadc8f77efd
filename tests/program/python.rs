//! Tests of the Python package (`scripts/python`), which runs the program and reads its output. The examples of
//! docs/python.md and the notebook run unchanged.

mod examples;
mod figures;

use mpi_test::{PlainTest, tests};
use std::path::Path;
use std::process::Command;

use crate::program::BOX;
use crate::restarts;
use crate::results;
use crate::results::{column, folder, good, is_complete};
use crate::sweeps::{numbers, supported};
use examples::{
    pip_installs_the_package, scenes_as_dicts_are_run, the_examples_of_the_documentation_run, the_notebook_runs,
};
use figures::{
    plots_have_axes_of_their_own, sweeps_are_drawn_as_curves_and_maps, sweeps_over_texts_are_drawn_with_names,
};

pub const TESTS: &[PlainTest] = tests![
    runs_are_read_as_they_are_written,
    a_run_that_was_killed_is_read_up_to_its_last_whole_row,
    sweeps_and_their_parts_are_read,
    sweeps_are_drawn_as_curves_and_maps,
    sweeps_over_texts_are_drawn_with_names,
    plots_have_axes_of_their_own,
    scenes_are_run_as_by_the_command_line,
    values_are_set_as_toml,
    errors_have_the_programs_message_and_status,
    an_interrupt_ends_the_program_in_order,
    the_package_has_the_programs_version,
    files_of_the_other_kind_are_refused
];
pub const DICTS: &[PlainTest] = tests![scenes_as_dicts_are_run, the_examples_of_the_documentation_run];
pub const LONG: &[PlainTest] = tests![pip_installs_the_package];
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

/// The search path, with the tested program first.
fn search_path() -> std::ffi::OsString {
    let program = Path::new(env!("CARGO_BIN_EXE_ricochet")).parent().unwrap();
    let others = std::env::var_os("PATH").unwrap();
    std::env::join_paths(std::iter::once(program.to_owned()).chain(std::env::split_paths(&others))).unwrap()
}

/// Output of Debian's Python for some lines of code, with the package of this repository.
fn python(folder: &Path, lines: &str) -> Result<Vec<String>, String> {
    // The packages are installed for Debian's Python.
    answer(Command::new("/usr/bin/python3").env("PYTHONPATH", repository().join("scripts/python")), folder, lines)
}

/// Output of a Python for some lines of code, with the package imported and a function `bits` that prints numbers
/// exactly. If it fails, returns its last line on standard error.
fn answer(python: &mut Command, folder: &Path, lines: &str) -> Result<Vec<String>, String> {
    // The code may start mpirun.
    mpi_test::keep_files_in(folder, python);
    let head = "import matplotlib\nmatplotlib.use('agg')\nimport matplotlib.pyplot as plt, numpy as np, ricochet\n\
        def bits(values): return np.asarray(values, '<f8').tobytes().hex()\n";
    let output = python
        .args(["-c", &format!("{head}{lines}")])
        .current_dir(folder)
        .env("PATH", search_path())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env_remove("PETSC_OPTIONS")
        .env_remove("RICOCHET_LOG")
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
         stresses = {name for name in run.series if name.startswith('stress/')}\n\
         print(*sorted(set(run.series) - stresses))\n\
         print(run.attributes['title'], run.attributes['complete'], run.units['impactor/acceleration'], run.units['impulse'])\n\
         for name in sorted(set(run.series) - stresses): print(bits(run.series[name]))\n\
         for name in ricochet.CONTACT: print(bits(run.contacts[name]))\n\
         axes = run.plot('contact/force')\n\
         print(axes.get_xlabel(), '|', axes.get_ylabel(), '|', bits(axes.lines[0].get_ydata()), len(axes.patches))\n\
         print(*sorted(stresses), run.series['stress/lower/point'].shape[1], run.units['stress/lower/largest'])",
    );
    let mut told = told.unwrap();
    let stresses = "stress/lower/largest stress/lower/point stress/ring stress/upper/largest stress/upper/point 3 Pa";
    assert_eq!(told.pop().as_deref(), Some(stresses));
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

/// A killed run is read up to its last complete row. A kill within a flush leaves the time, which is written last,
/// shorter than the rest, and also a column of the contacts.
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

/// Sweeps over two keys, one of them with text values, are read, and so is the second of three parts; missing members
/// are NaN.
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

/// Scenes are run from a path, from text and on two ranks, into a file and into memory. The last leaves nothing on the
/// disk.
fn scenes_are_run_as_by_the_command_line() {
    let folder = folder(BOX);
    good(&folder, 0, "run scene.toml -o expected.h5 --set impactor.speed=2");
    let told = python(
        folder.path(),
        "import glob, os, pathlib, tempfile\n\
         os.makedirs('temporary'); tempfile.tempdir = os.path.abspath('temporary')\n\
         speed = {'impactor.speed': 2.0}\n\
         def told(run): print(bits(run.series['contact/force']), run.attributes['complete'])\n\
         told(ricochet.run('scene.toml', set=speed))\n\
         told(ricochet.run(open('scene.toml').read(), set=speed))\n\
         told(ricochet.run(pathlib.Path('scene.toml'), 'made.h5', set=speed))\n\
         told(ricochet.run('made.h5'))\n\
         run = ricochet.run(open('scene.toml').read(), set=speed, ranks=2, petsc=['-ksp_type', 'cg'])\n\
         print(run.attributes['ranks'], '-ksp_type cg' in run.attributes['petsc_options'], bits(run.series['contact/force']))\n\
         print(os.listdir('temporary'), *sorted(glob.glob('*.h5')))",
    );
    let told = told.unwrap();
    let force = |name: &str| bits(&column(&folder.path().join(name), "contact/force"));
    assert_eq!(force("made.h5"), force("expected.h5"));
    for line in &told[..4] {
        assert_eq!(*line, format!("{} True", force("expected.h5")));
    }
    let on_ranks = told[4].strip_prefix("2 True ").unwrap();
    // Equal except for the rounding of sums over ranks.
    let expected = column(&folder.path().join("expected.h5"), "contact/force");
    assert!(results::difference(&numbers_of(on_ranks), &expected) < 1e-9);
    assert_eq!(told[5], "[] expected.h5 made.h5");
}

/// Texts, arrays, tables and removed keys are passed to the scene unchanged.
fn values_are_set_as_toml() {
    let folder = folder(&supported());
    let told = python(
        folder.path(),
        "name = 'a \"b\" = c\\\\d, é'\n\
         values = {'title': name, 'body.size': np.array([0.5, 0.4, 0.02]), 'solver.newton': None, 'impactor.mass': np.int64(40),\n\
           'output.probes': [{'name': name, 'point': (0, 0, -0.01)}], 'time.allow_unstable': False,\n\
           'time.scheme': 'central-difference', 'time.step': 1e-6, 'time.end': 1e-5, 'body.model': 'solid', 'body.reduction': 'none'}\n\
         run = ricochet.run('scene.toml', set=values)\n\
         print(run.attributes['title'] == name, run.series[f'probe/{name}/displacement'].shape[1])\n\
         print(run.attributes['scene'])",
    );
    let told = told.unwrap();
    assert_eq!(told[0], "True 3");
    for line in ["size = [0.5, 0.4, 0.02]", "mass = 40", "allow_unstable = false"] {
        assert!(told.iter().any(|there| there == line), "{line}: {told:#?}");
    }
    assert!(!told.iter().any(|line| line.starts_with("newton")), "{told:#?}");
}

fn errors_have_the_programs_message_and_status() {
    let folder = folder(BOX);
    let told = python(
        folder.path(),
        "import logging\n\
         logging.basicConfig(filename='log', level='INFO', format='%(levelname)s %(message)s')\n\
         def fails(*scene, **options):\n\
        \x20   try: ricochet.run(*scene, **options)\n\
        \x20   except (ricochet.RicochetError, FileNotFoundError) as error:\n\
        \x20       print(type(error).__name__, getattr(error, 'status', None), ' '.join(str(error).split()))\n\
         fails('scene.toml', set={'body.yuong': 1})\n\
         fails('missing.toml')\n\
         fails('scene.toml', 'missing/out.h5')\n\
         fails('scene.toml', program='no-ricochet')\n\
         ricochet.run('scene.toml', petsc=['-no_such_option', 1])\n\
         print(open('log').read())",
    );
    let told = told.unwrap();
    let expected: [(&str, &[&str]); 4] = [
        ("RicochetError 2 ", &["unknown key", "did you mean `young`?"]),
        ("RicochetError 4 ", &["missing.toml", "cannot be read"]),
        ("RicochetError 4 ", &["missing"]),
        ("FileNotFoundError None ", &["no-ricochet is not found"]),
    ];
    for (line, (start, fragments)) in told.iter().zip(expected) {
        assert!(line.starts_with(start) && fragments.iter().all(|fragment| line.contains(fragment)), "{line}");
    }
    assert!(told.iter().any(|line| line == "WARNING PETSc has not used the option -no_such_option"), "{told:#?}");
    assert!(told.iter().any(|line| line.starts_with("INFO ")), "{told:#?}");
}

/// An interrupt that reaches Python alone, as in a notebook, ends the program with a checkpoint and Python with
/// KeyboardInterrupt.
fn an_interrupt_ends_the_program_in_order() {
    let folder = folder(&restarts::scene("[output]\ncheckpoint_steps = 10\n"));
    let error = python(
        folder.path(),
        // Background jobs of a shell inherit that interrupts are ignored.
        "import os, signal, threading, time\n\
         signal.signal(signal.SIGINT, signal.default_int_handler)\n\
         def interrupt():\n\
        \x20   while not os.path.exists('out.checkpoint.h5'): time.sleep(0.002)\n\
        \x20   os.kill(os.getpid(), signal.SIGINT)\n\
         threading.Thread(target=interrupt, daemon=True).start()\n\
         ricochet.run('scene.toml', 'out.h5', set={'time.end': 10.0})",
    );
    assert_eq!(error.unwrap_err(), "KeyboardInterrupt");
    assert!(!is_complete(&folder.path().join("out.h5")));
    let told = python(folder.path(), "print(ricochet.Run('out.h5').time[-1])").unwrap();
    let end: f64 = told[0].parse().unwrap();
    // The checkpoint is of the last time step. A killed run would not have it.
    let checkpoint = results::open(folder.path().join("out.checkpoint.h5"));
    assert_eq!(checkpoint.attr("time").unwrap().read_scalar::<f64>().unwrap(), end);
}

fn the_package_has_the_programs_version() {
    let folder = folder(BOX);
    assert_eq!(python(folder.path(), "print(ricochet.__version__)").unwrap(), [env!("CARGO_PKG_VERSION")]);
}

/// The numbers from which `bits` made this text.
fn numbers_of(bits: &str) -> Vec<f64> {
    let number = |digits: &str| f64::from_bits(u64::from_str_radix(digits, 16).unwrap().swap_bytes());
    (0..bits.len() / 16).map(|n| number(&bits[16 * n..16 * n + 16])).collect()
}

fn files_of_the_other_kind_are_refused() {
    let folder = folder(&supported());
    good(&folder, 0, "run scene.toml -o run.h5");
    good(&folder, 0, "sweep scene.toml --vary support.0.stiffness=1e8,1e9 -o sweep.h5");
    for (line, message) in [
        ("ricochet.Run('sweep.h5')", "ValueError: sweep.h5 is not a run of ricochet"),
        (
            "ricochet.Run('scene.toml')",
            "ValueError: scene.toml is not a result of ricochet: ricochet.run computes a scene",
        ),
        ("ricochet.Run('no.h5')", "FileNotFoundError: there is no file no.h5"),
        ("ricochet.Run('run.h5').plot('forces')", "ValueError: the run has no series 'forces'"),
        ("ricochet.Sweep('run.h5')", "ValueError: run.h5 is not a sweep of ricochet"),
        ("ricochet.Sweep('sweep.h5').series(1)", "has no series of member 1: is it done, and was --series given?"),
    ] {
        let error = python(folder.path(), line).unwrap_err();
        assert!(error.contains(message), "{error}");
    }
}
