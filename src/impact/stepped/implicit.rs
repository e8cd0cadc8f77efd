//! One step of an implicit scheme: sets up its equation, solves it, and computes the state at the end of the step.

use petsc_wrap::{Comm, Int, Vector, VectorView};

use crate::body::{Body, Pads};
use crate::error::{Error, Result};
use crate::scene;
use crate::scheme::{Implicit, StageForce};

use super::condensed::Condensed;
use super::energy_balance::{Exchange, Work, exchange};
use super::full::Full;
use super::pad_condensed;
use super::relaxation::{Relaxed, Relaxing};
use super::state::{Impactor, Moment, State};
use super::step_sizes::Stepper;
use crate::impact::checkpoint::Visitor;
use crate::impact::parameters::ImpactParameters;

/// Rounding of the residual relative to its largest term. It can exceed the tolerance if a slow impactor hits a body
/// that is deformed or moving for other reasons.
const ROUNDING: f64 = 100.0 * f64::EPSILON;

/// Equations of a step, S E + p = g + a F and c2 m0 E_q = g_q − F, for the stage's increments E and E_q.
pub struct Problem<'a> {
    /// Displacement u_n at the start of the step.
    pub u: &'a Vector,
    /// Known part g of the body's equation, N.
    pub known: &'a Vector,
    /// Known part g_q of the impactor's equation, N.
    pub known_impactor: f64,
    /// Localisation vector a.
    pub direction: &'a Vector,
    /// Contact force F as a function of the approach at the stage.
    pub force: &'a StageForce,
    /// Pads, which exert the force p.
    pub pads: Option<&'a mut Pads>,
    /// Initial guess of E_q, m.
    pub guess: f64,
    /// Rounding of the residual, N.
    pub largest: f64,
}

/// Result of a solver, in addition to E.
pub struct Solved {
    /// Impactor's increment E_q, m.
    pub increment: f64,
    /// Contact force F, N.
    pub force: f64,
    /// Number of Newton iterations; in the condensed step, of the condensed equations.
    pub iterations: usize,
}

/// Solver of the equations for one step size.
enum Solver {
    Condensed(Box<Condensed>),
    Full(Box<Full>),
}

/// Solution method for the steps of a body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Method {
    /// Newton's method for all unknowns.
    Full,
    /// One linear solve and a scalar equation.
    Condensed,
    /// Two linear solves, and Newton's method for the unknowns on which pads act, given by their global numbers.
    CondensedOnPads(Vec<Int>),
}

impl Method {
    /// Returns the requested method; the full Newton's method replaces the condensed one if pads act on more than
    /// `pad_condensed::MOST_UNKNOWNS` unknowns, where it is cheaper. Collective.
    pub fn of(newton: scene::Newton, body: &Body) -> Self {
        let pushed = body.pads.as_ref().map(Pads::pushed).unwrap_or_default();
        match newton {
            scene::Newton::Condensed if pushed.is_empty() => Self::Condensed,
            scene::Newton::Condensed if pushed.len() <= pad_condensed::MOST_UNKNOWNS => Self::CondensedOnPads(pushed),
            _ => Self::Full,
        }
    }
}

/// An implicit scheme at one step size.
pub struct ImplicitStepper {
    scheme: Implicit,
    step: f64,
    solver: Solver,
    known: Vector,
    work: Vector,
    /// Pad forces p at the stage, if there are pads.
    pads: Option<Vector>,
    /// Viscoelastic parts, if there are any.
    relaxing: Option<Relaxing>,
    /// Product C D, where it does not follow from C u̇.
    damped: Vector,
    /// Whether K u and M u̇ may be updated from the previous step instead of being recomputed. This requires:
    /// - the condensed step without pads and with a direct solver, whose residual is rounding;
    /// - constrained unknowns that stay at zero and take no part in the translation, so that the reaction forces in
    ///   their equations do not contribute to the energies;
    /// - a scheme other than the midpoint rule, in which an error of K u changes sign from step to step and persists,
    ///   while the other schemes damp it;
    /// - no viscoelastic parts.
    may_follow: bool,
    /// Whether a step needs no iterations over all unknowns, which would start from a guess.
    is_direct: bool,
    /// Number of steps since K u was recomputed from u.
    followed: usize,
}

/// Number of steps after which K u and M u̇ are recomputed from u and u̇, so that rounding does not accumulate.
const FOLLOWED: usize = 100;

