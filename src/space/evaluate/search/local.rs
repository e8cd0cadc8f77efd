//! Local field on a face, as polynomials of the contact radius.

use crate::form::stress::{place, with_shear};
use crate::space::evaluate::{ContactNow, Face, FaceGrid};
use crate::stack::PointField;

/// Contribution of the local field to the stresses on a face.
pub(super) struct LocalRows {
    /// Largest contact radius for which the polynomials hold, m.
    largest: f64,
    /// Number of coefficients of each polynomial.
    terms: usize,
    /// For each point, the coefficients for 1 N of (a + b)/2, (a − b)/2 and ab, Pa.
    points: Vec<(usize, Vec<[f64; 3]>)>,
    /// The same for the stresses across the face, if these are used.
    across: Vec<(usize, Vec<[f64; 3]>)>,
    /// Points of the face that are left out.
    pub left_out: Vec<usize>,
}

impl LocalRows {
    /// `None` if the fields are not such polynomials.
    pub fn new(face: &Face) -> Option<Self> {
        let FaceGrid { axes: [a, b], .. } = face.grid.as_ref()?;
        let left_out = (0..face.points.len()).filter(|point| face.left_out[*point]).collect();
        let normal = 3 - a - b;
        let mut rows = Self { largest: 1.0, terms: 0, points: Vec::new(), across: Vec::new(), left_out };
        for (point, local) in &face.local {
            let (largest, coefficients) = local.polynomial()?;
            if !rows.points.is_empty() && largest != rows.largest {
                return None;
            }
            rows.largest = largest;
            rows.terms = rows.terms.max(coefficients.len());
            let in_plane = |all: &[f64; 6]| parts([all[*a], all[*b], all[place(*a, *b)]]);
            rows.points.push((*point, coefficients.iter().map(in_plane).collect()));
            if face.across.is_some() {
                let of = |all: &[f64; 6]| parts([all[place(*a, normal)], all[place(*b, normal)], all[normal]]);
                rows.across.push((*point, coefficients.iter().map(of).collect()));
            }
        }
        Some(rows)
    }

    /// Added stresses at the points under a contact, in their order; none without a force.
    pub fn under(&self, contact: &ContactNow) -> impl Iterator<Item = (usize, [f64; 3])> {
        self.sums(&self.points, contact)
    }

    /// Same as [`Self::under`], together with the added stresses across the face.
    pub fn whole_under(&self, contact: &ContactNow) -> impl Iterator<Item = (usize, [[f64; 3]; 2])> {
        let both = self.under(contact).zip(self.sums(&self.across, contact));
        both.map(|((point, in_plane), (_, across))| (point, [in_plane, across]))
    }

    fn sums<'a>(
        &self,
        points: &'a [(usize, Vec<[f64; 3]>)],
        contact: &ContactNow,
    ) -> impl Iterator<Item = (usize, [f64; 3])> + use<'a> {
        let points = if contact.force > 0.0 { points } else { &[] };
        let t = PointField::variable(contact.radius, self.largest);
        let mut polynomials = Vec::new();
        if !points.is_empty() {
            polynomials.reserve_exact(self.terms.max(2));
            polynomials.extend([contact.force, contact.force * t]);
            for k in 2..self.terms {
                polynomials.push(2.0 * t * polynomials[k - 1] - polynomials[k - 2]);
            }
        }
        points.iter().map(move |(point, coefficients)| {
            let mut sum = [0.0; 3];
            for (factor, of_degree) in polynomials.iter().zip(coefficients) {
                (0..3).for_each(|i| sum[i] += factor * of_degree[i]);
            }
            (*point, sum)
        })
    }
}

/// Largest principal stress from the parts of the in-plane stresses and of the stresses across the face.
pub(super) fn principal_of([m, d, s]: [f64; 3], [m_across, d_across, normal]: [f64; 3]) -> f64 {
    with_shear([m + d, m - d, s], [m_across + d_across, m_across - d_across, normal])
}

/// Upper bound of the largest principal stress. In a direction with the components p along the face and z across it,
/// the stress is at most λp² + 2τpz + σz², where λ is the in-plane principal stress, τ the magnitude of the transverse
/// shear stress, and σ the normal stress.
pub(super) fn ceiling_of([m, d, s]: [f64; 3], [m_across, d_across, normal]: [f64; 3]) -> f64 {
    let in_plane = m + (d * d + s * s).sqrt();
    let shear = 2.0 * (m_across * m_across + d_across * d_across);
    0.5 * (in_plane + normal) + (0.25 * (in_plane - normal).powi(2) + shear).sqrt()
}

/// (a + b)/2, (a − b)/2 and ab from a, b and ab; likewise from az, bz and zz.
pub(super) fn parts([a, b, ab]: [f64; 3]) -> [f64; 3] {
    [0.5 * (a + b), 0.5 * (a - b), ab]
}
