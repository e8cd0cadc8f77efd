//! A linear body reduced to a basis of few vectors, orthonormal in its mass.

use std::convert::Infallible;

use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::CsrMatrix;

use super::{BodyTerms, FoundationPoints, System};
use crate::material::Maxwell;

/// Reduced body ÿ + C ẏ + (K_e + K_s) y = a F + f on a basis V with VᵀMV = 1, so that u = V y.
///
/// Bases are nested: the first vectors of a basis form a basis too ([`Projection::leading`]).
#[derive(Debug, Clone)]
pub struct Projection {
    /// Operators, loads, contact port and readings on the basis. `translation` is VᵀMt of the unit translation t; it is zero
    /// unless the basis contains this translation.
    pub terms: BodyTerms<DMatrix<f64>, DVector<f64>>,
    /// Shift s at which the basis was made, 1/s.
    pub rate: f64,
    /// Shift s, 1/s, if stresses are read by mode acceleration: the basis has a single source and shift.
    pub mode_acceleration: Option<f64>,
    /// Unilateral foundations, whose springs are included in `support`.
    pub foundation: Option<FoundationPoints>,
}

impl Projection {
    /// Returns the reduced body as a system with the unknowns y, for time integration without modes.
    pub fn system(&self) -> System {
        let terms = self.terms.map(|_, matrix| with_zeros(matrix), |vector| vector.as_slice().to_vec());
        System {
            mass: CsrMatrix::identity(self.vectors()),
            terms: BodyTerms {
                // Springs without stiffness hold nothing.
                support: terms.support.filter(|support| support.values().iter().any(|entry| *entry != 0.0)),
                infinite_plate: None,
                ..terms
            },
            pads: Vec::new(),
            held: Vec::new(),
            exchange: None,
            is_nearly_incompressible: false,
            classes: 1,
        }
    }

    /// Returns K + G̃(s) D at the shift of the basis, supports included, 1/s².
    pub fn stiffness_at_rate(&self) -> DMatrix<f64> {
        self.stiffness_at(self.rate)
    }

    /// Returns K + G̃(s) D at any rate s (1/s), supports included, 1/s².
    pub fn stiffness_at(&self, rate: f64) -> DMatrix<f64> {
        let BodyTerms { elastic, support, relaxations, .. } = &self.terms;
        let supported = support.iter().fold(elastic.clone(), |sum, support| sum + support);
        relaxations.iter().fold(supported, |sum, part| sum + &part.distortion * part.chain.transformed_terms(rate))
    }

    /// Returns the body with other Prony series for its viscoelastic parts, in the same order.
    #[must_use]
    pub fn with_chains(&self, chains: &[Maxwell]) -> Self {
        let mut changed = self.clone();
        let BodyTerms { elastic, relaxations, .. } = &mut changed.terms;
        for (part, chain) in relaxations.iter_mut().zip(chains) {
            let rise = chain.equilibrium - part.chain.equilibrium;
            *elastic += &part.distortion * rise;
            part.chain = chain.clone();
        }
        changed
    }

    /// Number of vectors of the basis.
    pub fn vectors(&self) -> usize {
        self.terms.contact.force.len()
    }

    /// Whether loads act on the body.
    pub fn is_loaded(&self) -> bool {
        self.terms.load.amax() > 0.0 || self.terms.support_load.amax() > 0.0
    }

    /// Returns the body with supports interpolated linearly between this body (`part` 0) and another one (`part` 1).
    pub(super) fn towards(&self, other: &Self, part: f64) -> Self {
        let zeros = DMatrix::zeros(self.vectors(), self.vectors());
        let matrix = |_, of: &[Option<&DMatrix<f64>>]| {
            let [from, to] = [of[0].unwrap_or(&zeros), of[1].unwrap_or(&zeros)];
            Ok::<_, Infallible>(from + (to - from) * part)
        };
        let number = |of: &[f64]| of[0] + (of[1] - of[0]) * part;
        let vector = |of: &[&DVector<f64>]| Ok(of[0] + (of[1] - of[0]) * part);
        let Ok(mut terms) = BodyTerms::try_combine(&[&self.terms, &other.terms], matrix, vector, number);
        terms.damping = terms.damping.filter(|damping| damping.amax() > 0.0);
        Self { terms, ..self.clone() }
    }

    /// Returns the same body on the first `count` vectors of the basis.
    pub fn leading(&self, count: usize) -> Self {
        let square = |_, matrix: &DMatrix<f64>| matrix.view((0, 0), (count, count)).into_owned();
        Self {
            terms: self.terms.map(square, |vector| vector.rows(0, count).into_owned()),
            rate: self.rate,
            mode_acceleration: self.mode_acceleration,
            foundation: self.foundation.as_ref().map(|points| points.leading(count)),
        }
    }
}

/// Converts a matrix to sparse format with all entries, zeros included, because M adds to each of them.
fn with_zeros(matrix: &DMatrix<f64>) -> CsrMatrix<f64> {
    let (rows, columns) = matrix.shape();
    let offsets = (0..=rows).map(|row| row * columns).collect();
    let numbers = (0..rows).flat_map(|_| 0..columns).collect();
    let entries = matrix.transpose().as_slice().to_vec();
    CsrMatrix::try_from_csr_data(rows, columns, offsets, numbers, entries).expect("rows in order, columns ascending")
}
