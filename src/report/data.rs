//! Reads all data of a result that a report needs.

use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use crate::error::{Result, visible};
use crate::record::extremes::{Extremes, extremes};
use crate::record::provenance::{Cost, Provenance};
use crate::record::quantity::{Quantity, quantity};
use crate::record::read::{Contacts, episodes, origin};
use crate::record::stress::{StressMaps, Stresses};
use crate::scene::{Scene, Strength};

/// The data of a result.
pub struct Data {
    /// Path of the result file.
    path: PathBuf,
    /// Name of the result file.
    pub file: String,
    /// Time at which the file was last written, s since 1970; `None` if unknown.
    pub written: Option<u64>,
    /// Origin of the result.
    pub provenance: Provenance,
    /// Cost and estimated error of the run.
    pub cost: Cost,
    /// Whether the run reached its end.
    pub is_complete: bool,
    /// The scene, or the reason why this version of the program cannot read it.
    pub scene: std::result::Result<Scene, String>,
    /// Strengths of the faces given in the scene.
    pub strength: Strength,
    /// The contact episodes.
    pub contacts: Contacts,
    /// The largest values over time; `None` if the result has no rows.
    pub extremes: Option<Extremes>,
    /// Contact force, N.
    pub force: Series,
    /// Displacement of the surface under the impactor, m.
    pub deflection: Series,
    /// Velocity of the impactor, m/s.
    pub velocity: Series,
    /// Position of the impactor, m.
    pub position: Series,
    /// All energies, J.
    pub energies: Quantity,
    /// The largest stresses on the faces; `None` if the run recorded none.
    pub stresses: Option<Stresses>,
    /// Maps of the largest tension over time on the faces; `None` if the run recorded none.
    pub stress_maps: Option<StressMaps>,
}

/// A scalar time history.
#[derive(Debug)]
pub struct Series {
    /// Time of each row, s.
    pub time: Vec<f64>,
    /// Value in each row.
    pub values: Vec<f64>,
}

impl Data {
    /// Reads the data of a result.
    ///
    /// # Errors
    /// Same as [`crate::record::read::history`].
    pub fn read(path: &Path) -> Result<Self> {
        let (provenance, cost, is_complete) = origin(path)?;
        let series = |name: &str| -> Result<Series> {
            let Quantity { time, parts, .. } = quantity(path, name)?;
            Ok(Series { time, values: parts.into_iter().next().map(|part| part.values).unwrap_or_default() })
        };
        let scene =
            Scene::within(&path.display().to_string(), Path::new(&provenance.folder), &provenance.origin.scene, &[]);
        let written = std::fs::metadata(path).and_then(|file| file.modified()).ok();
        Ok(Self {
            path: path.to_owned(),
            file: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            written: written.and_then(|time| time.duration_since(UNIX_EPOCH).ok()).map(|time| time.as_secs()),
            strength: scene.as_ref().map_or_else(|_| Strength::default(), |(scene, _)| scene.strength.clone()),
            scene: scene.map(|(scene, _)| scene).map_err(|error| error.to_string()),
            contacts: episodes(path)?,
            extremes: extremes(path)?,
            force: series("force")?,
            deflection: series("deflection")?,
            velocity: series("velocity")?,
            position: series("position")?,
            energies: quantity(path, "energy")?,
            stresses: Stresses::read(path)?,
            stress_maps: StressMaps::read(path)?,
            provenance,
            cost,
            is_complete,
        })
    }

    /// Title of the report: the title of the scene, or the name of the file if the scene has none.
    pub fn title(&self) -> String {
        let title = self.provenance.origin.title.trim();
        visible(if title.is_empty() { &self.file } else { title })
    }

    /// Reads the dataset `what` of the probe `name`.
    ///
    /// # Errors
    /// [`crate::Error::Io`] if it cannot be read.
    pub fn probe(&self, name: &str, what: &str) -> Result<Quantity> {
        quantity(&self.path, &format!("probe/{name}/{what}"))
    }

    /// The last recorded time, s.
    pub fn end(&self) -> f64 {
        self.force.time.last().copied().unwrap_or_default()
    }
}
