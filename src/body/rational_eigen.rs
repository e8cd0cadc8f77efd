//! Eigenpairs of (λ² + K + g(λ) D) φ = 0, g = Σ G_i λτ_i/(1 + λτ_i): the free motions of a body with one relaxing chain.
//!
//! Each pair is found by itself, by inverse iteration with the Rayleigh functional (Ruhe, SIAM J. Numer. Anal. 10, 1973, for T(λ) = Tᵀ): from each mode of a given modulus a vibration, and in each interval between
//! two poles −1/τ_i, over which g falls from ∞ to −∞, a real one for each direction of D. From there on λ² changes them little. A pair that
//! is found twice means another one that is missing: whether all are there, the sums Σ λ φφᵀ/(φᵀT′φ) = 1 and −Σ λ⁻¹ φφᵀ/(φᵀT′φ) = K⁻¹
//! tell; and what the first of them lacks is the missing pair's, which is sought from there. The cost of a pair is the cube of the number of modes, where that of the first-order system is the cube of that times the number of terms.

use nalgebra::{Cholesky, Complex, ComplexField, DMatrix, DVector, Dyn};

use super::axpy::Entry;
use super::dense_solve::solved;
use super::eigen::symmetric_eigen;
use super::secular_eigen::Secular;
use crate::material::Maxwell;

/// Iterations for one pair: convergence is cubic.
pub(super) const MOST: usize = 12;

/// A change of λ over λ after which one iteration more leaves rounding.
const CLOSE: f64 = 1e-6;

/// Iterations end when the relative change of λ is below this. Pairs that lie close together take more of them.
const SETTLED: f64 = 1e-10;

/// How the iterations for a pair go.
#[derive(Debug)]
pub(super) struct Settling {
    /// Whether λ is near enough for one turn more, which makes φ as good as λ.
    pub is_found: bool,
    /// The last change of λ over λ.
    last: f64,
}

impl Settling {
    pub fn new() -> Self {
        Self { is_found: false, last: f64::INFINITY }
    }

    /// Takes the next change of λ over λ: whether it is the last one, for it is small, or rounding keeps it from falling.
    pub fn ends(&mut self, part: f64) -> bool {
        let ends = part.is_nan() || self.is_found && (part <= SETTLED || part >= self.last);
        self.is_found |= part <= CLOSE;
        self.last = part;
        ends
    }
}

/// Directions on which the chain has less than this part of the stiffness creep by nothing.
pub(super) const IDLE: f64 = 1e-10;

/// What the sums of all pairs may be off by.
const COMPLETE: f64 = 1e-8;

/// Vectors by whose products with the sums these are checked: the fractions of the multiples of these numbers' roots.
const PROBES: [f64; 4] = [2.0, 3.0, 5.0, 7.0];

/// Rates and shapes that differ by less are of one pair found twice.
const ALIKE: f64 = 1e-6;

/// Pairs found twice that are replaced by the missing ones, at most: each takes sums over all pairs.
const MISSING: usize = 12;

/// An eigenpair; one of two that are conjugate, the one with Im λ > 0.
pub struct Pair {
    /// λ, 1/s.
    pub rate: Complex<f64>,
    /// φ.
    pub shape: DVector<Complex<f64>>,
    /// φᵀT′(λ)φ.
    pub slope: Complex<f64>,
}

/// Where a pair was sought.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Vibration,
    /// Between these rates, 1/s, the first of which is a pole.
    Between(f64, f64),
}

/// T(λ).
pub struct Rational<'a> {
    /// K after all relaxation.
    pub stiffness: &'a DMatrix<f64>,
    /// D.
    pub distortion: &'a DMatrix<f64>,
    /// B with D = B Bᵀ, where it has few columns, and ḡ: the unit vectors are modes of K + ḡ D.
    pub factor: Option<(&'a DMatrix<f64>, f64)>,
    /// The terms.
    pub chain: &'a Maxwell,
}

impl Pair {
    /// How many pairs it stands for.
    pub fn count(&self) -> f64 {
        if self.rate.im == 0.0 { 1.0 } else { 2.0 }
    }

    /// Whether it is another one found again.
    fn is(&self, other: &Self) -> bool {
        let close = (self.rate - other.rate).norm() <= ALIKE * self.rate.norm();
        // Shapes are of unit length, and equal but for a factor of modulus 1.
        close && self.shape.dotc(&other.shape).norm() >= 1.0 - ALIKE
    }
}

