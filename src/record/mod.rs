//! What is written of a run, and what is read back: HDF5 files.

pub mod checkpoint;
mod columns;
pub mod episodes;
pub mod folder;
pub mod lock;
pub mod provenance;
pub mod read;
pub mod series;
pub mod sweep;
pub mod target;
