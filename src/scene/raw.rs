//! The keys of a scene and the types of their values, before any check of a value. The names of the fields are the
//! known keys; their comments are the descriptions of the JSON schema (`ricochet schema`).

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Deserialize;

use super::values::{
    ByComponent, Edges, FileOrPoints, FileOrTerms, List, Number, SurfacePoint, Three, Whole, WordOrWhole,
};

/// Values of `body.model`. In this list and the next ones, the first value is the default.
pub(super) const MODELS: [&str; 7] =
    ["auto", "half-space", "infinite-plate", "kirchhoff", "mindlin", "layerwise", "solid"];
/// Values of `body.symmetry`.
pub(super) const SYMMETRIES: [&str; 3] = ["auto", "none", "quarter"];
/// Values of `support.kind`, which has no default.
pub(super) const KINDS: [&str; 3] = ["elastic", "pad", "clamped"];
/// Values of `contact.pressure`.
pub(super) const PRESSURES: [&str; 2] = ["even", "hertz"];
/// Values of `contact.localization`.
pub(super) const LOCALIZATIONS: [&str; 2] = ["patch", "point"];
/// Values of `contact.law`.
pub(super) const LAWS: [&str; 3] = ["hertz", "power", "table"];
/// Values of `time.initial`.
pub(super) const INITIALS: [&str; 2] = ["rest", "equilibrium"];
/// Values of `time.scheme`. The first is the default for bodies without modes.
pub(super) const SCHEMES: [&str; 5] = ["newmark", "generalized-alpha", "energy", "central-difference", "modal"];
/// Values of `accuracy.quantity`.
pub(super) const QUANTITIES: [&str; 3] = ["acceleration", "stress", "deflection"];
/// Values of `solver.newton`.
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
    /// Accuracy for which the model, the basis and the time steps are chosen.
    #[serde(default)]
    pub accuracy: Accuracy,
    /// Tensile strength of the material.
    #[serde(default)]
    pub strength: Strength,
    /// Solution of a time step.
    #[serde(default)]
    pub solver: Solver,
    /// Output of the run.
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
    /// "auto" (default), "none", or the number of basis vectors.
    pub reduction: Option<WordOrWhole>,
    /// Young's modulus, Pa; or give materials.
    pub young: Option<Number>,
    /// Poisson's ratio, between -1 and 0.5; or give materials.
    pub poisson: Option<Number>,
    /// Density, kg/m3; or give materials.
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
    /// Thickness, m.
    pub thickness: Number,
    /// Name of the material.
    pub material: String,
}

/// One `[material.NAME]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with a header like [material.glass]")]
pub(super) struct Material {
    /// Young's modulus, Pa; or `shear`.
    pub young: Option<Number>,
    /// Poisson's ratio at t = 0, between -1 and 0.5; or `bulk`.
    pub poisson: Option<Number>,
    /// Density, kg/m3.
    pub density: Number,
    /// Bulk modulus, Pa, with `shear`.
    pub bulk: Option<Number>,
    /// Shear modulus, Pa; of a viscoelastic material the equilibrium modulus, after all relaxation.
    pub shear: Option<Number>,
    /// Terms G exp(-t/tau) of shear relaxation: list of { modulus, time }, or file with columns time (s), modulus (Pa).
    pub prony: Option<FileOrTerms>,
    /// Williams-Landel-Ferry shift of all relaxation times to `body.temperature`.
    pub wlf: Option<Wlf>,
}

/// One entry of `material.NAME.prony`
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table, as { modulus = 1e6, time = 1e-3 }")]
pub(super) struct Term {
    /// Modulus of the term, Pa.
    pub modulus: Number,
    /// Relaxation time, s.
    pub time: Number,
}

/// `wlf` of a `[material.NAME]`
#[derive(Debug, Clone, Copy, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table, as { c1 = 17.44, c2 = 51.6, reference = 20.0 }")]
pub(super) struct Wlf {
    /// Constant C1.
    pub c1: Number,
    /// Constant C2, K.
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
    /// The part of the surface that is supported; default all of it.
    pub within: Option<Within>,
    /// "elastic" (springs), "pad" (one-sided) or "clamped".
    #[schemars(extend("enum" = KINDS))]
    pub kind: String,
    /// Stiffness, N/m3, one number or [kx, ky, kz].
    pub stiffness: Option<ByComponent>,
    /// Damping, N s/m3, one number or [cx, cy, cz]; default 0.
    pub damping: Option<ByComponent>,
    /// Prescribed displacement, m; default [0, 0, 0].
    pub displacement: Option<Three<Number>>,
    /// Clamped only: which of "x", "y", "z" are constrained; default all.
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
    /// The part inside a box: its corners with the smallest and the largest coordinates, m.
    #[serde(rename = "box")]
    pub corners: Option<List<Three<Number>>>,
    /// The part inside a ball.
    pub disc: Option<Disc>,
}

