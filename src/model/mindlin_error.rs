//! The estimated error of Mindlin's theory relative to three-dimensional elasticity.
//!
//! Kirchhoff's theory neglects shear, rotary inertia, the twist of free edges and the local field under the impactor; Mindlin's has all
//! of them to a better order. So its error is a small part of the difference between both theories. That part has three terms:
//!
//! - **A constant.** Waves in the interior are right to (kh)⁴, and free edges have the twisting stiffness of three-dimensional
//!   elasticity ([`crate::form::plate::mindlin_edge`]); what else the edges' boundary layers do is left. Where a support holds the
//!   sections of an edge, which Mindlin's theory lets warp, more is.
//! - **Poisson's ratio.** Bending strains the thickness by −ν/(1 − ν) times the sum of the strains in the plane. Mindlin's theory has
//!   that at rest, and without the layer in which a free edge releases it. The energy goes with the square.
//! - **Short contacts.** The local field under the impactor is that of a layer at rest. Waves across the thickness make its error
//!   grow with h/(c_s T), c_s the speed of shear waves and T the contact time on a half-space, and with its square.
//!
//! The factors were measured; docs/costs.md compares the estimate with true errors. It is an estimate, not a bound.

use crate::scene::{Geometry, Scene, Support, SupportKind};
use crate::space::plate::crossing;

/// The constant where sections are free to warp: 0.004 of the difference was measured at ν = 0, and with k h/E up to 0.016.
const FREE_SECTIONS: f64 = 0.005;

/// The constant where clamps hold them: 0.042 of the difference was measured.
const HELD_SECTIONS: f64 = 0.045;

/// The same where springs do that are no stiffer than the sections: up to 0.01 was measured of plates from ten to 75
/// times as wide as thick with k h/E from 0.03 to 0.9, and 0.017 of one that is five times as wide.
const SPRUNG_SECTIONS: f64 = 0.02;

/// Factor of (ν/(1 − ν))²: 0.0134 of the difference was measured at ν = 0.45 in a long contact.
const STRAINED_THICKNESS: f64 = 0.016;

/// Factors of h/(c_s T) and of its square: 0.12 of the difference was measured where that is 0.28, 0.04 where it is 0.11, and 0.003 to 0.01
/// in other scenes where it is 0.06 to 0.1.
const SHORT_CONTACT: [f64; 2] = [0.2, 1.2];

/// k h/E from which springs count as holding the sections; at 0.003 they were measured not to.
const STIFF: f64 = 0.02;

/// k h/E from which they are as good as clamps.
const RIGID: f64 = 1.0;

/// Estimated error of the acceleration by Mindlin's theory, over its difference from that by Kirchhoff's.
pub fn mindlin_error_over_difference(scene: &Scene) -> f64 {
    let sections = scene.supports.iter().map(|support| sections(support, scene)).fold(FREE_SECTIONS, f64::max);
    let poisson = scene.body.struck().poisson;
    let across = poisson / (1.0 - poisson);
    let [linear, square] = SHORT_CONTACT;
    let crossing = crossing(scene);
    sections + STRAINED_THICKNESS * across * across + (linear + square * crossing) * crossing
}

/// The constant of a support that holds displacements along the plate: a clamp, or springs that are not much softer than the plate's sections.
fn sections(support: &Support, scene: &Scene) -> f64 {
    let (Geometry::Box { size, .. }, Some(struck)) = (&scene.body.geometry, scene.struck_axis()) else {
        return FREE_SECTIONS;
    };
    let SupportKind::Elastic { stiffness } = support.kind else {
        return if is_clamp_of_sections(support, scene) { HELD_SECTIONS } else { FREE_SECTIONS };
    };
    let along = (0..3).filter(|axis| *axis != struck).map(|axis| stiffness[axis]).fold(0.0, f64::max);
    match along * size[struck] / scene.body.struck().young {
        stiff if stiff > RIGID => HELD_SECTIONS,
        stiff if stiff > STIFF => SPRUNG_SECTIONS,
        _ => FREE_SECTIONS,
    }
}

/// Whether a support clamps displacements along the plate.
pub(super) fn is_clamp_of_sections(support: &Support, scene: &Scene) -> bool {
    let (SupportKind::Clamped { components }, Some(struck)) = (&support.kind, scene.struck_axis()) else {
        return false;
    };
    (0..3).any(|axis| components[axis] && axis != struck)
}
