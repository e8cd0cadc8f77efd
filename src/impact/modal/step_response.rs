//! Tabulated response of body and impactor over a step of one size, to the initial state and to the contact force.

use nalgebra::Complex;

use crate::body::Modes;
use crate::scheme::modal::{doubled, free_weights, phi, tripled, weights};

/// Fractions of a step at which its table is evaluated. The force is unknown at 1/2 and 1, and is checked at 1/4 and
/// 3/4.
pub const SAMPLE_POINTS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// Indices of 1/2 and 1 in [`SAMPLE_POINTS`].
pub const NODES: [usize; 2] = [1, 3];

/// The impactor as a free rigid body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeBody {
    /// Mass m0 of the impactor on the modelled part, kg.
    pub mass: f64,
    /// Acceleration by its weight along the direction of travel, m/s².
    pub gravity: f64,
    /// Speed at t = 0, m/s.
    pub speed: f64,
    /// Distance from the surface at t = 0, m.
    pub gap: f64,
}

/// State of a body in modal coordinates, and of the impactor.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Complex modal coordinates z.
    pub modes: Vec<Complex<f64>>,
    /// Rigid-body displacement X, m, and its velocity Ẋ, m/s.
    pub free: [f64; 2],
    /// Position q, m, and velocity q̇, m/s, of the impactor.
    pub impactor: [f64; 2],
    /// Impulse of the contact force, ∫F dt, N s.
    pub impulse: f64,
    /// Double integral of the contact force, ∫∫F dt dt, N s².
    pub way: f64,
    /// Time, s.
    pub time: f64,
    /// 1 if the body is in equilibrium with its loads at t = 0, including the modes left out; otherwise 0.
    pub settled: f64,
}

impl State {
    /// State of rest, except for the impactor's speed (m/s).
    pub fn start(modes: &Modes, speed: f64) -> Self {
        let zero = Complex::new(0.0, 0.0);
        Self {
            modes: vec![zero; modes.modes.len()],
            free: [0.0; 2],
            impactor: [0.0, speed],
            impulse: 0.0,
            way: 0.0,
            time: 0.0,
            settled: 0.0,
        }
    }

    /// State of rest under the loads: a vibration is displaced by x = f/ω² or, with dampers, by z = −g/λ.
    pub fn equilibrium(modes: &Modes, speed: f64) -> Self {
        let at_rest = |mode: &crate::body::Mode| match mode.load.norm_sqr() {
            0.0 => mode.load,
            _ => -mode.load / mode.rate,
        };
        Self { modes: modes.modes.iter().map(at_rest).collect(), settled: 1.0, ..Self::start(modes, speed) }
    }

    /// Displacement of the surface Re Σ c z + X, m, without the static displacement of the modes left out.
    pub fn surface(&self, modes: &Modes) -> f64 {
        let moved: f64 = modes.modes.iter().zip(&self.modes).map(|(mode, z)| real_product(mode.output, *z)).sum();
        moved + self.free[0]
    }

    /// Approach δ after a time (s) without contact force, m.
    pub fn flown(&self, modes: &Modes, impactor: &FreeBody, time: f64) -> f64 {
        let moved: f64 = modes
            .modes
            .iter()
            .zip(&self.modes)
            .map(|(mode, z)| {
                let y = mode.rate * time;
                let loaded = if mode.load.norm_sqr() == 0.0 {
                    *z * y.exp()
                } else {
                    *z * y.exp() + mode.load * phi(y)[0] * time
                };
                real_product(mode.output, loaded)
            })
            .sum();
        let free = self.free[0] + time * (self.free[1] + 0.5 * modes.free.load * time);
        let fallen = time * (self.impactor[1] + 0.5 * impactor.gravity * time);
        self.impactor[0] + fallen - impactor.gap - free - moved
    }
}

/// Time derivative of [`State::surface`] as a linear form on the state, prepared once because every step evaluates it.
pub struct SurfaceRate {
    /// Product c λ of each coordinate.
    of_modes: Vec<Complex<f64>>,
    /// Coefficient of the contact force, Re Σ c b, m/(N s).
    of_force: f64,
    /// Contribution of the loads, Re Σ c g, m/s.
    of_load: f64,
}

