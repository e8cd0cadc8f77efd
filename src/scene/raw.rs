//! The keys of a scene and the types of their values, before any check of a value. The names of the fields are the
//! known keys; their comments are the descriptions of the JSON schema (`ricochet schema`).

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::values::{ByComponent, Edges, FileOrPoints, FileOrTerms, List, Number, Three, Whole, WordOrWhole};

/// Words of `body.model`.
pub(super) const MODELS: [&str; 7] =
    ["auto", "half-space", "infinite-plate", "kirchhoff", "mindlin", "layerwise", "solid"];
/// Words of `body.symmetry`.
pub(super) const SYMMETRIES: [&str; 3] = ["auto", "none", "quarter"];
/// Words of `support.kind`.
pub(super) const KINDS: [&str; 3] = ["elastic", "pad", "clamped"];
/// Words of `contact.localization`.
pub(super) const LOCALIZATIONS: [&str; 2] = ["patch", "point"];
/// Words of `contact.law`.
pub(super) const LAWS: [&str; 3] = ["hertz", "power", "table"];
/// Words of `time.initial`.
pub(super) const INITIALS: [&str; 2] = ["rest", "equilibrium"];
/// Words of `time.scheme`.
pub(super) const SCHEMES: [&str; 5] = ["newmark", "generalized-alpha", "energy", "central-difference", "modal"];
/// Words of `accuracy.quantity`.
pub(super) const QUANTITIES: [&str; 2] = ["acceleration", "stress"];
/// Words of `solver.newton`.
pub(super) const NEWTONS: [&str; 2] = ["condensed", "full"];

/// The root table.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct Scene {
    /// Shown in figures and results.
    pub title: Option<String>,
    /// The body: material and geometry.
    pub body: Body,
    /// Materials of layers, or of the physical volumes of a mesh, by name.
    #[serde(default)]
    pub material: BTreeMap<String, Material>,
    /// Supports; none means a free body.
    #[serde(default)]
    pub support: List<Support>,
    /// The rigid impactor.
    pub impactor: Impactor,
    /// The contact.
    #[serde(default)]
    pub contact: Contact,
    /// Loads on the body.
    #[serde(default)]
    pub load: Load,
    /// Time and its integration.
    pub time: Time,
    /// What the model, the basis and the steps are chosen for.
    #[serde(default)]
    pub accuracy: Accuracy,
    /// The tension that the material bears.
    #[serde(default)]
    pub strength: Strength,
    /// How a step is solved.
    #[serde(default)]
    pub solver: Solver,
    /// What is recorded.
    #[serde(default)]
    pub output: Output,
}

/// `[body]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [body]")]
pub(super) struct Body {
    /// Theory; default "auto".
    #[schemars(extend("enum" = MODELS))]
    pub model: Option<String>,
    /// "auto" (default), "none", or the number of vectors of a basis.
    pub reduction: Option<WordOrWhole>,
    /// Young's modulus, Pa; or materials.
    pub young: Option<Number>,
    /// Poisson's ratio, between -1 and 0.5; or materials.
    pub poisson: Option<Number>,
    /// Density, kg/m3; or materials.
    pub density: Option<Number>,
    /// Temperature, degrees Celsius, to which materials with `wlf` are shifted.
    pub temperature: Option<Number>,
    /// Edges of a box centred on the origin, m: three, or with layers the two along these; or `mesh`.
    pub size: Option<Edges>,
    /// Layers of a box from the top down.
    #[serde(default)]
    pub layer: List<Layer>,
    /// Hexahedra along each edge of the box; by default chosen for the accuracy.
    pub cells: Option<Three<Whole>>,
    /// Largest cell edge over the smallest along each axis of the box; default 1.
    pub grading: Option<ByComponent>,
    /// Gmsh file (2.2 or 4.1), relative to the scene; or `size`.
    pub mesh: Option<String>,
    /// Polynomial degree of the elements, 1 or 2 (default).
    pub order: Option<Whole>,
    /// Quarter-symmetry model; default "auto".
    #[schemars(extend("enum" = SYMMETRIES))]
    pub symmetry: Option<String>,
}

/// One `[[body.layer]]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [[body.layer]]")]
pub(super) struct Layer {
    /// m.
    pub thickness: Number,
    /// Name of its material.
    pub material: String,
}

