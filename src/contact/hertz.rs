//! Hertz's law of contact between a sphere and a plane (Hertz 1881), and the resulting impact on a half-space.

use super::force_law::positive_part;

/// Exponent of the law, F ~ α^{3/2}.
const EXPONENT: f64 = 1.5;

/// Integral in the contact time: ∫₀¹ dx/√(1 − x^{5/2}) = (2/5) B(2/5, 1/2) = (2/5) √π Γ(2/5)/Γ(9/10).
const TIME_INTEGRAL: f64 = 1.471_637_592_162_352_3;

/// Contact stiffness k0 of (15), N/m^{3/2}, for a sphere of the given radius (m) on a plane, each with its Young's
/// modulus (Pa) and Poisson's ratio.
pub fn stiffness(radius: f64, (young1, poisson1): (f64, f64), (young2, poisson2): (f64, f64)) -> f64 {
    let compliance = (1. - poisson1 * poisson1) / young1 + (1. - poisson2 * poisson2) / young2;
    4. / 3. * radius.sqrt() / compliance
}

/// Hertz's law F = k0 ⟨α⟩^{3/2}, (8) and (9). NaN is passed on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hertz {
    /// Contact stiffness k0, N/m^{3/2}.
    pub stiffness: f64,
}

impl Hertz {
    /// Force at an indentation (m), N; 0 while the bodies are apart.
    pub fn force(&self, indentation: f64) -> f64 {
        let indentation = positive_part(indentation);
        self.stiffness * indentation * indentation.sqrt()
    }

    /// Tangent dF/dα, N/m.
    pub fn tangent(&self, indentation: f64) -> f64 {
        EXPONENT * self.stiffness * positive_part(indentation).sqrt()
    }

    /// Potential ∫ F dα = (2/5) k0 ⟨α⟩^{5/2}, J.
    pub fn potential(&self, indentation: f64) -> f64 {
        self.force(indentation) * positive_part(indentation) / (EXPONENT + 1.)
    }

    /// Indentation (m) at which the tangent reaches a value (N/m).
    pub fn indentation_of_tangent(&self, tangent: f64) -> f64 {
        (tangent / (EXPONENT * self.stiffness)).powi(2)
    }
}

/// Contact time (s) when a free mass (kg) hits a fixed half-space at the given speed (m/s):
/// 2 (α_max/v) ∫₀¹ dx/√(1 − x^{5/2}).
pub fn contact_time(stiffness: f64, mass: f64, speed: f64) -> f64 {
    2. * peak_indentation(stiffness, mass, speed) / speed * TIME_INTEGRAL
}

/// Contact stiffness k0 (N/m^{3/2}) for which that impact has the given contact time (s).
pub fn stiffness_of_contact_time(time: f64, mass: f64, speed: f64) -> f64 {
    let indentation = 0.5 * time * speed / TIME_INTEGRAL;
    0.5 * mass * speed * speed * (EXPONENT + 1.) / indentation.powf(EXPONENT + 1.)
}

/// Largest force (N) of the impact of [`contact_time`].
pub fn peak_force(stiffness: f64, mass: f64, speed: f64) -> f64 {
    Hertz { stiffness }.force(peak_indentation(stiffness, mass, speed))
}

