//! Reads the results of other programs for the same scene from a table.

use std::path::Path;

use serde::Deserialize;

use super::Errors;
use crate::error::{Error, Result};
use crate::record::episodes::Episode;
use crate::record::provenance::Provenance;
use crate::record::quantity::Quantity;
use crate::record::read;
use crate::record::stress::Stresses;
use crate::scene::{Body, Geometry, Scene, differences};
use crate::study::history::{Contact, History};

/// A line of the table: `name`, `setting`, either `seconds` or `build` and `run` (wall times, s), and either `error`
/// (and `whole_error`) or `series`. Errors are relative to the reference's peak; `series` is a file name relative to
/// the table's folder.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    name: String,
    #[serde(default)]
    setting: String,
    seconds: Option<f64>,
    build: Option<f64>,
    run: Option<f64>,
    error: Option<f64>,
    whole_error: Option<f64>,
    #[serde(default)]
    series: String,
}

/// A line of a time series: time (s) and acceleration (m/s²) of the impactor.
#[derive(Debug, Deserialize)]
struct Row {
    time: f64,
    acceleration: f64,
    /// Largest tension, Pa.
    tension: Option<f64>,
}

/// A run of another program (a peer).
#[derive(Debug, Clone, PartialEq)]
pub struct Foreign {
    /// Name of the method.
    pub name: String,
    /// Description of its settings.
    pub setting: String,
    /// Wall time before the first step and of the steps, s.
    pub seconds: [f64; 2],
    /// Result of the run.
    pub found: Found,
}

/// Result of a peer's run.
#[derive(Debug, Clone, PartialEq)]
pub enum Found {
    /// Errors as stated in the table.
    Errors(Errors),
    /// Time history of the acceleration.
    History(History),
}

impl Foreign {
    /// Errors relative to a reference.
    pub fn errors(&self, reference: &History) -> Errors {
        match &self.found {
            Found::Errors(errors) => *errors,
            Found::History(history) => Errors::of(history, reference),
        }
    }
}

/// Reads a table of peers' runs. Their series are read from the table's folder; `mass` (kg) is the impactor's.
///
/// # Errors
/// [`Error::Io`] with the line and the fault in it.
pub fn foreign(path: &Path, mass: f64) -> Result<Vec<Foreign>> {
    let mut table = csv::Reader::from_path(path).map_err(|e| Error::io(path, e))?;
    let mut all = Vec::new();
    for (n, line) in table.deserialize::<Line>().enumerate() {
        let line = line.map_err(|e| Error::io(path, fault(&e)))?;
        let wrong = |what: &str| Error::io(path, format!("line {}: {what}", n + 2));
        let seconds = match (line.seconds, line.build, line.run) {
            (Some(seconds), None, None) => [0.0, seconds],
            (None, build, Some(run)) => [build.unwrap_or_default(), run],
            _ => return Err(wrong("either `seconds`, or `build` and `run`, are to be given")),
        };
        if !(seconds[0] >= 0.0 && seconds[1] >= 0.0 && seconds[0] + seconds[1] > 0.0) {
            return Err(wrong("a time is to be positive"));
        }
        let found = match (line.error, line.series.trim()) {
            (Some(error), "") if error >= 0.0 => {
                Found::Errors(Errors::known(error, line.whole_error.unwrap_or(f64::NAN)))
            }
            (None, series) if !series.is_empty() => {
                let beside = path.parent().unwrap_or(Path::new("")).join(series);
                let found = history(&beside, mass).and_then(|found| comparable(&beside, found));
                Found::History(found.map_err(|error| wrong(&error.to_string()))?)
            }
            _ => return Err(wrong("either `error`, not negative, or `series` is to be given")),
        };
        all.push(Foreign { name: line.name, setting: line.setting, seconds, found });
    }
    if all.is_empty() {
        return Err(Error::io(path, "holds no runs"));
    }
    Ok(all)
}

/// Describes the fault in a line of a table, with the column number if it is known.
fn fault(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::Deserialize { pos, err } => {
            let line = pos.as_ref().map_or(1, csv::Position::line);
            let column = err.field().map_or(String::new(), |field| format!("column {}: ", field + 1));
            format!("line {line}: {column}{}", err.kind())
        }
        _ => error.to_string(),
    }
}

/// Reads a time series: a result file of ricochet (`.h5`), or a CSV table of `time`, `acceleration` and optionally
/// `tension`. `mass` (kg) is the impactor's.
///
/// # Errors
/// [`Error::Io`] if the file cannot be read or is not such a series.
pub fn history(path: &Path, mass: f64) -> Result<History> {
    if path.extension().is_some_and(|extension| extension == "h5") {
        let Quantity { time, parts, contacts, .. } = read::history(path)?;
        let acceleration = parts.into_iter().next().map(|part| part.values).unwrap_or_default();
        let contact = |Episode { start, end, impulse, .. }| Contact { start, end, impulse };
        let history = History::new(time, acceleration, contacts.into_iter().map(contact).collect());
        let tension = Stresses::read(path)?.map(|stresses| stresses.largest_of_rows()).unwrap_or_default();
        return Ok(history.with_tension(tension));
    }
    let mut table = csv::Reader::from_path(path).map_err(|e| Error::io(path, e))?;
    let (mut time, mut acceleration, mut tension) = (Vec::new(), Vec::new(), Vec::new());
    for row in table.deserialize::<Row>() {
        let row = row.map_err(|e| Error::io(path, fault(&e)))?;
        if !(row.time.is_finite() && row.acceleration.is_finite()) || time.last().is_some_and(|last| *last >= row.time)
        {
            return Err(Error::io(
                path,
                format!("line {}: times are to ascend, and all numbers to be finite", time.len() + 2),
            ));
        }
        time.push(row.time);
        acceleration.push(row.acceleration);
        tension.extend(row.tension);
    }
    if time.is_empty() {
        return Err(Error::io(path, "holds no series"));
    }
    // A tension column that is filled in some rows only is ignored.
    let tension = if tension.len() == time.len() { tension } else { Vec::new() };
    Ok(History::of_series(time, acceleration, mass).with_tension(tension))
}

