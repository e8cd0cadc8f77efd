//! Tests of user errors in the program itself, alone and under mpirun: one message that names the place, the right exit
//! status, and no file changed.

use crate::bad_meshes;
use crate::bad_scenes;
use crate::bad_sweeps;
use mpi_test::{PlainTest, tests};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

use crate::bad_meshes::TWO;
use crate::program::{BOX, on_threads, ricochet, run};

pub const TESTS: &[PlainTest] =
    tests![scenes, meshes, scenes_on_a_good_mesh, theories, sweeps, files_and_command_lines];

/// A user's input, and its expected outcome.
struct Case {
    name: String,
    /// Names and contents of the files in the folder.
    files: Vec<(String, Vec<u8>)>,
    arguments: Vec<String>,
    status: i32,
    fragments: Vec<String>,
    /// Content of out.h5 before the run.
    before: Before,
    ranks: &'static [usize],
}

#[derive(Clone, Copy)]
enum Before {
    Nothing,
    /// A file that is not a result.
    Sentinel,
    /// An earlier result.
    Result,
}

const ALONE: &[usize] = &[0];
const BOTH: &[usize] = &[0, 2];

/// A scene that is good if its mesh is [`TWO`].
const ON_MESH: &str = r#"[body]
young = 70e9
poisson = 0.23
density = 2500
mesh = "mesh.msh"
order = 1
[[support]]
surface = "top"
kind = "elastic"
stiffness = 1e9
[impactor]
mass = 52
radius = 0.05
young = 210e9
poisson = 0.3
speed = 1
point = [0.5, 0.5, 2]
[time]
end = 1e-4
step = 2e-5
[contact]
localization = "point"
[solver]
newton = "full"
"#;

/// Words that must not be shown to users.
const FORBIDDEN: [&str; 5] = ["panicked", "PETSC ERROR", "RUST_BACKTRACE", "stack backtrace", "HDF5-DIAG"];

/// The bytes of a real result.
fn earlier_result() -> &'static [u8] {
    static RESULT: OnceLock<Vec<u8>> = OnceLock::new();
    RESULT.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("box.toml"), BOX).unwrap();
        let outcome = run(ricochet(folder.path(), 0).args(["run", "box.toml", "-o", "out.h5"]));
        assert_eq!(outcome.status, Some(0), "{outcome:?}");
        fs::read(folder.path().join("out.h5")).unwrap()
    })
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let named = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    entries.map(|path| (named(&path), fs::read(&path).unwrap_or_default())).collect()
}

/// Number of messages of the program. Each begins on a new line.
fn messages(stderr: &str) -> usize {
    stderr.lines().filter(|line| line.starts_with("error: ") || line.starts_with("  × ")).count()
}

fn check(case: &Case, ranks: usize) -> Result<(), String> {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in &case.files {
        fs::write(folder.path().join(name), bytes).unwrap();
    }
    let out = folder.path().join("out.h5");
    match case.before {
        Before::Nothing => {}
        Before::Sentinel => fs::write(out, "somebody's notes").unwrap(),
        Before::Result => fs::write(out, earlier_result()).unwrap(),
    }
    let before = files(folder.path());
    let outcome = run(ricochet(folder.path(), ranks).args(&case.arguments));
    let mut faults = Vec::new();
    let mut must = |holds: bool, what: String| {
        if !holds {
            faults.push(what);
        }
    };
    must(outcome.status == Some(case.status), format!("expected status {}", case.status));
    must(messages(&outcome.stderr) == 1, "expected one message".to_owned());
    for fragment in &case.fragments {
        must(outcome.stderr.contains(fragment), format!("expected {fragment:?}"));
    }
    for word in FORBIDDEN {
        must(!outcome.stderr.contains(word) && !outcome.stdout.contains(word), format!("found {word:?}"));
    }
    let banner = ranks == 0 && ["MPI_ABORT", "ORTE"].iter().any(|word| outcome.stderr.contains(word));
    must(!banner, "MPI speaks where nobody has asked for it".to_owned());
    let mut after = files(folder.path());
    if ranks > 1 {
        // If another rank has ended the first one, its lock file remains; it then locks nothing.
        after.remove(".out.h5.lock");
    }
    must(after == before, "files have changed".to_owned());
    if faults.is_empty() {
        return Ok(());
    }
    Err(format!("{} on {ranks} ranks: {}\n{outcome:#?}", case.name, faults.join("; ")))
}

