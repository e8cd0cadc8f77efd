//! Scenes that must be refused; each differs from a good one by one edit.

#[path = "good_scenes.rs"]
mod good_scenes;
#[path = "bad_layers.rs"]
pub mod layers;

pub use good_scenes::{GOOD, MESH, QUARTER, SMALL};

/// A scene that must be refused, and the expected message.
pub struct BadScene {
    /// Description of the fault.
    pub name: &'static str,
    /// Text of the scene.
    pub text: String,
    /// Overrides, `KEY=VALUE`.
    pub overrides: Vec<String>,
    /// Texts that the whole message must contain.
    pub fragments: Vec<&'static str>,
    /// The key that the message names.
    pub key: &'static str,
    /// The line that the message names.
    pub line: usize,
}

/// Replaces the only occurrence of `from` in `good`; the faulty line is the one that begins with `at`.
fn edit(
    name: &'static str,
    good: &str,
    (from, to): (&str, &str),
    fragments: &[&'static str],
    (key, at): (&'static str, &str),
) -> BadScene {
    assert_eq!(good.matches(from).count(), 1, "{name}: `{from}` is not unique");
    let text = good.replacen(from, to, 1);
    let line = 1 + text
        .lines()
        .position(|line| line.starts_with(at))
        .unwrap_or_else(|| panic!("{name}: no line begins with `{at}`"));
    BadScene { name, text, overrides: Vec::new(), fragments: fragments.to_vec(), key, line }
}

/// [`GOOD`] with overrides.
fn set(name: &'static str, overrides: &[&str], fragments: &[&'static str], at: (&'static str, usize)) -> BadScene {
    varied(name, GOOD, overrides, fragments, at)
}

/// A good scene with overrides.
fn varied(
    name: &'static str,
    good: &str,
    overrides: &[&str],
    fragments: &[&'static str],
    (key, line): (&'static str, usize),
) -> BadScene {
    BadScene {
        name,
        text: good.into(),
        overrides: overrides.iter().map(|&given| given.into()).collect(),
        fragments: fragments.to_vec(),
        key,
        line,
    }
}

/// All faulty scenes.
pub fn table() -> Vec<BadScene> {
    let mut all = grammar();
    all.extend(body());
    all.extend(layers::table());
    all.extend(supports());
    all.extend(symmetry());
    all.extend(impactor());
    all.extend(implausible());
    all.extend(rest());
    all.extend(theories());
    all.extend(output());
    all.extend(overrides());
    all
}

#[rustfmt::skip]
fn grammar() -> Vec<BadScene> {
    vec![
        edit("no value", GOOD, ("young = 70e9", "young ="), &["not valid TOML"], ("young", "young =")),
        edit("no key", GOOD, ("mass = 52.0", "= 52.0"), &["not valid TOML"], ("= 52.0", "= 52.0")),
        edit("not a number", GOOD, ("mass = 52.0", "mass = 52.0 kg"), &["not valid TOML", "without a unit"], ("mass", "mass")),
        edit("a decimal comma", GOOD, ("mass = 52.0", "mass = 52,0"), &["not valid TOML", "a decimal has a point"], ("mass", "mass")),
        edit("no digit before the point", GOOD, ("mass = 52.0", "mass = .5"), &["not valid TOML", "as in 0.5"], ("mass", "mass")),
        edit("a colon", GOOD, ("mass = 52.0", "mass: 52.0"), &["not valid TOML", "not `:`"], ("mass", "mass")),
        edit("an array left open", GOOD, ("[1.5, 1.5, 0.1]", "[1.5, 1.5, 0.1"), &["not valid TOML", "in the line above"], ("cells", "cells")),
        edit("header left open", GOOD, ("[time]", "[time"), &["not valid TOML"], ("time", "[time")),
        edit("key twice", GOOD, ("order = 2", "order = 2\norder = 1"), &["not valid TOML", "duplicate", "a key may appear only once in a table"], ("order", "order = 1")),
        edit("text left open", GOOD, ("\"Plate\"", "\"Plate"), &["not valid TOML"], ("title", "title")),
        edit("no body", SMALL, ("[body]", "[load]"), &["unknown key", "known here"], ("load.young", "young = 70e9")),
        edit("unknown table", GOOD, ("[solver]", "[slover]"), &["unknown key", "did you mean `solver`?"], ("slover", "[slover]")),
        edit("unknown key", GOOD, ("density", "densty"), &["unknown key", "did you mean `density`?", "`young`"], ("body.densty", "densty")),
        edit("unknown key in a support", GOOD, ("damping", "dampnig"), &["did you mean `damping`?"], ("support.0.dampnig", "dampnig")),
        edit("unknown key in a traction", GOOD, ("value", "valve"), &["did you mean `value`?", "`surface`"], ("load.traction.0.valve", "valve")),
        edit("key of another table", GOOD, ("every = 2", "radius = 2"), &["unknown key", "`radius` is a key of", "`impactor`", "known here: `every`"], ("output.radius", "radius = 2")),
        edit("table in the wrong place", GOOD, ("[solver]", "[layer]"), &["`layer` is a key of `body`", "known here"], ("layer", "[layer]")),
        edit("unlike any key", GOOD, ("every = 2", "quux = 2"), &["unknown key", "known here: `every`"], ("output.quux", "quux")),
        edit("key missing", GOOD, ("young = 70e9\n", ""), &["this key is required", "`young` belongs here"], ("body.young", "[body]")),
        edit("table missing", SMALL, ("[time]\nend = 0.02", ""), &["this key is required", "add a table [time]"], ("time", "[body]")),
        edit("key of a support missing", GOOD, ("kind = \"pad\"\n", ""), &["this key is required"], ("support.1.kind", "[[support]]")).on_line(18),
        edit("text for a number", GOOD, ("young = 70e9", "young = \"70e9\""), &["wrong type: the text \"70e9\"", "expected a number"], ("body.young", "young")),
        edit("number for text", GOOD, ("\"Plate\"", "40"), &["wrong type: the number `40`", "expected a text in quotes"], ("title", "title")),
        edit("one number for three", GOOD, ("size = [1.5, 1.5, 0.1]", "size = 1.5"), &["expected three numbers [x, y, z]"], ("body.size", "size")),
        edit("four numbers for three", GOOD, ("[1.5, 1.5, 0.1]", "[1.5, 1.5, 0.1, 1]"), &["wrong number of entries: 4"], ("body.size", "size")),
        edit("text among numbers", GOOD, ("[1.5, 1.5, 0.1]", "[1.5, 1.5, \"h\"]"), &["wrong type", "expected a number"], ("body.size.2", "size")),
        edit("a broken number of cells", GOOD, ("[20, 20, 2]", "[20, 20, 2.5]"), &["expected a whole number"], ("body.cells.2", "cells")),
        edit("support in single brackets", MESH, ("[[support]]", "[support]"), &["wrong type: a table", "[[support]]"], ("support", "[support]")),
        edit("body without a header", SMALL, ("[body]", "body = 1\n[load]"), &["expected a table with the header [body]"], ("body", "body = 1")),
    ]
}

#[rustfmt::skip]
fn body() -> Vec<BadScene> {
    vec![
        edit("negative modulus", GOOD, ("young = 70e9", "young = -70e9"), &["must be positive, but is -7e10", "Pa"], ("body.young", "young")),
        edit("infinite modulus", GOOD, ("young = 70e9", "young = inf"), &["not finite"], ("body.young", "young")),
        edit("modulus not a number", GOOD, ("young = 70e9", "young = nan"), &["not finite"], ("body.young", "young")),
        edit("incompressible", GOOD, ("poisson = 0.23", "poisson = 0.5"), &["0.5 is out of range", "incompressible"], ("body.poisson", "poisson")),
        edit("Poisson's ratio of -1", GOOD, ("poisson = 0.23", "poisson = -1"), &["-1 is out of range"], ("body.poisson", "poisson")),
        edit("no mass", GOOD, ("density = 2500.0", "density = 0"), &["must be positive, but is 0"], ("body.density", "density")),
        edit("flat", GOOD, ("[1.5, 1.5, 0.1]", "[1.5, 1.5, 0]"), &["must be positive"], ("body.size", "size")),
        edit("no cells", GOOD, ("[20, 20, 2]", "[20, 20, 0]"), &["0 is out of range", "from 1 to 10000"], ("body.cells", "cells")),
        edit("negative cells", GOOD, ("[20, 20, 2]", "[-20, 20, 2]"), &["-20 is out of range"], ("body.cells", "cells")),
        edit("too many cells along an edge", GOOD, ("[20, 20, 2]", "[10001, 1, 1]"), &["10001 is out of range"], ("body.cells", "cells")),
        edit("too many cells", GOOD, ("[20, 20, 2]", "[10000, 10000, 1]"), &["100000000 cells are too many"], ("body.cells", "cells")),
        edit("cubic elements", GOOD, ("order = 2", "order = 3"), &["3 is out of range", "from 1 to 2"], ("body.order", "order")),
        edit("grading by one number too many", GOOD, ("order = 2", "grading = [1, 2, 3, 4]"), &["wrong number of entries: 4", "one number, or three"], ("body.grading", "grading")),
        edit("grading below one", GOOD, ("order = 2", "grading = [2, 0.5, 1]"), &["0.5 is out of range", "from 1 to 10000"], ("body.grading", "grading")),
        edit("grading beyond reason", GOOD, ("order = 2", "grading = 2e4"), &["20000 is out of range"], ("body.grading", "grading")),
        edit("grading not a number", GOOD, ("order = 2", "grading = nan"), &["not finite"], ("body.grading", "grading")),
        edit("mesh and grading", MESH, ("mesh = ", "grading = 2\nmesh = "), &["a mesh file has its own cells", "take out `grading`"], ("body.grading", "grading")),
        edit("cells too thin for coordinates", SMALL, ("[1.5, 1.5, 0.1]", "[1.5, 1.5, 5e-324]"), &["too thin for their coordinates"], ("body.size", "size")),
        edit("symmetry misspelled", GOOD, ("order = 2", "symmetry = \"quarters\""), &["did you mean \"quarter\"?"], ("body.symmetry", "symmetry")),
        edit("mesh and size", GOOD, ("order = 2", "mesh = \"plate.msh\""), &["either a size or a mesh"], ("body.mesh", "mesh")),
        edit("mesh and cells", MESH, ("mesh = ", "cells = [1, 1, 1]\nmesh = "), &["a mesh file has its own cells"], ("body.cells", "cells")),
        edit("cells without size", SMALL, ("size = [1.5, 1.5, 0.1]", "cells = [20, 20, 2]"), &["no geometry"], ("body.size", "[body]")),
        edit("no geometry", MESH, ("mesh = \"meshes/plate.msh\"\n", ""), &["no geometry"], ("body.size", "[body]")),
        edit("mesh without a name", MESH, ("meshes/plate.msh", ""), &["name is empty"], ("body.mesh", "mesh")),
        edit("model misspelled", GOOD, ("model = \"solid\"", "model = \"sold\""), &["did you mean \"solid\"?"], ("body.model", "model")),
    ]
}

#[rustfmt::skip]
fn supports() -> Vec<BadScene> {
    vec![
        edit("surface misspelled", GOOD, ("\"side\"", "\"sides\""), &["no surface \"sides\"", "did you mean \"side\"?", "\"x-min\""], ("support.0.surface", "surface = \"sides\"")),
        edit("surface of another body", GOOD, ("\"x-min\"", "\"rim\""), &["no surface \"rim\"", "\"bottom\""], ("support.2.surface", "surface = \"rim\"")),
        edit("surface without a name", MESH, ("\"rim\"", "\"\""), &["name is empty"], ("support.0.surface", "surface")),
        edit("kind misspelled", GOOD, ("\"elastic\"", "\"elastik\""), &["did you mean \"elastic\"?"], ("support.0.kind", "kind = \"elastik\"")),
        edit("elastic without stiffness", GOOD, ("stiffness = 1e9\n", ""), &["this key is required", "N/m3"], ("support.0.stiffness", "[[support]]")),
        edit("negative stiffness", GOOD, ("stiffness = 1e9", "stiffness = -1e9"), &["must not be negative"], ("support.0.stiffness", "stiffness = -1e9")),
        edit("negative component of stiffness", GOOD, ("stiffness = 1e9", "stiffness = [1, -2, 3]"), &["must not be negative, but is -2"], ("support.0.stiffness", "stiffness = [1, -2")),
        edit("two stiffnesses", GOOD, ("stiffness = 1e9", "stiffness = [1, 2]"), &["wrong number of entries: 2", "one number, or three"], ("support.0.stiffness", "stiffness = [1, 2]")),
        edit("negative damping", GOOD, ("damping = 1e3", "damping = -1e3"), &["must not be negative"], ("support.0.damping", "damping")),
        edit("elastic with a normal", GOOD, ("damping = 1e3", "normal = [0, 0, 1]"), &["kind \"elastic\" has no `normal`", "belongs to a pad"], ("support.0.normal", "normal = [0, 0, 1]")),
        edit("elastic with components", GOOD, ("damping = 1e3", "components = [\"x\"]"), &["kind \"elastic\" has no `components`"], ("support.0.components", "components = [\"x\"]")),
        edit("infinite displacement", GOOD, ("damping = 1e3", "displacement = [0, 0, inf]"), &["not finite"], ("support.0.displacement", "displacement")),
        edit("pad without a normal", GOOD, ("normal = [0, 0, -1]\n", ""), &["a pad needs this key"], ("support.1.normal", "[[support]]")).on_line(18),
        edit("pad with a zero normal", GOOD, ("normal = [0, 0, -1]", "normal = [0, 0, 0]"), &["zero vector has no direction"], ("support.1.normal", "normal")),
        edit("pad without stiffness", GOOD, ("[0, 0, 2e9]", "[2e9, 0, 0]"), &["does not push back"], ("support.1.stiffness", "stiffness = [2e9")),
        edit("clamped with damping", GOOD, ("components = [\"x\", \"z\"]", "damping = 1"), &["kind \"clamped\" has no `damping`"], ("support.2.damping", "damping = 1")).on_line(27),
        edit("clamped with stiffness", GOOD, ("components = [\"x\", \"z\"]", "stiffness = 1"), &["kind \"clamped\" has no `stiffness`"], ("support.2.stiffness", "stiffness = 1")).on_line(27),
        edit("clamped nowhere", GOOD, ("[\"x\", \"z\"]", "[]"), &["holds nothing"], ("support.2.components", "components")),
        edit("component unknown", GOOD, ("[\"x\", \"z\"]", "[\"x\", \"w\"]"), &["no component \"w\""], ("support.2.components.1", "components")),
        edit("component twice", GOOD, ("[\"x\", \"z\"]", "[\"x\", \"x\"]"), &["stands twice"], ("support.2.components.1", "components")),
    ]
}

/// Theories, reductions and modal coordinates that do not fit the rest of the scene.
#[rustfmt::skip]
fn theories() -> Vec<BadScene> {
    vec![
        edit("reduced to nothing", GOOD, ("order = 2", "reduction = 0"), &["0 is out of range", "from 1 to 2000"], ("body.reduction", "reduction")),
        edit("too many vectors", GOOD, ("order = 2", "reduction = 2001"), &["2001 is out of range"], ("body.reduction", "reduction")),
        edit("a broken number of vectors", GOOD, ("order = 2", "reduction = 60.5"), &["expected a word or a whole number"], ("body.reduction", "reduction")),
        edit("a basis on pads", GOOD, ("order = 2", "reduction = 60"), &["on a basis, a body on pads moves in modal coordinates only", "\"none\""], ("body.reduction", "reduction")),
        varied("a basis held at a displacement", MESH, &["support.0.displacement=[0, 0, 1e-4]", "body.reduction=60"], &["held at zero, and this one at a displacement"], ("body.reduction", 6)),
        edit("reduced to some", GOOD, ("order = 2", "reduction = \"some\""), &["\"some\" is not one of its values", "\"none\""], ("body.reduction", "reduction")),
        edit("a plate theory of a mesh file", MESH, ("mesh = ", "model = \"kirchhoff\"\nmesh = "), &["the theory \"kirchhoff\" is for a box", "`size` in place of `mesh`"], ("body.model", "model")),
        edit("a half-space of a mesh file", MESH, ("mesh = ", "model = \"half-space\"\nmesh = "), &["the theory \"half-space\" is for a box"], ("body.model", "model")),
        edit("modal by full Newton", GOOD, ("scheme = \"newmark\"\nbeta = 0.25\ngamma = 0.5", "scheme = \"modal\""), &["the full Newton's method solves for all unknowns", "another scheme"], ("time.scheme", "scheme")),
        varied("modal on clamps that are moved", MESH, &["support.0.displacement=[0, 0, 1e-4]", "time.scheme=modal"], &["held at zero, and this one at a displacement", "--set time.scheme=modal"], ("time.scheme", 21)),
        varied("modal without a basis", SMALL, &["body.reduction=none", "time.scheme=modal"], &["those of a reduced body"], ("time.scheme", 17)),
        varied("steps of a half-space", SMALL, &["body.model=half-space", "time.scheme=newmark"], &["the theory \"half-space\" has no unknowns to step"], ("time.scheme", 17)),
        varied("explicit steps of an infinite plate", SMALL, &["body.model=infinite-plate", "time.scheme=central-difference"], &["\"infinite-plate\" has no unknowns to step"], ("time.scheme", 17)),
        varied("beta of a half-space", SMALL, &["body.model=half-space", "time.beta=0.25"], &["has no unknowns to step", "--set time.beta=0.25"], ("time.beta", 17)),
        varied("Newton on a half-space", SMALL, &["body.model=half-space", "solver.newton=full"], &["has no unknowns to step or to solve for"], ("solver.newton", 19)),
        varied("explicit steps of a plate", SMALL, &["body.model=kirchhoff", "time.scheme=central-difference"], &["\"kirchhoff\" has no lumped mass"], ("time.scheme", 17)),
        varied("explicit steps of a basis", SMALL, &["body.reduction=60", "time.scheme=central-difference"], &["a reduced body has no lumped mass"], ("time.scheme", 17)),
        edit("beta of modal coordinates", SMALL, ("end = 0.02", "end = 0.02\nscheme = \"modal\"\nbeta = 0.25"), &["\"modal\" has no `beta`", "belongs to \"newmark\""], ("time.beta", "beta")),
    ]
}

/// Plates that cannot be represented by a quarter.
#[rustfmt::skip]
fn symmetry() -> Vec<BadScene> {
    let without = |name, (from, to), part| edit(name, QUARTER, (from, to), &["does not have two planes of symmetry", part], ("body.symmetry", "symmetry"));
    vec![
        without("quarter of a scene with one support", ("[[support]]\n", "[[support]]\nsurface = \"x-min\"\nkind = \"clamped\"\n\n[[support]]\n"), "support.0 on \"x-min\" has no mirror image across x = 0"),
        without("quarter off the centre", ("speed = 1", "speed = 1\npoint = [0, 0.3, 0.05]"), "not in the centre of the face: y = 0.3"),
        without("quarter of an oblique hit", ("speed = 1", "speed = 1\ndirection = [1e-3, 0, -1]"), "along the normal of the face"),
        without("quarter of odd cells", ("cells = [4, 4, 2]", "cells = [4, 5, 2]"), "the number of cells along y, 5, is odd"),
        without("quarter of a body pushed aside", ("end = 0.02", "end = 0.02\n[load]\nbody_force = [0, 1, 0]"), "load.body_force has a component along y"),
        without("quarter of a body pulled at one side", ("end = 0.02", "end = 0.02\n[[load.traction]]\nsurface = \"y-max\"\nvalue = [0, 0, 1]"), "load.traction.0 on \"y-max\" has no mirror image across y = 0"),
        edit("quarter of a mesh file", MESH, ("mesh = ", "symmetry = \"quarter\"\nmesh = "), &["the body is from a mesh file"], ("body.symmetry", "symmetry")),
    ]
}

#[rustfmt::skip]
fn impactor() -> Vec<BadScene> {
    vec![
        edit("weightless", GOOD, ("mass = 52.0", "mass = 0.0"), &["must be positive, but is 0"], ("impactor.mass", "mass")),
        edit("sharp", GOOD, ("radius = 0.05", "radius = 0"), &["must be positive"], ("impactor.radius", "radius")),
        edit("at rest", GOOD, ("speed = 1.0", "speed = 0"), &["must be positive"], ("impactor.speed", "speed")),
        edit("going away", GOOD, ("speed = 1.0", "speed = -1.0"), &["must be positive", "which way"], ("impactor.speed", "speed")),
        edit("impactor's Poisson's ratio", GOOD, ("poisson = 0.3", "poisson = 0.6"), &["0.6 is out of range"], ("impactor.poisson", "poisson = 0.6")),
        edit("impactor without modulus", GOOD, ("young = 210e9\n", ""), &["this key is required", "`stiffness`"], ("impactor.young", "[impactor]")),
        edit("modulus beyond numbers", GOOD, ("young = 210e9", "young = 1e-320"), &["the contact stiffness (15) comes out as 0"], ("impactor.young", "young = 1e-320")),
        edit("contact stiffness zero", MESH, ("stiffness = 1.669e10", "stiffness = 0"), &["must be positive"], ("impactor.stiffness", "stiffness")),
        edit("inside already", GOOD, ("gap = 0.0", "gap = -1e-3"), &["must not be negative, but is -0.001"], ("impactor.gap", "gap")),
        edit("off the surface", GOOD, ("[0.0, 0.0, 0.05]", "[0.0, 0.0, 0.082]"), &["the impact point is 3.20e-2 m away from the body's surface", "z = ±0.05"], ("impactor.point", "point")),
        edit("within the body", GOOD, ("[0.0, 0.0, 0.05]", "[0.0, 0.0, 0.0]"), &["is 5.00e-2 m away"], ("impactor.point", "point")),
        edit("from below", GOOD, ("[0.0, 0.0, 0.05]", "[0.0, 0.0, -0.05]"), &["does not lead into the body"], ("impactor.direction", "direction")),
        edit("from below by default", SMALL, ("speed = 1", "speed = 1\npoint = [0, 0, -0.05]"), &["does not lead into the body"], ("impactor.point", "point")),
        edit("along the surface", GOOD, ("direction = [0.0, 0.0, -1.0]", "direction = [1, 0, 0]"), &["does not lead into the body"], ("impactor.direction", "direction")),
        edit("no direction", GOOD, ("direction = [0.0, 0.0, -1.0]", "direction = [0, 0, 0]"), &["zero vector"], ("impactor.direction", "direction")),
        edit("mesh with a point on a face", MESH, ("point = [0, 0, 0.05]", "point = [0, 0]"), &["two numbers are a point on a face of a box"], ("impactor.point", "point")),
        edit("a point beside the face", SMALL, ("speed = 1", "speed = 1\npoint = [0, 0.8]"), &["is 5.00e-2 m away from the body's surface"], ("impactor.point", "point")),
        edit("a point of one number", SMALL, ("speed = 1", "speed = 1\npoint = [0]"), &["or two along the face"], ("impactor.point", "point")),
        edit("mesh without a point", MESH, ("point = [0, 0, 0.05]\n", ""), &["needs this key"], ("impactor.point", "[impactor]")),
    ]
}

#[rustfmt::skip]
fn rest() -> Vec<BadScene> {
    vec![
        edit("infinite weight", GOOD, ("-24525.0", "-inf"), &["not finite"], ("load.body_force", "body_force")),
        edit("traction on no surface", GOOD, ("\"top\"", "\"tpo\""), &["no surface \"tpo\"", "did you mean \"top\"?"], ("load.traction.0.surface", "surface = \"tpo\"")),
        edit("traction not a number", GOOD, ("-1e3]", "nan]"), &["not finite"], ("load.traction.0.value", "value")),
        edit("no time", GOOD, ("end = 0.02", "end = 0"), &["must be positive"], ("time.end", "end")),
        edit("endless", GOOD, ("end = 0.02", "end = inf"), &["not finite"], ("time.end", "end")),
        edit("no step", GOOD, ("step = 1e-5", "step = 0.0"), &["must be positive"], ("time.step", "step")),
        edit("one step too long", GOOD, ("step = 1e-5", "step = 0.05"), &["0.05 s is longer than the run of 0.02 s"], ("time.step", "step")),
        edit("too many steps", GOOD, ("step = 1e-5", "step = 1e-13"), &["2.0e11 steps", "at most 1e9"], ("time.step", "step")),
        edit("central difference by beta", GOOD, ("beta = 0.25", "beta = 0"), &["explicit", "`scheme = \"central-difference\"`"], ("time.beta", "beta")),
        edit("beta of another scheme", GOOD, ("\"newmark\"", "\"energy\""), &["\"energy\" has no `beta`", "belongs to \"newmark\""], ("time.beta", "beta")),
        edit("rho_inf of another scheme", GOOD, ("gamma = 0.5", "rho_inf = 0.5"), &["\"newmark\" has no `rho_inf`", "\"generalized-alpha\""], ("time.rho_inf", "rho_inf")),
        edit("allow_unstable of another scheme", GOOD, ("gamma = 0.5", "allow_unstable = true"), &["has no `allow_unstable`", "\"central-difference\""], ("time.allow_unstable", "allow_unstable")),
        edit("rho_inf without a scheme", SMALL, ("end = 0.02", "end = 0.02\nrho_inf = 0.5"), &["`rho_inf` is of the scheme \"generalized-alpha\", and no scheme is given"], ("time.rho_inf", "rho_inf")),
        edit("allow_unstable by a number", SMALL, ("end = 0.02", "end = 0.02\nallow_unstable = 1"), &["expected true or false"], ("time.allow_unstable", "allow_unstable")),
        edit("spectral radius above one", SMALL, ("end = 0.02", "end = 0.02\nscheme = \"generalized-alpha\"\nrho_inf = 1.5"), &["1.5 is out of range", "from 0 to 1"], ("time.rho_inf", "rho_inf")),
        edit("negative beta", GOOD, ("beta = 0.25", "beta = -0.25"), &["-0.25 is out of range"], ("time.beta", "beta")),
        edit("gamma above one", GOOD, ("gamma = 0.5", "gamma = 1.5"), &["1.5 is out of range"], ("time.gamma", "gamma")),
        edit("scheme misspelled", GOOD, ("\"newmark\"", "\"Newmarc\""), &["did you mean \"newmark\"?"], ("time.scheme", "scheme")),
        edit("never written", GOOD, ("every = 2", "every = 0"), &["0 is out of range"], ("output.every", "every")),
        edit("localization misspelled", GOOD, ("\"point\"", "\"pont\""), &["did you mean \"point\"?"], ("contact.localization", "localization")),
        edit("radius of a point", GOOD, ("localization = \"point\"", "localization = \"point\"\npatch_radius = 0.025"), &["a point has no radius"], ("contact.patch_radius", "patch_radius")),
        edit("disc of a point", GOOD, ("localization = \"point\"", "localization = \"point\"\ndisc_radius = 0.025"), &["a point has no radius"], ("contact.disc_radius", "disc_radius")),
        edit("law misspelled", GOOD, ("localization = \"point\"", "law = \"herz\""), &["did you mean \"hertz\"?"], ("contact.law", "law")),
        edit("a power without its exponent", GOOD, ("localization = \"point\"", "law = \"power\"\nstiffness = 5e4"), &["this key is required"], ("contact.exponent", "[contact]")),
        edit("an exponent below one", GOOD, ("localization = \"point\"", "law = \"power\"\nstiffness = 5e4\nexponent = 0.5"), &["0.5 is out of range"], ("contact.exponent", "exponent")),
        edit("a stiffness of Hertz's law", GOOD, ("localization = \"point\"", "stiffness = 5e4"), &["\"hertz\" has no stiffness", "impactor.stiffness"], ("contact.stiffness", "stiffness = 5e4")),
        edit("a table without a law", GOOD, ("localization = \"point\"", "table = \"t.csv\""), &["\"hertz\" has no table", "law = \"table\""], ("contact.table", "table")),
        edit("a table that is not there", GOOD, ("localization = \"point\"", "law = \"table\"\ntable = \"none.csv\""), &["none.csv cannot be read"], ("contact.table", "table = \"none")),
        edit("a table that falls", GOOD, ("localization = \"point\"", "law = \"table\"\ntable = [[0, 0], [1e-3, 1e6], [2e-3, 9e5]]"), &["the force falls from point 2 to point 3"], ("contact.table", "table = [")),
        edit("an empty table", GOOD, ("localization = \"point\"", "law = \"table\"\ntable = []"), &["two points at least, and has 0"], ("contact.table", "table = [")),
        edit("a table in kN", GOOD, ("localization = \"point\"", "law = \"table\"\ntable = [[0, 0], [1e-3, 40.0]]"), &["the table takes 2.000e-2 J"], ("contact.table", "table = [")),
        edit("damping below zero", GOOD, ("localization = \"point\"", "damping = -0.1"), &["-0.1"], ("contact.damping", "damping = -")),
        edit("damping without end", GOOD, ("localization = \"point\"", "damping = 2e3"), &["the first touch would take 2000 times the law's force"], ("contact.damping", "damping = 2e3")),
        edit("an area of Hertz's law", GOOD, ("localization = \"point\"", "area = { radius = 0.1 }"), &["Hertz's law has an area of its own"], ("contact.area", "area")),
        edit("an area and a patch", GOOD, ("localization = \"point\"", "law = \"power\"\nstiffness = 5e4\nexponent = 1\narea = { radius = 0.1 }\npatch_radius = 0.1"), &["takes the place of a patch"], ("contact.patch_radius", "patch_radius")),
        edit("an area of a point", GOOD, ("localization = \"point\"", "law = \"power\"\nstiffness = 5e4\nexponent = 1\narea = { radius = 0.1 }\nlocalization = \"point\""), &["takes the place of a patch, its disc or a point"], ("contact.localization", "localization")),
        edit("an area in two ways", GOOD, ("localization = \"point\"", "law = \"power\"\nstiffness = 5e4\nexponent = 1\narea = { radius = 0.1, square = 0.1 }"), &["given in one way"], ("contact.area", "area")),
        edit("an area of nothing", GOOD, ("localization = \"point\"", "law = \"power\"\nstiffness = 5e4\nexponent = 1\narea = { square = 0 }"), &["must be positive, but is 0"], ("contact.area.square", "area")),
        edit("an area over the edge", GOOD, ("localization = \"point\"", "law = \"power\"\nstiffness = 5e4\nexponent = 1\narea = { square = 1.51 }"), &["reaches 0.755 m from the impact point", "0.75 m away"], ("contact.area.square", "area")),
        edit("Hertz's pressure on a square", GOOD, ("localization = \"point\"", "law = \"power\"\nstiffness = 5e4\nexponent = 1\narea = { square = 0.1 }\npressure = \"hertz\""), &["is on a disc"], ("contact.pressure", "pressure")),
        edit("a pressure without an area", GOOD, ("localization = \"point\"", "pressure = \"even\""), &["contact.area, which is missing"], ("contact.pressure", "pressure")),
        edit("no radius", GOOD, ("localization = \"point\"", "patch_radius = 0"), &["must be positive, but is 0"], ("contact.patch_radius", "patch_radius")),
        edit("no disc", GOOD, ("localization = \"point\"", "disc_radius = -1"), &["must be positive, but is -1"], ("contact.disc_radius", "disc_radius")),
        edit("tolerance of all", GOOD, ("[solver]", "[accuracy]\ntolerance = 1\n\n[solver]"), &["1 is out of range", "from 1e-6 to 0.5"], ("accuracy.tolerance", "tolerance")),
        edit("tolerance of none", GOOD, ("[solver]", "[accuracy]\ntolerance = 0\n\n[solver]"), &["0 is out of range"], ("accuracy.tolerance", "tolerance")),
        edit("gate closed", GOOD, ("newton = \"full\"", "energy_gate = 0"), &["must be positive, but is 0"], ("solver.energy_gate", "energy_gate")),
        edit("newton misspelled", GOOD, ("\"full\"", "\"ful\""), &["did you mean \"full\"?"], ("solver.newton", "newton")),
    ]
}

/// Values that are implausible for an impact.
#[rustfmt::skip]
fn implausible() -> Vec<BadScene> {
    vec![
        varied("faster than waves", SMALL, &["impactor.speed=1e30"], &["faster than waves in the body, 5.292e3 m/s"], ("impactor.speed", 12)),
        varied("softer than anything", SMALL, &["body.young=1e-30"], &["faster than waves in the body", "Young's modulus in Pa"], ("body.young", 2)),
        varied("heavier than anything", SMALL, &["impactor.mass=1e30"], &["on a half-space the contact would have a radius of"], ("impactor.mass", 8)),
        varied("a flat impactor", SMALL, &["impactor.radius=1e20"], &["on a half-space the contact would have a radius of"], ("impactor.radius", 9)),
        varied("a speck", SMALL, &["body.size=[1e-7, 1e-7, 1e-7]"], &["the longest edge of the body is 1e-7 m"], ("body.size", 5)),
        varied("faster than light", SMALL, &["body.young=1e40"], &["faster than light", "--set body.young=1e40"], ("body.young", 2)),
        varied("heavier than any solid", SMALL, &["body.density=1e30"], &["faster than waves in the body", "--set body.density=1e30"], ("body.density", 4)),
        varied("a contact stiffer than anything", SMALL, &["impactor.stiffness=1e30"], &["times as long as a contact", "in N/m^1.5"], ("impactor.stiffness", 13)),
        varied("a contact softer than anything", SMALL, &["impactor.stiffness=1e-10"], &["of a contact on a half-space", "in N/m^1.5"], ("impactor.stiffness", 13)),
        varied("a run that is long for a small mass", SMALL, &["impactor.mass=1e-20"], &["--set impactor.mass=1e-20"], ("time.end", 15)),
        varied("a run without an end", SMALL, &["time.end=1e9"], &["times as long as a contact on a half-space"], ("time.end", 15)),
        varied("a run that ends before it begins", SMALL, &["time.end=1e-10"], &["of a contact on a half-space"], ("time.end", 15)),
    ]
}

/// Faulty probes and fields.
#[rustfmt::skip]
fn output() -> Vec<BadScene> {
    let probes = |entries: &str| format!("probes = [{entries}]");
    let edit = |name: &'static str, entries: &str, fragments: &[&'static str], key: &'static str| {
        edit(name, GOOD, ("every = 2", &probes(entries)), fragments, (key, "probes"))
    };
    vec![
        self::edit("fields after no step", GOOD, ("every = 2", "fields = 0"), &["0 is out of range", "from 1 to"], ("output.fields", "fields")),
        self::edit("fields by word", GOOD, ("every = 2", "fields = \"all\""), &["expected a whole number"], ("output.fields", "fields")),
        self::edit("one probe for many", GOOD, ("every = 2", "probes = { name = \"a\", point = [0, 0, 0] }"), &["wrong type: a table"], ("output.probes", "probes")),
        edit("a probe without a point", "{ name = \"a\" }", &["this key is required"], "output.probes.0.point"),
        edit("a probe without a name", "{ point = [0, 0, 0] }", &["this key is required"], "output.probes.0.name"),
        edit("a probe with another key", "{ name = \"a\", place = [0, 0, 0] }", &["unknown key", "`point`"], "output.probes.0.place"),
        edit("a probe in a plane", "{ name = \"a\", point = [0, 0] }", &["expected three numbers"], "output.probes.0.point"),
        edit("a probe nowhere", "{ name = \"a\", point = [0, nan, 0] }", &["not finite"], "output.probes.0.point"),
        edit("a probe outside", "{ name = \"a\", point = [0, 0, 0] }, { name = \"b\", point = [0, 0, -0.06] }", &["1.00e-2 m outside of the body", "z from -0.05 to 0.05"], "output.probes.1.point"),
        edit("a probe with an empty name", "{ name = \"\", point = [0, 0, 0] }", &["cannot be the name of a probe"], "output.probes.0.name"),
        edit("a probe with a path for a name", "{ name = \"a/b\", point = [0, 0, 0] }", &["cannot be the name of a probe", "without \"/\""], "output.probes.0.name"),
        edit("two probes of a name", "{ name = \"a\", point = [0, 0, 0] }, { name = \"a\", point = [0, 0, 0.01] }", &["there are two probes \"a\""], "output.probes.1.name"),
        varied("fields of a half-space", SMALL, &["body.model=half-space", "output.fields=9"], &["the theory \"half-space\" is a formula", "--set output.fields=9"], ("output.fields", 19)),
        varied("probes of an infinite plate", SMALL, &["body.model=infinite-plate", "output.probes=[{ name = \"a\", point = [0, 0, 0] }]"], &["the theory \"infinite-plate\" is a formula"], ("output.probes", 19)),
    ]
}

#[rustfmt::skip]
fn overrides() -> Vec<BadScene> {
    vec![
        set("override without a value", &["time.step"], &["command line", "no `=`", "--set time.step"], ("time.step", 1)),
        set("override without a key", &["=1"], &["--set =1", "path of names"], ("=1", 1)),
        set("override with an empty name", &["time..step=1"], &["--set time..step=1"], ("time..step", 1)),
        set("override too deep", &["a.b.c.d.e.f=1"], &["6 parts", "--set a.b.c.d.e.f=1"], ("a.b.c.d.e.f", 1)),
        set("override past the end", &["support.3.stiffness=1e9"], &["3 entries, numbers 0 to 2", "--set support.3.stiffness=1e9"], ("support.3.stiffness", 1)),
        set("override of no entry", &["support.side.stiffness=1e9"], &["`support` is an array", "number of an entry"], ("support.side.stiffness", 1)),
        set("override below a number", &["time.step.size=1"], &["`step` holds a single value"], ("time.step.size", 1)),
        set("override of an unknown key", &["time.stpe=1e-6"], &["unknown key", "did you mean `step`?", "--set time.stpe=1e-6"], ("time.stpe", 55)),
        set("override out of range", &["title=Other", "body.poisson=0.7"], &["0.7 is out of range", "--set body.poisson=0.7"], ("body.poisson", 6)),
        set("override of another type", &["body.young=stiff"], &["wrong type: the text \"stiff\"", "--set body.young=stiff"], ("body.young", 5)),
        set("kind by an override", &["support.0.kind=clamped"], &["kind \"clamped\" has no `stiffness` (set by --set support.0.kind=clamped)"], ("support.0.stiffness", 15)),
        set("scheme by an override", &["time.scheme=energy"], &["\"energy\" has no `beta` (set by --set time.scheme=energy)"], ("time.beta", 53)),
        set("mesh by an override", &["body.mesh=plate.msh"], &["either a size or a mesh", "--set body.mesh=plate.msh"], ("body.mesh", 11)),
        set("override of an entry that is not given", &["support=[]", "output.list.0=1"], &["`list` is not given, so it has no entry 0", "--set output.list.0=1"], ("output.list.0", 1)),
        set("override of a part", &["impactor.point.2=0.08"], &["3.00e-2 m away", "--set impactor.point.2=0.08"], ("impactor.point", 35)),
        set("override of a whole entry", &["support.0=1"], &["whole entry", "--set support.0=1"], ("support.0", 1)),
    ]
}

impl BadScene {
    /// Sets the faulty line, if it is not the first line that begins with the key.
    fn on_line(mut self, line: usize) -> Self {
        self.line = line;
        self
    }
}
