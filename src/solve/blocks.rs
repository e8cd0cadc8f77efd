//! Symmetric matrices in blocks of the three unknowns of a node, with only one triangle stored.

use std::rc::Rc;

use petsc_wrap::{Int, Matrix, MatrixView, Result, Row, VectorView};

use super::lanes::{BLOCK, Block, Lanes, Rows, SIZE, Sums, apply};
use super::ordering::{Graph, elimination_order};

/// Block sparsity pattern of this rank's rows and columns of a symmetric matrix, with the nodes in the order of
/// elimination.
#[derive(Debug)]
pub(super) struct Pattern {
    /// Nodes in the order of elimination.
    pub order: Vec<u32>,
    /// Start of the off-diagonal blocks of each row, with rows in the order of elimination.
    pub offsets: Vec<usize>,
    /// Columns of these blocks as positions in the order of elimination, ascending within a row.
    pub columns: Vec<u32>,
}

impl Pattern {
    /// Copies the unknowns of nodes into the order of elimination.
    pub fn gather(&self, from: &[f64], to: &mut [Lanes]) {
        let (nodes, _) = from.as_chunks::<SIZE>();
        to.iter_mut().zip(&self.order).for_each(|(to, node)| *to = Lanes::of(nodes[*node as usize]));
    }
}

/// This rank's rows and columns of a symmetric matrix, as diagonal blocks and one triangle.
#[derive(Debug)]
pub(super) struct Triangle {
    pub pattern: Rc<Pattern>,
    /// Diagonal blocks.
    pub diagonal: Vec<Block>,
    /// Numbers of the off-diagonal blocks, by rows, and one additional number ([`Rows::read`]).
    pub numbers: Vec<f64>,
}

/// A row of blocks as stored by PETSc: three rows of numbers.
#[derive(Default)]
struct BlockRow([Row; SIZE]);

impl BlockRow {
    fn read(&mut self, matrix: &MatrixView, first: Int) -> Result<()> {
        for (i, row) in self.0.iter_mut().enumerate() {
            matrix.row_into(first + i as Int, row)?;
        }
        let [first, others @ ..] = &self.0;
        assert!(others.iter().all(|row| row.columns == first.columns), "rows that are not of blocks");
        Ok(())
    }

    /// Numbers of the nodes of the columns.
    fn nodes(&self) -> impl Iterator<Item = Int> {
        let (nodes, rest) = self.0[0].columns.as_chunks::<SIZE>();
        assert!(rest.is_empty(), "rows that are not of blocks");
        nodes.iter().map(|columns| {
            let first = columns[0];
            assert!(first % SIZE as Int == 0 && columns[SIZE - 1] == first + 2, "rows that are not of blocks");
            first / SIZE as Int
        })
    }

    fn block(&self, at: usize) -> Block {
        std::array::from_fn(|k| self.0[k / SIZE].values[SIZE * at + k % SIZE])
    }
}

