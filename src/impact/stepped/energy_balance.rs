//! Energy balance of each step.
//!
//! Let D, Δa, Δv, ΔF be the changes over a step of the family α_m, α_f, β, γ. The discrete equations then give exactly
//!
//! ΔE + D·C v̄ + F_d D_δ − D·f = ΔV − (F − F_d) D_δ + Δψ − p·D − (1/2 − α_f) D·(K D + C Δv)
//! − (1 − γ − α_m) D·M Δa − Δt² (β − γ/2) Δa·M((1−γ) a_n + γ a_{n+1})
//!
//! over body and impactor with their loads f. E is the total energy, v̄ the mean velocity, V and ψ the potentials of
//! contact and pads, F and p the forces used in the step, and F_d the damping part of F. The left side is the balance
//! of stored, dissipated and supplied energy. The right side is the energy gained or lost by the scheme. It is zero for
//! the midpoint rule with discrete gradients, except for the contribution of viscoelastic parts
//! ([`super::relaxation`]). (The central difference is the case β = 0, with the lumped mass.)

use petsc_wrap::{Vector, VectorView};

use crate::body::Body;
use crate::error::Result;
use crate::scheme::Implicit;

use super::relaxation::{Relaxed, stored_beyond};
use super::state::Moment;
use crate::impact::checkpoint::Visitor;
use crate::impact::parameters::ImpactParameters;
use crate::impact::step::Energy;

/// Energies exchanged in a step, J.
#[derive(Debug, Clone, Copy, Default)]
pub struct Exchange {
    /// Dissipated by dampers, viscoelastic parts and the contact: D·C v̄ + F_d D_δ and the dashpots.
    pub dissipated: f64,
    /// Work of the loads, D·f, and of the impactor's weight.
    pub external: f64,
    /// Gained (negative: lost) by the scheme.
    pub numerical: f64,
}

/// Forces of a step and the increment on which they do work.
pub struct Work<'a> {
    /// Increment D, m.
    pub increment: &'a Vector,
    /// Contact force F, N.
    pub force: f64,
    /// Damping part of F, N.
    pub damping: f64,
    /// Energies exchanged by the viscoelastic parts.
    pub relaxed: Relaxed,
    /// Pad forces p, N.
    pub pads: Option<&'a Vector>,
}

/// Energies exchanged in one step; `work` is overwritten. Collective.
pub(super) fn exchange(
    body: &Body,
    parameters: &ImpactParameters,
    (scheme, step): (&Implicit, f64),
    (from, to): (&Moment, &Moment),
    done: Work,
    work: &mut Vector,
) -> Result<Exchange> {
    let Implicit { alpha_m, alpha_f, beta, gamma, .. } = *scheme;
    let d = done.increment;
    let impactor = to.state.q.position - from.state.q.position;
    let (q0, q1) = (from.state.q, to.state.q);
    let (before, after) = (&from.products, &to.products);
    let damping = before.damping.as_ref().zip(after.damping.as_ref());
    let support = before.support.as_ref().zip(after.support.as_ref());
    // All forces that do work on D, so that one reduction is enough.
    let mut forces: Vec<&VectorView> =
        vec![&body.terms.load, &before.elastic, &after.elastic, &from.inertia, &to.inertia];
    let pairs = [damping, support].into_iter().flatten();
    forces.extend(pairs.flat_map(|(before, after)| [&**before, after]));
    forces.extend(done.pads.map(|pads| &**pads));
    let mut works = d.dots(&forces)?.into_iter();
    let mut next = || works.next().expect("one work for each force");
    let external = next() + parameters.weight * impactor;
    let [elastic, inertia] = std::array::from_fn(|_| -next() + next());
    let Relaxed { dissipated, numerical } = done.relaxed;
    let mut exchange = Exchange { external, dissipated, numerical };
    let potential = |approach| parameters.law.potential(approach);
    let contact = done.force - done.damping;
    exchange.numerical += potential(to.approach) - potential(from.approach) - contact * (to.approach - from.approach);
    exchange.dissipated += done.damping * (to.approach - from.approach);
    let mut stiffness = elastic;
    if damping.is_some() {
        let (before, after) = (next(), next());
        exchange.dissipated += 0.5 * (before + after);
        stiffness += after - before;
    }
    if support.is_some() {
        stiffness += -next() + next();
    }
    if done.pads.is_some() {
        exchange.numerical += to.pads - from.pads - next();
    }
    exchange.numerical -= (0.5 - alpha_f) * stiffness;
    let (of_mass, of_square) = (1.0 - gamma - alpha_m, step * step * (beta - 0.5 * gamma));
    let of_impactor = parameters.mass * impactor * (q1.acceleration - q0.acceleration);
    exchange.numerical -= of_mass * (inertia + of_impactor);
    if of_square != 0.0 {
        work.set_combination(&[(1.0, &to.state.a), (-1.0, &from.state.a)])?;
        let dots = work.dots(&[&from.inertia, &to.inertia])?;
        let body = (1.0 - gamma) * dots[0] + gamma * dots[1];
        let mean = (1.0 - gamma) * q0.acceleration + gamma * q1.acceleration;
        let impactor = parameters.mass * mean * (q1.acceleration - q0.acceleration);
        exchange.numerical -= of_square * (body + impactor);
    }
    Ok(exchange)
}

/// Sums of the exchanged energies since t = 0.
#[derive(Debug, Clone, Copy, Default)]
pub struct EnergyBalance {
    sum: Exchange,
}

impl EnergyBalance {
    /// Adds the energies of a step.
    pub(super) fn account(&mut self, step: Exchange) {
        self.sum.dissipated += step.dissipated;
        self.sum.external += step.external;
        self.sum.numerical += step.numerical;
    }

    /// Saves the sums to a checkpoint or restores them.
    pub(super) fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        let Exchange { dissipated, external, numerical } = &mut self.sum;
        visitor.number("dissipated", dissipated)?;
        visitor.number("external", external)?;
        visitor.number("numerical", numerical)
    }

    /// Energies of the whole body, the impactor and the contact at a moment. Collective.
    pub(super) fn energy(&self, body: &Body, parameters: &ImpactParameters, at: &Moment) -> Result<Energy> {
        let Moment { state, products, .. } = at;
        let multiplicity = parameters.multiplicity;
        let kinetic = multiplicity * 0.5 * products.momentum.dot(&state.v)?;
        // Computed from u without its translation, like K u.
        let dots = products.elastic.dots(&[&state.u, &body.terms.translation])?;
        let bent = dots[0] - at.surface * dots[1];
        let relaxing = stored_beyond(body, &at.lags, &state.u, at.surface)?;
        let elastic = multiplicity * (0.5 * bent + relaxing);
        let mut forces: Vec<&VectorView> = vec![&body.terms.support_load];
        forces.extend(products.support.iter().map(|support| &**support));
        let dots = state.u.dots(&forces)?;
        let support = body.terms.support_offset - dots[0] + at.pads + 0.5 * dots.get(1).copied().unwrap_or_default();
        let support = multiplicity * support;
        let impactor = multiplicity * 0.5 * parameters.mass * state.q.velocity * state.q.velocity;
        let contact = multiplicity * parameters.law.potential(at.approach);
        Ok(Energy {
            kinetic,
            elastic,
            support,
            impactor,
            contact,
            dissipated: multiplicity * self.sum.dissipated,
            external: multiplicity * self.sum.external,
            numerical: multiplicity * self.sum.numerical,
            total: kinetic + elastic + support + impactor + contact,
        })
    }
}
