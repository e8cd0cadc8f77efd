//! The largest tensions of many steps at once, on the faces of a box that moves in few coordinates.
//!
//! At most steps all but a few points of a face are far below its largest tension. Therefore the tensions at all points are looked through in
//! single precision, and in double precision at those points alone whose tension is the largest or may be, by a bound of the rounding:
//! what is found is what a search of all points in double precision finds. The stresses come of rows of all of them in single precision
//! ([`StressRows`]), or, on lines of a face, of fewer coefficients in double ([`LineStresses`]).
//!
//! *The bound.* Stresses over a size S are off by some u, as they are made. The principal stress m + √(d² + s²) is off by no more than the
//! errors of m, d and s together, and by its own few roundings. On the faces of soft layers there are three more parts, of the stresses across the
//! face, and five errors together: a principal stress is off by no more than the largest sum of errors in a row of the tensor, in which two
//! are a sum of two parts.
//!
//! *The map.* The same values, times S, give the largest tension over time at each point, within the bound. At the points of a step's largest
//! tension on a face the one found in double precision counts, between the points too: the largest value of the map is that of the history.

mod coordinates;
mod local;
mod rows;
mod screen;
mod seen;

use std::rc::Rc;

use super::faces::ALIKE;
use super::line_stress::{TOGETHER, Together};
use super::{ContactNow, FaceStresses, FaceTension, LineStresses, TensionMap};
pub use coordinates::Coordinates;
use local::{LocalRows, parts};
pub(super) use rows::StressRows;
pub(super) use screen::Screen;
use seen::{Peaks, Seen, Wanted};

/// Steps whose stresses are computed at once: they stay in the cache.
const BLOCK: usize = 64;

/// The same on lines, where the matrix that makes coefficients of coordinates is read once for them: it is larger than the cache.
const BLOCK_ON_LINES: usize = 256;

/// Values of which the largest is kept together, a power of two for the processor's vectors.
const LANES: usize = 16;

/// Unit roundoff of single precision.
const ROUNDOFF: f64 = 0.5 * f32::EPSILON as f64;

/// Roundings of a principal stress of its three parts, with room.
const OF_PRINCIPAL: f64 = 32.0;

/// By how much a tension between points is taken to be above that at the highest one at most: each of two parabolas lifts it by an eighth of how
/// far a neighbour is below, so by a quarter where that is compressed as much as the highest is stretched. An estimate.
const LIFTED: f64 = 1.5;

/// A search on all faces of a box.
pub struct TensionSearch<'a> {
    faces: &'a FaceStresses,
    /// What the local fields add at points near the hit, face by face.
    local: Vec<LocalRows>,
    stresses: Stresses,
    /// By what steps may be left out that are between others of a smooth history.
    screen: Option<Rc<Screen>>,
}

/// What the stresses at the sampled points come of.
enum Stresses {
    Rows(Rc<StressRows>),
    Lines(LineStresses),
}

/// The stresses of a step.
struct OfStep<'a, F> {
    /// Over S in single precision: (a + b)/2 of all sampled points, then (a − b)/2, then ab.
    column: &'a [f32],
    /// S, Pa.
    size: f64,
    /// a, b and ab at a sampled point in double precision, Pa.
    at: F,
}

/// What a search has found.
pub struct Searched {
    /// The largest tension on each face, step by step.
    pub steps: Vec<Vec<FaceTension>>,
    /// Of each face.
    peaks: Vec<Peaks>,
    /// Points of each face.
    counts: Vec<usize>,
}

impl Searched {
    /// The largest tension over all steps at each point, of the times of the steps, s.
    pub fn map(&self, times: &[f64]) -> TensionMap {
        let (mut tension, mut time) = (Vec::new(), Vec::new());
        for (peaks, &count) in self.peaks.iter().zip(&self.counts) {
            tension.extend_from_slice(&peaks.tension[..count]);
            time.extend(peaks.steps[..count].iter().map(|step| times[*step as usize]));
        }
        TensionMap::of_steps(tension, time)
    }
}

impl<'a> TensionSearch<'a> {
    /// Of stresses for 1 of each of `count` coordinates at the sampled points, a row for each component a, b and ab; `None` but for faces of
    /// a box.
    pub fn new(faces: &'a FaceStresses, count: usize, rows: Vec<f64>) -> Option<Self> {
        if faces.map.components() != 3 || count == 0 {
            return None;
        }
        Self::of(faces, || Stresses::Rows(Rc::new(StressRows::new(count, rows))))
    }

