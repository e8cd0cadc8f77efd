//! Response of a body to the contact force, interpolated between bodies that differ in one parameter.
//!
//! The displacement at the impact point, and all other displacements, are linear in the time history of the force.
//! Their kernels are functions of time and of the parameter, and smooth in the parameter. Between bodies with known
//! modes, the kernel is a sum of their kernels with the weights of Lagrange's interpolation. The modes of all bodies
//! move side by side, and the force on each body is multiplied by its weight. For vibrations that can be followed from
//! one body to the next, the rates and the residues are interpolated instead of the kernels. Creep motions have rates
//! that all bodies share ([`CommonRates`]), so that they can be followed too. No eigenproblem remains to be solved.

mod numbers;

use nalgebra::{Complex, DMatrix};

use serde::{Deserialize, Serialize};

use super::common_rates::{CommonRates, Decay};
use super::modal::ModalBody;
use super::modes::{Free, Mode, Modes};
use super::shapes::{Forms, Shapes};
use super::{BlockMatrix, Projection};
use crate::contact::Footprint;
use numbers::Numbers;

/// Least cosine of the angle between the residues of one vibration in two bodies, and largest relative change of its
/// rate.
const LEAST_MODE_COSINE: f64 = 0.9;
const LARGEST_RATE_CHANGE: f64 = 0.2;

/// Part of its amplitude that a vibration may lose within a run without effect.
const NEGLIGIBLE_DECAY: f64 = 1e-3;

/// Rates λ and outputs of coordinates that F drives with an input of 1.
type Rates = Vec<(Complex<f64>, Complex<f64>)>;

/// Modes of one body, with their displacements on a basis that all bodies share.
#[derive(Clone, Serialize, Deserialize)]
#[serde(into = "Numbers", from = "Numbers")]
pub struct Response {
    /// Duration of the run, s.
    end: f64,
    modes: Rates,
    /// Matrix Y of the basis coordinates y = Re(Y z), with one column for each coordinate z.
    places: DMatrix<Complex<f64>>,
    free: Free,
    residual: f64,
    /// Displacements that do not depend on z.
    others: Shapes,
    /// Stress forms on y on the face opposite the impact point, and the local stresses that they lack for 1 N.
    hit_stress: (DMatrix<f64>, [f64; 3]),
    compliance: f64,
    multiplicity: f64,
    footprint: Footprint,
}

