//! Partial Cholesky factor of a matrix: the interior unknowns are eliminated, and the last ones, the interface
//! unknowns, are retained.
//!
//! With A_ii = L Lᵀ and W = A_bi L⁻ᵀ, the eliminated columns of the factor are [L; W]. The elimination subtracts
//! W Wᵀ = A_bi A_ii⁻¹ A_ib from A_bb. faer factorises the matrix with a diagonal in place of A_bb. This changes neither
//! L nor W.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::amd;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMat, SymbolicSparseColMat, SymbolicSparseColMatRef};
use faer::{Mat, Par, Side};
use pulp::{Simd, WithSimd};

use super::split::Entry;
use crate::solve::triangle::{TOGETHER, products, subtract};

/// Factor of the bounds in the diagonal that replaces A_bb. It is above 1, so that the retained part is positive
/// definite after the elimination.
const MARGIN: f64 = 2.0;

/// Partial factor, with the work space for sweeps.
pub(super) struct PartialCholesky {
    /// Number of eliminated unknowns.
    inside: usize,
    /// Unknown at each position of the order of elimination; the retained unknowns are last and in their original
    /// order.
    order: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
    /// Entries by supernodes; each supernode has dense columns, one after the other.
    entries: Vec<f64>,
    /// Diagonal in place of A_bb.
    diagonal: Vec<f64>,
    /// Work vector in the order of elimination.
    ordered: Vec<f64>,
    /// Work vector for the rows of a supernode.
    work: Vec<f64>,
}

impl PartialCholesky {
    /// Factorises a symmetric matrix. `rows` are the rows of the eliminated unknowns, from the diagonal on. `bounds`,
    /// one for each retained unknown, must be at least the amount that the elimination subtracts from its diagonal.
    /// `None` if the matrix is not positive definite.
    pub fn new(rows: &[Vec<Entry>], bounds: &[f64]) -> Option<Self> {
        let (inside, count) = (rows.len(), rows.len() + bounds.len());
        let diagonal: Vec<f64> = bounds.iter().map(|bound| MARGIN * bound).collect();
        let (mut offsets, mut places, mut values) = (vec![0], Vec::new(), Vec::new());
        for row in rows {
            places.extend(row.iter().map(|entry| entry.column));
            values.extend(row.iter().map(|entry| entry.value));
            offsets.push(places.len());
        }
        for (number, entry) in diagonal.iter().enumerate() {
            places.push(inside + number);
            values.push(*entry);
            offsets.push(places.len());
        }
        let order = order(rows, bounds.len())?;
        let mut place_of = vec![0; count];
        order.iter().enumerate().for_each(|(place, unknown)| place_of[*unknown] = place);
        let matrix = SparseColMat::new(SymbolicSparseColMat::new_checked(count, count, offsets, None, places), values);
        let symbolic = factorize_symbolic_cholesky(
            matrix.symbolic(),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&order, &place_of, count)),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .ok()?;
        let mut entries = vec![0.0; symbolic.len_val()];
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        symbolic
            .factorize_numeric_llt(
                &mut entries,
                matrix.as_ref(),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut MemBuffer::new(scratch)),
                Default::default(),
            )
            .ok()?;
        tracing::info!(inside, staying = bounds.len(), entries = entries.len(), "factor of a part");
        let mut partial =
            Self { inside, order, symbolic, entries, diagonal, ordered: vec![0.0; count], work: Vec::new() };
        let longest = supernodes(&partial.symbolic, &partial.entries).map(|node| node.rows()).max();
        partial.work.resize(longest.unwrap_or(0), 0.0);
        Some(partial)
    }

    /// Subtracts W Wᵀ from a full symmetric matrix; `places` are the rows of the retained unknowns in it.
    pub fn subtract_from(&self, matrix: &mut [f64], places: &[usize]) {
        let (staying, count) = (places.len(), matrix.len().isqrt());
        // Cholesky factor of the retained part.
        let mut left = Mat::<f64>::zeros(staying, staying);
        for node in supernodes(&self.symbolic, &self.entries) {
            for column in (0..node.columns).filter(|column| node.first + column >= self.inside) {
                let entries = node.column(column).iter().enumerate().skip(column);
                entries.for_each(|(row, entry)| {
                    left[(node.row(row) - self.inside, node.first + column - self.inside)] = *entry
                });
            }
        }
        let product = &left * left.transpose();
        for (i, row) in places.iter().enumerate() {
            for (j, column) in places.iter().enumerate() {
                let diagonal = if i == j { self.diagonal[i] } else { 0.0 };
                matrix[row * count + column] -= diagonal - product[(i, j)];
            }
        }
    }

    /// Computes (f_i, f_b) → (L⁻¹ f_i, f_b − W L⁻¹ f_i).
    pub fn forward(&mut self, x: &mut [f64]) {
        self.sweep(x, Direction::Forward);
    }

    /// Computes (y_i, x_b) → (L⁻ᵀ (y_i − Wᵀ x_b), x_b).
    pub fn backward(&mut self, x: &mut [f64]) {
        self.sweep(x, Direction::Backward);
    }

    fn sweep(&mut self, x: &mut [f64], direction: Direction) {
        let Self { inside, order, symbolic, entries, ordered, work, .. } = self;
        ordered.iter_mut().zip(&*order).for_each(|(value, unknown)| *value = x[*unknown]);
        let nodes = supernodes(symbolic, entries);
        pulp::Arch::new().dispatch(Sweep { nodes, inside: *inside, direction, x: ordered, work });
        ordered.iter().zip(&*order).for_each(|(value, unknown)| x[*unknown] = *value);
    }
}