impl Triangle {
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
        let first_node = range.start / SIZE as Int;
        let count = (graph.neighbours.len() - nodes) / 2;
        let (mut offsets, mut columns) = (vec![0], Vec::with_capacity(count));
        let (mut diagonal, mut numbers) = (Vec::with_capacity(nodes), Vec::with_capacity(BLOCK * count + 1));
        let (mut row, mut beyond) = (BlockRow::default(), Vec::new());
        for (at, node) in order.iter().enumerate() {
            row.read(matrix, range.start + (SIZE * *node as usize) as Int)?;
            beyond.clear();
            for (k, other) in row.nodes().enumerate() {
                let Some(place) = usize::try_from(other - first_node).ok().and_then(|local| rank.get(local)) else {
                    continue;
                };
                match (*place as usize).cmp(&at) {
                    std::cmp::Ordering::Less => {}
                    std::cmp::Ordering::Equal => diagonal.push(row.block(k)),
                    std::cmp::Ordering::Greater => beyond.push((*place, k)),
                }
            }
            assert_eq!(diagonal.len(), at + 1, "a row without its diagonal block");
            beyond.sort_unstable();
            for (place, k) in &beyond {
                columns.push(*place);
                numbers.extend(row.block(*k));
            }
            offsets.push(columns.len());
        }
        numbers.push(0.0);
        Ok(Self { pattern: Rc::new(Pattern { order, offsets, columns }), diagonal, numbers })
    }

    /// Operator with the products of the matrix: this rank's rows and columns are multiplied here, columns of other
    /// ranks by PETSc. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn into_operator(self, matrix: &MatrixView) -> Result<Matrix> {
        let others = if matrix.comm().size() > 1 { Some(columns_of_others(matrix)?) } else { None };
        let nodes = self.diagonal.len();
        let mut work = [vec![Lanes::default(); nodes], vec![Lanes::default(); nodes]];
        Matrix::closure(matrix.comm(), SIZE * nodes, move |x: &VectorView, y: &mut VectorView| {
            match &others {
                Some(others) => others.mult(x, y)?,
                None => y.fill(0.0)?,
            }
            let [from, to] = &mut work;
            self.pattern.gather(&x.read()?, from);
            self.multiply(from, to);
            let mut y = y.write()?;
            let (nodes, _) = y.as_chunks_mut::<SIZE>();
            for (node, Lanes(sum)) in self.pattern.order.iter().zip(to) {
                nodes[*node as usize].iter_mut().zip(&*sum).for_each(|(y, sum)| *y += sum);
            }
            Ok(())
        })
    }

    /// Computes y ← A x for nodes in the order of elimination.
    pub fn multiply(&self, x: &[Lanes], y: &mut [Lanes]) {
        pulp::Arch::new().dispatch(Multiplying { triangle: self, x, y });
    }
}

/// Graph of this rank's nodes, where nodes of one cell are adjacent.
fn graph(matrix: &MatrixView) -> Result<Graph> {
    let range = matrix.row_range();
    let own = range.start / SIZE as Int..range.end / SIZE as Int;
    let (mut offsets, mut neighbours, mut row) = (vec![0], Vec::new(), Row::default());
    for node in own.clone() {
        matrix.row_into(node * SIZE as Int, &mut row)?;
        let nodes = row.columns.iter().step_by(SIZE).map(|column| column / SIZE as Int);
        neighbours.extend(nodes.filter(|other| own.contains(other)).map(|other| (other - own.start) as u32));
        offsets.push(neighbours.len());
    }
    Ok(Graph { offsets, neighbours })
}

/// Entries of this rank's rows in columns of other ranks. Collective.
pub(super) fn columns_of_others(matrix: &MatrixView) -> Result<Matrix> {
    let range = matrix.row_range();
    let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    let mut row = Row::default();
    for i in range.clone() {
        matrix.row_into(i, &mut row)?;
        for (column, value) in row.columns.iter().zip(&row.values).filter(|(column, _)| !range.contains(column)) {
            columns.push(*column);
            values.push(*value);
        }
        offsets.push(columns.len() as Int);
    }
    Matrix::csr(matrix.comm(), &offsets, &columns, &values)
}

/// Product with a vector, compiled for the vector instructions of each kind of processor.
struct Multiplying<'a> {
    triangle: &'a Triangle,
    x: &'a [Lanes],
    y: &'a mut [Lanes],
}

impl pulp::NullaryFnOnce for Multiplying<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { triangle: Triangle { pattern, diagonal, numbers }, x, y } = self;
        y.fill(Lanes::default());
        for (at, block) in diagonal.iter().enumerate() {
            let (own, mut sums) = (x[at].node(), Sums::default());
            let row = pattern.offsets[at]..pattern.offsets[at + 1];
            let blocks = numbers[BLOCK * row.start..=BLOCK * row.end].windows(BLOCK + 1).step_by(BLOCK);
            for (column, block) in pattern.columns[row].iter().zip(blocks) {
                let (rows, column) = (Rows::read(block), *column as usize);
                y[column] = rows.add_transposed(own, y[column]);
                sums.add(rows, x[column]);
            }
            let (above, here, beyond) = (y[at].node(), apply(block, own), sums.total());
            y[at] = Lanes::of(std::array::from_fn(|i| above[i] + here[i] + beyond[i]));
        }
    }
}
