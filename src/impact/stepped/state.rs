//! State of body and impactor at one time, and the forces in it.

use petsc_wrap::{Matrix, Vector};

use crate::body::Body;
use crate::error::Result;

use super::relaxation::{MaxwellTermState, add_force};
use crate::impact::checkpoint::Visitor;

/// Displacement, velocity and acceleration of body and impactor.
pub struct State {
    /// Displacement u, m.
    pub u: Vector,
    /// Velocity u̇, m/s.
    pub v: Vector,
    /// Acceleration ü, m/s².
    pub a: Vector,
    /// State of the impactor, the same on all ranks.
    pub q: Impactor,
}

/// Motion of the impactor along its direction of travel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impactor {
    /// Position q, m.
    pub position: f64,
    /// Velocity q̇, m/s.
    pub velocity: f64,
    /// Acceleration q̈, m/s².
    pub acceleration: f64,
}

/// Products of the operators with a state, stored so that each operator is applied once a step.
pub struct Products {
    /// K u of the body without supports, plus the forces of the viscoelastic terms, N.
    pub elastic: Vector,
    /// K u of the elastic supports, N.
    pub support: Option<Vector>,
    /// C u̇, N.
    pub damping: Option<Vector>,
    /// M u̇, N s.
    pub momentum: Vector,
}

impl State {
    /// A state of zeros.
    pub(super) fn zero(body: &Body) -> Result<Self> {
        let zeros = || body.terms.load.duplicate();
        let q = Impactor { position: 0.0, velocity: 0.0, acceleration: 0.0 };
        Ok(Self { u: zeros()?, v: zeros()?, a: zeros()?, q })
    }
}

impl Products {
    /// Products of zeros.
    pub(super) fn zero(body: &Body) -> Result<Self> {
        let zeros = || body.terms.load.duplicate();
        let of = |matrix: &Option<Matrix>| matrix.as_ref().map(|_| zeros()).transpose();
        Ok(Self {
            elastic: zeros()?,
            support: of(&body.terms.support)?,
            damping: of(&body.terms.damping)?,
            momentum: zeros()?,
        })
    }

    /// Recomputes all products from u and u̇; `surface` is aᵀu, m. Collective.
    pub(super) fn update(&mut self, body: &Body, state: &State, surface: f64) -> Result<()> {
        // A translation does not change K u, except for its rounding: 1e-9 of the energy for a body that has moved far
        // away. So the translation is subtracted first. The momentum serves as work space until it is recomputed below.
        let bent = &mut self.momentum;
        bent.copy_from(&state.u)?;
        bent.axpy(-surface, &body.terms.translation)?;
        body.apply_elastic(bent, &mut self.elastic)?;
        body.apply_mass(&state.v, &mut self.momentum)?;
        self.update_of_surface(body, state)
    }

    /// Recomputes the products of supports and dampers, whose matrices have entries on the surface only. Collective.
    pub(super) fn update_of_surface(&mut self, body: &Body, state: &State) -> Result<()> {
        if let (Some(matrix), Some(product)) = (&body.terms.support, &mut self.support) {
            matrix.mult(&state.u, product)?;
        }
        if let Some(product) = &mut self.damping {
            body.apply_damping(&state.v, product)?;
        }
        Ok(())
    }

    /// out ← out + factor (K u + C u̇), including the supports' part of K.
    pub(super) fn add_internal(&self, factor: f64, out: &mut Vector) -> Result<()> {
        for product in [Some(&self.elastic), self.support.as_ref(), self.damping.as_ref()].into_iter().flatten() {
            out.axpy(factor, product)?;
        }
        Ok(())
    }
}

/// A state with its products, at one end of a step.
pub struct Moment {
    /// State u, u̇, ü, q.
    pub state: State,
    /// Products K u, C u̇, M u̇.
    pub products: Products,
    /// States of the viscoelastic terms.
    pub lags: Vec<MaxwellTermState>,
    /// M ü of the free unknowns, N.
    pub inertia: Vector,
    /// Displacement of the surface under the impactor, aᵀu, m.
    pub surface: f64,
    /// Approach δ = q − gap − aᵀu, m.
    pub approach: f64,
    /// Rate of the approach, δ̇ = q̇ − aᵀu̇, m/s.
    pub rate: f64,
    /// Potential of the pads, J.
    pub pads: f64,
}