/// Order of elimination: the eliminated unknowns, ordered for little fill-in (Amestoy, Davis and Duff, SIAM J. Matrix
/// Anal. Appl. 17, 1996), then the retained ones. `None` if there are too many for the integer type.
///
/// The retained unknowns are treated as coupled to each other, so that unknowns near them are eliminated late.
/// Otherwise the neighbours of these would get fill-in with all retained unknowns.
fn order(rows: &[Vec<Entry>], staying: usize) -> Option<Vec<usize>> {
    let (inside, count) = (rows.len(), rows.len() + staying);
    let (mut offsets, mut places) = (vec![0], Vec::new());
    for row in rows {
        places.extend(row.iter().map(|entry| entry.column));
        offsets.push(places.len());
    }
    for unknown in inside..count {
        places.extend(unknown..count);
        offsets.push(places.len());
    }
    let pattern = SymbolicSparseColMatRef::new_checked(count, count, &offsets, None, &places);
    let (mut order, mut inverse) = (vec![0; count], vec![0; count]);
    let mut scratch = MemBuffer::new(amd::order_scratch::<usize>(count, places.len()));
    // No row is treated as dense.
    let control = amd::Control { dense: -1.0, ..Default::default() };
    amd::order(&mut order, &mut inverse, pattern, control, MemStack::new(&mut scratch)).ok()?;
    order.retain(|unknown| *unknown < inside);
    order.extend(inside..count);
    Some(order)
}

/// Supernode: columns of a factor with the same rows below them.
#[derive(Clone, Copy)]
struct Supernode<'a> {
    /// First of the columns.
    first: usize,
    columns: usize,
    /// Row numbers below the columns, ascending.
    below: &'a [usize],
    /// Entries of the columns, one column after the other, each with the rows of the columns and the rows below.
    entries: &'a [f64],
}

impl<'a> Supernode<'a> {
    fn rows(&self) -> usize {
        self.columns + self.below.len()
    }

    /// Copies the values of the columns to the work array. Columns of unknowns below `inside` are eliminated.
    #[inline(always)]
    fn taken<'w>(&self, inside: usize, x: &[f64], work: &'w mut [f64]) -> SupernodeWork<'w> {
        let eliminated = self.columns.min(inside - self.first);
        let work = &mut work[..self.rows()];
        work[..self.columns].copy_from_slice(&x[self.first..self.first + self.columns]);
        SupernodeWork { eliminated, whole: eliminated - eliminated % TOGETHER, work }
    }

    /// Row number in the factor of a row of the supernode.
    fn row(&self, number: usize) -> usize {
        if number < self.columns { self.first + number } else { self.below[number - self.columns] }
    }

    #[inline(always)]
    fn column(&self, number: usize) -> &'a [f64] {
        let rows = self.rows();
        &self.entries[number * rows..(number + 1) * rows]
    }

    /// A group of [`TOGETHER`] columns, each from the diagonal row of the first one on.
    #[inline(always)]
    fn group(&self, first: usize) -> [&'a [f64]; TOGETHER] {
        std::array::from_fn(|k| &self.column(first + k)[first..])
    }
}

