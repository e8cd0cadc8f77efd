//! Search for the largest tensions of many steps at once, on the faces of a box with few coordinates.
//!
//! At most steps, all but a few points of a face are far below the largest tension. Therefore the tensions at all
//! points are evaluated in single precision. Double precision is used only at points whose tension may be the largest,
//! according to a bound of the rounding error. The result is the same as for a search of all points in double
//! precision. The stresses are computed from rows for all of them in single precision ([`StressRows`]) or, on lines of
//! a face, from fewer coefficients in double precision ([`LineStresses`]).
//!
//! *Bound.* S is an upper bound of the stresses of a step. Stresses divided by S have an error of at most some u, which
//! depends on how they are computed. The error of the principal stress m + √(d² + s²) is at most the sum of the errors
//! of m, d and s, plus a few roundings of its own. On the faces of soft layers there are three more parts, for the
//! stresses across the face, and the sum has five errors: the error of a principal stress is at most the largest sum of
//! errors in a row of the tensor, in which two components are sums of two parts.
//!
//! *Map.* The same values, times S, give the largest tension over time at each point, within the bound. At the points
//! of a step's largest tension on a face, the value found in double precision is used, including interpolation between
//! points. So the largest value of the map equals the largest value of the time history.

mod coordinates;
mod local;
mod rows;
mod screen;
mod seen;

use std::rc::Rc;

use super::faces::ALIKE;
use super::line_stress::{LineVisitor, StepsTogether, TOGETHER, Together};
use super::{ContactNow, FaceStresses, FaceTension, LineStresses, TensionMap};
pub use coordinates::Coordinates;
use local::{LocalRows, parts};
pub(super) use rows::StressRows;
pub(super) use screen::Screen;
use seen::{Peaks, Seen, Wanted};

/// Number of steps whose stresses are computed at once, so that they stay in the cache.
const BLOCK: usize = 64;

/// Number of values whose maximum is kept together; a power of two, for the vector units of the processor.
const LANES: usize = 16;

/// Unit roundoff of single precision.
const ROUNDOFF: f64 = 0.5 * f32::EPSILON as f64;

/// Number of roundings in a principal stress computed from its three parts, with a margin.
const ROUNDINGS_OF_PRINCIPAL: f64 = 32.0;

/// Assumed upper limit of the ratio of a tension between points to the largest tension at the points. Each of two
/// parabolas adds an eighth of the difference to a neighbour: a quarter of the largest tension if the neighbour has the
/// same stress in compression. An estimate.
const LIFTED: f64 = 1.5;

/// Search on all faces of a box.
pub struct TensionSearch<'a> {
    faces: &'a FaceStresses,
    /// Local fields at points near the impact point, face by face.
    local: Vec<LocalRows>,
    stresses: Stresses,
    /// Selects steps of a smooth time history that need no search.
    screen: Option<Rc<Screen>>,
}

/// Source of the stresses at the sampled points.
enum Stresses {
    Rows(Rc<StressRows>),
    Lines(LineStresses),
}

/// Stresses of a step.
struct OfStep<'a, F> {
    /// Stresses divided by S in single precision: (a + b)/2 at all sampled points, then (a − b)/2, then ab.
    column: &'a [f32],
    /// Size S, Pa.
    size: f64,
    /// Number of products that are summed to a stress in single precision.
    products: usize,
    /// Upper bound of the stresses divided by S.
    largest: f64,
    /// Stresses a, b and ab at a sampled point in double precision, Pa.
    at: F,
}

/// Result of a search.
pub struct Searched {
    /// Largest tension on each face, step by step.
    pub steps: Vec<Vec<FaceTension>>,
    /// Largest tensions over the steps, for each face; empty if only the largest of all steps was searched.
    peaks: Vec<Peaks>,
    /// Number of points of each face.
    counts: Vec<usize>,
}