    /// Of a body's coordinates on its basis at steps that follow its motion closely, what is made for it being kept; `None` as of [`Self::new`], and
    /// where the faces' map is not dense.
    pub fn on_basis(faces: &'a FaceStresses) -> Option<Self> {
        let (count, entries) = faces.dense().filter(|(count, _)| *count > 0 && faces.map.components() == 3)?;
        let rows = faces.rows.get_or_init(|| Rc::new(StressRows::new(count, entries.to_vec())));
        let search = Self::of(faces, || Stresses::Rows(Rc::clone(rows)))?;
        let screen = faces.screen.get_or_init(|| Screen::new(&faces.faces, count, entries).map(Rc::new));
        Some(Self { screen: screen.clone(), ..search })
    }

    /// Of stresses on lines; `None` as of [`Self::new`].
    pub fn on_lines(faces: &'a FaceStresses, lines: &LineStresses) -> Option<Self> {
        Self::of(faces, || Stresses::Lines(lines.clone()))
    }

    fn of(faces: &'a FaceStresses, stresses: impl FnOnce() -> Stresses) -> Option<Self> {
        let local = faces.faces.iter().map(LocalRows::new).collect::<Option<Vec<_>>>()?;
        Some(Self { faces, local, stresses: stresses(), screen: None })
    }

    /// The largest tension on each face at some steps, of their coordinates and contacts. Where the largest of all steps is wanted alone, with the
    /// least one that counts (Pa), none is searched at steps at which it is clearly below both.
    pub fn tensions<'c>(
        &self,
        coordinates: impl Into<Coordinates<'c>>,
        contacts: &[ContactNow],
        least: Option<f64>,
    ) -> Searched {
        let coordinates = coordinates.into();
        let count = match &self.stresses {
            Stresses::Rows(rows) => rows.count,
            Stresses::Lines(lines) => lines.coordinates(),
        };
        let mut found = Finding::new(self, contacts, least);
        if let (Stresses::Rows(rows), Some(screen), Some(least)) = (&self.stresses, &self.screen, least)
            && let Some(high) = screen.steps(coordinates, contacts, least)
        {
            return self.tensions_of(&high, rows, coordinates, found);
        }
        let block = match &self.stresses {
            Stresses::Rows(_) => BLOCK,
            Stresses::Lines(_) => BLOCK_ON_LINES,
        };
        for coordinates in coordinates.all().chunks(block * count) {
            match &self.stresses {
                Stresses::Rows(rows) => {
                    let (all, sizes) = rows.of_steps(coordinates);
                    for (step, size) in sizes.into_iter().enumerate() {
                        let of_step = &coordinates[step * count..(step + 1) * count];
                        let column = all.column(step);
                        let at = |number: usize| rows.at(number, of_step);
                        found.take(&OfStep { column: column.as_slice(), size, at });
                    }
                }
                Stresses::Lines(lines) => {
                    let mut columns = vec![0.0; TOGETHER * 3 * lines.crossings()];
                    lines.each(coordinates, |steps, stresses| {
                        let sizes = scaled(stresses, &mut columns);
                        let columns = columns.chunks_exact(3 * stresses.len());
                        for ((step, column), size) in columns.enumerate().zip(sizes).take(steps) {
                            let at = |number: usize| stresses[number].map(|together| together[step]);
                            found.take(&OfStep { column, size, at });
                        }
                    });
                }
            }
        }
        self.searched(found)
    }

    /// The same at the steps that are named, which ascend; nothing is known of the others.
    fn tensions_of(&self, high: &[usize], rows: &StressRows, coordinates: Coordinates, mut found: Finding) -> Searched {
        for steps in high.chunks(BLOCK) {
            let some = coordinates.of(steps, rows.count);
            let (all, sizes) = rows.of_steps(&some);
            let columns = all.column_iter().zip(some.chunks_exact(rows.count));
            for ((&step, size), (column, of_step)) in steps.iter().zip(sizes).zip(columns) {
                found.skip_to(step);
                found.take(&OfStep { column: column.as_slice(), size, at: |number| rows.at(number, of_step) });
            }
        }
        found.skip_to(found.contacts.len());
        self.searched(found)
    }

    fn searched(&self, found: Finding) -> Searched {
        let counts = self.faces.faces.iter().map(|face| face.points.len()).collect();
        Searched { steps: found.steps, peaks: found.peaks, counts }
    }

    /// By how much a tension over S that was the largest may lie below the highest one seen.
    fn bound(&self, top: f32) -> f32 {
        let products = match &self.stresses {
            Stresses::Rows(rows) => rows.count as f64,
            // They are rounded two or three times.
            Stresses::Lines(_) => 0.0,
        };
        let together = if self.faces.faces.iter().any(|face| face.across.is_some()) { 5.0 } else { 3.0 };
        let error = (together * (products + 4.0) + OF_PRINCIPAL) * ROUNDOFF;
        // Both may be off; and points count as alike that differ by a part.
        let of_top = (2.0 * ALIKE + OF_PRINCIPAL * ROUNDOFF) * f64::from(top.abs()).max(1.0);
        (2.0 * error + of_top) as f32
    }
}

