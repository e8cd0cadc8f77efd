//! What a body's stresses lack near the hit: the exact field under Hertz's pressure over the contact, less what the body has already.
//!
//! Both are those of an infinite stack at rest, and differ near the hit alone. In wavenumbers,
//!
//! Δσ = (1/2π) ∫ ξ [A P_c − A_w P_w] J(ξr) dξ,
//!
//! with A of the stack at the point's depth, P_c of Hertz's pressure over the contact radius r_c, A_w and P_w of the body
//! ([`Carrier`]). Long waves of A are those of a thin plate, L/ξ²: the integrals exist together only. Therefore
//!
//! - under a plate theory both lose L/ξ² of one smooth pressure, (1 + ξa) e^{−ξa}; what is left of A decays as e^{−ξz} and is summed
//!   by Gauss's rule; what is left of the plate is elementary ([`Pressure`]);
//! - in the loaded layer, but for its lower end, the half-space's part is Hertz's field in closed form, and the rest of A decays as
//!   e^{−ξ(2h − z)}, h being the thickness of that layer: so the surface has no slowly convergent integral;
//! - the rest is even and analytic in r_c: a short Chebyshev series in r_c².

use std::f64::consts::PI;

use super::level::Level;
use super::point::PointField;
use super::pressure::{Pressure, smooth_transform};
use super::{Layerwise, LayerwiseWave, Section, Stack, Wave};
use crate::element::gauss_legendre;
use crate::form::hertz_wave;

/// How a body carries the force.
#[derive(Debug, Clone, PartialEq)]
pub enum Carrier {
    /// A plate of Kirchhoff's or of Mindlin's theory.
    ///
    /// Where the force is the pressure times the mean of w + s h² ∇·θ, with s h² the `reading` (m²), it also bends the plate: moments
    /// have the transform P_w (1 + s h² ξ²), shear forces P_w. Kirchhoff's plate has a reading of 0. Under a point force the moment is
    /// infinite on the axis: there the field is that at 1e-9 thicknesses.
    Plate {
        /// Of the force.
        pressure: Pressure,
        /// s h², m².
        reading: f64,
    },
    /// A plate of the layerwise theory of the same stack.
    Layerwise {
        /// Of the force: a spread one over the stack's thickness or more, for which the sum over waves converges.
        pressure: Pressure,
        /// The theory.
        theory: Layerwise,
        /// Of the disc over which its stresses are read as a mean; `None` where they are read as they are.
        smoothing: Option<Pressure>,
    },
    /// A solid that resolves the thickness.
    Solid {
        /// Of the force.
        pressure: Pressure,
    },
    /// A solid of one layer that bends alone: half of the force is on each face.
    BentSolid {
        /// Of the force.
        pressure: Pressure,
    },
    /// A body that is read by the resultants of its sections, as means over a disc: stresses along the face by their mean and
    /// moment over the thickness, those across it by the shear force on a parabola; of several layers each by its own mean and moments. Both
    /// pressures are spread ones over half the thickness of the loaded layer or more, for which the sum over waves converges.
    Sections {
        /// Of the force.
        pressure: Pressure,
        /// Of the disc over which the mean is taken.
        smoothing: Pressure,
        /// What the body is.
        body: Sections,
    },
}

/// What carries a force through sections.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sections {
    /// A plate, with its reading as of [`Carrier::Plate`], m².
    Plate {
        /// s h².
        reading: f64,
    },
    /// A solid that resolves the thickness, of one layer or several.
    Solid,
    /// A solid that bends alone, whose sections have no mean.
    BentSolid,
}

/// Thicknesses outside of the body's disc up to which waves are summed.
const REACH: f64 = 4.0;

/// Depth over the loaded layer's thickness down to which the half-space's part is taken out.
pub(super) const SHALLOW: f64 = 0.9;

/// Exponents in e^{−ξz} from which on nothing is left: 1e-7 of a stress of 1/z².
pub(super) const END: f64 = 22.0;

/// Points of Gauss's rule on one panel, and the angle by which its waves turn at most: (e·PANEL/8·POINTS)^{2·POINTS}, 1e-12. Long panels
/// take the fewest points for an angle.
const POINTS: usize = 32;
const PANEL: f64 = 60.0;

/// Points of it where nothing turns.
const FEW_POINTS: usize = 16;

/// Most terms of Chebyshev's series.
const MOST_TERMS: usize = 24;

/// One wavenumber of the quadrature.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub wavenumber: f64,
    /// ξ dξ/(2π), 1/m².
    pub weight: f64,
    pub wave: Wave,
    /// The layerwise theory's, where it carries the force.
    pub layerwise: Option<LayerwiseWave>,
    /// P_w, times that of the mean where one is taken.
    pub carried: f64,
    /// (1 + ξa) e^{−ξa}, a being the stack's thickness.
    pub smooth: f64,
    /// P_c: of Chebyshev's polynomials of 2 (r_c/largest)² − 1.
    pub contact: Vec<f64>,
}

