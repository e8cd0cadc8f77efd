//! Lists the methods that apply to a scene, and the settings of each from coarse to fine.

use crate::scene::{Contact, Geometry, Scene};

/// A method of computing a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Method {
    /// Words joined by `/`: the theory, then the differences from the default.
    pub name: String,
    /// Overrides `KEY=VALUE` of the cleared scene for each setting, from coarse to fine.
    pub rungs: Vec<Vec<String>>,
    /// Assumed wall time of the coarsest setting, s, before any run has been timed.
    pub guess: f64,
}

/// Keys that define how a scene is computed, not the physical problem.
const NUMERICAL: [&str; 15] = [
    "body.model",
    "body.reduction",
    "body.symmetry",
    "time.step",
    "time.scheme",
    "time.beta",
    "time.gamma",
    "time.rho_inf",
    "time.allow_unstable",
    "accuracy.tolerance",
    "solver.newton",
    "solver.energy_gate",
    "output.every",
    "output.fields",
    "output.probes",
];

/// Keys of the cells, which are numerical settings too.
const CELLS: [&str; 3] = ["body.cells", "body.grading", "body.order"];

/// Overrides that remove from a scene the keys set by the methods.
pub fn cleared(scene: &Scene) -> Vec<String> {
    let cells = CELLS.iter().filter(|_| converges(scene));
    NUMERICAL.iter().chain(cells).map(|key| format!("{key}=")).collect()
}

/// Whether refining the cells converges to one solution: a box under a patch. A mesh file cannot be refined, and the
/// displacement under a point force diverges.
fn converges(scene: &Scene) -> bool {
    matches!((&scene.body.geometry, scene.contact), (Geometry::Box { .. }, Contact::Patch { .. }))
}

/// Numbers of time steps per contact on a half-space.
const STEPS: [f64; 5] = [20.0, 60.0, 200.0, 600.0, 2000.0];

/// Settings of the unreduced solid: steps per contact on a half-space, and radius of the patch over the thickness. The
/// cells under the patch resolve its radius.
const REFINED: [(f64, f64); 5] = [(20.0, 0.5), (60.0, 0.5), (60.0, 0.25), (200.0, 0.25), (600.0, 0.125)];

const TOLERANCES: [f64; 8] = [3e-1, 1e-1, 3e-2, 1e-2, 3e-3, 1e-3, 3e-4, 1e-4];
/// Assumed wall time of the coarsest setting on a plate, s, as an order of magnitude: of a plate theory or a formula,
/// of a box of splines, of a solid stepped in its unknowns, and of the last with the full Newton method.
const GUESSES: [f64; 4] = [0.03, 0.3, 3.0, 30.0];

const DECADES: [f64; 4] = [1e-1, 1e-2, 1e-3, 1e-4];
const VECTORS: [usize; 5] = [8, 16, 32, 64, 128];

/// Number of basis vectors of a reduced body that is stepped by Newmark's method.
const STEPPED: usize = 64;

/// Properties of a scene from which the settings of its methods are derived.
pub struct Ladder {
    /// Contact time on a half-space, s.
    contact: f64,
    /// Thickness under the impactor, m, if the scene leaves the radius of the patch free.
    thickness: Option<f64>,
    /// Whether the body can be computed in modal coordinates.
    is_linear: bool,
    is_box: bool,
    /// Whether the body is of one elastic material.
    is_uniform: bool,
}

impl Ladder {
    /// Derives the settings from a cleared scene.
    pub fn new(scene: &Scene) -> Self {
        let impactor = &scene.impactor;
        let thickness = match (&scene.body.geometry, scene.struck_axis(), scene.contact) {
            (Geometry::Box { size, .. }, Some(axis), Contact::Patch { radius: None, .. }) => Some(size[axis]),
            _ => None,
        };
        Self {
            contact: impactor.contact_time(),
            thickness,
            is_linear: scene.time.modal && !scene.is_on_pads(),
            is_box: matches!(scene.body.geometry, Geometry::Box { .. }),
            is_uniform: scene.body.composition.uniform().is_some(),
        }
    }

