//! A relaxation on the modes of a body: the directions in which each of its terms relaxes.

use nalgebra::{DMatrix, DVector};

use super::ProjectedRelaxation;
use super::relaxing_directions::{Directions, left_out};
use crate::material::{Maxwell, Term};

/// What an eigenpair takes, in products of r² n of n modes in r directions, over what the first-order system takes, in products of its size cubed. 0.5
/// to 0.7 was measured with 100 to 1500 unknowns of that.
const OF_PAIR: f64 = 0.6;

/// A relaxation on the real coordinates of modes.
#[derive(Debug, Clone)]
pub struct ModalRelaxation {
    /// D.
    pub distortion: DMatrix<f64>,
    /// B with D = B Bᵀ, where few directions relax.
    pub directions: Option<Directions>,
    /// Its terms.
    pub chain: Maxwell,
    /// The rate with whose modulus the modes were made, 1/s.
    pub rate: f64,
}

impl ModalRelaxation {
    /// A relaxation on modes, by columns, which were made with the modulus at a rate (1/s).
    pub fn new(part: &ProjectedRelaxation, vectors: &DMatrix<f64>, rate: f64) -> Self {
        let part = part.on(|distortion| vectors.tr_mul(&(distortion * vectors)));
        Self { distortion: part.distortion, directions: None, chain: part.chain, rate }
    }

    /// The same on some of the modes.
    pub fn select(&self, modes: &[usize]) -> Self {
        let distortion = self.distortion.select_rows(modes).select_columns(modes);
        Self { distortion, directions: None, chain: self.chain.clone(), rate: self.rate }
    }

    /// The same relaxing in no more directions than an accuracy asks for in a run of a length (s), with modes of the given amplitudes. In the others it
    /// keeps the modulus of the modes. `None` where no term relaxes.
    pub fn in_few_directions(self, amplitudes: &DVector<f64>, end: f64, accuracy: f64) -> Option<Self> {
        let left_out = left_out(&self.chain, end, accuracy);
        match Directions::new(&self.distortion, amplitudes, &left_out) {
            Some(directions) => self.in_directions(directions, |_| true),
            None => Some(self),
        }
    }

    /// With those terms that relax in some directions, and of whose numbers of directions something is true.
    fn in_directions(&self, directions: Directions, takes: impl Fn(usize) -> bool) -> Option<Self> {
        let Directions { factor, counts } = directions;
        let terms = self.chain.terms.iter().zip(counts).filter(|(_, count)| *count > 0 && takes(*count));
        let (terms, counts): (Vec<Term>, Vec<usize>) = terms.unzip();
        let most = counts.iter().copied().max()?;
        let factor = factor.columns(0, most).into_owned();
        let chain = Maxwell { terms, ..self.chain };
        let distortion = &factor * factor.transpose();
        Some(Self { distortion, directions: Some(Directions { factor, counts }), chain, rate: self.rate })
    }

    /// The same of some modes, which no others relax with.
    pub fn of_class(&self, modes: &[usize]) -> Option<Self> {
        let part = self.select(modes);
        match &self.directions {
            None => Some(part).filter(|part| part.distortion.amax() > 0.0),
            Some(directions) => part.in_directions(directions.of_class(modes), |_| true),
        }
    }

    /// The parts whose terms relax in the same directions.
    pub fn parts(&self) -> Vec<Self> {
        let Some(directions) = &self.directions else { return vec![self.clone()] };
        let mut counts = directions.counts.clone();
        counts.sort_unstable();
        counts.dedup();
        let part = |count| self.in_directions(directions.clone(), |own| own == count);
        counts.into_iter().filter_map(part).collect()
    }

    /// Σ G_i sτ_i/(1 + sτ_i) of the modulus that the modes have, Pa.
    pub fn modulus(&self) -> f64 {
        self.chain.transformed_terms(self.rate)
    }

    /// Whether finding pair by pair, all terms in the directions of that which has most, takes less than the eigenvectors of the first-order system.
    pub fn is_quicker_by_pairs(&self) -> bool {
        let (modes, terms) = (self.distortion.nrows(), self.chain.terms.len());
        let counts = self.directions.as_ref().map_or_else(|| vec![modes; terms], |few| few.counts.clone());
        let most = counts.iter().copied().max().unwrap_or(0);
        let by_pairs = OF_PAIR * (modes * most * most * (modes + terms * most)) as f64;
        by_pairs < ((2 * modes + counts.iter().sum::<usize>()) as f64).powi(3)
    }
}