/// The local field of a body: by [`LocalField::at`] a table for each point, made once, which gives the stresses for any contact radius.
#[derive(Debug, Clone)]
pub struct LocalField {
    pub(super) stack: Stack,
    pub(super) section: Section,
    pub(super) carrier: Carrier,
    /// The largest contact radius, m.
    pub(super) largest: f64,
    pub(super) nodes: Vec<Node>,
    /// Gauss's, on \[−1, 1\].
    pub(super) rule: Vec<(f64, f64)>,
    /// Outside of the body's disc, m.
    reach: f64,
}

impl Carrier {
    /// The pressure that the body is under.
    pub fn pressure(&self) -> &Pressure {
        match self {
            Self::Plate { pressure, .. }
            | Self::Layerwise { pressure, .. }
            | Self::Solid { pressure }
            | Self::BentSolid { pressure }
            | Self::Sections { pressure, .. } => pressure,
        }
    }
}

impl Carrier {
    /// The radius (m) within which the body's field is that of its own disc.
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

    /// The same where no point is farther from the line of the force than a radius, m.
    pub fn within(reach: f64, stack: Stack, carrier: Carrier, largest: f64) -> Self {
        // The rest has its singularities at r_c² = −z² and beyond: Bernstein's ellipse, for 1e-9.
        let centre = 1.0 + 2.0 * (SHALLOW * stack.layers()[0].thickness / largest).powi(2);
        let decay = (centre + (centre * centre - 1.0).sqrt()).ln();
        let terms = ((20.7 / decay).ceil() + 1.0).clamp(4.0, MOST_TERMS as f64) as usize;
        Self::with_contacts(reach, stack, carrier, (largest, Chebyshev::new(terms)))
    }

    /// The same on the line of the force, at one contact radius alone, m.
    pub fn on_axis(stack: Stack, carrier: Carrier, contact_radius: f64) -> Self {
        Self::with_contacts(0.0, stack, carrier, (contact_radius.max(f64::MIN_POSITIVE), Chebyshev::at_end()))
    }

    fn with_contacts(reach: f64, stack: Stack, carrier: Carrier, (largest, chebyshev): (f64, Chebyshev)) -> Self {
        let height = stack.thickness();
        let (rule, few) = (gauss_legendre(POINTS), gauss_legendre(FEW_POINTS));
        let (fine, panels) = panels(&stack, reach + carrier.reach() + largest);
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

    /// The radius (m) beyond which the field is taken as σ_rr = −σ_θθ ∝ r⁻²: the stretch by the mean of σ_zz, and the warping that goes with
    /// the shear force, which plate theories do not have.
    ///
    /// On one layer under a plate theory it is there 0.3% of the largest tension on the lower face, and the rest of the field 1e-4.
    pub fn reach(&self) -> f64 {
        self.reach + self.carrier.reach()
    }

    /// The field at a radius from the line of the force and a depth below the loaded face, m, between the faces.
    pub fn at(&self, radius: f64, depth: f64) -> PointField {
        self.at_depth(depth).at(radius)
    }

    /// The field at a depth (m), for many radii: they share what the waves have there.
    pub fn at_depth(&self, depth: f64) -> Level<'_> {
        Level::new(self, depth)
    }
}

/// The ends of the panels, 1/m, for waves that turn by no more than over a length, m: finer towards 0, where the layers of a stack with a
/// soft one begin to slide; with the number of these.
fn panels(stack: &Stack, length: f64) -> (usize, Vec<f64>) {
    let moduli = stack.layers().iter().map(|layer| layer.young);
    let (least, most) = moduli.fold((f64::INFINITY, 0.0_f64), |(least, most), e| (least.min(e), most.max(e)));
    // (Panels are wide: one more where there is any.)
    let quarterings = (1.0 + (most / least).log(16.0)).ceil() as i32;
    let quarterings = if quarterings > 1 { quarterings } else { 0 };
    let end = END / (SHALLOW * stack.layers()[0].thickness);
    let count = (end * length / PANEL).ceil().max(1.0);
    let width = end / count;
    let fine = (1..=quarterings).rev().map(|i| width * 0.25_f64.powi(i));
    let ends = std::iter::once(0.0).chain(fine).chain((1..=count as usize).map(|i| width * i as f64)).collect();
    (quarterings as usize, ends)
}

/// What makes coefficients of Chebyshev's polynomials of 2q − 1 for functions of q in [0, 1], by interpolation at their roots.
struct Chebyshev {
    /// q at the roots.
    roots: Vec<f64>,
    /// The weights of the values at the roots in each coefficient.
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

    /// The value at q = 1 alone, as a constant.
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