/// A ball, which cuts a disc out of a plane surface.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table, as { centre = [0.2, 0.2, -0.005], radius = 0.03 }")]
pub(super) struct Disc {
    /// Centre of the ball, m.
    pub centre: Three<Number>,
    /// Radius of the ball, m.
    pub radius: Number,
}

/// `[impactor]`
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [impactor]")]
pub(super) struct Impactor {
    /// Mass, kg.
    pub mass: Number,
    /// Radius of the rounded end, m; contact laws other than "hertz" do not need it.
    pub radius: Option<Number>,
    /// Young's modulus, Pa; or `stiffness`.
    pub young: Option<Number>,
    /// Poisson's ratio; or `stiffness`.
    pub poisson: Option<Number>,
    /// Hertz's k0, N/m^1.5, in place of the moduli.
    pub stiffness: Option<Number>,
    /// Speed along `direction` at t = 0, m/s; or `drop_height`.
    pub speed: Option<Number>,
    /// Height of a free fall from rest in place of `speed`, m.
    pub drop_height: Option<Number>,
    /// Whether the impactor's weight acts on it along z during the run; default false.
    pub gravity: Option<bool>,
    /// Impact point on the surface of the body, m: three coordinates, or the two along the face of a box that is hit.
    pub point: Option<SurfacePoint>,
    /// Direction of travel, into the body; default [0, 0, -1].
    pub direction: Option<Three<Number>>,
    /// Distance to the surface at t = 0, m; default 0.
    pub gap: Option<Number>,
}

/// `contact.area`: one of `square` and `radius`.
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table as { square = 0.2 } or { radius = 0.1 }")]
pub(super) struct Area {
    /// Side of a square with sides along the axes of the face, m.
    pub square: Option<Number>,
    /// Radius of a disc, m.
    pub radius: Option<Number>,
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
    /// Power and table only: the area of the surface on which the contact presses; by default chosen.
    pub area: Option<Area>,
    /// Pressure on the area: "even" (default), or "hertz" on a disc.
    #[schemars(extend("enum" = PRESSURES))]
    pub pressure: Option<String>,
    /// "hertz" (default), "power" or "table".
    #[schemars(extend("enum" = LAWS))]
    pub law: Option<String>,
    /// Power only: stiffness, N/m^exponent.
    pub stiffness: Option<Number>,
    /// Power only: exponent, 1 or more.
    pub exponent: Option<Number>,
    /// Table only: a file with columns indentation (m) and force (N), relative to the scene; or the points themselves.
    pub table: Option<FileOrPoints>,
    /// Hunt and Crossley's factor 1 + damping * rate of indentation, s/m; default 0.
    pub damping: Option<Number>,
    /// Name of the impacted material, for a mesh file with several.
    pub material: Option<String>,
}

/// `[load]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [load]")]
pub(super) struct Load {
    /// Force per volume, N/m3; default [0, 0, 0].
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
    /// Traction, N/m2.
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
    /// Time integration; by default "modal" if the body has modes, else "newmark".
    #[schemars(extend("enum" = SCHEMES))]
    pub scheme: Option<String>,
    /// Newmark only; default 0.25.
    pub beta: Option<Number>,
    /// Newmark only; default 0.5.
    pub gamma: Option<Number>,
    /// Generalised-alpha only: spectral radius at infinite frequency, 0 to 1; default 0.8.
    pub rho_inf: Option<Number>,
    /// Central difference only: accept a step above the stability limit; default false.
    pub allow_unstable: Option<bool>,
}

/// `[accuracy]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [accuracy]")]
pub(super) struct Accuracy {
    /// Largest error of the quantity over its peak, 1e-6 to 0.5; default 1e-2.
    pub tolerance: Option<Number>,
    /// "acceleration" (default); "stress": the largest tension; "deflection": the acceleration, and the deflection in
    /// the whole run.
    #[schemars(extend("enum" = QUANTITIES))]
    pub quantity: Option<String>,
}

/// `[strength]`
#[derive(Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "a table with the header [strength]")]
pub(super) struct Strength {
    /// Strength of every face without an entry in `face`, Pa.
    pub tension: Option<Number>,
    /// Strength of single faces by name ("upper", "lower", or a surface of the mesh), Pa.
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
    /// Whether the largest tension on each face is computed; default true, except with central differences.
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
    /// Position in the body or on its surface, m.
    pub point: Three<Number>,
}