impl SurfaceRate {
    /// Prepares the form for the modes of a body.
    pub fn new(modes: &Modes) -> Self {
        let sum = |of: &dyn Fn(&crate::body::Mode) -> Complex<f64>| -> f64 {
            modes.modes.iter().map(|mode| real_product(mode.output, of(mode))).sum()
        };
        Self {
            of_modes: modes.modes.iter().map(|mode| mode.output * mode.rate).collect(),
            of_force: sum(&|mode| mode.input),
            of_load: sum(&|mode| mode.load),
        }
    }

    /// Rate of the surface displacement under a contact force (N), m/s.
    pub fn at(&self, state: &State, force: f64) -> f64 {
        let moved: f64 = self.of_modes.iter().zip(&state.modes).map(|(row, z)| real_product(*row, *z)).sum();
        moved + self.of_force * force + self.of_load + state.free[1]
    }
}

/// Real part of the product a b.
pub(super) fn real_product(a: Complex<f64>, b: Complex<f64>) -> f64 {
    a.re * b.re - a.im * b.im
}

/// Response at one point of [`SAMPLE_POINTS`]: δ of the unforced motion minus the responses to the three force values.
struct SamplePoint {
    tau: f64,
    /// Displacement of the surface away from the impactor due to the loads, minus the displacement of the impactor due
    /// to its weight, m.
    load: f64,
    /// Decrease of δ for F of 1 N at 0, h/2 and h, m/N.
    responses: [f64; 3],
    /// Response of each coordinate; filled only if foundation forces act in addition to F.
    coordinates: Vec<Coordinate>,
}

/// Response z(τh) of a coordinate: e^{λτh} z + g, and the weights of its inputs at 0, h/2 and h.
struct Coordinate {
    growth: Complex<f64>,
    load: Complex<f64>,
    weights: [Complex<f64>; 3],
}

/// Response of body and impactor over a step of size h.
pub struct StepResponse {
    /// Step size h, s.
    pub step: f64,
    samples: Vec<SamplePoint>,
    /// Real and imaginary parts of c e^{λτh} at all points of [`SAMPLE_POINTS`], for each coordinate. Four sums at a time fit
    /// the vector registers of a processor.
    rows: Vec<[[f64; 4]; 2]>,
    /// For each coordinate: e^{λh}, and the weights of the force values, including the factor b h.
    growth: Vec<Complex<f64>>,
    inputs: Vec<[Complex<f64>; 3]>,
    loads: Vec<Complex<f64>>,
}

impl StepResponse {
    /// Computes the tables of a step (s).
    pub fn new(modes: &Modes, impactor: &FreeBody, step: f64) -> Self {
        let count = modes.modes.len();
        let mut samples: Vec<SamplePoint> = SAMPLE_POINTS
            .iter()
            .map(|&tau| {
                let way = free_weights(tau).1.map(|w| w * step * step);
                SamplePoint {
                    tau,
                    load: 0.5 * (modes.free.load - impactor.gravity) * (tau * step).powi(2),
                    responses: way.map(|w| w * (modes.free.mobility + 1.0 / impactor.mass)),
                    coordinates: Vec::new(),
                }
            })
            .collect();
        let mut response = Self {
            step,
            samples: Vec::new(),
            rows: Vec::with_capacity(count),
            growth: Vec::with_capacity(count),
            inputs: Vec::with_capacity(count),
            loads: Vec::with_capacity(count),
        };
        for mode in &modes.modes {
            let y = mode.rate * step;
            let quarter = phi(y * 0.25);
            let half = doubled(quarter, y * 0.25);
            let of_samples = [quarter, half, tripled(quarter, half, y * 0.25), doubled(half, y * 0.5)];
            let of_force = mode.output * mode.input * step;
            let mut rows = [[0.0; 4]; 2];
            for (k, (sample, phi)) in samples.iter_mut().zip(of_samples).enumerate() {
                let row = mode.output * (phi[0] * y * sample.tau + 1.0);
                (rows[0][k], rows[1][k]) = (row.re, row.im);
                sample.load += real_product(mode.output, mode.load * phi[0]) * sample.tau * step;
                let weights = weights(phi, sample.tau);
                for (response, weight) in sample.responses.iter_mut().zip(weights) {
                    *response += real_product(of_force, weight);
                }
                if modes.internal_force().is_some() {
                    sample.coordinates.push(Coordinate {
                        growth: phi[0] * y * sample.tau + 1.0,
                        load: mode.load * phi[0] * sample.tau * step,
                        weights: weights.map(|w| w * step),
                    });
                }
            }
            response.rows.push(rows);
            let [_, _, _, whole] = of_samples;
            response.growth.push(whole[0] * y + 1.0);
            response.inputs.push(weights(whole, 1.0).map(|w| mode.input * w * step));
            response.loads.push(mode.load * whole[0] * step);
        }
        response.samples = samples;
        response
    }

