//! The stresses that sections carry: along the face by mean and moment, across it by shear force on a parabola.

use super::level::components;
use super::local::{LocalField, Node, Sections};

/// Points of the sum over the thickness: pressures that are as wide as the thickness have no waves that are shorter than its half.
const POINTS: usize = 12;

/// The response of one wavenumber at a depth (m), as the sections of a body of one layer have it: σ_rr + σ_θθ, σ_rr − σ_θθ, σ_zz, σ_rz.
pub(super) fn along_section(local: &LocalField, node: &Node, depth: f64, body: Sections) -> [f64; 4] {
    let (stack, height) = (&local.stack, local.stack.thickness());
    if let Sections::Plate { reading } = body {
        let bending = local.section.bending(stack, depth);
        let square = node.wavenumber * node.wavenumber;
        let moment = (1.0 + reading * square) / square;
        return [bending.sum * moment, bending.difference * moment, 0.0, bending.shear / node.wavenumber];
    }
    // Of σ along the face, and of the shear: ∫σ dz/h and ∫σ ζ dz/h², with ζ from the middle.
    let (mut mean, mut moment, mut shear) = ([0.0; 2], [0.0; 2], 0.0);
    let rule = crate::element::gauss_legendre(POINTS);
    for (at, weight) in &rule {
        let part = 0.5 * weight;
        let response = components(&node.wave.response(stack, 0.5 * height * (1.0 + at)));
        for i in 0..2 {
            mean[i] += part * response[i];
            moment[i] += part * 0.5 * at * response[i];
        }
        shear += part * response[3];
    }
    if body == Sections::BentSolid {
        mean = [0.0; 2];
    }
    let place = depth / height - 0.5;
    let along = |i: usize| mean[i] + 12.0 * place * moment[i];
    [along(0), along(1), 0.0, 1.5 * (1.0 - 4.0 * place * place) * shear]
}