/// Largest indentation α_max (m) of the impact of [`contact_time`]: the potential then equals the kinetic energy.
pub fn peak_indentation(stiffness: f64, mass: f64, speed: f64) -> f64 {
    let ratio = 0.5 * mass * speed * speed * (EXPONENT + 1.) / stiffness;
    ratio.powf(1. / (EXPONENT + 1.))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::{Quadrature, Shape};

    /// Contact stiffness of the paper, N/m^{3/2}: a steel impactor of 50 mm radius on glass.
    const PAPER: f64 = 16_690_188_300.054_407;

    #[test]
    fn stiffness_goes_with_the_contact_time() {
        let found = stiffness_of_contact_time(contact_time(PAPER, 52., 1.2), 52., 1.2);
        assert!((found / PAPER - 1.).abs() < 1e-14);
    }

    #[test]
    fn stiffness_of_the_papers_impactor() {
        let k0 = stiffness(0.05, (70e9, 0.23), (210e9, 0.3));
        assert!((k0 / PAPER - 1.).abs() < 1e-15);
    }

    /// With x^{5/2} = sin²(s⁵) the integral becomes 4 ∫ s³ (s⁵/sin s⁵)^{1/5} ds over 0 < s < (π/2)^{1/5}, which is
    /// smooth.
    #[test]
    fn time_integral_is_that_of_its_definition() {
        let end = std::f64::consts::FRAC_PI_2.powf(0.2);
        let rule = Quadrature::exact(Shape::Quadrilateral, 79);
        // The integrand is constant in the second coordinate, whose weights sum to 2.
        let sum: f64 = rule
            .points
            .iter()
            .zip(&rule.weights)
            .map(|(point, weight)| {
                let s = 0.5 * end * (1. + point[0]);
                let angle = s.powi(5);
                weight / 2. * 0.5 * end * 4. * s.powi(3) * (angle / angle.sin()).powf(0.2)
            })
            .sum();
        assert!((sum - TIME_INTEGRAL).abs() < 1e-14, "{sum}");
    }

    /// Derivative and integral of the law agree with central differences.
    #[test]
    fn force_is_the_slope_of_the_potential_and_tangent_that_of_the_force() {
        let law = Hertz { stiffness: PAPER };
        for indentation in [1e-6, 3e-5, 4e-4] {
            // Relative error of the differences: about (step/α)²/24, and rounding over step/α: 1e-9 in all.
            let step = 1e-5 * indentation;
            let slope =
                |f: fn(&Hertz, f64) -> f64| (f(&law, indentation + step) - f(&law, indentation - step)) / (2. * step);
            let force = law.force(indentation);
            assert!((slope(Hertz::potential) / force - 1.).abs() < 1e-9);
            assert!((slope(Hertz::force) / law.tangent(indentation) - 1.).abs() < 1e-9);
        }
        for apart in [0., -1e-6, f64::NEG_INFINITY] {
            assert_eq!([law.force(apart), law.tangent(apart), law.potential(apart)], [0.; 3]);
        }
        assert!(law.force(f64::NAN).is_nan());
    }

    /// Integrates m q̈ = −F by the classical Runge–Kutta scheme from the first touch on, and compares contact time and
    /// peak with the formulas.
    #[test]
    fn impact_on_a_half_space_integrated_in_time() {
        let (mass, speed) = (52., 1.2);
        let law = Hertz { stiffness: PAPER };
        let acceleration = |q: f64| -law.force(q) / mass;
        let expected = contact_time(PAPER, mass, speed);
        let steps = 20_000;
        let dt = expected / f64::from(steps);
        let (mut q, mut v, mut peak) = (0., speed, 0_f64);
        for _ in 0..steps {
            let (q1, v1) = (v, acceleration(q));
            let (q2, v2) = (v + dt / 2. * v1, acceleration(q + dt / 2. * q1));
            let (q3, v3) = (v + dt / 2. * v2, acceleration(q + dt / 2. * q2));
            let (q4, v4) = (v + dt * v3, acceleration(q + dt * q3));
            q += dt / 6. * (q1 + 2. * (q2 + q3) + q4);
            v += dt / 6. * (v1 + 2. * (v2 + v3) + v4);
            peak = peak.max(law.force(q));
        }
        // At the touch the order is 5/2: (1/20000)^{5/2} = 2e-11. The peak lies between two steps: (1/20000)² = 3e-9.
        assert!(q.abs() < 1e-9 * speed * expected, "{q:e}");
        assert!((v / speed + 1.).abs() < 1e-9, "{v}");
        assert!((peak / peak_force(PAPER, mass, speed) - 1.).abs() < 1e-8);
    }
}
