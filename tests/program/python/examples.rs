//! Tests that everything users may copy runs: scenes as dictionaries, the examples of docs/python.md, the package from
//! pip, the notebook.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use crate::program::BOX;
use crate::results::{column, folder, good};
use crate::sweeps::{numbers, supported};

use super::{answer, bits, python, repository, search_path};

pub(super) fn scenes_as_dicts_are_run() {
    let folder = folder(&supported());
    good(&folder, 0, "run scene.toml");
    let told = python(
        folder.path(),
        "import tomllib\n\
         scene = tomllib.load(open('scene.toml', 'rb'))\n\
         scene['body']['size'] = np.array(scene['body']['size'])\n\
         print(bits(ricochet.run(scene).series['contact/force']))",
    );
    assert_eq!(told.unwrap(), [bits(&column(&folder.path().join("scene.h5"), "contact/force"))]);
}

/// The code blocks of docs/python.md with this word after the three backticks.
fn examples(marked: &str) -> Vec<String> {
    let text = fs::read_to_string(repository().join("docs/python.md")).unwrap();
    let parts = text.split("```").skip(1).step_by(2);
    parts.filter_map(|part| part.strip_prefix(marked)?.strip_prefix('\n')).map(str::to_owned).collect()
}

/// The examples run one after the other, with the scene and the sweep of the page.
pub(super) fn the_examples_of_the_documentation_run() {
    let folder = folder("");
    fs::write(folder.path().join("frame.toml"), examples("toml").concat()).unwrap();
    let text = fs::read_to_string(repository().join("docs/python.md")).unwrap();
    let sweep = text.lines().find_map(|line| line.strip_prefix("    ricochet sweep ")).unwrap();
    good(&folder, 0, &format!("sweep {sweep}"));
    let examples = examples("python");
    assert_eq!(examples.len(), 6);
    let told = python(folder.path(), &examples.concat()).unwrap();
    let path = folder.path().join("frame.h5");
    let peak = numbers(&path, "contacts/peak_force").into_iter().fold(0.0, f64::max);
    assert_eq!(told[0], format!("mindlin {peak:?} N"));
    assert!(told[3].starts_with("2 ") && told.iter().any(|line| line.contains("did you mean `young`?")), "{told:#?}");
    for picture in ["frame.png", "speeds.png", "k.png"] {
        assert!(fs::read(folder.path().join(picture)).unwrap().starts_with(b"\x89PNG"), "{picture}");
    }
}

/// pip installs the package into a separate environment, with the packages from PyPI that it needs.
pub(super) fn pip_installs_the_package() {
    let folder = folder(BOX);
    let run = |command: &mut Command| {
        let output = command.env_remove("PYTHONPATH").current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    run(Command::new("/usr/bin/python3").args(["-m", "venv", "venv"]));
    let package = repository().join("scripts/python");
    run(Command::new("venv/bin/pip").args(["install", "--quiet", "--disable-pip-version-check"]).arg(package));
    let lines = "import importlib.metadata, tomllib\n\
        print(ricochet.__file__.startswith(__import__('sys').prefix), importlib.metadata.version('ricochet'))\n\
        run = ricochet.run(tomllib.load(open('scene.toml', 'rb')), 'out.h5')\n\
        print(bits(run.series['contact/force']), bits(run.plot('force').lines[0].get_ydata()))";
    let mut python = Command::new(folder.path().join("venv/bin/python"));
    let told = answer(python.env_remove("PYTHONPATH"), folder.path(), lines).unwrap();
    assert_eq!(told[0], format!("True {}", env!("CARGO_PKG_VERSION")));
    let force = bits(&column(&folder.path().join("out.h5"), "contact/force"));
    assert_eq!(told[1], format!("{force} {force}"));
}

/// Each cell runs, the figures are there, and the momentum computed by the notebook equals the impulse of the contacts.
pub(super) fn the_notebook_runs() {
    let output = Command::new("scripts/example").current_dir(repository()).env("PATH", search_path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let written: PathBuf = repository().join(String::from_utf8(output.stdout).unwrap().lines().last().unwrap());
    let notebook: serde_json::Value = serde_json::from_slice(&fs::read(written).unwrap()).unwrap();
    let outputs: Vec<&serde_json::Value> =
        notebook["cells"].as_array().unwrap().iter().filter_map(|cell| cell["outputs"].as_array()).flatten().collect();
    assert_eq!(outputs.iter().filter(|output| output["data"]["image/png"].is_string()).count(), 5);
    let said: String = outputs.iter().map(|output| output["text"].to_string()).collect();
    let momentum =
        said.split(" N s").take(2).map(|part| part.rsplit(['"', ' ']).next().unwrap().parse::<f64>().unwrap());
    let momentum: Vec<f64> = momentum.collect();
    // In modal coordinates the impulse of a step equals the momentum transferred, to rounding.
    assert!((momentum[0] - momentum[1]).abs() < 1e-9 * momentum[1] && momentum[1] > 52.0, "{momentum:?}");
}
