//! A linear body on a basis of few vectors, orthonormal in its mass.

use nalgebra::{DMatrix, DVector};
use nalgebra_sparse::CsrMatrix;

use super::{FoundationPoints, InfinitePlate, ProjectedRelaxation, System};
use crate::contact::Patch;
use crate::material::Maxwell;

/// ÿ + C ẏ + (K_e + K_s) y = a F + f: a body's operators on a basis V with VᵀMV = 1, so that u = V y.
///
/// Bases are nested: the first vectors of one are a basis too ([`Projection::leading`]).
#[derive(Debug, Clone)]
pub struct Projection {
    /// VᵀKV of the elastic body alone, 1/s²: of relaxing parts what is left after all relaxation.
    pub elastic: DMatrix<f64>,
    /// What relaxes beside that.
    pub relaxations: Vec<ProjectedRelaxation>,
    /// s, 1/s: the rate at which the basis was made.
    pub rate: f64,
    /// VᵀKV of the elastic supports (11), 1/s².
    pub support: DMatrix<f64>,
    /// VᵀCV of the dampers (13), 1/s; `None` without dampers.
    pub damping: Option<DMatrix<f64>>,
    /// Vᵀa.
    pub force: DVector<f64>,
    /// VᵀMt of the unit translation t along the impactor's direction.
    pub translation: DVector<f64>,
    /// The forms of [`System::hit_stress`] on V, a row each.
    pub hit_stress: DMatrix<f64>,
    /// As of [`System::hit_local`].
    pub hit_local: [f64; 3],
    /// Vᵀf of body forces and tractions.
    pub load: DVector<f64>,
    /// Vᵀ∫ k ū of the supports.
    pub support_load: DVector<f64>,
    /// ½ ∫ k ū·ū dS of the supports, J.
    pub support_offset: f64,
    /// c_l of the contact law, m/N, of the modelled part.
    pub compliance: f64,
    /// How many such parts make the whole.
    pub copies: f64,
    /// The patch, where there is one.
    pub patch: Option<Patch>,
    /// Unilateral foundations, whose springs are among the supports.
    pub foundation: Option<FoundationPoints>,
    /// What stands for the plate's shortest waves, where the basis is to know the longer ones alone.
    pub infinite_plate: Option<InfinitePlate>,
}

impl Projection {
    /// The body for schemes that know no modes: y are its unknowns.
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
            patch: self.patch,
            hit_stress: self.hit_stress.row_iter().map(|row| row.iter().copied().collect()).collect(),
            hit_local: self.hit_local,
            translation: self.translation.as_slice().to_vec(),
            infinite_plate: None,
            exchange: None,
            factorised: Vec::new(),
            copies: self.copies,
            classes: 1,
        }
    }

    /// K + G̃(s) D at the rate of the basis, supports included, 1/s².
    pub fn stiffness_at_rate(&self) -> DMatrix<f64> {
        self.stiffness_at(self.rate)
    }

    /// The same at any rate, 1/s.
    pub fn stiffness_at(&self, rate: f64) -> DMatrix<f64> {
        let elastic = &self.elastic + &self.support;
        let relaxing = self.relaxations.iter();
        relaxing.fold(elastic, |sum, part| sum + &part.distortion * part.chain.transformed_terms(rate))
    }

    /// The body whose relaxing parts have other chains, in their order, the same otherwise.
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

    /// Vectors of the basis.
    pub fn vectors(&self) -> usize {
        self.force.len()
    }

    /// The body whose supports lie on the straight line from this one's (0) to another one's (1), the same otherwise.
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

    /// All the numbers of the arrays.
    pub(super) fn numbers(&mut self) -> impl Iterator<Item = &mut [f64]> {
        let Self { elastic, relaxations, support, damping, force, translation, hit_stress, load, support_load, .. } =
            self;
        [Some(elastic), Some(support), Some(hit_stress), damping.as_mut()]
            .into_iter()
            .flatten()
            .chain(relaxations.iter_mut().map(|part| &mut part.distortion))
            .map(|m| m.as_mut_slice())
            .chain([force, translation, load, support_load].map(|v| v.as_mut_slice()))
    }

    /// The same body on the first `count` vectors of the basis.
    pub fn leading(&self, count: usize) -> Self {
        let square = |m: &DMatrix<f64>| m.view((0, 0), (count, count)).into_owned();
        let head = |v: &DVector<f64>| v.rows(0, count).into_owned();
        Self {
            elastic: square(&self.elastic),
            relaxations: self.relaxations.iter().map(|part| part.on(square)).collect(),
            rate: self.rate,
            support: square(&self.support),
            damping: self.damping.as_ref().map(square),
            force: head(&self.force),
            translation: head(&self.translation),
            hit_stress: self.hit_stress.columns(0, count).into_owned(),
            hit_local: self.hit_local,
            load: head(&self.load),
            support_load: head(&self.support_load),
            support_offset: self.support_offset,
            compliance: self.compliance,
            copies: self.copies,
            patch: self.patch,
            foundation: self.foundation.as_ref().map(|points| points.leading(count)),
            infinite_plate: self.infinite_plate.clone(),
        }
    }
}

/// A matrix with all of its entries, zeros too: M adds to each of them.
fn with_zeros(matrix: &DMatrix<f64>) -> CsrMatrix<f64> {
    let (rows, columns) = matrix.shape();
    let offsets = (0..=rows).map(|row| row * columns).collect();
    let numbers = (0..rows).flat_map(|_| 0..columns).collect();
    let entries = matrix.transpose().as_slice().to_vec();
    CsrMatrix::try_from_csr_data(rows, columns, offsets, numbers, entries).expect("rows in order, columns ascending")
}