/// One `[material.NAME]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with a header like [material.glass]")]
pub(super) struct Material {
    /// Young's modulus, Pa; or `shear`.
    pub young: Option<Number>,
    /// Poisson's ratio, between -1 and 0.5, of the moduli at once; or `bulk`.
    pub poisson: Option<Number>,
    /// Density, kg/m3.
    pub density: Number,
    /// Bulk modulus, Pa, with `shear`.
    pub bulk: Option<Number>,
    /// Shear modulus, Pa: what is left of it after all relaxation.
    pub shear: Option<Number>,
    /// Terms G exp(-t/tau) of the relaxation of shear: a list of { modulus, time }, or a file with columns time (s) and modulus (Pa).
    pub prony: Option<FileOrTerms>,
    /// Williams, Landel and Ferry's shift of all times, by `body.temperature`.
    pub wlf: Option<Wlf>,
}

/// One entry of `material.NAME.prony`
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table, as { modulus = 1e6, time = 1e-3 }")]
pub(super) struct Term {
    /// Pa.
    pub modulus: Number,
    /// s.
    pub time: Number,
}

/// `wlf` of a `[material.NAME]`
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table, as { c1 = 17.44, c2 = 51.6, reference = 20.0 }")]
pub(super) struct Wlf {
    /// C1.
    pub c1: Number,
    /// C2, K.
    pub c2: Number,
    /// Temperature at which the relaxation times are given, degrees Celsius.
    pub reference: Number,
}

/// One `[[support]]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [[support]]")]
pub(super) struct Support {
    /// Name of the surface: "side", "top", "bottom", "x-min" ... "z-max" of a box, or a physical surface of the mesh.
    pub surface: String,
    /// The part of the surface that is held; default all of it.
    pub within: Option<Within>,
    /// "elastic" (springs), "pad" (one-sided) or "clamped".
    #[schemars(extend("enum" = KINDS))]
    pub kind: String,
    /// N/m3, one number or [kx, ky, kz].
    pub stiffness: Option<ByComponent>,
    /// N s/m3, one number or [cx, cy, cz]; default 0.
    pub damping: Option<ByComponent>,
    /// Prescribed displacement, m; default [0, 0, 0].
    pub displacement: Option<Three<Number>>,
    /// Clamped only: which of "x", "y", "z" are held; default all.
    pub components: Option<List<String>>,
    /// Pad only: the direction into the pad.
    pub normal: Option<Three<Number>>,
}

/// A part of a surface: one of its keys.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table, as { rim = 0.02 }")]
pub(super) struct Within {
    /// Strips of this width along all edges of a box's faces, m.
    pub rim: Option<Number>,
    /// What lies in a box: its corners with the least and the largest coordinates, m.
    #[serde(rename = "box")]
    pub corners: Option<List<Three<Number>>>,
    /// What lies in a ball.
    pub disc: Option<Disc>,
}

/// A ball, which cuts a disc out of a plane surface.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table, as { centre = [0.2, 0.2, -0.005], radius = 0.03 }")]
pub(super) struct Disc {
    /// m.
    pub centre: Three<Number>,
    /// m.
    pub radius: Number,
}

/// `[impactor]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [impactor]")]
pub(super) struct Impactor {
    /// kg.
    pub mass: Number,
    /// m; laws of contact other than "hertz" need none.
    pub radius: Option<Number>,
    /// Young's modulus, Pa; or `stiffness`.
    pub young: Option<Number>,
    /// Poisson's ratio; or `stiffness`.
    pub poisson: Option<Number>,
    /// Hertz's k0, N/m^1.5, in place of radius and moduli.
    pub stiffness: Option<Number>,
    /// m/s along `direction` at t = 0; or `drop_height`.
    pub speed: Option<Number>,
    /// Height of a free fall from rest in place of `speed`, m.
    pub drop_height: Option<Number>,
    /// Whether the impactor's weight acts on it along z during the run; default false.
    pub gravity: Option<bool>,
    /// Where it hits, on the surface of the body, m.
    pub point: Option<Three<Number>>,
    /// Direction of travel, into the body; default [0, 0, -1].
    pub direction: Option<Three<Number>>,
    /// Distance to the surface at t = 0, m; default 0.
    pub gap: Option<Number>,
}

