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
//! - in the loaded layer, but for its lower end, the half-space's part of A P_c is Hertz's field in closed form, and the rest of A decays as
//!   e^{−ξ(2h − z)}, h being the thickness of that layer: so the surface has no slowly convergent integral;
//! - the rest is even and analytic in r_c: a short Chebyshev series in r_c².

use std::f64::consts::PI;

use super::point::PointField;
use super::pressure::{Pressure, smooth_plane, smooth_transform};
use super::{Response, Section, Stack, Wave};
use crate::element::gauss_legendre;
use crate::form::hertz_wave;

/// How a body carries the force.
#[derive(Debug, Clone, Copy, PartialEq)]
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
}

/// Radius over the thickness up to which the field is resolved.
pub const REACH: f64 = 4.0;

/// Depth over the loaded layer's thickness down to which the half-space's part is taken out.
const SHALLOW: f64 = 0.9;

/// Exponents in e^{−ξz} from which on nothing is left: 1e-12 of the integrand.
const END: f64 = 28.0;

/// ξR from which on nothing is left of a spread pressure that meets a surface: 1e-5 of it.
const END_OF_SPREAD: f64 = 100.0;

/// Points of Gauss's rule on one panel, and its width times the stack's thickness. J₀ at the largest radius turns by 20 rad on it: 1e-10.
const POINTS: usize = 16;
const PANEL: f64 = 5.0;

/// One wavenumber of the quadrature.
#[derive(Debug, Clone)]
struct Node {
    wavenumber: f64,
    /// ξ dξ/(2π), 1/m².
    weight: f64,
    wave: Wave,
    /// P_w.
    carried: f64,
    /// L's pressure.
    smooth: f64,
    /// Of Chebyshev's polynomials: P_c.
    contact: Vec<f64>,
}

/// The local field of a body.
#[derive(Debug, Clone)]
pub struct LocalField {
    stack: Stack,
    section: Section,
    carrier: Carrier,
    largest: f64,
    nodes: Vec<Node>,
}

impl Carrier {
    /// The pressure.
    pub fn pressure(&self) -> &Pressure {
        match self {
            Self::Plate { pressure, .. } | Self::Solid { pressure } | Self::BentSolid { pressure } => pressure,
        }
    }
}

impl LocalField {
    /// Prepares the field for contact radii up to a positive largest one, m.
    pub fn new(stack: Stack, carrier: Carrier, largest: f64) -> Self {
        let (height, first) = (stack.thickness(), stack.layers()[0].thickness);
        // The rest has its singularities at r_c² = −z² and beyond: Bernstein's ellipse, for 1e-9.
        let centre = 1.0 + 2.0 * (SHALLOW * first / largest).powi(2);
        let decay = (centre + (centre * centre - 1.0).sqrt()).ln();
        let terms = ((20.7 / decay).ceil() + 1.0).clamp(4.0, 24.0) as usize;
        let end_of_spread = match carrier {
            Carrier::Solid { pressure: Pressure::Spread { radius, .. } }
            | Carrier::BentSolid { pressure: Pressure::Spread { radius, .. } } => END_OF_SPREAD / radius,
            _ => 0.0,
        };
        let end = end_of_spread.max(END / (SHALLOW * first));
        let rule = gauss_legendre(POINTS);
        let mut nodes = Vec::new();
        for ends in panels(&stack, end).windows(2) {
            let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            nodes.extend(rule.iter().map(|(at, weight)| {
                let wavenumber = middle + half * at;
                Node {
                    wavenumber,
                    weight: half * weight * wavenumber / (2.0 * PI),
                    wave: stack.wave(wavenumber),
                    carried: carrier.pressure().transform(wavenumber),
                    smooth: smooth_transform(wavenumber * height),
                    contact: chebyshev(terms, |square| hertz_wave(wavenumber * largest * square.sqrt())),
                }
            }));
        }
        let section = Section::new(&stack);
        Self { stack, section, carrier, largest, nodes }
    }

