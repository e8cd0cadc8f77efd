//! A linear body reduced to a basis of few vectors, orthonormal in its mass.

use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::CsrMatrix;

use super::{FoundationPoints, InfinitePlate, ProjectedRelaxation, System};
use crate::contact::Footprint;
use crate::material::Maxwell;

/// Reduced body ÿ + C ẏ + (K_e + K_s) y = a F + f on a basis V with VᵀMV = 1, so that u = V y.
///
/// Bases are nested: the first vectors of a basis form a basis too ([`Projection::leading`]).
#[derive(Debug, Clone)]
pub struct Projection {
    /// VᵀKV of the elastic body alone, 1/s². Viscoelastic parts contribute their fully relaxed stiffness.
    pub elastic: DMatrix<f64>,
    /// Viscoelastic parts, in addition to `elastic`.
    pub relaxations: Vec<ProjectedRelaxation>,
    /// Shift s at which the basis was made, 1/s.
    pub rate: f64,
    /// Shift s, 1/s, if stresses are read by mode acceleration: the basis has a single source and shift.
    pub mode_acceleration: Option<f64>,
    /// VᵀKV of the elastic supports (11), 1/s².
    pub support: DMatrix<f64>,
    /// VᵀCV of the dampers (13), 1/s; `None` without dampers.
    pub damping: Option<DMatrix<f64>>,
    /// Reduced contact force vector Vᵀa.
    pub force: DVector<f64>,
    /// VᵀMt for the unit translation t along the impactor's direction.
    pub translation: DVector<f64>,
    /// Linear forms of [`System::hit_stress`] on V, one in each row.
    pub hit_stress: DMatrix<f64>,
    /// Same as [`System::local_stress_per_newton`].
    pub local_stress_per_newton: [f64; 3],
    /// Vᵀf of body forces and tractions.
    pub load: DVector<f64>,
    /// Vᵀ∫ k ū of the supports.
    pub support_load: DVector<f64>,
    /// ½ ∫ k ū·ū dS of the supports, J.
    pub support_offset: f64,
    /// Local compliance c_l of the contact law, m/N, of the modelled part.
    pub compliance: f64,
    /// Number of such parts that form the whole.
    pub multiplicity: f64,
    /// Distribution of the contact force on the surface.
    pub footprint: Footprint,
    /// Unilateral foundations, whose springs are included in `support`.
    pub foundation: Option<FoundationPoints>,
    /// Infinite plate that replaces the shortest waves of the plate, if the basis is made for the longer ones only.
    pub infinite_plate: Option<InfinitePlate>,
}

impl Projection {
    /// Returns the reduced body as a system with the unknowns y, for time integration without modes.
    pub fn system(&self) -> System {
        let of = with_zeros;
        let count = self.vectors();
        System {
            mass: CsrMatrix::identity(count),
            elastic: of(&self.elastic),
            relaxations: self.relaxations.iter().map(|part| (of(&part.distortion), part.chain.clone())).collect(),
            support: (self.support.amax() > 0.0).then(|| of(&self.support)),
            damping: self.damping.as_ref().map(of),
            pads: Vec::new(),
            held: Vec::new(),
            load: self.load.as_slice().to_vec(),
            support_load: self.support_load.as_slice().to_vec(),
            support_offset: self.support_offset,
            localization: self.force.as_slice().to_vec(),
            compliance: self.compliance,
            footprint: self.footprint,
            hit_stress: self.hit_stress.row_iter().map(|row| row.iter().copied().collect()).collect(),
            local_stress_per_newton: self.local_stress_per_newton,
            translation: self.translation.as_slice().to_vec(),
            infinite_plate: None,
            exchange: None,
            is_nearly_incompressible: false,
            multiplicity: self.multiplicity,
            classes: 1,
        }
    }

    /// Returns K + G̃(s) D at the shift of the basis, supports included, 1/s².
    pub fn stiffness_at_rate(&self) -> DMatrix<f64> {
        self.stiffness_at(self.rate)
    }