/// `[contact]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [contact]")]
pub(super) struct Contact {
    /// "patch" (default): Hertz's pressure over a disc; "point": a force at a point.
    #[schemars(extend("enum" = LOCALIZATIONS))]
    pub localization: Option<String>,
    /// Radius of the patch, m; by default chosen.
    pub patch_radius: Option<Number>,
    /// Radius of the disc on which plates and spline solids spread the force, m; by default about two thicknesses.
    pub disc_radius: Option<Number>,
    /// "hertz" (default), "power" or "table".
    #[schemars(extend("enum" = LAWS))]
    pub law: Option<String>,
    /// Power only: N/m^exponent.
    pub stiffness: Option<Number>,
    /// Power only: 1 or more.
    pub exponent: Option<Number>,
    /// Table only: a file with columns indentation (m) and force (N), relative to the scene; or the points themselves.
    pub table: Option<FileOrPoints>,
    /// Hunt and Crossley's factor 1 + damping * rate of indentation, s/m; default 0.
    pub damping: Option<Number>,
    /// Name of the material that is hit, of a mesh file with several.
    pub material: Option<String>,
}

/// `[load]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [load]")]
pub(super) struct Load {
    /// N/m3; default [0, 0, 0].
    pub body_force: Option<Three<Number>>,
    /// Acceleration of gravity on the body, m/s2; default [0, 0, 0].
    pub gravity: Option<Three<Number>>,
    /// Loaded surfaces.
    #[serde(default)]
    pub traction: List<Traction>,
}

/// One `[[load.traction]]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [[load.traction]]")]
pub(super) struct Traction {
    /// Name of the surface.
    pub surface: String,
    /// The part of the surface that is loaded; default all of it.
    pub within: Option<Within>,
    /// N/m2.
    pub value: Three<Number>,
}

/// `[time]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [time]")]
pub(super) struct Time {
    /// End of the run, s.
    pub end: Number,
    /// Fixed step, s; by default chosen for the accuracy.
    pub step: Option<Number>,
    /// "rest" (default): undeformed; "equilibrium": at rest under loads, supports and pads.
    #[schemars(extend("enum" = INITIALS))]
    pub initial: Option<String>,
    /// Time integration; by default "modal" where the body has modes, else "newmark".
    #[schemars(extend("enum" = SCHEMES))]
    pub scheme: Option<String>,
    /// Newmark only; default 0.25.
    pub beta: Option<Number>,
    /// Newmark only; default 0.5.
    pub gamma: Option<Number>,
    /// Generalised-alpha only: spectral radius at infinite frequency, 0 to 1; default 0.8.
    pub rho_inf: Option<Number>,
    /// Central difference only: takes a step above the stable one; default false.
    pub allow_unstable: Option<bool>,
}

/// `[accuracy]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [accuracy]")]
pub(super) struct Accuracy {
    /// Error of the quantity over its peak in the first contact, 1e-6 to 0.5; default 1e-2.
    pub tolerance: Option<Number>,
    /// "acceleration" (default), or "stress": the largest tension.
    #[schemars(extend("enum" = QUANTITIES))]
    pub quantity: Option<String>,
}

/// `[strength]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [strength]")]
pub(super) struct Strength {
    /// On every face that has none of its own, Pa.
    pub tension: Option<Number>,
    /// By the name of a face ("upper", "lower", or a surface of the mesh), Pa.
    #[serde(default)]
    pub face: BTreeMap<String, Number>,
}

/// `[solver]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [solver]")]
pub(super) struct Solver {
    /// "condensed" (default) or "full" (SNES with the block aaT).
    #[schemars(extend("enum" = NEWTONS))]
    pub newton: Option<String>,
    /// Largest error of the energy balance over the initial energy; by default none.
    pub energy_gate: Option<Number>,
}

/// `[output]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [output]")]
pub(super) struct Output {
    /// Every n-th step is recorded; default 1.
    pub every: Option<Whole>,
    /// A checkpoint after every n-th step.
    pub checkpoint_steps: Option<Whole>,
    /// Wall time between checkpoints, min; default 10, 0 for none.
    pub checkpoint_minutes: Option<Number>,
    /// Fields of every n-th step for ParaView.
    pub fields: Option<Whole>,
    /// Whether the largest tension on each face is looked for; default true.
    pub stress: Option<bool>,
    /// Points that are read at every recorded step.
    #[serde(default)]
    pub probes: List<Probe>,
}

/// One entry of `output.probes`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table, as { name = \"bottom\", point = [0, 0, -0.05] }")]
pub(super) struct Probe {
    /// The probe's name in the results.
    pub name: String,
    /// In the body or on its surface, m.
    pub point: Three<Number>,
}
