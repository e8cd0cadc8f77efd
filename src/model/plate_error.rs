//! Estimates the error of a plate with shear relative to three-dimensional elasticity.
//!
//! Kirchhoff's theory neglects shear, rotary inertia, the twist of free edges and the local field under the impactor.
//! Mindlin's theory has all of them to a better order. Its error is therefore a small part of the difference between
//! both theories. (With several layers, the plate is compared with one whose stiff layers do not shear.) That part has
//! three terms:
//!
//! - **A constant.** Waves in the interior are exact to (kh)⁴, and free edges have the twisting stiffness of
//!   three-dimensional elasticity. The rest is other effects of the boundary layers at edges. It is larger for supports
//!   that prevent the sections of an edge from warping, because the theory lets them warp. At clamps it grows with
//!   Poisson's ratio.
//! - **Poisson's ratio.** Bending strains the thickness by −ν/(1 − ν) times the sum of the in-plane strains. Mindlin's
//!   theory has that strain statically only, and without the boundary layer in which a free edge releases it.
//!   Frequencies of a thin polymer plate with free edges are too low by 1e-4. This shows after a hundred vibrations.
//! - **Short contacts.** The local field under the impactor is the static one of a layer. Waves across the thickness
//!   make its error grow with h/(c_s T) and with its square. c_s is the speed of shear waves and T the contact time on
//!   a half-space. In laminates, the plies vibrate on the interlayers, too ([`LocalVibrations`]).
//!
//! The first two act on slow waves, and the third where the impact begins and ends, with the opposite sign. They are
//! combined like errors of different causes.
//!
//! The factors were measured; docs/costs.md compares the estimate with true errors. It is an estimate, not a bound.

use crate::impact::joined;
use crate::scene::{Geometry, Scene, Support};
use crate::space::plate::LocalVibrations;

/// The constant if sections are free to warp. On 16 plates, 8 to 50 times as wide as thick, compared with solids of
/// tolerance 1e-4, the error exceeded the other two terms by at most 0.001 of the difference. On 18 free and hinged ones, 6
/// and 12 times as wide, it was 0.002 to 0.011 of it, with the errors of cells and steps (tolerance 5e-4).
const FREE_SECTIONS: f64 = 0.005;

/// The constant if clamps prevent warping, and its growth with (ν/(1 − ν))². Clamps hold the strain of the thickness
/// too, which Mindlin's theory leaves free. Measured over the difference on fourteen clamped plates, 4 to 14 times as
/// wide as thick: 0.007 to 0.039 at ν = 0.2 and 0.23, 0.011 to 0.033 at 0.3, 0.031 to 0.05 at 0.33, and 0.044 to 0.087
/// at 0.37. An estimate.
const HELD_SECTIONS: f64 = 0.03;
const HELD_THICKNESS: f64 = 0.17;

/// Factor of (ν/(1 − ν))³. At ν = 0.45, 0.033 of the difference was measured in a long contact. At ν = 0.23 this term is
/// smaller than the constant, as measured.
const STRAINED_THICKNESS: f64 = 0.055;

/// Factors of h/(c_s T) and of its square. Measured, over the difference: 0.12 at h/(c_s T) = 0.28, 0.04 at 0.11, and
/// 0.003 to 0.01 in other scenes at 0.06 to 0.1.
const SHORT_CONTACT: [f64; 2] = [0.2, 1.2];

/// Sum of the periods of interlayers, over the contact time, above which their part grows linearly, not quadratically:
/// softer interlayers transmit less shear. On 4.9/1.52/4.9 mm with 5 MPa, where it is 0.3, the upper ply vibrates on the
/// interlayer and changes the acceleration by 2.8%, a fifth of the effect of shear and the local field. On twelve
/// laminates with 0.1 to 5 MPa and sums of 0.37 to 4.2, the error is 0.27 to 0.68 of the estimate. (When each period was
/// limited to 0.3, it was up to 4.4 times the estimate.)
const SLOW_INTERLAYERS: f64 = 0.3;

/// k h/E from which springs along the plate count as clamps. Below it the constant grows linearly from the one of free
/// sections. Measured over the difference, at ν = 0: 0.0012 at k h/E = 0.0006, 0.002 at 0.002, 0.0065 at 0.0057, and
/// 0.0105 at 0.014; up to 0.02 from 0.03 to 0.9 (tests/ranks/model/theory_error.rs has such plates).
const STIFF: f64 = 0.02;

/// Estimated error of the acceleration by Mindlin's theory, over its difference from Kirchhoff's.
pub fn plate_error_over_difference(scene: &Scene) -> f64 {
    let poisson = scene.body.struck().poisson;
    let across = poisson / (1.0 - poisson);
    let sections = sections(scene, across);
    let [linear, square] = SHORT_CONTACT;
    let LocalVibrations { plies, interlayers } = LocalVibrations::of(scene);
    let of_vibrations = (linear + square * (plies + interlayers.min(SLOW_INTERLAYERS))) * (plies + interlayers);
    joined(sections + STRAINED_THICKNESS * across.powi(3), of_vibrations)
}

/// The constant for the supports: clamps along the plate, or springs that are not much softer than the plate's
/// sections. `across` is ν/(1 − ν).
fn sections(scene: &Scene, across: f64) -> f64 {
    let held = HELD_SECTIONS + HELD_THICKNESS * across * across;
    // Springs constrain a ply on a soft layer more than the modulus of the struck layer suggests.
    let part = if scene.clamps_sections() { 1.0 } else { (spring_over_section(scene) / STIFF).min(1.0) };
    FREE_SECTIONS + (held - FREE_SECTIONS) * part
}

/// k h/E of the springs along a plate; 0 for other bodies.
fn spring_over_section(scene: &Scene) -> f64 {
    let (Geometry::Box { size, .. }, Some(struck)) = (&scene.body.geometry, scene.struck_axis()) else { return 0.0 };
    // Several springs may act on one edge: together they constrain it by at most their sum.
    let springs = scene.supports.iter().filter(|support| !support.is_rigid() && !support.may_lift_off());
    let in_plane = |support: &Support| {
        (0..3).filter(|axis| *axis != struck).map(|axis| support.stiffness_along(axis)).fold(0.0, f64::max)
    };
    let along: f64 = springs.map(in_plane).sum();
    along * size[struck] / scene.body.struck().young
}