impl Moment {
    /// State of rest at u = 0.
    pub(super) fn zero(body: &Body) -> Result<Self> {
        let (state, products) = (State::zero(body)?, Products::zero(body)?);
        let (lags, inertia) = (MaxwellTermState::all(body)?, body.terms.load.duplicate()?);
        Ok(Self { state, products, lags, inertia, surface: 0.0, approach: 0.0, rate: 0.0, pads: 0.0 })
    }

    /// Recomputes everything except the inertia, after a change of u, u̇ and q. Collective.
    pub(super) fn update(&mut self, body: &mut Body, gap: f64) -> Result<()> {
        self.place(body, gap)?;
        self.products.update(body, &self.state, self.surface)?;
        add_force(body, &self.lags, &mut self.products.elastic)?;
        if let Some(pads) = &mut body.pads {
            self.pads = pads.potential(&self.state.u)?;
        }
        Ok(())
    }

    /// Recomputes surface displacement, approach and its rate, after a change of u, u̇ and q. Collective.
    pub(super) fn place(&mut self, body: &Body, gap: f64) -> Result<()> {
        let State { u, v, q, .. } = &self.state;
        let dots = body.terms.contact.force.dots(&[u, v])?;
        self.surface = dots[0];
        self.approach = q.position - gap - self.surface;
        self.rate = q.velocity - dots[1];
        Ok(())
    }

    /// Velocity of the surface under the impactor, aᵀu̇, m/s. Collective.
    pub(super) fn surface_rate(&self, body: &Body) -> Result<f64> {
        Ok(body.terms.contact.force.dot(&self.state.v)?)
    }

    /// Second time derivative of the approach, δ̈ = q̈ − aᵀü, m/s². Collective.
    pub(super) fn acceleration(&self, body: &Body) -> Result<f64> {
        Ok(self.state.q.acceleration - body.terms.contact.force.dot(&self.state.a)?)
    }

    /// Saves the state to a checkpoint or restores it.
    pub(super) fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        let Self { state, products, lags, inertia, surface, approach, rate, pads } = self;
        let vectors = [
            ("displacement", &mut state.u),
            ("velocity", &mut state.v),
            ("acceleration", &mut state.a),
            ("elastic", &mut products.elastic),
            ("momentum", &mut products.momentum),
            ("inertia", inertia),
        ];
        for (name, vector) in vectors {
            visitor.vector(name, vector)?;
        }
        for (name, vector) in [("support", &mut products.support), ("damping", &mut products.damping)] {
            if let Some(vector) = vector {
                visitor.vector(name, vector)?;
            }
        }
        MaxwellTermState::visit(lags, visitor)?;
        let Impactor { position, velocity, acceleration } = &mut state.q;
        let numbers = [
            ("impactor.position", position),
            ("impactor.velocity", velocity),
            ("impactor.acceleration", acceleration),
            ("surface", surface),
            ("approach", approach),
            ("rate", rate),
            ("pads", pads),
        ];
        numbers.into_iter().try_for_each(|(name, number)| visitor.number(name, number))
    }

    /// Relative difference between aᵀu on a body that every rank has completely and the stored value, over the sum of
    /// its absolute terms.
    pub(super) fn misfit(&self, body: &Body) -> Result<f64> {
        let (a, u) = (body.terms.contact.force.read()?, self.state.u.read()?);
        let terms = || a.iter().zip(u.iter()).map(|(a, u)| a * u);
        let size: f64 = terms().map(f64::abs).sum();
        Ok(if size > 0.0 { (terms().sum::<f64>() - self.surface).abs() / size } else { 0.0 })
    }

    /// Overwrites this with another moment of the same body.
    pub(super) fn copy_from(&mut self, other: &Self) -> Result<()> {
        let (state, from) = (&mut self.state, &other.state);
        for (to, from) in [(&mut state.u, &from.u), (&mut state.v, &from.v), (&mut state.a, &from.a)] {
            to.copy_from(from)?;
        }
        state.q = from.q;
        let (products, from) = (&mut self.products, &other.products);
        products.elastic.copy_from(&from.elastic)?;
        products.momentum.copy_from(&from.momentum)?;
        for (to, from) in [(&mut products.support, &from.support), (&mut products.damping, &from.damping)] {
            if let (Some(to), Some(from)) = (to, from) {
                to.copy_from(from)?;
            }
        }
        for (to, from) in self.lags.iter_mut().zip(&other.lags) {
            to.copy_from(from)?;
        }
        self.inertia.copy_from(&other.inertia)?;
        (self.surface, self.approach, self.pads) = (other.surface, other.approach, other.pads);
        self.rate = other.rate;
        Ok(())
    }
}
