//! A trajectory and its twin at double steps, and how the two differ.

use petsc_wrap::Vector;

use crate::body::Body;
use crate::error::Result;

use super::trajectory::Trajectory;
use crate::impact::checkpoint::Visitor;
use crate::impact::observer::Observed;
use crate::impact::parameters::ImpactParameters;

/// The fine and the coarse trajectory, and how they differ.
pub struct StepDoubling {
    /// The one that is told.
    pub fine: Trajectory,
    /// Its twin.
    pub coarse: Trajectory,
    /// Whether the fine one has been in contact over the last two steps.
    pub has_touched: bool,
    /// Largest acceleration and largest difference of the two so far, m/s².
    pub peak: f64,
    difference: f64,
    /// Range so far of aᵀu, less the motion of a free body as a whole, m.
    pub surface: [f64; 2],
    /// What gives that motion of a free body from u, along the direction of travel.
    mean: Option<Vector>,
}

impl StepDoubling {
    pub(super) fn new(body: &mut Body, parameters: &ImpactParameters) -> Result<Self> {
        let [fine, coarse] = [Trajectory::new(body, parameters)?, Trajectory::new(body, parameters)?];
        let mean = if body.is_free()? { Some(mean_displacement(body)?) } else { None };
        Ok(Self { fine, coarse, has_touched: false, peak: 0.0, difference: 0.0, surface: [0.0; 2], mean })
    }

    pub(super) fn copy_from(&mut self, other: &Self) -> Result<()> {
        self.fine.copy_from(&other.fine)?;
        self.coarse.copy_from(&other.coarse)
    }

    /// To a checkpoint or from it.
    pub(super) fn visit(&mut self, visitor: &mut Visitor) -> Result<()> {
        visitor.within("fine", |visitor| self.fine.visit(visitor))?;
        visitor.within("coarse", |visitor| self.coarse.visit(visitor))?;
        let [low, high] = &mut self.surface;
        let numbers =
            [("peak", &mut self.peak), ("difference", &mut self.difference), ("lowest", low), ("highest", high)];
        numbers.into_iter().try_for_each(|(name, number)| visitor.number(name, number))
    }

    pub(super) fn is_touching(&self) -> bool {
        self.fine.now.approach.max(self.coarse.now.approach) >= 0.0
    }

    /// Takes what the steps told and how the two differ after them. Collective.
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

    /// Largest difference of the two accelerations over the peak, once there is a peak.
    pub(super) fn difference(&self) -> Option<f64> {
        (self.peak > 0.0).then(|| self.difference / self.peak)
    }
}

/// M t / tᵀM t for the translation t: the mean displacement of a body along it. Collective.
fn mean_displacement(body: &Body) -> Result<Vector> {
    let mut mean = body.load.duplicate()?;
    body.apply_mass(&body.translation, &mut mean)?;
    let moved = mean.dot(&body.translation)?;
    mean.scale(1.0 / moved)?;
    Ok(mean)
}
