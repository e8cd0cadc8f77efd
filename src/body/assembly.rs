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

/// A matrix of zeros with an entry wherever unknowns of two nodes of a chosen element meet; `owned` nodes are this rank's.
/// Collective.
///
/// The pattern is found for nodes, a ninth of its entries. The zeros stand in order before the first value comes, so that adding an
/// element's block moves nothing.
///
/// # Errors
/// PETSc's.
pub fn zeros(
    comm: &Comm,
    owned: usize,
    elements: &Elements,
    chosen: impl IntoIterator<Item = usize>,
) -> Result<Matrix> {
    let graph = node_graph(comm, owned, elements, chosen)?;
    let range = graph.row_range();
    let (mut here, mut elsewhere) = (Vec::with_capacity(3 * owned), Vec::with_capacity(3 * owned));
    for node in range.clone() {
        let row = graph.row(node)?;
        let own = row.columns().iter().filter(|column| range.contains(column)).count();
        here.extend([3 * own as Int; 3]);
        elsewhere.extend([3 * (row.columns().len() - own) as Int; 3]);
    }
    let mut matrix = Matrix::aij(comm, (3 * owned, 3 * owned), &here, &elsewhere)?;
    matrix.set_block_size(3)?;
    let (mut columns, mut values) = (Vec::new(), Vec::new());
    for node in range {
        unknowns(graph.row(node)?.columns(), &mut columns);
        values.resize(3 * columns.len(), 0.0);
        matrix.set_values(&[3 * node, 3 * node + 1, 3 * node + 2], &columns, &values, Insert::Replace)?;
    }
    matrix.assemble()?;
    graph.destroy()?;
    Ok(matrix)
}

/// A matrix of zeros with a row a node and an entry wherever two nodes share a chosen element. Collective.
///
/// # Errors
/// PETSc's.
pub(super) fn node_graph(
    comm: &Comm,
    owned: usize,
    elements: &Elements,
    chosen: impl IntoIterator<Item = usize>,
) -> Result<Matrix> {
    let mut pattern = Matrix::pattern(comm, (owned, owned))?;
    let ones = vec![1.0; elements.nodes_each().pow(2)];
    for i in chosen {
        let nodes = elements.nodes(i);
        pattern.set_values(nodes, nodes, &ones, Insert::Add)?;
    }
    pattern.assemble()?;
    let graph = pattern.preallocated()?;
    pattern.destroy()?;
    Ok(graph)
}
