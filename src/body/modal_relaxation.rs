//! A viscoelastic part in modal coordinates, with the directions in which each term of the Prony series relaxes.

use nalgebra::{DMatrix, DVector};

use super::Relaxation;
use super::eigen::semidefinite_factor;
use super::relaxing_directions::{Directions, left_out};
use crate::material::{Maxwell, Term};

/// Cost of one eigenpair, in units of r² n operations for n modes and r directions, relative to the cost of the
/// first-order system, in units of its size cubed. Measured with 100 to 1500 unknowns: 0.5 to 0.7.
const PAIR_COST: f64 = 0.6;

/// A viscoelastic part in the real coordinates of the modes.
#[derive(Debug, Clone)]
pub struct ModalRelaxation {
    /// D in modal coordinates.
    pub distortion: DMatrix<f64>,
    /// B with D = B Bᵀ, if few directions relax.
    pub directions: Option<Directions>,
    /// Prony series of the part.
    pub chain: Maxwell,
    /// The modes were computed with the modulus at this rate, 1/s.
    pub rate: f64,
}

impl ModalRelaxation {
    /// Projects a viscoelastic part onto modes (columns of `vectors`), which were computed with the modulus at a rate
    /// (1/s).
    pub fn new(part: &Relaxation<DMatrix<f64>>, vectors: &DMatrix<f64>, rate: f64) -> Self {
        let distortion = vectors.tr_mul(&(&part.distortion * vectors));
        Self { distortion, directions: None, chain: part.chain.clone(), rate }
    }

    /// Restricts the part to some of the modes.
    pub fn select(&self, modes: &[usize]) -> Self {
        let distortion = self.distortion.select_rows(modes).select_columns(modes);
        Self { distortion, directions: None, chain: self.chain.clone(), rate: self.rate }
    }

    /// Restricts relaxation to the directions that an accuracy requires, for a run of length `end` (s) and modes of the
    /// given amplitudes. The other directions keep the modulus of the modes. `None` if no term relaxes.
    pub fn in_few_directions(self, amplitudes: &DVector<f64>, end: f64, accuracy: f64) -> Option<Self> {
        let left_out = left_out(&self.chain, self.rate, end, accuracy);
        match Directions::new(&self.distortion, amplitudes, &left_out) {
            Some(directions) => self.in_directions(directions, |_| true),
            None => Some(self),
        }
    }

    /// Keeps the terms that relax in some directions and whose number of directions satisfies a condition.
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

    /// Restricts the part to one class of modes, which relax independently of all others. `None` if they do not relax.
    pub fn of_class(&self, modes: &[usize]) -> Option<Self> {
        let part = self.select(modes);
        match &self.directions {
            None => Some(part).filter(|part| part.distortion.amax() > 0.0),
            Some(directions) => part.in_directions(directions.of_class(modes), |_| true),
        }
    }

    /// Returns B with D = B Bᵀ.
    pub fn factor(&self) -> DMatrix<f64> {
        self.directions.as_ref().map_or_else(|| semidefinite_factor(&self.distortion), |few| few.factor.clone())
    }

    /// Splits the part into parts whose terms relax in the same directions.
    pub fn parts(&self) -> Vec<Self> {
        let Some(directions) = &self.directions else { return vec![self.clone()] };
        let mut counts = directions.counts.clone();
        counts.sort_unstable();
        counts.dedup();
        let part = |count| self.in_directions(directions.clone(), |own| own == count);
        counts.into_iter().filter_map(part).collect()
    }

    /// Returns the modulus of the terms in the modes, Σ G_i sτ_i/(1 + sτ_i), Pa.
    pub fn modulus(&self) -> f64 {
        self.chain.transformed_terms(self.rate)
    }

    /// Whether eigenpairs are cheaper one by one, with all terms in the largest set of directions, than by the
    /// first-order system.
    pub fn is_quicker_by_pairs(&self) -> bool {
        let (modes, terms) = (self.distortion.nrows(), self.chain.terms.len());
        let counts = self.directions.as_ref().map_or_else(|| vec![modes; terms], |few| few.counts.clone());
        let most = counts.iter().copied().max().unwrap_or(0);
        let by_pairs = PAIR_COST * (modes * most * most * (modes + terms * most)) as f64;
        by_pairs < ((2 * modes + counts.iter().sum::<usize>()) as f64).powi(3)
    }
}