    /// Approach δ at the points of [`SAMPLE_POINTS`] without contact force, m; `gap` in m.
    pub fn free(&self, state: &State, gap: f64) -> [f64; 4] {
        let mut moved = [0.0; 4];
        for ([real, imaginary], z) in self.rows.iter().zip(&state.modes) {
            (0..4).for_each(|k| moved[k] += real[k] * z.re - imaginary[k] * z.im);
        }
        [0, 1, 2, 3].map(|k| {
            let SamplePoint { tau, load, .. } = &self.samples[k];
            let t = tau * self.step;
            let impactor = state.impactor[0] + t * state.impactor[1];
            impactor - gap - (state.free[0] + t * state.free[1] + load + moved[k])
        })
    }

    /// Decrease of δ at a point of [`SAMPLE_POINTS`] for F of 1 N at 0, h/2 and h, m/N.
    pub fn responses(&self, sample: usize) -> [f64; 3] {
        self.samples[sample].responses
    }

    /// Coordinates z at a point of [`SAMPLE_POINTS`] with no force except the loads.
    pub fn left_alone(&self, sample: usize, state: &State) -> Vec<Complex<f64>> {
        let coordinates = self.samples[sample].coordinates.iter().zip(&state.modes);
        coordinates.map(|(Coordinate { growth, load, .. }, z)| growth * z + load).collect()
    }

    /// Contribution of inputs at 0, h/2 and h to z at a point of [`SAMPLE_POINTS`].
    pub fn driven(&self, sample: usize, inputs: &[Vec<Complex<f64>>; 3]) -> Vec<Complex<f64>> {
        let [a, b, c] = inputs;
        let of = |(i, Coordinate { weights, .. }): (usize, &Coordinate)| {
            weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i]
        };
        self.samples[sample].coordinates.iter().enumerate().map(of).collect()
    }

    /// Advances the state to the end of the step under the three values of the contact force, N.
    pub fn advance(&self, state: &mut State, modes: &Modes, impactor: &FreeBody, force: [f64; 3]) {
        let h = self.step;
        let left_alone = state.modes.iter_mut().zip(&self.growth).zip(&self.loads);
        if force == [0.0; 3] {
            left_alone.for_each(|((z, growth), load)| *z = growth * *z + load);
        } else {
            for (((z, growth), load), [a, b, c]) in left_alone.zip(&self.inputs) {
                *z = growth * *z + load + a * force[0] + b * force[1] + c * force[2];
            }
        }
        let (velocity, way) = free_weights(1.0);
        let sum = |w: [f64; 3]| w[0] * force[0] + w[1] * force[1] + w[2] * force[2];
        let (impulse, way) = (h * sum(velocity), h * h * sum(way));
        let free = modes.free;
        state.free[0] += h * state.free[1] + way * free.mobility + 0.5 * h * h * free.load;
        state.free[1] += impulse * free.mobility + h * free.load;
        state.impactor[0] += h * (state.impactor[1] + 0.5 * h * impactor.gravity) - way / impactor.mass;
        state.impactor[1] += h * impactor.gravity - impulse / impactor.mass;
        state.way += way + h * state.impulse;
        state.impulse += impulse;
        state.time += h;
    }
}
