//! Step doubling: a fine trajectory, a coarse one in steps of double size, and their difference.

use petsc_wrap::Vector;

use crate::body::Body;
use crate::error::Result;

use super::trajectory::Trajectory;
use crate::impact::checkpoint::Visitor;
use crate::impact::observer::Observed;
use crate::impact::parameters::ImpactParameters;

/// The fine and the coarse trajectory, and their difference.
pub struct StepDoubling {
    /// Trajectory whose steps the observer receives.
    pub fine: Trajectory,
    /// Trajectory in steps of double size.
    pub coarse: Trajectory,
    /// Time up to which the smallest steps are taken, after a larger step led into contact, s.
    pub careful: f64,
    /// Whether the fine trajectory has been in contact in the last two steps.
    pub has_touched: bool,
    /// Largest acceleration so far, and largest difference of the two accelerations so far, m/s².
    pub peak: f64,
    difference: f64,
    /// Range so far (lowest, highest) of aᵀu without the rigid-body motion of an unsupported body, m.
    pub surface: [f64; 2],
    /// Vector whose product with u is this rigid-body motion along the direction of travel; `None` for a supported
    /// body.
    mean: Option<Vector>,
}

impl StepDoubling {
    pub(super) fn new(body: &mut Body, parameters: &ImpactParameters) -> Result<Self> {
        let [fine, coarse] = [Trajectory::new(body, parameters)?, Trajectory::new(body, parameters)?];
        let mean = if body.is_free()? { Some(mean_displacement(body)?) } else { None };
        Ok(Self { fine, coarse, careful: 0.0, has_touched: false, peak: 0.0, difference: 0.0, surface: [0.0; 2], mean })
    }

    pub(super) fn copy_from(&mut self, other: &Self) -> Result<()> {
        self.fine.copy_from(&other.fine)?;
        self.coarse.copy_from(&other.coarse)
    }

    /// Saves both trajectories and their difference to a checkpoint or restores them.
    pub(super) fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        visitor.within("fine", |visitor| self.fine.visit(visitor))?;
        visitor.within("coarse", |visitor| self.coarse.visit(visitor))?;
        let [low, high] = &mut self.surface;
        let numbers = [
            ("peak", &mut self.peak),
            ("difference", &mut self.difference),
            ("lowest", low),
            ("highest", high),
            ("careful", &mut self.careful),
        ];
        numbers.into_iter().try_for_each(|(name, number)| visitor.number(name, number))
    }

    pub(super) fn is_touching(&self) -> bool {
        self.fine.now.approach.max(self.coarse.now.approach) >= 0.0
    }

    /// Updates the peak and the difference of the two trajectories after the steps `told`. Collective.
    pub(super) fn compare(&mut self, parameters: &ImpactParameters, told: &[Observed]) -> Result<()> {
        for Observed { step, .. } in told {
            self.peak = self.peak.max(step.impactor.acceleration);
        }
        let now = &self.fine.now;
        let whole = self.mean.as_ref().map_or(Ok(0.0), |mean| mean.dot(&now.state.u))?;
        let surface = now.surface - whole;
        self.surface = [self.surface[0].min(surface), self.surface[1].max(surface)];
        let difference = self.fine.acceleration(parameters) - self.coarse.acceleration(parameters);
        self.difference = self.difference.max(difference.abs());
        Ok(())
    }

    /// Largest difference of the two accelerations over the peak; `None` before there is a peak.
    pub(super) fn difference(&self) -> Option<f64> {
        (self.peak > 0.0).then(|| self.difference / self.peak)
    }
}

/// Returns M t / tᵀM t for the translation t; its product with u is the mean displacement of the body along t.
/// Collective.
fn mean_displacement(body: &Body) -> Result<Vector> {
    let mut mean = body.terms.load.duplicate()?;
    body.apply_mass(&body.terms.translation, &mut mean)?;
    let moved = mean.dot(&body.terms.translation)?;
    mean.scale(1.0 / moved)?;
    Ok(mean)
}