impl Rational<'_> {
    /// All pairs; `squares` are those of the unit vectors as modes of a mean modulus. `None` where some are not found.
    pub fn pairs(&self, squares: &DVector<f64>) -> Option<Vec<Pair>> {
        let count = squares.len();
        let factor = self.stiffness.clone().cholesky()?;
        let secular = self.factor.map(|(factor, modulus)| Secular::new(squares, factor, modulus));
        let mut found = Vec::new();
        for (j, square) in squares.iter().enumerate() {
            if let Some(pair) = secular.as_ref().and_then(|secular| secular.vibration(j, self)) {
                found.push((pair, Place::Vibration));
                continue;
            }
            let shape = DVector::from_fn(count, |i, _| Complex::new(f64::from(u8::from(i == j)), 0.0));
            found.push((self.vibration(square.sqrt(), shape)?, Place::Vibration));
        }
        let mut times: Vec<f64> = self.chain.terms.iter().map(|term| term.time).collect();
        times.sort_by(|a, b| b.total_cmp(a));
        let mut slower = 0.0;
        for pole in times.into_iter().map(|time| -1.0 / time) {
            let place = Place::Between(pole, slower);
            if let Some(pairs) = secular.as_ref().and_then(|secular| secular.creeping((pole, slower), self)) {
                found.extend(pairs.into_iter().map(|pair| (pair, place)));
            } else {
                for (rate, shape) in self.creeping(pole, slower)? {
                    found.push((self.creep(rate, shape, (pole, slower))?, place));
                }
            }
            slower = pole;
        }
        let pairs = self.without_repetition(found, squares)?;
        self.are_complete(&pairs, &factor).then_some(pairs)
    }

    /// The vibration near a frequency, rad/s; `None` where it is none.
    fn vibration(&self, frequency: f64, shape: DVector<Complex<f64>>) -> Option<Pair> {
        self.refined(Complex::new(0.0, frequency), shape).filter(|pair| pair.rate.im > 0.0)
    }

    /// The real pair near a rate, between two.
    fn creep(&self, rate: f64, shape: DVector<f64>, (pole, slower): (f64, f64)) -> Option<Pair> {
        self.refined(rate, shape).filter(|pair| pair.rate.re > pole && pair.rate.re < slower)
    }

    /// Each pair once, the missing ones in the place of those found twice; `None` where these are not found.
    fn without_repetition(&self, found: Vec<(Pair, Place)>, squares: &DVector<f64>) -> Option<Vec<Pair>> {
        let mut pairs: Vec<Pair> = Vec::with_capacity(found.len());
        let mut begin = 0;
        let (mut last, mut missing) = (Place::Vibration, Vec::new());
        for (pair, place) in found {
            if place != last {
                (last, begin) = (place, pairs.len());
            }
            if pairs[begin..].iter().any(|other| pair.is(other)) { missing.push(place) } else { pairs.push(pair) }
        }
        if missing.len() > MISSING {
            return None;
        }
        // Vibrations, which weigh most, come first.
        for place in missing {
            let (weights, shapes) =
                symmetric_eigen(sum(&pairs, |pair| pair.rate) - DMatrix::identity(squares.len(), squares.len()));
            let heaviest = weights.iamax();
            let shape = shapes.column(heaviest).into_owned();
            let pair = match place {
                Place::Vibration => {
                    let square = shape.component_mul(&shape).dot(squares);
                    self.vibration(square.sqrt(), shape.map(|entry| Complex::new(entry, 0.0)))?
                }
                Place::Between(pole, slower) => {
                    let [stiff, stretched] =
                        [self.stiffness, self.distortion].map(|matrix| shape.dot(&(matrix * &shape)));
                    let rate = self.balanced((pole, slower), |rate, g| rate * rate + stiff + g * stretched);
                    self.creep(rate, shape, (pole, slower))?
                }
            };
            if pairs.iter().any(|other| pair.is(other)) {
                return None;
            }
            pairs.push(pair);
        }
        Some(pairs)
    }

    /// The rate between a pole and a slower one at which a function of the rate and g, which rises from −∞ at the pole, is zero.
    pub(super) fn balanced(&self, (pole, slower): (f64, f64), value: impl Fn(f64, f64) -> f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            let rate = pole + middle * (slower - pole);
            let [g, _] = self.modulus(rate);
            if value(rate, g) < 0.0 { low = middle } else { high = middle }
        }
        pole + 0.5 * (low + high) * (slower - pole)
    }

    /// Real pairs between two poles, with λ² as at the faster one.
    fn creeping(&self, pole: f64, slower: f64) -> Option<Vec<(f64, DVector<f64>)>> {
        let count = self.stiffness.nrows();
        let held = self.stiffness + DMatrix::identity(count, count) * (pole * pole);
        let lower = held.cholesky()?.unpack();
        let half = lower.solve_lower_triangular(self.distortion)?;
        let both = lower.solve_lower_triangular(&half.transpose())?;
        let (values, directions) = symmetric_eigen((&both + both.transpose()) * 0.5);
        let all: f64 = self.chain.terms.iter().map(|term| term.modulus).sum();
        let mut found = Vec::new();
        for (value, direction) in values.iter().zip(directions.column_iter()).filter(|(value, _)| **value * all > IDLE)
        {
            let rate = self.balanced((pole, slower), |_, g| 1.0 + g * value);
            let shape = lower.tr_solve_lower_triangular(&direction.into_owned())?;
            found.push((rate, shape.normalize()));
        }
        Some(found)
    }

    /// g and g′.
    pub(super) fn modulus<T: ComplexField<RealField = f64> + Copy>(&self, rate: T) -> [T; 2] {
        let one = T::one();
        self.chain.terms.iter().fold([T::zero(); 2], |[value, slope], term| {
            let [modulus, time] = [term.modulus, term.time].map(T::from_real);
            let (x, inverse) = (rate * time, one / (one + rate * time));
            [value + modulus * x * inverse, slope + modulus * time * inverse * inverse]
        })
    }

    /// The pair near an approximate one.
    fn refined<T>(&self, mut rate: T, mut shape: DVector<T>) -> Option<Pair>
    where
        T: Entry + Into<Complex<f64>>,
    {
        let [stiffness, distortion] = [self.stiffness, self.distortion].map(|matrix| matrix.map(T::from_real));
        let slope = |rate: T, shape: &DVector<T>, stretched: &DVector<T>| {
            let [_, slope] = self.modulus(rate);
            (rate + rate) * shape.dot(shape) + slope * shape.dot(stretched)
        };
        let mut settling = Settling::new();
        for _ in 0..MOST {
            let [g, of_g] = self.modulus(rate);
            let stretched = &distortion * &shape;
            let mut matrix = &stiffness + &distortion * g;
            (0..shape.len()).for_each(|i| matrix[(i, i)] += rate * rate);
            let turned = &shape * (rate + rate) + &stretched * of_g;
            let mut next = solved(matrix.clone(), turned);
            let length = next.norm();
            if !length.is_finite() {
                // λ is exact.
                break;
            }
            next /= T::from_real(length);
            let stretched = &distortion * &next;
            let change = next.dot(&(&matrix * &next)) / slope(rate, &next, &stretched);
            shape = next;
            rate -= change;
            if settling.ends(change.modulus() / rate.modulus()) {
                break;
            }
        }
        let stretched = &distortion * &shape;
        let slope = slope(rate, &shape, &stretched);
        settling.is_found.then(|| Pair { rate: rate.into(), shape: shape.map(Into::into), slope: slope.into() })
    }

    /// Whether no pair is missing, and none is unsettled: the sums over all pairs, multiplied by some vectors, have to be what is known of them.
    /// What a missing pair leaves of a sum is practically never orthogonal to all of these vectors.
    fn are_complete(&self, pairs: &[Pair], factor: &Cholesky<f64, Dyn>) -> bool {
        let count = self.stiffness.nrows();
        // No two entries of all of these are alike, but for the sign: modes that are found twice for another one are seen too.
        let probes = DMatrix::from_fn(count, PROBES.len(), |i, j| ((i + 1) as f64 * PROBES[j].sqrt()).fract() - 0.5);
        let of_rates = sum_times(pairs, |pair| pair.rate, &probes) - &probes;
        let at_rest = factor.solve(&probes);
        let off = &at_rest + sum_times(pairs, |pair| pair.rate.inv(), &probes);
        of_rates.amax() <= COMPLETE && off.amax() <= COMPLETE * at_rest.amax()
    }
}

