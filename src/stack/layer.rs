//! One layer at one wavenumber: relation of the states at its two faces, and the field between them.
//!
//! A field u_r = U(z) J₁(ξr), u_z = W(z) J₀(ξr), σ_zz = S(z) J₀(ξr), σ_rz = T(z) J₁(ξr) has the state
//!
//! y = (φ, W, s, t) = (U/ξ, W, S/ξ⁴, T/ξ³),
//!
//! for which Hooke's law and equilibrium are, with k = ξ², M = λ + 2μ and E′ = E/(1 − ν²),
//!
//! φ′ = W + k t/μ,   W′ = −(λ/M) k φ + k² s/M,   s′ = −t,   t′ = E′ φ + (λ/M) k s.
//!
//! At k = 0 these are the equations of a thin plate. For long waves all four entries have the same order of magnitude,
//! and there is no cancellation for any small k. The matrix G of y′ = G y has the double eigenvalues ±ξ, (G² − k)² = 0.
//! So exp(zG) is a cubic polynomial in G.
//!
//! For short waves exp(zG) overflows. There the field is a sum of four solutions that decay from the faces. Divided by
//! e^{−s} with s = ξz, the two that decay from the upper face are
//!
//! (U, W, S, T) = (1, 1, −2μξ, −2μξ)   and   (s − 1 + 2ν, s + 2 − 2ν, −2μξ (1 + s), −2μξ s),
//!
//! and the other two are their mirror images. The second solution is a half-space under a pressure of 2μξ.

use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};

use super::Layer;

/// Value of ξh below which the cubic in G is used. Rounding errors grow as e^{2ξh} with the cubic and as (ξh)⁻³ with
/// the decaying solutions.
const THIN: f64 = 1.0;

/// A layer in scaled units: lengths in thicknesses of the stack, stresses in a common modulus.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scaled {
    pub thickness: f64,
    pub young: f64,
    pub poisson: f64,
}

/// Amplitudes U, W, S, T at a depth.
pub(super) type Amplitudes = [f64; 4];

/// Field within a layer.
#[derive(Debug, Clone, Copy)]
pub(super) enum Field {
    /// State y at the upper face, with Gy, G²y and G³y.
    Thin([Vector4<f64>; 4]),
    /// Amplitudes of the solutions that decay from the upper and from the lower face.
    Thick { from_above: Vector2<f64>, from_below: Vector2<f64> },
}

/// Matrices that give a layer's field from the displacements (φ, W) of its upper face, for known layers below.
pub(super) enum Coupling {
    Thin(Matrix4<f64>),
    Thick { of_above: Matrix2<f64>, of_below: Matrix2<f64> },
}

/// Mirrors a matrix of (φ, W) or (s, t) at a plane of constant z. This changes the sign of W and of σ_rz, the second
/// row in both cases.
fn mirrored(m: Matrix2<f64>) -> Matrix2<f64> {
    Matrix2::new(m[(0, 0)], m[(0, 1)], -m[(1, 0)], -m[(1, 1)])
}

/// Coefficients of 1, G, G², G³ in exp(zG), with x = ξz.
fn cubic(z: f64, x: f64) -> [f64; 4] {
    let (cosh, sinh_over) = if x == 0.0 { (1.0, 1.0) } else { (x.cosh(), x.sinh() / x) };
    // (cosh x − sinh x/x)/x², as a series where this form loses digits: Σ 2(k + 1) x^{2k}/(2k + 3)!.
    let g = if x > THIN {
        (cosh - sinh_over) / (x * x)
    } else {
        let (mut term, mut sum) = (1.0 / 3.0, 0.0);
        for k in 1..10 {
            sum += term;
            let n = 2.0 * f64::from(k);
            term *= x * x / (n * (n + 3.0));
        }
        sum
    };
    let half = 0.5 * x * x;
    [cosh - half * sinh_over, z * (sinh_over - half * g), 0.5 * z * z * sinh_over, 0.5 * z.powi(3) * g]
}

impl Scaled {
    pub fn new(layer: &Layer, length: f64, modulus: f64) -> Self {
        Self { thickness: layer.thickness / length, young: layer.young / modulus, poisson: layer.poisson }
    }

    pub fn shear(&self) -> f64 {
        0.5 * self.young / (1.0 + self.poisson)
    }

    /// λ/M.
    fn ratio(&self) -> f64 {
        self.poisson / (1.0 - self.poisson)
    }

    fn generator(&self, x: f64) -> Matrix4<f64> {
        let (k, ratio) = (x * x, self.ratio());
        let of_pressure =
            (1.0 + self.poisson) * (1.0 - 2.0 * self.poisson) / (self.young * (1.0 - self.poisson)) * k * k;
        let plane = self.young / (1.0 - self.poisson * self.poisson);
        #[rustfmt::skip]
        let generator = Matrix4::new(
            0.0,        1.0,  0.0,         k / self.shear(),
            -ratio * k, 0.0,  of_pressure, 0.0,
            0.0,        0.0,  0.0,         -1.0,
            plane,      0.0,  ratio * k,   0.0,
        );
        generator
    }

