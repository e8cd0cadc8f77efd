//! Bodies that are symmetric under the exchange of the two axes of a square (reflection about the diagonal).
//!
//! A force with the same symmetry excites symmetric motions only, in which u_i equals its partner u_j. This halves the
//! number of unknowns. With z = (u_i + u_j)/√2 for each pair, u = P z and PᵀP = 1. The symmetric motions are a body
//! with the operators PᵀAP and the vectors Pᵀf.

use nalgebra_sparse::CsrMatrix;

use super::System;
use super::deviates::normal;

/// Tolerance of the symmetry test, relative to the largest entry of a vector or to the sum of the absolute terms of a
/// product.
const ROUNDING: f64 = 1e-12;

/// Symmetric motions of a body under the exchange of its axes.
#[derive(Debug, Clone)]
pub struct DiagonalSymmetry {
    /// For each unknown of the body: number of the coordinate z that represents it and its partner, and its weight.
    places: Vec<(usize, f64)>,
    /// The two unknowns of each pair. An unknown can be its own partner.
    pairs: Vec<[usize; 2]>,
}

impl DiagonalSymmetry {
    /// Creates the pairs from the partner of each unknown: its number after the exchange of the axes.
    fn new(partners: &[usize]) -> Self {
        let mut places = vec![(0, 1.0); partners.len()];
        let mut pairs = Vec::new();
        for (first, &partner) in partners.iter().enumerate().filter(|(first, partner)| first <= *partner) {
            let weight = if first == partner { 1.0 } else { 0.5_f64.sqrt() };
            (places[first], places[partner]) = ((pairs.len(), weight), (pairs.len(), weight));
            pairs.push([first, partner]);
        }
        Self { places, pairs }
    }

    /// Returns the symmetric motions and their system, which contains all motions that the force and the loads excite.
    /// `None` if the body is not symmetric, or has several classes, pads or nonzero prescribed displacements.
    pub fn of(system: &System) -> Option<(Self, System)> {
        let exchange = Self::new(system.exchange.as_ref()?);
        let is_plain =
            system.classes == 1 && system.pads.is_empty() && system.held.iter().all(|(_, value)| *value == 0.0);
        if !is_plain {
            return None;
        }
        let terms = &system.terms;
        // Linear forms that are only evaluated need no symmetry.
        let vectors = [&terms.load, &terms.support_load, &terms.contact.force, &terms.translation];
        if !vectors.into_iter().all(|vector| exchange.keeps(vector)) {
            return None;
        }
        let matrix = |_, matrix: &CsrMatrix<f64>| exchange.matrix(matrix).ok_or(());
        let symmetric = System {
            mass: exchange.matrix(&system.mass)?,
            terms: terms.try_map(matrix, |vector| Ok(exchange.form(vector))).ok()?,
            pads: Vec::new(),
            held: exchange.held(&system.held)?,
            exchange: None,
            is_nearly_incompressible: system.is_nearly_incompressible,
            classes: 1,
        };
        Some((exchange, symmetric))
    }

    /// Number of unknowns of the body.
    pub fn unknowns(&self) -> usize {
        self.places.len()
    }

    /// Returns u = P z.
    pub fn whole(&self, symmetric: &[f64]) -> Vec<f64> {
        self.places.iter().map(|(place, weight)| weight * symmetric[*place]).collect()
    }

