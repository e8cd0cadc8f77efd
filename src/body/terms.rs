//! The linear terms of a body's equation of motion, and what is read of the body, in any storage:
//!
//! M ü + C u̇ + (K + K_s) u + Σ G_i D (u − z_i) = a F + f
//!
//! A symmetry class, a basis and a copy in other storage are maps of all matrices by one function and of all vectors by
//! another ([`BodyTerms::map`]). A new term or reading is added here.

use std::convert::Infallible;

use super::InfinitePlate;
use super::linear::Operator;
use crate::contact::Footprint;
use crate::material::{Decay, Maxwell};

/// Terms of a body, with matrices `M` and vectors `V`. The mass is not among them: a basis is orthonormal in it.
#[derive(Debug, Clone)]
pub struct BodyTerms<M, V> {
    /// Stiffness K of the elastic body alone, N/m. Viscoelastic parts contribute their fully relaxed stiffness.
    pub elastic: M,
    /// Viscoelastic parts, in addition to the elastic K.
    pub relaxations: Vec<Relaxation<M>>,
    /// Stiffness K_s of the elastic supports (11), N/m.
    pub support: Option<M>,
    /// Damping matrix C of the dampers (13), N s/m.
    pub damping: Option<M>,
    /// Load vector f of the body force and the tractions, N.
    pub load: V,
    /// ∫ k ū·v dS of the elastic supports, N.
    pub support_load: V,
    /// ½ ∫ k ū·ū dS of the elastic supports, J.
    pub support_offset: f64,
    /// Where the contact force acts.
    pub contact: ContactPort<V>,
    /// Rigid translation of the whole body by one unit in the impactor's direction.
    pub translation: V,
    /// Stresses that are read at every step.
    pub readings: StressReadings<V>,
    /// Response of an infinite plate of the same section, if the body is a plate.
    pub infinite_plate: Option<InfinitePlate>,
    /// Number of such bodies that form the whole: 1, or 4 for a quarter of a symmetric box.
    pub multiplicity: f64,
}

/// Viscoelastic force Σ G_i D (u − z_i), in addition to the elastic K u. All terms of a Prony series have the same D.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxation<M> {
    /// Distortion stiffness D of the viscoelastic parts for a shear modulus of 1 Pa, m.
    pub distortion: M,
    /// Prony series. Its G∞ is included in the elastic K.
    pub chain: Maxwell,
}

/// The place where the contact force acts and where the displacement under the impactor is read.
#[derive(Debug, Clone)]
pub struct ContactPort<V> {
    /// Contact force vector a (14): aᵀu is the displacement of the surface along the impactor's direction, m.
    pub force: V,
    /// Local compliance c_l of the modelled part, m/N: the part of aᵀu for F = 1 N that Hertz's law already contains,
    /// α = δ + c_l F; 0 for a point force.
    pub compliance: f64,
    /// Distribution of the contact force on the surface.
    pub footprint: Footprint,
}

/// Stresses as linear forms of the displacements.
#[derive(Debug, Clone)]
pub struct StressReadings<V> {
    /// Stresses σ_a, σ_b and σ_ab, Pa, along the axes of a face: on the face opposite the impact point, then at other watched
    /// places. Empty if they are not read.
    pub forms: Vec<V>,
    /// Local stresses that the first three forms lack for a force of 1 N on the whole body, Pa.
    pub local_per_newton: [f64; 3],
}

impl<V> Default for StressReadings<V> {
    fn default() -> Self {
        Self { forms: Vec::new(), local_per_newton: [0.0; 3] }
    }
}

impl<M> Relaxation<M> {
    /// Returns Σ G_i φ_i for a time step (s), Pa: the effective shear modulus for a strain that varies linearly over
    /// the step.
    pub fn stiffness(&self, step: f64) -> f64 {
        self.chain.terms.iter().map(|term| term.modulus * Decay::new(step, term.time).taken).sum()
    }
}

