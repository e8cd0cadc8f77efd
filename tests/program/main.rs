//! Tests of the program as a user runs it: alone and under `mpirun`; and of its results as other programs read them.

#[path = "../common/bad_meshes.rs"]
mod bad_meshes;
#[path = "../common/bad_scenes.rs"]
mod bad_scenes;
#[path = "../common/bad_sweeps.rs"]
mod bad_sweeps;
#[path = "../common/bricks.rs"]
mod bricks;
#[path = "../common/glass.rs"]
mod glass;
#[path = "../common/page.rs"]
mod page;
#[path = "../common/program.rs"]
mod program;
#[path = "../common/restarts.rs"]
mod restarts;
#[path = "../common/results.rs"]
mod results;
#[path = "../common/stresses.rs"]
mod stresses;
#[path = "../common/sweeps.rs"]
mod sweeps;
#[path = "../common/texts.rs"]
mod texts;

mod agreement;
mod bad_input;
mod chart;
mod checks;
mod documents;
mod ended_runs;
mod energy_gate;
mod examples;
mod fields;
mod kills;
mod laws;
mod limit;
mod losses;
mod mutated_meshes;
mod probes;
mod python;
mod report;
mod restart;
mod restart_files;
mod runs;
mod slurm;
mod stability_study;
mod strangers;
mod summaries;
mod sweep;
mod sweep_resume;
mod temperatures;
mod tension;
mod tools;

use std::process::ExitCode;

use mpi_test::PlainSuite;

fn main() -> ExitCode {
    PlainSuite::default()
        .group("agreement", agreement::TESTS)
        .group("bad_input", bad_input::TESTS)
        .group("chart", chart::TESTS)
        .long_group("chart", chart::LONG)
        .group("checks", checks::TESTS)
        .group("documents", documents::TESTS)
        .group("ended_runs", ended_runs::TESTS)
        .group("energy_gate", energy_gate::TESTS)
        .group("examples", examples::TESTS)
        .group("fields", fields::TESTS)
        .group_unless(tools::vtk(), "fields", fields::BY_VTK)
        .group("kills", kills::TESTS)
        .long_group("kills", kills::LONG)
        .group("losses", losses::TESTS)
        .group("laws", laws::TESTS)
        .group("limit", limit::TESTS)
        .group("mutated_meshes", mutated_meshes::TESTS)
        .group("probes", probes::TESTS)
        .group_unless(tools::python(&["h5py", "matplotlib"]), "python", python::TESTS)
        .group_unless(tools::python(&["h5py", "matplotlib", "tomli_w"]), "python", python::DICTS)
        .long_group("python", python::LONG)
        .group_unless(tools::python(&["h5py", "matplotlib", "nbclient", "ipykernel"]), "python", python::NOTEBOOK)
        .group("report", report::TESTS)
        .group_unless(tools::browser(), "report", report::IN_A_BROWSER)
        .group("restart", restart::TESTS)
        .group("restart_files", restart_files::TESTS)
        .group("runs", runs::TESTS)
        .group("slurm", slurm::TESTS)
        .group_unless(tools::command("shellcheck"), "slurm", slurm::SHELLCHECK)
        .group("stability_study", stability_study::TESTS)
        .group("strangers", strangers::TESTS)
        .group("summaries", summaries::TESTS)
        .group("sweep", sweep::TESTS)
        .group("sweep_resume", sweep_resume::TESTS)
        .group("temperatures", temperatures::TESTS)
        .group("tension", tension::TESTS)
        .run()
}