/// Runs all cases on their numbers of ranks, three at a time, as each one mostly waits for MPI to start.
fn check_all(cases: &[Case]) {
    earlier_result();
    let jobs: Vec<(&Case, usize)> = cases.iter().flat_map(|case| case.ranks.iter().map(move |r| (case, *r))).collect();
    let failures = on_threads(3, &jobs, |_, (case, ranks)| check(case, *ranks));
    assert!(failures.is_empty(), "{} of {}:\n{}", failures.len(), jobs.len(), failures.join("\n"));
}

fn words(text: &str) -> Vec<String> {
    text.split_whitespace().map(str::to_owned).collect()
}

/// Errors in the text of a scene: the message names the key and the line.
fn scenes() {
    let table = bad_scenes::table();
    let case = |(n, bad): (usize, bad_scenes::BadScene)| {
        let mut arguments = words("run scene.toml -o out.h5");
        arguments.extend(bad.overrides.iter().flat_map(|given| ["--set".to_owned(), given.clone()]));
        let mut fragments = vec![format!(":{}: {}: ", bad.line, bad.key)];
        fragments.extend(bad.fragments.iter().map(|&part| part.to_owned()));
        Case {
            name: bad.name.to_owned(),
            files: vec![("scene.toml".to_owned(), bad.text.into_bytes())],
            arguments,
            status: 2,
            fragments,
            before: [Before::Nothing, Before::Sentinel, Before::Result][n % 3],
            // All ranks read and check the text in the same way: a few cases of every kind show that they agree.
            ranks: if n % 12 == 5 { BOTH } else { ALONE },
        }
    };
    let cases: Vec<Case> = table.into_iter().enumerate().map(case).collect();
    assert!(cases.len() > 100);
    check_all(&cases);
}

/// Faulty mesh files: the message names the key, its line and the file.
fn meshes() {
    let case = |(n, bad): (usize, bad_meshes::BadMesh)| {
        let mut fragments = vec!["scene.toml:5: body.mesh: ".to_owned(), "mesh".to_owned()];
        fragments.extend(bad.fragments.iter().map(|&part| part.to_owned()));
        Case {
            name: bad.name.to_owned(),
            files: vec![("scene.toml".to_owned(), ON_MESH.into()), ("mesh.msh".to_owned(), bad.bytes)],
            arguments: words("run scene.toml -o out.h5"),
            status: 2,
            fragments,
            before: [Before::Nothing, Before::Result][n % 2],
            // Every third case is enough for errors that rank 0 finds before PETSc reads the mesh. The later errors are
            // at the end of the table.
            ranks: if n % 3 == 0 || n > 31 { BOTH } else { ALONE },
        }
    };
    let cases: Vec<Case> = bad_meshes::table().into_iter().enumerate().map(case).collect();
    check_all(&cases);
}

/// Scenes that ask a good mesh for something it does not have.
fn scenes_on_a_good_mesh() {
    let case = |name: &str, set: &str, fragments: &[&str]| Case {
        name: name.to_owned(),
        files: vec![("scene.toml".to_owned(), ON_MESH.into()), ("mesh.msh".to_owned(), TWO.into())],
        arguments: words(&format!("run scene.toml -o out.h5 --set {set}")),
        status: 2,
        fragments: fragments.iter().map(|&part| part.to_owned()).collect(),
        before: Before::Result,
        ranks: BOTH,
    };
    check_all(&[
        case("no such surface", "support.0.surface=tpo", &[":8: support.0.surface: ", "no surface \"tpo\"", "\"top\""]),
        case(
            "a volume's name",
            "support.0.surface=block",
            &[":8: support.0.surface: ", "no surface \"block\"", "\"top\""],
        ),
        case(
            "a name that marks nothing",
            "support.0.surface=middle",
            &[":8: support.0.surface: ", "the surface \"middle\"", "has no faces"],
        ),
        case(
            "off the body",
            "impactor.point=[0.5,0.5,2.25]",
            &[":17: impactor.point: ", "2.500e-1 m away", "nearest point"],
        ),
        case("within the body", "impactor.point=[0.5,0.5,1.5]", &[":17: impactor.point: ", "5.000e-1 m away"]),
        case(
            "out of the body",
            "impactor.direction=[0,0,1]",
            &[": impactor.direction: ", "does not lead into the body"],
        ),
        case(
            "no mesh file",
            "body.mesh=no/mesh.msh",
            &[":5: body.mesh: ", "no/mesh.msh: cannot be read", "No such file"],
        ),
        case("a folder for a mesh", "body.mesh=.", &[":5: body.mesh: ", "cannot be read", "directory"]),
    ]);
}