    /// Returns K + G̃(s) D at any rate s (1/s), supports included, 1/s².
    pub fn stiffness_at(&self, rate: f64) -> DMatrix<f64> {
        let elastic = &self.elastic + &self.support;
        let relaxing = self.relaxations.iter();
        relaxing.fold(elastic, |sum, part| sum + &part.distortion * part.chain.transformed_terms(rate))
    }

    /// Returns the body with other Prony series for its viscoelastic parts, in the same order.
    #[must_use]
    pub fn with_chains(&self, chains: &[Maxwell]) -> Self {
        let mut changed = self.clone();
        for (part, chain) in changed.relaxations.iter_mut().zip(chains) {
            let rise = chain.equilibrium - part.chain.equilibrium;
            changed.elastic += &part.distortion * rise;
            part.chain = chain.clone();
        }
        changed
    }

    /// Number of vectors of the basis.
    pub fn vectors(&self) -> usize {
        self.force.len()
    }

    /// Whether loads act on the body.
    pub fn is_loaded(&self) -> bool {
        self.load.amax() > 0.0 || self.support_load.amax() > 0.0
    }

    /// Returns the body with supports interpolated linearly between this body (`part` 0) and another one (`part` 1).
    pub(super) fn towards(&self, other: &Self, part: f64) -> Self {
        let zeros = DMatrix::zeros(self.vectors(), self.vectors());
        let damping = match (&self.damping, &other.damping) {
            (None, None) => None,
            (from, to) => {
                let (from, to) = (from.as_ref().unwrap_or(&zeros), to.as_ref().unwrap_or(&zeros));
                let between = from + (to - from) * part;
                (between.amax() > 0.0).then_some(between)
            }
        };
        Self {
            support: &self.support + (&other.support - &self.support) * part,
            damping,
            support_load: &self.support_load + (&other.support_load - &self.support_load) * part,
            support_offset: self.support_offset + (other.support_offset - self.support_offset) * part,
            ..self.clone()
        }
    }

    /// Iterates over the entries of all arrays.
    pub(super) fn numbers(&mut self) -> impl Iterator<Item = &mut [f64]> {
        let Self {
            elastic,
            relaxations,
            support,
            damping,
            force,
            translation,
            hit_stress,
            local_stress_per_newton,
            load,
            support_load,
            support_offset,
            compliance,
            foundation,
            ..
        } = self;
        let scalars = [support_offset, compliance].map(std::slice::from_mut);
        let of_foundation = foundation.iter_mut().flat_map(FoundationPoints::numbers);
        [Some(elastic), Some(support), Some(hit_stress), damping.as_mut()]
            .into_iter()
            .flatten()
            .chain(relaxations.iter_mut().map(|part| &mut part.distortion))
            .map(|m| m.as_mut_slice())
            .chain([force, translation, load, support_load].map(|v| v.as_mut_slice()))
            .chain(scalars)
            .chain([&mut local_stress_per_newton[..]])
            .chain(of_foundation)
    }

    /// Returns the same body on the first `count` vectors of the basis.
    pub fn leading(&self, count: usize) -> Self {
        let square = |m: &DMatrix<f64>| m.view((0, 0), (count, count)).into_owned();
        let head = |v: &DVector<f64>| v.rows(0, count).into_owned();
        Self {
            elastic: square(&self.elastic),
            relaxations: self.relaxations.iter().map(|part| part.on(square)).collect(),
            rate: self.rate,
            mode_acceleration: self.mode_acceleration,
            support: square(&self.support),
            damping: self.damping.as_ref().map(square),
            force: head(&self.force),
            translation: head(&self.translation),
            hit_stress: self.hit_stress.columns(0, count).into_owned(),
            local_stress_per_newton: self.local_stress_per_newton,
            load: head(&self.load),
            support_load: head(&self.support_load),
            support_offset: self.support_offset,
            compliance: self.compliance,
            multiplicity: self.multiplicity,
            footprint: self.footprint,
            foundation: self.foundation.as_ref().map(|points| points.leading(count)),
            infinite_plate: self.infinite_plate.clone(),
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
