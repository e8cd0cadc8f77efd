//! Impact on an infinite plate (Zener, The intrinsic inelasticity of large plates, Phys. Rev. 59, 1941).
//!
//! Under a force F an infinite Kirchhoff plate moves at the speed F/Z with the impedance Z = 8 √(ρ h D). The impactor's
//! mass m0 and Hertz's law then give
//!
//! σ″ + (1 + λ d/dτ)⟨σ⟩^{3/2} = 0,  σ(0) = 0,  σ′(0) = 1,  λ = k0^{2/5} v^{1/5} m0^{3/5} / Z,
//!
//! with time in units of T = (m0²/(k0² v))^{1/5} and the indentation α in units of v T.

use super::Hertz;
use crate::form::Material;

/// Step of the integration up to the peak, in units of the scaled time. The error is 1e-7, due to the kink of ⟨σ⟩^{3/2}
/// at the touch.
const STEP: f64 = 1e-3;

/// Impedance Z (N s/m) of a plate of a material and a thickness (m).
pub fn impedance(material: &Material, thickness: f64) -> f64 {
    let Material { young, poisson, density } = *material;
    let bending = young * thickness.powi(3) / (12. * (1. - poisson * poisson));
    8. * (density * thickness * bending).sqrt()
}

/// Largest indentation (m) when a mass (kg) hits a plate of the given impedance (N s/m) at a speed (m/s), without
/// echoes. It is smaller than on a half-space, which corresponds to an infinite impedance.
pub fn peak_indentation(stiffness: f64, mass: f64, speed: f64, impedance: f64) -> f64 {
    let lambda = stiffness.powf(0.4) * speed.powf(0.2) * mass.powf(0.6) / impedance;
    (mass * speed * speed / stiffness).powf(0.4) * peak(lambda)
}

/// Upper limit of [`peak_indentation`] (m) in closed form.
pub fn peak_indentation_limit(stiffness: f64, mass: f64, speed: f64, impedance: f64) -> f64 {
    // The contact stores at most the kinetic energy.
    let on_half_space = (1.25 * mass * speed * speed / stiffness).powf(0.4);
    // At the peak, the plate and the impactor have the same speed F/Z. It is at most the initial speed v, so F ≤ Z v.
    on_half_space.min((impedance * speed / stiffness).powf(2. / 3.))
}

/// Largest σ; 0 for infinite λ.
fn peak(lambda: f64) -> f64 {
    let mut motion = Motion::new(lambda);
    let mut sigma = motion.sigma();
    loop {
        motion.step(STEP);
        if motion.sigma() > sigma {
            sigma = motion.sigma();
        } else {
            return sigma;
        }
    }
}

/// The motion in scaled coordinates, which stay of order one up to the peak for every λ: s = σ/S and w = σ′ + λσ^{3/2},
/// with the time τ/S and S = min(1, λ^{-2/3}). Then s′ = w − λ S^{3/2} ⟨s⟩^{3/2} and w′ = −S^{5/2} ⟨s⟩^{3/2}.
struct Motion {
    /// Scale S.
    scale: f64,
    /// Coefficient of radiation, λ S^{3/2}.
    radiation: f64,
    s: f64,
    w: f64,
}

/// Force law in these units.
const LAW: Hertz = Hertz { stiffness: 1. };

impl Motion {
    fn new(lambda: f64) -> Self {
        let scale = lambda.powf(-2. / 3.).min(1.);
        Self { scale, radiation: lambda.min(1.), s: 0., w: 1. }
    }

    fn sigma(&self) -> f64 {
        self.scale * self.s
    }

    fn rates(&self, s: f64, w: f64) -> (f64, f64) {
        let force = LAW.force(s);
        (w - self.radiation * force, -self.scale.powf(2.5) * force)
    }

    /// Makes a step by the classical Runge–Kutta method.
    fn step(&mut self, dt: f64) {
        let (s1, w1) = self.rates(self.s, self.w);
        let (s2, w2) = self.rates(self.s + dt / 2. * s1, self.w + dt / 2. * w1);
        let (s3, w3) = self.rates(self.s + dt / 2. * s2, self.w + dt / 2. * w2);
        let (s4, w4) = self.rates(self.s + dt * s3, self.w + dt * w3);
        self.s += dt / 6. * (s1 + 2. * (s2 + s3) + s4);
        self.w += dt / 6. * (w1 + 2. * (w2 + w3) + w4);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::hertz;

    /// λ, coefficient of restitution, peak force and contact time, each to five digits.
    const TABLE: [(f64, f64, f64, f64); 5] = [
        (0.1, 0.84334, 1.03555, 3.27849),
        (0.2, 0.71404, 0.94606, 3.34866),
        (0.5, 0.43690, 0.75023, 3.62444),
        (1.0, 0.18412, 0.55616, 4.38761),
        (2.0, 0.02068, 0.36466, 8.48322),
    ];

    #[test]
    fn known_impacts_up_to_separation() {
        for (lambda, restitution, force, time) in TABLE {
            assert!((LAW.force(peak(lambda)) - force).abs() < 6e-6, "λ = {lambda}: {}", LAW.force(peak(lambda)));
            let mut motion = Motion::new(lambda);
            let mut steps = 0;
            while motion.s > 0. || steps == 0 {
                motion.step(STEP);
                steps += 1;
            }
            // After the end of contact the mass moves at the speed −e, so the time of the end is found by linear
            // extrapolation back. In τ a step is S times as long.
            let end = motion.scale * (f64::from(steps) * STEP - motion.s / motion.w);
            assert!((-motion.w - restitution).abs() < 6e-6, "λ = {lambda}: e = {}", -motion.w);
            assert!((end - time).abs() < 1.2e-5, "λ = {lambda}: {end}");
        }
    }

    /// An infinite impedance is a half-space. For a small impedance the mass keeps its speed, which is also the plate's
    /// speed F/Z: λσ^{3/2} = 1.
    #[test]
    fn limits() {
        let (stiffness, mass, speed) = (1.669e10, 52., 1.3);
        let rigid = peak_indentation(stiffness, mass, speed, f64::INFINITY);
        assert!((rigid / hertz::peak_indentation(stiffness, mass, speed) - 1.).abs() < 1e-6, "{rigid}");
        for impedance in [1e-9, 1e2, 1e4, 1e5, 1e6, 1e9] {
            let [peak, limit] =
                [peak_indentation, peak_indentation_limit].map(|of| of(stiffness, mass, speed, impedance));
            // The time steps give the peak an error below 1e-6. Where both limits are equal, it is about 0.64 of them.
            assert!(peak <= limit * (1. + 1e-6) && peak > 0.5 * limit, "Z = {impedance:e}: {peak:e} {limit:e}");
        }
        let soft = peak_indentation(stiffness, mass, speed, 1e-9);
        let force = Hertz { stiffness }.force(soft);
        assert!((force / (1e-9 * speed) - 1.).abs() < 1e-6, "{force:e}");
        assert_eq!(peak_indentation(stiffness, mass, speed, 0.), 0.);
    }

    /// The paper's plate of 0.1 m: D = 70e9·1e-3/(12·0.9471) = 6.1591525e6 N m and ρh = 250 kg/m², by hand to eight
    /// digits.
    #[test]
    fn impedance_by_hand() {
        let found = impedance(&Material { young: 70e9, poisson: 0.23, density: 2500. }, 0.1);
        assert!((found / 313_921.07 - 1.).abs() < 3e-8, "{found}");
    }
}
