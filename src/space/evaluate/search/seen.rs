//! Tensions at all points of a face at one step, in single precision.

use crate::space::evaluate::{ContactNow, Face};

use super::LANES;
use super::local::{LocalRows, ceiling_of, principal_of};

/// Tensions divided by S at all points of a face, in single precision.
#[derive(Default)]
pub(super) struct Seen {
    /// √(d² + s²) at all sampled points, which the faces share.
    roots: Vec<f32>,
    /// Tensions, padded with −∞ to a multiple of [`LANES`].
    pub values: Vec<f32>,
    /// Maximum of each group of [`LANES`] values.
    tops: Vec<f32>,
    /// Maximum of all values.
    pub top: f32,
}

/// Added to upper bounds in single precision, so that they remain bounds with their roundings. Without the local field,
/// stresses divided by S are at most 1.
const CEILING_MARGIN: f32 = 64.0 * f32::EPSILON;

/// The larger of two values; the first if the second is NaN.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if b > a { b } else { a }
}

/// Values that must be exact. Others may be too large, but exceed neither the largest value nor their earlier peaks.
#[derive(Clone, Copy)]
pub(super) enum Wanted<'a> {
    /// All values.
    #[cfg(test)]
    All,
    /// The largest of the step.
    Largest,
    /// The largest of the step, and all that exceed the peaks of earlier steps.
    Peaks(&'a Peaks),
}

impl Wanted<'_> {
    /// Whether a value below a ceiling may be left as it is, given the largest value so far. Values are divided by S;
    /// `size` is S, Pa.
    fn is_out(self, point: usize, ceiling: f32, (top, size): (f32, f64)) -> bool {
        match self {
            #[cfg(test)]
            Self::All => false,
            Self::Largest => ceiling <= top,
            Self::Peaks(peaks) => ceiling <= top && ceiling * size as f32 <= peaks.tension[point],
        }
    }
}

/// A value in single precision. A value out of range due to a small size becomes infinite, so that all points are then
/// examined.
fn known(value: f64) -> f32 {
    if value.is_nan() { f32::INFINITY } else { value as f32 }
}

impl Seen {
    /// Sets the stresses of a step.
    pub fn take(&mut self, column: &[f32]) {
        let sampled = column.len() / 3;
        self.roots.resize(sampled, 0.0);
        pulp::Arch::new().dispatch(Rooting {
            half: &column[sampled..2 * sampled],
            shear: &column[2 * sampled..3 * sampled],
            roots: &mut self.roots,
        });
    }

    /// Computes the tensions on a face from its stresses divided by the size S in a column.
    pub fn look(
        &mut self,
        (face, local): (&Face, &LocalRows),
        (column, size): (&[f32], f64),
        contact: &ContactNow,
        wanted: Wanted,
    ) {
        let (sampled, count) = (column.len() / 3, face.points.len());
        let [mean, half, shear] = [0, 1, 2].map(|part| &column[part * sampled + face.first..][..count]);
        let sign = face.sign as f32;
        // The padding may still hold values of another face.
        self.values.resize(count.next_multiple_of(LANES), f32::NEG_INFINITY);
        let (values, beyond) = self.values.split_at_mut(count);
        beyond.fill(f32::NEG_INFINITY);
        match face.across {
            Some(first) => {
                let across = [0, 1, 2].map(|part| &column[part * sampled + first..][..count]);
                // Most points are far below the largest; the ceiling takes square roots, which are cheaper than an arc
                // cosine.
                pulp::Arch::new().dispatch(UpperBounds { sign, in_plane: [mean, half, shear], across, values });
                let (mut lacking, mut top) = (local.whole_under(contact).peekable(), f32::NEG_INFINITY);
                for (point, value) in values.iter_mut().enumerate() {
                    let more = lacking.next_if(|(of, _)| *of == point);
                    if more.is_none() && wanted.is_out(point, *value, (top, size)) {
                        continue;
                    }
                    let mut in_plane = [mean, half, shear].map(|parts| face.sign * f64::from(parts[point]));
                    let mut across = across.map(|parts| f64::from(parts[point]));
                    // On a plate in bending, transverse shear is the same on both faces.
                    across[2] *= face.sign;
                    if let Some((_, more)) = more {
                        (0..3).for_each(|i| in_plane[i] += more[0][i] / size);
                        (0..3).for_each(|i| across[i] += more[1][i] / size);
                    }
                    let ceiling = known(ceiling_of(in_plane, across));
                    *value = match face.left_out[point] {
                        true => f32::NEG_INFINITY,
                        false if wanted.is_out(point, ceiling, (top, size)) => ceiling,
                        false => known(principal_of(in_plane, across)),
                    };
                    top = larger(top, *value);
                }
            }
            None => {
                let roots = &self.roots[face.first..][..count];
                pulp::Arch::new().dispatch(Adding { sign, mean, roots, values });
                for (point, more) in local.under(contact) {
                    let of = |part: usize, stress: f32| f64::from(sign * stress) + more[part] / size;
                    let [m, d, s] = [of(0, mean[point]), of(1, half[point]), of(2, shear[point])];
                    values[point] = known(m + (d * d + s * s).sqrt());
                }
            }
        }
        local.left_out.iter().for_each(|point| values[*point] = f32::NEG_INFINITY);
        self.tops.resize(self.values.len() / LANES, f32::NEG_INFINITY);
        pulp::Arch::new().dispatch(Topping { values: &self.values, tops: &mut self.tops });
        self.top = self.tops.iter().copied().fold(f32::NEG_INFINITY, larger);
    }

