//! Factors from the difference between two bases to their errors, measured on bodies of each kind.

use crate::body::{LinearBody, Start, rates};

/// Factors from the difference of the forces on two bases to their errors.
#[derive(Debug, Clone, Copy)]
pub struct ErrorFactors {
    /// Error of the smaller basis over the difference.
    pub smaller: f64,
    /// Error of the larger basis over the difference; `None` if the larger basis is used only for the estimate.
    pub larger: Option<f64>,
}

impl ErrorFactors {
    /// For an elastic body, if the larger basis has half as many vectors more, and at least nine more. With 10 to 90
    /// vectors on 141 plates and solids, the error of the smaller basis was measured to be 0.6 to 1.42 times the
    /// difference for the force, with a median of 0.98. For the tension it was 0.5 to 1.5 times in 98 of 100 cases.
    ///
    /// The error of the larger basis is 0.05 to 2 times the difference, so it cannot be estimated as well. Therefore the
    /// smaller basis is used.
    pub const ELASTIC: Self = Self { smaller: 1.4, larger: None };

    /// For a viscoelastic body with one shift. With 24 to 120 vectors, the error of the smaller basis was measured to be
    /// 0.7 to 1.2 times the difference on six laminates, and up to 2.0 times on a seventh, which is hit by 52 kg. For the
    /// larger basis, 0.2 to 1.15 was measured.
    pub(super) const VISCOELASTIC: Self = Self { smaller: 2.1, larger: Some(1.5) };

    /// For a strongly relaxing body, which has several shifts. The error falls slowly and irregularly with the number of
    /// vectors. In 40 comparisons on four such laminates with 20 to 180 vectors, it was 0.7 to 2.7 times the difference
    /// for the smaller basis and 0.1 to 1.9 times for the larger one; on a fifth with 200 to 400 vectors, 0.7 to 1.0 times
    /// for the smaller one. The factors have a margin of a fifth. An estimate.
    const STRONGLY_RELAXING: Self = Self { smaller: 3.3, larger: Some(2.3) };

    /// Returns the factors for a body and the initial settings of its basis.
    pub fn of(body: &dyn LinearBody, start: Start) -> Self {
        let chains = body.chains();
        if chains.is_empty() {
            Self::ELASTIC
        } else if rates(&chains, start.shift, start.end).len() == 1 {
            Self::VISCOELASTIC
        } else {
            Self::STRONGLY_RELAXING
        }
    }
}