    /// The field at a radius from the line of the force and a depth below the loaded face, m, between the faces. `None` beyond [`REACH`]
    /// thicknesses.
    pub fn at(&self, radius: f64, depth: f64) -> Option<PointField> {
        let height = self.stack.thickness();
        if radius > REACH * height {
            return None;
        }
        let depth = depth.clamp(0.0, height);
        let is_shallow = depth < SHALLOW * self.stack.layers()[0].thickness;
        let terms = self.nodes.first().map_or(0, |node| node.contact.len());
        let mut coefficients = vec![[0.0; 4]; terms];
        let bending = self.section.bending(&self.stack, depth);
        for node in &self.nodes {
            let bessel = bessel(node.wavenumber * radius).map(|j| j * node.weight);
            let exact = components(&node.wave.response(&self.stack, depth));
            let mut of_contact = exact;
            let mut of_body = [0.0; 4];
            if is_shallow {
                let half_space = components(&node.wave.half_space(&self.stack, depth));
                (0..4).for_each(|i| of_contact[i] -= half_space[i]);
            }
            match self.carrier {
                Carrier::Plate { .. } => {
                    let smooth = node.smooth / (node.wavenumber * node.wavenumber);
                    (of_body[0], of_body[1]) = (bending.sum * smooth, bending.difference * smooth);
                }
                // Hertz's pressure on a half-space is in closed form here too.
                Carrier::Solid { pressure: Pressure::Hertz { .. } } => of_body = of_contact.map(|a| a * node.carried),
                Carrier::Solid { .. } => of_body = exact.map(|a| a * node.carried),
                Carrier::BentSolid { .. } => {
                    let other = components(&node.wave.response(&self.stack, height - depth));
                    let signs = [-1.0, -1.0, -1.0, 1.0];
                    of_body = std::array::from_fn(|i| 0.5 * (exact[i] + signs[i] * other[i]) * node.carried);
                }
            }
            for (i, j) in [0, 2, 0, 1].into_iter().enumerate() {
                coefficients[0][i] -= of_body[i] * bessel[j];
                let factor = of_contact[i] * bessel[j];
                coefficients.iter_mut().zip(&node.contact).for_each(|(to, part)| to[i] += factor * part);
            }
        }
        if let Some(first) = coefficients.first_mut() {
            let closed = self.closed(radius, depth, is_shallow);
            (0..4).for_each(|i| first[i] -= closed[i]);
        }
        let poisson = self.stack.layers()[0].poisson;
        let hertz = is_shallow.then_some((poisson, radius, depth));
        Some(PointField { hertz, coefficients, largest: self.largest })
    }

    /// What the body has besides the sum over wavenumbers.
    fn closed(&self, radius: f64, depth: f64, is_shallow: bool) -> [f64; 4] {
        let height = self.stack.thickness();
        match self.carrier {
            Carrier::Plate { pressure, reading } => {
                let radius = if pressure == Pressure::Point { radius.max(1e-9 * height) } else { radius };
                let (plane, bending) = (pressure.plane(radius), self.section.bending(&self.stack, depth));
                let (potential, average) = smooth_plane(radius, height);
                let read = 2.0 * PI * reading;
                let sum = plane.potential - potential + read * plane.density;
                let difference = plane.average - average + read * (plane.mean - plane.density);
                [
                    bending.sum * sum / (2.0 * PI),
                    bending.difference * difference / (2.0 * PI),
                    0.0,
                    0.5 * bending.shear * radius * plane.mean,
                ]
            }
            Carrier::Solid { pressure: Pressure::Hertz { radius: patch } } if is_shallow => {
                let poisson = self.stack.layers()[0].poisson;
                let field = super::half_space::hertz(poisson, radius, depth, patch);
                [field.rr + field.tt, field.rr - field.tt, field.zz, field.rz]
            }
            Carrier::Solid { .. } | Carrier::BentSolid { .. } => [0.0; 4],
        }
    }
}

/// σ_rr + σ_θθ, σ_rr − σ_θθ, σ_zz, σ_rz.
fn components(response: &Response) -> [f64; 4] {
    [response.sum, response.difference, response.sigma_zz, response.sigma_rz]
}

/// J₀, J₁, J₂.
fn bessel(x: f64) -> [f64; 3] {
    let (j0, j1) = (libm::j0(x), libm::j1(x));
    // J₂ = x²/8 − …, rounded to 1e-16 of 1.
    [j0, j1, if x > 1e-6 { 2.0 * j1 / x - j0 } else { 0.0 }]
}

/// The ends of the panels from 0 to an end, 1/m: finer towards 0, where the layers of a stack with a soft one begin to slide.
fn panels(stack: &Stack, end: f64) -> Vec<f64> {
    let moduli = stack.layers().iter().map(|layer| layer.young);
    let (least, most) = moduli.fold((f64::INFINITY, 0.0_f64), |(least, most), e| (least.min(e), most.max(e)));
    let halvings = (most / least).log(16.0).ceil() as i32;
    let width = PANEL / stack.thickness();
    let count = (end / width).ceil().max(1.0);
    let fine = (1..=halvings).rev().map(|i| width * 0.25_f64.powi(i));
    std::iter::once(0.0).chain(fine).chain((1..=count as usize).map(|i| end * i as f64 / count)).collect()
}

/// Coefficients of Chebyshev's polynomials of 2q − 1 for a function of q in [0, 1], by interpolation at their roots.
fn chebyshev(terms: usize, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let angle = |k: usize| PI * (k as f64 + 0.5) / terms as f64;
    let values: Vec<f64> = (0..terms).map(|k| f(0.5 + 0.5 * angle(k).cos())).collect();
    let coefficient = |degree: usize| {
        let sum: f64 = values.iter().enumerate().map(|(k, value)| value * (degree as f64 * angle(k)).cos()).sum();
        sum * if degree == 0 { 1.0 } else { 2.0 } / terms as f64
    };
    (0..terms).map(coefficient).collect()
}
