//! Finds PETSc on this machine and checks that it can be used.

use std::path::{Path, PathBuf};

use super::{fail, listed};

/// The oldest supported version of PETSc.
const OLDEST: (u32, u32) = (3, 18);

/// Location of PETSc.
pub struct Petsc {
    /// The folders of its headers.
    pub include: Vec<PathBuf>,
    /// Folder and name of its library.
    folder: PathBuf,
    name: String,
}

impl Petsc {
    /// Finds PETSc. If PETSC_DIR is set, only that PETSc is accepted.
    pub fn find() -> Result<Self, String> {
        match std::env::var("PETSC_DIR") {
            Ok(dir) if !dir.is_empty() => in_folder(Path::new(&dir)),
            _ => from_pkg_config(),
        }
    }

    /// Path of its shared library, with the name that does not change in updates.
    pub fn library(&self) -> PathBuf {
        let (major, minor) = self.version();
        let names = [format!("lib{}.so.{major}.{minor}", self.name), format!("lib{}.so", self.name)];
        let found = names.iter().map(|name| self.folder.join(name)).find(|library| library.exists());
        found.unwrap_or_else(|| {
            let library = self.folder.join(&names[1]);
            fail(&format!("there is no {}: PETSc must be built with shared libraries", library.display()))
        })
    }

    /// Refuses versions and scalar types that the bindings do not describe.
    pub fn check_configuration(&self) {
        let (found, configuration) = (self.version(), self.header("petscconf.h"));
        if found < OLDEST {
            fail(&format!("this is PETSc {}.{}; {}.{} or newer is needed", found.0, found.1, OLDEST.0, OLDEST.1));
        }
        if defined(&configuration, "PETSC_USE_COMPLEX").is_some() {
            fail(
                "this PETSc is built with complex scalars; one with real scalars is needed: set PETSC_DIR and PETSC_ARCH to such a \
                 build (on Debian, apt-get install petsc-dev and leave both unset)",
            );
        }
        if defined(&configuration, "PETSC_USE_REAL_DOUBLE").is_none() {
            fail("this PETSc is not built in double precision; --with-precision=double is needed");
        }
    }

    /// The text of one of its headers.
    fn header(&self, name: &str) -> String {
        let text = self.include.iter().find_map(|folder| std::fs::read_to_string(folder.join(name)).ok());
        text.unwrap_or_else(|| fail(&format!("{name} is not in PETSc's include folders")))
    }

    /// Its major and minor version.
    fn version(&self) -> (u32, u32) {
        let header = self.header("petscversion.h");
        let number = |name: &str| {
            defined(&header, name)
                .and_then(|value| value.parse().ok())
                .unwrap_or_else(|| fail(&format!("petscversion.h does not define {name}")))
        };
        (number("PETSC_VERSION_MAJOR"), number("PETSC_VERSION_MINOR"))
    }
}

/// PETSc where the user says it is: `PETSC_DIR`, and `PETSC_ARCH` for a build inside its source tree.
fn in_folder(dir: &Path) -> Result<Petsc, String> {
    let build = match std::env::var("PETSC_ARCH") {
        Ok(arch) if !arch.is_empty() => dir.join(arch),
        _ => dir.to_owned(),
    };
    let include = vec![dir.join("include"), build.join("include")];
    if !include.iter().any(|folder| folder.join("petscconf.h").is_file()) {
        return Err(format!(
            "there is no PETSc at PETSC_DIR and PETSC_ARCH: {} has no include/petscconf.h",
            build.display()
        ));
    }
    let folder = build.join("lib");
    // Debian's builds differ in these names.
    let names = ["petsc", "petsc_real", "petsc64_real"];
    let name = names.into_iter().find(|name| folder.join(format!("lib{name}.so")).exists()).unwrap_or(names[0]);
    Ok(Petsc { include, folder, name: name.to_owned() })
}

fn from_pkg_config() -> Result<Petsc, String> {
    let mut reasons = vec!["PETSC_DIR is not set".to_owned()];
    for name in ["petsc", "PETSc"] {
        match pkg_config::Config::new().cargo_metadata(false).probe(name) {
            Ok(library) => return of_package(library),
            Err(error) => {
                let text = error.to_string();
                let line = text.lines().find(|l| !l.trim().is_empty()).unwrap_or_default();
                reasons.push(format!("pkg-config {name}: {}", line.trim()));
            }
        }
    }
    Err(format!("PETSc was not found. On Debian: apt-get install petsc-dev. Tried: {}", listed(&reasons)))
}

/// The library reported by pkg-config whose name begins with "petsc".
fn of_package(package: pkg_config::Library) -> Result<Petsc, String> {
    let name = package.libs.into_iter().find(|name| name.starts_with("petsc"));
    let name = name.ok_or("pkg-config names no library of PETSc")?;
    let mut folders = package.link_paths.into_iter();
    let folder = folders.find(|folder| folder.join(format!("lib{name}.so")).exists());
    let folder = folder.ok_or_else(|| format!("lib{name}.so is in none of the folders that pkg-config names"))?;
    Ok(Petsc { include: package.include_paths, folder, name })
}

/// Value of a macro in a header; empty if the header does not define it.
fn defined<'a>(header: &'a str, name: &str) -> Option<&'a str> {
    header.lines().find_map(|line| {
        let mut words = line.split_whitespace();
        (words.next() == Some("#define") && words.next() == Some(name)).then(|| words.next().unwrap_or_default())
    })
}
