//! What is done with each input. Whatever it holds, the answer is a value or an error: no panic, no crash, no hang.

use std::cell::OnceCell;
use std::fs;

use petsc_wrap::Session;
use ricochet::mesh::Mesh;
use ricochet::record::checkpoint::{Kept, beside};
use ricochet::scene::{Geometry, Scene};

/// A good scene.
const SCENE: &str = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500\nsize = [0.5, 0.5, 0.02]\n[[support]]\nsurface = \"side\"\n\
                     kind = \"elastic\"\nstiffness = 1e9\n[impactor]\nmass = 52\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1\n\
                     [time]\nend = 1e-3\n";

/// The text of a scene.
pub fn scene(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match Scene::parse("scene.toml", text, &[]) {
        Ok((_, source)) => {
            assert!(Scene::parse("again.toml", source.text(), &[]).is_ok(), "a good scene is good again")
        }
        Err(error) => assert!(!ricochet::Error::from(error).report(false).is_empty()),
    }
}

/// Words of `--set`, one a line, for a good scene.
pub fn set(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let overrides: Vec<String> = text.lines().map(str::to_owned).collect();
    match Scene::parse("scene.toml", SCENE, &overrides) {
        // What was written into the text must give the same scene.
        Ok((scene, source)) => {
            assert!(Scene::parse("again.toml", source.text(), &[]).is_ok_and(|(again, _)| again == scene))
        }
        Err(error) => assert!(!ricochet::Error::from(error).report(false).is_empty()),
    }
}

thread_local! {
    static SESSION: OnceCell<Session> = const { OnceCell::new() };
}

/// A mesh file.
pub fn mesh(data: &[u8]) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("mesh.msh");
    fs::write(&path, data).expect("a file in it");
    let (scene, _) = Scene::parse("scene.toml", SCENE, &[]).expect("a good scene");
    let mut body = scene.body;
    body.geometry = Geometry::Gmsh(path);
    SESSION.with(|session| {
        let session = session.get_or_init(|| Session::start(&[]).expect("once a thread").expect("PETSc starts"));
        let comm = session.world();
        if let Ok(mesh) = Mesh::new(&comm, &body) {
            assert!(mesh.positions().iter().flatten().all(|x| !x.is_nan()));
        }
        comm.collect_garbage().expect("garbage is collected");
    });
}

/// A checkpoint.
pub fn checkpoint(data: &[u8]) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let result = folder.path().join("out.h5");
    fs::write(beside(&result), data).expect("a file in it");
    // A whole one is gone on from by a body of a single node.
    if let Ok(Some(kept)) = Kept::read(&result) {
        let _ = kept.at(Some(&[[0.0; 3]]));
    }
}
