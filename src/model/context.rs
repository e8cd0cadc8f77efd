//! How a model is made, beside what its scene says.

use petsc_wrap::Comm;

use super::watch::Watch;

/// How a model is made, beside what its scene says.
#[derive(Clone, Copy)]
pub struct ModelContext<'a> {
    /// Ranks on which the model is made.
    pub comm: &'a Comm,
    /// Follows and may interrupt it.
    pub watch: &'a dyn Watch,
    /// Whether the basis must also limit the estimated error of the deflection, although the tolerance does not apply to it.
    pub limits_deflection_error: bool,
    /// Whether cells are not refined by their estimated error, because several runs share one choice of cells.
    pub keeps_cells: bool,
}

impl<'a> ModelContext<'a> {
    /// As the scene alone requires.
    pub fn new(comm: &'a Comm, watch: &'a dyn Watch) -> Self {
        Self { comm, watch, limits_deflection_error: false, keeps_cells: false }
    }
}
