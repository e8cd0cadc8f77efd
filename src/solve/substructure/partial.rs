//! The Cholesky factor of a matrix of which a part of the unknowns is eliminated and the others, the last ones, stay.
//!
//! With A_ii = L Lᵀ, W = A_bi L⁻ᵀ: [L; W] are the columns that are eliminated, and W Wᵀ = A_bi A_ii⁻¹ A_ib is what that takes off A_bb.
//! faer factorises the matrix with a diagonal in the place of A_bb, which changes neither L nor W.

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

/// More than the magnitudes of the interface, so that what is left of it after the elimination is positive definite.
const MARGIN: f64 = 2.0;

/// The factor.
pub(super) struct PartialCholesky {
    /// Unknowns that are eliminated.
    inside: usize,
    /// The unknown in each place of the order of elimination; those that stay are last, as they were.
    order: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
    /// By supernodes: each has its columns one after the other, full.
    entries: Vec<f64>,
    /// The diagonal in the place of A_bb.
    diagonal: Vec<f64>,
    /// A vector in the order of elimination.
    ordered: Vec<f64>,
    /// The rows of a supernode.
    work: Vec<f64>,
}

impl PartialCholesky {
    /// Of the lower triangle of a matrix, `rows` being those that are eliminated, from their diagonals on; `bounds`, one for each unknown that stays,
    /// are no less than what the elimination takes off its diagonal. `None` where it is not positive definite.
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

    /// Subtracts W Wᵀ from a full symmetric matrix; `places` are those of the unknowns that stay in its rows.
    pub fn subtract_from(&self, matrix: &mut [f64], places: &[usize]) {
        let (staying, count) = (places.len(), matrix.len().isqrt());
        // The factor of what is left of the diagonal.
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

    /// f_i, f_b → L⁻¹ f_i, f_b − W L⁻¹ f_i.
    pub fn forward(&mut self, x: &mut [f64]) {
        self.sweep(x, Direction::Forward);
    }

    /// y_i, x_b → L⁻ᵀ (y_i − Wᵀ x_b), x_b.
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

/// The order of elimination: those that are eliminated so that little is filled in (Amestoy, Davis and Duff, SIAM J. Matrix Anal. Appl. 17,
/// 1996), then those that stay. `None` where there are too many to count.
///
/// Those that stay count as coupled to each other, so that what is near them goes late: else what it is coupled to would be filled in with all of
/// them.
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
    // No row is left out for being long.
    let control = amd::Control { dense: -1.0, ..Default::default() };
    amd::order(&mut order, &mut inverse, pattern, control, MemStack::new(&mut scratch)).ok()?;
    order.retain(|unknown| *unknown < inside);
    order.extend(inside..count);
    Some(order)
}

/// Columns of a factor with the same rows below them.
#[derive(Clone, Copy)]
struct Supernode<'a> {
    /// The first of the columns.
    first: usize,
    columns: usize,
    /// The rows below, ascending.
    below: &'a [usize],
    /// Its columns one after the other, each of the rows of the columns and those below.
    entries: &'a [f64],
}

impl<'a> Supernode<'a> {
    fn rows(&self) -> usize {
        self.columns + self.below.len()
    }

    /// The values of its columns among those of all unknowns, of which those inside are eliminated, in a place to work at.
    #[inline(always)]
    fn taken<'w>(&self, inside: usize, x: &[f64], work: &'w mut [f64]) -> Taken<'w> {
        let eliminated = self.columns.min(inside - self.first);
        let work = &mut work[..self.rows()];
        work[..self.columns].copy_from_slice(&x[self.first..self.first + self.columns]);
        Taken { eliminated, whole: eliminated - eliminated % TOGETHER, work }
    }

    /// Which row of the factor is one of its own.
    fn row(&self, number: usize) -> usize {
        if number < self.columns { self.first + number } else { self.below[number - self.columns] }
    }

    #[inline(always)]
    fn column(&self, number: usize) -> &'a [f64] {
        let rows = self.rows();
        &self.entries[number * rows..(number + 1) * rows]
    }

    /// `TOGETHER` columns, each from the first one's row on.
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
        // That of a matrix without rows alone, for the other kind is asked for.
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
    /// By L⁻¹.
    Forward,
    /// By L⁻ᵀ.
    Backward,
}

/// A sweep over the columns that are eliminated, compiled for the vectors of each kind of processor.
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
        // (The columns of what stays are last; one supernode may have of both.)
        let nodes = nodes.take_while(|node| node.first < inside);
        // (Loops, since closures are not compiled for these vectors.)
        match direction {
            Direction::Forward => {
                for node in nodes {
                    forward(simd, &node, inside, x, work);
                }
            }
            Direction::Backward => {
                // (A list, since what is taken from the front cannot be taken from the back.)
                let nodes: Vec<Supernode> = nodes.collect();
                for node in nodes.iter().rev() {
                    backward(simd, node, inside, x, work);
                }
            }
        }
    }
}

/// What a sweep begins a supernode with.
struct Taken<'a> {
    /// How many of its columns are eliminated.
    eliminated: usize,
    /// How many of these go together.
    whole: usize,
    /// The values of its columns, and room for those of the rows below.
    work: &'a mut [f64],
}

#[inline(always)]
fn forward<S: Simd>(simd: S, node: &Supernode, inside: usize, x: &mut [f64], work: &mut [f64]) {
    let Supernode { first, columns, below, .. } = *node;
    let Taken { eliminated, whole, work } = node.taken(inside, x, work);
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
    let Taken { eliminated, whole, work } = node.taken(inside, x, work);
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

    /// Sweeps and what elimination leaves, against full matrices: unknowns in a ring with chords, of which the last six stay.
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
        // What is left acts on those that stay alone. (The rounding of some dozen operations on numbers below a hundred, here and below.)
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
