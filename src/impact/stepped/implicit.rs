//! One step of an implicit scheme: its equation set up, solved, and the state at its end.

use petsc_wrap::{Comm, Int, Vector};

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
use crate::impact::checkpoint::Visitor;
use crate::impact::parameters::ImpactParameters;

/// What rounding leaves of the residual, as a part of its largest term: more than the tolerance where a slow impactor
/// meets a body that is bent or moves for other reasons.
const ROUNDING: f64 = 100.0 * f64::EPSILON;

/// A step's equations S E + p = g + a F, c2 m0 E_q = g_q − F for the stage's increments E and E_q.
pub struct Problem<'a> {
    /// u_n.
    pub u: &'a Vector,
    /// g, N.
    pub known: &'a Vector,
    /// g_q, N.
    pub known_impactor: f64,
    /// a.
    pub direction: &'a Vector,
    /// F at the stage.
    pub force: &'a StageForce,
    /// p.
    pub pads: Option<&'a mut Pads>,
    /// Where to start, m.
    pub guess: f64,
    /// What rounding leaves of the residual, N.
    pub largest: f64,
}

/// What a solver returns beside E.
pub struct Solved {
    /// E_q, m.
    pub increment: f64,
    /// F, N.
    pub force: f64,
    /// Newton iterations, of the condensed equations in the condensed step.
    pub iterations: usize,
}

/// Who solves the equations of one step size.
enum Solver {
    Condensed(Box<Condensed>),
    Full(Box<Full>),
}

/// How a body's steps are solved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Method {
    /// All unknowns by Newton's method.
    Full,
    /// One solve and a scalar equation.
    Condensed,
    /// Two solves, and Newton's method on these unknowns, which pads push: their global numbers.
    CondensedOnPads(Vec<Int>),
}

impl Method {
    /// What is asked for, but for pads of so many unknowns that the full Newton's method is cheaper. Collective.
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
    /// p at the stage, where there are pads.
    pads: Option<Vector>,
    /// The relaxing parts, where there are any.
    relaxing: Option<Relaxing>,
    /// M D; before, C E.
    weighed: Vector,
    /// Whether products may follow from those of the last moment: in the condensed step without pads, of a direct solver, whose residual is
    /// rounding; where held unknowns, in whose equations there are other forces, stay at zero and are none of the translation's, so that
    /// those forces are in no energy; and not in the midpoint rule, in which an error of K u changes its sign from step to step and stays,
    /// where other schemes damp it; and not where forces relax.
    may_follow: bool,
    /// Whether a step has no iterations over all unknowns, which start from a guess.
    is_direct: bool,
    /// Steps since K u was made of u.
    followed: usize,
}

/// Steps after which K u and M u̇ are made anew of u and u̇, lest rounding pile up in them.
const FOLLOWED: usize = 100;