/// Fills the columns of some steps with their stresses at the sampled points over the largest ones, which it returns.
fn scaled(stresses: &[[Together; 3]], columns: &mut [f32]) -> Together {
    let mut sizes = [0.0_f64; TOGETHER];
    for together in stresses.iter().flatten() {
        sizes.iter_mut().zip(together).for_each(|(size, stress)| *size = size.max(stress.abs()));
    }
    let over = sizes.map(|size| if size > 0.0 { 1.0 / size } else { 1.0 });
    let sampled = stresses.len();
    for (number, [a, b, ab]) in stresses.iter().enumerate() {
        for step in 0..TOGETHER {
            for (part, stress) in parts([a[step], b[step], ab[step]]).into_iter().enumerate() {
                columns[(3 * step + part) * sampled + number] = (stress * over[step]) as f32;
            }
        }
    }
    sizes
}

/// What a search has found so far.
struct Finding<'a> {
    search: &'a TensionSearch<'a>,
    contacts: &'a [ContactNow],
    steps: Vec<Vec<FaceTension>>,
    peaks: Vec<Peaks>,
    seen: Seen,
    /// The least tension that counts, Pa, where the largest of all steps is wanted alone; and the largest so far.
    least: Option<f64>,
    largest: f64,
}

impl<'a> Finding<'a> {
    fn new(search: &'a TensionSearch<'a>, contacts: &'a [ContactNow], least: Option<f64>) -> Self {
        let peaks = search.faces.faces.iter().map(|face| Peaks::new(face.points.len())).collect();
        Self {
            search,
            contacts,
            steps: Vec::with_capacity(contacts.len()),
            peaks,
            seen: Seen::default(),
            least,
            largest: 0.0,
        }
    }

    /// Passes over the steps before a number.
    fn skip_to(&mut self, step: usize) {
        self.steps.resize(step, vec![FaceTension::UNKNOWN; self.search.faces.faces.len()]);
    }

    /// Takes the next step.
    fn take(&mut self, of_step: &OfStep<impl Fn(usize) -> [f64; 3]>) {
        let Self { search, contacts, steps, peaks, seen, least, largest } = self;
        let OfStep { column, size, at } = of_step;
        let (contact, number) = (&contacts[steps.len()], steps.len() as u32);
        seen.take(column);
        let faces = search.faces.faces.iter().zip(&search.local).zip(peaks);
        let each = faces.map(|((face, local), peaks)| {
            seen.look((face, local), (column, *size), contact, Wanted::Peaks(peaks));
            // (Where all is compressed, nothing is known of points between.)
            let is_small = |least: f64| seen.top > 0.0 && LIFTED * f64::from(seen.top) * size < largest.min(least);
            if *size > f64::MIN_POSITIVE && least.is_some_and(is_small) {
                return FaceTension::UNKNOWN;
            }
            let value = |point: usize| match face.left_out[point] {
                true => f64::NAN,
                false => face.value(point, at, contact),
            };
            let (alike, found) = if *size > f64::MIN_POSITIVE && seen.top.is_finite() {
                peaks.take(&seen.values, *size as f32, number);
                let bound = search.bound(seen.top);
                // (Points that are left out have no tension.)
                face.largest(seen.from(seen.top - bound), value)
            } else {
                // Without a size, as at rest, single precision tells nothing.
                let values: Vec<f64> = (0..face.points.len()).map(value).collect();
                values.iter().enumerate().for_each(|(point, value)| peaks.raise(point, *value as f32, number));
                face.largest(face.read_points(), |point| values[point])
            };
            // Points that mirror each other stay alike.
            alike.into_iter().for_each(|point| peaks.raise(point, found.largest as f32, number));
            *largest = largest.max(found.largest);
            found
        });
        steps.push(each.collect());
    }
}

#[cfg(test)]
mod tests;
