//! Incomplete Cholesky factors in blocks of three unknowns, those of a node, without fill.
//!
//! S ≈ Uᵀ D U with D of blocks on the diagonal and U unit upper triangular, where S has blocks: entries that elimination would add elsewhere
//! are dropped (Meijerink and van der Vorst, Math. Comp. 31, 1977, by blocks). Of several ranks each factorises its own rows and columns
//! (block Jacobi). The blocks are kept as V = D U in single precision: a preconditioner need not be exact, and reading it is what it costs.

use petsc_wrap::{Int, MatrixView, Result, Row};

/// Unknowns of a node.
pub(super) const SIZE: usize = 3;

/// Added to the diagonal blocks, as a part of them, where a factor without it has a block on its diagonal that is not positive definite:
/// nothing at first, then the smallest of these that does (Manteuffel, Math. Comp. 34, 1980).
const SHIFTS: [f64; 6] = [0.0, 1e-3, 1e-2, 1e-1, 1.0, 10.0];

/// By rows.
type Block = [f64; SIZE * SIZE];

/// The factor of this rank's part of a symmetric positive definite matrix.
#[derive(Debug, Clone)]
pub struct IncompleteCholesky {
    /// Where the blocks of a row of nodes begin.
    offsets: Vec<usize>,
    /// Columns of nodes beyond the diagonal, ascending in a row.
    columns: Vec<u32>,
    /// V, by rows.
    blocks: Vec<[f32; SIZE * SIZE]>,
    /// D⁻¹.
    inverses: Vec<Block>,
}

impl IncompleteCholesky {
    /// Of the rows and columns that this rank has of an assembled symmetric matrix, whose rows are by nodes, three unknowns each.
    ///
    /// # Errors
    /// PETSc's, e.g. for a matrix that is not AIJ.
    ///
    /// # Panics
    /// Where this rank's rows are not of such blocks.
    pub fn new(matrix: &MatrixView) -> Result<Self> {
        let (mut factor, diagonal) = Self::upper(matrix)?;
        for (attempt, shift) in SHIFTS.iter().enumerate() {
            if attempt > 0 {
                factor = Self::upper(matrix)?.0;
            }
            if factor.eliminate(&diagonal, *shift) {
                return Ok(factor);
            }
        }
        // The blocks of the diagonal alone are a preconditioner of every such matrix.
        factor.offsets.fill(0);
        (factor.columns, factor.blocks) = (Vec::new(), Vec::new());
        factor.inverses = diagonal.iter().map(|block| inverse(block).unwrap_or(IDENTITY)).collect();
        Ok(factor)
    }

    /// The blocks beyond the diagonal, and those on it.
    fn upper(matrix: &MatrixView) -> Result<(Self, Vec<Block>)> {
        let range = matrix.row_range();
        let nodes = (range.end - range.start) as usize / SIZE;
        let local = |column: Int| (column - range.start) as usize;
        let (mut diagonal, mut row) = (Vec::with_capacity(nodes), Row::default());
        let mut count = 0;
        for first in range.clone().step_by(SIZE) {
            matrix.row_into(first, &mut row)?;
            count += row.columns.iter().filter(|column| first < **column && **column < range.end).count() / SIZE;
        }
        let (mut offsets, mut columns, mut blocks) = (vec![0], Vec::with_capacity(count), Vec::with_capacity(count));
        for node in 0..nodes {
            let begin = columns.len();
            let mut own = [0.0; SIZE * SIZE];
            for i in 0..SIZE {
                matrix.row_into(range.start + (SIZE * node + i) as Int, &mut row)?;
                let first = row.columns.partition_point(|column| *column < range.start + (SIZE * node) as Int);
                let last = row.columns.partition_point(|column| *column < range.end);
                let mut of_nodes =
                    row.columns[first..last].chunks_exact(SIZE).zip(row.values[first..last].chunks_exact(SIZE));
                let (column, values) = of_nodes.next().expect("a diagonal");
                assert_eq!(local(column[0]), SIZE * node, "a row without its diagonal block");
                own[SIZE * i..SIZE * (i + 1)].copy_from_slice(values);
                for (at, (column, values)) in of_nodes.enumerate() {
                    if i == 0 {
                        columns.push((local(column[0]) / SIZE) as u32);
                        blocks.push([0.0_f32; SIZE * SIZE]);
                    }
                    assert_eq!(local(column[0]), SIZE * columns[begin + at] as usize, "rows that are not of blocks");
                    for (j, value) in values.iter().enumerate() {
                        blocks[begin + at][SIZE * i + j] = *value as f32;
                    }
                }
            }
            diagonal.push(own);
            offsets.push(columns.len());
        }
        Ok((Self { offsets, columns, blocks, inverses: Vec::new() }, diagonal))
    }

