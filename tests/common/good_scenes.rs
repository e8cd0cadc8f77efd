//! Good scenes, from which the faulty ones are made by edits.

/// A good scene with a box and with every kind of table.
pub const GOOD: &str = r#"title = "Plate"

[body]
model = "solid"
young = 70e9
poisson = 0.23
density = 2500.0
size = [1.5, 1.5, 0.1]
cells = [20, 20, 2]
order = 2

[[support]]
surface = "side"
kind = "elastic"
stiffness = 1e9
damping = 1e3

[[support]]
surface = "bottom"
kind = "pad"
stiffness = [0, 0, 2e9]
normal = [0, 0, -1]

[[support]]
surface = "x-min"
kind = "clamped"
components = ["x", "z"]

[impactor]
mass = 52.0
radius = 0.05
young = 210e9
poisson = 0.3
speed = 1.0
point = [0.0, 0.0, 0.05]
direction = [0.0, 0.0, -1.0]
gap = 0.0

[contact]
localization = "point"

[load]
body_force = [0.0, 0.0, -24525.0]

[[load.traction]]
surface = "top"
value = [0.0, 0.0, -1e3]

[time]
end = 0.02
step = 1e-5
scheme = "newmark"
beta = 0.25
gamma = 0.5

[solver]
newton = "full"

[output]
every = 2
"#;

/// A good scene with the fewest keys, and a mesh file.
pub const MESH: &str = r#"[body]
young = 70e9
poisson = 0.23
density = 2500
mesh = "meshes/plate.msh"

[[support]]
surface = "rim"
kind = "clamped"

[impactor]
mass = 52
radius = 0.05
stiffness = 1.669e10
speed = 1
point = [0, 0, 0.05]

[time]
end = 0.02
"#;

/// A good scene with the fewest keys, and a box.
pub const SMALL: &str = r#"[body]
young = 70e9
poisson = 0.23
density = 2500
size = [1.5, 1.5, 0.1]

[impactor]
mass = 52
radius = 0.05
young = 210e9
poisson = 0.3
speed = 1

[time]
end = 0.02
"#;

/// A good scene whose body is represented by a quarter.
pub const QUARTER: &str = r#"[body]
young = 70e9
poisson = 0.23
density = 2500
size = [1.5, 1.5, 0.1]
cells = [4, 4, 2]
symmetry = "quarter"

[[support]]
surface = "side"
kind = "elastic"
stiffness = 1e9

[impactor]
mass = 52
radius = 0.05
young = 210e9
poisson = 0.3
speed = 1

[time]
end = 0.02
"#;
