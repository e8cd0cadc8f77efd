//! One loop that hands the kernels' blocks to a sink, and the sparsity of what they add up to.

use petsc_wrap::{Comm, Insert, Int, Matrix, Vector};

use crate::error::Result;
use crate::form::Tangled;
use crate::mesh::{Elements, mean};

/// The unknowns of an element's nodes, node-major: 3·node + component.
pub fn unknowns(nodes: &[Int], out: &mut Vec<Int>) {
    out.clear();
    out.extend(nodes.iter().flat_map(|node| [3 * node, 3 * node + 1, 3 * node + 2]));
}

/// Why an assembly stopped.
pub enum Stopped {
    /// A cell is tangled; its centre, m.
    Tangled([f64; 3]),
    /// The sink failed.
    Sink(petsc_wrap::Error),
}

/// For each chosen element: the kernel's dense block (`size` values), handed with the element's unknowns to the sink.
///
/// The kernel gets the element's index and vertex coordinates and overwrites the block; a block of (3n)² values is a
/// matrix by rows, one of 3n a vector.
pub fn assemble(
    elements: &Elements,
    chosen: impl IntoIterator<Item = usize>,
    size: usize,
    mut kernel: impl FnMut(usize, &[[f64; 3]], &mut [f64]) -> std::result::Result<(), Tangled>,
    mut sink: impl FnMut(&[Int], &[f64]) -> petsc_wrap::Result<()>,
) -> std::result::Result<(), Stopped> {
    let mut block = vec![0.0; size];
    let mut indices = Vec::with_capacity(3 * elements.nodes_each());
    for i in chosen {
        let x = elements.x(i);
        kernel(i, x, &mut block).map_err(|_| Stopped::Tangled(mean(x.iter().copied())))?;
        unknowns(elements.nodes(i), &mut indices);
        sink(&indices, &block).map_err(Stopped::Sink)?;
    }
    Ok(())
}

/// A sink that adds to a matrix by `MatSetValues`.
pub fn into_matrix(matrix: &mut Matrix) -> impl FnMut(&[Int], &[f64]) -> petsc_wrap::Result<()> {
    |indices, block| matrix.set_values(indices, indices, block, Insert::Add)
}

/// A sink that adds to a vector.
pub fn into_vector(vector: &mut Vector) -> impl FnMut(&[Int], &[f64]) -> petsc_wrap::Result<()> {
    |indices, block| vector.set_values(indices, block, Insert::Add)
}

/// Which nodes share an element: the sparsity of every matrix assembled over these elements.
///
/// Kept for nodes, a ninth of the entries of a matrix for their unknowns.
pub struct NodeGraph {
    comm: Comm,
    graph: Matrix,
}

impl NodeGraph {
    /// The graph of the chosen elements, for `owned` nodes of this rank. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(
        comm: &Comm,
        owned: usize,
        elements: &Elements,
        chosen: impl IntoIterator<Item = usize>,
    ) -> Result<Self> {
        let mut pattern = Matrix::pattern(comm, (owned, owned))?;
        let ones = vec![1.0; elements.nodes_each().pow(2)];
        for i in chosen {
            let nodes = elements.nodes(i);
            pattern.set_values(nodes, nodes, &ones, Insert::Add)?;
        }
        pattern.assemble()?;
        let graph = pattern.preallocated()?;
        pattern.destroy()?;
        Ok(Self { comm: comm.clone(), graph })
    }

    /// A matrix for three unknowns a node with room for just these couplings. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn matrix(&self) -> Result<Matrix> {
        let range = self.graph.row_range();
        let nodes = (range.end - range.start) as usize;
        let (mut diagonal, mut off_diagonal) = (Vec::with_capacity(3 * nodes), Vec::with_capacity(3 * nodes));
        for row in range.clone() {
            let row = self.graph.row(row)?;
            let here = row.columns().iter().filter(|column| range.contains(column)).count();
            diagonal.extend([3 * here as Int; 3]);
            off_diagonal.extend([3 * (row.columns().len() - here) as Int; 3]);
        }
        Ok(Matrix::aij(&self.comm, (3 * nodes, 3 * nodes), &diagonal, &off_diagonal)?)
    }

    /// Couplings between nodes, on all ranks. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn couplings(&self) -> Result<u64> {
        Ok(self.graph.entries()?)
    }
}
