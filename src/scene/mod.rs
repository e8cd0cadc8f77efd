//! What the user wrote: parsed, checked, in SI units. Plain data that every constructor may read.
//!
//! The text's way: [`Source`] (overrides applied) → `raw` (typed) → `check` (checked) → [`Scene`].

mod body;
mod check;
mod composition;
mod decode;
mod differences;
mod doubts;
mod error;
pub(crate) mod faces;
mod fault;
mod grammar;
mod impactor;
mod layout;
mod load;
mod locate;
mod output;
mod overrides;
mod raw;
mod source;
mod strength;
mod suggest;
mod support;
mod time;
mod units;
mod values;

use std::path::Path;

use crate::contact::ForceLaw;

pub use body::{Body, Geometry, Model, Reduction, Symmetry};
pub use composition::{Composition, Layer, Parts};
pub use differences::differences;
pub use doubts::{Doubt, doubts};
pub use error::SceneError;
pub(crate) use faces::faces;
pub use fault::Fault;
pub use impactor::Impactor;
pub use load::{Load, Traction};
pub use output::{Measure, Output, Probe};
pub use source::Source;
pub use strength::{Strength, face_names};
pub use support::{Support, SupportKind, Within};
pub use time::{Initial, Newton, Scheme, Solver, Time};
pub use units::unit;

/// A JSON schema of a scene, by which editors check one while it is typed.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(raw::Scene)
}

/// A vector with one value per Cartesian component.
pub type Vec3 = [f64; 3];

/// Standard acceleration of gravity, m/s², against z (ISO 80000-3).
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// Young's modulus over that of the stiffest layer below which a layer is soft: shear across its faces is a good part of their stress.
const SOFT: f64 = 0.1;

/// One impact, checked: every number finite and in its range.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Free text, shown in figures and results.
    pub title: String,
    /// The elastic body.
    pub body: Body,
    /// Terms on named surfaces; none means a free body.
    pub supports: Vec<Support>,
    /// The rigid body that hits.
    pub impactor: Impactor,
    /// How the contact's force reaches the body.
    pub contact: Contact,
    /// Forces other than the contact's.
    pub load: Load,
    /// How long, and in which steps.
    pub time: Time,
    /// Error of the acceleration history over its peak that error-controlled steps aim at.
    pub tolerance: f64,
    /// What that is the error of.
    pub measure: Measure,
    /// The tension that the material bears.
    pub strength: Strength,
    /// How a step is solved.
    pub solver: Solver,
    /// What is written.
    pub output: Output,
}

impl Scene {
    /// Whether a support only pushes back.
    pub fn is_on_pads(&self) -> bool {
        self.supports.iter().any(|support| matches!(support.kind, SupportKind::Pad { .. }))
    }

    /// Whether the body moves on a basis.
    pub fn is_reduced(&self) -> bool {
        self.time.modal || matches!(self.body.reduction, Reduction::Vectors(_))
    }

    /// Reads and checks a scene file after `overrides`, each `KEY=VALUE` with a dotted path for the key.
    ///
    /// # Errors
    /// [`Error::Usage`](crate::Error::Usage) for a file that cannot be read as text;
    /// [`Error::Scene`](crate::Error::Scene) for everything that is wrong in it or in an override.
    pub fn read(path: &Path, overrides: &[String]) -> crate::Result<(Self, Source)> {
        let text = Self::text(path).map_err(crate::Error::Usage)?;
        Self::from_text(path, &text, overrides)
    }