impl Response {
    /// Creates the response of a body reduced to the shared basis, with its noticeable modes. Loads are left out.
    pub fn new(projection: &Projection, modes: &Modes, noticeable: Noticeable) -> Self {
        let Shapes { moving, free, residual, rest } = &modes.shapes;
        let kept = noticeable.of(&modes.modes);
        let mut places = match &modes.forms.damped {
            Some([places, _]) => places.times_from_left(moving).select_columns(&kept),
            // x = Im z/ω.
            None => {
                let frequencies = &modes.forms.frequencies;
                DMatrix::from_fn(moving.nrows(), kept.len(), |i, k| {
                    Complex::new(0.0, -moving[(i, kept[k])] / frequencies[kept[k]])
                })
            }
        };
        let own: Vec<&Mode> = kept.iter().map(|&k| &modes.modes[k]).collect();
        places.column_iter_mut().zip(&own).for_each(|(mut column, mode)| column *= mode.input);
        let own_modes: Vec<_> = own.into_iter().map(|mode| (mode.rate, mode.output * mode.input)).collect();
        let (coordinates, places) = with_common_rates(&own_modes, &places, CommonRates::new(noticeable.end));
        Self {
            end: noticeable.end,
            modes: coordinates,
            places,
            free: modes.free,
            residual: modes.residual,
            others: Shapes {
                moving: DMatrix::zeros(moving.nrows(), 0),
                free: free.clone(),
                residual: residual.clone(),
                rest: rest.clone(),
            },
            hit_stress: (projection.hit_stress.clone(), projection.local_stress_per_newton),
            compliance: projection.compliance,
            multiplicity: projection.multiplicity,
            footprint: projection.footprint,
        }
    }

    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.modes.len()
    }

    /// Returns, for each coordinate, the number of the coordinate of another body that continues it, if there is one: a
    /// similar vibration, or a decay of equal rate.
    fn tracked_in(&self, other: &Self) -> Vec<Option<usize>> {
        let real = |matrix: &DMatrix<Complex<f64>>, of: fn(&Complex<f64>) -> f64| matrix.map(|entry| of(&entry));
        let [own, others] = [self, other]
            .map(|response| [real(&response.places, |entry| entry.re), real(&response.places, |entry| entry.im)]);
        // |yᴴ y′|² for all pairs of coordinates.
        let re = own[0].tr_mul(&others[0]) + own[1].tr_mul(&others[1]);
        let im = own[0].tr_mul(&others[1]) - own[1].tr_mul(&others[0]);
        let squares = |response: &Self| -> Vec<f64> {
            response.places.column_iter().map(|column| column.norm_squared().max(f64::MIN_POSITIVE)).collect()
        };
        let [of_own, of_others] = [self, other].map(squares);
        let alike = DMatrix::from_fn(re.nrows(), re.ncols(), |k, l| {
            let [(rate, _), (of_other, _)] = [self.modes[k], other.modes[l]];
            if rate == of_other && rate.im == 0.0 {
                return 1.0;
            }
            let is_near =
                rate.im > 0.0 && of_other.im > 0.0 && (rate - of_other).norm() < LARGEST_RATE_CHANGE * rate.norm();
            if is_near { (re[(k, l)].powi(2) + im[(k, l)].powi(2)) / (of_own[k] * of_others[l]) } else { 0.0 }
        });
        let best = |values: &mut dyn Iterator<Item = f64>| {
            let (place, value) =
                values.enumerate().fold((0, 0.0), |most, next| if next.1 > most.1 { next } else { most });
            (value > LEAST_MODE_COSINE * LEAST_MODE_COSINE).then_some(place)
        };
        let backward: Vec<Option<usize>> =
            alike.column_iter().map(|column| best(&mut column.iter().copied())).collect();
        let forward = alike.row_iter().map(|row| best(&mut row.iter().copied()));
        forward.enumerate().map(|(k, found)| found.filter(|l| backward[*l] == Some(k))).collect()
    }
}

/// Replaces coordinates that decay without vibrating by coordinates with common rates.
fn with_common_rates(
    modes: &[(Complex<f64>, Complex<f64>)],
    places: &DMatrix<Complex<f64>>,
    common: CommonRates,
) -> (Rates, DMatrix<Complex<f64>>) {
    let is_decay = |k: &usize| modes[*k].0.im == 0.0 && modes[*k].0.re <= 0.0;
    let (decays, others): (Vec<usize>, Vec<usize>) = (0..modes.len()).partition(is_decay);
    let sums: Vec<(usize, Decay)> = decays.into_iter().map(|k| (k, common.decay(-modes[k].0.re))).collect();
    let count = sums.iter().map(|(_, decay)| decay.first + decay.weights.len()).max().unwrap_or(0);
    let zero = Complex::new(0.0, 0.0);
    let mut all: Vec<_> = others.iter().map(|&k| modes[k]).collect();
    all.extend((0..count).map(|number| (Complex::new(-common.rate(number), 0.0), zero)));
    let mut all_places = places.select_columns(&others).resize_horizontally(all.len(), zero);
    for (k, Decay { first, weights }) in sums {
        for (place, weight) in (others.len() + first..).zip(weights) {
            all[place].1 += modes[k].1 * weight;
            all_places.column_mut(place).zip_apply(&places.column(k), |sum, entry| *sum += entry * weight);
        }
    }
    (all, all_places)
}

/// Correspondence between the coordinates of several bodies, for interpolation between them.
pub struct Interpolant {
    /// Coordinates that are followed through all bodies, by their numbers in each body.
    followed: Vec<Vec<usize>>,
    /// The other coordinates of each body.
    apart: Vec<Vec<usize>>,
}

