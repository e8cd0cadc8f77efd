//! Search for the largest tensions of many steps on the faces of a body with few coordinates.
//!
//! The stresses at all sampled points are linear in the coordinates: a matrix with a row for each stress ([`FaceStresses`])
//! or, on lines of a face, a product of fewer coefficients ([`LineStresses`]). They are computed for a block of steps at
//! once. Near the impact point the local field is added ([`LocalRows`]).
//!
//! If only the largest tension of all steps is needed, as in sweeps, all points are first searched at every few steps and
//! at the peaks of the contact force, and then in the steps between two of these, if one of them is near the highest
//! tension. (Steps are short because of the contact force, which varies faster in time than the body.)

mod coordinates;
mod local;

use std::borrow::Cow;

use super::faces::ALIKE;
use super::line_stress::Together;
use super::map::products_of_steps;
use super::{ContactNow, Face, FaceStresses, FaceTension, LineStresses, TensionMap};
pub use coordinates::Coordinates;
use local::{LocalRows, ceiling_of, parts, principal_of};

/// Number of steps whose stresses are computed at once.
pub const STEPS_TOGETHER: usize = 32;

/// Interval of the steps that are searched first, if only the largest tension of all steps is needed.
const STRIDE: usize = 4;

/// Assumed upper limit of the ratio of a tension to those at the steps searched first, before and after it. Such steps are two
/// away at most; a sine that falls by this factor within two steps has a period of 21 steps.
const BETWEEN: f64 = 1.2;

/// Smallest number of steps of which some are searched first.
const MANY: usize = 64;

/// Search on all faces of a box.
pub struct TensionSearch<'a> {
    faces: &'a FaceStresses,
    /// Local fields at points near the impact point, face by face.
    local: Vec<LocalRows>,
    stresses: Stresses<'a>,
}

/// Source of the stresses a, b and ab at the sampled points.
enum Stresses<'a> {
    /// A row for each stress of each point, with an entry for each of `count` coordinates.
    Rows {
        count: usize,
        rows: Cow<'a, [f64]>,
    },
    Lines(&'a LineStresses),
}

/// Result of a search.
pub struct Searched {
    /// Largest tension on each face, step by step; unknown at steps that were not searched.
    pub steps: Vec<Vec<FaceTension>>,
    /// Largest tensions over the steps, for each face; empty if only the largest of all steps was searched.
    peaks: Vec<Peaks>,
}

/// Largest tension at each point of a face over the steps so far, in single precision.
struct Peaks {
    /// Tension, Pa.
    tension: Vec<f32>,
    /// Number of the step of each tension.
    steps: Vec<u32>,
}

impl Peaks {
    /// Includes the tension at one point, Pa.
    fn raise(&mut self, point: usize, tension: f64, step: usize) {
        if tension as f32 > self.tension[point] {
            (self.tension[point], self.steps[point]) = (tension as f32, step as u32);
        }
    }
}

impl Searched {
    /// Largest tension over all steps at each point; empty if only the largest of all steps was searched. `times` are
    /// the times of the steps, s.
    pub fn map(&self, times: &[f64]) -> TensionMap {
        let (mut tension, mut time) = (Vec::new(), Vec::new());
        for peaks in &self.peaks {
            tension.extend_from_slice(&peaks.tension);
            time.extend(peaks.steps.iter().map(|step| times[*step as usize]));
        }
        TensionMap::of_steps(tension, time)
    }
}

impl<'a> TensionSearch<'a> {
    /// Search with rows of stresses at the sampled points for a unit value of each of `count` coordinates; each point
    /// has a row for each of a, b and ab. `None` unless the body is a box.
    pub fn new(faces: &'a FaceStresses, count: usize, rows: impl Into<Cow<'a, [f64]>>) -> Option<Self> {
        if faces.map.components() != 3 || count == 0 {
            return None;
        }
        Self::of(faces, Stresses::Rows { count, rows: rows.into() })
    }

    /// Search in the reduced coordinates of a body. `None` as for [`Self::new`], or if the map of the faces is not dense.
    pub fn on_basis(faces: &'a FaceStresses) -> Option<Self> {
        let (count, rows) = faces.dense()?;
        Self::new(faces, count, rows)
    }

