//! Loop that passes element blocks from a kernel to a sink, and the sparsity pattern of their sum.

use petsc_wrap::{Comm, Insert, Int, Matrix, Vector};

use crate::error::Result;
use crate::form::Tangled;
use crate::mesh::{Elements, mean};

/// Unknowns of the nodes of an element, ordered by node: 3·node + component.
pub fn unknowns(nodes: &[Int], out: &mut Vec<Int>) {
    out.clear();
    out.extend(nodes.iter().flat_map(|node| [3 * node, 3 * node + 1, 3 * node + 2]));
}

/// Reason why an assembly stopped.
pub enum Stopped {
    /// A cell is tangled (inverted); its centre, m.
    Tangled([f64; 3]),
    /// The sink failed.
    Sink(crate::Error),
}

/// Calls `kernel` for each chosen element, and passes its dense block (`size` values) with the unknowns of the element
/// to `sink`.
///
/// The kernel receives the index and the vertex coordinates of the element and overwrites the block. A block of (3n)²
/// values is a row-major matrix; a block of 3n values is a vector.
pub fn assemble(
    elements: &Elements,
    chosen: impl IntoIterator<Item = usize>,
    size: usize,
    mut kernel: impl FnMut(usize, &[[f64; 3]], &mut [f64]) -> std::result::Result<(), Tangled>,
    mut sink: impl FnMut(&[Int], &[f64]) -> Result<()>,
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

/// Sink that adds blocks to a matrix by `MatSetValues`.
pub fn into_matrix(matrix: &mut Matrix) -> impl FnMut(&[Int], &[f64]) -> Result<()> {
    |indices, block| Ok(matrix.set_values(indices, indices, block, Insert::Add)?)
}

/// Sink that adds blocks to a vector.
pub fn into_vector(vector: &mut Vector) -> impl FnMut(&[Int], &[f64]) -> Result<()> {
    |indices, block| Ok(vector.set_values(indices, block, Insert::Add)?)
}

/// Matrix of zeros with an entry for each pair of unknowns of nodes that share a chosen element. `owned` is the number
/// of nodes of this rank. Collective.
///
/// The sparsity pattern is computed for nodes, with a ninth of the entries. The zeros are stored in order before the
/// first value is added, so that adding an element's block moves no entries.
///
/// # Errors
/// If a PETSc call fails.
pub fn zeros(
    comm: &Comm,
    owned: usize,
    elements: &Elements,
    chosen: impl IntoIterator<Item = usize>,
) -> Result<Matrix> {
    let graph = node_graph(comm, owned, elements, chosen)?;
    let matrix = Components::new(&graph)?.zeros()?;
    graph.destroy()?;
    Ok(matrix)
}

/// Expansion of a node matrix to a matrix that acts on each of three components alike, with stored entries for their
/// coupling. Holds the rows of this rank.
pub(super) struct Components {
    comm: Comm,
    offsets: Vec<Int>,
    columns: Vec<Int>,
    values: Vec<f64>,
}

impl Components {
    /// Expansion of a matrix with one row for each node.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn new(graph: &Matrix) -> Result<Self> {
        let mut count = 0;
        for node in graph.row_range() {
            count += 9 * graph.row(node)?.columns.len();
        }
        let (mut offsets, mut columns, mut values) = (vec![0], Vec::with_capacity(count), Vec::with_capacity(count));
        let mut of_row = Vec::new();
        for node in graph.row_range() {
            let row = graph.row(node)?;
            unknowns(&row.columns, &mut of_row);
            for component in 0..3 {
                let begin = values.len();
                columns.extend_from_slice(&of_row);
                values.resize(columns.len(), 0.0);
                let own = values.iter_mut().skip(begin + component).step_by(3);
                own.zip(&row.values).for_each(|(to, value)| *to = *value);
                offsets.push(columns.len() as Int);
            }
        }
        Ok(Self { comm: graph.comm().clone(), offsets, columns, values })
    }

    /// Matrix of zeros with the sparsity pattern of the expansion. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn zeros(&self) -> Result<Matrix> {
        let mut matrix = Matrix::csr(&self.comm, &self.offsets, &self.columns, &vec![0.0; self.values.len()])?;
        matrix.set_block_size(3)?;
        Ok(matrix)
    }

    /// Matrix of the expansion, which shares the sparsity pattern of `other`. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn like(&self, other: &Matrix) -> Result<Matrix> {
        Ok(other.with_values(&self.offsets, &self.columns, &self.values)?)
    }
}

/// Matrix of zeros with one row for each node, and an entry for each pair of nodes that share a chosen element.
/// Collective.
///
/// # Errors
/// If a PETSc call fails.
pub(super) fn node_graph(
    comm: &Comm,
    owned: usize,
    elements: &Elements,
    chosen: impl IntoIterator<Item = usize>,
) -> Result<Matrix> {
    let (mut rows, mut columns) = (Vec::new(), Vec::new());
    for i in chosen {
        let nodes = elements.nodes(i);
        for node in nodes {
            rows.extend(std::iter::repeat_n(*node, nodes.len()));
            columns.extend_from_slice(nodes);
        }
    }
    Ok(Matrix::of_pairs(comm, (owned, owned), rows, columns)?)
}
