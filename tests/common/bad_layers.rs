//! Scenes with faulty layers and materials.

use super::{BadScene, MESH, SMALL, edit, varied};

/// A good laminate with every key that a material may have.
pub const LAMINATE: &str = r#"[body]
size = [0.5, 0.5]
temperature = 20.0

[[body.layer]]
thickness = 0.010
material = "glass"

[[body.layer]]
thickness = 0.00076
material = "interlayer"

[[body.layer]]
thickness = 0.0101
material = "glass"

[material.glass]
young = 70e9
poisson = 0.23
density = 2500.0

[material.interlayer]
bulk = 2e9
density = 1100.0
shear = 3e6
prony = [{ modulus = 7e6, time = 1e-5 }, { modulus = 4e6, time = 1e-4 }]
wlf = { c1 = 20.0, c2 = 90.0, reference = 20.0 }

[impactor]
mass = 52.0
radius = 0.05
young = 210e9
poisson = 0.3
speed = 1.0

[time]
end = 0.003
"#;

/// A mesh body of two materials.
const VOLUMES: &str = r#"[body]
mesh = "meshes/two.msh"

[material.plate]
young = 70e9
poisson = 0.23
density = 2500

[material.frame]
young = 10e9
poisson = 0.3
density = 900

[impactor]
mass = 52
radius = 0.05
stiffness = 1e10
speed = 1
point = [0, 0, 0.05]

[contact]
material = "plate"

[time]
end = 0.02
"#;

