//! What a body does over a step of one size: the answers to its state and to the force, from tables.

use nalgebra::Complex;

use crate::body::Modes;
use crate::scheme::modal::{doubled, free_weights, phi, tripled, weights};

/// The parts of a step at which its table looks: where the force is unknown (1/2 and 1), and where it is checked.
pub const LOOKS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];

/// The numbers of 1/2 and 1 among [`LOOKS`].
pub const NODES: [usize; 2] = [1, 3];

/// The impactor as a free body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeBody {
    /// Mass, kg.
    pub mass: f64,
    /// What its weight accelerates it by, m/s².
    pub gravity: f64,
    /// Speed at t = 0, m/s.
    pub speed: f64,
    /// Distance from the surface at t = 0, m.
    pub gap: f64,
}

/// The state of a body in modal coordinates, and of the impactor.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// z.
    pub modes: Vec<Complex<f64>>,
    /// X, m, and Ẋ, m/s, of the free motions.
    pub free: [f64; 2],
    /// q, m, and q̇, m/s.
    pub impactor: [f64; 2],
    /// ∫F dt, N s.
    pub impulse: f64,
    /// ∫∫F dt dt, N s².
    pub way: f64,
    /// Time, s.
    pub time: f64,
    /// 1 where the loads have moved the body before t = 0, also in the modes that are left out; otherwise 0.
    pub settled: f64,
}

impl State {
    /// At rest, but for the impactor's speed (m/s).
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

    /// At rest under the loads, which have moved what is held by x = f/ω² or, with dampers, by z = −g/λ.
    pub fn equilibrium(modes: &Modes, speed: f64) -> Self {
        let at_rest = |mode: &crate::body::Mode| match mode.load.norm_sqr() {
            0.0 => mode.load,
            _ => -mode.load / mode.rate,
        };
        Self { modes: modes.modes.iter().map(at_rest).collect(), settled: 1.0, ..Self::start(modes, speed) }
    }

    /// Re Σ c z + X, m: the surface's displacement but for its spring.
    pub fn surface(&self, modes: &Modes) -> f64 {
        let moved: f64 = modes.modes.iter().zip(&self.modes).map(|(mode, z)| real_product(mode.output, *z)).sum();
        moved + self.free[0]
    }

    /// δ after a time (s) without force, m.
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

/// The rate of [`State::surface`], which is asked for at each step, as a form on the state.
pub struct SurfaceRate {
    /// c λ of each coordinate.
    of_modes: Vec<Complex<f64>>,
    /// Re Σ c b, m/(N s).
    of_force: f64,
    /// Re Σ c g, m/s.
    of_load: f64,
}

impl SurfaceRate {
    /// Of a body.
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

