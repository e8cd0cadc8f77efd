//! The contact force as a function of the indentation: Hertz's law, a power law, or a table.

use std::f64::consts::PI;

use super::{Hertz, Table, hertz};

/// Contact force F(α): zero for α ≤ 0 and non-decreasing. NaN is passed on.
#[derive(Debug, Clone, PartialEq)]
pub enum ForceLaw {
    /// Hertz's law F = k0 ⟨α⟩^{3/2}, (8) and (9).
    Hertz(Hertz),
    /// Power law F = k ⟨α⟩^n.
    Power(Power),
    /// Monotone cubic interpolation of measured points.
    Table(Table),
}

/// Power law F = k ⟨α⟩^n.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Power {
    /// Stiffness k, N/m^n.
    pub stiffness: f64,
    /// Exponent n, 1 or more.
    pub exponent: f64,
}

impl Power {
    /// Indentation (m) at which the tangent n k α^{n−1} reaches a value (N/m); 0 or infinite for n = 1.
    fn indentation_of_tangent(&self, tangent: f64) -> f64 {
        let Self { stiffness, exponent } = *self;
        if exponent > 1.0 {
            return (tangent / (exponent * stiffness)).powf(1.0 / (exponent - 1.0));
        }
        if tangent > stiffness { f64::INFINITY } else { 0.0 }
    }
}

impl ForceLaw {
    /// Name of the law in a scene.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Hertz(_) => "hertz",
            Self::Power(_) => "power",
            Self::Table(_) => "table",
        }
    }

    /// Force at an indentation (m), N; 0 while the bodies are apart.
    pub fn force(&self, indentation: f64) -> f64 {
        match self {
            Self::Hertz(law) => law.force(indentation),
            Self::Power(Power { stiffness, exponent }) => stiffness * positive_part(indentation).powf(*exponent),
            Self::Table(table) => table.force(indentation),
        }
    }

    /// Tangent dF/dα, N/m; 0 while the bodies are apart.
    pub fn tangent(&self, indentation: f64) -> f64 {
        match self {
            Self::Hertz(law) => law.tangent(indentation),
            Self::Power(_) if indentation <= 0.0 => 0.0,
            Self::Power(Power { stiffness, exponent }) => stiffness * exponent * indentation.powf(exponent - 1.0),
            Self::Table(table) => table.tangent(indentation),
        }
    }

    /// Potential ∫ F dα, J.
    pub fn potential(&self, indentation: f64) -> f64 {
        match self {
            Self::Hertz(law) => law.potential(indentation),
            Self::Power(Power { exponent, .. }) => {
                self.force(indentation) * positive_part(indentation) / (exponent + 1.0)
            }
            Self::Table(table) => table.potential(indentation),
        }
    }

    /// The law of one of n equal parts of a body, which carries 1/n of the force.
    pub fn part(&self, multiplicity: f64) -> Self {
        self.scaled(1.0 / multiplicity)
    }

    /// The law with its forces multiplied by a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Hertz(Hertz { stiffness }) => Self::Hertz(Hertz { stiffness: stiffness * factor }),
            Self::Power(law) => Self::Power(Power { stiffness: law.stiffness * factor, ..*law }),
            Self::Table(table) => Self::Table(table.scaled(factor)),
        }
    }

    /// Largest indentation (m) at which the law is defined: the end of a table, otherwise infinite.
    pub fn end(&self) -> f64 {
        if let Self::Table(table) = self { table.end() } else { f64::INFINITY }
    }

    /// Least indentation (m) from which the tangent is above a value (N/m); infinite if it never is.
    pub fn indentation_of_tangent(&self, tangent: f64) -> f64 {
        match self {
            Self::Hertz(law) => law.indentation_of_tangent(tangent),
            Self::Power(law) => law.indentation_of_tangent(tangent),
            Self::Table(table) => table.indentation_of_tangent(tangent),
        }
    }

    /// Largest tangent up to an indentation (m), N/m.
    pub fn steepest(&self, indentation: f64) -> f64 {
        if let Self::Table(table) = self { table.steepest(indentation) } else { self.tangent(indentation) }
    }

    /// Indentation (m) at a force (N).
    pub fn indentation(&self, force: f64) -> f64 {
        match self {
            Self::Hertz(Hertz { stiffness }) => (force / stiffness).powf(2.0 / 3.0),
            Self::Power(Power { stiffness, exponent }) => (force / stiffness).powf(1.0 / exponent),
            Self::Table(table) => table.indentation(force),
        }
    }

    /// Largest indentation α_max (m) when a free mass (kg) hits a fixed body at the given speed (m/s): the potential
    /// then equals the kinetic energy.
    pub fn peak_indentation(&self, mass: f64, speed: f64) -> f64 {
        let energy = 0.5 * mass * speed * speed;
        match self {
            Self::Hertz(Hertz { stiffness }) => hertz::peak_indentation(*stiffness, mass, speed),
            Self::Power(Power { stiffness, exponent }) => {
                (energy * (exponent + 1.0) / stiffness).powf(1.0 / (exponent + 1.0))
            }
            Self::Table(table) => table.indentation_of_potential(energy),
        }
    }

    /// Largest force (N) of the impact of [`ForceLaw::peak_indentation`].
    pub fn peak_force(&self, mass: f64, speed: f64) -> f64 {
        self.force(self.peak_indentation(mass, speed))
    }

    /// Contact time (s) of the same impact, 2 ∫ dα/√(v² − 2V/m): exact for powers, with an error of 1e-6 for tables.
    pub fn contact_time(&self, mass: f64, speed: f64) -> f64 {
        let way = self.peak_indentation(mass, speed);
        match self {
            Self::Hertz(Hertz { stiffness }) => hertz::contact_time(*stiffness, mass, speed),
            Self::Power(Power { exponent, .. }) => {
                // ∫₀¹ dx/√(1 − x^p) = √π Γ(1 + 1/p)/Γ(1/2 + 1/p).
                let part = 1.0 / (exponent + 1.0);
                2.0 * way / speed * PI.sqrt() * libm::tgamma(1.0 + part) / libm::tgamma(0.5 + part)
            }
            Self::Table(_) => {
                // The substitution α = α_max (1 − s²) removes the zero of the root from the integrand, which is then
                // integrated by the midpoint rule.
                const POINTS: usize = 2000;
                let energy = self.potential(way);
                let value = |i: usize| {
                    let s = (i as f64 + 0.5) / POINTS as f64;
                    let left = (1.0 - self.potential(way * (1.0 - s * s)) / energy).max(f64::MIN_POSITIVE);
                    2.0 * s / left.sqrt()
                };
                2.0 * way / speed * (0..POINTS).map(value).sum::<f64>() / POINTS as f64
            }
        }
    }
}

