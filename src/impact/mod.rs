//! One impact: body, impactor and contact law in time.

pub mod step;
