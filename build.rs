//! Passes the commit from which the program is built to the compiler.

use std::process::Command;

fn main() {
    let commit = git(&["describe", "--always", "--dirty", "--abbrev=12"]).unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=RICOCHET_COMMIT={commit}");
    // Files that may change the output of `git describe`: an edit makes the tree dirty, a commit moves a head.
    let heads = ["HEAD", "refs", "index"].into_iter().filter_map(|name| git(&["rev-parse", "--git-path", name]));
    let sources = ["src", "petsc-wrap", "build.rs", "Cargo.toml", "Cargo.lock"].into_iter().map(str::to_owned);
    // A path that does not exist would rerun this script at every build.
    for path in heads.chain(sources).filter(|path| std::path::Path::new(path).exists()) {
        println!("cargo::rerun-if-changed={path}");
    }
}

/// Output of git; `None` without git, or outside a repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