impl Interpolant {
    /// Finds the correspondence for several bodies in the order of the parameter.
    pub fn new(bodies: &[&Response]) -> Self {
        let count = bodies.first().map_or(0, |first| first.coordinates());
        let mut followed: Vec<Vec<usize>> = (0..count).map(|k| vec![k]).collect();
        for pair in bodies.windows(2) {
            let next = pair[0].tracked_in(pair[1]);
            followed.retain_mut(|one| match one.last().and_then(|last| next[*last]) {
                Some(number) => {
                    one.push(number);
                    true
                }
                None => false,
            });
        }
        if bodies.len() < 2 {
            followed.clear();
        }
        let apart = (0..bodies.len()).map(|body| {
            let mut is_apart = vec![true; bodies[body].coordinates()];
            followed.iter().for_each(|one| is_apart[one[body]] = false);
            (0..is_apart.len()).filter(|&k| is_apart[k]).collect()
        });
        let apart: Vec<Vec<usize>> = apart.collect();
        let alone: usize = apart.iter().map(Vec::len).sum();
        tracing::debug!(followed = followed.len(), apart = alone, "coordinates between bodies");
        Self { apart, followed }
    }

    /// Returns the body whose response is the sum of the responses of these bodies, with weights whose sum is 1. It has
    /// no energies.
    pub fn sum(&self, all: &[&Response], weights: &[f64]) -> ModalBody {
        let zero = Complex::new(0.0, 0.0);
        let bodies = || all.iter().zip(weights.iter().copied());
        let vectors = all.first().map_or(0, |first| first.places.nrows());
        let count = self.followed.len() + self.apart.iter().map(Vec::len).sum::<usize>();
        let mut places = DMatrix::from_element(vectors, count, zero);
        let mut modes = Vec::with_capacity(count);
        let mode = |rate, output, input: f64| Mode { rate, input: Complex::new(input, 0.0), load: zero, output };
        for (numbers, mut column) in self.followed.iter().zip(places.column_iter_mut()) {
            let (mut decay, mut frequency, mut output) = (MeanDecay::new(all[0].end), 0.0, zero);
            for ((body, weight), &number) in bodies().zip(numbers) {
                let (rate, of_output) = body.modes[number];
                decay.add(-rate.re, weight);
                frequency += rate.im * weight;
                output += of_output * weight;
                column.zip_apply(&body.places.column(number), |sum, entry| *sum += entry * weight);
            }
            modes.push(mode(Complex::new(-decay.rate(), frequency), output, 1.0));
        }
        for ((body, weight), numbers) in bodies().zip(&self.apart) {
            for &number in numbers {
                places.set_column(modes.len(), &body.places.column(number));
                // z is proportional to the weight, and so are all results that depend on z.
                let (rate, output) = body.modes[number];
                modes.push(mode(rate, output, weight));
            }
        }
        let (mut shapes, mut free, mut residual, mut compliance) = (Shapes::zero(vectors), Free::default(), 0.0, 0.0);
        shapes.moving = DMatrix::identity(vectors, vectors);
        let mut hit_stress = (DMatrix::zeros(all[0].hit_stress.0.nrows(), vectors), [0.0; 3]);
        for (body, weight) in bodies() {
            let Shapes { free: of_free, residual: of_residual, .. } = &body.others;
            shapes.free.iter_mut().zip(of_free).for_each(|(sum, free)| sum.axpy(weight, free, 1.0));
            shapes.residual.axpy(weight, of_residual, 1.0);
            free.mobility += weight * body.free.mobility;
            residual += weight * body.residual;
            compliance += weight * body.compliance;
            hit_stress.0 += &body.hit_stress.0 * weight;
            hit_stress.1.iter_mut().zip(body.hit_stress.1).for_each(|(sum, local)| *sum += weight * local);
        }
        let hit_stress = (hit_stress.0.nrows() > 0).then(|| (shapes.mapped(&hit_stress.0), hit_stress.1));
        let forms = Forms { damped: Some([places, DMatrix::zeros(0, count)].map(BlockMatrix::whole)), ..Forms::none() };
        let modes = Modes { modes, free, residual, rest: 0.0, forms, shapes, hit_stress, foundation: None };
        let mut body = ModalBody::given(modes);
        (body.compliance, body.multiplicity, body.footprint) = (compliance, all[0].multiplicity, all[0].footprint);
        body
    }
}

