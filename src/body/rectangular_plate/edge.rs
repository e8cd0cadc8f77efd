//! Bending waves of Mindlin's plate at an edge on springs.

use super::BendingWaves;

/// Largest spring over the stiffness of the waves. It replaces the infinite stiffness of a clamp.
const RIGID: f64 = 1e60;

/// Springs along an edge per length; infinite for clamps.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EdgeSprings {
    /// Stiffness against the deflection, N/m².
    pub deflection: f64,
    /// Stiffness against the rotation across the edge, N.
    pub rotation: f64,
    /// Stiffness against the rotation along the edge, N.
    pub twist: f64,
}

/// Squared wavenumbers of a wave, 1/m². One of them is negative if the wave decays in its direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SquaredWavenumbers {
    /// Across the edge.
    pub across: f64,
    /// Along the edge.
    pub along: f64,
}

/// Standing wave at the distance x from an edge, c cos(k x) + s sin(k x)/k.
///
/// It is an entire function of k². For negative k² it consists of the hyperbolic functions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct StandingWave {
    cosine: f64,
    sine: f64,
    /// k², 1/m².
    square: f64,
}

impl StandingWave {
    /// Standing wave that satisfies the conditions at an edge, for the squared wavenumbers `squares`.
    ///
    /// The bending wave ξ² = k² + q², with k across and q along the edge, is accompanied by a bending wave and a
    /// thickness-twist wave that decay from the edge. The waves have w = Σ w_i and the rotations θ = Σ (σ_i − 1) ∇w_i + curl
    /// H, with σ = ρhω²/(κμh ξ²) for each wavenumber ξ (R. D. Mindlin, J. Appl. Mech. 18, 1951). The amplitudes of the
    /// four waves (cosine, sine and both decaying ones) satisfy three conditions: the shear force, the bending moment
    /// and the twisting moment are those of the springs.
    pub(super) fn at_edge(
        springs: &EdgeSprings,
        waves: &BendingWaves,
        SquaredWavenumbers { across, along }: SquaredWavenumbers,
    ) -> Self {
        let BendingWaves { mass, rigidity, shear, rotary, poisson } = *waves;
        let bending = across + along;
        let frequency = waves.frequency(bending.sqrt());
        let (inertia, stiffness) = (mass * frequency * frequency, shear - rotary * frequency * frequency);
        // ξ² of the second bending wave is negative.
        let second = -inertia * stiffness / (shear * rigidity * bending);
        let decay = (along - second).sqrt();
        let decay_twisting = (along + stiffness / (0.5 * (1.0 - poisson) * rigidity)).sqrt();
        let [one, other] = [bending, second].map(|square| inertia / (shear * square));
        let [a, c] = [one - 1.0, other - 1.0];
        // Displacements and forces over D at the edge for unit amplitudes of the four waves. The amplitude of the
        // thickness-twist wave contains the factor q, and the condition along the edge is divided by q, so that all are
        // functions of q².
        let deflection = [1.0, 0.0, 1.0, 0.0];
        let rotation = [0.0, a, -c * decay, along];
        let twist = [-a, 0.0, -c, decay_twisting];
        let force = [0.0, one, -other * decay, along].map(|value| value * shear / rigidity);
        let moment = [
            -a * (across + poisson * along),
            0.0,
            c * (decay * decay - poisson * along),
            -(1.0 - poisson) * along * decay_twisting,
        ];
        let twisting = [0.0, -2.0 * a, 2.0 * c * decay, -(along + decay_twisting * decay_twisting)];
        let twisting = twisting.map(|value| 0.5 * (1.0 - poisson) * value);
        let scale = bending.sqrt();
        let condition = |force: [f64; 4], spring: f64, displacement: [f64; 4], scale: f64| -> [f64; 4] {
            let spring = (spring / rigidity / scale).min(RIGID);
            std::array::from_fn(|i| (force[i] / scale - spring * displacement[i]) / (1.0 + spring))
        };
        let conditions = [
            condition(force, springs.deflection, deflection, scale.powi(3)),
            condition(moment, springs.rotation, rotation, scale),
            condition(twisting, springs.twist, twist, scale),
        ];
        // Cramer's rule. The vector of minors is continuous in all springs and wavenumbers.
        let minor = |columns: [usize; 3]| {
            let [x, y, z] = conditions.map(|row| columns.map(|column| row[column]));
            x[0] * (y[1] * z[2] - y[2] * z[1]) - x[1] * (y[0] * z[2] - y[2] * z[0]) + x[2] * (y[0] * z[1] - y[1] * z[0])
        };
        Self { cosine: minor([1, 2, 3]), sine: -minor([0, 2, 3]), square: across }
    }

    /// Phase ψ of the wave cos(k x − ψ), for positive k². −π/2 < ψ ≤ 3π/4 for springs of any stiffness.
    pub(super) fn phase(&self) -> f64 {
        (self.sine / self.square.sqrt()).atan2(self.cosine)
    }

    /// Deflection at a distance from the edge, m.
    pub(super) fn at(&self, distance: f64) -> f64 {
        let (cosine, sine) = self.functions(distance);
        self.cosine * cosine + self.sine * sine
    }

    /// Derivative of the deflection by the distance from the edge.
    pub(super) fn slope(&self, distance: f64) -> f64 {
        let (cosine, sine) = self.functions(distance);
        self.sine * cosine - self.cosine * self.square * sine
    }

    /// cos(k x) and sin(k x)/k.
    fn functions(&self, distance: f64) -> (f64, f64) {
        let wavenumber = self.square.abs().sqrt();
        let angle = wavenumber * distance;
        match self.square {
            0.0 => (1.0, distance),
            square if square > 0.0 => (angle.cos(), angle.sin() / wavenumber),
            _ => (angle.cosh(), angle.sinh() / wavenumber),
        }
    }
}
