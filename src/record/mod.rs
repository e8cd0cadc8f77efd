//! Writing and reading of results: HDF5 files.

pub mod checkpoint;
mod columns;
pub mod episodes;
pub mod extremes;
pub mod fields;
pub mod folder;
pub mod lock;
mod probes;
pub mod provenance;
pub mod quantity;
pub mod read;
pub mod series;
mod storage;
pub mod stress;
pub mod sweep;
pub mod target;
pub mod useless;
