//! The scene that the user wrote: parsed, checked, in SI units. Plain data that all other modules may read.
//!
//! The text is processed in this order: [`Source`] (overrides applied) → `raw` (typed) → `check` (checked) → [`Scene`].

mod body;
mod check;
mod composition;
mod decode;
mod differences;
mod elsewhere;
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
use crate::form::ContactArea;

pub use body::{Body, Geometry, Model, Reduction, Symmetry};
pub use check::one_digit;
pub(crate) use check::{HOT, in_celsius, show};
pub use composition::{Composition, Layer, Parts};
pub use differences::differences;
pub use error::SceneError;
pub(crate) use faces::faces;
pub use fault::Fault;
pub use impactor::Impactor;
pub use load::{Load, Traction};
pub use output::{Measure, Output, Probe, is_name_of_result};
pub use source::Source;
pub use strength::{Strength, face_names};
pub use support::{CLEAR_OF_SUPPORTS, Support, SupportKind, Within, leave_free};
pub use time::{Initial, Newton, Scheme, Solver, Time};
pub use units::unit;

/// JSON schema of a scene. Editors use it to check a scene while it is typed.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(raw::Scene)
}

/// A vector with one value per Cartesian component.
pub type Vec3 = [f64; 3];

/// Standard acceleration of gravity, m/s² (ISO 80000-3).
pub const STANDARD_GRAVITY: f64 = 9.80665;

/// Ratio of Young's moduli, to the stiffest layer, below which a layer is soft. In a soft layer, shear across the faces
/// is a large part of the stress.
const SOFT: f64 = 0.1;

/// Distance of the impact point from a clamped edge, divided by the thickness, within which the tension at that edge may
/// be the largest. Plates give up to 1.9 times less tension there than solids, and at this distance about as much as
/// under the impact point.
const NEAR_CLAMPED_EDGE: f64 = 4.0;

/// A checked scene of one impact: every number is finite and in its range.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Free text, shown in figures and results.
    pub title: String,
    /// The elastic body.
    pub body: Body,
    /// Supports on named surfaces. Empty for an unsupported body.
    pub supports: Vec<Support>,
    /// The rigid impactor.
    pub impactor: Impactor,
    /// Localisation of the contact force on the body.
    pub contact: Contact,
    /// Loads other than the contact force.
    pub load: Load,
    /// Duration of the run and time integration.
    pub time: Time,
    /// Tolerance: error over its peak of the quantity in `measure`, in the first contact.
    pub tolerance: f64,
    /// Factor on the size of all cells that are chosen automatically.
    pub cell_factor: f64,
    /// Quantity to which the tolerance applies.
    pub measure: Measure,
    /// Tensile strength of the material.
    pub strength: Strength,
    /// Solution of a time step.
    pub solver: Solver,
    /// Output of the run.
    pub output: Output,
}

impl Scene {
    /// Whether the body has unilateral supports (pads).
    pub fn is_on_pads(&self) -> bool {
        self.supports.iter().any(Support::may_lift_off)
    }

    /// Whether the body is reduced to a basis.
    pub fn is_reduced(&self) -> bool {
        self.time.modal || matches!(self.body.reduction, Reduction::Vectors(_))
    }

    /// Reads and checks a scene file with `overrides`, each `KEY=VALUE` with a dotted path as the key.
    ///
    /// # Errors
    /// [`Error::Usage`](crate::Error::Usage) if the file cannot be read as text; [`Error::Scene`](crate::Error::Scene)
    /// for any error in it or in an override.
    pub fn read(path: &Path, overrides: &[String]) -> crate::Result<(Self, Source)> {
        let text = Self::text(path).map_err(crate::Error::Usage)?;
        Self::from_text(path, &text, overrides)
    }

