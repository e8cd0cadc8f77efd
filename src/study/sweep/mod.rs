//! A scene with some of its keys varied: every member an impact of its own, on one rank alone.

mod bodies;
mod by_body;
mod census;
mod digest;
mod family;
mod grid;
mod member;
mod shard;
mod spread;
mod vary;

pub use bodies::Bodies;
pub use census::{Census, Property};
pub use digest::{Task, digest};
pub use grid::Grid;
pub use member::{Computed, simulate};
pub use shard::{Shard, parts};
pub use spread::{Compute, Kept, spread};
pub use vary::{Variation, written};