impl<M, V> BodyTerms<M, V> {
    /// Returns one of the operators, if the body has it.
    pub fn operator(&self, operator: Operator) -> Option<&M> {
        match operator {
            Operator::Mass => None,
            Operator::Elastic => Some(&self.elastic),
            Operator::Support => self.support.as_ref(),
            Operator::Damping => self.damping.as_ref(),
            Operator::Distortion(number) => self.relaxations.get(number).map(|part| &part.distortion),
        }
    }

    /// Applies a function to each matrix, and another to each vector.
    pub fn map<N, W>(
        &self,
        mut matrix: impl FnMut(Operator, &M) -> N,
        mut vector: impl FnMut(&V) -> W,
    ) -> BodyTerms<N, W> {
        let Ok(mapped) = self
            .try_map(|operator, of| Ok::<_, Infallible>(matrix(operator, of)), |of| Ok::<_, Infallible>(vector(of)));
        mapped
    }

    /// [`Self::map`] with functions that may fail.
    ///
    /// # Errors
    /// The first error of a function.
    pub fn try_map<N, W, E>(
        &self,
        mut matrix: impl FnMut(Operator, &M) -> Result<N, E>,
        mut vector: impl FnMut(&V) -> Result<W, E>,
    ) -> Result<BodyTerms<N, W>, E> {
        let only = |operator, of: &[Option<&M>]| matrix(operator, of[0].expect("an operator that the body has"));
        Self::try_combine(&[self], only, |of| vector(of[0]), |of| of[0])
    }

    /// Combines bodies with the same relaxations and readings, each matrix, vector and number by a function. An operator
    /// that one of the bodies does not have is `None`.
    ///
    /// # Errors
    /// The first error of a function.
    pub fn try_combine<N, W, E>(
        bodies: &[&Self],
        mut matrix: impl FnMut(Operator, &[Option<&M>]) -> Result<N, E>,
        mut vector: impl FnMut(&[&V]) -> Result<W, E>,
        number: impl Fn(&[f64]) -> f64,
    ) -> Result<BodyTerms<N, W>, E> {
        let first = bodies[0];
        let mut operator = |operator| {
            let of_bodies: Vec<_> = bodies.iter().map(|body| body.operator(operator)).collect();
            let is_any = of_bodies.iter().any(Option::is_some);
            is_any.then(|| matrix(operator, &of_bodies)).transpose()
        };
        let mut relaxations = Vec::new();
        for (part, Relaxation { chain, .. }) in first.relaxations.iter().enumerate() {
            let distortion = operator(Operator::Distortion(part))?.expect("the distortion of a relaxation");
            relaxations.push(Relaxation { distortion, chain: chain.clone() });
        }
        let mut of = |get: &dyn Fn(&Self) -> &V| vector(&bodies.iter().map(|body| get(body)).collect::<Vec<_>>());
        let forms = (0..first.readings.forms.len()).map(|form| of(&|body| &body.readings.forms[form]));
        let forms = forms.collect::<Result<_, E>>()?;
        Ok(BodyTerms {
            elastic: operator(Operator::Elastic)?.expect("the stiffness of a body"),
            relaxations,
            support: operator(Operator::Support)?,
            damping: operator(Operator::Damping)?,
            load: of(&|body| &body.load)?,
            support_load: of(&|body| &body.support_load)?,
            support_offset: number(&bodies.iter().map(|body| body.support_offset).collect::<Vec<_>>()),
            contact: ContactPort {
                force: of(&|body| &body.contact.force)?,
                compliance: first.contact.compliance,
                footprint: first.contact.footprint,
            },
            translation: of(&|body| &body.translation)?,
            readings: StressReadings { forms, local_per_newton: first.readings.local_per_newton },
            infinite_plate: first.infinite_plate.clone(),
            multiplicity: first.multiplicity,
        })
    }
}