/// The supernodes of a factor in the order of elimination.
fn supernodes<'a>(
    symbolic: &'a SymbolicCholesky<usize>,
    entries: &'a [f64],
) -> impl DoubleEndedIterator<Item = Supernode<'a>> {
    let symbolic = match symbolic.raw() {
        SymbolicCholeskyRaw::Supernodal(symbolic) => Some(symbolic),
        // Only a matrix without rows is simplicial, since supernodes are requested.
        SymbolicCholeskyRaw::Simplicial(_) => None,
    };
    symbolic.into_iter().flat_map(move |symbolic| {
        let (first, end) = (symbolic.supernode_begin(), symbolic.supernode_end());
        let (of_rows, of_entries, below) =
            (symbolic.col_ptr_for_row_idx(), symbolic.col_ptr_for_val(), symbolic.row_idx());
        (0..symbolic.n_supernodes()).map(move |node| Supernode {
            first: first[node],
            columns: end[node] - first[node],
            below: &below[of_rows[node]..of_rows[node + 1]],
            entries: &entries[of_entries[node]..of_entries[node + 1]],
        })
    })
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Direction {
    /// Multiplication with L⁻¹.
    Forward,
    /// Multiplication with L⁻ᵀ.
    Backward,
}

/// Sweep over the eliminated columns, compiled for the vector instructions of each kind of processor.
struct Sweep<'a, N> {
    nodes: N,
    inside: usize,
    direction: Direction,
    x: &'a mut [f64],
    work: &'a mut [f64],
}

impl<'n, N: DoubleEndedIterator<Item = Supernode<'n>>> WithSimd for Sweep<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { nodes, inside, direction, x, work } = self;
        // The retained columns are last; one supernode may contain both kinds.
        let nodes = nodes.take_while(|node| node.first < inside);
        // Loops are used because closures are not compiled for these vector instructions.
        match direction {
            Direction::Forward => {
                for node in nodes {
                    forward(simd, &node, inside, x, work);
                }
            }
            Direction::Backward => {
                // A list is needed because an iterator with `take_while` cannot be reversed.
                let nodes: Vec<Supernode> = nodes.collect();
                for node in nodes.iter().rev() {
                    backward(simd, node, inside, x, work);
                }
            }
        }
    }
}

/// Data at the start of a supernode in a sweep.
struct SupernodeWork<'a> {
    /// Number of its columns that are eliminated.
    eliminated: usize,
    /// Number of these columns that are processed in whole groups.
    whole: usize,
    /// Values of its columns, and space for the rows below.
    work: &'a mut [f64],
}

#[inline(always)]
fn forward<S: Simd>(simd: S, node: &Supernode, inside: usize, x: &mut [f64], work: &mut [f64]) {
    let Supernode { first, columns, below, .. } = *node;
    let SupernodeWork { eliminated, whole, work } = node.taken(inside, x, work);
    work[columns..].fill(0.0);
    for j in (0..whole).step_by(TOGETHER) {
        let group = node.group(j);
        let mut found = [0.0; TOGETHER];
        for k in 0..TOGETHER {
            found[k] = (0..k).fold(work[j + k], |sum, i| sum - group[i][k] * found[i]) / group[k][k];
        }
        work[j..j + TOGETHER].copy_from_slice(&found);
        subtract(simd, &mut work[j + TOGETHER..], group.map(|column| &column[TOGETHER..]), found);
    }
    for j in whole..eliminated {
        let column = &node.column(j)[j..];
        let (value, others) = work[j..].split_first_mut().expect("a row of each column");
        *value /= column[0];
        others.iter_mut().zip(&column[1..]).for_each(|(other, entry)| *other -= entry * *value);
    }
    let (of_columns, of_others) = work.split_at(columns);
    x[first..first + columns].copy_from_slice(of_columns);
    of_others.iter().zip(below).for_each(|(change, row)| x[*row] += change);
}