    /// Reads the text of a scene file.
    ///
    /// # Errors
    /// If the file cannot be read, or is not text; the message has the reason.
    pub fn text(path: &Path) -> Result<String, String> {
        let shown = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|reason| format!("{shown}: the scene cannot be read: {reason}"))?;
        Self::decode(&shown, bytes)
    }

    /// Converts the bytes of a scene file to text. Messages call the file `shown`.
    ///
    /// # Errors
    /// If the bytes are not UTF-8.
    pub fn decode(shown: &str, bytes: Vec<u8>) -> Result<String, String> {
        String::from_utf8(bytes).map_err(|reason| {
            let good = &reason.as_bytes()[..reason.utf8_error().valid_up_to()];
            format!("{shown}: line {} is not text in UTF-8", locate::line(good, good.len()))
        })
    }

    /// The scene in the text of the file at `path`. A mesh file is relative to the folder of that file.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) for any error in the text or in an override.
    pub fn from_text(path: &Path, text: &str, overrides: &[String]) -> crate::Result<(Self, Source)> {
        Self::within(&path.display().to_string(), path.parent().unwrap_or(Path::new("")), text, overrides)
    }

    /// The scene in `text`, called `name` in messages. A mesh file is relative to `folder`.
    ///
    /// # Errors
    /// [`Error::Scene`](crate::Error::Scene) for any error in the text or in an override.
    pub fn within(name: &str, folder: &Path, text: &str, overrides: &[String]) -> crate::Result<(Self, Source)> {
        Ok(Self::checked(Source::new(name, text, overrides)?.of_folder(folder))?)
    }

    /// Axis normal to the impacted face of a box; `None` for a mesh file.
    pub fn struck_axis(&self) -> Option<usize> {
        match &self.body.geometry {
            Geometry::Box { size, .. } => Some(faces::struck_axis(*size, self.impactor.point, self.impactor.direction)),
            Geometry::Gmsh(_) => None,
        }
    }

    /// Whether a box is a free layer around the impact point: the impact is normal, and no support on the two faces across it is
    /// within a number of thicknesses (`clearance`). The distance to the edges is not checked.
    pub fn is_free_layer(&self, clearance: f64) -> bool {
        let (Geometry::Box { size, .. }, Some(axis)) = (&self.body.geometry, self.struck_axis()) else { return false };
        let Impactor { direction, point, .. } = &self.impactor;
        (direction[axis].abs() - 1.0).abs() < 1e-9 && leave_free(&self.supports, (*size, *point, axis), clearance)
    }

    /// Distance of the impact point from the nearest edge of the impacted face of a box, m; `None` for a mesh file.
    pub fn distance_to_edge(&self) -> Option<f64> {
        let (Geometry::Box { size, .. }, Some(struck)) = (&self.body.geometry, self.struck_axis()) else { return None };
        let to_edge = |axis: usize| 0.5 * size[axis] - self.impactor.point[axis].abs();
        (0..3).filter(|axis| *axis != struck).map(to_edge).min_by(f64::total_cmp)
    }

    /// Words for the quantity in `measure` that follow "error" or "difference" in a message; empty for the acceleration,
    /// which is the default. With clamped edges the largest tension may be there, where its error is not estimated.
    pub fn of_measure(&self) -> &'static str {
        match self.measure {
            Measure::Acceleration => "",
            Measure::Stress if self.clamps_sections() => " of the tension under the impact point",
            Measure::Stress => " of the largest tension",
            Measure::Deflection => " of the deflection (or of the acceleration in the first contact, if larger)",
        }
    }

    /// Words for the part of the time history to which the tolerance applies; empty if [`Self::of_measure`] has them.
    pub fn in_measured_part(&self) -> &'static str {
        match self.measure {
            Measure::Acceleration | Measure::Stress => " in the first contact",
            Measure::Deflection => "",
        }
    }

    /// Whether a support clamps displacements in the plane of the plate.
    pub fn clamps_sections(&self) -> bool {
        self.struck_axis().is_some_and(|struck| self.supports.iter().any(|support| support.clamps_sections(struck)))
    }

    /// Whether a support is on the impacted face of a box or on the face opposite.
    pub fn has_support_across(&self) -> bool {
        let is_across = |surface: &str| faces(surface).iter().any(|(axis, _)| Some(*axis) == self.struck_axis());
        self.supports.iter().any(|support| is_across(&support.surface))
    }

    /// Whether a point of a plate is within half a thickness of an edge with clamped in-plane displacements. Stresses
    /// of a solid are singular there.
    pub fn is_at_clamped_edge(&self, point: Vec3) -> bool {
        self.thicknesses_to_clamped_edge(point).is_some_and(|distance| distance <= 0.5)
    }

    /// Distance of the impact point from the nearest edge with clamped in-plane displacements, divided by the thickness,
    /// if it is so small that the tension at that edge may be the largest even if the model finds a larger one elsewhere.
    /// In solids, the tension at a clamped edge grows as cells get smaller.
    pub fn hit_near_clamped_edge(&self) -> Option<f64> {
        self.thicknesses_to_clamped_edge(self.impactor.point).filter(|distance| *distance <= NEAR_CLAMPED_EDGE)
    }

    /// Distance of a point of a plate from the nearest edge with clamped in-plane displacements, divided by the
    /// thickness; `None` without such an edge.
    fn thicknesses_to_clamped_edge(&self, point: Vec3) -> Option<f64> {
        let (Geometry::Box { size, .. }, Some(struck)) = (&self.body.geometry, self.struck_axis()) else { return None };
        let clamps = self.supports.iter().filter(|support| support.clamps_sections(struck));
        let edges = clamps.flat_map(|support| faces::faces(&support.surface)).filter(|(axis, _)| *axis != struck);
        let distance = |(axis, is_upper): &faces::Face| {
            let along = if *is_upper { point[*axis] } else { -point[*axis] };
            (0.5 * size[*axis] - along) / size[struck]
        };
        edges.map(distance).min_by(f64::total_cmp)
    }

    /// Coordinates z of the faces of all layers of a box that is hit across its layers, m, ascending. Empty if a side
    /// is hit, and for one elastic material.
    pub fn hit_layers(&self) -> Vec<f64> {
        match self.struck_axis() {
            Some(2) => self.body.composition.interfaces(),
            _ => Vec::new(),
        }
    }

    /// Whether each of these layers is soft compared with the stiffest, starting at the impacted face. The stress in
    /// soft layers is mostly shear.
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

    /// Points of a file for `contact.table`, written as a TOML array. An array is returned as given.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn table_in_file(source: &Source, file: &str) -> Result<String, SceneError> {
        if file.trim_start().starts_with('[') {
            return Ok(file.to_owned());
        }
        check::table_in_file(source, file.trim_matches('"'))
    }

    /// The scene of `source` with the `values` of one member of a sweep, each `KEY=VALUE`.
    ///
    /// # Errors
    /// If a value is wrong, or the scene with the values.
    pub fn varied(source: &Source, values: &[String]) -> Result<(Self, Source), SceneError> {
        Self::checked(source.varied(values)?)
    }

    /// The scene in `text`, called `name` in messages. A mesh file is relative to the current folder.
    ///
    /// # Errors
    /// If anything in the text or in an override is wrong.
    pub fn parse(name: &str, text: &str, overrides: &[String]) -> Result<(Self, Source), SceneError> {
        Self::checked(Source::new(name, text, overrides)?)
    }

    /// Checks a source. In the returned source, the files of the contact table and of the relaxation terms are replaced
    /// by their contents, so that it is all that is needed to repeat the run.
    ///
    /// # Errors
    /// If anything in the source is wrong.
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

/// Localisation of the contact force on the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Contact {
    /// Hertz's pressure over a disc.
    Patch {
        /// Radius r_p of the patch, m; `None`: chosen by the mesh.
        radius: Option<f64>,
        /// Radius of the wider disc on which plates and spline solids carry the pressure, m; `None`: chosen by the
        /// theory.
        disc: Option<f64>,
    },
    /// Pressure on a given area, for other laws than Hertz's: α is the impactor's path less the mean displacement of the surface,
    /// weighted by the pressure.
    Area(ContactArea),
    /// A force at one point, as in the paper.
    Point,
}

impl Contact {
    /// The given area, if there is one.
    pub fn area(&self) -> Option<&ContactArea> {
        if let Self::Area(area) = self { Some(area) } else { None }
    }
}