/// Returns a history, read from the file `path`, if other histories can be compared with it.
///
/// # Errors
/// [`Error::Io`] if it has fewer than two rows or no contact.
pub fn comparable(path: &Path, history: History) -> Result<History> {
    let why = match (history.rows(), history.peak()) {
        (rows @ 0..2, _) => format!("has {rows} rows, and a history at least two"),
        (_, peak) if peak > 0.0 => return Ok(history),
        _ => "has no acceleration above zero, so no contact to compare".to_owned(),
    };
    Err(Error::io(path, why))
}

/// Refuses the result `path` if it belongs to another impact than `scene`, whose text is `text`. Model, cells, time
/// steps and tolerances may differ.
///
/// # Errors
/// [`Error::Io`] with the keys that differ.
pub fn check_same_impact(path: &Path, scene: &Scene, text: &str) -> Result<()> {
    let Provenance { origin, folder, .. } = read::provenance(path)?;
    let (mut other, _) = Scene::within(&path.display().to_string(), Path::new(&folder), &origin.scene, &[])?;
    let Body { composition, temperature, geometry, .. } = other.body;
    let geometry = match (geometry, &scene.body.geometry) {
        (Geometry::Box { size, .. }, Geometry::Box { size: same, .. }) if size == *same => scene.body.geometry.clone(),
        // A mesh file may be a finer mesh of the same body.
        (Geometry::Gmsh(_), Geometry::Gmsh(_)) => scene.body.geometry.clone(),
        (geometry, _) => geometry,
    };
    other.body = Body { composition, temperature, geometry, ..scene.body.clone() };
    let same = Scene {
        body: other.body,
        supports: other.supports,
        impactor: other.impactor,
        load: other.load,
        ..scene.clone()
    };
    if same == *scene {
        return Ok(());
    }
    let of_impact = [
        "body.young",
        "body.poisson",
        "body.density",
        "body.layer",
        "body.temperature",
        "material",
        "body.size",
        "body.mesh",
        "support",
        "impactor",
        "load",
        "contact.law",
        "contact.stiffness",
        "contact.exponent",
        "contact.table",
        "contact.damping",
    ];
    let mut keys = differences(&origin.scene, text);
    keys.retain(|key| of_impact.iter().any(|start| key.starts_with(start)));
    Err(Error::io(path, format!("is of another impact: other values of {}", keys.join(", "))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<Vec<Foreign>> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("half.csv"), "time,acceleration\n0,0\n1,2\n2,0\n").unwrap();
        std::fs::write(folder.path().join("short.csv"), "time,acceleration\n0,2\n").unwrap();
        std::fs::write(folder.path().join("flat.csv"), "time,acceleration\n0,0\n1,0\n").unwrap();
        std::fs::write(folder.path().join("back.csv"), "time,acceleration\n0,0\n1,2\n1,0\n").unwrap();
        let path = folder.path().join("peers.csv");
        std::fs::write(&path, text).unwrap();
        foreign(&path, 3.0)
    }

    #[test]
    fn errors_and_series_are_read() {
        let all = table("name,setting,seconds,error\nA,\"coarse, 3\",2.5,0.01\n").unwrap();
        assert_eq!((all[0].name.as_str(), all[0].setting.as_str(), all[0].seconds), ("A", "coarse, 3", [0.0, 2.5]));
        let Found::Errors(errors) = all[0].found else { panic!("{all:?}") };
        assert!(errors.history.first == 0.01 && errors.history.whole.is_nan());
        let all = table("name,build,run,series\nB,1,0.5,half.csv\n").unwrap();
        let Found::History(history) = &all[0].found else { panic!("{all:?}") };
        assert_eq!((history.peak(), history.first().unwrap().impulse), (2.0, 6.0));
    }

    #[test]
    fn faults_are_told_with_their_line() {
        for (text, part) in [
            ("name,seconds\nA,1\n", "line 2: either `error`"),
            ("name,seconds,error\nA,1,0.1\nB,,0.1\n", "line 3: either `seconds`"),
            ("name,seconds,error\nA,-1,0.1\n", "positive"),
            ("name,seconds,error\nA,fast,0.1\n", "invalid"),
            ("name,seconds,fault\nA,1,0.1\n", "fault"),
            ("name,seconds,series\nA,1,none.csv\n", "none.csv"),
            ("name,seconds,series\nA,1,short.csv\n", "line 2: "),
            ("name,seconds,series\nA,1,short.csv\n", "short.csv: has 1 rows"),
            ("name,seconds,series\nA,1,flat.csv\n", "flat.csv: has no acceleration above zero"),
            ("name,seconds,series\nA,1,back.csv\n", "line 4: times are to ascend"),
        ] {
            let error = table(text).unwrap_err();
            assert_eq!(error.status(), 4);
            assert!(error.to_string().contains(part), "{text}: {error}");
        }
    }
}
