//! Tests that the result does not depend on how it is computed: on any number of ranks, on a quarter or on the whole
//! plate, with either Newton's method.

use crate::results;
use mpi_test::{PlainTest, tests};
use std::path::{Path, PathBuf};

use crate::glass::{plate, sides};
use crate::results::{column, difference, folder, good};

pub const TESTS: &[PlainTest] = tests![ways_to_the_answer_agree];

/// Tolerance for rounding errors in the entries of K, which may grow about a millionfold. Here they stay below 1e-9.
const ROUNDING: f64 = 1e-7;

/// Four time integration schemes and their settings.
const SCHEMES: [(&str, &str); 4] =
    [("newmark", ""), ("generalized-alpha", "--set time.rho_inf=0.6"), ("energy", ""), ("central-difference", "")];

/// The paper's plate of 0.04 m on springs, with a coarse mesh: three contacts in 8 ms.
fn scene() -> String {
    let body = "size = [1.5, 1.5, 0.04]\ncells = [8, 8, 1]\ngrading = [6, 6, 1]";
    plate(body, "end = 8e-3\nstep = 4e-5", &sides(1e9, 0.0))
}

/// Runs the scene with further overrides; returns the path of the result.
fn solved(folder: &tempfile::TempDir, name: &str, ranks: usize, overrides: &str) -> PathBuf {
    let name = format!("{name}.h5");
    good(folder, ranks, &format!("run scene.toml -o {name} {overrides}"));
    folder.path().join(name)
}

fn hits(path: &Path) -> usize {
    results::open(path).dataset("contacts/start").unwrap().size()
}

/// Compares the whole time histories of the energies and of the impactor's acceleration, over its peak.
fn ways_to_the_answer_agree() {
    let folder = folder(&scene());
    for (scheme, settings) in SCHEMES {
        let explicit = scheme == "central-difference";
        // Explicit time steps have a stability limit. Order 1 keeps it long and the run short.
        let step = if explicit { "--set time.step=2.5e-6 --set body.order=1" } else { "" };
        let base = format!("--set time.scheme={scheme} {settings} {step}");
        let reference = solved(&folder, &format!("{scheme}-reference"), 0, &base);
        assert!(hits(&reference) >= 2, "{scheme}: {} hits", hits(&reference));
        let mut others = vec![("two ranks", 2, ""), ("the whole", 0, "--set body.symmetry=none")];
        if scheme == "newmark" {
            others.push(("three ranks", 3, ""));
        }
        if !explicit {
            others.push(("full Newton", 0, "--set solver.newton=full"));
        }
        for (name, ranks, overrides) in others {
            let other =
                solved(&folder, &format!("{scheme}-{}", name.replace(' ', "-")), ranks, &format!("{base} {overrides}"));
            for series in ["impactor/acceleration", "contact/surface_displacement", "energy/elastic"] {
                let off = difference(&column(&reference, series), &column(&other, series));
                println!("{scheme}, {name}: {series} differs by {off:.1e}");
                assert!(off < ROUNDING, "{scheme}, {name}: {series} differs by {off:e}");
            }
        }
    }
}
