//! Symmetric matrices in blocks of the three unknowns of a node, with only one triangle stored.

use std::cmp::Ordering;
use std::ops::Range;

use nalgebra::Matrix3;
use petsc_wrap::{Int, MatrixView, Result, Row};

use super::ordering::{Graph, elimination_order};

/// Number of unknowns of a node.
pub(super) const SIZE: usize = 3;

/// This rank's rows and columns of a symmetric matrix, as diagonal blocks and one triangle.
#[derive(Debug)]
pub(super) struct Triangle<T> {
    /// Nodes in the order of elimination. Rows and columns of blocks are positions in this order.
    pub order: Vec<u32>,
    /// Start of the off-diagonal blocks of each row.
    pub offsets: Vec<usize>,
    /// Columns of these blocks, ascending within a row.
    pub columns: Vec<u32>,
    /// Diagonal blocks.
    pub diagonal: Vec<Matrix3<f64>>,
    /// Off-diagonal blocks, by rows.
    pub blocks: Vec<Matrix3<T>>,
}

impl<T> Triangle<T> {
    /// Returns the numbers of the off-diagonal blocks of a row.
    #[inline(always)]
    pub fn row(&self, at: usize) -> Range<usize> {
        self.offsets[at]..self.offsets[at + 1]
    }
}

impl Triangle<f64> {
    /// Copies an assembled symmetric matrix with rows ordered by node, three unknowns each. The order of elimination
    /// follows from the positions of this rank's nodes (m), or is the order of the rows.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for a matrix that is not AIJ.
    ///
    /// # Panics
    /// If this rank's rows do not consist of such blocks.
    pub fn new(matrix: &MatrixView, places: Option<&[[f64; 3]]>) -> Result<Self> {
        let graph = graph(matrix)?;
        let nodes = graph.offsets.len() - 1;
        let order = places.map_or_else(|| (0..nodes as u32).collect(), |places| elimination_order(&graph, places));
        assert_eq!(order.len(), nodes);
        let mut rank = vec![0_u32; nodes];
        order.iter().enumerate().for_each(|(at, node)| rank[*node as usize] = at as u32);
        let range = matrix.row_range();
        let count = (graph.neighbours.len() - nodes) / 2;
        let (mut offsets, mut columns) = (vec![0], Vec::with_capacity(count));
        let (mut diagonal, mut blocks) = (Vec::with_capacity(nodes), Vec::with_capacity(count));
        let (mut rows, mut beyond): ([Row; SIZE], Vec<(u32, Matrix3<f64>)>) = Default::default();
        for (at, node) in order.iter().enumerate() {
            for (i, row) in (0..).zip(&mut rows) {
                matrix.row_into(range.start + (SIZE * *node as usize) as Int + i, row)?;
                let is_block = |of: &[Int]| of[0] % SIZE as Int == 0 && of[SIZE - 1] == of[0] + 2;
                let (of_nodes, rest) = row.columns.as_chunks::<SIZE>();
                assert!(rest.is_empty() && of_nodes.iter().all(|of| is_block(of)), "rows that are not of blocks");
            }
            assert!(rows[1..].iter().all(|row| row.columns == rows[0].columns), "rows that are not of blocks");
            let first_columns = rows[0].columns.iter().step_by(SIZE).enumerate();
            for (k, first) in first_columns.filter(|(_, first)| range.contains(first)) {
                let place = rank[(first - range.start) as usize / SIZE];
                let block = || Matrix3::from_fn(|i, j| rows[i].values[SIZE * k + j]);
                match (place as usize).cmp(&at) {
                    Ordering::Less => {}
                    Ordering::Equal => diagonal.push(block()),
                    Ordering::Greater => beyond.push((place, block())),
                }
            }
            assert_eq!(diagonal.len(), at + 1, "a row without its diagonal block");
            beyond.sort_unstable_by_key(|(place, _)| *place);
            for (place, block) in beyond.drain(..) {
                columns.push(place);
                blocks.push(block);
            }
            offsets.push(columns.len());
        }
        Ok(Self { order, offsets, columns, diagonal, blocks })
    }
}

/// Graph of this rank's nodes, where nodes of one cell are adjacent.
fn graph(matrix: &MatrixView) -> Result<Graph> {
    let range = matrix.row_range();
    let (mut offsets, mut neighbours, mut row) = (vec![0], Vec::new(), Row::default());
    for first in range.clone().step_by(SIZE) {
        matrix.row_into(first, &mut row)?;
        let own = row.columns.iter().step_by(SIZE).filter(|column| range.contains(column));
        neighbours.extend(own.map(|column| (column - range.start) as u32 / SIZE as u32));
        offsets.push(neighbours.len());
    }
    Ok(Graph { offsets, neighbours })
}
