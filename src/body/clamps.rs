//! Constrained displacement components: clamps (2), and components normal to planes of symmetry.

use petsc_wrap::{Int, Vector};

use crate::error::Result;

/// Constrained unknowns and their prescribed displacements.
pub struct Clamps {
    /// 1 for a free unknown, 0 for a constrained one.
    pub free: Vector,
    /// Prescribed displacement ū of the constrained unknowns, m; 0 for the free ones.
    pub displacement: Vector,
    /// Global numbers of this rank's constrained unknowns.
    pub rows: Vec<Int>,
}

impl Clamps {
    /// Constrains the unknowns for which `free` is 0, with the values of `displacement`.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn new(free: Vector, displacement: Vector) -> Result<Self> {
        let first = free.range().start;
        let held = |(i, free): (usize, &f64)| (*free == 0.0).then_some(first + i as Int);
        let rows = free.read()?.iter().enumerate().filter_map(held).collect();
        Ok(Self { free, displacement, rows })
    }

    /// Sets the constrained unknowns of a vector to zero. The vector may be longer than u.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn zero(&self, vector: &mut Vector) -> petsc_wrap::Result<()> {
        if self.rows.is_empty() {
            return Ok(());
        }
        let first = vector.range().start;
        let mut values = vector.write()?;
        for row in &self.rows {
            values[(row - first) as usize] = 0.0;
        }
        Ok(())
    }
}
