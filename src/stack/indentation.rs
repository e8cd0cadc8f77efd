//! Contact of a sphere with the loaded face of a stack of layers.
//!
//! Hertz's law holds as long as the contact disc is small compared with the layer that is hit. A soft layer on a stiff
//! one is compressed by a disc as wide as the layer is thick, and becomes stiffer than a half-space. By Ritz's method, let
//! the pressure be Hertz's on a disc of an unknown radius a, with an unknown force F. Its mean displacement per unit of
//! force, weighted by the pressure, is C(a) = 3/(5 E* a) + g(a) with
//!
//! g(a) = (1/2π) ∫ (Γ − H) (P² − 1) ξ dξ.
//!
//! Γ and H are the responses of the stack and of a half-space of the impacted layer at the wavenumber ξ, P is the
//! transform of Hertz's pressure, and E* is the contact modulus. g is the difference from a point force, whose deflection
//! (1/2π) ∫ (Γ − H) ξ dξ belongs to the body. The complementary energy ½ F² C − F (α − a²/5R) is stationary for
//!
//! F = −4a/(5R C′(a)),   α = F C(a) + a²/(5R).
//!
//! For g = 0 this is Hertz's law. On a thin compressible layer on a rigid base, where the pressure is a paraboloid, F is
//! 1.2% below the exact force at the same α.

use std::f64::consts::PI;

use super::Stack;
use crate::element::gauss_legendre;
use crate::form::{Spread, hertz_terms, hertz_wave};

/// Elastic sphere that touches the loaded face of a stack.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Radius R, m.
    pub radius: f64,
    /// Contact modulus E* of the sphere and the impacted layer, Pa: 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂.
    pub modulus: f64,
}

/// Value of ξh, h the thickness of the impacted layer, above which a stack responds like the half-space.
const HALF_SPACE: f64 = 22.0;

/// Ratio of the ends of each panel of the integrals over wavenumbers.
const PANEL: f64 = 1.25;

/// Ratio of successive contact radii: the cubics between the points then have an error of 1e-5 of the force.
const GROWTH: f64 = 1.04;

/// First contact radius over that of Hertz's law at the given energy: 1e-6 of the force.
const FIRST: f64 = 1e-2;

/// Largest number of points: the last radius is 25 times that of Hertz's law.
const MOST_POINTS: usize = 200;

/// Largest tangent of the law times the compliance that a body lacks. At 1 the contact would have negative stiffness.
/// Near it the contact is so stiff that modal coordinates leave out too many modes: histories were wrong by 6% at 0.87,
/// and right up to 0.8.
const LARGEST_TANGENT: f64 = 0.8;

/// Wavenumbers ξ (1/m) with the weights of an integral over (Γ − H) ξ dξ/2π, m/N.
struct Beyond(Vec<(f64, f64)>);

impl Beyond {
    fn new(stack: &Stack, longest: f64) -> Self {
        let struck = stack.layers()[0];
        let half_space = 2.0 * (1.0 - struck.poisson.powi(2)) / struck.young;
        let rule = gauss_legendre(10);
        let (mut waves, mut from) = (Vec::new(), longest);
        let end = HALF_SPACE / struck.thickness;
        while from < end {
            let to = (PANEL * from).min(end);
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            waves.extend(rule.iter().map(|(x, weight)| {
                let xi = middle + half * x;
                let response = stack.wave(xi).response(stack, 0.0).u_z - half_space / xi;
                (xi, half * weight * response * xi / (2.0 * PI))
            }));
            from = to;
        }
        Self(waves)
    }

    /// g(a) and a g′(a), m/N.
    fn at(&self, radius: f64) -> [f64; 2] {
        let terms = self.0.iter().map(|(xi, weight)| {
            let x = xi * radius;
            let wave = hertz_wave(x);
            let below_one = if x < 1.0 { hertz_terms(x, 1) } else { wave - 1.0 };
            [weight * below_one * (wave + 1.0), weight * 2.0 * wave * x * slope(x)]
        });
        terms.fold([0.0; 2], |sum, term| [sum[0] + term[0], sum[1] + term[1]])
    }
}

/// Derivative of [`hertz_wave`].
fn slope(x: f64) -> f64 {
    if x >= 1.0 {
        return 3.0 * x.sin() / (x * x) - 3.0 * hertz_wave(x) / x;
    }
    // Terms 6 (k+1) (−1)^k 2k x^{2k−1}/(2k+3)! from k = 1 on; each is twice k times that of the wave over x.
    let (mut term, mut sum) = (1.0, 0.0);
    for k in 1..10 {
        let n = f64::from(k);
        term *= -x * x * (n + 1.0) / (n * (2.0 * n + 2.0) * (2.0 * n + 3.0));
        sum += 2.0 * n * term;
    }
    sum / x
}

impl Stack {
    /// Indentation (m) and force (N) in the contact with a sphere, from (0, 0) to far beyond the force at which the law
    /// has stored an energy (J). `longest` is the wavenumber (1/m) of the longest wave. `disc` is the radius (m) of the disc
    /// on which a body carries the force.
    ///
    /// `None` if the indentation does not increase with the force until the law has stored twice the energy: then the body
    /// deflects by more than the indentation. Also `None` if the contact with such a body would nearly have negative
    /// stiffness, because the layer is much thinner than the disc.
    pub fn contact_law(&self, sphere: &Sphere, longest: f64, disc: f64, energy: f64) -> Option<Vec<[f64; 2]>> {
        let beyond = Beyond::new(self, longest);
        let Ritz { points, steepest } = Ritz::new(&beyond, sphere, energy)?;
        (steepest * self.lacking(&beyond, disc) < LARGEST_TANGENT).then_some(points)
    }

