//! What the user wrote: parsed, checked, in SI units. Plain data that every constructor may read.
//!
//! The text's way: [`Source`] (overrides applied) → `raw` (typed) → `check` (checked) → [`Scene`].

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
mod locate;
mod output;
mod overrides;
mod raw;
mod source;
mod strength;
mod suggest;
mod units;
mod values;

use std::path::Path;

use crate::contact::ForceLaw;
use crate::form;

pub use composition::{Composition, Layer, Parts};
pub use differences::differences;
pub use doubts::{Doubt, doubts};
pub use error::SceneError;
pub(crate) use faces::faces;
pub use fault::Fault;
pub use impactor::Impactor;
pub use output::{Measure, Output, Probe};
pub use source::Source;
pub use strength::Strength;
pub use units::unit;

/// A JSON schema of a scene, by which editors check one while it is typed.
pub fn schema() -> schemars::Schema {
    schemars::schema_for!(raw::Scene)
}

/// A vector with one value per Cartesian component.
pub type Vec3 = [f64; 3];

/// Standard acceleration of gravity, m/s², against z (ISO 80000-3).
pub const STANDARD_GRAVITY: f64 = 9.80665;

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

/// The elastic body: theory, material, geometry, elements.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// What is taken into account.
    pub model: Model,
    /// What is made of a linear body before it is stepped.
    pub reduction: Reduction,
    /// What it is made of, relaxation times being those at its temperature.
    pub composition: Composition,
    /// Its temperature, °C; `None` where relaxation times are taken as they are given.
    pub temperature: Option<f64>,
    /// Where the mesh comes from.
    pub geometry: Geometry,
    /// Polynomial degree of the elements: 1 or 2.
    pub order: usize,
    /// What part of it is solved.
    pub symmetry: Symmetry,
}

impl Body {
    /// The elastic constants at t → 0, and the density, of what is hit.
    pub fn struck(&self) -> form::Material {
        self.composition.struck
    }

    /// The largest Young's modulus of its materials, Pa.
    pub fn stiffest(&self) -> f64 {
        self.composition.materials().iter().map(|material| material.instantaneous.young).fold(0.0, f64::max)
    }

    /// Mass of a box, kg; `None` for a mesh file.
    pub fn mass(&self) -> Option<f64> {
        let Geometry::Box { size, .. } = &self.geometry else { return None };
        Some(self.composition.density()? * size.iter().product::<f64>())
    }

    /// The thickness that a hit along z, or against it, meets first, m: that of the layer that is hit where the layers differ. `thickness` is
    /// that of the whole.
    pub fn struck_thickness(&self, thickness: f64) -> f64 {
        match (&self.composition.parts, self.composition.uniform()) {
            (Parts::Layers(layers), None) => layers[self.composition.struck_layer].thickness.min(thickness),
            _ => thickness,
        }
    }
}

/// What a body's theory takes into account, the least first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Model {
    /// The least that the scene's tolerance allows.
    Auto,
    /// Its dent alone, which Hertz's law holds.
    HalfSpace,
    /// Bending waves without echoes (Zener 1941).
    InfinitePlate,
    /// Bending of a thin plate.
    Kirchhoff,
    /// Bending with shear and rotary inertia (Reissner 1945, Mindlin 1951).
    Mindlin,
    /// Elasticity in three dimensions.
    Solid,
}

/// What is made of a linear body before it is stepped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reduction {
    /// A Krylov basis as large as the tolerance asks for where the scheme is modal, otherwise nothing.
    Auto,
    /// Nothing.
    None,
    /// A Krylov basis of so many vectors.
    Vectors(usize),
}

/// What part of the body is solved.
#[derive(Debug, Clone, PartialEq)]
pub enum Symmetry {
    /// The whole.
    None {
        /// Why it was not cut, where a cut was to be made if possible.
        reason: Option<String>,
    },
    /// The part of a box where the coordinates of both axes are positive. The planes where one of them is zero are planes of
    /// symmetry of the whole scene.
    Quarter {
        /// The axes normal to those planes, ascending.
        axes: [usize; 2],
    },
    /// The whole. The body, its supports and its loads are symmetric about planes that the impact is not symmetric about: of splines, the
    /// motion is the sum of symmetric and antisymmetric ones, each of them that of a part.
    Parts {
        /// The axes normal to the planes, ascending: one or two.
        axes: Vec<usize>,
        /// Why the impact is not symmetric.
        reason: String,
    },
}

/// Where the mesh comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// A box centred on the origin, cut into hexahedra.
    Box {
        /// Edge lengths, m.
        size: Vec3,
        /// Coordinates of the grid planes across each axis, m, ascending from −size/2 to size/2; the cells lie between them.
        planes: [Vec<f64>; 3],
        /// Whether the scene gives cells or their order.
        is_given: bool,
    },
    /// A Gmsh file (2.2 or 4.1), surfaces by physical name; relative to the scene file.
    Gmsh(std::path::PathBuf),
}

/// A term on one named surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Support {
    /// Name of the surface: of a box, or a physical name of the mesh file.
    pub surface: String,
    /// The part of it that is held; all of it where this is left out.
    pub within: Option<Within>,
    /// What holds the body there.
    pub kind: SupportKind,
    /// Damping c of (13), N s/m³ by component.
    pub damping: Vec3,
    /// Prescribed displacement ū, m.
    pub displacement: Vec3,
}

/// A part of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Within {
    /// Strips of a width (m) along all edges of the faces of a box.
    Rim(f64),
    /// What lies in a box, given by its least and largest coordinates, m.
    Box([Vec3; 2]),
    /// What lies in a ball.
    Ball {
        /// Its centre, m.
        centre: Vec3,
        /// Its radius, m.
        radius: f64,
    },
}