impl ImplicitStepper {
    /// Sets up the solver. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub(super) fn new(
        comm: &Comm,
        body: &Body,
        parameters: &ImpactParameters,
        (scheme, step): (Implicit, f64),
        (newton, tolerance): (scene::Newton, f64),
    ) -> Result<Self> {
        let stage = scheme.stage(step);
        let condensed = |pushed: Vec<Int>| {
            let condensed = Condensed::new(comm, body, (stage, step), parameters.mass, (pushed, tolerance))?;
            Ok::<_, Error>(Solver::Condensed(Box::new(condensed)))
        };
        let solver = match Method::of(newton, body) {
            Method::Condensed => condensed(Vec::new())?,
            Method::CondensedOnPads(pushed) => condensed(pushed)?,
            Method::Full => Solver::Full(Box::new(Full::new(comm, body, (stage, step), parameters.mass, tolerance)?)),
        };
        let zeros = || body.terms.load.duplicate();
        let pads = body.pads.as_ref().map(|_| zeros()).transpose()?;
        let is_quiet = body.clamps.displacement.norm_max()? == 0.0 && !body.is_translation_held()?;
        let is_direct = matches!(&solver, Solver::Condensed(condensed) if condensed.is_direct);
        let relaxing = Relaxing::new(body, step)?;
        let may_follow = is_quiet && is_direct && pads.is_none() && !scheme.gradient && relaxing.is_none();
        let (known, work, damped) = (zeros()?, zeros()?, zeros()?);
        Ok(Self { scheme, step, solver, known, work, pads, relaxing, damped, may_follow, is_direct, followed: 0 })
    }

    /// Computes the products at the end of a step from the products at its start. `known` contains g, `work` D, and F is
    /// the contact force. The solved equation S E = g + a F with E = θ D gives K D = (g + a F)/θ − c1 C D − c2 M D. Of
    /// the large matrices only M is applied, which couples no displacement components. It is applied to ü, because M ü
    /// carried on from step to step would accumulate a growing error.
    fn follow(
        &mut self,
        body: &Body,
        parameters: &ImpactParameters,
        (from, to): (&Moment, &mut Moment),
        force: f64,
    ) -> Result<()> {
        let (stage, end, theta) = (self.scheme.stage(self.step), self.scheme.end(self.step), self.scheme.theta());
        let (before, after) = (&from.products, &mut to.products);
        body.apply_mass(&to.state.a, &mut to.inertia)?;
        body.clamps.zero(&mut to.inertia)?;
        after.update_of_surface(body, &to.state)?;
        // M D from ü = c2 D + a[0] u̇_n + a[1] ü_n.
        let factor = 1.0 / end.c2;
        let of_mass: [(f64, &VectorView); 3] =
            [(factor, &to.inertia), (-end.a[0] * factor, &before.momentum), (-end.a[1] * factor, &from.inertia)];
        let mut terms: Vec<(f64, &VectorView)> =
            vec![(1.0, &before.elastic), (1.0 / theta, &self.known), (force / theta, &body.terms.contact.force)];
        terms.extend(of_mass.map(|(factor, term)| (-stage.c2 * factor, term)));
        if let (Some(before), Some(after)) = (&before.support, &after.support) {
            terms.extend([(1.0, &**before), (-1.0, after)]);
        }
        if let (Some(matrix), Some(before), Some(after)) = (&body.terms.damping, &before.damping, &after.damping) {
            if end.v[1] == 0.0 {
                // C D from u̇ = c1 D + v[0] u̇_n.
                let factor = stage.c1 / end.c1;
                terms.extend([(-factor, &**after), (factor * end.v[0], before)]);
            } else {
                matrix.mult(&self.work, &mut self.damped)?;
                terms.push((-stage.c1, &self.damped));
            }
        }
        after.elastic.set_combination(&terms)?;
        body.clamps.zero(&mut after.elastic)?;
        let ratio = end.c1 / end.c2;
        let of_old = [0, 1].map(|i| end.v[i] - ratio * end.a[i]);
        after.momentum.set_combination(&[
            (ratio, &to.inertia),
            (of_old[0], &before.momentum),
            (of_old[1], &from.inertia),
        ])?;
        to.place(body, parameters.gap)
    }

    /// Computes u, u̇ and ü at the end of a step from D in `work`.
    fn end(&self, from: &Moment, to: &mut State, impactor: f64) -> Result<()> {
        let (state, end) = (&from.state, self.scheme.end(self.step));
        to.u.set_combination(&[(1.0, &state.u), (1.0, &self.work)])?;
        for (out, (c, [of_v, of_a])) in [(&mut to.v, (end.c1, end.v)), (&mut to.a, (end.c2, end.a))] {
            out.set_combination(&[(of_v, &*state.v), (of_a, &state.a), (c, &self.work)])?;
        }
        let (velocity, acceleration) = end.apply(impactor, state.q.velocity, state.q.acceleration);
        to.q = Impactor { position: state.q.position + impactor, velocity, acceleration };
        Ok(())
    }
}

