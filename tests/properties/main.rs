//! Tests without PETSc: elements, integrals, scenes, result files. They check properties of random cases, and exact
//! values.

#[path = "../common/bad_scenes.rs"]
mod bad_scenes;
#[path = "../common/sample.rs"]
mod sample;
#[path = "../common/stresses.rs"]
mod stresses;
#[path = "../common/texts.rs"]
mod texts;

mod constants;
mod elements;
mod forms;
mod layerwise_plates;
mod local_bodies;
mod local_field;
mod local_layers;
mod map;
mod plate_symmetry;
mod plates;
mod plot;
mod scene {
    mod boxes;
    mod doubts;
    mod errors;
    mod hits;
    mod layers;
    mod random;
    mod schema;
    mod values;
}
mod series;
mod stack;
mod static_plates;
mod stress;
mod surfaces;

use std::sync::{Mutex, MutexGuard, PoisonError};

/// Lets one test run at a time: a process started by one test inherits the files, and their locks, that another test
/// has open.
pub fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}
