//! One-sided elastic support (12) over a part of a surface: a unilateral Winkler foundation.

use super::SurfaceElement;
use super::surface::add_square;

/// A one-sided foundation.
///
/// With n the unit vector into it, each component i with n_i ≠ 0 pushes back where its penetration g_i = s_i (u_i − ū_i),
/// s_i = sign n_i, is positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foundation {
    /// k, N/m³ by component.
    pub stiffness: [f64; 3],
    /// n.
    pub normal: [f64; 3],
    /// ū, m.
    pub displacement: [f64; 3],
}

/// A foundation under a part of a surface. The integrand has a kink, so the quadrature points are part of the model.
#[derive(Debug, Clone)]
pub struct PadElement {
    /// n, the number of unknowns.
    unknowns: usize,
    points: Vec<PadPoint>,
}

/// One component of a foundation at one quadrature point: it pushes back with w ⟨g⟩, g = Σ s φ_a u_a − s ū.
#[derive(Debug, Clone, PartialEq)]
pub struct PadPoint {
    /// w = k dS, N/m.
    pub weight: f64,
    /// s ū, m.
    pub offset: f64,
    /// The unknowns u_a.
    pub unknowns: Vec<usize>,
    /// s φ_a.
    pub values: Vec<f64>,
}

impl PadElement {
    /// A foundation under quadrature points of a surface.
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

    /// The points, component by component: what the sums below consist of.
    pub fn points(&self) -> &[PadPoint] {
        &self.points
    }

    /// Σ_i ∫ k_i ⟨g_i⟩ s_i v_i dS at the unknowns `u`, N; with unknowns `from`, the mean of ⟨g_i⟩ between the two that does just the
    /// potential's work (its discrete gradient).
    pub fn residual(&self, from: Option<&[f64]>, u: &[f64], out: &mut [f64]) {
        out.fill(0.);
        for point in &self.points {
            point.add(point.weight * point.push(from, u).0, out);
        }
    }

    /// The semi-smooth derivative of the residual with respect to `u`, N/m.
    pub fn tangent(&self, from: Option<&[f64]>, u: &[f64], out: &mut [f64]) {
        out.fill(0.);
        for point in &self.points {
            let slope = point.push(from, u).1;
            if slope != 0. {
                add_square(point.weight * slope, &point.values, &point.unknowns, self.unknowns, out);
            }
        }
    }

    /// The tangent of a pad pressed everywhere, which is the largest, times `u`, N.
    pub fn pressed(&self, u: &[f64], out: &mut [f64]) {
        out.fill(0.);
        for point in &self.points {
            point.add(point.weight * point.moved(u), out);
        }
    }

    /// That tangent, N/m.
    pub fn pressed_tangent(&self, out: &mut [f64]) {
        out.fill(0.);
        for point in &self.points {
            add_square(point.weight, &point.values, &point.unknowns, self.unknowns, out);
        }
    }

    /// Σ_i ∫ k_i s_i f v_i dS of a f that may depend on the point, N.
    pub fn load(&self, f: impl Fn(&PadPoint) -> f64, out: &mut [f64]) {
        out.fill(0.);
        for point in &self.points {
            point.add(point.weight * f(point), out);
        }
    }

    /// Σ s φ_a u_a at each point, m.
    pub fn moved<'a>(&'a self, u: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.points.iter().map(|point| point.moved(u))
    }

    /// Σ_i ½ ∫ k_i ⟨g_i⟩² dS, J.
    pub fn potential(&self, u: &[f64]) -> f64 {
        self.points.iter().map(|point| 0.5 * point.weight * positive_part(point.penetration(u)).powi(2)).sum()
    }
}

impl PadPoint {
    /// Σ s φ_a u_a.
    fn moved(&self, u: &[f64]) -> f64 {
        self.unknowns.iter().zip(&self.values).map(|(&unknown, value)| value * u[unknown]).sum()
    }

    /// g, m.
    fn penetration(&self, u: &[f64]) -> f64 {
        self.moved(u) - self.offset
    }

    /// ⟨g⟩ or its mean, with its derivative.
    fn push(&self, from: Option<&[f64]>, u: &[f64]) -> (f64, f64) {
        pressed_depth(from.map(|from| self.penetration(from)), self.penetration(u))
    }

    /// Adds a force along g.
    fn add(&self, force: f64, out: &mut [f64]) {
        self.unknowns.iter().zip(&self.values).for_each(|(&unknown, value)| out[unknown] += force * value);
    }
}
/// ⟨g⟩ (m) of a penetration, or, with the penetration `from` before a step, the mean of ⟨·⟩ that does just the work of ½⟨g⟩²;
/// and the derivative with respect to `to`.
pub fn pressed_depth(from: Option<f64>, to: f64) -> (f64, f64) {
    match from {
        None => (positive_part(to), if to > 0. { 1. } else { 0. }),
        Some(from) => mean(from, to),
    }
}

/// ⟨g⟩; it keeps NaN, so that a failed step is seen.
fn positive_part(g: f64) -> f64 {
    g.clamp(0., f64::INFINITY)
}

/// The difference of ½⟨g⟩² between two penetrations over their difference, and its derivative in the second.
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
