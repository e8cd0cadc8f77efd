//! Tells the program which commit it was built from.

use std::process::Command;

fn main() {
    let commit = git(&["describe", "--always", "--dirty", "--abbrev=12"]).unwrap_or_else(|| "unknown".to_owned());
    println!("cargo::rustc-env=RICOCHET_COMMIT={commit}");
    // Whatever may change what `describe` says: an edit makes the tree dirty, a commit moves a head.
    let heads = ["HEAD", "refs", "index"].into_iter().filter_map(|name| git(&["rev-parse", "--git-path", name]));
    let sources = ["src", "petsc-wrap", "build.rs", "Cargo.toml", "Cargo.lock"].into_iter().map(str::to_owned);
    // A path that does not exist would rerun this every time.
    for path in heads.chain(sources).filter(|path| std::path::Path::new(path).exists()) {
        println!("cargo::rerun-if-changed={path}");
    }
}

/// What git answers; `None` without git, or outside a repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
}
