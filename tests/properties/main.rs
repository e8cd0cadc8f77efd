//! What needs no PETSc: elements, integrals, scenes, files of results. Properties of random cases, exact values.

#[path = "../common/bad_scenes.rs"]
mod bad_scenes;
#[path = "../common/sample.rs"]
mod sample;

mod elements;
mod forms;
mod plates;
mod scene {
    mod boxes;
    mod errors;
    mod random;
    mod values;
}
mod series;
mod surfaces;