    /// Makes V of the upper blocks, and D⁻¹; whether D is positive definite. Row by row, each is taken off those of its columns.
    fn eliminate(&mut self, diagonal: &[Block], shift: f64) -> bool {
        const NOWHERE: u32 = u32::MAX;
        let nodes = diagonal.len();
        let mut pivots: Vec<Block> = diagonal.iter().map(|block| block.map(|value| (1.0 + shift) * value)).collect();
        // Where a row has its blocks, by column.
        let mut places = vec![NOWHERE; nodes];
        self.inverses = Vec::with_capacity(nodes);
        for node in 0..nodes {
            let Some(pivot) = inverse(&pivots[node]) else { return false };
            self.inverses.push(pivot);
            let row = self.offsets[node]..self.offsets[node + 1];
            row.clone().for_each(|at| places[self.columns[at] as usize] = at as u32);
            for at in row.clone() {
                let (column, block) = (self.columns[at] as usize, self.blocks[at].map(f64::from));
                // VᵀD⁻¹ of this block.
                let left = multiply_transposed(&block, &pivot);
                subtract(&mut pivots[column], &left, &block);
                for below in self.offsets[column]..self.offsets[column + 1] {
                    let other = places[self.columns[below] as usize];
                    if other != NOWHERE {
                        let other = self.blocks[other as usize].map(f64::from);
                        let mut changed = self.blocks[below].map(f64::from);
                        subtract(&mut changed, &left, &other);
                        self.blocks[below] = changed.map(|value| value as f32);
                    }
                }
            }
            row.for_each(|at| places[self.columns[at] as usize] = NOWHERE);
        }
        true
    }

    /// x ← (Uᵀ D U)⁻¹ b.
    ///
    /// # Panics
    /// When there are not as many entries as rows.
    pub fn solve(&self, b: &[f64], x: &mut [f64]) {
        x.copy_from_slice(b);
        let (nodes, rest) = x.as_chunks_mut::<SIZE>();
        assert!(rest.is_empty() && nodes.len() == self.inverses.len());
        for (node, pivot) in self.inverses.iter().enumerate() {
            let [p, q, r] = apply(pivot, nodes[node]);
            let row = self.offsets[node]..self.offsets[node + 1];
            for (column, block) in self.columns[row.clone()].iter().zip(&self.blocks[row]) {
                let v = block.map(f64::from);
                let y = &mut nodes[*column as usize];
                for i in 0..SIZE {
                    y[i] -= v[i] * p + v[SIZE + i] * q + v[2 * SIZE + i] * r;
                }
            }
        }
        for (node, pivot) in self.inverses.iter().enumerate().rev() {
            let row = self.offsets[node]..self.offsets[node + 1];
            let mut sum = [[0.0; SIZE]; SIZE];
            for (column, block) in self.columns[row.clone()].iter().zip(&self.blocks[row]) {
                let (v, y) = (block.map(f64::from), nodes[*column as usize]);
                for i in 0..SIZE {
                    for j in 0..SIZE {
                        sum[i][j] += v[SIZE * i + j] * y[j];
                    }
                }
            }
            let y = &mut nodes[node];
            for i in 0..SIZE {
                y[i] -= sum[i][0] + sum[i][1] + sum[i][2];
            }
            *y = apply(pivot, *y);
        }
    }
}

