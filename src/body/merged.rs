//! One basis for bodies that differ in the stiffness or the damping of one support, or in the chain of what relaxes.
//!
//! Vibrations of a few such bodies, weighted by how far the impact reaches them, are put together and made orthonormal in the mass,
//! the directions that hold the most of them first (proper orthogonal decomposition of snapshots: L. Sirovich, Q. Appl. Math. 45, 1987,
//! here in the inner product of M). The supports' operators go with the parameter along a straight line, so that those of any of the
//! bodies follow from two. What relaxes has one D, of which a chain is a factor ([`Projection::with_chains`]).

use nalgebra::{DMatrix, DVector};
use petsc_wrap::Vector;

use super::eigen::symmetric_eigen;
use super::gram::forms_on;
use super::shift::SLOWEST;
use super::{Body, ProjectedRelaxation, Projection, Relaxation};
use crate::error::Result;

/// Of the depth of a basis, that of the larger one that judges it.
const LARGER: f64 = 0.1;

/// The vibrations on a basis of a body, each scaled by its weight: 1 well below a frequency (rad/s), falling with its square above. What
/// relaxes has its modulus at the lowest rate of the basis, by which no vibration is too fast to count that is slow later.
/// Collective.
///
/// # Errors
/// PETSc's.
pub fn snapshots(body: &Body, basis: &[Vector], projection: &Projection, frequency: f64) -> Result<Vec<Vector>> {
    let (squares, shapes) = symmetric_eigen(projection.stiffness_at(SLOWEST * projection.rate));
    let mut vectors = Vec::new();
    for (square, shape) in squares.iter().zip(shapes.column_iter()) {
        let weight = 1.0 / (1.0 + square.max(0.0) / (frequency * frequency));
        let factors: Vec<f64> = shape.iter().map(|factor| weight * factor).collect();
        let mut vector = body.load.duplicate()?;
        vector.add_combination(&factors, &basis[..factors.len()])?;
        vectors.push(vector);
    }
    Ok(vectors)
}

/// The bodies on their common basis.
pub struct Merged {
    /// The two parameters whose supports are known.
    ends: [f64; 2],
    /// The bodies there.
    projections: [Projection; 2],
    /// Vectors of the basis; there are more, by which it is judged.
    vectors: usize,
    /// All of them.
    basis: Vec<Vector>,
    /// The directions, each as long as it weighs: what stands for all snapshots where more are added.
    pub directions: Vec<Vector>,
}

impl Merged {
    /// Merges the vibrations of some bodies; `ends` are two of the bodies with their parameters. Directions are taken down to a weight of
    /// `depth` over the largest. Relaxing parts have their moduli at a rate (1/s) in the modes. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(ends: [(f64, &Body); 2], all: &[Vector], depth: f64, rate: f64) -> Result<Self> {
        let [(from, body), (to, other)] = ends;
        let count = all.len();
        let mut momentum = body.load.duplicate()?;
        let mut gram = DMatrix::zeros(count, count);
        for (j, vector) in all.iter().enumerate() {
            body.apply_mass(vector, &mut momentum)?;
            for (i, other) in all[..=j].iter().enumerate() {
                gram[(i, j)] = momentum.dot(other)?;
                gram[(j, i)] = gram[(i, j)];
            }
        }
        body.comm().broadcast_from_root(gram.as_mut_slice());
        let (values, shapes) = symmetric_eigen(gram);
        // The largest first.
        let order: Vec<usize> = (0..count).rev().collect();
        let largest = order.first().map_or(0.0, |&i| values[i]);
        let deep = |depth: f64| order.iter().filter(|&&i| values[i] > depth * depth * largest).count();
        let [vectors, larger] = [depth, LARGER * depth].map(deep);
        let mut directions = Vec::with_capacity(larger);
        let mut basis: Vec<Vector> = Vec::with_capacity(larger);
        for &direction in &order[..larger] {
            let mut next = body.load.duplicate()?;
            for (vector, factor) in all.iter().zip(shapes.column(direction).iter()) {
                next.axpy(*factor, vector)?;
            }
            let mut direction = next.duplicate()?;
            direction.copy_from(&next)?;
            directions.push(direction);
            orthonormalize(body, &mut next, &basis, &mut momentum)?;
            basis.push(next);
        }
        let projections = [project(body, &basis, rate)?, project(other, &basis, rate)?];
        Ok(Self { ends: [from, to], projections, vectors, basis, directions })
    }

    /// The vectors of the basis.
    pub fn basis(&self) -> &[Vector] {
        &self.basis[..self.vectors]
    }

    /// The body at a parameter: on the basis, and on the larger one.
    pub fn at(&self, parameter: f64) -> [Projection; 2] {
        let part = (parameter - self.ends[0]) / (self.ends[1] - self.ends[0]);
        let larger = self.projections[0].towards(&self.projections[1], part);
        [larger.leading(self.vectors), larger]
    }
}

/// Twice, for rounding.
fn orthonormalize(body: &Body, next: &mut Vector, basis: &[Vector], momentum: &mut Vector) -> Result<()> {
    for _ in 0..2 {
        body.apply_mass(next, momentum)?;
        let shares: Vec<f64> = momentum.dots(basis)?.iter().map(|share| -share).collect();
        next.add_combination(&shares, basis)?;
        body.apply_mass(next, momentum)?;
        let length = next.dot(momentum)?.sqrt();
        next.scale(1.0 / length)?;
    }
    Ok(())
}

/// A body on any basis that is orthonormal in its mass. Collective.
fn project(body: &Body, basis: &[Vector], rate: f64) -> Result<Projection> {
    let count = basis.len();
    let mut product = body.load.duplicate()?;
    let mut square = |apply: &dyn Fn(&Vector, &mut Vector) -> Result<()>| {
        let mut matrix = DMatrix::zeros(count, count);
        for (j, vector) in basis.iter().enumerate() {
            apply(vector, &mut product)?;
            matrix.set_column(j, &DVector::from_vec(product.dots(basis)?));
        }
        // Symmetric but for rounding.
        Ok::<_, crate::Error>((&matrix + matrix.transpose()) * 0.5)
    };
    let elastic = square(&|v, out| body.apply_elastic(v, out))?;
    let support = match &body.support {
        Some(support) => square(&|v, out| Ok(support.mult(v, out)?))?,
        None => DMatrix::zeros(count, count),
    };
    let damping = match &body.damping {
        Some(damping) => Some(square(&|v, out| Ok(damping.mult(v, out)?))?),
        None => None,
    };
    let relaxing = body.relaxations.iter().map(|Relaxation { distortion, chain }| {
        let distortion = square(&|v, out| Ok(distortion.mult(v, out)?))?;
        Ok::<_, crate::Error>(ProjectedRelaxation { distortion, chain: chain.clone() })
    });
    let relaxations = relaxing.collect::<Result<Vec<_>>>()?;
    let along = |v: &Vector| Ok::<_, crate::Error>(DVector::from_vec(v.dots(basis)?));
    let mut projection = Projection {
        elastic,
        relaxations,
        rate,
        support,
        damping,
        force: along(&body.localization.vector)?,
        translation: DVector::zeros(count),
        hit_stress: forms_on(&body.hit_stress, basis)?,
        hit_local: body.hit_local,
        load: along(&body.load)?,
        support_load: along(&body.support_load)?,
        support_offset: body.support_offset,
        compliance: body.localization.compliance,
        copies: body.copies,
        patch: body.localization.patch,
        foundation: None,
        infinite_plate: None,
    };
    projection.numbers().for_each(|numbers| body.comm().broadcast_from_root(numbers));
    Ok(projection)
}