/// Decay rate λ of a vibration, interpolated between bodies. Damping changes with temperature by orders of magnitude, so
/// that a polynomial in λ may become negative. The logarithm of λT + [`NEGLIGIBLE_DECAY`] is interpolated, where T is the
/// duration of the run, and kept above its smallest value.
struct MeanDecay {
    end: f64,
    mean: f64,
    smallest: f64,
}

impl MeanDecay {
    fn new(end: f64) -> Self {
        Self { end, mean: 0.0, smallest: f64::INFINITY }
    }

    /// Adds the rate of one body, 1/s, with its weight.
    fn add(&mut self, rate: f64, weight: f64) {
        let logarithm = ((rate * self.end).max(0.0) + NEGLIGIBLE_DECAY).ln();
        self.mean += weight * logarithm;
        self.smallest = self.smallest.min(logarithm);
    }

    /// The interpolated rate, 1/s.
    fn rate(&self) -> f64 {
        (self.mean.max(self.smallest).exp() - NEGLIGIBLE_DECAY).max(0.0) / self.end
    }
}

/// Which modes move the impact point noticeably.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noticeable {
    /// Duration of a contact, s.
    pub contact: f64,
    /// Duration of the run, s.
    pub end: f64,
    /// Largest part of the motion that all other modes together may have.
    pub left_out: f64,
}

impl Noticeable {
    /// Returns the numbers of the modes that are noticeable within a contact or within the run. (A slow mode, such as
    /// that of a rigid body on soft supports, moves the impact point furthest within the run, but hardly within a
    /// contact.)
    fn of(&self, modes: &[Mode]) -> Vec<usize> {
        let mut is_noticeable = vec![false; modes.len()];
        for time in [self.contact, self.end] {
            let mut order: Vec<(f64, usize)> = modes.iter().map(|mode| reach(mode, time)).zip(0..).collect();
            order.sort_by(|a, b| a.0.total_cmp(&b.0));
            let all: f64 = order.iter().map(|(reach, _)| reach).sum();
            let mut sum = 0.0;
            for (reach, number) in order {
                // (All creep motions are kept; common rates replace them by a few.)
                let is_creep = modes[number].rate.im == 0.0;
                sum += if is_creep { 0.0 } else { reach };
                is_noticeable[number] |= is_creep || sum > self.left_out * all;
            }
        }
        (0..modes.len()).filter(|&number| is_noticeable[number]).collect()
    }
}