const IDENTITY: Block = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// The inverse of a symmetric block; `None` where it is not positive definite.
fn inverse(block: &Block) -> Option<Block> {
    let [a, b, c, _, d, e, _, _, f] = *block;
    let minor = a * d - b * b;
    let (of_b, of_c) = (c * e - b * f, b * e - c * d);
    let determinant = a * (d * f - e * e) + b * of_b + c * of_c;
    // NaN is no positive definite block either.
    if !(a > 0.0 && minor > 0.0 && determinant > 0.0 && determinant.is_finite()) {
        return None;
    }
    let of_e = b * c - a * e;
    let adjugate = [d * f - e * e, of_b, of_c, of_b, a * f - c * c, of_e, of_c, of_e, minor];
    Some(adjugate.map(|value| value / determinant))
}

/// block · x.
fn apply(block: &Block, [x, y, z]: [f64; SIZE]) -> [f64; SIZE] {
    std::array::from_fn(|i| block[SIZE * i] * x + block[SIZE * i + 1] * y + block[SIZE * i + 2] * z)
}

/// leftᵀ · right.
fn multiply_transposed(left: &Block, right: &Block) -> Block {
    std::array::from_fn(|at| (0..SIZE).map(|k| left[SIZE * k + at / SIZE] * right[SIZE * k + at % SIZE]).sum())
}

/// from ← from − left · right.
fn subtract(from: &mut Block, left: &Block, right: &Block) {
    for i in 0..SIZE {
        for j in 0..SIZE {
            from[SIZE * i + j] -= left[SIZE * i] * right[j]
                + left[SIZE * i + 1] * right[SIZE + j]
                + left[SIZE * i + 2] * right[2 * SIZE + j];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three nodes in a row: S in blocks, by rows, of a positive definite matrix whose elimination adds nothing.
    fn chain() -> (IncompleteCholesky, Vec<Block>) {
        let stiff = [4.0, 1.0, 0.5, 1.0, 5.0, -1.0, 0.5, -1.0, 6.0];
        let coupling = [-1.0_f32, 0.25, 0.5, 0.125, -2.0, 0.0, 0.75, 0.5, -1.5];
        let factor = IncompleteCholesky {
            offsets: vec![0, 1, 2, 2],
            columns: vec![1, 2],
            blocks: vec![coupling; 2],
            inverses: Vec::new(),
        };
        (factor, vec![stiff; 3])
    }

    /// S x of that matrix.
    fn multiply(factor: &IncompleteCholesky, diagonal: &[Block], x: &[f64]) -> Vec<f64> {
        let (x, _) = x.as_chunks::<SIZE>();
        let mut y: Vec<[f64; SIZE]> = diagonal.iter().zip(x).map(|(block, x)| apply(block, *x)).collect();
        for node in 0..x.len() {
            for at in factor.offsets[node]..factor.offsets[node + 1] {
                let (column, block) = (factor.columns[at] as usize, factor.blocks[at].map(f64::from));
                let (above, below) = (apply(&block, x[column]), multiply_transposed(&block, &IDENTITY));
                let below = apply(&below, x[node]);
                (0..SIZE).for_each(|i| y[node][i] += above[i]);
                (0..SIZE).for_each(|i| y[column][i] += below[i]);
            }
        }
        y.into_flattened()
    }

    /// Without entries to drop, the factor is exact but for single precision.
    #[test]
    fn a_chain_of_nodes_is_solved() {
        let (mut factor, diagonal) = chain();
        let exact: Vec<f64> = (0..9).map(|i| f64::from(i).sin()).collect();
        let b = multiply(&factor, &diagonal, &exact);
        assert!(factor.eliminate(&diagonal, 0.0));
        let mut x = vec![0.0; 9];
        factor.solve(&b, &mut x);
        let error = x.iter().zip(&exact).map(|(x, exact)| (x - exact).abs()).fold(0.0, f64::max);
        // The condition number is some tens.
        assert!(error < 1e-5 && error > 0.0, "{error:e}");
    }

    /// A block that is not positive definite is found out, also where only elimination makes it so; a shift cures it.
    #[test]
    fn an_indefinite_block_is_told() {
        for (block, shift, is_definite) in [(0, 0.0, false), (2, 0.0, false), (2, 10.0, true)] {
            let (mut factor, mut diagonal) = chain();
            diagonal[block] = if block == 0 { IDENTITY.map(|value| -value) } else { IDENTITY };
            assert_eq!(factor.eliminate(&diagonal, shift), is_definite, "{block} {shift}");
        }
        assert_eq!(inverse(&[f64::NAN; 9]), None);
    }
}
