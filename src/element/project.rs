//! Closest point of a facet to a given point, and normal of a facet.

use nalgebra::{Matrix3x2, Vector2, Vector3};

use super::{Element, Shape, table};

/// Finds the point of a facet closest to `p`: its reference coordinates and its distance.
///
/// `x` are the facet's vertices. On a triangle the result is exact (Ericson, Real-Time Collision Detection, 2005,
/// 5.1.5). A quadrilateral is a bilinear patch, and the squared distance may have several minima. Newton's iteration
/// within the bounds of the facet is started at the vertices, the midpoints of edges and the centre, and the best
/// result is taken.
///
/// # Panics
/// If `shape` is not a facet shape.
pub fn closest(shape: Shape, x: &[[f64; 3]], p: [f64; 3]) -> ([f64; 3], f64) {
    let p = Vector3::from(p);
    let (xi, distance) = match shape {
        Shape::Triangle => closest_on_triangle([0, 1, 2].map(|v| Vector3::from(x[v])), p),
        Shape::Quadrilateral => closest_on_patch(&Patch::new(x), p),
        Shape::Tetrahedron | Shape::Hexahedron => panic!("{shape:?} is no facet"),
    };
    ([xi[0], xi[1], 0.], distance)
}

/// Unit normal at `xi` of the facet with vertices `x`, right-handed about the order of the vertices. NaN if the facet
/// is degenerate.
///
/// # Panics
/// If `shape` is not a facet shape.
pub fn normal(shape: Shape, x: &[[f64; 3]], xi: [f64; 3]) -> [f64; 3] {
    let mut gradients = [[0.; 3]; 4];
    let geometry = Element::new(shape, 1);
    geometry.gradients(xi, &mut gradients);
    let j = table::jacobian(&gradients[..geometry.nodes()], x);
    let n = j.column(0).cross(&j.column(1));
    (n / n.norm()).into()
}

fn closest_on_triangle([a, b, c]: [Vector3<f64>; 3], p: Vector3<f64>) -> (Vector2<f64>, f64) {
    let (ab, ac) = (b - a, c - a);
    let (d1, d2) = (ab.dot(&(p - a)), ac.dot(&(p - a)));
    let (d3, d4) = (ab.dot(&(p - b)), ac.dot(&(p - b)));
    let (d5, d6) = (ab.dot(&(p - c)), ac.dot(&(p - c)));
    // Twice the signed areas of the triangles formed by the projection of p and the edges bc, ca, ab, times twice the
    // area.
    let va = d3 * d6 - d5 * d4;
    let vb = d5 * d2 - d1 * d6;
    let vc = d1 * d4 - d3 * d2;
    let xi = if d1 <= 0. && d2 <= 0. {
        Vector2::new(0., 0.)
    } else if d3 >= 0. && d4 <= d3 {
        Vector2::new(1., 0.)
    } else if d6 >= 0. && d5 <= d6 {
        Vector2::new(0., 1.)
    } else if vc <= 0. && d1 >= 0. && d3 <= 0. {
        Vector2::new(d1 / (d1 - d3), 0.)
    } else if vb <= 0. && d2 >= 0. && d6 <= 0. {
        Vector2::new(0., d2 / (d2 - d6))
    } else if va <= 0. && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        Vector2::new(1. - t, t)
    } else {
        Vector2::new(vb, vc) / (va + vb + vc)
    };
    (xi, (a + ab * xi[0] + ac * xi[1] - p).norm())
}

/// Bilinear patch x(ξ) = centre + across ξ + twist ξ₁ξ₂ over \[−1, 1\]².
struct Patch {
    centre: Vector3<f64>,
    across: Matrix3x2<f64>,
    twist: Vector3<f64>,
}

impl Patch {
    fn new(x: &[[f64; 3]]) -> Self {
        let [a, b, c, d] = [0, 1, 2, 3].map(|v| Vector3::from(x[v]) * 0.25);
        Self {
            centre: a + b + c + d,
            across: Matrix3x2::from_columns(&[b + c - a - d, c + d - a - b]),
            twist: a + c - b - d,
        }
    }

    fn position(&self, xi: Vector2<f64>) -> Vector3<f64> {
        self.centre + self.across * xi + self.twist * (xi[0] * xi[1])
    }