    /// Search with stresses on lines; `None` as for [`Self::new`].
    pub fn on_lines(faces: &'a FaceStresses, lines: &'a LineStresses) -> Option<Self> {
        Self::of(faces, Stresses::Lines(lines))
    }

    fn of(faces: &'a FaceStresses, stresses: Stresses<'a>) -> Option<Self> {
        let local = faces.faces.iter().map(LocalRows::new).collect::<Option<Vec<_>>>()?;
        Some(Self { faces, local, stresses })
    }

    /// Number of coordinates of a step.
    fn count(&self) -> usize {
        match &self.stresses {
            Stresses::Rows { count, .. } => *count,
            Stresses::Lines(lines) => lines.coordinates(),
        }
    }

    /// Largest tension on each face at some steps, given their coordinates and contacts. `least` is given if only the
    /// largest tension of all steps is needed: steps at which tensions are clearly below both the largest one and `least`
    /// (Pa) may be left out.
    pub fn tensions<'c>(
        &self,
        coordinates: impl Into<Coordinates<'c>>,
        contacts: &[ContactNow],
        least: Option<f64>,
    ) -> Searched {
        let coordinates = coordinates.into();
        let faces = self.faces.faces.iter().filter(|_| least.is_none());
        let peaks = faces.map(|face| {
            let count = face.points.len();
            Peaks { tension: vec![f32::NEG_INFINITY; count], steps: vec![0; count] }
        });
        let unknown = vec![FaceTension::UNKNOWN; self.faces.faces.len()];
        let mut found = Searched { steps: vec![unknown; contacts.len()], peaks: peaks.collect() };
        match least.filter(|_| contacts.len() >= MANY) {
            None => self.search(&(0..contacts.len()).collect::<Vec<_>>(), coordinates, contacts, &mut found),
            Some(least) => {
                let first = first_steps(contacts);
                self.search(&first, coordinates, contacts, &mut found);
                let high = steps_between(&first, &found.steps, least);
                self.search(&high, coordinates, contacts, &mut found);
                tracing::debug!(steps = contacts.len(), searched = first.len() + high.len(), "tensions");
            }
        }
        found
    }

    /// Searches all points at some steps.
    fn search(&self, steps: &[usize], coordinates: Coordinates, contacts: &[ContactNow], found: &mut Searched) {
        let (count, mut stresses) = (self.count(), Vec::new());
        let sampled = match &self.stresses {
            Stresses::Rows { count, rows } => rows.len() / count,
            Stresses::Lines(lines) => 3 * lines.crossings(),
        };
        for steps in steps.chunks(STEPS_TOGETHER) {
            let coordinates = coordinates.of(steps, count);
            match &self.stresses {
                Stresses::Rows { rows, .. } => stresses = products_of_steps(rows, count, &coordinates),
                Stresses::Lines(lines) => {
                    stresses.resize(sampled * steps.len(), 0.0);
                    let mut columns = stresses.chunks_exact_mut(sampled);
                    lines.each(&coordinates, |together| {
                        let all = together.stresses();
                        let of_step = |column: &mut [f64], step: usize| {
                            let values = all.iter().flatten().map(|together: &Together| together[step]);
                            column.iter_mut().zip(values).for_each(|(to, value)| *to = value);
                        };
                        (0..together.steps()).zip(&mut columns).for_each(|(step, column)| of_step(column, step));
                    });
                }
            }
            for (&step, stresses) in steps.iter().zip(stresses.chunks_exact(sampled)) {
                self.take(step, stresses, &contacts[step], found);
            }
        }
    }

    /// Searches all points of a step, given its stresses.
    fn take(&self, step: usize, stresses: &[f64], contact: &ContactNow, found: &mut Searched) {
        let mut values = Vec::new();
        for (place, (face, local)) in self.faces.faces.iter().zip(&self.local).enumerate() {
            let mut peaks = found.peaks.get_mut(place);
            let top = tensions_at_points((face, local), stresses, contact, peaks.as_deref(), &mut values);
            let value = |point: usize| face.value(point, |number| &stresses[3 * number..][..3], contact);
            let high = values.iter().enumerate().filter(|(_, value)| **value >= top - 2.0 * ALIKE * top.abs());
            let (alike, largest) = face.largest(high.map(|(point, _)| point), value);
            if let Some(peaks) = &mut peaks {
                values.iter().enumerate().for_each(|(point, value)| peaks.raise(point, *value, step));
                // Points that mirror each other keep equal values.
                alike.into_iter().for_each(|point| peaks.raise(point, largest.largest, step));
            }
            found.steps[step][place] = largest;
        }
    }
}