impl Searched {
    /// Largest tension over all steps at each point; empty if only the largest of all steps was searched. `times` are
    /// the times of the steps, s.
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
    /// Search with rows of stresses at the sampled points for a unit value of each of `count` coordinates; each point
    /// has a row for each of a, b and ab. `None` unless the body is a box.
    pub fn new(faces: &'a FaceStresses, count: usize, rows: Vec<f64>) -> Option<Self> {
        if faces.map.components() != 3 || count == 0 {
            return None;
        }
        Self::of(faces, || Stresses::Rows(Rc::new(StressRows::new(count, rows))))
    }

    /// Search in the reduced coordinates of a body, at steps that resolve its motion. The derived data are kept for
    /// later searches. `None` as for [`Self::new`], or if the map of the faces is not dense.
    pub fn on_basis(faces: &'a FaceStresses) -> Option<Self> {
        let (count, entries) = faces.dense().filter(|(count, _)| *count > 0 && faces.map.components() == 3)?;
        let rows = faces.rows.get_or_init(|| Rc::new(StressRows::new(count, entries.to_vec())));
        let search = Self::of(faces, || Stresses::Rows(Rc::clone(rows)))?;
        let screen = faces.screen.get_or_init(|| Screen::new(&faces.faces, count, entries).map(Rc::new));
        Some(Self { screen: screen.clone(), ..search })
    }

    /// Search with stresses on lines; `None` as for [`Self::new`].
    pub fn on_lines(faces: &'a FaceStresses, lines: &LineStresses) -> Option<Self> {
        Self::of(faces, || Stresses::Lines(lines.clone()))
    }

    fn of(faces: &'a FaceStresses, stresses: impl FnOnce() -> Stresses) -> Option<Self> {
        let local = faces.faces.iter().map(LocalRows::new).collect::<Option<Vec<_>>>()?;
        Some(Self { faces, local, stresses: stresses(), screen: None })
    }

    /// Largest tension on each face at some steps, given their coordinates and contacts. `least` is given if only the
    /// largest tension of all steps is needed: a step is then left out if its tensions are clearly below both the
    /// largest one and `least` (Pa).
    pub fn tensions<'c>(
        &self,
        coordinates: impl Into<Coordinates<'c>>,
        contacts: &[ContactNow],
        least: Option<f64>,
    ) -> Searched {
        let coordinates = coordinates.into();
        let mut found = Finding::new(self, contacts, least);
        if let (Stresses::Rows(rows), Some(screen), Some(least)) = (&self.stresses, &self.screen, least)
            && let Some(high) = screen.steps(coordinates, contacts, least)
        {
            return self.tensions_of(&high, rows, coordinates, found);
        }
        let all = coordinates.all();
        match &self.stresses {
            Stresses::Rows(rows) => {
                let mut columns = Vec::new();
                for coordinates in all.chunks(BLOCK * rows.count) {
                    let sizes = rows.of_steps(coordinates, &mut columns);
                    let each = columns.chunks_exact(3 * rows.points()).zip(sizes);
                    let each = each.zip(coordinates.chunks_exact(rows.count));
                    for ((column, size), of_step) in each {
                        let at = |number: usize| rows.at(number, of_step);
                        found.take(&OfStep { column, size, products: rows.count, largest: 1.0, at });
                    }
                }
            }
            Stresses::Lines(lines) => {
                let (scales, mut columns) = (lines.scales(), vec![0.0; 3 * TOGETHER * lines.crossings()]);
                lines.each(&all, |together| {
                    let largest = scaled(together, &scales, &mut columns);
                    let each = columns.chunks_exact(3 * lines.crossings()).zip(together.coordinates());
                    for (step, (column, of_step)) in each.enumerate() {
                        let (size, largest) = (size(of_step, &scales), largest[step]);
                        let at = |number: usize| together.at(number, step);
                        // The sums have been computed in double precision.
                        found.take(&OfStep { column, size, products: 0, largest, at });
                    }
                });
            }
        }
        self.searched(found)
    }

    /// Same as [`Self::tensions`] for the listed steps, ascending; the other steps have unknown tensions.
    fn tensions_of(&self, high: &[usize], rows: &StressRows, coordinates: Coordinates, mut found: Finding) -> Searched {
        let mut columns = Vec::new();
        for steps in high.chunks(BLOCK) {
            let some = coordinates.of(steps, rows.count);
            let sizes = rows.of_steps(&some, &mut columns);
            let each = columns.chunks_exact(3 * rows.points()).zip(some.chunks_exact(rows.count));
            for ((&step, size), (column, of_step)) in steps.iter().zip(sizes).zip(each) {
                found.skip_to(step);
                let at = |number: usize| rows.at(number, of_step);
                found.take(&OfStep { column, size, products: rows.count, largest: 1.0, at });
            }
        }
        found.skip_to(found.contacts.len());
        self.searched(found)
    }

    fn searched(&self, found: Finding) -> Searched {
        let counts = self.faces.faces.iter().map(|face| face.points.len()).collect();
        Searched { steps: found.steps, peaks: found.peaks, counts }
    }

    /// Bound of the difference, divided by S, between the largest tension seen (`top`) and the single-precision value
    /// at the point of the true largest tension. `products` is the number of products that are summed to a stress in
    /// single precision, and `largest` an upper bound of the stresses; both are divided by S.
    fn bound(&self, top: f32, products: usize, largest: f64) -> f32 {
        let together = if self.faces.faces.iter().any(|face| face.across.is_some()) { 5.0 } else { 3.0 };
        let error = (together * (products as f64 + 4.0) + ROUNDINGS_OF_PRINCIPAL) * ROUNDOFF * largest;
        // Both values may have the error, and points within a relative difference count as equal.
        let of_top = (2.0 * ALIKE + ROUNDINGS_OF_PRINCIPAL * ROUNDOFF) * f64::from(top.abs()).max(largest);
        (2.0 * error + of_top) as f32
    }
}

