//! Where the energy is, step by step.

use petsc_wrap::Vector;

use crate::body::Solid;
use crate::error::Result;

use super::State;
use super::step::Energy;

/// Sums what has left and entered the system, and tells the energies of a state.
pub struct Ledger {
    dissipated: f64,
    external: f64,
    product: Vector,
}

impl Ledger {
    pub(super) fn new(body: &Solid) -> Result<Self> {
        Ok(Self { dissipated: 0.0, external: 0.0, product: body.load.duplicate()? })
    }

    /// Counts the dampers' loss and the loads' work over an increment of u in a step (s). With the mean velocity
    /// ΔU/Δt the balance of the average acceleration's linear part is exact. Collective.
    pub(super) fn account(&mut self, body: &Solid, increment: &Vector, step: f64) -> Result<()> {
        if let Some(damping) = &body.damping {
            damping.mult(increment, &mut self.product)?;
            self.dissipated += self.product.dot(increment)? / step;
        }
        self.external += body.load.dot(increment)?;
        Ok(())
    }

    /// The energies of a state; impactor's and contact's are given. Collective.
    pub(super) fn energy(&mut self, body: &mut Solid, state: &State, impactor: f64, contact: f64) -> Result<Energy> {
        let State { u, v, .. } = state;
        body.mass.mult(v, &mut self.product)?;
        let kinetic = 0.5 * self.product.dot(v)?;
        body.elastic.mult(u, &mut self.product)?;
        let elastic = 0.5 * self.product.dot(u)?;
        let mut support = body.support_offset - body.support_load.dot(u)?;
        if let Some(matrix) = &body.support {
            matrix.mult(u, &mut self.product)?;
            support += 0.5 * self.product.dot(u)?;
        }
        if let Some(pads) = &mut body.pads {
            support += pads.potential(u)?;
        }
        Ok(Energy {
            kinetic,
            elastic,
            support,
            impactor,
            contact,
            dissipated: self.dissipated,
            external: self.external,
            total: kinetic + elastic + support + impactor + contact,
        })
    }
}
