//! Held components of the displacement, (2), and those normal to planes of symmetry.

use petsc_wrap::{Int, Vector};

use crate::error::Result;

/// Which unknowns are held, and where.
pub struct Clamps {
    /// 1 for a free unknown, 0 for a held one.
    pub free: Vector,
    /// ū of the held unknowns, m; 0 for the free ones.
    pub displacement: Vector,
    /// Global numbers of this rank's held unknowns.
    pub rows: Vec<Int>,
}

impl Clamps {
    /// The unknowns where `free` is 0, at a displacement.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(free: Vector, displacement: Vector) -> Result<Self> {
        let first = free.range().start;
        let held = |(i, free): (usize, &f64)| (*free == 0.0).then_some(first + i as Int);
        let rows = free.read()?.iter().enumerate().filter_map(held).collect();
        Ok(Self { free, displacement, rows })
    }

    /// Sets the held unknowns of a vector, which may be longer, to zero.
    ///
    /// # Errors
    /// PETSc's.
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
