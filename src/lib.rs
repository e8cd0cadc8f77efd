//! ricochet: low-velocity impact on elastic plates and bodies.
//!
//! Data flow: [`scene`] → [`description`] → [`space`] (a [`mesh`], splines or a plate, by [`form`] on [`element`]) →
//! [`body`] → [`impact`] (with [`contact`] and [`scheme`]) → steps → [`record`].

pub mod agree;
pub mod body;
pub mod cli;
pub mod contact;
pub mod description;
pub mod element;
pub mod error;
pub mod figure;
pub mod form;
pub mod impact;
pub mod material;
pub mod mesh;
pub mod model;
pub mod record;
pub mod report;
pub mod scene;
pub mod scheme;
pub mod solve;
pub mod space;
pub mod stack;
pub mod study;

pub use error::{Error, Result};
