//! Stresses computed from section resultants: in-plane stresses from their mean and moment, transverse shear stresses
//! from the shear force with a parabolic distribution. In a stack of several layers, each layer has separate
//! resultants.

use super::level::components;
use super::local::{LocalField, Node, Sections};

/// Number of points of the integral over a layer. A pressure at least as wide as the layer is thick has no waves
/// shorter than half the thickness.
const POINTS: usize = 12;

/// Weight w(z, z′) for which the parabola ∫ w(z, z′) σ(z′) dz′ has the mean and the first and second moments of σ over
/// a layer. Heights are measured from the middle of the layer, divided by its thickness.
pub fn on_parabola(z: f64, from: f64) -> f64 {
    1.0 + 12.0 * z * from + 180.0 * (z * z - 1.0 / 12.0) * (from * from - 1.0 / 12.0)
}

/// Response of one wavenumber at a depth (m), computed from the section resultants of a body: σ_rr + σ_θθ, σ_rr − σ_θθ,
/// σ_zz, σ_rz. A stack of several layers must be a solid.
pub(super) fn along_section(local: &LocalField, node: &Node, depth: f64, body: Sections) -> [f64; 4] {
    let stack = &local.stack;
    if body == Sections::Plate {
        return components(&local.section.response(stack, node.wavenumber, depth));
    }
    let (layer, within) = stack.layer_at(depth);
    let height = stack.layers()[layer].thickness;
    let place = within / height - 0.5;
    let is_one = stack.layers().len() == 1;
    // In-plane stresses: ∫σ dz/h and ∫σ ζ dz/h², with ζ from the middle. Shear stress: its mean or parabola.
    let (mut mean, mut moment, mut shear) = ([0.0; 2], [0.0; 2], 0.0);
    let rule = crate::element::gauss_legendre(POINTS);
    for (at, weight) in &rule {
        let part = 0.5 * weight;
        let response = components(&node.wave.response_in(stack, layer, 0.5 * height * (1.0 + at)));
        for i in 0..2 {
            mean[i] += part * response[i];
            moment[i] += part * 0.5 * at * response[i];
        }
        shear += part * response[3] * if is_one { 1.0 } else { on_parabola(place, 0.5 * at) };
    }
    if body == Sections::BentSolid {
        mean = [0.0; 2];
    }
    let along = |i: usize| mean[i] + 12.0 * place * moment[i];
    let over_mean = if is_one { 1.5 * (1.0 - 4.0 * place * place) } else { 1.0 };
    [along(0), along(1), 0.0, over_mean * shear]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The parabola of a quadratic function is the function.
    #[test]
    fn parabolas_stay() {
        for f in [|_: f64| 1.0, |z: f64| z - 0.3, |z: f64| 2.0 * z * z + z] {
            for z in [-0.5, 0.2, 0.5] {
                let sum: f64 = crate::element::gauss_legendre(3)
                    .iter()
                    .map(|(at, weight)| 0.5 * weight * on_parabola(z, 0.5 * at) * f(0.5 * at))
                    .sum();
                assert!((sum - f(z)).abs() < 1e-13, "{z}: {sum} {}", f(z));
            }
        }
    }
}