#[inline(always)]
fn backward<S: Simd>(simd: S, node: &Supernode, inside: usize, x: &mut [f64], work: &mut [f64]) {
    let Supernode { first, columns, below, .. } = *node;
    let SupernodeWork { eliminated, whole, work } = node.taken(inside, x, work);
    work[columns..].iter_mut().zip(below).for_each(|(value, row)| *value = x[*row]);
    for j in (whole..eliminated).rev() {
        let column = &node.column(j)[j..];
        let sum: f64 = column[1..].iter().zip(&work[j + 1..]).map(|(entry, value)| entry * value).sum();
        work[j] = (work[j] - sum) / column[0];
    }
    for j in (0..whole).step_by(TOGETHER).rev() {
        let group = node.group(j);
        let sums = products(simd, group.map(|column| &column[TOGETHER..]), &work[j + TOGETHER..]);
        let mut found = [0.0; TOGETHER];
        for k in (0..TOGETHER).rev() {
            let others = (k + 1..TOGETHER).fold(sums[k], |sum, i| sum + group[k][i] * found[i]);
            found[k] = (work[j + k] - others) / group[k][k];
        }
        work[j..j + TOGETHER].copy_from_slice(&found);
    }
    x[first..first + eliminated].copy_from_slice(&work[..eliminated]);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sweeps and the Schur complement agree with dense matrices, for unknowns in a ring with chords. The last six are
    /// retained.
    #[test]
    fn elimination_of_a_part() {
        const COUNT: usize = 53;
        const INSIDE: usize = 47;
        let mut full = Mat::<f64>::zeros(COUNT, COUNT);
        for i in 0..COUNT {
            for j in [(i + 1) % COUNT, (5 * i + 2) % COUNT, (i + 11) % COUNT] {
                let value = -0.3 - ((3 * i + j) % 5) as f64;
                if i != j && full[(i, j)] == 0.0 {
                    (full[(i, j)], full[(j, i)]) = (value, value);
                }
            }
        }
        for i in 0..COUNT {
            full[(i, i)] = 0.5 + (0..COUNT).filter(|j| *j != i).map(|j| full[(i, j)].abs()).sum::<f64>();
        }
        let rows: Vec<Vec<Entry>> = (0..INSIDE)
            .map(|i| {
                let entries = (i..COUNT).map(|column| Entry { column, value: full[(i, column)] });
                entries.filter(|entry| entry.value != 0.0).collect()
            })
            .collect();
        let bounds: Vec<f64> = (INSIDE..COUNT).map(|i| (INSIDE..COUNT).map(|j| full[(i, j)].abs()).sum()).collect();
        let mut part = PartialCholesky::new(&rows, &bounds).expect("a positive definite matrix");

        let staying = COUNT - INSIDE;
        let mut left: Vec<f64> =
            (0..staying * staying).map(|k| full[(INSIDE + k / staying, INSIDE + k % staying)]).collect();
        part.subtract_from(&mut left, &(0..staying).collect::<Vec<_>>());
        let left = Mat::from_fn(staying, staying, |i, j| left[i * staying + j]);
        let exact: Vec<f64> = (0..COUNT).map(|i| (0.7 * i as f64).sin() + 1.0).collect();
        let mut x: Vec<f64> = (0..COUNT).map(|i| (0..COUNT).map(|j| full[(i, j)] * exact[j]).sum()).collect();
        part.forward(&mut x);
        // The Schur complement acts on the retained unknowns only. The tolerances here and below are the rounding of
        // some dozen operations on numbers below a hundred.
        for i in 0..staying {
            let of_exact: f64 = (0..staying).map(|j| left[(i, j)] * exact[INSIDE + j]).sum();
            assert!((x[INSIDE + i] - of_exact).abs() < 1e-12, "{i}: {} {of_exact}", x[INSIDE + i]);
        }
        x[INSIDE..].copy_from_slice(&exact[INSIDE..]);
        part.backward(&mut x);
        x.iter().zip(&exact).for_each(|(x, exact)| assert!((x - exact).abs() < 1e-12, "{x} {exact}"));

        // A rank without unknowns.
        let mut none = PartialCholesky::new(&[], &[]).expect("a matrix without rows");
        none.forward(&mut []);
        none.subtract_from(&mut [], &[]);

        // A pivot that is not positive.
        let mut rows = rows;
        rows[20][0].value = -1.0;
        assert!(PartialCholesky::new(&rows, &bounds).is_none());
    }
}
