//! One basis for bodies that differ in the stiffness or the damping of one support, or in the chain of what relaxes.
//!
//! Vibrations of a few such bodies, weighted by how far the impact reaches them, are put together and made orthonormal in the mass,
//! the directions that hold the most of them first (proper orthogonal decomposition of snapshots: L. Sirovich, Q. Appl. Math. 45, 1987,
//! here in the inner product of M). The supports' operators go with the parameter along a straight line, so that those of any of the
//! bodies follow from two. What relaxes has one D, of which a chain is a factor ([`Projection::with_chains`]).

use super::columns::Columns;
use super::eigen::symmetric_eigen;
use super::projected::Projected;
use super::shift::SLOWEST;
use super::{LinearBody, Operator, Projection};
use crate::error::Result;

/// Of the depth of a basis, that of the larger one that judges it.
const LARGER: f64 = 0.1;

/// The vibrations on a basis of a body, each scaled by its weight: 1 well below a frequency (rad/s), falling with its square above. What
/// relaxes has its modulus at the lowest rate of the basis, by which no vibration is too fast to count that is slow later.
pub fn snapshots(basis: &Columns, projection: &Projection, frequency: f64) -> Columns {
    let (squares, mut shapes) = symmetric_eigen(projection.stiffness_at(SLOWEST * projection.rate));
    for (square, mut shape) in squares.iter().zip(shapes.column_iter_mut()) {
        shape *= 1.0 / (1.0 + square.max(0.0) / (frequency * frequency));
    }
    basis.combined(&shapes)
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
    basis: Columns,
    /// The directions, each as long as it weighs: what stands for all snapshots where more are added.
    pub directions: Columns,
}

impl Merged {
    /// Merges the vibrations of some bodies; `ends` are two of the bodies with their parameters. Directions are taken down to a weight of
    /// `depth` over the largest. Relaxing parts have their moduli at a rate (1/s) in the modes. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(ends: [(f64, &dyn LinearBody); 2], all: &Columns, depth: f64, rate: f64) -> Result<Self> {
        let [(from, body), (to, other)] = ends;
        let (directions, vectors) = main_directions(body, all, depth)?;
        let basis = orthonormal_basis(body, &directions)?;
        let projections = [project(body, &basis, rate)?, project(other, &basis, rate)?];
        Ok(Self { ends: [from, to], projections, vectors, basis, directions })
    }

    /// The vectors of the basis, all rows of them.
    pub fn basis(&self) -> Vec<Vec<f64>> {
        self.basis.whole(self.vectors)
    }

    /// The body at a parameter: on the basis, and on the larger one.
    pub fn at(&self, parameter: f64) -> [Projection; 2] {
        let part = (parameter - self.ends[0]) / (self.ends[1] - self.ends[0]);
        let larger = self.projections[0].towards(&self.projections[1], part);
        [larger.leading(self.vectors), larger]
    }
}

/// The directions that hold the most of some vectors, each as long as it weighs, the largest first: down to `LARGER` times a weight of
/// `depth` over the largest; with how many there are down to that weight itself. Collective.
///
/// # Errors
/// PETSc's.
pub fn main_directions(body: &dyn LinearBody, all: &Columns, depth: f64) -> Result<(Columns, usize)> {
    let mut gram = all.products(&body.apply(Operator::Mass, all)?);
    // Symmetric but for rounding.
    gram.fill_lower_triangle_with_upper_triangle();
    all.agree(gram.as_mut_slice());
    let (values, shapes) = symmetric_eigen(gram);
    // The largest first.
    let order: Vec<usize> = (0..all.count()).rev().collect();
    let largest = order.first().map_or(0.0, |&i| values[i]);
    let deep = |depth: f64| order.iter().filter(|&&i| values[i] > depth * depth * largest).count();
    let [vectors, larger] = [depth, LARGER * depth].map(deep);
    Ok((all.combined(&shapes.select_columns(&order[..larger])), vectors))
}

/// Vectors of some directions that are orthonormal in a body's mass. Collective.
///
/// # Errors
/// PETSc's.
pub fn orthonormal_basis(body: &dyn LinearBody, directions: &Columns) -> Result<Columns> {
    let mut basis = directions.zeros(0);
    for number in 0..directions.count() {
        let next = orthonormal(body, directions.range(number..number + 1), &basis)?;
        basis.append(next);
    }
    Ok(basis)
}

/// A vector made orthonormal to a basis: twice, for rounding.
fn orthonormal(body: &dyn LinearBody, mut next: Columns, basis: &Columns) -> Result<Columns> {
    for _ in 0..2 {
        let parts = basis.products(&body.apply(Operator::Mass, &next)?);
        next.subtract(basis, &parts);
        let length = next.dot(&body.apply(Operator::Mass, &next)?).sqrt();
        next.scale(1.0 / length);
    }
    Ok(next)
}

/// A body on any basis that is orthonormal in its mass, what relaxes with its modulus at a rate (1/s). Collective.
///
/// # Errors
/// PETSc's.
pub fn project(body: &dyn LinearBody, basis: &Columns, rate: f64) -> Result<Projection> {
    let mut projected = Projected::new(body);
    projected.extend(body, basis)?;
    let projection = projected.projection(body, &body.properties()?, basis, rate)?;
    // No vector of it is the translation.
    Ok(Projection { translation: projection.translation * 0.0, ..projection })
}
