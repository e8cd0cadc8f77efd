//! One basis for several bodies that differ in the stiffness or the damping of one support, or in the Prony series of a
//! viscoelastic part.
//!
//! The vibrations of a few such bodies are collected, weighted by how strongly the impact excites them. Their dominant
//! directions are made orthonormal in the mass (proper orthogonal decomposition of snapshots: L. Sirovich, Q. Appl.
//! Math. 45, 1987, here in the inner product of M). The support operators depend linearly on the parameter, so that two
//! bodies determine the operators for any parameter. A viscoelastic part has one D, and its Prony series is a factor of
//! D ([`Projection::with_chains`]).

use super::columns::Columns;
use super::eigen::symmetric_eigen;
use super::projected::Projected;
use super::shift::SLOWEST;
use super::{LinearBody, Operator, Projection};
use crate::error::Result;

/// Ratio of the depth of the larger basis, used for the error estimate, to the depth of the basis.
const DEPTH_OF_LARGER: f64 = 0.1;

/// Weight relative to the largest below which a direction is only rounding: its square is the relative error of the
/// products of some hundred vectors.
const ROUNDING: f64 = 3e-7;

/// Returns the vibrations of a reduced body as vectors of the whole body. Each is scaled by a weight: 1 well below a
/// frequency (rad/s), decreasing with the inverse square above. Viscoelastic parts have the modulus at the lowest shift
/// of the basis. With the instantaneous modulus, vibrations that become slow later would be too fast to count.
pub fn snapshots(basis: &Columns, projection: &Projection, frequency: f64) -> Columns {
    let (squares, mut shapes) = symmetric_eigen(projection.stiffness_at(SLOWEST * projection.rate));
    for (square, mut shape) in squares.iter().zip(shapes.column_iter_mut()) {
        shape *= 1.0 / (1.0 + square.max(0.0) / (frequency * frequency));
    }
    basis.combined(&shapes)
}

/// Several bodies reduced to their common basis.
pub struct CommonBasis {
    /// The two parameters for which the supports are known.
    ends: [f64; 2],
    /// The reduced bodies at these two parameters.
    projections: [Projection; 2],
    /// Number of vectors of the basis. The larger basis of the error estimate has more.
    vectors: usize,
    /// All vectors of the larger basis.
    basis: Columns,
    /// Dominant directions, each scaled by its weight. They represent all snapshots when more are added.
    pub directions: Columns,
}

impl CommonBasis {
    /// Merges the vibrations `all` of several bodies. `ends` are two of the bodies with their parameters. Directions
    /// are kept down to a weight of `depth` relative to the largest, at least `ROUNDING / DEPTH_OF_LARGER`. In the
    /// modes, viscoelastic parts have their moduli
    /// at a rate (1/s). Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn new(ends: [(f64, &dyn LinearBody); 2], all: &Columns, depth: f64, rate: f64) -> Result<Self> {
        let [(from, body), (to, other)] = ends;
        // The larger basis ends where weights are rounding. If the other one ended there too, as it would at a small
        // tolerance, both would be equal and the estimated error zero.
        let depth = depth.max(ROUNDING / DEPTH_OF_LARGER);
        let (directions, [vectors, _]) = main_directions(body, all, [depth, DEPTH_OF_LARGER * depth])?;
        let mut basis = directions.zeros(0);
        extend_orthonormal(body, &mut basis, &directions)?;
        let projections = [project(body, &basis, rate)?, project(other, &basis, rate)?];
        Ok(Self { ends: [from, to], projections, vectors, basis, directions })
    }

    /// Returns all rows of the basis vectors.
    pub fn basis(&self) -> Vec<Vec<f64>> {
        self.basis.whole(self.vectors)
    }

    /// Returns the body at a parameter, reduced to the basis and to the larger basis.
    pub fn at(&self, parameter: f64) -> [Projection; 2] {
        let part = (parameter - self.ends[0]) / (self.ends[1] - self.ends[0]);
        let larger = self.projections[0].towards(&self.projections[1], part);
        [larger.leading(self.vectors), larger]
    }
}

/// Returns the dominant directions of some vectors, each scaled by its weight, the largest first. `depths` are weights
/// relative to the largest, in descending order: also returns the number of directions down to each of them. Directions
/// below the last one are left out. Collective.
///
/// # Errors
/// If a PETSc call fails.
fn main_directions<const N: usize>(
    body: &dyn LinearBody,
    all: &Columns,
    depths: [f64; N],
) -> Result<(Columns, [usize; N])> {
    let mut gram = all.products(&body.apply(Operator::Mass, all)?);
    // Symmetric up to rounding.
    gram.fill_lower_triangle_with_upper_triangle();
    all.agree(gram.as_mut_slice());
    let (values, shapes) = symmetric_eigen(gram);
    // In descending order.
    let order: Vec<usize> = (0..all.count()).rev().collect();
    let largest = order.first().map_or(0.0, |&i| values[i]);
    let deep = |depth: f64| {
        let least = depth.max(ROUNDING).powi(2) * largest;
        order.iter().filter(|&&i| values[i] > least).count()
    };
    let counts = depths.map(deep);
    let kept = counts.last().copied().unwrap_or_default();
    Ok((all.combined(&shapes.select_columns(&order[..kept])), counts))
}

/// Adds some directions to a basis that is orthonormal in the mass of a body. Collective.
///
/// # Errors
/// If a PETSc call fails.
fn extend_orthonormal(body: &dyn LinearBody, basis: &mut Columns, directions: &Columns) -> Result<()> {
    for number in 0..directions.count() {
        let next = orthonormal(body, directions.range(number..number + 1), basis)?;
        basis.append(next);
    }
    Ok(())
}

/// Makes a vector orthonormal to a basis, in two passes because of rounding.
fn orthonormal(body: &dyn LinearBody, mut next: Columns, basis: &Columns) -> Result<Columns> {
    for _ in 0..2 {
        let parts = basis.products(&body.apply(Operator::Mass, &next)?);
        next.subtract(basis, &parts);
        let length = next.dot(&body.apply(Operator::Mass, &next)?).sqrt();
        next.scale(1.0 / length);
    }
    Ok(next)
}

/// Projects a body onto any basis that is orthonormal in its mass. Viscoelastic parts have their moduli at a rate
/// (1/s). Collective.
///
/// # Errors
/// If a PETSc call fails.
fn project(body: &dyn LinearBody, basis: &Columns, rate: f64) -> Result<Projection> {
    let mut projected = Projected::new(body);
    projected.extend(body, basis)?;
    let mut projection = projected.projection(body, &body.properties()?, basis, rate)?;
    // No basis vector is the translation.
    projection.terms.translation.fill(0.0);
    Ok(projection)
}
