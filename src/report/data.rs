//! What a report is made of: everything that it reads of a result.

use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use crate::error::Result;
use crate::record::extremes::{Extremes, extremes};
use crate::record::provenance::{Cost, Provenance};
use crate::record::quantity::{Quantity, quantity};
use crate::record::read::{Contacts, episodes, origin};
use crate::record::stress::{StressMaps, Stresses};
use crate::scene::{Scene, Strength};

/// A result.
pub struct Data {
    /// Where it is.
    path: PathBuf,
    /// Its file's name.
    pub file: String,
    /// When the file was last written, s since 1970.
    pub written: Option<u64>,
    /// Where it comes from.
    pub provenance: Provenance,
    /// What it has cost, and its estimated error.
    pub cost: Cost,
    /// Whether the run came to its end.
    pub is_complete: bool,
    /// The scene; or why this version of the program cannot read it.
    pub scene: std::result::Result<Scene, String>,
    /// What the material stands.
    pub strength: Strength,
    /// The contacts.
    pub contacts: Contacts,
    /// The largest values; `None` without a row.
    pub extremes: Option<Extremes>,
    /// Contact force, N.
    pub force: Series,
    /// Displacement of the surface under the impactor, m.
    pub deflection: Series,
    /// Of the impactor, m/s.
    pub velocity: Series,
    /// Of the impactor, m.
    pub position: Series,
    /// All energies, J.
    pub energies: Quantity,
    /// The largest stresses on the faces; `None` where the run has none.
    pub stresses: Option<Stresses>,
    /// The maps of them over time.
    pub stress_maps: Option<StressMaps>,
}

/// A number in each row.
#[derive(Debug)]
pub struct Series {
    /// s.
    pub time: Vec<f64>,
    /// One a row.
    pub values: Vec<f64>,
}

impl Data {
    /// Reads a result.
    ///
    /// # Errors
    /// [`crate::Error::Io`] as [`crate::record::read::history`].
    pub fn read(path: &Path) -> Result<Self> {
        let (provenance, cost, is_complete) = origin(path)?;
        let series = |name: &str| -> Result<Series> {
            let Quantity { time, parts, .. } = quantity(path, name)?;
            Ok(Series { time, values: parts.into_iter().next().map(|part| part.values).unwrap_or_default() })
        };
        let scene = Scene::within(&path.display().to_string(), Path::new(&provenance.folder), &provenance.scene, &[]);
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

    /// What the report is called.
    pub fn title(&self) -> String {
        match self.provenance.title.trim() {
            "" => self.file.clone(),
            title => title.to_owned(),
        }
    }

    /// What a probe has read, by the name of the dataset.
    ///
    /// # Errors
    /// [`crate::Error::Io`] where it cannot be read.
    pub fn probe(&self, name: &str, what: &str) -> Result<Quantity> {
        quantity(&self.path, &format!("probe/{name}/{what}"))
    }

    /// The last recorded time, s.
    pub fn end(&self) -> f64 {
        self.force.time.last().copied().unwrap_or_default()
    }

    /// Start and end of each contact, s.
    pub fn touches(&self) -> Vec<(f64, f64)> {
        self.contacts.episodes.iter().map(|episode| (episode.start, episode.end)).collect()
    }
}
