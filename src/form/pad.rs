//! Unilateral (one-sided) elastic foundation (12) over a part of a surface (Winkler foundation in compression only).

use super::SurfaceElement;
use super::surface::add_square;

/// Unilateral (one-sided) foundation.
///
/// Let n be the unit vector into the foundation. Each component i with n_i ≠ 0 resists if its penetration g_i = s_i
/// (u_i − ū_i), s_i = sign n_i, is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foundation {
    /// Stiffness k of each component, N/m³.
    pub stiffness: [f64; 3],
    /// Unit vector n into the foundation.
    pub normal: [f64; 3],
    /// Displacement ū of the foundation, m.
    pub displacement: [f64; 3],
}

/// Foundation under a part of a surface. The integrand has a kink, so the quadrature points are part of the model.
#[derive(Debug, Clone)]
pub struct PadElement {
    /// Number of unknowns n.
    unknowns: usize,
    points: Vec<PadPoint>,
}

/// One component of a foundation at one quadrature point. Its reaction is w ⟨g⟩ with g = Σ s φ_a u_a − s ū.
#[derive(Debug, Clone, PartialEq)]
pub struct PadPoint {
    /// Stiffness w = k dS, N/m.
    pub weight: f64,
    /// Offset s ū, m.
    pub offset: f64,
    /// Numbers of the unknowns u_a.
    pub unknowns: Vec<usize>,
    /// Signed shape functions s φ_a, in the order of the unknowns.
    pub values: Vec<f64>,
}

impl PadElement {
    /// Foundation under the quadrature points of a surface.
    pub fn new(element: &SurfaceElement, foundation: &Foundation) -> Self {
        let Foundation { stiffness, normal, displacement } = foundation;
        let mut points = Vec::new();
        for point in &element.points {
            for component in (0..3).filter(|&i| normal[i] != 0. && stiffness[i] > 0.) {
                let sign = normal[component].signum();
                points.push(PadPoint {
                    weight: stiffness[component] * point.area,
                    offset: sign * displacement[component],
                    unknowns: element.of_component[component].clone(),
                    values: point.shape[component].iter().map(|value| sign * value).collect(),
                });
            }
        }
        Self { unknowns: element.unknowns, points }
    }

    /// Points of the sums in this type: one for each quadrature point and resisting component.
    pub fn points(&self) -> &[PadPoint] {
        &self.points
    }

    /// Computes the residual Σ_i ∫ k_i ⟨g_i⟩ s_i v_i dS at the unknowns `u`, N. If unknowns `from` are given, ⟨g_i⟩ is
    /// replaced by its mean between `from` and `u`, whose work equals the change of the potential (discrete gradient).
    pub fn residual(&self, from: Option<&[f64]>, u: &[f64], out: &mut [f64]) {
        out.fill(0.);
        for point in &self.points {
            point.add(point.weight * point.push(from, u).0, out);
        }
    }

    /// Computes the semi-smooth derivative of the residual with respect to `u`, N/m.
    pub fn tangent(&self, from: Option<&[f64]>, u: &[f64], out: &mut [f64]) {
        out.fill(0.);
        for point in &self.points {
            let slope = point.push(from, u).1;
            if slope != 0. {
                add_square(point.weight * slope, &point.values, &point.unknowns, self.unknowns, out);
            }
        }
    }

    /// Multiplies the tangent of a pad pressed everywhere, which is the largest possible one, with `u`, N.
    pub fn pressed(&self, u: &[f64], out: &mut [f64]) {
        out.fill(0.);
        for point in &self.points {
            point.add(point.weight * point.moved(u), out);
        }
    }

    /// Computes the tangent of a pad pressed everywhere, N/m.
    pub fn pressed_tangent(&self, out: &mut [f64]) {
        out.fill(0.);
        for point in &self.points {
            add_square(point.weight, &point.values, &point.unknowns, self.unknowns, out);
        }
    }

    /// Computes Σ_i ∫ k_i s_i f v_i dS, N, for a function f of the point.
    pub fn load(&self, f: impl Fn(&PadPoint) -> f64, out: &mut [f64]) {
        out.fill(0.);
        for point in &self.points {
            point.add(point.weight * f(point), out);
        }
    }

    /// Displacement into the foundation Σ s φ_a u_a at each point, m.
    pub fn moved<'a>(&'a self, u: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.points.iter().map(|point| point.moved(u))
    }

    /// Potential Σ_i ½ ∫ k_i ⟨g_i⟩² dS, J.
    pub fn potential(&self, u: &[f64]) -> f64 {
        self.points.iter().map(|point| 0.5 * point.weight * positive_part(point.penetration(u)).powi(2)).sum()
    }
}

impl PadPoint {
    /// Displacement into the foundation Σ s φ_a u_a, m.
    fn moved(&self, u: &[f64]) -> f64 {
        self.unknowns.iter().zip(&self.values).map(|(&unknown, value)| value * u[unknown]).sum()
    }

    /// Penetration g, m.
    fn penetration(&self, u: &[f64]) -> f64 {
        self.moved(u) - self.offset
    }

    /// ⟨g⟩ or its mean, and the derivative with respect to `u`.
    fn push(&self, from: Option<&[f64]>, u: &[f64]) -> (f64, f64) {
        pressed_depth(from.map(|from| self.penetration(from)), self.penetration(u))
    }

    /// Adds a force along g to a vector.
    fn add(&self, force: f64, out: &mut [f64]) {
        self.unknowns.iter().zip(&self.values).for_each(|(&unknown, value)| out[unknown] += force * value);
    }
}
/// Returns ⟨g⟩ (m) at the penetration `to`, and its derivative with respect to `to`. With the penetration `from` before
/// a time step, ⟨g⟩ is replaced by the mean whose work equals the change of ½⟨g⟩².
pub fn pressed_depth(from: Option<f64>, to: f64) -> (f64, f64) {
    match from {
        None => (positive_part(to), if to > 0. { 1. } else { 0. }),
        Some(from) => mean(from, to),
    }
}

/// Positive part ⟨g⟩. NaN is kept, so that a failed step is noticed.
fn positive_part(g: f64) -> f64 {
    g.clamp(0., f64::INFINITY)
}

/// Difference of ½⟨g⟩² between two penetrations, divided by the difference of the penetrations; and the derivative with
/// respect to the second.
fn mean(from: f64, to: f64) -> (f64, f64) {
    match (from > 0., to > 0.) {
        (true, true) => (0.5 * (from + to), 0.5),
        (false, false) => (0. * (from + to), 0.),
        (false, true) => {
            let part = to / (to - from);
            (0.5 * to * part, part * (1. - 0.5 * part))
        }
        (true, false) => {
            let part = from / (from - to);
            (0.5 * from * part, 0.5 * part * part)
        }
    }
}