/// Bound S of the stresses of a step, Pa, with the bounds ρ for a unit value of each coordinate.
fn size(coordinates: &[f64], scales: &[f64]) -> f64 {
    coordinates.iter().zip(scales).map(|(w, scale)| (w * scale).abs()).sum()
}

/// Fills a column for each of some steps with the stresses at the sampled points, divided by S. Returns the largest of
/// them for each step.
fn scaled(together: &StepsTogether, scales: &[f64], columns: &mut [f32]) -> Together {
    let mut over = [0.0; TOGETHER];
    for (over, of_step) in over.iter_mut().zip(together.coordinates()) {
        let size = size(of_step, scales);
        *over = if size > 0.0 { size.recip() } else { 1.0 };
    }
    let mut scaling = Scaling { over, columns, largest: [0.0; TOGETHER] };
    together.each_line(&mut scaling);
    together.apart().for_each(|(crossing, stresses)| scaling.take(crossing, &[stresses]));
    scaling.largest
}

/// Fills the columns of some steps.
struct Scaling<'a> {
    /// 1/S of the steps.
    over: Together,
    columns: &'a mut [f32],
    /// Largest stress of each step so far, divided by S.
    largest: Together,
}

impl Scaling<'_> {
    /// Takes the stresses at consecutive sampled points.
    #[inline(always)]
    fn take(&mut self, first: usize, stresses: &[[Together; 3]]) {
        let sampled = self.columns.len() / (3 * TOGETHER);
        // Local copies stay in registers.
        let (over, mut largest) = (self.over, self.largest);
        for (step, columns) in self.columns.chunks_exact_mut(3 * sampled).enumerate() {
            let (means, rest) = columns.split_at_mut(sampled);
            let (halves, shears) = rest.split_at_mut(sampled);
            let into = means[first..].iter_mut().zip(&mut halves[first..]).zip(&mut shears[first..]);
            for (((mean, half), shear), [a, b, ab]) in into.zip(stresses) {
                let of_step = [a[step] * over[step], b[step] * over[step], ab[step] * over[step]];
                let size = of_step[0].abs().max(of_step[1].abs()).max(of_step[2].abs());
                largest[step] = if size > largest[step] { size } else { largest[step] };
                let [m, d, s] = parts(of_step);
                (*mean, *half, *shear) = (m as f32, d as f32, s as f32);
            }
        }
        self.largest = largest;
    }
}