    /// Matrices of (φ, W) and of (s, t) of the solutions that decay from the upper face, at ξz = s below it, without
    /// e^{−s}.
    fn decaying(&self, x: f64, s: f64) -> (Matrix2<f64>, Matrix2<f64>) {
        let nu = self.poisson;
        let displacements = Matrix2::new(1.0 / x, (s - 1.0 + 2.0 * nu) / x, 1.0, s + 2.0 * (1.0 - nu));
        let factor = -2.0 * self.shear() / (x * x);
        let tractions = Matrix2::new(factor / x, factor / x * (1.0 + s), factor, factor * s);
        (displacements, tractions)
    }

    /// Computes the matrix from (φ, W) to (s, t) at the upper face from the same matrix at the lower face, and the
    /// coupling for the field. `None` if a matrix is singular.
    pub fn up(&self, x: f64, below: &Matrix2<f64>) -> Option<(Matrix2<f64>, Coupling)> {
        let own = x * self.thickness;
        if own < THIN {
            let g = self.generator(x);
            let square = g * g;
            let c = cubic(self.thickness, own);
            let t = Matrix4::identity() * c[0] + g * c[1] + square * c[2] + square * g * c[3];
            let block = |i: usize, j: usize| t.fixed_view::<2, 2>(2 * i, 2 * j).into_owned();
            let above = (block(1, 1) - below * block(0, 1)).try_inverse()? * (below * block(0, 0) - block(1, 0));
            return Some((above, Coupling::Thin(t)));
        }
        let ((near, near_tractions), (far, far_tractions)) = (self.decaying(x, 0.0), self.decaying(x, own));
        let decay = (-own).exp();
        let lower = mirrored(near_tractions) - below * mirrored(near);
        let of_below = lower.try_inverse()? * (below * far - far_tractions) * decay;
        let displacements = near + mirrored(far) * of_below * decay;
        let tractions = near_tractions + mirrored(far_tractions) * of_below * decay;
        let of_above = displacements.try_inverse()?;
        Some((tractions * of_above, Coupling::Thick { of_above, of_below }))
    }

    /// Computes the field and the displacements of the lower face, from the displacements and the matrix at the upper
    /// face.
    pub fn down(
        &self,
        x: f64,
        coupling: &Coupling,
        displacements: Vector2<f64>,
        above: &Matrix2<f64>,
    ) -> (Field, Vector2<f64>) {
        match coupling {
            Coupling::Thin(t) => {
                let tractions = above * displacements;
                let y = Vector4::new(displacements.x, displacements.y, tractions.x, tractions.y);
                let g = self.generator(x);
                let first = g * y;
                let second = g * first;
                (Field::Thin([y, first, second, g * second]), (t * y).xy())
            }
            Coupling::Thick { of_above, of_below } => {
                let from_above = of_above * displacements;
                let from_below = of_below * from_above;
                let own = x * self.thickness;
                let (near, far) = (self.decaying(x, 0.0).0, self.decaying(x, own).0);
                let lower = far * from_above * (-own).exp() + mirrored(near) * from_below;
                (Field::Thick { from_above, from_below }, lower)
            }
        }
    }

    /// Amplitudes at a depth in the layer, in scaled units.
    pub fn amplitudes(&self, x: f64, field: &Field, depth: f64) -> Amplitudes {
        let s = x * depth;
        let [phi, w, sigma, tau] = match field {
            Field::Thin(powers) => {
                let c = cubic(depth, s);
                let y = powers[0] * c[0] + powers[1] * c[1] + powers[2] * c[2] + powers[3] * c[3];
                [y[0], y[1], y[2], y[3]]
            }
            Field::Thick { from_above, from_below } => {
                let rest = x * self.thickness - s;
                let (of_above, tractions_of_above) = self.decaying(x, s);
                let (of_below, tractions_of_below) = self.decaying(x, rest);
                let (from_above, from_below) = (from_above * (-s).exp(), from_below * (-rest).exp());
                let d = of_above * from_above + mirrored(of_below) * from_below;
                let t = tractions_of_above * from_above + mirrored(tractions_of_below) * from_below;
                [d[0], d[1], t[0], t[1]]
            }
        };
        [x * phi, w, x.powi(4) * sigma, x.powi(3) * tau]
    }

    /// Amplitudes in a half-space of this material under a unit pressure.
    pub fn half_space(&self, x: f64, depth: f64) -> Amplitudes {
        let (s, decay) = (x * depth, (-x * depth).exp());
        let compliance = decay / (2.0 * self.shear() * x);
        let nu = self.poisson;
        [compliance * (s - 1.0 + 2.0 * nu), compliance * (s + 2.0 * (1.0 - nu)), -decay * (1.0 + s), -decay * s]
    }
}
