//! Local field that the computed stresses of a body lack near the impact point: the exact field under Hertz's pressure
//! over the contact disc, minus the field that the body's model already contains.
//!
//! Both are static fields of an infinite stack, and they differ only near the impact point. As integrals over
//! wavenumbers,
//!
//! Δσ = (1/2π) ∫ ξ [A P_c − A_w P_w] J(ξr) dξ,
//!
//! with A for the stack at the depth of the point, P_c for Hertz's pressure over the contact radius r_c, and A_w and
//! P_w for the body ([`Carrier`]). For long waves A tends to L/ξ² of a thin plate, so that only the difference of both
//! terms can be integrated. Therefore
//!
//! - under a plate theory, L/ξ² times the transform of one smooth pressure, (1 + ξa) e^{−ξa}, is subtracted from both
//!   terms. The rest of A decays as e^{−ξz} and is integrated by Gauss's rule. The rest of the plate's term is
//!   elementary ([`Pressure`]);
//! - in the loaded layer, except near its lower face, the half-space's part is Hertz's field in closed form. The rest
//!   of A decays as e^{−ξ(2h − z)}, where h is the thickness of that layer. So there is no slowly convergent integral
//!   at the surface;
//! - the rest is even and analytic in r_c: it is a short Chebyshev series in r_c².

use std::f64::consts::PI;

use super::level::Level;
use super::point::PointField;
use super::pressure::{Pressure, smooth_transform};
use super::{Layerwise, LayerwiseWave, Section, Stack, Wave};
use crate::element::gauss_legendre;
use crate::form::hertz_wave;

/// Type of the body's model, and the pressure of the force on it.
#[derive(Debug, Clone, PartialEq)]
pub enum Carrier {
    /// Plate of Kirchhoff's theory. Under a point force the moment is infinite on the axis; the field there is evaluated
    /// at a radius of 1e-9 thicknesses.
    Plate {
        /// Pressure of the force on the plate.
        pressure: Pressure,
    },
    /// Plate of the layerwise theory of the same stack.
    Layerwise {
        /// Pressure of the force: a spread one over the stack's thickness or more, so that the sum over waves
        /// converges.
        pressure: Pressure,
        /// Layerwise theory of the stack.
        theory: Layerwise,
        /// Pressure with the weights of the disc over which the stresses are averaged; `None` if they are not averaged.
        smoothing: Option<Pressure>,
    },
    /// Solid model that resolves the thickness.
    Solid {
        /// Pressure of the force on the solid.
        pressure: Pressure,
    },
    /// Solid model of one layer with bending only: half of the force acts on each face.
    BentSolid {
        /// Pressure of the force on the solid.
        pressure: Pressure,
    },
    /// Body whose stresses are computed from section resultants averaged over a disc. In-plane stresses follow from
    /// their mean and moment over the thickness, transverse shear stresses from the shear force with a parabolic
    /// distribution. In a stack of several layers, each layer has separate means and moments. Both pressures are spread
    /// ones over half the thickness of the loaded layer or more, so that the sum over waves converges.
    Sections {
        /// Pressure of the force on the body.
        pressure: Pressure,
        /// Pressure with the weights of the disc over which the resultants are averaged.
        smoothing: Pressure,
        /// Model of the body.
        body: Sections,
    },
}

/// Model of a body evaluated by its section resultants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sections {
    /// Plate of Kirchhoff's theory.
    Plate,
    /// Solid that resolves the thickness, with one layer or several.
    Solid,
    /// Solid with bending only, whose sections have no mean in-plane stress.
    BentSolid,
}

/// Distance from the edge of the body's disc, in stack thicknesses, up to which the field is summed over waves.
const REACH: f64 = 4.0;

/// Depth, divided by the thickness of the loaded layer, down to which the half-space's part is separated.
pub(super) const HERTZ_DEPTH_FRACTION: f64 = 0.9;

/// Exponent ξz at which the sum over wavenumbers is truncated. The error is 1e-7 of a stress of 1/z².
pub(super) const END: f64 = 22.0;

/// Least depth at which all waves are summed, as a fraction of the largest contact radius r_c. At smaller depths the
/// sum is cut off, with an error of some thousandths of the contact pressure.
pub const LEAST_DEPTH_OVER_CONTACT: f64 = 0.02;

/// Number of Gauss points on one panel of wavenumbers.
const POINTS: usize = 32;
/// Largest phase of the waves over one panel, rad. The error of the rule is (e·PANEL/(8·POINTS))^{2·POINTS} = 1e-12.
/// Long panels need the fewest points per phase.
const PANEL: f64 = 60.0;