    /// The plate theory whose cells and basis are refined: Mindlin's, or the layerwise one for several layers.
    fn plate(&self) -> &'static str {
        if self.is_uniform { "mindlin" } else { "layerwise" }
    }

    /// Whether the body can be computed in modal coordinates.
    pub fn is_linear(&self) -> bool {
        self.is_linear
    }

    /// A time step as a setting, from the number of steps per contact on a half-space.
    pub fn step(&self, a_contact: f64) -> String {
        format!("time.step={:.2e}", self.contact / a_contact)
    }

    /// All methods that apply to the scene.
    pub fn methods(&self) -> Vec<Method> {
        let mut methods = vec![self.by("auto", &["body.model=auto"], &DECADES.map(tolerance))];
        let plate = self.plate();
        if self.is_box && self.is_linear {
            // A formula has one solution, and the theory error of a plate without shear soon exceeds its other errors.
            let by_theory =
                [("half-space", &DECADES[1..2]), ("infinite-plate", &DECADES[1..2]), ("kirchhoff", &TOLERANCES[..4])];
            for (theory, tolerances) in
                by_theory.iter().filter(|(theory, _)| self.is_uniform || *theory == "half-space")
            {
                let rungs: Vec<String> = tolerances.iter().copied().map(tolerance).collect();
                methods.push(self.by(theory, &[&format!("body.model={theory}")], &rungs));
            }
            let model = format!("body.model={plate}");
            methods.push(self.by(plate, &[&model], &TOLERANCES.map(tolerance)));
            let vectors = [&model, "accuracy.tolerance=1e-3"];
            methods.push(self.by(&format!("{plate}/vectors"), &vectors, &VECTORS.map(reduction)));
        }
        if self.is_linear {
            methods.push(self.by("solid", &["body.model=solid"], &TOLERANCES.map(tolerance)));
            let vectors = ["body.model=solid", "accuracy.tolerance=1e-3"];
            methods.push(self.by("solid/vectors", &vectors, &VECTORS.map(reduction)));
        }
        let steps = STEPS.map(|a_contact| self.step(a_contact));
        let reduced = [plate, "solid"];
        for theory in &reduced[..if self.is_box && self.is_linear { 2 } else { 0 }] {
            let basis = [format!("body.model={theory}"), reduction(STEPPED)];
            let name = format!("{theory}/vectors/newmark");
            methods.push(self.by(&name, &[&basis[0], &basis[1], "time.scheme=newmark"], &steps));
        }
        for scheme in ["newmark", "generalized-alpha", "energy"] {
            let scheme_key = format!("time.scheme={scheme}");
            if self.is_box && self.is_linear {
                let whole = [&format!("body.model={plate}"), "body.reduction=none", &scheme_key];
                methods.push(self.by(&format!("{plate}/{scheme}"), &whole, &steps));
            }
            methods.push(self.refined(&format!("solid/{scheme}"), &[&scheme_key]));
        }
        methods.push(self.refined("solid/newmark/full", &["time.scheme=newmark", "solver.newton=full"]));
        let explicit = ["body.model=solid", "body.reduction=none", "time.scheme=central-difference"];
        let patches: Vec<String> = self
            .thickness
            .map_or(vec![String::new()], |thickness| [0.5, 0.25].map(|part| patch(part * thickness)).to_vec());
        methods.push(self.by("solid/central-difference", &explicit, &patches));
        methods
    }

    /// A method with fixed settings and one varied setting per rung.
    fn by(&self, name: &str, fixed: &[&str], varied: &[String]) -> Method {
        let rung = |varied: &String| {
            let fixed = fixed.iter().map(|setting| (*setting).to_owned());
            fixed.chain((!varied.is_empty()).then(|| varied.clone())).collect()
        };
        Method { name: name.to_owned(), rungs: varied.iter().map(rung).collect(), guess: guess(name) }
    }

    /// The unreduced solid. Its time steps and, if the scene leaves them free, its cells are refined together.
    fn refined(&self, name: &str, settings: &[&str]) -> Method {
        let rung = |&(a_contact, part): &(f64, f64)| {
            let fixed = ["body.model=solid", "body.reduction=none"].iter().chain(settings);
            let mut rung: Vec<String> = fixed.map(|setting| (*setting).to_owned()).collect();
            rung.push(self.step(a_contact));
            rung.extend(self.thickness.map(|thickness| patch(part * thickness)));
            rung
        };
        let mut rungs: Vec<Vec<String>> = REFINED.iter().map(rung).collect();
        // If the cells are given, only the steps are refined.
        rungs.dedup();
        Method { name: name.to_owned(), rungs, guess: guess(name) }
    }
}

