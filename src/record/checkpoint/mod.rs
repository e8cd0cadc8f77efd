//! Checkpoints on the disk: the state from which a run is continued, in the folder of its result.
//!
//! A checkpoint is written to a temporary file, which replaces the last checkpoint when it is complete. So there is a
//! complete one at any moment. Values are stored by node, and nodes are identified by their positions, so a run
//! can be continued on any number of ranks. A digest follows the content written by HDF5, so that a truncated or
//! altered file is detected.

mod nodes;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use hdf5_metno as hdf5;

use crate::error::{Error, Result};
use crate::impact::checkpoint::Checkpoint;
use crate::record::columns::not_written;
use crate::record::provenance::digest;
use crate::record::storage::{self, long_text, words, write_long_text, write_scalar, write_words};
use crate::record::target;
use crate::scene::Vec3;

use nodes::Nodes;

/// Content of a checkpoint: the state of a run, its scene, and the nodes of its vectors.
pub struct StoredCheckpoint {
    /// Full text of the scene.
    pub scene: String,
    /// `run_id` of the result of the run.
    pub run_id: u64,
    /// Time of the state, s.
    pub time: f64,
    /// Positions of the nodes, m, in the order of the values of the vectors, with three unknowns for each node; empty
    /// for a body without nodes.
    pub nodes: Vec<Vec3>,
    /// All values of all ranks.
    pub checkpoint: Checkpoint,
}

/// Ending of the name of a checkpoint.
pub const ENDING: &str = "checkpoint.h5";

/// Path of the checkpoint of a result: `plate.checkpoint.h5` for `plate.h5`.
pub fn beside(result: &Path) -> PathBuf {
    target::companion(result, ENDING)
}

/// Whether a checkpoint of the run with this id exists in the folder of a result.
pub fn is_there(result: &Path, run_id: u64) -> bool {
    let read = || storage::open(&beside(result))?.attr("run_id")?.read_scalar::<u64>();
    beside(result).exists() && read().is_ok_and(|there| there == run_id)
}

/// Checks that a checkpoint can be written for a result: a file of another kind is neither replaced nor removed.
///
/// # Errors
/// [`Error::Io`] with the reason.
pub fn check_writable(result: &Path) -> Result<()> {
    let path = beside(result);
    let is_one = |file: hdf5::File| file.attr("run_id").is_ok() && file.dataset("names").is_ok();
    if path.exists() && !storage::open(&path).is_ok_and(is_one) {
        return Err(Error::io(&path, "is no checkpoint of a run, so it is not replaced"));
    }
    Ok(())
}

impl StoredCheckpoint {
    /// Writes the checkpoint of the result `result`, which replaces the last one.
    ///
    /// # Errors
    /// [`Error::Io`] if writing fails; the last checkpoint then remains.
    pub fn write(&self, result: &Path) -> Result<()> {
        let path = beside(result);
        let written = target::write_part(&path, |part| {
            self.write_to(part).map_err(|error| not_written(&path, &error))?;
            // The file is on the disk before it receives its final name.
            let named = sealed(part).and_then(|()| fs::rename(part, &path));
            named.and_then(|()| target::synced(target::folder(&path))).map_err(|error| Error::io(&path, error))
        });
        written.map(|_| ())
    }

    fn write_to(&self, path: &Path) -> hdf5::Result<()> {
        let file = storage::create(path)?;
        write_long_text(&file, "scene", &self.scene)?;
        write_scalar(&file, "run_id", self.run_id)?;
        write_scalar(&file, "time", self.time)?;
        let (names, numbers): (Vec<&str>, Vec<f64>) =
            self.checkpoint.numbers.iter().map(|(name, number)| (name.as_str(), *number)).unzip();
        write_words(&file, "names", names.into_iter())?;
        file.new_dataset_builder().with_data(&numbers).create("numbers")?;
        file.new_dataset_builder().with_data(self.nodes.as_flattened()).create("nodes")?;
        for (group, all) in [("vectors", &self.checkpoint.vectors), ("lists", &self.checkpoint.lists)] {
            let group = file.create_group(group)?;
            for (name, values) in all {
                group.new_dataset_builder().with_data(values).create(name.as_str())?;
            }
        }
        file.close()
    }

