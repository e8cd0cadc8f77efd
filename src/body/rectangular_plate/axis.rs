//! Waves between the two edges across an axis of a rectangular plate.

use std::f64::consts::PI;

use crate::solve::root::RootSearch;

use super::edge::{SquaredWavenumbers, StandingWave};
use super::{EdgeSprings, PlateWaves};

/// Change of a wavenumber over the spacing of wavenumbers at which its search ends.
const CHANGE: f64 = 1e-8;

/// Smallest squared wavenumber of a wave along an edge, over that along the edge. Edge waves have values above −0.03 on
/// thin plates.
const LOWEST_SQUARE: f64 = -0.25;

/// A wavenumber at which a wave is uniform, over that of the lowest mode.
const UNIFORM: f64 = 1e-4;

/// Distance between two edges of a plate, with the edges.
pub(super) struct Axis<'a> {
    /// Distance of the edges, m.
    pub length: f64,
    /// Lower and upper edge.
    pub edges: &'a [EdgeSprings; 2],
    /// Bending waves of the plate.
    pub waves: &'a PlateWaves,
}

/// Standing waves of both edges across an axis.
pub(super) struct StandingWaves {
    /// Wave that satisfies the conditions at the lower edge.
    pub lower: StandingWave,
    /// Wave that satisfies the conditions at the upper edge.
    pub upper: StandingWave,
    /// Half the distance of the edges, m.
    half: f64,
}

impl StandingWaves {
    /// Wronskian w₀ w₁' − w₀' w₁ up to its sign, 1/m. It vanishes if both waves are proportional.
    pub fn wronskian(&self) -> f64 {
        let Self { lower, upper, half } = self;
        lower.at(*half) * upper.slope(*half) + lower.slope(*half) * upper.at(*half)
    }

    /// Ratio |w₀/w₁| of both waves if they are proportional.
    pub fn ratio(&self) -> f64 {
        let size = |wave: &StandingWave| wave.at(self.half).hypot(self.half * wave.slope(self.half));
        size(&self.lower) / size(&self.upper)
    }

    /// Number of the mode times π for squared wavenumbers that are roots, and a continuous function between them, for
    /// waves longer than the plate or decaying.
    fn angle(&self) -> f64 {
        let of = |wave: &StandingWave| (-self.half * wave.slope(self.half)).atan2(wave.at(self.half));
        of(&self.lower) + of(&self.upper)
    }
}

impl Axis<'_> {
    /// Standing waves of both edges for a squared wavenumber across them and one along them (1/m²).
    pub fn pair(&self, across: f64, along: f64) -> StandingWaves {
        let waves = self.waves.equivalent_mindlin((across + along).sqrt());
        let of = |edge| StandingWave::at_edge(edge, &waves, SquaredWavenumbers { across, along });
        let [lower, upper] = self.edges;
        let one = of(lower);
        StandingWaves { lower: one, upper: if lower == upper { one } else { of(upper) }, half: 0.5 * self.length }
    }

    /// Squared wavenumber across the edges (1/m²) of the mode with a number, for a squared wavenumber along the edges;
    /// from a first guess. `None` if there is no such mode.
    pub fn square(&self, number: usize, guess: f64, along: f64) -> Option<f64> {
        let turns = number as f64 * PI;
        let spacing = PI / self.length;
        let real = |wavenumber: f64| {
            let StandingWaves { lower, upper, .. } = self.pair(wavenumber * wavenumber, along);
            wavenumber * self.length - lower.phase() - upper.phase() - turns
        };
        // The sum of both phases is between −π and 3π/2.
        let lowest = if number < 2 { UNIFORM * spacing } else { (number - 1) as f64 * spacing };
        let highest = (number as f64 + 1.5) * spacing;
        if number >= 2 || real(lowest) < 0.0 {
            let search = RootSearch {
                bracket: [lowest, highest],
                guess: guess.max(0.0).sqrt(),
                slope: self.length,
                change: CHANGE * spacing,
            };
            return Some(search.root(real).powi(2));
        }
        let decaying = |square: f64| self.pair(square, along).angle() - turns;
        let [lower, upper] = [LOWEST_SQUARE * along, lowest * lowest];
        let search = RootSearch {
            bracket: [lower, upper],
            guess,
            slope: self.length / spacing,
            change: CHANGE * spacing * spacing,
        };
        (decaying(lower) < 0.0).then(|| search.root(decaying))
    }
}