impl ImplicitStepper {
    /// Sets up the solver. Collective.
    ///
    /// # Errors
    /// PETSc's.
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
        let zeros = || body.load.duplicate();
        let pads = body.pads.as_ref().map(|_| zeros()).transpose()?;
        let is_quiet = body.clamps.displacement.norm_max()? == 0.0 && !body.is_translation_held()?;
        let is_direct = matches!(&solver, Solver::Condensed(condensed) if condensed.is_direct);
        let relaxing = Relaxing::new(body, step)?;
        let may_follow = is_quiet && is_direct && pads.is_none() && !scheme.gradient && relaxing.is_none();
        let (known, work, weighed) = (zeros()?, zeros()?, zeros()?);
        Ok(Self { scheme, step, solver, known, work, pads, relaxing, weighed, may_follow, is_direct, followed: 0 })
    }

    /// What it remembers of the steps before, to a checkpoint or from it. (What the full Newton's method and
    /// that of pads keep of their factors is not carried: they go on within their tolerance.)
    pub(super) fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        visitor.count("followed", &mut self.followed)
    }

    /// Takes a step: writes the state at its end, and what was exchanged over it. Returns the Newton iterations. Collective.
    pub(super) fn advance(
        &mut self,
        body: &mut Body,
        parameters: &ImpactParameters,
        from: &Moment,
        to: &mut Moment,
    ) -> Result<(Exchange, usize)> {
        let (scheme, step, theta) = (self.scheme, self.step, self.scheme.theta());
        let stage = scheme.stage(step);
        let (state, products) = (&from.state, &from.products);
        // g = f − K u_n − M a* − C v*, with a* and v* what the stage has of them for E = 0.
        let known = &mut self.known;
        known.copy_from(&body.load)?;
        known.axpy(1.0, &body.support_load)?;
        known.axpy(-1.0, &products.elastic)?;
        if let Some(support) = &products.support {
            known.axpy(-1.0, support)?;
        }
        if let Some(relaxing) = &self.relaxing {
            relaxing.add_lost(&from.lags, theta, known)?;
        }
        known.axpy(-stage.a[0], &products.momentum)?;
        known.axpy(-stage.a[1], &from.inertia)?;
        if let (Some(matrix), Some(damping)) = (&body.damping, &products.damping) {
            known.axpy(-stage.v[0], damping)?;
            if stage.v[1] != 0.0 {
                matrix.mult(&state.a, &mut self.work)?;
                known.axpy(-stage.v[1], &self.work)?;
            }
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
        let Body { localization, pads, .. } = &mut *body;
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
            direction: &localization.vector,
            force: &force,
            pads: pads.as_mut(),
            guess: 0.0,
            largest,
        };
        if !self.is_direct {
            // Iterations start from the increment at constant acceleration.
            let (first, second) = (theta * step, 0.5 * theta * theta * step * step);
            increment.copy_from(&state.v)?;
            increment.scale(first)?;
            increment.axpy(second, &state.a)?;
            problem.guess = first * q.velocity + second * q.acceleration;
        }
        let solved = match &mut self.solver {
            Solver::Condensed(condensed) => condensed.solve(&problem, increment)?,
            Solver::Full(full) => full.solve(problem, increment).map_err(|error| full.describe(error))?,
        };
        self.followed = if self.may_follow { (self.followed + 1) % FOLLOWED } else { 0 };
        let follows = self.followed > 0;
        if follows {
            // K E by the equation just solved, S E = g + a F, but for c2 M E.
            self.known.axpy(solved.force, &body.localization.vector)?;
            if let Some(damping) = &body.damping {
                damping.mult(&self.work, &mut self.weighed)?;
                self.known.axpy(-stage.c1, &self.weighed)?;
            }
            self.known.scale(1.0 / theta)?;
        }
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
                // The known part has served.
                self.known.copy_from(&state.u)?;
                self.known.axpy(theta, &self.work)?;
                pads.add_force(None, &self.known, force)?;
            }
        }
        if follows {
            self.follow(body, parameters, (from, to))?;
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

    /// The products at the end of a step from those at its start, K D + c2 M D in `known`: M alone, which couples no components, is applied.
    /// To ü, since M ü carried on from step to step would have a life of its own, which grows.
    fn follow(&mut self, body: &Body, parameters: &ImpactParameters, (from, to): (&Moment, &mut Moment)) -> Result<()> {
        let (stage, end) = (self.scheme.stage(self.step), self.scheme.end(self.step));
        let (momentum, [of_v, of_a]) = (&from.products.momentum, end.a);
        body.apply_mass(&to.state.a, &mut to.inertia)?;
        // M D from ü = c2 D + of_v u̇_n + of_a ü_n.
        self.weighed.copy_from(&to.inertia)?;
        self.weighed.axpy(-of_v, momentum)?;
        self.weighed.axpy(-of_a, &from.inertia)?;
        self.weighed.scale(1.0 / end.c2)?;
        self.known.axpy(-stage.c2, &self.weighed)?;
        body.clamps.zero(&mut self.known)?;
        body.clamps.zero(&mut to.inertia)?;
        to.place(body, parameters.gap)?;
        to.products.follow(body, &from.products, &to.state, &self.known)?;
        let out = &mut to.products.momentum;
        out.copy_from(momentum)?;
        out.scale(end.v[0])?;
        out.axpy(end.v[1], &from.inertia)?;
        Ok(out.axpy(end.c1, &self.weighed)?)
    }

    /// u, u̇ and ü at the end of a step, from D in `work`.
    fn end(&self, from: &Moment, to: &mut State, impactor: f64) -> Result<()> {
        let (state, end) = (&from.state, self.scheme.end(self.step));
        to.u.copy_from(&state.u)?;
        to.u.axpy(1.0, &self.work)?;
        for (out, (c, [of_v, of_a])) in [(&mut to.v, (end.c1, end.v)), (&mut to.a, (end.c2, end.a))] {
            out.copy_from(&state.v)?;
            out.scale(of_v)?;
            out.axpy(of_a, &state.a)?;
            out.axpy(c, &self.work)?;
        }
        let (velocity, acceleration) = end.apply(impactor, state.q.velocity, state.q.acceleration);
        to.q = Impactor { position: state.q.position + impactor, velocity, acceleration };
        Ok(())
    }
}
