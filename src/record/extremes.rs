//! Largest values of the series of a result.

use std::path::Path;

use hdf5_metno as hdf5;
use serde::Serialize;

use crate::error::{Error, Result};
use crate::record::read::open;
use crate::record::storage;
use crate::record::stress::{Largest, LargestTension, StressMaps, Stresses, TensionExtreme};

/// Value of a series and its time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Extreme {
    /// Value, in the unit of its series.
    pub value: f64,
    /// Time, s.
    pub time: f64,
}

/// Largest values of a run. The force and the tensions on faces include all steps, the other values only the recorded
/// rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Extremes {
    /// Largest deceleration F/m0 of the impactor, m/s².
    pub acceleration: Extreme,
    /// Largest contact force, N.
    pub force: Extreme,
    /// Displacement of the surface under the impactor with the largest magnitude, signed, m.
    pub deflection: Extreme,
    /// Largest tension on the faces; `None` if no stresses were read.
    pub tension: Option<TensionExtreme>,
    /// Largest tension on each face, from the struck face down.
    pub faces: Vec<Largest>,
    /// Largest values at each probe, in the order of the names of the probes.
    pub probes: Vec<ProbeExtremes>,
}

/// Largest values at a probe in the recorded rows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProbeExtremes {
    /// Name of the probe.
    pub name: String,
    /// Magnitude of the displacement, m.
    pub displacement: Extreme,
    /// Magnitude of the velocity, m/s.
    pub velocity: Extreme,
    /// Largest principal stress, Pa; tension is positive.
    pub tension: Extreme,
}

/// Reads the largest values of the result `path`; `None` if it has no row yet.
///
/// # Errors
/// Same as [`super::read::history`]; [`Error::Io`] if a series cannot be read.
pub fn extremes(path: &Path) -> Result<Option<Extremes>> {
    let maps = StressMaps::read(path)?;
    let faces = Stresses::read(path)?.map_or_else(Vec::new, |stresses| stresses.peaks(maps.as_ref()));
    let file = open(path)?;
    of(&file, faces).map_err(|error| Error::io(path, format!("its series cannot be read: {error}")))
}

fn of(file: &hdf5::File, faces: Vec<Largest>) -> hdf5::Result<Option<Extremes>> {
    let column = |name: &str| storage::read::<f64>(file, &format!("series/{name}"));
    let time = column("time")?;
    let largest = |values: &[f64], size: fn(f64) -> f64| {
        let rows = time.iter().zip(values).filter(|(_, value)| !value.is_nan());
        // Of equal values, the first.
        rows.reduce(|one, other| if size(*other.1) > size(*one.1) { other } else { one })
            .map_or(Extreme { value: f64::NAN, time: f64::NAN }, |(time, value)| Extreme { value: *value, time: *time })
    };
    if time.is_empty() {
        return Ok(None);
    }
    let mut probes = Vec::new();
    if let Ok(group) = file.group("series/probe") {
        for name in group.member_names()? {
            let of_rows = |what: &str, of_row: fn(&[f64]) -> f64| -> hdf5::Result<Extreme> {
                let values = column(&format!("probe/{name}/{what}"))?;
                let values: Vec<f64> = values.chunks_exact(3).map(of_row).collect();
                Ok(largest(&values, |value| value))
            };
            let length = |row: &[f64]| row.iter().map(|x| x * x).sum::<f64>().sqrt();
            probes.push(ProbeExtremes {
                displacement: of_rows("displacement", length)?,
                velocity: of_rows("velocity", length)?,
                tension: of_rows("principal_stress", |row| row.iter().copied().fold(f64::NEG_INFINITY, f64::max))?,
                name,
            });
        }
    }
    // Contact episodes have their peaks from all steps, recorded or not.
    let of_contacts = |name: &str| storage::read::<f64>(file, &format!("contacts/{name}"));
    let peaks = of_contacts("peak_force")?.into_iter().zip(of_contacts("peak_time")?);
    let peaks = peaks.map(|(value, time)| Extreme { value, time });
    let of_rows = largest(&column("contact/force")?, |value| value);
    Ok(Some(Extremes {
        acceleration: largest(&column("impactor/acceleration")?, |value| value),
        force: peaks.chain([of_rows]).max_by(|one, other| one.value.total_cmp(&other.value)).unwrap_or(of_rows),
        deflection: largest(&column("contact/surface_displacement")?, f64::abs),
        tension: LargestTension::read(file).filter(|tension| !tension.largest.value.is_nan()),
        faces,
        probes,
    }))
}