    /// Points whose values are at least `least`; few if most values are far below.
    pub fn from(&self, least: f32) -> impl Iterator<Item = usize> {
        let high = self.tops.iter().enumerate().filter(move |(_, top)| **top >= least);
        high.flat_map(move |(chunk, _)| {
            let some = self.values[LANES * chunk..LANES * (chunk + 1)].iter().enumerate();
            some.filter(move |(_, value)| **value >= least).map(move |(i, _)| LANES * chunk + i)
        })
    }
}

/// Computes √(d² + s²). Like the other tasks here, it is compiled for the vector units of each kind of processor.
struct Rooting<'a> {
    half: &'a [f32],
    shear: &'a [f32],
    roots: &'a mut [f32],
}

impl pulp::NullaryFnOnce for Rooting<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let parts = self.half.iter().zip(self.shear);
        self.roots.iter_mut().zip(parts).for_each(|(root, (d, s))| *root = (d * d + s * s).sqrt());
    }
}

/// Computes values from the means, times a sign, and the roots.
struct Adding<'a> {
    sign: f32,
    mean: &'a [f32],
    roots: &'a [f32],
    values: &'a mut [f32],
}

impl pulp::NullaryFnOnce for Adding<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let parts = self.mean.iter().zip(self.roots);
        self.values.iter_mut().zip(parts).for_each(|(value, (mean, root))| *value = self.sign * mean + root);
    }
}

/// Computes upper bounds of the principal stresses, as [`ceiling_of`] does, from the parts of the in-plane stresses,
/// times a sign, and of the stresses across the face.
struct UpperBounds<'a> {
    sign: f32,
    in_plane: [&'a [f32]; 3],
    across: [&'a [f32]; 3],
    values: &'a mut [f32],
}

impl pulp::NullaryFnOnce for UpperBounds<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { sign, in_plane: [mean, half, shear], across: [mean_across, half_across, normal], values } = self;
        let in_plane = mean.iter().zip(half).zip(shear);
        let across = mean_across.iter().zip(half_across).zip(normal);
        for ((value, ((m, d), s)), ((m_across, d_across), normal)) in values.iter_mut().zip(in_plane).zip(across) {
            let (in_plane, normal) = (sign * m + (d * d + s * s).sqrt(), sign * normal);
            let (difference, shear) = (in_plane - normal, 2.0 * (m_across * m_across + d_across * d_across));
            *value = 0.5 * (in_plane + normal) + (0.25 * difference * difference + shear).sqrt() + CEILING_MARGIN;
        }
    }
}

/// Computes the maximum of each group of [`LANES`] values.
struct Topping<'a> {
    values: &'a [f32],
    tops: &'a mut [f32],
}

impl pulp::NullaryFnOnce for Topping<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for (top, values) in self.tops.iter_mut().zip(self.values.as_chunks::<LANES>().0) {
            // Compares the two halves element by element; NaN is replaced by −∞ first.
            let mut most = values.map(|value| larger(f32::NEG_INFINITY, value));
            let mut width = LANES / 2;
            while width > 0 {
                for i in 0..width {
                    most[i] = larger(most[i], most[i + width]);
                }
                width /= 2;
            }
            *top = most[0];
        }
    }
}

/// Largest tension at each point of a face over the steps so far, in single precision.
pub(super) struct Peaks {
    /// Tension, Pa, padded like [`Seen::values`].
    pub tension: Vec<f32>,
    /// Number of the step of each tension.
    pub steps: Vec<u32>,
}

impl Peaks {
    /// Peaks of `count` points, before the first step.
    pub fn new(count: usize) -> Self {
        let filled = count.next_multiple_of(LANES);
        Self { tension: vec![f32::NEG_INFINITY; filled], steps: vec![0; filled] }
    }

    /// Includes the tensions of a step, which are divided by a size, Pa.
    pub fn take(&mut self, values: &[f32], size: f32, step: u32) {
        let Self { tension, steps } = self;
        pulp::Arch::new().dispatch(Raising { tension, steps, values, size, step });
    }

    /// Includes the tension at one point, Pa.
    pub fn raise(&mut self, point: usize, tension: f32, step: u32) {
        if tension > self.tension[point] {
            (self.tension[point], self.steps[point]) = (tension, step);
        }
    }
}

/// Task of [`Peaks::take`].
struct Raising<'a> {
    tension: &'a mut [f32],
    steps: &'a mut [u32],
    values: &'a [f32],
    size: f32,
    step: u32,
}

impl pulp::NullaryFnOnce for Raising<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { tension, steps, values, size, step } = self;
        for ((top, when), value) in tension.iter_mut().zip(steps).zip(values) {
            let tension = value * size;
            // Both are written each time, so that the loop can be vectorised.
            let is_larger = tension > *top;
            *when = if is_larger { step } else { *when };
            *top = if is_larger { tension } else { *top };
        }
    }
}