/// Tensions at the points of a face, Pa; −∞ at points that are left out. Returns the largest. Values that are neither near
/// the largest nor above the earlier peaks may be too small on faces with stresses across them.
fn tensions_at_points(
    (face, local): (&Face, &LocalRows),
    stresses: &[f64],
    contact: &ContactNow,
    peaks: Option<&Peaks>,
    values: &mut Vec<f64>,
) -> f64 {
    let of_points = |first: usize| stresses[3 * first..][..3 * face.points.len()].as_chunks::<3>().0;
    let (in_plane, sign) = (of_points(face.first), face.sign);
    values.clear();
    let Some(across) = face.across.map(of_points) else {
        // Compiled for the vector units of each kind of processor.
        pulp::Arch::new().dispatch(|| {
            values.extend(in_plane.iter().map(|stress| {
                let [m, d, s] = parts(*stress);
                sign * m + (d * d + s * s).sqrt()
            }));
        });
        for (point, more) in local.under(contact) {
            let own = parts(in_plane[point]);
            let [m, d, s] = std::array::from_fn(|i| sign * own[i] + more[i]);
            values[point] = m + (d * d + s * s).sqrt();
        }
        local.left_out.iter().for_each(|point| values[*point] = f64::NEG_INFINITY);
        return values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    };
    let (mut lacking, mut top) = (local.whole_under(contact).peekable(), f64::NEG_INFINITY);
    for (point, (in_plane, across)) in in_plane.iter().zip(across).enumerate() {
        let more = lacking.next_if(|(of, _)| *of == point).map_or([[0.0; 3]; 2], |(_, more)| more);
        let [in_plane, across] = [parts(*in_plane), parts(*across)];
        let in_plane = std::array::from_fn(|i| sign * in_plane[i] + more[0][i]);
        // On a plate in bending, transverse shear is the same on both faces, and the normal stress is opposite.
        let across = std::array::from_fn(|i| if i == 2 { sign * across[i] } else { across[i] } + more[1][i]);
        // An upper bound takes square roots, which are cheaper than an arc cosine.
        let ceiling = ceiling_of(in_plane, across);
        let is_low = ceiling < top - 4.0 * ALIKE * top.abs();
        let is_out = face.left_out[point] || is_low && peaks.is_none_or(|peaks| ceiling as f32 <= peaks.tension[point]);
        values.push(if is_out { f64::NEG_INFINITY } else { principal_of(in_plane, across) });
        top = top.max(values[point]);
    }
    top
}

/// Every few steps, the last one, and the peaks of the contact force.
fn first_steps(contacts: &[ContactNow]) -> Vec<usize> {
    let last = contacts.len() - 1;
    let is_peak_of_force = |step: usize| {
        let [before, now, after] = [step.saturating_sub(1), step, last.min(step + 1)].map(|at| contacts[at].force);
        now > 0.0 && now >= before && now >= after
    };
    (0..=last).filter(|step| step.is_multiple_of(STRIDE) || *step == last || is_peak_of_force(*step)).collect()
}

/// Steps between those searched first at which a tension may be the largest of all, or at least `least`, Pa.
fn steps_between(first: &[usize], steps: &[Vec<FaceTension>], least: f64) -> Vec<usize> {
    let tension = |step: usize| steps[step].iter().map(|face| face.largest).fold(0.0, f64::max);
    let level = first.iter().map(|step| tension(*step)).fold(0.0, f64::max).min(least) / BETWEEN;
    let high = first.windows(2).filter(|ends| tension(ends[0]).max(tension(ends[1])) >= level);
    high.flat_map(|ends| ends[0] + 1..ends[1]).collect()
}

#[cfg(test)]
mod tests;