/// Theories that cannot model a scene: the message names `body.model` and the reason.
fn theories() {
    let case = |name: &str, model: &str, set: &str, fragment: &str| Case {
        name: name.to_owned(),
        files: vec![("scene.toml".to_owned(), bad_scenes::SMALL.into())],
        arguments: words(&format!("run scene.toml -o out.h5 --set body.model={model} --set {set}")),
        status: 2,
        fragments: vec![
            ": body.model: ".to_owned(),
            format!("\"{model}\" cannot model this scene: "),
            fragment.to_owned(),
        ],
        before: Before::Result,
        ranks: if model == "mindlin" { BOTH } else { ALONE },
    };
    let oblique = "impactor.direction=[0.1,0,-1]";
    let pad = "support=[{surface=\"bottom\",kind=\"pad\",stiffness=1e9,normal=[0.1,0,-1]}]";
    let clamped = "support=[{surface=\"bottom\",kind=\"clamped\"}]";
    let pushed = "support=[{surface=\"side\",kind=\"elastic\",stiffness=1e9,displacement=[1e-4,0,0]}]";
    let traction = "load.traction=[{surface=\"top\",value=[1,0,0]}]";
    check_all(&[
        case("plate hit askew", "kirchhoff", oblique, "the impactor does not move along the normal of a face"),
        case("endless plate hit askew", "infinite-plate", oblique, "the hit is oblique"),
        case("plate on a pad", "kirchhoff", pad, "support.0 on \"bottom\" is a pad that acts along the plate"),
        case("plate held by its face", "kirchhoff", clamped, "support.0 on \"bottom\" holds a face of the plate"),
        case(
            "plate pushed along itself",
            "mindlin",
            pushed,
            "support.0 on \"side\" has a displacement in the plate's plane",
        ),
        case("plate pulled along itself", "mindlin", traction, "load.traction.0 has a part in the plate's plane"),
        case(
            "plate that weighs sideways",
            "kirchhoff",
            "load.body_force=[1,0,0]",
            "load.body_force has a part in the plate's plane",
        ),
        case("disc off the edge", "mindlin", "impactor.point=[0.745,0,0.05]", "the hit is 5.000e-3 m from an edge"),
        case("plate on its edge", "kirchhoff", "impactor.direction=[-1,0,0]", "the body is not thin along x"),
        case(
            "disc at a point",
            "mindlin",
            "contact.localization=point",
            "a force at a point is for kirchhoff and solid",
        ),
        case(
            "half-space at a point",
            "half-space",
            "contact.localization=point",
            "a force at a point is for kirchhoff and solid",
        ),
    ]);
}

/// Sweeps that cannot start, and files that are not sweeps.
fn sweeps() {
    let case = |name: &str, line: &str, status, fragments: &[&str], before, ranks| Case {
        name: name.to_owned(),
        files: vec![("box.toml".to_owned(), BOX.into())],
        arguments: words(line),
        status,
        fragments: fragments.iter().map(|&part| part.to_owned()).collect(),
        before,
        ranks,
    };
    let refused = bad_sweeps::TABLE.iter().map(|bad| {
        let ranks = if bad.on_ranks { BOTH } else { ALONE };
        case(bad.name, &format!("sweep box.toml {}", bad.line), 2, bad.fragments, Before::Nothing, ranks)
    });
    let sweep = |name, before, fragment, ranks| {
        case(name, "sweep box.toml --vary impactor.speed=1,2 -o out.h5", 4, &[fragment], before, ranks)
    };
    let mut cases: Vec<Case> = refused.collect();
    cases.push(sweep(
        "a run's result",
        Before::Result,
        "out.h5: is the result of a run, so it is not replaced by a sweep",
        BOTH,
    ));
    cases.push(sweep("somebody's notes", Before::Sentinel, "out.h5: is no readable HDF5 file", ALONE));
    let line = "sweep box.toml --vary impactor.speed=1,2 -o no/out.h5";
    cases.push(case("no folder", line, 4, &["no/out.h5: there is no folder no"], Before::Nothing, BOTH));
    check_all(&cases);
}

