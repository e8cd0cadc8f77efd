//! Viscoelastic parts of a body over a step, exact for displacements that are linear in time over the step.
//!
//! Each term of the generalised Maxwell chain stores the stretch of its spring, w = u − z, and D w. Over a step
//! w⁺ = E w + φ Δu ([`Decay`]), so that the body's force K u + Σ G_i D w_i changes by (K + Σ G_i φ_i D)
//! Δu − Σ G_i (1 − E_i) D w_i. The stored energy is ½ Σ G_i wᵀD w; the dashpots dissipate the rest of the work. A
//! translation of the whole body is subtracted from Δu: it does not change D Δu, except for its rounding.

use petsc_wrap::{Matrix, Vector};

use crate::body::{Body, Relaxation};
use crate::error::Result;
use crate::material::Decay;

use crate::impact::checkpoint::Visitor;

/// State of one Maxwell term.
pub struct MaxwellTermState {
    /// Stretch w of the spring, m.
    stretch: Vector,
    /// Product D w, m².
    distortion: Vector,
}

/// Energies exchanged by the viscoelastic parts over a step, J.
#[derive(Debug, Clone, Copy, Default)]
pub struct Relaxed {
    /// Dissipated by the dashpots.
    pub dissipated: f64,
    /// Stored plus dissipated energy, minus the work of the mean of the forces at both ends, which the scheme accounts
    /// for.
    pub numerical: f64,
}

/// All terms of a body, with their factors for one step size.
pub struct Relaxing {
    /// For each relaxation, and each of its terms: modulus G, Pa, and the factors of a step.
    terms: Vec<Vec<(f64, Decay)>>,
    /// Δu without the translation, m.
    bent: Vector,
    /// Product D Δu.
    moved: Vector,
}

impl MaxwellTermState {
    /// States of all terms of a body that has been at rest.
    pub(super) fn all(body: &Body) -> Result<Vec<Self>> {
        let count: usize = body.terms.relaxations.iter().map(|relaxation| relaxation.chain.terms.len()).sum();
        (0..count)
            .map(|_| Ok(Self { stretch: body.terms.load.duplicate()?, distortion: body.terms.load.duplicate()? }))
            .collect()
    }

    pub(super) fn copy_from(&mut self, other: &Self) -> Result<()> {
        self.stretch.copy_from(&other.stretch)?;
        Ok(self.distortion.copy_from(&other.distortion)?)
    }

    /// Saves the states to a checkpoint or restores them.
    pub(super) fn visit(lags: &mut [Self], visitor: &mut Visitor) -> Result<()> {
        for (number, lag) in lags.iter_mut().enumerate() {
            visitor.vector(&format!("stretch.{number}"), &mut lag.stretch)?;
            visitor.vector(&format!("distortion.{number}"), &mut lag.distortion)?;
        }
        Ok(())
    }
}

/// Moduli of a body's terms, in the order of their states.
fn moduli(body: &Body) -> impl Iterator<Item = f64> {
    body.terms
        .relaxations
        .iter()
        .flat_map(|relaxation: &Relaxation<Matrix>| relaxation.chain.terms.iter().map(|term| term.modulus))
}

/// out ← out + Σ G_i D w_i.
pub(super) fn add_force(body: &Body, lags: &[MaxwellTermState], out: &mut Vector) -> Result<()> {
    moduli(body).zip(lags).try_for_each(|(modulus, lag)| Ok(out.axpy(modulus, &lag.distortion)?))
}

/// Σ G_i (½ wᵀD w − ½ uᵀD w), J: energy stored by the terms minus half of the product of u with their force.
/// Collective.
pub(super) fn stored_beyond(body: &Body, lags: &[MaxwellTermState], u: &Vector, surface: f64) -> Result<f64> {
    let mut sum = 0.0;
    for (modulus, lag) in moduli(body).zip(lags) {
        let MaxwellTermState { stretch, distortion } = lag;
        let bent = distortion.dot(u)? - surface * distortion.dot(&body.terms.translation)?;
        sum += 0.5 * modulus * (distortion.dot(stretch)? - bent);
    }
    Ok(sum)
}

impl Relaxing {
    /// Sets up the terms for a step size (s); `None` for a body without viscoelastic parts.
    pub(super) fn new(body: &Body, step: f64) -> Result<Option<Self>> {
        if moduli(body).next().is_none() {
            return Ok(None);
        }
        let of = |relaxation: &Relaxation<Matrix>| -> Vec<(f64, Decay)> {
            relaxation.chain.terms.iter().map(|term| (term.modulus, Decay::new(step, term.time))).collect()
        };
        let terms = body.terms.relaxations.iter().map(of).collect();
        Ok(Some(Self { terms, bent: body.terms.load.duplicate()?, moved: body.terms.load.duplicate()? }))
    }

    /// out ← out + factor Σ G_i (1 − E_i) D w_i: the loss of force over a step without motion.
    pub(super) fn add_lost(&self, lags: &[MaxwellTermState], factor: f64, out: &mut Vector) -> Result<()> {
        let terms = self.terms.iter().flatten().zip(lags);
        terms
            .into_iter()
            .try_for_each(|((modulus, decay), lag)| Ok(out.axpy(factor * modulus * decay.lost, &lag.distortion)?))
    }

    /// Computes the states after a step by an increment Δu (m). Collective.
    pub(super) fn advance(
        &mut self,
        body: &Body,
        increment: &Vector,
        from: &[MaxwellTermState],
        to: &mut [MaxwellTermState],
    ) -> Result<Relaxed> {
        let Self { terms, bent, moved } = self;
        bent.copy_from(increment)?;
        bent.axpy(-body.terms.contact.force.dot(increment)?, &body.terms.translation)?;
        let mut relaxed = Relaxed::default();
        let mut number = 0;
        for (relaxation, terms) in body.terms.relaxations.iter().zip(terms) {
            relaxation.distortion.mult(bent, moved)?;
            let square = moved.dot(bent)?;
            for (modulus, decay) in terms.iter() {
                let (before, after) = (&from[number], &mut to[number]);
                let (stored, mixed) = (before.distortion.dot(&before.stretch)?, before.distortion.dot(bent)?);
                let Decay { left: e, taken: phi, .. } = *decay;
                for (out, old, change) in [
                    (&mut after.stretch, &before.stretch, &*bent),
                    (&mut after.distortion, &before.distortion, &*moved),
                ] {
                    out.copy_from(old)?;
                    out.scale(e)?;
                    out.axpy(phi, change)?;
                }
                let dissipated = decay.loss([stored, mixed, square]);
                let end = e * e * stored + 2.0 * e * phi * mixed + phi * phi * square;
                let mean = 0.5 * ((1.0 + e) * mixed + phi * square);
                relaxed.dissipated += modulus * dissipated;
                relaxed.numerical += modulus * (0.5 * (end - stored) + dissipated - mean);
                number += 1;
            }
        }
        Ok(relaxed)
    }
}
