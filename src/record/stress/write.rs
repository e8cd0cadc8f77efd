//! Writes the largest tension on each face, row by row: `/series/stress/<face>/{largest, point}` and
//! `/series/stress/ring`.

use hdf5_metno as hdf5;

use crate::record::columns::{new_rows, put, put_vectors};
use crate::record::storage;
use crate::space::evaluate::FaceTension;

use super::Faces;

/// Group of all datasets of this module.
const GROUP: &str = "series/stress";

/// Datasets of all faces in their order, and the dataset of the ring tension.
pub(in crate::record) struct TensionDatasets {
    faces: Vec<[hdf5::Dataset; 2]>,
    ring: Option<hdf5::Dataset>,
}

impl TensionDatasets {
    /// Creates empty, extensible datasets; `chunk` is the number of rows in a chunk.
    pub fn new(file: &hdf5::File, of: &Faces, chunk: usize) -> hdf5::Result<Self> {
        let dataset = |name: &str, columns: Option<usize>, units: &str| {
            new_rows::<f64>(file, &format!("{GROUP}/{name}"), units, columns, chunk)
        };
        let face = |name: &String| {
            Ok([dataset(&format!("{name}/largest"), None, "Pa")?, dataset(&format!("{name}/point"), Some(3), "m")?])
        };
        Ok(Self {
            faces: of.names.iter().map(face).collect::<hdf5::Result<_>>()?,
            ring: of.ring.as_ref().map(|_| dataset("ring", None, "Pa")).transpose()?,
        })
    }

    /// Writes rows, each with the tension of every face, from the row `first` on, and cuts the datasets after them.
    pub fn append(&self, first: usize, rows: &[Vec<FaceTension>], ring: &[f64]) -> hdf5::Result<()> {
        for (number, [largest, point]) in self.faces.iter().enumerate() {
            let at = |row: &Vec<FaceTension>| row.get(number).copied().unwrap_or(FaceTension::UNKNOWN);
            put(largest, first, &rows.iter().map(|row| at(row).largest).collect::<Vec<f64>>())?;
            put_vectors(point, first, &rows.iter().map(|row| at(row).point).collect::<Vec<_>>())?;
        }
        self.ring.as_ref().map_or(Ok(()), |dataset| put(dataset, first, ring))
    }
}

/// Stresses in the first rows of a result.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EarlierTensions {
    /// Largest tension on every face, for each row.
    pub faces: Vec<Vec<FaceTension>>,
    /// Tension at the edge of the contact for each row; `None` if it is not recorded.
    pub ring: Option<Vec<f64>>,
}

/// First `rows` rows of a result, each with the tension of every face of `names`.
pub(in crate::record) fn rows(file: &hdf5::File, names: &[String], rows: usize) -> hdf5::Result<Vec<Vec<FaceTension>>> {
    let mut all = vec![Vec::with_capacity(names.len()); rows];
    for name in names {
        let column = |of: &str| storage::read::<f64>(file, &format!("{GROUP}/{name}/{of}"));
        let (largest, points) = (column("largest")?, column("point")?);
        if largest.len() < rows || points.len() < 3 * rows {
            return Err(format!("/{GROUP}/{name} has {} rows, and its checkpoint {rows}", largest.len()).into());
        }
        for ((row, largest), point) in all.iter_mut().zip(largest).zip(points.as_chunks().0) {
            row.push(FaceTension { largest, point: *point });
        }
    }
    Ok(all)
}