impl LineVisitor for Scaling<'_> {
    #[inline(always)]
    fn line(&mut self, number: usize, stresses: &[[Together; 3]]) {
        self.take(number * stresses.len(), stresses);
    }
}

/// State of a search.
struct Finding<'a> {
    search: &'a TensionSearch<'a>,
    contacts: &'a [ContactNow],
    steps: Vec<Vec<FaceTension>>,
    /// Largest tensions over the steps, for each face; empty if only the largest of all steps is needed.
    peaks: Vec<Peaks>,
    seen: Seen,
    /// Smallest tension of interest, Pa, if only the largest of all steps is needed; and the largest tension so far.
    least: Option<f64>,
    largest: f64,
}

impl<'a> Finding<'a> {
    fn new(search: &'a TensionSearch<'a>, contacts: &'a [ContactNow], least: Option<f64>) -> Self {
        let faces = search.faces.faces.iter().filter(|_| least.is_none());
        let peaks = faces.map(|face| Peaks::new(face.points.len())).collect();
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

    /// Marks the steps before a number as unknown.
    fn skip_to(&mut self, step: usize) {
        self.steps.resize(step, vec![FaceTension::UNKNOWN; self.search.faces.faces.len()]);
    }

    /// Searches the next step.
    fn take(&mut self, of_step: &OfStep<impl Fn(usize) -> [f64; 3]>) {
        let Self { search, contacts, steps, peaks, seen, least, largest } = self;
        let OfStep { column, size, products, largest: bound_of_stresses, at } = of_step;
        let (contact, number) = (&contacts[steps.len()], steps.len() as u32);
        seen.take(column);
        let faces = search.faces.faces.iter().zip(&search.local).enumerate();
        let each = faces.map(|(place, (face, local))| {
            let mut peaks = peaks.get_mut(place);
            let wanted = peaks.as_deref().map_or(Wanted::Largest, Wanted::Peaks);
            seen.look((face, local), (column, *size), contact, wanted);
            // If all points are in compression, this gives no limit for the tension between points.
            let is_small = |least: f64| seen.top > 0.0 && LIFTED * f64::from(seen.top) * size < largest.min(least);
            if *size > f64::MIN_POSITIVE && least.is_some_and(is_small) {
                return FaceTension::UNKNOWN;
            }
            let value = |point: usize| match face.left_out[point] {
                true => f64::NAN,
                false => face.value(point, at, contact),
            };
            let (alike, found) = if *size > f64::MIN_POSITIVE && seen.top.is_finite() {
                if let Some(peaks) = &mut peaks {
                    peaks.take(&seen.values, *size as f32, number);
                }
                let bound = search.bound(seen.top, *products, *bound_of_stresses);
                // Points that are left out have no tension.
                face.largest(seen.from(seen.top - bound), value)
            } else {
                // If the size is zero, as at rest, single precision gives no information.
                let values: Vec<f64> = (0..face.points.len()).map(value).collect();
                if let Some(peaks) = &mut peaks {
                    values.iter().enumerate().for_each(|(point, value)| peaks.raise(point, *value as f32, number));
                }
                face.largest(face.read_points(), |point| values[point])
            };
            // Points that mirror each other keep equal values.
            if let Some(peaks) = &mut peaks {
                alike.into_iter().for_each(|point| peaks.raise(point, found.largest as f32, number));
            }
            *largest = largest.max(found.largest);
            found
        });
        steps.push(each.collect());
    }
}

#[cfg(test)]
mod tests;
