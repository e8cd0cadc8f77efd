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
//! For g = 0 this is Hertz's law. On a thin soft layer C(a) is positive but far larger than the local deflection, because it is
//! relative to that of a point force. The body carries the force on a wider disc; c F is the part of α that is not local to it:
//!
//! c = (1/2π) ∫ {H P_d² + (Γ − H) (P_d² − 1)} ξ dξ,
//!
//! with the transform P_d of the pressure on that disc. The law is therefore given for the indentation relative to the mean
//! displacement of the disc, α − c F, which increases with F as long as the contact is much smaller than the disc.

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

/// Largest ratio of the tangent to F/α; it is 1.5 for Hertz's law, and 2 for a thin compressible layer. It is larger where the
/// contact is so wide that the body bends less under it than under the disc, whose pressure is that of a point on long waves.
/// There the law ends.
const STEEPEST: f64 = 4.0;

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

/// Contact of a sphere with a stack, on any disc.
pub struct SphereOnStack<'a> {
    stack: &'a Stack,
    sphere: Sphere,
    beyond: Beyond,
    /// First contact radius, m.
    first: f64,
    /// States that were needed so far; each takes a sum over all waves.
    states: Vec<State>,
}

/// State of the contact, whose indentation is relative to a point force on the stack.
#[derive(Clone, Copy)]
struct State {
    /// Contact radius a, m.
    radius: f64,
    /// Force F, N.
    force: f64,
    /// Approach F C(a) + a²/5R, m.
    approach: f64,
}

impl<'a> SphereOnStack<'a> {
    /// Contact in an impact of an energy (J) that determines the first contact radius. `longest` is the wavenumber (1/m) of the
    /// longest wave.
    pub fn new(stack: &'a Stack, sphere: Sphere, longest: f64, energy: f64) -> Self {
        let of_hertz = (2.5 * energy / (4.0 / 3.0 * sphere.modulus * sphere.radius.sqrt())).powf(0.4);
        let first = FIRST * (sphere.radius * of_hertz).sqrt();
        Self { stack, sphere, beyond: Beyond::new(stack, longest), first, states: Vec::new() }
    }

    /// Law of the contact, for a disc of a radius (m) on which the body carries the force.
    pub fn on_disc(&mut self, disc: f64) -> ContactLaw {
        let compliance = self.lacking(disc);
        ContactLaw { points: self.points(compliance), compliance }
    }

    /// Law of the contact whose indentations are relative to a point force.
    pub fn at_point(&mut self) -> ContactLaw {
        ContactLaw { points: self.points(0.0), compliance: 0.0 }
    }

    /// Forces (N), ascending, with the contact radius (m) at each, up to the first force of at least `end`, or up to where the
    /// radius can no longer be computed. They do not depend on the disc, and go beyond the end of a law on a disc.
    pub fn radii(&mut self, end: f64) -> Vec<[f64; 2]> {
        let mut radii = vec![[0.0; 2]];
        while let Some(State { radius, force, .. }) = self.state(radii.len() - 1) {
            let [before, _] = radii[radii.len() - 1];
            if before >= end || force <= before {
                break;
            }
            radii.push([force, radius]);
        }
        radii
    }

    /// Points of the law whose indentations are without `compliance` (m/N) times the force.
    fn points(&mut self, compliance: f64) -> Vec<ContactPoint> {
        let mut points = vec![ContactPoint::default()];
        while let Some(State { force, approach, .. }) = self.state(points.len() - 1) {
            let indentation = approach - compliance * force;
            let before = points[points.len() - 1];
            let (rise, width) = (force - before.force, indentation - before.indentation);
            if !(rise > 0.0 && width > 0.0 && rise * indentation < STEEPEST * force * width) {
                break;
            }
            points.push(ContactPoint { indentation, force });
        }
        points
    }

    /// A state by its number; `None` beyond the largest radius, or where the mean displacement no longer falls with the radius.
    fn state(&mut self, number: usize) -> Option<State> {
        if number < self.states.len() || number >= MOST_POINTS {
            return self.states.get(number).copied();
        }
        let Sphere { radius, modulus } = self.sphere;
        let a = self.states.last().map_or(self.first, |last| GROWTH * last.radius);
        let ([g, slope], half_space) = (self.beyond.at(a), 0.6 / (modulus * a));
        // a C′(a), negative.
        let slope = slope - half_space;
        if slope.is_nan() || slope >= 0.0 {
            return None;
        }
        let force = -0.8 * a * a / (radius * slope);
        let state = State { radius: a, force, approach: force * (half_space + g) + 0.2 * a * a / radius };
        self.states.push(state);
        Some(state)
    }