/// Number of Gauss points for integrands that do not oscillate.
const FEW_POINTS: usize = 16;

/// Maximum number of terms of the Chebyshev series.
const MOST_TERMS: usize = 24;

/// One wavenumber of the quadrature.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub wavenumber: f64,
    /// Weight ξ dξ/(2π), 1/m².
    pub weight: f64,
    pub wave: Wave,
    /// Solution of the layerwise theory, if it carries the force.
    pub layerwise: Option<LayerwiseWave>,
    /// P_w, times the transform of the averaging disc if there is one.
    pub carried: f64,
    /// (1 + ξa) e^{−ξa}, where a is the thickness of the stack.
    pub smooth: f64,
    /// Coefficients of P_c in Chebyshev polynomials of 2 (r_c/largest)² − 1.
    pub contact: Vec<f64>,
}

/// Local field of a body. [`LocalField::at`] makes a table for a point once, from which the stresses for any contact
/// radius follow.
#[derive(Debug, Clone)]
pub struct LocalField {
    pub(super) stack: Stack,
    pub(super) section: Section,
    pub(super) carrier: Carrier,
    /// Largest contact radius, m.
    pub(super) largest: f64,
    pub(super) nodes: Vec<Node>,
    /// Gauss rule on \[−1, 1\].
    pub(super) rule: Vec<(f64, f64)>,
    /// Distance from the edge of the body's disc up to which the field is summed over waves, m.
    reach: f64,
}

impl Carrier {
    /// Pressure that acts on the body.
    pub fn pressure(&self) -> &Pressure {
        match self {
            Self::Plate { pressure }
            | Self::Layerwise { pressure, .. }
            | Self::Solid { pressure }
            | Self::BentSolid { pressure }
            | Self::Sections { pressure, .. } => pressure,
        }
    }
}

impl Carrier {
    /// Radius (m) within which the body's field depends on its disc.
    fn reach(&self) -> f64 {
        match self {
            Self::Sections { pressure, smoothing, .. }
            | Self::Layerwise { pressure, smoothing: Some(smoothing), .. } => pressure.radius() + smoothing.radius(),
            _ => self.pressure().radius(),
        }
    }
}

impl LocalField {
    /// Prepares the field for contact radii up to a positive largest one, m.
    pub fn new(stack: Stack, carrier: Carrier, largest: f64) -> Self {
        Self::within(REACH * stack.thickness(), stack, carrier, largest)
    }

    /// Same as [`LocalField::new`], with the field summed over waves up to the distance `reach` (m) from the edge of
    /// the body's disc.
    pub fn within(reach: f64, stack: Stack, carrier: Carrier, largest: f64) -> Self {
        // The series has singularities at r_c² = −z² and farther away. The Bernstein ellipse determines the number of
        // terms for an error of 1e-9.
        let centre = 1.0 + 2.0 * (HERTZ_DEPTH_FRACTION * stack.layers()[0].thickness / largest).powi(2);
        let decay = (centre + (centre * centre - 1.0).sqrt()).ln();
        let terms = ((20.7 / decay).ceil() + 1.0).clamp(4.0, MOST_TERMS as f64) as usize;
        Self::with_contacts(reach, stack, carrier, (largest, Chebyshev::new(terms)))
    }

    /// Same as [`LocalField::new`], on the line of the force and for one contact radius (m).
    pub fn on_axis(stack: Stack, carrier: Carrier, contact_radius: f64) -> Self {
        Self::with_contacts(0.0, stack, carrier, (contact_radius.max(f64::MIN_POSITIVE), Chebyshev::at_end()))
    }

