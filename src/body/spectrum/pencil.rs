//! K and M of the body, with the impactor on it or without, as operators.

use petsc_wrap::{Comm, Insert, Ksp, Matrix, Vector};

use crate::body::Solid;
use crate::error::Result;
use crate::mesh::Mesh;

use super::{Inertia, LinearContact};

/// K x = λ M x with held unknowns taken out. A motion is the body's x and the impactor's q; q = 0 without contact.
pub struct Pencil<'a> {
    body: &'a mut Solid,
    mass: Mass<'a>,
    contact: Option<LinearContact>,
    product: Vector,
}

enum Mass<'a> {
    Diagonal(&'a Vector),
    /// Held rows are those of the identity.
    Matrix {
        matrix: Matrix,
        solver: Ksp,
    },
}

impl<'a> Pencil<'a> {
    /// Factorises M where it is consistent. Collective.
    pub fn new(comm: &Comm, body: &'a mut Solid, inertia: Inertia<'a>, contact: Option<LinearContact>) -> Result<Self> {
        let mass = match inertia {
            Inertia::Lumped(diagonal) => Mass::Diagonal(diagonal),
            Inertia::Consistent => {
                let mut matrix = body.mass.duplicate()?;
                matrix.zero_rows_columns(&body.clamps.rows, 1.0)?;
                matrix.declare_positive_definite()?;
                Mass::Matrix { solver: Ksp::new(comm, "mass_", &matrix)?, matrix }
            }
        };
        let product = body.load.duplicate()?;
        Ok(Self { body, mass, contact, product })
    }

    /// A vector of the body's unknowns. Collective.
    pub fn vector(&self) -> Result<Vector> {
        Ok(self.product.duplicate()?)
    }

    /// Free unknowns, the impactor's among them. Collective.
    pub fn dimension(&self) -> Result<usize> {
        let free = &self.body.clamps.free;
        Ok(free.dot(free)?.round() as usize + usize::from(self.contact.is_some()))
    }

    /// Force on body and impactor, K (x, q). Collective.
    pub fn stiffness(&mut self, (x, q): (&Vector, f64), force: &mut Vector) -> Result<f64> {
        let body = &mut *self.body;
        body.elastic.mult(x, force)?;
        if let Some(support) = &body.support {
            support.mult(x, &mut self.product)?;
            force.axpy(1.0, &self.product)?;
        }
        if let Some(pads) = &mut body.pads {
            pads.add_pressed(x, force)?;
        }
        let mut on_impactor = 0.0;
        if let Some(contact) = self.contact {
            let a = &body.localization.vector;
            on_impactor = contact.tangent * (q - a.dot(x)?);
            force.axpy(-on_impactor, a)?;
        }
        body.clamps.zero(force)?;
        Ok(on_impactor)
    }

    /// M (x, q). Collective.
    pub fn mass(&self, (x, q): (&Vector, f64), momentum: &mut Vector) -> Result<f64> {
        match &self.mass {
            Mass::Diagonal(diagonal) => {
                momentum.copy_from(x)?;
                momentum.pointwise_mult(diagonal)?;
            }
            Mass::Matrix { matrix, .. } => matrix.mult(x, momentum)?,
        }
        Ok(self.impactor_mass() * q)
    }

    /// (x, q) from M (x, q). Collective.
    pub fn solve_mass(&mut self, (momentum, of_impactor): (&Vector, f64), x: &mut Vector) -> Result<f64> {
        match &mut self.mass {
            Mass::Diagonal(diagonal) => {
                x.copy_from(momentum)?;
                x.pointwise_divide(diagonal)?;
            }
            Mass::Matrix { solver, .. } => solver.solve(momentum, x)?,
        }
        Ok(of_impactor / self.impactor_mass())
    }