#[rustfmt::skip]
pub(super) fn table() -> Vec<BadScene> {
    let prony = "prony = [{ modulus = 7e6, time = 1e-5 }, { modulus = 4e6, time = 1e-4 }]";
    let with = |name, overrides: &[&str], fragments: &[&'static str], at| varied(name, LAMINATE, overrides, fragments, at);
    vec![
        edit("a layer of no thickness", LAMINATE, ("0.00076", "0"), &["must be positive, but is 0", "thickness in m"], ("body.layer.1.thickness", "thickness = 0\n".trim())).on_line(10),
        edit("a negative layer", LAMINATE, ("0.00076", "-1e-3"), &["must be positive, but is -0.001"], ("body.layer.1.thickness", "thickness = -1e-3")),
        edit("two edges without layers", SMALL, ("[1.5, 1.5, 0.1]", "[1.5, 0.1]"), &["two edges", "[[body.layer]]"], ("body.size", "size")),
        edit("three edges with layers", LAMINATE, ("[0.5, 0.5]", "[0.5, 0.5, 0.02]"), &["the thickness is theirs", "0.02086"], ("body.size", "size")),
        edit("an unknown material", LAMINATE, ("material = \"interlayer\"", "material = \"interlayr\""), &["there is no material \"interlayr\"", "did you mean \"interlayer\"?"], ("body.layer.1.material", "material = \"interlayr\"")),
        edit("a material that nothing is made of", LAMINATE, ("[impactor]", "[material.steel]\nyoung = 210e9\npoisson = 0.3\ndensity = 7800\n[impactor]"), &["no layer is made of it"], ("material.steel", "[material.steel]")),
        with("a material that an override leaves unused", &["body.layer.1.material=glass"], &["no layer is made of it (set by --set body.layer.1.material=glass)", "remove the table"], ("material.interlayer", 22)),
        edit("materials without layers", SMALL, ("young = 70e9\npoisson = 0.23\ndensity = 2500\n", "material.glass.young = 70e9\n"), &["unknown key"], ("body.material", "material.glass")),
        edit("an incompressible layer", LAMINATE, ("bulk = 2e9", "poisson = 0.5"), &["0.5 is out of range", "incompressible"], ("material.interlayer.poisson", "poisson = 0.5")),
        edit("a layer nearly incompressible", LAMINATE, ("bulk = 2e9", "bulk = 1e25"), &["incompressible", "bulk modulus"], ("material.interlayer.bulk", "bulk")),
        edit("no bulk modulus", LAMINATE, ("bulk = 2e9\n", ""), &["this key is required", "`poisson`"], ("material.interlayer.bulk", "[material.interlayer]")),
        edit("moduli given twice", LAMINATE, ("bulk = 2e9", "bulk = 2e9\npoisson = 0.49"), &["given twice"], ("material.interlayer.poisson", "poisson = 0.49")),
        edit("relaxation beside Young's modulus", LAMINATE, ("poisson = 0.23", "poisson = 0.23\nshear = 1e9"), &["given twice: by `young` and by `shear`"], ("material.glass.shear", "shear = 1e9")),
        edit("no modulus at all", LAMINATE, ("young = 70e9\n", ""), &["this key is required", "`shear`"], ("material.glass.young", "[material.glass]")).on_line(17),
        edit("relaxation to no shear modulus", LAMINATE, ("shear = 3e6\n", ""), &["this key is required"], ("material.interlayer.shear", "[material.interlayer]")),
        edit("a negative shear modulus", LAMINATE, ("shear = 3e6", "shear = -3e6"), &["must not be negative"], ("material.interlayer.shear", "shear")),
        edit("a shear modulus of zero without terms", LAMINATE, (&format!("shear = 3e6\n{prony}\nwlf = {{ c1 = 20.0, c2 = 90.0, reference = 20.0 }}"), "shear = 0"), &["no material's relaxation depends on the temperature"], ("body.temperature", "temperature")),
        edit("a time twice", LAMINATE, ("time = 1e-4", "time = 1e-5"), &["1e-5 s is there twice"], ("material.interlayer.prony.1.time", "prony")),
        edit("a negative modulus of a term", LAMINATE, ("modulus = 4e6", "modulus = -4e6"), &["must be positive"], ("material.interlayer.prony.1.modulus", "prony")),
        edit("a time of zero", LAMINATE, ("time = 1e-4", "time = 0"), &["must be positive"], ("material.interlayer.prony.1.time", "prony")),
        edit("no terms", LAMINATE, (prony, "prony = []"), &["there is no term"], ("material.interlayer.prony", "prony")),
        edit("a key of no term", LAMINATE, ("modulus = 4e6", "moduls = 4e6"), &["unknown key", "did you mean `modulus`?"], ("material.interlayer.prony.1.moduls", "prony")),
        edit("a file of terms that is not there", LAMINATE, (prony, "prony = \"none.csv\""), &["none.csv cannot be read", "ascending"], ("material.interlayer.prony", "prony")),
        edit("a temperature at the pole", LAMINATE, ("temperature = 20.0", "temperature = -70"), &["at -70 °C and below"], ("body.temperature", "temperature")),
        edit("a temperature that shifts to nothing", LAMINATE, ("temperature = 20.0", "temperature = -69.9"), &["leaves no number"], ("body.temperature", "temperature")),
        edit("a temperature without a shift", LAMINATE, ("wlf = { c1 = 20.0, c2 = 90.0, reference = 20.0 }\n", ""), &["no material's relaxation depends"], ("body.temperature", "temperature")),
        edit("a shift without terms", LAMINATE, (&format!("{prony}\n"), ""), &["no relaxation times to shift"], ("material.interlayer.wlf", "wlf")),
        edit("young beside layers", LAMINATE, ("temperature = 20.0", "temperature = 20.0\nyoung = 70e9"), &["no `young`, `poisson` and `density` of its own"], ("body.young", "young = 70e9")),
        edit("layers of a mesh", MESH, ("[[support]]", "[[body.layer]]\nthickness = 0.1\nmaterial = \"glass\"\n[[support]]"), &["its own layers"], ("body.layer", "[[body.layer]]")),
        edit("a mesh's struck material left out", VOLUMES, ("[contact]\nmaterial = \"plate\"\n", ""), &["one that is hit", "\"frame\", \"plate\""], ("contact.material", "[body]")).on_line(1),
        edit("a mesh's struck material unknown", VOLUMES, ("\"plate\"\n", "\"plat\"\n"), &["did you mean \"plate\"?"], ("contact.material", "material = \"plat\"")),
        edit("a struck material of a box", SMALL, ("[time]", "[contact]\nmaterial = \"glass\"\n[time]"), &["it is for mesh files"], ("contact.material", "material")),
        edit("fewer cells than layers", LAMINATE, ("size = [0.5, 0.5]", "size = [0.5, 0.5]\ncells = [8, 8, 2]"), &["2 cells across 3 layers"], ("body.cells", "cells")),
        edit("layers graded", LAMINATE, ("size = [0.5, 0.5]", "size = [0.5, 0.5]\ncells = [8, 8, 3]\ngrading = 2"), &["not graded", "[x, y, 1]"], ("body.grading", "grading")),
        edit("explicit steps of a relaxing body", LAMINATE, ("end = 0.003", "end = 0.003\nscheme = \"central-difference\""), &["does not follow the relaxation"], ("time.scheme", "scheme")),
        edit("a plate theory of a relaxing body", LAMINATE, ("temperature = 20.0", "temperature = 20.0\nmodel = \"mindlin\""), &["\"mindlin\" does not follow the relaxation"], ("body.model", "model")),
        with("a modulus of a material by an override", &["material.interlayer.shear=-1"], &["must not be negative, but is -1 (set by --set material.interlayer.shear=-1)"], ("material.interlayer.shear", 25)),
        with("a thickness by an override", &["body.layer.1.thickness=0"], &["set by --set body.layer.1.thickness=0"], ("body.layer.1.thickness", 10)),
        with("a temperature by an override", &["body.temperature=-80"], &["set by --set body.temperature=-80"], ("body.temperature", 3)),
    ]
}