    /// Values for a body with nodes at `nodes`, in their order; unchanged for a body without nodes.
    ///
    /// # Errors
    /// Text with the reason why the checkpoint belongs to another body.
    pub fn at(self, nodes: Option<&[Vec3]>) -> std::result::Result<Checkpoint, String> {
        let Some(nodes) = nodes else {
            return if self.nodes.is_empty() { Ok(self.checkpoint) } else { Err("it is of a body with a mesh".into()) };
        };
        let places: Vec<usize> = if self.nodes == nodes {
            (0..nodes.len()).collect()
        } else {
            let table = Nodes::new(&self.nodes);
            let place = |x: &Vec3| {
                let [x, y, z] = *x;
                table
                    .at([x, y, z])
                    .ok_or_else(|| format!("it has no node, or more than one, at [{x:.6}, {y:.6}, {z:.6}]"))
            };
            nodes.iter().map(place).collect::<std::result::Result<_, _>>()?
        };
        let Checkpoint { vectors, numbers, lists } = self.checkpoint;
        let sort = |(name, values): (String, Vec<f64>)| {
            if values.len() != 3 * self.nodes.len() {
                return Err(format!("its {name} has {} values for {} nodes", values.len(), self.nodes.len()));
            }
            let sorted = places.iter().flat_map(|place| &values[3 * place..3 * place + 3]).copied().collect();
            Ok((name, sorted))
        };
        let vectors = vectors.into_iter().map(sort).collect::<std::result::Result<_, _>>()?;
        Ok(Checkpoint { vectors, numbers, lists })
    }

    /// Reads the checkpoint of a result; `None` if there is none.
    ///
    /// # Errors
    /// [`Error::Io`] if it cannot be read, or if it is not a checkpoint.
    pub fn read(result: &Path) -> Result<Option<Self>> {
        let path = beside(result);
        if !path.try_exists().map_err(|error| Error::io(&path, error))? {
            return Ok(None);
        }
        if !is_sealed(&path).map_err(|error| Error::io(&path, error))? {
            return Err(Error::io(&path, "is no whole checkpoint"));
        }
        let read = || {
            let file = storage::open(&path)?;
            let names = words(&file.dataset("names")?)?.ok_or("its names are no words")?;
            let numbers = names.into_iter().zip(storage::read::<f64>(&file, "numbers")?).collect();
            let all = |group: &str| {
                let group = file.group(group)?;
                let values = |name: String| Ok((name.clone(), storage::read::<f64>(&group, &name)?));
                group.member_names()?.into_iter().map(values).collect::<hdf5::Result<_>>()
            };
            let flat = storage::read::<f64>(&file, "nodes")?;
            Ok(Self {
                scene: long_text(&file, "scene")?,
                run_id: file.attr("run_id")?.read_scalar()?,
                time: file.attr("time")?.read_scalar()?,
                nodes: flat.as_chunks().0.to_vec(),
                checkpoint: Checkpoint { numbers, vectors: all("vectors")?, lists: all("lists")? },
            })
        };
        read().map(Some).map_err(|error: hdf5::Error| {
            Error::io(
                &path,
                format!("is no checkpoint of this version: {}", error.to_string().lines().next().unwrap_or_default()),
            )
        })
    }
}

/// Marker before the digest at the end of a file.
const SEAL: [u8; 8] = *b"ricochet";

/// Appends the digest of a file to it, and forces the file onto the disk.
fn sealed(path: &Path) -> io::Result<()> {
    let digest = digest(&fs::read(path)?).to_le_bytes();
    let mut file = fs::OpenOptions::new().append(true).open(path)?;
    file.write_all([SEAL, digest].as_flattened())?;
    file.sync_all()
}

/// Whether a file ends with the correct digest.
fn is_sealed(path: &Path) -> io::Result<bool> {
    let bytes = fs::read(path)?;
    let Some((content, end)) = bytes.split_at_checked(bytes.len().saturating_sub(16)) else { return Ok(false) };
    Ok(end == [SEAL, digest(content).to_le_bytes()].as_flattened())
}

/// Removes the checkpoint of a result: if it belongs to another run, or if the run is complete.
///
/// # Errors
/// [`Error::Io`] if there is a checkpoint and it cannot be removed.
pub fn remove(result: &Path) -> Result<()> {
    let path = beside(result);
    match fs::remove_file(&path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Error::io(&path, error)),
        _ => Ok(()),
    }
}