impl Stepper for ImplicitStepper {
    fn advance(
        &mut self,
        body: &mut Body,
        parameters: &ImpactParameters,
        from: &Moment,
        to: &mut Moment,
    ) -> Result<(Exchange, usize)> {
        let (scheme, step, theta) = (self.scheme, self.step, self.scheme.theta());
        let stage = scheme.stage(step);
        let (state, products) = (&from.state, &from.products);
        // g = f − K u_n − M a* − C v*, where a* and v* are the stage's acceleration and velocity for E = 0.
        let known = &mut self.known;
        let mut terms: Vec<(f64, &VectorView)> =
            vec![(1.0, &body.terms.load), (1.0, &body.terms.support_load), (-1.0, &products.elastic)];
        terms.extend(products.support.iter().map(|support| (-1.0, &**support)));
        terms.extend([(-stage.a[0], &*products.momentum), (-stage.a[1], &from.inertia)]);
        if let (Some(matrix), Some(damping)) = (&body.terms.damping, &products.damping) {
            terms.push((-stage.v[0], damping));
            if stage.v[1] != 0.0 {
                matrix.mult(&state.a, &mut self.work)?;
                terms.push((-stage.v[1], &self.work));
            }
        }
        known.set_combination(&terms)?;
        if let Some(relaxing) = &self.relaxing {
            relaxing.add_lost(&from.lags, theta, known)?;
        }
        body.clamps.zero(known)?;
        let q = state.q;
        let known_impactor = parameters.weight - parameters.mass * stage.apply(0.0, q.velocity, q.acceleration).1;
        let rate = match parameters.law.damping {
            0.0 => [0.0; 2],
            _ => [stage.v[0] * from.rate + stage.v[1] * from.acceleration(body)?, stage.c1],
        };
        let force =
            StageForce { law: parameters.law.clone(), from: from.approach, theta, gradient: scheme.gradient, rate };
        let Body { terms: of_body, pads, .. } = &mut *body;
        let increment = &mut self.work;
        let mut largest = 0.0_f64;
        if pads.is_some() || matches!(self.solver, Solver::Full(_)) {
            let terms = [(1.0, &products.elastic), (stage.a[0], &products.momentum), (stage.a[1], &from.inertia)];
            for (factor, term) in terms {
                largest = largest.max(ROUNDING * factor.abs() * term.norm()?);
            }
        }
        let mut problem = Problem {
            u: &state.u,
            known,
            known_impactor,
            direction: &of_body.contact.force,
            force: &force,
            pads: pads.as_mut(),
            guess: 0.0,
            largest,
        };
        if !self.is_direct {
            // Iterations start from the increment at constant acceleration.
            let (first, second) = (theta * step, 0.5 * theta * theta * step * step);
            increment.set_combination(&[(first, &state.v), (second, &state.a)])?;
            problem.guess = first * q.velocity + second * q.acceleration;
        }
        let solved = match &mut self.solver {
            Solver::Condensed(condensed) => condensed.solve(&problem, increment)?,
            Solver::Full(full) => full.solve(problem, increment).map_err(|error| full.describe(error))?,
        };
        self.followed = if self.may_follow { (self.followed + 1) % FOLLOWED } else { 0 };
        let follows = self.followed > 0;
        self.work.scale(1.0 / theta)?;
        let impactor = solved.increment / theta;
        self.end(from, &mut to.state, impactor)?;
        let relaxed = match &mut self.relaxing {
            Some(relaxing) => relaxing.advance(body, &self.work, &from.lags, &mut to.lags)?,
            None => Relaxed::default(),
        };
        if let (Some(pads), Some(force)) = (&mut body.pads, &mut self.pads) {
            force.fill(0.0)?;
            if scheme.gradient {
                pads.add_force(Some(&state.u), &to.state.u, force)?;
            } else {
                // The known part is not needed any more and serves as work space.
                self.known.copy_from(&state.u)?;
                self.known.axpy(theta, &self.work)?;
                pads.add_force(None, &self.known, force)?;
            }
        }
        if follows {
            self.follow(body, parameters, (from, to), solved.force)?;
        } else {
            to.update(body, parameters.gap)?;
            body.apply_mass(&to.state.a, &mut to.inertia)?;
            body.clamps.zero(&mut to.inertia)?;
        }
        let damping = match parameters.law.damping {
            0.0 => 0.0,
            _ => solved.force - force.elastic(from.approach + theta * (to.approach - from.approach)).0,
        };
        let work = Work { increment: &self.work, force: solved.force, damping, relaxed, pads: self.pads.as_ref() };
        let exchange = exchange(body, parameters, (&scheme, step), (from, to), work, &mut self.known)?;
        Ok((exchange, solved.iterations))
    }

    /// The factors kept by the full Newton's method and by the pads are not saved; the solution is reproduced within
    /// the tolerance.
    fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        visitor.count("followed", &mut self.followed)
    }
}
