//! The keys of a scene and the types of their values, before any check of a value. The names of the fields are the
//! known keys.

use serde::Deserialize;

use super::values::{ByComponent, List, Number, Three, Whole, WordOrWhole};

/// The root table.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct Scene {
    pub title: Option<String>,
    pub body: Body,
    #[serde(default)]
    pub support: List<Support>,
    pub impactor: Impactor,
    #[serde(default)]
    pub contact: Contact,
    #[serde(default)]
    pub load: Load,
    pub time: Time,
    #[serde(default)]
    pub accuracy: Accuracy,
    #[serde(default)]
    pub solver: Solver,
    #[serde(default)]
    pub output: Output,
}

/// `[body]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with the header [body]")]
pub(super) struct Body {
    pub model: Option<String>,
    pub reduction: Option<WordOrWhole>,
    pub young: Number,
    pub poisson: Number,
    pub density: Number,
    pub size: Option<Three<Number>>,
    pub cells: Option<Three<Whole>>,
    pub grading: Option<ByComponent>,
    pub mesh: Option<String>,
    pub order: Option<Whole>,
    pub symmetry: Option<String>,
}

/// One `[[support]]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with the header [[support]]")]
pub(super) struct Support {
    pub surface: String,
    pub kind: String,
    pub stiffness: Option<ByComponent>,
    pub damping: Option<ByComponent>,
    pub displacement: Option<Three<Number>>,
    pub components: Option<List<String>>,
    pub normal: Option<Three<Number>>,
}

/// `[impactor]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with the header [impactor]")]
pub(super) struct Impactor {
    pub mass: Number,
    pub radius: Number,
    pub young: Option<Number>,
    pub poisson: Option<Number>,
    pub stiffness: Option<Number>,
    pub speed: Number,
    pub point: Option<Three<Number>>,
    pub direction: Option<Three<Number>>,
    pub gap: Option<Number>,
}

/// `[contact]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with the header [contact]")]
pub(super) struct Contact {
    pub localization: Option<String>,
    pub patch_radius: Option<Number>,
}

/// `[load]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with the header [load]")]
pub(super) struct Load {
    pub body_force: Option<Three<Number>>,
    #[serde(default)]
    pub traction: List<Traction>,
}

/// One `[[load.traction]]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with the header [[load.traction]]")]
pub(super) struct Traction {
    pub surface: String,
    pub value: Three<Number>,
}

/// `[time]`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with the header [time]")]
pub(super) struct Time {
    pub end: Number,
    pub step: Option<Number>,
    pub scheme: Option<String>,
    pub beta: Option<Number>,
    pub gamma: Option<Number>,
    pub rho_inf: Option<Number>,
    pub allow_unstable: Option<bool>,
}

/// `[accuracy]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with the header [accuracy]")]
pub(super) struct Accuracy {
    pub tolerance: Option<Number>,
}

/// `[solver]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with the header [solver]")]
pub(super) struct Solver {
    pub newton: Option<String>,
    pub energy_gate: Option<Number>,
}

/// `[output]`
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table with the header [output]")]
pub(super) struct Output {
    pub every: Option<Whole>,
    pub checkpoint_steps: Option<Whole>,
    pub checkpoint_minutes: Option<Number>,
    pub fields: Option<Whole>,
    #[serde(default)]
    pub probes: List<Probe>,
}

/// One entry of `output.probes`
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table, as { name = \"bottom\", point = [0, 0, -0.05] }")]
pub(super) struct Probe {
    pub name: String,
    pub point: Three<Number>,
}