    /// Tangent vectors ∂x/∂ξ₁ and ∂x/∂ξ₂.
    fn tangents(&self, xi: Vector2<f64>) -> Matrix3x2<f64> {
        self.across + Matrix3x2::from_columns(&[self.twist * xi[1], self.twist * xi[0]])
    }
}

fn closest_on_patch(patch: &Patch, p: Vector3<f64>) -> (Vector2<f64>, f64) {
    let starts = [-1., 0., 1.];
    starts
        .into_iter()
        .flat_map(|s| starts.map(|t| Vector2::new(s, t)))
        .map(|start| {
            let xi = descend(patch, p, start);
            (xi, (patch.position(xi) - p).norm())
        })
        .min_by(|(_, one), (_, other)| one.total_cmp(other))
        .unwrap_or((Vector2::zeros(), f64::NAN))
}

/// Finds the local minimum of the squared distance within the bounds, starting from `xi`.
fn descend(patch: &Patch, p: Vector3<f64>, mut xi: Vector2<f64>) -> Vector2<f64> {
    let square = |xi| (patch.position(xi) - p).norm_squared();
    let mut value = square(xi);
    // About five steps are needed; more if p is near a centre of curvature, where the minimum is flat.
    for _ in 0..100 {
        // Rounding of the distance must not reject the last steps, which still improve ξ.
        let descends = |next: &Vector2<f64>| square(*next) <= value * (1. + 1e-14);
        let next = [Curvature::Kept, Curvature::Dropped]
            .into_iter()
            .map(|curvature| newton(patch, p, xi, curvature))
            .find(descends)
            .unwrap_or_else(|| sweep(patch, p, xi));
        let reached = square(next);
        let step = (next - xi).amax();
        (xi, value) = (next, reached);
        if step <= 4. * f64::EPSILON {
            break;
        }
    }
    xi
}

/// Treatment of the patch's curvature in the second derivatives of the squared distance.
#[derive(Clone, Copy, PartialEq)]
enum Curvature {
    /// Newton's method: quadratic convergence at every strict minimum.
    Kept,
    /// Gauss–Newton method: the matrix is positive definite wherever the tangents are independent.
    Dropped,
}

/// One step of the coordinates that are not constrained by a bound, clipped at the bounds. The result is NaN if the
/// matrix is not positive definite, because the step would not be a descent step.
fn newton(patch: &Patch, p: Vector3<f64>, xi: Vector2<f64>, curvature: Curvature) -> Vector2<f64> {
    let residual = patch.position(xi) - p;
    let tangents = patch.tangents(xi);
    let gradient = tangents.transpose() * residual;
    let held = [0, 1].map(|d| xi[d].abs() >= 1. && xi[d] * gradient[d] <= 0.);
    let mut hessian = tangents.transpose() * tangents;
    if curvature == Curvature::Kept {
        // The only non-zero second derivative is ∂²x/∂ξ₁∂ξ₂ = twist; along one coordinate the patch is straight.
        let bend = patch.twist.dot(&residual);
        hessian[(0, 1)] += bend;
        hessian[(1, 0)] += bend;
    }
    let mut step = -gradient;
    if held == [false; 2] {
        let inverse = hessian.try_inverse().filter(|_| hessian.determinant() > 0.);
        step = inverse.map_or(Vector2::repeat(f64::NAN), |inverse| inverse * step);
    } else {
        for d in [0, 1] {
            step[d] = if held[d] { 0. } else { step[d] / hessian[(d, d)] };
        }
    }
    // Clipping would turn NaN into a number.
    if step.iter().all(|x| x.is_finite()) { (xi + step).map(|x| x.clamp(-1., 1.)) } else { step }
}

/// Exact minimum along ξ₁, then along ξ₂. The patch is straight along each, so the distance never increases.
fn sweep(patch: &Patch, p: Vector3<f64>, mut xi: Vector2<f64>) -> Vector2<f64> {
    for d in [0, 1] {
        let tangent = patch.tangents(xi).column(d).into_owned();
        let along = tangent.dot(&(patch.position(xi) - p)) / tangent.norm_squared();
        if along.is_finite() {
            xi[d] = (xi[d] - along).clamp(-1., 1.);
        }
    }
    xi
}
