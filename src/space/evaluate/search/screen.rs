//! Selection of the steps at which the largest tension of all steps may occur, by a coarse search of some steps at some
//! points.
//!
//! Steps are short because of the contact force, which varies faster in time than the body. Points are closer than the
//! wavelengths, except near the impact point. So the tensions are first evaluated on every other line of a face, at every
//! few steps and at the peaks of the contact force. All points are then searched only in the steps between two
//! such steps, if one of these is near the highest tension.

use super::local::LocalRows;
use super::rows::StressRows;
use super::seen::{Seen, Wanted};
use super::{BLOCK, ContactNow, Coordinates};
use crate::space::evaluate::Face;

/// Interval of steps at which tensions are evaluated where they are high. Where they are low it is twice as long.
const STRIDE: usize = 4;

/// Assumed upper limit of the ratio of a tension to the tensions at the neighbouring steps and points. An estimate.
const BETWEEN: f64 = 1.2;

/// The same for intervals twice as long: a sine that falls by a factor of 1.2 within two steps of its maximum falls by 2.6
/// within four.
const BETWEEN_COARSE: f64 = 2.6;

/// Smallest number of steps for which the selection saves time.
const MANY: usize = 64;

/// Subset of the points of faces with which steps are selected: all points with the local field, and the other points
/// on every other line.
pub struct Screen {
    faces: Vec<Face>,
    local: Vec<LocalRows>,
    rows: StressRows,
}

impl Screen {
    /// Screen of faces with grids. `rows` are the stresses at all sampled points for a unit value of each of `count`
    /// coordinates, a row for each component. `None` for other faces.
    pub fn new(faces: &[Face], count: usize, rows: &[f64]) -> Option<Self> {
        let (mut few, mut chosen): (Vec<Face>, Vec<f64>) = (Vec::new(), Vec::new());
        for (number, face) in faces.iter().enumerate() {
            let points = points(face)?;
            // Faces that share their stresses also share the selected points.
            let alike = faces[..number].iter().position(|other| other.first == face.first);
            let mut chosen_from = |first: usize| {
                let place = chosen.len() / (3 * count);
                let of_point = |point: &usize| &rows[3 * (first + point) * count..3 * (first + point + 1) * count];
                chosen.extend(points.iter().flat_map(of_point));
                place
            };
            let (first, across) = match alike {
                Some(other) => (few[other].first, few[other].across),
                None => (chosen_from(face.first), face.across.map(&mut chosen_from)),
            };
            let local = |(place, point): (usize, &usize)| {
                let at = face.local.binary_search_by_key(point, |(of, _)| *of).ok()?;
                Some((place, face.local[at].1.clone()))
            };
            few.push(Face {
                name: face.name.clone(),
                points: points.iter().map(|point| face.points[*point]).collect(),
                first,
                across,
                local: points.iter().enumerate().filter_map(local).collect(),
                left_out: points.iter().map(|point| face.left_out[*point]).collect(),
                sign: face.sign,
                grid: face.grid.clone(),
            });
        }
        let local = few.iter().map(LocalRows::new).collect::<Option<_>>()?;
        Some(Self { faces: few, local, rows: StressRows::new(count, chosen) })
    }

    /// Steps whose largest tension may be the largest of all, or at least `least`, Pa. `None` if searching all steps is
    /// as fast.
    pub(super) fn steps(&self, coordinates: Coordinates, contacts: &[ContactNow], least: f64) -> Option<Vec<usize>> {
        if contacts.len() < MANY {
            return None;
        }
        let last = contacts.len() - 1;
        let is_peak_of_force = |step: usize| {
            let [before, now, after] = [step.saturating_sub(1), step, last.min(step + 1)].map(|at| contacts[at].force);
            now > 0.0 && now >= before && now >= after
        };
        let is_coarse = |step: &usize| step.is_multiple_of(2 * STRIDE) || *step == last || is_peak_of_force(*step);
        let coarse: Vec<usize> = (0..=last).filter(is_coarse).collect();
        let mut evaluated = self.largest_tensions(&coarse, coordinates, contacts)?;
        let high = intervals(&evaluated, level(&evaluated, least) / BETWEEN_COARSE)
            .filter(|ends| ends[1].step - ends[0].step > STRIDE);
        let middles: Vec<usize> = high.map(|ends| ends[0].step + STRIDE).collect();
        evaluated.extend(self.largest_tensions(&middles, coordinates, contacts)?);
        evaluated.sort_unstable_by_key(|of_step| of_step.step);
        let mut high: Vec<usize> = intervals(&evaluated, level(&evaluated, least) / BETWEEN)
            .flat_map(|ends| ends[0].step..=ends[1].step)
            .collect();
        high.dedup();
        let points = self.rows.points();
        tracing::debug!(
            steps = contacts.len(),
            coordinates = self.rows.count,
            points,
            searched = high.len(),
            "tensions"
        );
        Some(high)
    }

    /// Largest tension at each of some steps; `None` if one of them is not finite.
    fn largest_tensions(
        &self,
        steps: &[usize],
        coordinates: Coordinates,
        contacts: &[ContactNow],
    ) -> Option<Vec<StepTension>> {
        let count = self.rows.count;
        let of_steps = coordinates.of(steps, count);
        let (mut seen, mut tensions) = (Seen::default(), Vec::with_capacity(steps.len()));
        let mut columns = Vec::new();
        for (steps, coordinates) in steps.chunks(BLOCK).zip(of_steps.chunks(BLOCK * count)) {
            let sizes = self.rows.of_steps(coordinates, &mut columns);
            for ((&step, size), column) in steps.iter().zip(sizes).zip(columns.chunks_exact(3 * self.rows.points())) {
                seen.take(column);
                let faces = self.faces.iter().zip(&self.local).map(|(face, local)| {
                    seen.look((face, local), (column, size), &contacts[step], Wanted::Largest);
                    f64::from(seen.top) * size
                });
                // If the size is zero, as at rest, single precision gives no information.
                let top = faces.fold(f64::NEG_INFINITY, f64::max);
                tensions.push(StepTension { step, tension: if size > f64::MIN_POSITIVE { top } else { 0.0 } });
            }
        }
        tensions.iter().all(|of_step| of_step.tension.is_finite()).then_some(tensions)
    }
}

/// Largest tension at a step, Pa.
struct StepTension {
    step: usize,
    tension: f64,
}

/// Smallest tension of interest: the largest one found so far, or `least` if that is lower, Pa.
fn level(tensions: &[StepTension], least: f64) -> f64 {
    tensions.iter().map(|of_step| of_step.tension).fold(0.0, f64::max).min(least)
}

/// Intervals between consecutive evaluated steps with at least the tension `level` (Pa) at one end.
fn intervals(tensions: &[StepTension], level: f64) -> impl Iterator<Item = &[StepTension]> {
    tensions.windows(2).filter(move |ends| ends[0].tension.max(ends[1].tension) >= level)
}

/// Numbers of the selected points of a face, ascending.
fn points(face: &Face) -> Option<Vec<usize>> {
    let [lines, count] = face.grid.as_ref()?.lines.each_ref().map(Vec::len);
    let is_among = |line: usize, lines: usize| line.is_multiple_of(2) || line + 1 == lines;
    let is_near = |point: usize| face.local.binary_search_by_key(&point, |(of, _)| *of).is_ok();
    let is_chosen =
        |point: &usize| is_near(*point) || (is_among(point / count, lines) && is_among(point % count, count));
    Some((0..face.points.len()).filter(is_chosen).collect())
}
