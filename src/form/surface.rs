//! Terms over a part of a surface: elastic supports (11), dampers (13) and tractions (3).

/// Quadrature points of a part of a surface, with the displacement there as a function of a few common unknowns.
///
/// The part is a facet of a mesh, a cell of a grid on a face, or the portion of either within a region. Unknowns are
/// numbered from zero. For n unknowns, matrices are row-major slices of n² values and vectors are slices of n values.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SurfaceElement {
    /// Number of unknowns n.
    pub unknowns: usize,
    /// Numbers of the unknowns that determine each component of the displacement.
    pub of_component: [Vec<usize>; 3],
    /// Quadrature points of the part.
    pub points: Vec<SurfacePoint>,
}

/// A quadrature point of a surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SurfacePoint {
    /// Position, m.
    pub position: [f64; 3],
    /// Area represented by the point (quadrature weight), m².
    pub area: f64,
    /// Values of the shape functions, for each component in the order of [`SurfaceElement::of_component`].
    pub shape: [Vec<f64>; 3],
}

impl SurfaceElement {
    /// Computes Σ_i ∫ k_i u_i v_i dS with one coefficient per component: N/m for the k of (11), N s/m for the c of
    /// (13).
    pub fn spring(&self, k: [f64; 3], out: &mut [f64]) {
        out.fill(0.);
        for (component, k) in k.into_iter().enumerate().filter(|(_, k)| *k != 0.) {
            let of = &self.of_component[component];
            for point in &self.points {
                add_square(k * point.area, &point.shape[component], of, self.unknowns, out);
            }
        }
    }

    /// Computes ∫ f·v dS, N, for the traction `f` (N/m²), a function of the position.
    pub fn traction(&self, f: impl Fn([f64; 3]) -> [f64; 3], out: &mut [f64]) {
        out.fill(0.);
        for SurfacePoint { position, area, shape } in &self.points {
            for ((f, shape), of) in f(*position).into_iter().zip(shape).zip(&self.of_component) {
                of.iter().zip(shape).for_each(|(&unknown, value)| out[unknown] += area * f * value);
            }
        }
    }

    /// Area ∫ dS, m².
    pub fn area(&self) -> f64 {
        self.points.iter().map(|point| point.area).sum()
    }
}

/// Adds factor · N Nᵀ for the values N of some of the n unknowns. The products are symmetric to the last bit.
pub(super) fn add_square(factor: f64, values: &[f64], of: &[usize], n: usize, out: &mut [f64]) {
    for (&a, &i) in values.iter().zip(of) {
        for (&b, &j) in values.iter().zip(of) {
            out[i * n + j] += factor * (a * b);
        }
    }
}
