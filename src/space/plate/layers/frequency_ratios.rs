//! Errors of the layerwise theory in the frequencies of flexural waves.

use super::{Layers, LayerwiseWaves};
use crate::space::plate::geometry::PlateGeometry;
use crate::stack::flexural_frequency;

/// Wavenumbers ξ at which waves are compared, times the thickness of the stack: from the first on, in equal ratios.
const FIRST: f64 = 0.05;
const RATIO: f64 = 1.3;
const LAST: f64 = 4.0;

/// Exact frequency of a flexural wave divided by that of the layerwise theory, as a function of the latter. Waves of a
/// finite plate have nearly the same ratio.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyRatios(Vec<FrequencyRatio>);

#[derive(Debug, Clone, Copy, PartialEq)]
struct FrequencyRatio {
    /// Frequency of the layerwise theory, rad/s.
    frequency: f64,
    /// Exact frequency divided by it.
    ratio: f64,
}

impl FrequencyRatios {
    /// Compares the waves of elastic layers with exact ones.
    pub(super) fn new(layers: &Layers, geometry: &PlateGeometry) -> Self {
        let stack = layers.theory.stack();
        let densities = layers.parts.iter().map(|part| part.material.instantaneous.density);
        let all: Vec<_> = stack.layers().iter().copied().zip(densities).collect();
        let Some(waves) = LayerwiseWaves::new(layers, geometry, &[], 0.0) else { return Self(Vec::new()) };
        let at = |x: f64| {
            let wavenumber = x / stack.thickness();
            // The wave that the force excites most bends the stack. In a soft coat others may be slower.
            let frequency =
                waves.at(wavenumber).into_iter().max_by(|a, b| a.of_force.total_cmp(&b.of_force))?.frequency;
            let ratio = flexural_frequency(&all, wavenumber, frequency) / frequency;
            (ratio.is_finite() && frequency > 0.0).then_some(FrequencyRatio { frequency, ratio })
        };
        let all = std::iter::successors(Some(FIRST), |x| Some(x * RATIO)).take_while(|x| *x < LAST);
        let mut ratios: Vec<FrequencyRatio> = all.filter_map(at).collect();
        ratios.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
        Self(ratios)
    }

    /// Ratio at a frequency of the layerwise theory, rad/s.
    pub fn at(&self, frequency: f64) -> f64 {
        let after = self.0.partition_point(|one| one.frequency < frequency);
        match (after.checked_sub(1).map(|before| self.0[before]), self.0.get(after)) {
            (Some(before), Some(after)) => {
                let part = (frequency - before.frequency) / (after.frequency - before.frequency);
                before.ratio + part * (after.ratio - before.ratio)
            }
            (Some(last), None) => last.ratio,
            // Long waves are exact.
            (None, first) => first.map_or(1.0, |first| 1.0 + (first.ratio - 1.0) * frequency / first.frequency),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::space::plate::frequency_ratios;

    fn ratios(layers: &[(f64, &str)], shear: f64) -> FrequencyRatios {
        let materials = [
            ("glass", "young = 70e9\npoisson = 0.23\ndensity = 2500.0".to_owned()),
            ("soft", format!("shear = {shear}\nbulk = 2e9\ndensity = 1100.0")),
            ("polycarbonate", "young = 2.3e9\npoisson = 0.38\ndensity = 1200.0".to_owned()),
        ];
        let mut text = "[body]\nsize = [0.5, 0.5]\n".to_owned();
        for (thickness, material) in layers {
            text += &format!("[[body.layer]]\nthickness = {thickness}\nmaterial = \"{material}\"\n");
        }
        for (name, constants) in materials.iter().filter(|(name, _)| layers.iter().any(|(_, used)| used == name)) {
            text += &format!("[material.{name}]\n{constants}\n");
        }
        text += "[impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\n[time]\nend = 1e-3\n";
        frequency_ratios(&Scene::parse("test", &text, &[]).expect("a scene").0).expect("a laminate")
    }

    /// Frequencies of the layerwise theory are exact up to the fourth power of ξH, whether the plies are bonded or slide.
    /// Measured: errors of at most 1.5e-4 (ξH)⁴ for equal plies, and 2.6e-3 (ξH)⁴ for the others. If each layer were a
    /// Mindlin plate and all layers had the same deflection, the error would be 1.5e-3 for two plies of 10 mm at ξH =
    /// 0.8, in place of 4e-6.
    #[test]
    fn frequencies_are_of_fourth_order() {
        let equal = [(0.01, "glass"), (0.00076, "soft"), (0.01, "glass")];
        let unequal = [(0.01, "glass"), (0.00038, "soft"), (0.004, "glass")];
        let five = [(0.006, "glass"), (0.00076, "soft"), (0.01, "glass"), (0.00152, "soft"), (0.004, "glass")];
        let bonded = [(0.006, "glass"), (0.008, "polycarbonate")];
        // Mindlin's plate with its best shear factor would have 4e-4 (ξH)⁴.
        let one = [(0.01, "glass")];
        for (layers, shear, factor) in [
            (&equal[..], 1e8, 3e-4),
            (&equal, 1e7, 3e-4),
            (&equal, 1e6, 3e-4),
            (&unequal, 1e7, 2e-3),
            (&five, 3e7, 3e-3),
            (&bonded, 1e7, 5e-3),
            (&one, 1e7, 5e-5),
        ] {
            let FrequencyRatios(all) = ratios(layers, shear);
            for (number, FrequencyRatio { ratio, .. }) in all.into_iter().enumerate() {
                let x = FIRST * RATIO.powi(number as i32);
                if x < 1.2 {
                    assert!((ratio - 1.0).abs() < factor * x.powi(4), "{layers:?} {shear:e} {x}: {ratio}");
                }
            }
        }
    }

    /// Between the wavenumbers the ratio is linear in the frequency; it is 1 at rest and constant beyond the last.
    #[test]
    fn between_and_beyond() {
        let known = [(1.0, 1.01), (3.0, 1.03)].map(|(frequency, ratio)| FrequencyRatio { frequency, ratio });
        let ratios = FrequencyRatios(known.to_vec());
        for (frequency, exact) in [(0.0, 1.0), (0.5, 1.005), (1.0, 1.01), (2.0, 1.02), (3.0, 1.03), (9.0, 1.03)] {
            assert!((ratios.at(frequency) - exact).abs() < 1e-12, "{frequency}: {}", ratios.at(frequency));
        }
    }
}
