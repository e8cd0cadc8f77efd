//! Runs a scene with some of its keys varied: every member is a separate impact, computed on one rank.

mod bodies;
mod by_body;
mod digest;
mod family;
mod grid;
mod grouping;
mod member;
mod scheduler;
mod shard;
mod vary;

pub use bodies::Bodies;
pub use digest::{Task, digest};
pub use grid::Grid;
pub use grouping::{Found, Grouping, Property};
pub use member::{Computed, simulate};
pub use scheduler::{Compute, Kept, schedule};
pub use shard::{Shard, parts};
pub use vary::{Variation, written};
