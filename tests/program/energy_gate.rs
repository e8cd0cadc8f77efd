//! Test of an unstable scheme in the program: the run is stopped, and the rows written before can be read.

use crate::program::{BOX, ricochet, run};
use crate::results::{column, folder, is_complete, words};
use mpi_test::{PlainTest, tests};

pub const TESTS: &[PlainTest] = tests![a_growing_run_is_stopped_and_its_steps_are_kept];

fn a_growing_run_is_stopped_and_its_steps_are_kept() {
    let time = |gamma: &str| format!("step = 2e-5\nscheme = \"newmark\"\ngamma = {gamma}");
    let ended = |gamma: &str| {
        let scene = BOX.replace("end = 1e-3", "end = 4e-3").replace("step = 2e-5", &time(gamma));
        let folder = folder(&scene);
        let outcome = run(ricochet(folder.path(), 0).args(words("run scene.toml -o out.h5")));
        (folder, outcome)
    };
    let (folder, outcome) = ended("0.45");
    assert_eq!(outcome.status, Some(3), "{outcome:#?}");
    let path = folder.path().join("out.h5");
    let time = column(&path, "time");
    // The message names the first step that is not in the file.
    assert!(outcome.stderr.contains(&format!("step {}, t = ", time.len())), "{} rows: {outcome:#?}", time.len());
    assert!(time.len() > 2 && time.len() < 200 && !is_complete(&path));
    for name in ["impactor/position", "impactor/acceleration", "contact/force", "energy/kinetic", "energy/total"] {
        let values = column(&path, name);
        assert!(values.len() == time.len() && values.iter().all(|value| value.is_finite()), "{name}");
    }
    let (_folder, outcome) = ended("0.5");
    assert_eq!(outcome.status, Some(0), "{outcome:#?}");
}
