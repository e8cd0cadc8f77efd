//! Fuzz targets. For every input, the result must be a value or an error: no panic, no crash, no hang.

use std::cell::OnceCell;
use std::fs;
use std::ops::ControlFlow;

use clap::Parser;
use petsc_wrap::{Comm, Session};
use ricochet::cli::checkpoint_writer::Known;
use ricochet::cli::summary::Summary;
use ricochet::cli::{self, Cli, Command};
use ricochet::impact::checkpoint::{Checkpoint, Visitor};
use ricochet::impact::step::Step;
use ricochet::impact::{Observer, Reading};
use ricochet::mesh::Mesh;
use ricochet::model::{Model, Simulation};
use ricochet::record::checkpoint::{StoredCheckpoint, beside};
use ricochet::record::episodes::Episodes;
use ricochet::scene::{Geometry, Scene};
use ricochet::space::evaluate::TensionMap;

/// A valid scene.
const SCENE: &str = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500\nsize = [0.5, 0.5, 0.02]\n[[support]]\nsurface = \"side\"\n\
                     kind = \"elastic\"\nstiffness = 1e9\n[impactor]\nmass = 52\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1\n\
                     [time]\nend = 1e-3\n";

/// Target: the input is the text of a scene.
pub fn scene(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match Scene::parse("scene.toml", text, &[]) {
        Ok((_, source)) => {
            assert!(Scene::parse("again.toml", source.text(), &[]).is_ok(), "a good scene is good again")
        }
        Err(error) => assert!(!ricochet::Error::from(error).report(false).is_empty()),
    }
}

/// Target: the input is a list of `--set` overrides for a valid scene, one per line.
pub fn set(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let overrides: Vec<String> = text.lines().map(str::to_owned).collect();
    match Scene::parse("scene.toml", SCENE, &overrides) {
        // The text with the overrides must give the same scene.
        Ok((scene, source)) => {
            assert!(Scene::parse("again.toml", source.text(), &[]).is_ok_and(|(again, _)| again == scene))
        }
        Err(error) => assert!(!ricochet::Error::from(error).report(false).is_empty()),
    }
}

thread_local! {
    static SESSION: OnceCell<Session> = const { OnceCell::new() };
}

/// Target: the input is a mesh file.
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

thread_local! {
    /// A small result of a run, and a sweep.
    static RESULTS: OnceCell<[Vec<u8>; 2]> = const { OnceCell::new() };
}

/// Target: the input changes bytes of a result: which of the two, then for each change two bytes for the place, of the first
/// 64 KiB, and one for the value.
pub fn result(data: &[u8]) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let made = RESULTS.with(|results| {
        results
            .get_or_init(|| {
                fs::write(at("scene.toml"), BODY).expect("a scene");
                let [scene, run, sweep] = ["scene.toml", "run.h5", "sweep.h5"].map(at);
                command(&["run", &scene, "-o", &run]);
                command(&["sweep", &scene, "--vary", "impactor.speed=1,2", "--series", "-o", &sweep]);
                [run, sweep].map(|path| fs::read(path).expect("a result"))
            })
            .clone()
    });
    let mut data = Bytes(data);
    let mut bytes = made[usize::from(data.next() % 2)].clone();
    while !data.0.is_empty() {
        let place = usize::from(u16::from_le_bytes([data.next(), data.next()]));
        let value = data.next();
        bytes.get_mut(place).into_iter().for_each(|byte| *byte = value);
    }
    fs::write(at("changed.h5"), &bytes).expect("a file");
    let (changed, page, figure) = (at("changed.h5"), at("x.html"), at("x.svg"));
    for line in [&["info", &changed][..], &["report", &changed, "-o", &page], &["plot", &changed, "-o", &figure]] {
        command(line);
    }
}

/// Runs a command of the program; its error, if there is one, is not looked at.
fn command(words: &[&str]) {
    let cli = Cli::try_parse_from(["ricochet", "-q"].iter().chain(words)).expect("a good command line");
    SESSION.with(|session| {
        let session = session.get_or_init(|| Session::start(&[]).expect("once a thread").expect("PETSc starts"));
        let comm = session.world();
        let _ = match &cli.command {
            Command::Run(run) => cli::run::run(&comm, run),
            Command::Sweep(sweep) => cli::sweep::sweep(&comm, sweep),
            Command::Info(info) => cli::info::info(info).map(|()| 0),
            Command::Report(report) => cli::report::report(report).map(|()| 0),
            Command::Plot(plot) => cli::plot::plot(&plot.results, &plot.output, None).map(|()| 0),
            _ => Ok(0),
        };
    });
}