impl Within {
    /// The shortest extent of what it has of a surface, m: of a box's, along its faces and within these; of a mesh's, as it is given.
    pub fn width(&self, geometry: &Geometry, surface: &str) -> f64 {
        let (size, along): (Vec3, Vec<usize>) = match geometry {
            Geometry::Box { size, .. } => {
                let along = |axis: &usize| faces::faces(surface).iter().any(|(across, _)| across != axis);
                (*size, (0..3).filter(along).collect())
            }
            Geometry::Gmsh(_) => ([f64::INFINITY; 3], vec![0, 1, 2]),
        };
        let shortest =
            |extent: &dyn Fn(usize) -> f64| along.iter().map(|axis| extent(*axis)).fold(f64::INFINITY, f64::min);
        match self {
            Self::Rim(width) => shortest(&|i| width.min(0.5 * size[i])),
            Self::Box([low, high]) => shortest(&|i| high[i].min(0.5 * size[i]) - low[i].max(-0.5 * size[i])),
            Self::Ball { radius, .. } => *radius,
        }
    }

    /// Whether it has as much of a body of a thickness (m) on either side of the middle plane across an axis.
    pub fn is_even(&self, axis: usize, thickness: f64) -> bool {
        let half = 0.5 * thickness;
        match self {
            Self::Rim(_) => true,
            Self::Box([low, high]) => low[axis].max(-half) == -high[axis].min(half),
            Self::Ball { centre, .. } => centre[axis] == 0.0,
        }
    }
}

impl Load {
    /// What acts on a part of a density (kg/m³), N/m³.
    pub fn force_on(&self, density: f64) -> Vec3 {
        [0, 1, 2].map(|i| self.body_force[i] + density * self.gravity[i])
    }

    /// Whether a force acts on the body's volume along an axis.
    pub fn acts_along(&self, axis: usize) -> bool {
        self.body_force[axis] != 0.0 || self.gravity[axis] != 0.0
    }
}

impl Support {
    /// Whether it acts on a part of a side that is not even across the thickness along an axis of a body, and in other directions than
    /// along that axis: then bending and stretching are coupled. A pad that acts in such directions lets go of one half of a bent side.
    pub fn couples_stretching(&self, axis: usize, thickness: f64) -> bool {
        let is_even = self.within.is_none_or(|within| within.is_even(axis, thickness));
        let acts = |values: Vec3| (0..3).any(|i| i != axis && values[i] != 0.0);
        let holds = match self.kind {
            SupportKind::Pad { normal, .. } if acts(normal) => return true,
            SupportKind::Pad { .. } => false,
            SupportKind::Elastic { stiffness } => acts(stiffness),
            SupportKind::Clamped { components } => (0..3).any(|i| i != axis && components[i]),
        };
        !is_even && (holds || acts(self.damping))
    }
}

/// What holds the body on a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum SupportKind {
    /// Springs in both directions, (11).
    Elastic {
        /// k, N/m³ by component.
        stiffness: Vec3,
    },
    /// Springs that only push back, (12).
    Pad {
        /// k, N/m³ by component.
        stiffness: Vec3,
        /// Unit vector into the pad: each component of u that points into it is resisted.
        normal: Vec3,
    },
    /// Held components, (2).
    Clamped {
        /// Which components are held.
        components: [bool; 3],
    },
}

/// How the contact's force reaches the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Contact {
    /// Hertz's pressure over a disc.
    Patch {
        /// r_p, m; chosen on the mesh where it is left out.
        radius: Option<f64>,
    },
    /// A force at one point, the paper's.
    Point,
}

/// Forces other than the contact's, constant from t = 0 on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Load {
    /// b of (1) without the body's weight, N/m³.
    pub body_force: Vec3,
    /// Acceleration of gravity, m/s²: of the density ρ of each part the force ρ g is added to b.
    pub gravity: Vec3,
    /// f of (3) on named surfaces.
    pub traction: Vec<Traction>,
}

/// A constant traction on a named surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Traction {
    /// Name of the surface.
    pub surface: String,
    /// The part of it that is loaded; all of it where this is left out.
    pub within: Option<Within>,
    /// f, N/m².
    pub value: Vec3,
}

/// How long, and in which steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Time {
    /// End of the run, s.
    pub end: f64,
    /// Step Δt, s; controlled by the error where it is left out.
    pub step: Option<f64>,
    /// How the body is at t = 0.
    pub initial: Initial,
    /// Whether the body moves in modal coordinates, exactly in its linear part.
    pub modal: bool,
    /// How a step is taken otherwise.
    pub scheme: Scheme,
}

/// How the body is at t = 0: at rest in either case.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Initial {
    /// Undeformed.
    Rest,
    /// Deformed by its loads.
    Equilibrium,
}

/// How a step is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scheme {
    /// Newmark (1959).
    Newmark {
        /// β, in (0, 1].
        beta: f64,
        /// γ, in [0, 1].
        gamma: f64,
    },
    /// Generalised-α (Chung & Hulbert 1993).
    GeneralizedAlpha {
        /// Spectral radius at infinite frequency ρ∞, in [0, 1].
        rho_inf: f64,
    },
    /// Midpoint rule with discrete gradients, energy-conserving (Gonzalez 2000).
    Energy,
    /// Explicit, with lumped mass.
    CentralDifference {
        /// Whether a step above the stable one is taken all the same.
        allow_unstable: bool,
    },
}

/// How a step is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Solver {
    /// Which Newton's method.
    pub newton: Newton,
    /// The part of the initial energy that the balance may be off by before the run is stopped.
    pub energy_gate: Option<f64>,
}

/// Which Newton's method solves an implicit step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Newton {
    /// One linear solve and a scalar equation.
    Condensed,
    /// All unknowns and the block aaᵀ, as in the paper.
    Full,
}