/// Files that cannot be read or written, and meaningless command lines.
fn files_and_command_lines() {
    let good = |name: &str, line: &str, status: i32, fragments: &[&str], before: Before, ranks| Case {
        name: name.to_owned(),
        files: vec![("box.toml".to_owned(), BOX.into()), ("bytes".to_owned(), vec![0xff, 0xfe, 0, 1])],
        arguments: words(line),
        status,
        fragments: fragments.iter().map(|&part| part.to_owned()).collect(),
        before,
        ranks,
    };
    use Before::{Nothing, Result, Sentinel};
    #[rustfmt::skip]
    let cases = [
        good("no scene file", "run no.toml", 4, &["no.toml: the scene cannot be read: No such file"], Result, BOTH),
        good("a folder for a scene", "run .", 4, &[".: the scene cannot be read", "directory"], Result, BOTH),
        good("bytes for a scene", "run bytes", 2, &["bytes: line 1 is not text in UTF-8"], Nothing, BOTH),
        good("a result over itself", "run out.h5", 2, &["the scene of a result needs a name for its result: -o OUT.h5"], Result, BOTH),
        good("a scene for a result", "info box.toml", 4, &["box.toml: is not an HDF5 file"], Nothing, ALONE),
        good("a restart from a scene", "run box.toml --restart box.toml", 4, &["box.toml: is no"], Nothing, BOTH),
        good("no folder", "run box.toml -o no/out.h5", 4, &["no/out.h5: there is no folder no"], Result, BOTH),
        good("a folder", "run box.toml -o ..", 4, &["error: ..: "], Nothing, ALONE),
        good("a folder by name", "run box.toml -o /tmp", 4, &["/tmp: is a folder"], Nothing, BOTH),
        // This folder of the kernel refuses new files even from root.
        good("no permission", "run box.toml -o /proc/out.h5", 4, &["/proc/out.h5: cannot be created"], Nothing, BOTH),
        good("the scene itself", "run box.toml -o box.toml", 4, &["box.toml: is no readable HDF5 file, so it is not replaced"], Nothing, BOTH),
        good("somebody's notes", "run box.toml -o out.h5", 4, &["out.h5: is no readable HDF5 file"], Sentinel, BOTH),
        good("a device", "run box.toml -o /dev/null", 4, &["/dev/null: is not a regular file"], Nothing, ALONE),
        good("unknown subcommand", "frob box.toml", 2, &["unrecognized subcommand 'frob'"], Nothing, BOTH),
        good("unknown flag", "run box.toml --fast", 2, &["unexpected argument '--fast'"], Nothing, ALONE),
        good("no scene", "run", 2, &["<SCENE>"], Nothing, ALONE),
        good("no subcommand's argument", "check", 2, &["<SCENE>"], Nothing, ALONE),
        good("an override without a value", "run box.toml --set", 2, &["--set <KEY=VALUE>"], Nothing, ALONE),
        good("a malformed override", "run box.toml --set time.step", 2, &["--set time.step", "no `=`"], Result, BOTH),
        good("a word for PETSc", "run box.toml -o out.h5 -- ksp_type", 2, &["expected a PETSc option such as -snes_monitor after `--`, got \"ksp_type\""], Result, BOTH),
        good("our options after --", "run box.toml -o out.h5 -- --set time.end=1", 2, &["--set stands after `--`, where PETSc's options are: write it before `--`"], Result, BOTH),
        good("our output after --", "run box.toml -- -snes_monitor -o out.h5", 2, &["-o stands after `--`"], Result, ALONE),
        good("no file of options", "run box.toml -o out.h5 -- -options_file none", 2, &["-options_file none: No such file"], Result, BOTH),
        good("unknown type", "run box.toml -o out.h5 -- -ksp_type nonsense", 2, &["a PETSc option is wrong", "KSP type nonsense"], Result, BOTH),
        good("unknown preconditioner", "run box.toml -o out.h5 -- -pc_type nonsense", 2, &["a PETSc option is wrong", "nonsense"], Result, ALONE),
        good("value of another type", "run box.toml -o out.h5 -- -snes_max_it few", 2, &["a PETSc option is wrong", "few"], Result, BOTH),
        good("no result", "plot no.h5 -o figure.svg", 4, &["no.h5: No such file"], Nothing, ALONE),
        good("a foreign file", "plot box.toml -o figure.svg", 4, &["box.toml: is not an HDF5 file"], Nothing, ALONE),
        good("another ending", "plot out.h5 -o figure.pdf", 2, &["figure.pdf", ".svg", ".png"], Result, ALONE),
        good("no such quantity", "plot out.h5 -o figure.svg --quantity forces", 2, &["--quantity forces", "deflection"], Result, ALONE),
        good("no figure", "plot out.h5", 2, &["--output"], Result, ALONE),
        good("no folder for the figure", "plot out.h5 -o no/figure.svg", 4, &["no/figure.svg"], Result, ALONE),
    ];
    check_all(&cases);
}