/// Target: the input is a checkpoint file; it is also used to change a valid checkpoint from which a run continues.
pub fn checkpoint(data: &[u8]) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let result = folder.path().join("out.h5");
    fs::write(beside(&result), data).expect("a file in it");
    let _ = StoredCheckpoint::read(&result);
    // The checksum rejects every file that this program has not written. Therefore the contents are changed before they
    // are written.
    let mut data = Bytes(data);
    let scene = if data.next() % 2 == 0 { BODY.to_owned() } else { BODY.replace("step = 1e-5\n", "") };
    let (scene, _) = Scene::parse("scene.toml", &scene, &[]).expect("a good scene");
    let simulation = |comm: &Comm| Simulation::new(&scene, Model::new(comm, &scene)?);
    SESSION.with(|session| {
        let session = session.get_or_init(|| Session::start(&[]).expect("once a thread").expect("PETSc starts"));
        let comm = session.world();
        let mut impact = simulation(&comm).expect("a good simulation");
        let mut keeper = Keeper(known(), Checkpoint::default());
        assert!(impact.run_watched(&mut keeper).expect("it runs").is_continue());
        let nodes = impact.nodes().expect("a mesh").to_vec();
        let mut kept = StoredCheckpoint {
            scene: SCENE.to_owned(),
            run_id: 1,
            time: 1e-4,
            nodes: nodes.clone(),
            checkpoint: keeper.1,
        };
        let is_good = data.0.is_empty();
        for _ in 0..32 {
            change(&mut kept, &mut data);
        }
        let written = kept.write(&result).and_then(|()| StoredCheckpoint::read(&result));
        let resume = |kept: StoredCheckpoint| {
            let carried = known().visit(&mut Visitor::restore(&kept.checkpoint));
            let part = kept.at(Some(&nodes)).map_err(ricochet::Error::Output);
            carried.and(part.and_then(|part| simulation(&comm)?.resume(&part)))
        };
        let resumed = written.and_then(|kept| resume(kept.expect("it is there")));
        assert!(resumed.is_ok() || !is_good, "{resumed:?}");
        drop(impact);
        comm.collect_garbage().expect("garbage is collected");
    });
}

/// Scene of the smallest body, with ten steps.
const BODY: &str = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500\nsize = [0.5, 0.5, 0.02]\nmodel = \"solid\"\nreduction = \"none\"\n\
                    cells = [2, 2, 1]\norder = 1\nsymmetry = \"none\"\n[impactor]\nmass = 52\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\n\
                    speed = 1\n[contact]\nlocalization = \"point\"\n[time]\nscheme = \"newmark\"\nend = 1e-4\nstep = 1e-5\n";

/// State of the recording before the first step.
fn known() -> Known {
    Known { rows: 0, episodes: Episodes::default(), summary: Summary::default(), map: TensionMap::default() }
}

/// Keeps a checkpoint of every step, like a run.
struct Keeper(Known, Checkpoint);

impl Observer for Keeper {
    fn step(&mut self, step: &Step, reading: &Reading) -> Result<ControlFlow<()>, ricochet::Error> {
        self.0.rows += 1;
        self.0.episodes.push(step);
        self.0.summary.step(step);
        self.0.map.take(&reading.map);
        Ok(ControlFlow::Continue(()))
    }

    fn settled(
        &mut self,
        _: bool,
        checkpoint: &mut dyn FnMut() -> Result<Checkpoint, ricochet::Error>,
    ) -> Result<(), ricochet::Error> {
        self.1 = checkpoint()?;
        self.0.visit(&mut Visitor::save(&mut self.1))
    }
}

/// Reads values from an input; zeros after its end.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn next(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else { return 0 };
        self.0 = rest;
        *first
    }

    fn number(&mut self) -> f64 {
        f64::from_le_bytes(std::array::from_fn(|_| self.next()))
    }
}

/// Changes a name, a number, a length or a node of a checkpoint; nothing at the end of the input.
fn change(kept: &mut StoredCheckpoint, data: &mut Bytes) {
    if data.0.is_empty() {
        return;
    }
    let (what, which) = (data.next() % 9, usize::from(data.next()));
    let Checkpoint { vectors, numbers, lists } = &mut kept.checkpoint;
    let number = numbers.keys().nth(which % numbers.len().max(1)).cloned().unwrap_or_default();
    let vector = vectors.keys().nth(which % vectors.len().max(1)).cloned().unwrap_or_default();
    let length = 3 * kept.nodes.len();
    match what {
        0 => drop(numbers.remove(&number)),
        1 => drop(numbers.insert(number, data.number())),
        2 => drop(numbers.insert(number, f64::from(data.next()))),
        3 => drop(numbers.insert(format!("record.episode.{which}.start"), data.number())),
        4 => drop(vectors.remove(&vector)),
        5 => drop(vectors.insert(vector, vec![data.number(); (length + which).saturating_sub(128)])),
        6 => drop(vectors.insert(vector, vec![data.number(); length])),
        7 => drop(lists.insert("record.tension".to_owned(), vec![data.number(); which])),
        _ => match kept.nodes.get_mut(which) {
            Some(node) => node[which % 3] = data.number(),
            None => kept.nodes.truncate(which % 20),
        },
    }
}