    /// The rate under a force (N), m/s.
    pub fn at(&self, state: &State, force: f64) -> f64 {
        let moved: f64 = self.of_modes.iter().zip(&state.modes).map(|(row, z)| real_product(*row, *z)).sum();
        moved + self.of_force * force + self.of_load + state.free[1]
    }
}

/// Re(a b).
pub(super) fn real_product(a: Complex<f64>, b: Complex<f64>) -> f64 {
    a.re * b.re - a.im * b.im
}

/// One look at a step: δ there is δ of the state left alone, less the answers to the force's three values.
struct Look {
    tau: f64,
    /// What loads move the surface away from the impactor, whose weight moves it closer, m.
    load: f64,
    /// δ's answer to F at 0, h/2 and h, m/N.
    answers: [f64; 3],
    /// What the coordinates do by themselves, where forces beside F act on them.
    coordinates: Vec<Coordinate>,
}

/// z(τh) of a coordinate: e^{λτh} z + g, and the weights of its inputs at 0, h/2 and h.
struct Coordinate {
    growth: Complex<f64>,
    load: Complex<f64>,
    weights: [Complex<f64>; 3],
}

/// What a step of the size h does.
pub struct Answer {
    /// h, s.
    pub step: f64,
    looks: Vec<Look>,
    /// Re and Im of c e^{λτh} at all looks, by coordinate: four sums at a time, which a processor's vectors hold.
    rows: Vec<[[f64; 4]; 2]>,
    /// e^{λh}, and the weights of the force's values with b h in them, by coordinate.
    growth: Vec<Complex<f64>>,
    inputs: Vec<[Complex<f64>; 3]>,
    loads: Vec<Complex<f64>>,
}

impl Answer {
    /// The tables of a step, s.
    pub fn new(modes: &Modes, impactor: &FreeBody, step: f64) -> Self {
        let count = modes.modes.len();
        let mut looks: Vec<Look> = LOOKS
            .iter()
            .map(|&tau| {
                let way = free_weights(tau).1.map(|w| w * step * step);
                Look {
                    tau,
                    load: 0.5 * (modes.free.load - impactor.gravity) * (tau * step).powi(2),
                    answers: way.map(|w| w * (modes.free.mobility + 1.0 / impactor.mass)),
                    coordinates: Vec::new(),
                }
            })
            .collect();
        let mut answer = Self {
            step,
            looks: Vec::new(),
            rows: Vec::with_capacity(count),
            growth: Vec::with_capacity(count),
            inputs: Vec::with_capacity(count),
            loads: Vec::with_capacity(count),
        };
        for mode in &modes.modes {
            let y = mode.rate * step;
            let quarter = phi(y * 0.25);
            let half = doubled(quarter, y * 0.25);
            let of_looks = [quarter, half, tripled(quarter, half, y * 0.25), doubled(half, y * 0.5)];
            let of_force = mode.output * mode.input * step;
            let mut rows = [[0.0; 4]; 2];
            for (k, (look, phi)) in looks.iter_mut().zip(of_looks).enumerate() {
                let row = mode.output * (phi[0] * y * look.tau + 1.0);
                (rows[0][k], rows[1][k]) = (row.re, row.im);
                look.load += real_product(mode.output, mode.load * phi[0]) * look.tau * step;
                let weights = weights(phi, look.tau);
                for (answer, weight) in look.answers.iter_mut().zip(weights) {
                    *answer += real_product(of_force, weight);
                }
                if modes.foundation.is_some() {
                    look.coordinates.push(Coordinate {
                        growth: phi[0] * y * look.tau + 1.0,
                        load: mode.load * phi[0] * look.tau * step,
                        weights: weights.map(|w| w * step),
                    });
                }
            }
            answer.rows.push(rows);
            let [_, _, _, whole] = of_looks;
            answer.growth.push(whole[0] * y + 1.0);
            answer.inputs.push(weights(whole, 1.0).map(|w| mode.input * w * step));
            answer.loads.push(mode.load * whole[0] * step);
        }
        answer.looks = looks;
        answer
    }

    /// δ at every look, m, with no force: `gap` in m.
    pub fn free(&self, state: &State, gap: f64) -> [f64; 4] {
        let mut moved = [0.0; 4];
        for ([real, imaginary], z) in self.rows.iter().zip(&state.modes) {
            (0..4).for_each(|k| moved[k] += real[k] * z.re - imaginary[k] * z.im);
        }
        [0, 1, 2, 3].map(|k| {
            let Look { tau, load, .. } = &self.looks[k];
            let t = tau * self.step;
            let impactor = state.impactor[0] + t * state.impactor[1];
            impactor - gap - (state.free[0] + t * state.free[1] + load + moved[k])
        })
    }

    /// How much δ falls at a look for F of 1 N at 0, h/2 and h, m/N.
    pub fn answers(&self, look: usize) -> [f64; 3] {
        self.looks[look].answers
    }

    /// z at a look without any force but the loads.
    pub fn left_alone(&self, look: usize, state: &State) -> Vec<Complex<f64>> {
        let coordinates = self.looks[look].coordinates.iter().zip(&state.modes);
        coordinates.map(|(Coordinate { growth, load, .. }, z)| growth * z + load).collect()
    }

    /// What inputs at 0, h/2 and h add to z at a look.
    pub fn driven(&self, look: usize, inputs: &[Vec<Complex<f64>>; 3]) -> Vec<Complex<f64>> {
        let [a, b, c] = inputs;
        let of = |(i, Coordinate { weights, .. }): (usize, &Coordinate)| {
            weights[0] * a[i] + weights[1] * b[i] + weights[2] * c[i]
        };
        self.looks[look].coordinates.iter().enumerate().map(of).collect()
    }

    /// The state at the end under the force's three values, N.
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
