//! Terms over a part of a surface: elastic supports (11), dampers (13) and tractions (3).

/// Quadrature points of a part of a surface, and the displacement there as a sum over the same few unknowns.
///
/// It is a facet of a mesh, a cell of a grid on a face, or what a region has of either. Unknowns are numbered from zero; matrices are
/// row-major slices of n² values for n unknowns, vectors slices of n.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SurfaceElement {
    /// n.
    pub unknowns: usize,
    /// The unknowns on which each component of the displacement depends.
    pub of_component: [Vec<usize>; 3],
    /// The quadrature points.
    pub points: Vec<SurfacePoint>,
}

/// A quadrature point of a surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SurfacePoint {
    /// Where it is, m.
    pub position: [f64; 3],
    /// The area that it stands for, m².
    pub area: f64,
    /// Values of the shape functions, for each component in the order of [`SurfaceElement::of_component`].
    pub shape: [Vec<f64>; 3],
}

impl SurfaceElement {
    /// Σ_i ∫ k_i u_i v_i dS with one coefficient a component: N/m for the k of (11), N s/m for the c of (13).
    pub fn spring(&self, k: [f64; 3], out: &mut [f64]) {
        out.fill(0.);
        for (component, k) in k.into_iter().enumerate().filter(|(_, k)| *k != 0.) {
            let of = &self.of_component[component];
            for point in &self.points {
                add_square(k * point.area, &point.shape[component], of, self.unknowns, out);
            }
        }
    }

    /// ∫ f·v dS with the traction `f` (N/m²) at a point of space, N.
    pub fn traction(&self, f: impl Fn([f64; 3]) -> [f64; 3], out: &mut [f64]) {
        out.fill(0.);
        for SurfacePoint { position, area, shape } in &self.points {
            for ((f, shape), of) in f(*position).into_iter().zip(shape).zip(&self.of_component) {
                of.iter().zip(shape).for_each(|(&unknown, value)| out[unknown] += area * f * value);
            }
        }
    }

    /// ∫ dS, m².
    pub fn area(&self) -> f64 {
        self.points.iter().map(|point| point.area).sum()
    }
}

/// Adds factor · N Nᵀ for values N of some of n unknowns. Products are symmetric to the last bit.
pub(super) fn add_square(factor: f64, values: &[f64], of: &[usize], n: usize, out: &mut [f64]) {
    for (&a, &i) in values.iter().zip(of) {
        for (&b, &j) in values.iter().zip(of) {
            out[i * n + j] += factor * (a * b);
        }
    }
}