/// Re Σ f φφᵀ/(φᵀT′φ) over all pairs, conjugate ones counted.
fn sum(pairs: &[Pair], factor: impl Fn(&Pair) -> Complex<f64>) -> DMatrix<f64> {
    let count = pairs.first().map_or(0, |pair| pair.shape.len());
    sum_times(pairs, factor, &DMatrix::identity(count, count))
}

/// The same times vectors, by columns.
fn sum_times(pairs: &[Pair], factor: impl Fn(&Pair) -> Complex<f64>, vectors: &DMatrix<f64>) -> DMatrix<f64> {
    let count = vectors.nrows();
    // Re f φφᵀ = Re(f φ) Re φᵀ − Im(f φ) Im φᵀ, as products of matrices.
    let scaled: Vec<_> = pairs.iter().map(|pair| &pair.shape * (factor(pair) * pair.count() / pair.slope)).collect();
    let part = |of: &dyn Fn(usize, usize) -> f64| DMatrix::from_fn(count, pairs.len(), |i, k| of(k, i));
    part(&|k, i| scaled[k][i].re) * part(&|k, i| pairs[k].shape[i].re).tr_mul(vectors)
        - part(&|k, i| scaled[k][i].im) * part(&|k, i| pairs[k].shape[i].im).tr_mul(vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Term;

    /// A vibration and a creeping pair found twice are replaced by the pairs that they stood in the place of.
    #[test]
    fn missing_pairs_are_found() {
        let count = 6;
        let squares = DVector::from_fn(count, |i, _| [1.0, 2.0, 2.2, 5.0, 9.0, 9.5][i]);
        // Of full rank, and a good part of the stiffness.
        let distortion = DMatrix::from_fn(count, count, |i, j| {
            let together = 0.1 / (1.0 + (i as f64 - j as f64).powi(2));
            together * (squares[i] * squares[j]).sqrt()
        });
        let terms = [(0.8, 0.3), (0.5, 20.0)].map(|(modulus, time)| Term { modulus, time });
        let chain = Maxwell { equilibrium: 0.0, terms: terms.to_vec() };
        let stiffness = DMatrix::from_diagonal(&squares) - &distortion * chain.transformed_terms(3.0);
        let rational = Rational { stiffness: &stiffness, distortion: &distortion, factor: None, chain: &chain };
        let all = rational.pairs(&squares).expect("all pairs");
        assert_eq!(all.len(), count + 2 * count);
        let place = |number: usize| match number / count {
            0 => Place::Vibration,
            1 => Place::Between(-1.0 / 20.0, 0.0),
            _ => Place::Between(-1.0 / 0.3, -1.0 / 20.0),
        };
        let again = |number: usize| {
            let Pair { rate, shape, slope } = &all[number];
            Pair { rate: *rate, shape: shape.clone(), slope: *slope }
        };
        let place_of_creep = 2 * count;
        for lost in [vec![1], vec![place_of_creep + 3], vec![4, place_of_creep]] {
            // Each that is lost was found as the one after it.
            let found = (0..all.len()).map(|k| (again(if lost.contains(&k) { k + 1 } else { k }), place(k)));
            let pairs = rational.without_repetition(found.collect(), &squares).expect("the missing pairs");
            assert_eq!(pairs.len(), all.len());
            for number in lost {
                assert!(pairs.iter().any(|pair| pair.is(&all[number])), "{number}");
            }
        }
    }

    /// Each pair of modes that lie close together, and relax in few directions, solves its equation, by a product with the whole matrix.
    #[test]
    fn close_pairs_settle() {
        let count = 24;
        let squares = DVector::from_fn(count, |i, _| (1.0 + (i / 2) as f64).powi(2) * (1.0 + 0.01 * (i % 2) as f64));
        let factor = DMatrix::from_fn(count, 4, |i, j| 0.05 * squares[i].sqrt() * ((3 * i * (j + 1) + j) as f64).sin());
        let terms = [(0.8, 0.03), (0.6, 0.4), (0.5, 20.0)].map(|(modulus, time)| Term { modulus, time });
        let chain = Maxwell { equilibrium: 0.0, terms: terms.to_vec() };
        let (distortion, modulus) = (&factor * factor.transpose(), chain.transformed_terms(3.0));
        let stiffness = DMatrix::from_diagonal(&squares) - &distortion * modulus;
        let factor = Some((&factor, modulus));
        let rational = Rational { stiffness: &stiffness, distortion: &distortion, factor, chain: &chain };
        let pairs = rational.pairs(&squares).expect("all pairs");
        assert_eq!(pairs.len(), count + 3 * 4);
        for Pair { rate, shape, .. } in &pairs {
            let [g, _] = rational.modulus(*rate);
            let real = |matrix: &DMatrix<f64>| matrix.map(|entry| Complex::new(entry, 0.0)) * shape;
            let (held, stretched) = (real(&stiffness), real(&distortion) * g);
            let off = &held + &stretched + shape * (rate * rate);
            // Rounding of sums in which the largest terms cancel: 1e-13 was found.
            let size = held.norm() + stretched.norm() + rate.norm_sqr();
            assert!(off.norm() < 1e-11 * size, "{rate}: {:e}", off.norm() / size);
        }
    }
}
