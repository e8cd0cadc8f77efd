//! Products of a nodal matrix, with one row per node, with vectors of three components per node. The mass of one
//! component is such a matrix.
//!
//! Each entry is read once for all three components, and only the upper triangle is stored, because memory traffic
//! limits the speed.

use petsc_wrap::{Matrix, MatrixView, Result, Row, VectorView};

use super::blocks::columns_of_others;
use super::lanes::{Lanes, SIZE};

/// This rank's rows and columns of a symmetric nodal matrix.
struct NodeTriangle {
    diagonal: Vec<f64>,
    /// Start of each row's numbers beyond the diagonal.
    offsets: Vec<usize>,
    /// Columns of these numbers.
    columns: Vec<u32>,
    numbers: Vec<f64>,
}

/// Operator with the products of a symmetric nodal matrix for each of three components: this rank's rows and
/// columns are multiplied here, columns of other ranks by PETSc. The numbers are copied. Collective.
///
/// # Errors
/// If the matrix is not an assembled AIJ matrix, or if a PETSc call fails.
pub fn nodal_product(matrix: &MatrixView) -> Result<Matrix> {
    let is_shared = matrix.comm().size() > 1;
    let others = if is_shared { Some(columns_of_others(matrix)?.by_component(SIZE)?) } else { None };
    let triangle = NodeTriangle::new(matrix)?;
    let nodes = triangle.diagonal.len();
    let mut work = [vec![Lanes::default(); nodes], vec![Lanes::default(); nodes]];
    Matrix::closure(matrix.comm(), SIZE * nodes, move |x: &VectorView, y: &mut VectorView| {
        let [from, to] = &mut work;
        let x_here = x.read()?;
        let (of_nodes, _) = x_here.as_chunks::<SIZE>();
        from.iter_mut().zip(of_nodes).for_each(|(to, node)| *to = Lanes::of(*node));
        drop(x_here);
        pulp::Arch::new().dispatch(Multiplying { triangle: &triangle, x: from, y: to });
        let add = |y: &mut VectorView, is_sum: bool| {
            let mut y = y.write()?;
            let (nodes, _) = y.as_chunks_mut::<SIZE>();
            for (node, sum) in nodes.iter_mut().zip(&*to) {
                let sum = sum.node();
                *node = if is_sum { std::array::from_fn(|i| node[i] + sum[i]) } else { sum };
            }
            Ok(())
        };
        if let Some(others) = &others {
            others.mult(x, y)?;
        }
        add(y, others.is_some())
    })
}

impl NodeTriangle {
    fn new(matrix: &MatrixView) -> Result<Self> {
        let range = matrix.row_range();
        let mut triangle = Self { diagonal: Vec::new(), offsets: vec![0], columns: Vec::new(), numbers: Vec::new() };
        let mut row = Row::default();
        for i in range.clone() {
            matrix.row_into(i, &mut row)?;
            let mut on_diagonal = 0.0;
            for (column, number) in row.columns.iter().zip(&row.values).filter(|(column, _)| range.contains(column)) {
                match column.cmp(&i) {
                    std::cmp::Ordering::Less => {}
                    std::cmp::Ordering::Equal => on_diagonal = *number,
                    std::cmp::Ordering::Greater => {
                        triangle.columns.push((column - range.start) as u32);
                        triangle.numbers.push(*number);
                    }
                }
            }
            triangle.diagonal.push(on_diagonal);
            triangle.offsets.push(triangle.columns.len());
        }
        Ok(triangle)
    }
}

/// Product with a vector, compiled for the vector instructions of each kind of processor.
struct Multiplying<'a> {
    triangle: &'a NodeTriangle,
    x: &'a [Lanes],
    y: &'a mut [Lanes],
}

impl pulp::NullaryFnOnce for Multiplying<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { triangle: NodeTriangle { diagonal, offsets, columns, numbers }, x, y } = self;
        y.fill(Lanes::default());
        for (i, on_diagonal) in diagonal.iter().enumerate() {
            let (own, row) = (x[i], offsets[i]..offsets[i + 1]);
            let mut sum = y[i].plus(*on_diagonal, own);
            for (column, number) in columns[row.clone()].iter().zip(&numbers[row]) {
                let column = *column as usize;
                sum = sum.plus(*number, x[column]);
                y[column] = y[column].plus(*number, own);
            }
            y[i] = sum;
        }
    }
}