    /// c of the module's documentation, m/N.
    fn lacking(&self, disc: f64) -> f64 {
        let (spread, struck) = (Spread::new(0.0), self.stack.layers()[0]);
        let of_waves = self.beyond.0.iter().map(|(xi, weight)| weight * spread.over_waves(xi * disc));
        0.6 * (1.0 - struck.poisson.powi(2)) / struck.young * spread.compliance() / disc + of_waves.sum::<f64>()
    }
}

/// Contact of a sphere with a stack.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactLaw {
    /// States of the contact, from the first touch on.
    pub points: Vec<ContactPoint>,
    /// Compliance c (m/N) of the disc that these indentations do not contain.
    pub compliance: f64,
}

impl ContactLaw {
    /// Largest force of the law, N.
    pub fn largest_force(&self) -> f64 {
        self.points.last().map_or(0.0, |point| point.force)
    }

    /// Energy stored at the end of the law, J.
    pub fn capacity(&self) -> f64 {
        let of_pair =
            |pair: &[ContactPoint]| 0.5 * (pair[0].force + pair[1].force) * (pair[1].indentation - pair[0].indentation);
        self.points.windows(2).map(of_pair).sum()
    }
}

/// State of the contact of a sphere with a stack.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ContactPoint {
    /// Indentation relative to the mean displacement of the disc, m.
    pub indentation: f64,
    /// Force, N.
    pub force: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{ForceLaw, Hertz, Table};
    use crate::stack::Layer;

    fn table(points: &[ContactPoint]) -> Table {
        let points: Vec<[f64; 2]> = points.iter().map(|point| [point.indentation, point.force]).collect();
        Table::new(&points).expect("a table")
    }

    const SPHERE: Sphere = Sphere { radius: 0.05, modulus: 2.5e9 };

    fn stack(layers: &[(f64, f64, f64)]) -> Stack {
        let layer = |&(thickness, young, poisson)| Layer { thickness, young, poisson };
        Stack::new(&layers.iter().map(layer).collect::<Vec<_>>()).expect("elastic layers")
    }

    /// On a layer much thicker than the contact disc the law is Hertz's.
    #[test]
    fn small_discs_have_hertzs_law() {
        let energy = 1e-3;
        let stack = stack(&[(0.2, 2.4e9, 0.23), (0.1, 70e9, 0.23)]);
        let points = SphereOnStack::new(&stack, SPHERE, 10.0, energy).points(0.0);
        let found = ForceLaw::Table(table(&points));
        let hertz = ForceLaw::Hertz(Hertz { stiffness: 4.0 / 3.0 * SPHERE.modulus * SPHERE.radius.sqrt() });
        for part in [0.1, 0.5, 0.9] {
            let indentation = part * found.peak_indentation(2.0 * energy, 1.0);
            // The disc is 1.3 mm wide; g is 1e-5 of the compliance, and the cubics err by 1e-5.
            let error = found.force(indentation) / hertz.force(indentation) - 1.0;
            assert!(error.abs() < 5e-5, "{part}: {error:e}");
        }
    }

    /// On a layer much thicker than the contact disc the contact radius is Hertz's, also beyond the end of a law on a disc.
    #[test]
    fn small_discs_have_hertzs_radius() {
        let stack = stack(&[(0.2, 2.4e9, 0.23), (0.1, 70e9, 0.23)]);
        let mut contact = SphereOnStack::new(&stack, SPHERE, 10.0, 1e-3);
        let end = 100.0 * contact.on_disc(4e-3).largest_force();
        let radii = contact.radii(end);
        assert!(radii[radii.len() - 1][0] >= end, "{radii:?}");
        for [force, radius] in radii.into_iter().skip(1).filter(|[_, radius]| *radius < 4e-3) {
            // −a² g′ over 0.6/E* is below (a/h)³ for the thickness h.
            let hertz = (0.75 * force * SPHERE.radius / SPHERE.modulus).cbrt();
            assert!((radius / hertz - 1.0).abs() < 1e-4, "{force}: {radius} {hertz}");
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
            let points = SphereOnStack::new(&stack(layers), sphere, 10.0, exact * alpha).points(0.0);
            let found = ForceLaw::Table(table(&points)).force(alpha);
            // Hertz's pressure in place of the true one: at most 0.3% here.
            assert!((found / exact - 1.0).abs() < 4e-3, "{line}: {found}");
            compared += 1;
        }
        assert_eq!(compared, 6);
    }
}