/// Bound, to a factor of about 1, for the displacement of the impact point within a time (s) of a unit force: the
/// integral of e^{σt} (Re c · cos ωt − Im c · sin ωt), where c is the product of output and input.
fn reach(mode: &Mode, time: f64) -> f64 {
    let (amplitude, rate) = (mode.output * mode.input, mode.rate.norm());
    let time = time.min(1.0 / rate);
    (amplitude.re.abs() + amplitude.im.abs() * rate * time) * time
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mode of a rigid body on soft springs moves furthest within the run. It does not hide a vibration that counts
    /// within a contact, however soft the springs are; a vibration that counts nowhere is left out.
    #[test]
    fn soft_springs_hide_no_vibration() {
        let contact = 1e-4;
        let noticeable = Noticeable { contact, end: 1e-2, left_out: 1e-4 };
        for spring_rate in [1e1, 1e2, 1e3] {
            // sin(ωt)/(mω) for a unit impulse, with m in kg.
            let mode = |rate: f64, mass: f64| Mode {
                rate: Complex::new(0.0, rate),
                input: Complex::new(1.0, 0.0),
                load: Complex::new(0.0, 0.0),
                output: Complex::new(0.0, -1.0 / (mass * rate)),
            };
            let modes = [mode(spring_rate, 1.0), mode(1.0 / contact, 20.0), mode(10.0 / contact, 2e4)];
            assert_eq!(noticeable.of(&modes), [0, 1], "{spring_rate}");
        }
    }

    /// Damping that grows by orders of magnitude from body to body stays positive between them, and close to its true
    /// value where it matters within the run.
    #[test]
    fn damping_stays_positive() {
        let nodes: [f64; 4] = [0.0, 1.0, 2.0, 3.0];
        let rate = |p: f64| 1e-2 * 20.0_f64.powf(p);
        for p in (0..=30).map(|k| 0.1 * f64::from(k)) {
            let mut decay = MeanDecay::new(1.0);
            for node in nodes {
                let others = nodes.into_iter().filter(|other| *other != node);
                decay.add(rate(node), others.map(|other| (p - other) / (node - other)).product());
            }
            // e^{-λt} up to t = 1: interpolation of λ itself errs by more than 1 and amplifies.
            let error = ((-decay.rate()).exp() - (-rate(p)).exp()).abs();
            assert!(decay.rate() > 0.0 && error < 1e-2, "{p}: {} {}", decay.rate(), rate(p));
        }
    }

    /// Where damping begins abruptly, its logarithm undershoots by orders of magnitude; the rate stays at its smallest value.
    #[test]
    fn damping_does_not_undershoot() {
        let mut decay = MeanDecay::new(1.0);
        // Weights of Lagrange's interpolation at 0.5 between 0, 1, 2 and 3.
        for (rate, weight) in [(1.0, 0.3125), (1.0, 0.9375), (1e5, -0.3125), (1e5, 0.0625)] {
            decay.add(rate, weight);
        }
        assert!((decay.rate() - 1.0).abs() < 1e-12, "{}", decay.rate());
    }

    /// A vibration that is followed through all bodies becomes one coordinate, with rate and residue of the parameter
    /// in between. Creep motions are taken from each body, scaled by its weight.
    #[test]
    fn vibrations_go_on() {
        let number = Complex::new;
        let rate = |p: f64| number(NEGLIGIBLE_DECAY - (0.1 * p).exp(), 10.0 + 0.3 * p * p);
        let output = |p: f64| number(0.2 * p * p * p, -1.0);
        let body = |p: f64| {
            let mut others = Shapes::zero(3);
            others.residual[2] = p;
            Response {
                end: 1.0,
                modes: vec![(rate(p), output(p)), (number(-p - 1.0, 0.0), number(0.1, 0.0))],
                places: DMatrix::from_fn(3, 2, |i, k| number((i + k) as f64 + 0.1 * p, 1.0 - k as f64)),
                free: Free::default(),
                residual: p,
                others,
                hit_stress: (DMatrix::zeros(0, 3), [0.0; 3]),
                compliance: 1.0,
                multiplicity: 4.0,
                footprint: Footprint::Point,
            }
        };
        let bodies = [0.0, 1.0, 2.0, 3.0].map(body);
        let all: Vec<&Response> = bodies.iter().collect();
        // Weights of Lagrange's interpolation at the midpoint.
        let weights = [-0.0625, 0.5625, 0.5625, -0.0625];
        let between = Interpolant::new(&all);
        assert_eq!((between.followed.len(), between.apart.iter().map(Vec::len).sum::<usize>()), (1, 4));
        let sum = between.sum(&all, &weights);
        let closed = crate::body::Closed { tangent: 1.0, compliance: 0.0, mass: 1.0, accuracy: 1e-3, end: 1.0 };
        let modes = sum.modes(1.0, &closed).expect("modes");
        let [first, rest @ ..] = &modes.modes[..] else { panic!("modes") };
        // Cubic functions are exact, to rounding.
        assert!((first.rate - rate(1.5)).norm() < 1e-13 && (first.output - output(1.5)).norm() < 1e-13);
        assert!((modes.residual - 1.5).abs() < 1e-14 && sum.multiplicity == 4.0);
        let inputs: Vec<f64> = rest.iter().map(|mode| mode.input.re).collect();
        assert_eq!(inputs, weights);
        // With a single nonzero weight, the result is that body.
        let one = between.sum(&all, &[0.0, 1.0, 0.0, 0.0]).modes(1.0, &closed).expect("modes");
        assert!((one.modes[0].rate - rate(1.0)).norm() == 0.0 && one.residual == 1.0);
    }
}
