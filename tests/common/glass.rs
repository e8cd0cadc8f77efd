//! Scenes with the paper's glass and impactor.
#![allow(dead_code, reason = "not every test that shares this module uses all of it")]

/// Young's modulus (Pa), Poisson's ratio and density (kg/m³) of the glass.
pub const GLASS: (f64, f64, f64) = (70e9, 0.23, 2500.0);

/// Impactor mass m0, kg.
pub const MASS: f64 = 52.0;

/// A scene with a body (`size` and similar keys), the lines of `impactor` in addition to radius and material, the lines
/// of `time`, and the tables of `rest`.
pub fn scene(body: &str, impactor: &str, time: &str, rest: &str) -> String {
    let (young, poisson, density) = GLASS;
    format!(
        "[body]\nyoung = {young:e}\npoisson = {poisson}\ndensity = {density}\n{body}\n\
         [impactor]\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\n{impactor}\n[time]\n{time}\n{rest}"
    )
}

/// The paper's impact at 1 m/s.
pub fn plate(body: &str, time: &str, rest: &str) -> String {
    scene(body, &format!("mass = {MASS}\nspeed = 1.0"), time, rest)
}

/// Springs (N/m³) with dampers (N s/m³) along all sides.
pub fn sides(stiffness: f64, damping: f64) -> String {
    format!("[[support]]\nsurface = \"side\"\nkind = \"elastic\"\nstiffness = {stiffness:e}\ndamping = {damping:e}\n")
}