/// The positive part ⟨α⟩; NaN stays NaN.
pub(super) fn positive_part(indentation: f64) -> f64 {
    indentation.clamp(0.0, f64::INFINITY)
}

/// Zero of a non-decreasing function between two places; the function returns its value and slope. Newton's method,
/// safeguarded by a shrinking bracket.
pub(super) fn zero(mut low: f64, mut high: f64, function: impl Fn(f64) -> (f64, f64)) -> f64 {
    /// Largest number of iterations: enough to bisect from 1e308 down to rounding.
    const MAX_ITERATIONS: usize = 2200;
    let mut x = 0.5 * (low + high);
    for _ in 0..MAX_ITERATIONS {
        let (value, slope) = function(x);
        if value == 0.0 || value.is_nan() {
            break;
        }
        *(if value > 0.0 { &mut high } else { &mut low }) = x;
        let newton = x - value / slope;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= f64::EPSILON * x.abs() {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laws() -> [ForceLaw; 4] {
        let points: Vec<[f64; 2]> = (0..=40).map(|i| 1e-3 * f64::from(i)).map(|x| [x, 5e4 * x.powf(1.3)]).collect();
        [
            ForceLaw::Hertz(Hertz { stiffness: 1.669e10 }),
            ForceLaw::Power(Power { stiffness: 1.669e10, exponent: 1.5 }),
            ForceLaw::Power(Power { stiffness: 5e4, exponent: 1.0 }),
            ForceLaw::Table(Table::new(&points).unwrap()),
        ]
    }

    /// A power law with exponent 3/2 is Hertz's law.
    #[test]
    fn hertz_is_a_power() {
        let [hertz, power, ..] = laws();
        let (mass, speed) = (52.0, 1.2);
        let of = |law: &ForceLaw| {
            let way = law.peak_indentation(mass, speed);
            [way, law.force(way), law.tangent(way), law.potential(way), law.contact_time(mass, speed)]
        };
        for (a, b) in of(&hertz).into_iter().zip(of(&power)) {
            // Rounding errors of powers.
            assert!((a / b - 1.0).abs() < 1e-13, "{a} {b}");
        }
        assert!((hertz.indentation_of_tangent(1e8) / power.indentation_of_tangent(1e8) - 1.0).abs() < 1e-13);
    }

    /// Each force is the derivative of its potential, each tangent the derivative of the force, and inverse functions
    /// are exact.
    #[test]
    fn derivatives_and_inverses() {
        for law in laws() {
            let top = law.peak_indentation(0.5, 1.0).min(0.9 * law.end());
            for part in [0.013, 0.2, 0.77, 0.99] {
                let x = part * top;
                // Relative error of the differences: about (step/α)²/24, and rounding over step/α: 1e-8 in all.
                let step = 1e-5 * x;
                let slope = |f: fn(&ForceLaw, f64) -> f64| (f(&law, x + step) - f(&law, x - step)) / (2.0 * step);
                assert!((slope(ForceLaw::potential) / law.force(x) - 1.0).abs() < 1e-8);
                assert!((slope(ForceLaw::force) / law.tangent(x) - 1.0).abs() < 1e-5, "{law:?} {x}");
                assert!((law.indentation(law.force(x)) / x - 1.0).abs() < 1e-12);
            }
            for apart in [0.0, -1e-6, f64::NEG_INFINITY] {
                assert_eq!([law.force(apart), law.tangent(apart), law.potential(apart)], [0.0; 3]);
            }
            assert!(law.force(f64::NAN).is_nan());
        }
    }

    /// A mass on a linear spring has a contact time of half a period. A table of points of a power law approximates
    /// that law.
    #[test]
    fn contact_times() {
        let [.., spring, table] = laws();
        assert!((spring.contact_time(2.0, 1.0) / (PI * (2.0_f64 / 5e4).sqrt()) - 1.0).abs() < 1e-14);
        let power = ForceLaw::Power(Power { stiffness: 5e4, exponent: 1.3 });
        let (found, exact) = (table.contact_time(2.0, 1.0), power.contact_time(2.0, 1.0));
        // Of the 41 points about a dozen are passed. The cubics' error is about 1e-4 near the first point, where the
        // power law has zero slope.
        assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact}");
    }

    #[test]
    fn zeros_are_found() {
        let cubic = |x: f64| (x * x * x - 2.0, 3.0 * x * x);
        assert!((zero(0.0, 1e6, cubic) - 2.0_f64.cbrt()).abs() < 1e-15);
        // A function that is first constant, then steep.
        let kink = |x: f64| if x < 1.0 { (-1.0, 0.0) } else { (1e9 * (x - 1.0) - 1.0, 1e9) };
        assert!((zero(0.0, 1e3, kink) - 1.0 - 1e-9).abs() < 1e-15);
    }
}