    /// (1/2π) ∫ {H P² + (Γ − H) (P² − 1)} ξ dξ, m/N, with the pressure that a body carries on a disc of a radius (m).
    fn lacking(&self, beyond: &Beyond, disc: f64) -> f64 {
        let (spread, struck) = (Spread::new(0.0), self.layers()[0]);
        let of_waves = beyond.0.iter().map(|(xi, weight)| weight * spread.over_waves(xi * disc));
        0.6 * (1.0 - struck.poisson.powi(2)) / struck.young * spread.compliance() / disc + of_waves.sum::<f64>()
    }
}

/// The law, from (0, 0) to far beyond an energy.
struct Ritz {
    /// Indentations (m) and forces (N).
    points: Vec<[f64; 2]>,
    /// Largest tangent up to the energy, N/m.
    steepest: f64,
}

impl Ritz {
    /// `None` if the indentation does not increase with the force until twice the energy (J) is stored.
    fn new(beyond: &Beyond, sphere: &Sphere, energy: f64) -> Option<Self> {
        let Sphere { radius, modulus } = *sphere;
        let of_hertz = (2.5 * energy / (4.0 / 3.0 * modulus * radius.sqrt())).powf(0.4);
        let mut points = vec![[0.0; 2]];
        let (mut stored, mut steepest) = (0.0, 0.0_f64);
        let mut a = FIRST * (radius * of_hertz).sqrt();
        while points.len() <= MOST_POINTS {
            let ([g, slope], half_space) = (beyond.at(a), 0.6 / (modulus * a));
            // a C′(a), negative.
            let slope = slope - half_space;
            let force = -0.8 * a * a / (radius * slope);
            let indentation = force * (half_space + g) + 0.2 * a * a / radius;
            let [before, force_before] = points[points.len() - 1];
            if !(slope < 0.0 && indentation > before && force > force_before && force.is_finite()) {
                break;
            }
            if stored < energy {
                steepest = steepest.max((force - force_before) / (indentation - before));
            }
            stored += 0.5 * (force + force_before) * (indentation - before);
            points.push([indentation, force]);
            a *= GROWTH;
        }
        (stored > 2.0 * energy).then_some(Self { points, steepest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{ForceLaw, Hertz, Table};
    use crate::stack::Layer;

    const SPHERE: Sphere = Sphere { radius: 0.05, modulus: 2.5e9 };

    fn stack(layers: &[(f64, f64, f64)]) -> Stack {
        let layer = |&(thickness, young, poisson)| Layer { thickness, young, poisson };
        Stack::new(&layers.iter().map(layer).collect::<Vec<_>>()).expect("elastic layers")
    }

    /// On a layer much thicker than the contact disc the law is Hertz's.
    #[test]
    fn small_discs_have_hertzs_law() {
        let energy = 1e-3;
        let beyond = Beyond::new(&stack(&[(0.2, 2.4e9, 0.23), (0.1, 70e9, 0.23)]), 10.0);
        let ritz = Ritz::new(&beyond, &SPHERE, energy).expect("a law");
        let found = ForceLaw::Table(Table::new(&ritz.points).expect("a table"));
        let hertz = ForceLaw::Hertz(Hertz { stiffness: 4.0 / 3.0 * SPHERE.modulus * SPHERE.radius.sqrt() });
        for part in [0.1, 0.5, 0.9] {
            let indentation = part * found.peak_indentation(2.0 * energy, 1.0);
            // The disc is 1.3 mm wide; g is 1e-5 of the compliance, and the cubics err by 1e-5.
            let error = found.force(indentation) / hertz.force(indentation) - 1.0;
            assert!(error.abs() < 5e-5, "{part}: {error:e}");
        }
    }

    /// Contact with a soft layer on a stiff one by another program (scripts/independent/indentation.py), on discs of 0.4 to
    /// 1.6 times the layer's thickness.
    #[test]
    fn soft_layers_are_indented_as_by_another_program() {
        let cases = [
            ("plastic", 2.5e9, [(0.006, 2.4e9, 0.23), (0.008, 70e9, 0.23)]),
            ("coat", 3.8e8, [(0.002, 2.95e8, 0.475), (0.012, 70e9, 0.23)]),
        ];
        let mut compared = 0;
        for line in include_str!("../../tests/fixtures/independent/indentation.csv").lines() {
            let [name, alpha, force] = line.split(',').collect::<Vec<_>>()[..] else { panic!("{line}") };
            let (_, modulus, layers) = cases.iter().find(|(case, ..)| *case == name).expect("a case");
            let [alpha, exact]: [f64; 2] = [alpha, force].map(|value| value.parse().expect("a number"));
            let sphere = Sphere { modulus: *modulus, ..SPHERE };
            let ritz = Ritz::new(&Beyond::new(&stack(layers), 10.0), &sphere, exact * alpha).expect("a law");
            let found = ForceLaw::Table(Table::new(&ritz.points).expect("a table")).force(alpha);
            // Hertz's pressure in place of the true one: at most 0.3% here.
            assert!((found / exact - 1.0).abs() < 4e-3, "{line}: {found}");
            compared += 1;
        }
        assert_eq!(compared, 6);
    }
}