    /// Returns Pᵀ f.
    fn form(&self, form: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.pairs.len()];
        self.places.iter().zip(form).for_each(|((place, weight), value)| sums[*place] += weight * value);
        sums
    }

    /// Whether a vector is symmetric.
    fn keeps(&self, vector: &[f64]) -> bool {
        let allowed = ROUNDING * vector.iter().fold(0.0_f64, |largest, value| value.abs().max(largest));
        let is_kept = |[first, partner]: &[usize; 2]| (vector[*first] - vector[*partner]).abs() <= allowed;
        self.pairs.iter().all(is_kept)
    }

    /// Returns the constrained coordinates z, if both unknowns of each pair are constrained or both are free.
    fn held(&self, held: &[(usize, f64)]) -> Option<Vec<(usize, f64)>> {
        let mut is_held = vec![false; self.places.len()];
        held.iter().for_each(|(unknown, _)| is_held[*unknown] = true);
        let is_kept = |[first, partner]: &[usize; 2]| is_held[*first] == is_held[*partner];
        let of_pairs = self.pairs.iter().enumerate().filter(|(_, [first, _])| is_held[*first]);
        self.pairs.iter().all(is_kept).then(|| of_pairs.map(|(place, _)| (place, 0.0)).collect())
    }

    /// Returns PᵀAP if A maps symmetric motions to symmetric ones. This is tested with one random symmetric motion.
    fn matrix(&self, matrix: &CsrMatrix<f64>) -> Option<CsrMatrix<f64>> {
        if !self.is_kept_by(matrix) {
            return None;
        }
        let count = self.pairs.len();
        let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        columns.reserve(matrix.nnz() / 2);
        values.reserve(matrix.nnz() / 2);
        // A row of A P, with one bit for each entry that is present.
        let (mut sums, mut found) = (vec![0.0; count], vec![0_u64; count.div_ceil(64)]);
        for [first, partner] in &self.pairs {
            let row = matrix.row(*first);
            for (&j, value) in row.col_indices().iter().zip(row.values()) {
                let (place, weight) = self.places[j];
                found[place / 64] |= 1 << (place % 64);
                sums[place] += weight * value;
            }
            let scale = if first == partner { 1.0 } else { 2.0_f64.sqrt() };
            for (word, bits) in found.iter_mut().enumerate() {
                let mut left = std::mem::take(bits);
                while left != 0 {
                    let place = 64 * word + left.trailing_zeros() as usize;
                    left &= left - 1;
                    columns.push(place);
                    values.push(scale * std::mem::take(&mut sums[place]));
                }
            }
            offsets.push(columns.len());
        }
        let matrix = CsrMatrix::try_from_csr_data(count, count, offsets, columns, values);
        Some(matrix.expect("rows in order, columns ascending"))
    }

    fn is_kept_by(&self, matrix: &CsrMatrix<f64>) -> bool {
        let motion: Vec<f64> = (0..self.pairs.len() as u64).map(normal).collect();
        let motion = self.whole(&motion);
        // Sum of the terms of a product of a row with the motion, each passed through a function.
        let sum = |row: usize, of: fn(f64) -> f64| -> f64 {
            let row = matrix.row(row);
            row.col_indices().iter().zip(row.values()).map(|(&j, value)| of(value * motion[j])).sum()
        };
        self.pairs.iter().filter(|[first, partner]| first != partner).all(|pair| {
            let [one, other] = pair.map(|row| sum(row, |term| term));
            let off = (one - other).abs();
            // The sum of the absolute values is at least that of the terms, and is mostly not needed.
            off <= ROUNDING * one.abs() || off <= ROUNDING * sum(pair[0], f64::abs)
        })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;

    fn sparse(matrix: &DMatrix<f64>) -> CsrMatrix<f64> {
        CsrMatrix::from(matrix)
    }

    /// Energies, norms and linear forms of symmetric motions agree with the whole body.
    #[test]
    fn symmetric_motions_have_the_energy_of_the_whole() {
        let partners = [1, 0, 2, 4, 3];
        let any = DMatrix::from_fn(5, 5, |i, j| normal((5 * i + j) as u64));
        let symmetric = &any + any.transpose();
        let exchanged = DMatrix::from_fn(5, 5, |i, j| symmetric[(partners[i], partners[j])]);
        let (exchange, kept) = (DiagonalSymmetry::new(&partners), symmetric.clone() + exchanged);
        let own = exchange.matrix(&sparse(&kept)).expect("a matrix that the exchange keeps");
        let own = DMatrix::from(&own);
        let motion = DVector::from_vec(vec![0.3, -1.1, 0.7]);
        let whole = DVector::from_vec(exchange.whole(motion.as_slice()));
        // Rounding of about ten terms of size ten.
        assert!((motion.dot(&(&own * &motion)) - whole.dot(&(&kept * &whole))).abs() < 1e-13);
        assert!((motion.norm() - whole.norm()).abs() < 1e-15);
        let form = [0.2, 0.9, 0.5, -0.4, 0.1];
        let read = DVector::from_vec(exchange.form(&form));
        assert!((read.dot(&motion) - DVector::from_row_slice(&form).dot(&whole)).abs() < 1e-15);
        // Matrices, vectors and constraints without the symmetry are rejected.
        assert!(exchange.matrix(&sparse(&symmetric)).is_none());
        assert!(!exchange.keeps(&form) && exchange.keeps(whole.as_slice()));
        assert!(exchange.held(&[(0, 0.0)]).is_none());
        assert_eq!(exchange.held(&[(3, 0.0), (4, 0.0)]), Some(vec![(2, 0.0)]));
    }
}