/// Assumed wall time of a method's coarsest setting, s, by the method's name.
fn guess(name: &str) -> f64 {
    let words: Vec<&str> = name.split('/').collect();
    GUESSES[match words[..] {
        ["solid"] | ["solid", "vectors", ..] => 1,
        ["solid", .., "full"] => 3,
        ["solid", ..] => 2,
        _ => 0,
    }]
}

fn tolerance(value: f64) -> String {
    format!("accuracy.tolerance={value:e}")
}

fn reduction(vectors: usize) -> String {
    format!("body.reduction={vectors}")
}

fn patch(radius: f64) -> String {
    format!("contact.patch_radius={radius:.3e}")
}

/// A method's settings without those that its name already tells.
pub fn settings_of(settings: &[String]) -> String {
    let said = ["body.model=", "time.scheme=", "solver.newton=", "body.reduction=none"];
    let rest = settings.iter().filter(|setting| !said.iter().any(|start| setting.starts_with(start)));
    rest.map(String::as_str).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    const PLATE: &str = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.5, 0.5, 0.02]\n\
        [impactor]\nmass = 52.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 1.0\n[time]\nend = 0.01\n";

    fn methods(text: &str) -> Vec<Method> {
        let given = Scene::parse("given", text, &[]).unwrap().0;
        let cleared = Scene::parse("cleared", text, &cleared(&given)).unwrap().0;
        let methods = Ladder::new(&cleared).methods();
        for method in &methods {
            assert!(!method.rungs.is_empty());
            for rung in &method.rungs {
                let overrides: Vec<String> = super::cleared(&given).into_iter().chain(rung.iter().cloned()).collect();
                Scene::parse("varied", text, &overrides).unwrap_or_else(|e| panic!("{}: {rung:?}: {e}", method.name));
            }
        }
        methods
    }

    fn names(text: &str) -> String {
        methods(text).iter().map(|method| method.name.clone()).collect::<Vec<_>>().join(" ")
    }

    /// Every setting gives a valid scene, whatever the scene itself asks for.
    #[test]
    fn all_settings_are_scenes() {
        let all = names(PLATE);
        assert!(all.starts_with("auto half-space infinite-plate kirchhoff mindlin mindlin/vectors solid"), "{all}");
        let with = |key: &str, lines: &str| PLATE.replace(key, &format!("{lines}\n{key}"));
        let asked = with(
            "[impactor]",
            "model = \"solid\"\nreduction = \"none\"\ncells = [4, 4, 2]\n[solver]\nnewton = \"full\"\n\
             [output]\nfields = 9\nprobes = [{ name = \"a\", point = [0, 0, 0] }]",
        );
        let asked = format!("{asked}step = 1e-5\nscheme = \"generalized-alpha\"\nrho_inf = 0.5\n");
        assert_eq!(names(&asked), all);
    }

    /// Laminates are charted with the layerwise plate. Of the closed forms only the half-space of the struck layer
    /// remains.
    #[test]
    fn layers_have_a_theory_of_their_own() {
        let layers = PLATE
            .replace("young = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.5, 0.5, 0.02]", "size = [0.5, 0.5]");
        let layers = layers.replace(
            "[impactor]",
            "[[body.layer]]\nthickness = 0.01\nmaterial = \"glass\"\n[[body.layer]]\nthickness = 0.002\nmaterial = \"polymer\"\n\
             [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
             [material.polymer]\nyoung = 3e9\npoisson = 0.4\ndensity = 1100.0\n[impactor]",
        );
        let found = names(&layers);
        assert!(found.starts_with("auto half-space layerwise layerwise/vectors solid"), "{found}");
        assert!(!found.contains("mindlin"), "{found}");
    }

    /// Cells under a point force, and bodies without modal coordinates, are not refined.
    #[test]
    fn what_does_not_converge_is_not_refined() {
        let point = PLATE.replace("[impactor]", "cells = [4, 4, 2]\n[contact]\nlocalization = \"point\"\n[impactor]");
        let pad = "[[support]]\nsurface = \"bottom\"\nkind = \"pad\"\nstiffness = 1e9\nnormal = [0, 0, -1]\n[impactor]";
        for text in [point, PLATE.replace("[impactor]", pad)] {
            let found = methods(&text);
            let cells = |rung: &Vec<String>| rung.iter().any(|setting| setting.starts_with("body.cells"));
            assert!(!found.iter().flat_map(|method| &method.rungs).any(cells));
            assert!(found.iter().any(|method| method.name == "solid/newmark"));
            assert_eq!(found.iter().any(|method| method.name == "solid"), !text.contains("pad"));
        }
    }
}