    /// A motion whose parts, scaled by the roots of M's diagonal, look like independent normal deviates. It depends on where the
    /// nodes lie, not on their numbers, and so not on the number of ranks. Collective.
    pub fn random(&mut self, mesh: &Mesh, x: &mut Vector) -> Result<f64> {
        for cell in 0..mesh.cells.len() {
            for (&node, position) in mesh.cells.nodes(cell).iter().zip(mesh.cells.node_positions(cell)) {
                let key = place(position, mesh.diameter);
                let values = [0, 1, 2].map(|component| normal(key.wrapping_add(component)));
                x.set_values(&[3 * node, 3 * node + 1, 3 * node + 2], &values, Insert::Replace)?;
            }
        }
        x.assemble()?;
        match &self.mass {
            Mass::Diagonal(diagonal) => self.product.copy_from(diagonal)?,
            Mass::Matrix { matrix, .. } => matrix.diagonal(&mut self.product)?,
        }
        self.product.write()?.iter_mut().for_each(|mass| *mass = mass.sqrt());
        x.pointwise_divide(&self.product)?;
        self.body.clamps.zero(x)?;
        Ok(if self.contact.is_some() { normal(0) / self.impactor_mass().sqrt() } else { 0.0 })
    }

    /// Any number without an impactor, which then never moves.
    fn impactor_mass(&self) -> f64 {
        self.contact.map_or(1.0, |contact| contact.mass)
    }
}

/// A number for a node's place, the same where the place differs by rounding alone.
fn place(x: [f64; 3], diameter: f64) -> u64 {
    // Far above rounding, far below any cell. Nodes lie at round numbers, so the seams between quanta are at odd ones.
    let (quantum, seam) = (1e-9 * diameter, 0.381_966);
    x.iter().fold(0, |key, x| mix(key ^ ((x / quantum + seam).floor() as i64 as u64)))
}

/// A normal deviate for a number (Box & Muller 1958).
fn normal(key: u64) -> f64 {
    let uniform = |key: u64| (mix(key) >> 11) as f64 / (1_u64 << 53) as f64;
    let (radius, angle) = (1.0 - uniform(key), uniform(!key));
    (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
}

/// Every bit of the result depends on every bit given: the generator SplitMix64 (Steele, Lea & Flood 2014).
fn mix(key: u64) -> u64 {
    let key = key.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let key = (key ^ (key >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let key = (key ^ (key >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    key ^ (key >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean, variance and correlation of neighbours over a grid: those of independent normal deviates within four times what chance
    /// allows.
    #[test]
    fn deviates_on_a_grid_are_normal_and_independent() {
        let key = |i: usize| place([0.1 * (i % 100) as f64, 0.1 * (i / 100) as f64, 0.0], 10.0);
        let n = 10_000;
        let values: Vec<f64> =
            (0..n).flat_map(|i| [0, 1, 2].map(|component| normal(key(i).wrapping_add(component)))).collect();
        let chance = 4.0 / (values.len() as f64).sqrt();
        let mean_product = |lag: usize| {
            values.iter().zip(&values[lag..]).map(|(one, other)| one * other).sum::<f64>() / values.len() as f64
        };
        assert!((values.iter().sum::<f64>() / values.len() as f64).abs() < chance);
        // The variance of a squared deviate is 2.
        assert!((mean_product(0) - 1.0).abs() < chance * 2_f64.sqrt());
        for lag in [1, 2, 3, 300] {
            assert!(mean_product(lag).abs() < chance, "{lag}");
        }
    }

    #[test]
    fn a_place_bears_rounding() {
        for x in [[0.1 + 0.2, -0.5, 1.0 / 3.0], [0.0, 1e-3, 0.25]] {
            let rounded = x.map(|x| x * (1.0 + f64::EPSILON) - 1e-17);
            assert_eq!(place(x, 2.0), place(rounded, 2.0));
            assert_ne!(place(x, 2.0), place([x[0] + 1e-6, x[1], x[2]], 2.0));
        }
    }
}