    /// The text of a scene file.
    ///
    /// # Errors
    /// Why the file cannot be read as text.
    pub fn text(path: &Path) -> Result<String, String> {
        let shown = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|reason| format!("{shown}: the scene cannot be read: {reason}"))?;
        Self::decode(&shown, bytes)
    }

    /// The text in the bytes of a scene's file, which messages call `shown`.
    ///
    /// # Errors
    /// Where they are not text.
    pub fn decode(shown: &str, bytes: Vec<u8>) -> Result<String, String> {
        String::from_utf8(bytes).map_err(|reason| {
            let good = &reason.as_bytes()[..reason.utf8_error().valid_up_to()];
            format!("{shown}: line {} is not text in UTF-8", locate::line(good, good.len()))
        })
    }

    /// The scene in the text of the file at `path`; a mesh file is relative to that file's folder.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) for everything that is wrong in the text or in an override.
    pub fn from_text(path: &Path, text: &str, overrides: &[String]) -> crate::Result<(Self, Source)> {
        Self::within(&path.display().to_string(), path.parent().unwrap_or(Path::new("")), text, overrides)
    }

    /// The scene in `text`, called `name` in messages; a mesh file is relative to `folder`.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) for everything that is wrong in the text or in an override.
    pub fn within(name: &str, folder: &Path, text: &str, overrides: &[String]) -> crate::Result<(Self, Source)> {
        Ok(Self::checked(Source::new(name, text, overrides)?.of_folder(folder))?)
    }

    /// The axis across the face of a box that is hit; `None` for a mesh file.
    pub fn struck_axis(&self) -> Option<usize> {
        match &self.body.geometry {
            Geometry::Box { size, .. } => Some(faces::struck_axis(*size, self.impactor.point, self.impactor.direction)),
            Geometry::Gmsh(_) => None,
        }
    }

    /// How far the nearest edge of the face of a box that is hit is from the impact point, m; `None` for a mesh file.
    pub fn distance_to_edge(&self) -> Option<f64> {
        let (Geometry::Box { size, .. }, Some(struck)) = (&self.body.geometry, self.struck_axis()) else { return None };
        let to_edge = |axis: usize| 0.5 * size[axis] - self.impactor.point[axis].abs();
        (0..3).filter(|axis| *axis != struck).map(to_edge).min_by(f64::total_cmp)
    }

    /// Whether a support clamps displacements along a plate.
    pub fn clamps_sections(&self) -> bool {
        self.struck_axis().is_some_and(|struck| self.supports.iter().any(|support| support.clamps_sections(struck)))
    }

    /// Whether a point of a plate is within half its thickness of an edge whose sections are clamped: in a solid stresses have no limit there.
    pub fn is_at_clamped_edge(&self, point: Vec3) -> bool {
        let (Geometry::Box { size, .. }, Some(struck)) = (&self.body.geometry, self.struck_axis()) else {
            return false;
        };
        let is_near = |(axis, is_upper): &faces::Face| {
            let along = if *is_upper { point[*axis] } else { -point[*axis] };
            *axis != struck && 0.5 * size[*axis] - along <= 0.5 * size[struck]
        };
        let clamps = self.supports.iter().filter(|support| support.clamps_sections(struck));
        clamps.flat_map(|support| faces::faces(&support.surface)).any(is_near)
    }

    /// Heights along z where the layers of a box end that is hit across them, ascending, m; empty where they do not differ, or are hit along.
    pub fn hit_layers(&self) -> Vec<f64> {
        match self.struck_axis() {
            Some(2) => self.body.composition.interfaces(),
            _ => Vec::new(),
        }
    }

    /// Which of these layers are soft beside the stiffest, from the hit down: their stress is shear for the most part.
    pub fn soft_layers(&self) -> Vec<bool> {
        let Parts::Layers(layers) = &self.body.composition.parts else { return Vec::new() };
        if self.hit_layers().is_empty() {
            return Vec::new();
        }
        let limit = SOFT * self.body.stiffest();
        let mut soft: Vec<bool> = layers.iter().map(|layer| layer.material.instantaneous.young < limit).collect();
        if self.impactor.point[2] < 0.0 {
            soft.reverse();
        }
        soft
    }

    /// The points of a file for `contact.table`, as a scene has them in its text; an array is taken as it is.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn table_in_file(source: &Source, file: &str) -> Result<String, SceneError> {
        if file.trim_start().starts_with('[') {
            return Ok(file.to_owned());
        }
        check::table_in_file(source, file.trim_matches('"'))
    }

    /// The scene of `source`, with `values` (each `KEY=VALUE`) of a sweep written into it.
    ///
    /// # Errors
    /// Everything that is wrong in the values, or in the scene with them.
    pub fn varied(source: &Source, values: &[String]) -> Result<(Self, Source), SceneError> {
        Self::checked(source.varied(values)?)
    }

    /// The scene in `text`, called `name` in messages; a mesh file is relative to the current folder.
    ///
    /// # Errors
    /// Everything that is wrong in the text or in an override.
    pub fn parse(name: &str, text: &str, overrides: &[String]) -> Result<(Self, Source), SceneError> {
        Self::checked(Source::new(name, text, overrides)?)
    }

    /// The scene of a source, which gets the points of the table of the contact's law, and the terms of relaxation, in the place of their
    /// files: then it is all that is needed to repeat the run.
    ///
    /// # Errors
    /// Everything that is wrong in it.
    pub fn checked(source: Source) -> Result<(Self, Source), SceneError> {
        let scene = check::scene(&source, source.folder())?;
        let source = match &scene.impactor.force_law {
            ForceLaw::Table(table) => source.with_table(&table.points()),
            _ => source,
        };
        let source = check::with_series(source)?;
        Ok((scene, source))
    }
}

/// How the contact's force reaches the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Contact {
    /// Hertz's pressure over a disc.
    Patch {
        /// r_p, m; chosen on the mesh where it is left out.
        radius: Option<f64>,
        /// Radius of the wider disc on which plates and spline solids carry it, m; by their rule where it is left out.
        disc: Option<f64>,
    },
    /// A force at one point, the paper's.
    Point,
}
