//! Tools that some tests need; `scripts/test --all` installs them. A test whose tool is missing is ignored, with the
//! reason.

use std::path::Path;
use std::process::{Command, Stdio};

use mpi_test::Missing;

/// The reason why a command cannot be run, if there is one.
pub fn command(name: &str) -> Missing {
    let found =
        std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()).any(|folder| folder.join(name).is_file());
    (!found).then(|| format!("needs {name}"))
}

/// The reason why a page cannot be read in a browser and in print, if there is one.
pub fn browser() -> Missing {
    command("chromium").or_else(|| command("pdftotext"))
}

/// The reason why Debian's Python cannot import modules, if there is one.
pub fn python(modules: &[&str]) -> Missing {
    can_import("/usr/bin/python3", modules)
}

/// The reason why the Python of scripts/readers cannot import VTK, if there is one.
pub fn vtk() -> Missing {
    can_import(&Path::new(env!("CARGO_MANIFEST_DIR")).join("out/readers-venv/bin/python").to_string_lossy(), &["vtk"])
}

fn can_import(python: &str, modules: &[&str]) -> Missing {
    let find = format!("import importlib.util as u, sys; sys.exit(not all(map(u.find_spec, {modules:?})))");
    let status = Command::new(python).args(["-c", &find]).stdout(Stdio::null()).stderr(Stdio::null()).status();
    let found = status.is_ok_and(|status| status.success());
    (!found).then(|| format!("needs Python's {}", modules.join(", ")))
}