    fn with_contacts(reach: f64, stack: Stack, carrier: Carrier, (largest, chebyshev): (f64, Chebyshev)) -> Self {
        let height = stack.thickness();
        let (rule, few) = (gauss_legendre(POINTS), gauss_legendre(FEW_POINTS));
        let (fine, panels) = panels(&stack, reach + carrier.reach() + largest, LEAST_DEPTH_OVER_CONTACT * largest);
        let mut nodes = Vec::new();
        for (number, ends) in panels.windows(2).enumerate() {
            let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            nodes.extend(if number < fine { &few } else { &rule }.iter().map(|(at, weight)| {
                let wavenumber = middle + half * at;
                Node {
                    wavenumber,
                    weight: half * weight * wavenumber / (2.0 * PI),
                    wave: stack.wave(wavenumber),
                    layerwise: match &carrier {
                        Carrier::Layerwise { theory, .. } => Some(theory.wave(wavenumber)),
                        _ => None,
                    },
                    carried: carrier.pressure().transform(wavenumber)
                        * match &carrier {
                            Carrier::Sections { smoothing, .. }
                            | Carrier::Layerwise { smoothing: Some(smoothing), .. } => smoothing.transform(wavenumber),
                            _ => 1.0,
                        },
                    smooth: smooth_transform(wavenumber * height),
                    contact: chebyshev.coefficients(|square| hertz_wave(wavenumber * largest * square.sqrt())),
                }
            }));
        }
        let section = Section::new(&stack);
        Self { stack, section, carrier, largest, nodes, rule: few, reach }
    }

    /// Radius (m) beyond which the field is extrapolated as σ_rr = −σ_θθ ∝ r⁻². This far field is due to the in-plane
    /// strain from the mean of σ_zz and to the warping of sections under the shear force. Plate theories do not contain
    /// either.
    ///
    /// For one layer under a plate theory, the field at this radius is 0.3% of the largest tension on the lower face,
    /// and the terms that decay faster are 1e-4.
    pub fn reach(&self) -> f64 {
        self.reach + self.carrier.reach()
    }

    /// Computes the field at a radius from the line of the force and a depth below the loaded face, m, between the
    /// faces.
    pub fn at(&self, radius: f64, depth: f64) -> PointField {
        self.at_depth(depth).at(radius)
    }

    /// Prepares the field at a depth (m) for many radii. The amplitudes of the waves at this depth are computed once.
    pub fn at_depth(&self, depth: f64) -> Level<'_> {
        Level::new(self, depth)
    }
}

/// Number of fine panels, and the ends of all panels, 1/m, for waves over the given length (m) at depths of at least `depth` (m).
/// Panels are finer towards 0, where the stiff layers of a stack with a soft layer begin to slide on each other.
fn panels(stack: &Stack, length: f64, depth: f64) -> (usize, Vec<f64>) {
    let moduli = stack.layers().iter().map(|layer| layer.young);
    let (least, most) = moduli.fold((f64::INFINITY, 0.0_f64), |(least, most), e| (least.min(e), most.max(e)));
    // Panels are wide, so there is one more refinement if the moduli differ.
    let quarterings = (1.0 + (most / least).log(16.0)).ceil() as i32;
    let quarterings = if quarterings > 1 { quarterings } else { 0 };
    let end = END / (HERTZ_DEPTH_FRACTION * stack.layers()[0].thickness).max(depth);
    let count = (end * length / PANEL).ceil().max(1.0);
    let width = end / count;
    let fine = (1..=quarterings).rev().map(|i| width * 0.25_f64.powi(i));
    let ends = std::iter::once(0.0).chain(fine).chain((1..=count as usize).map(|i| width * i as f64)).collect();
    (quarterings as usize, ends)
}

/// Computes coefficients of Chebyshev polynomials of 2q − 1 for functions of q in [0, 1], by interpolation at their
/// roots.
struct Chebyshev {
    /// Values of q at the roots.
    roots: Vec<f64>,
    /// For each coefficient: weights of the values at the roots.
    weights: Vec<Vec<f64>>,
}

impl Chebyshev {
    fn new(terms: usize) -> Self {
        let angle = |k: usize| PI * (k as f64 + 0.5) / terms as f64;
        let weight = |degree: usize, k: usize| {
            (degree as f64 * angle(k)).cos() * if degree == 0 { 1.0 } else { 2.0 } / terms as f64
        };
        Self {
            roots: (0..terms).map(|k| 0.5 + 0.5 * angle(k).cos()).collect(),
            weights: (0..terms).map(|degree| (0..terms).map(|k| weight(degree, k)).collect()).collect(),
        }
    }

    /// The value at q = 1 only, as a constant.
    fn at_end() -> Self {
        Self { roots: vec![1.0], weights: vec![vec![1.0]] }
    }

    fn coefficients(&self, f: impl Fn(f64) -> f64) -> Vec<f64> {
        let mut values = [0.0; MOST_TERMS];
        values.iter_mut().zip(&self.roots).for_each(|(value, q)| *value = f(*q));
        let coefficient = |weights: &Vec<f64>| weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
        self.weights.iter().map(coefficient).collect()
    }
}
