//! Incomplete Cholesky factors in blocks of three unknowns, those of a node, without fill.
//!
//! S ≈ Uᵀ D U with D of blocks on the diagonal and U unit upper triangular, where S has blocks: entries that elimination would add elsewhere
//! are dropped (Meijerink and van der Vorst, Math. Comp. 31, 1977, by blocks), most of each added to the diagonal blocks of its row and its
//! column, so that smooth motions feel the same force (Axelsson and Lindskog, Numer. Math. 48, 1986: relaxed, or modified, factors). Of several
//! ranks each factorises its own rows and columns (block Jacobi). The blocks are kept as V = D U in single precision: a preconditioner need not
//! be exact, and reading it is what it costs.

use std::rc::Rc;

use super::blocks::{Pattern, Triangle};
use super::lanes::{BLOCK, Block, Lanes, Rows, SIZE, Sums, apply};

/// How a factor is tried.
struct Attempt {
    /// Part of what is dropped that goes to the diagonal.
    relaxation: f64,
    /// Added to the diagonal blocks, as a part of them (Manteuffel, Math. Comp. 34, 1980).
    shift: f64,
}

/// The first of these that leaves all blocks on the diagonal positive definite. With nine tenths of what is dropped a step of 2e-5 s takes 11
/// iterations in the place of 16; beyond that, stiffer steps have no such factor.
const ATTEMPTS: [Attempt; 8] = [
    Attempt { relaxation: 0.9, shift: 0.0 },
    Attempt { relaxation: 0.5, shift: 0.0 },
    Attempt { relaxation: 0.0, shift: 0.0 },
    Attempt { relaxation: 0.0, shift: 1e-3 },
    Attempt { relaxation: 0.0, shift: 1e-2 },
    Attempt { relaxation: 0.0, shift: 1e-1 },
    Attempt { relaxation: 0.0, shift: 1.0 },
    Attempt { relaxation: 0.0, shift: 10.0 },
];

/// The factor of this rank's part of a symmetric positive definite matrix.
#[derive(Debug)]
pub(super) struct IncompleteCholesky {
    pattern: Rc<Pattern>,
    /// V beyond its diagonal, by rows, and one number more ([`Rows::read`]); empty where the factor is its diagonal.
    numbers: Vec<f32>,
    /// D⁻¹.
    inverses: Vec<Block>,
    /// A vector in the order of elimination.
    work: Vec<Lanes>,
}

impl IncompleteCholesky {
    /// Of a matrix.
    pub fn new(triangle: &Triangle) -> Self {
        let work = vec![Lanes::default(); triangle.diagonal.len()];
        let mut factor = Self { pattern: triangle.pattern.clone(), numbers: Vec::new(), inverses: Vec::new(), work };
        if ATTEMPTS.iter().any(|attempt| factor.eliminate(triangle, attempt)) {
            return factor;
        }
        // The blocks of the diagonal alone are a preconditioner of every such matrix.
        factor.numbers = Vec::new();
        factor.inverses = triangle.diagonal.iter().map(|block| inverse(block).unwrap_or(IDENTITY)).collect();
        factor
    }

    /// Makes V and D⁻¹; whether D is positive definite. Row by row, each is taken off those of its columns.
    fn eliminate(&mut self, triangle: &Triangle, Attempt { relaxation, shift }: &Attempt) -> bool {
        const NOWHERE: u32 = u32::MAX;
        let Self { pattern, numbers, inverses, .. } = self;
        let Pattern { offsets, columns, .. } = &**pattern;
        *numbers = triangle.numbers.iter().map(|value| *value as f32).collect();
        let (blocks, _) = numbers.as_chunks_mut::<BLOCK>();
        let mut pivots: Vec<Block> =
            triangle.diagonal.iter().map(|block| block.map(|value| (1.0 + shift) * value)).collect();
        // Where a row has its blocks, by column; and which of them the row that it is taken off has too.
        let (mut places, mut has) = (vec![NOWHERE; pivots.len()], Vec::new());
        inverses.clear();
        for node in 0..pivots.len() {
            let Some(pivot) = inverse(&pivots[node]) else { return false };
            inverses.push(pivot);
            let row = offsets[node]..offsets[node + 1];
            row.clone().for_each(|at| places[columns[at] as usize] = at as u32);
            for at in row.clone() {
                let (column, block) = (columns[at] as usize, blocks[at].map(f64::from));
                // VᵀD⁻¹ of this block.
                let left = multiply_transposed(&block, &pivot);
                subtract(&mut pivots[column], &left, &block);
                has.clear();
                has.resize(row.len(), false);
                for below in offsets[column]..offsets[column + 1] {
                    let other = places[columns[below] as usize];
                    if other != NOWHERE {
                        has[other as usize - row.start] = true;
                        let other = blocks[other as usize].map(f64::from);
                        let mut changed = blocks[below].map(f64::from);
                        subtract(&mut changed, &left, &other);
                        blocks[below] = changed.map(|value| value as f32);
                    }
                }
                if *relaxation > 0.0 {
                    for dropped in (at + 1..row.end).filter(|other| !has[other - row.start]) {
                        let mut fill = [0.0; BLOCK];
                        subtract(&mut fill, &left, &blocks[dropped].map(f64::from));
                        add_symmetric(&mut pivots[column], *relaxation, &fill);
                        add_symmetric(&mut pivots[columns[dropped] as usize], *relaxation, &fill);
                    }
                }
            }
            row.for_each(|at| places[columns[at] as usize] = NOWHERE);
        }
        true
    }

    /// x ← (Uᵀ D U)⁻¹ b.
    ///
    /// # Panics
    /// When there are not as many entries as rows.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64]) {
        assert!(b.len() == SIZE * self.work.len() && x.len() == b.len());
        let Self { pattern, numbers, inverses, work } = self;
        pattern.gather(b, work);
        if numbers.is_empty() {
            work.iter_mut().zip(inverses).for_each(|(x, inverse)| *x = Lanes::of(apply(inverse, x.node())));
        } else {
            pulp::Arch::new().dispatch(Solving { pattern, numbers, inverses, x: work });
        }
        let (nodes, _) = x.as_chunks_mut::<SIZE>();
        pattern.order.iter().zip(work).for_each(|(node, x)| nodes[*node as usize] = x.node());
    }
}

/// Both sweeps, compiled for the vectors of each kind of processor.
struct Solving<'a> {
    pattern: &'a Pattern,
    numbers: &'a [f32],
    inverses: &'a [Block],
    x: &'a mut [Lanes],
}

impl pulp::NullaryFnOnce for Solving<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { pattern: Pattern { offsets, columns, .. }, numbers, inverses, x } = self;
        let row = |at: usize| {
            let row = offsets[at]..offsets[at + 1];
            let blocks = numbers[BLOCK * row.start..=BLOCK * row.end].windows(BLOCK + 1).step_by(BLOCK);
            columns[row].iter().zip(blocks)
        };
        for (at, inverse) in inverses.iter().enumerate() {
            let own = apply(inverse, x[at].node()).map(|value| -value);
            for (column, block) in row(at) {
                let column = *column as usize;
                x[column] = Rows::read(block).add_transposed(own, x[column]);
            }
        }
        for (at, inverse) in inverses.iter().enumerate().rev() {
            let mut sums = Sums::default();
            for (column, block) in row(at) {
                sums.add(Rows::read(block), x[*column as usize]);
            }
            let (own, beyond) = (x[at].node(), sums.total());
            x[at] = Lanes::of(apply(inverse, std::array::from_fn(|i| own[i] - beyond[i])));
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

/// to ← to + factor · (block + blockᵀ) / 2.
fn add_symmetric(to: &mut Block, factor: f64, block: &Block) {
    for i in 0..SIZE {
        for j in 0..SIZE {
            to[SIZE * i + j] += 0.5 * factor * (block[SIZE * i + j] + block[SIZE * j + i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three nodes in a row: S in blocks, by rows, of a positive definite matrix whose elimination adds nothing.
    fn chain() -> Triangle {
        let stiff = [4.0, 1.0, 0.5, 1.0, 5.0, -1.0, 0.5, -1.0, 6.0];
        let coupling = [-1.0, 0.25, 0.5, 0.125, -2.0, 0.0, 0.75, 0.5, -1.5];
        let pattern = Pattern { order: vec![2, 0, 1], offsets: vec![0, 1, 2, 2], columns: vec![1, 2] };
        let numbers = [coupling.as_slice(), &coupling, &[0.0]].concat();
        Triangle { pattern: Rc::new(pattern), diagonal: vec![stiff; 3], numbers }
    }

    /// A triangle of nodes, each beside the next, and a fourth beside all but the second: eliminating the first drops an entry.
    fn with_a_gap() -> Triangle {
        let stiff = |k: f64| [k, 0.0, 0.0, 0.0, k, 0.0, 0.0, 0.0, k];
        let pattern = Pattern { order: vec![0, 1, 2, 3], offsets: vec![0, 3, 4, 5, 5], columns: vec![1, 2, 3, 2, 3] };
        let numbers: Vec<f64> = std::iter::repeat_n(stiff(-1.0), 5).flatten().chain([0.0]).collect();
        Triangle { pattern: Rc::new(pattern), diagonal: [4.0, 3.0, 4.0, 3.0].map(stiff).to_vec(), numbers }
    }

    /// Without entries to drop, the factor is exact but for single precision, and the product is its inverse.
    #[test]
    fn a_chain_of_nodes_is_solved() {
        let triangle = chain();
        let exact: Vec<f64> = (0..9).map(|i| f64::from(i).sin()).collect();
        let (mut from, mut to) = (vec![Lanes::default(); 3], vec![Lanes([7.0; 4]); 3]);
        triangle.pattern.gather(&exact, &mut from);
        assert_eq!(from[0].node(), exact[6..]);
        triangle.multiply(&from, &mut to);
        let mut b = vec![0.0; 9];
        for (node, sum) in triangle.pattern.order.iter().zip(to) {
            b[SIZE * *node as usize..][..SIZE].copy_from_slice(&sum.node());
        }
        // By hand: the second of the chain has both neighbours.
        let coupling: Block = triangle.numbers[..BLOCK].try_into().unwrap();
        let [first, second, third] = [from[0], from[1], from[2]].map(Lanes::node);
        let above = apply(&multiply_transposed(&coupling, &IDENTITY), first);
        let (here, beyond) = (apply(&triangle.diagonal[0], second), apply(&coupling, third));
        (0..3).for_each(|i| assert!((b[i] - above[i] - here[i] - beyond[i]).abs() < 1e-14));
        let mut x = vec![0.0; 9];
        IncompleteCholesky::new(&triangle).solve(&b, &mut x);
        let error = x.iter().zip(&exact).map(|(x, exact)| (x - exact).abs()).fold(0.0, f64::max);
        // The condition number is some tens.
        assert!(error < 1e-5 && error > 0.0, "{error:e}");
    }

    /// With all that is dropped on the diagonal, a motion of all nodes alike feels the force that it feels in the matrix.
    #[test]
    fn what_is_dropped_goes_to_the_diagonal() {
        let triangle = with_a_gap();
        let translation = vec![Lanes::of([1.0, 2.0, 3.0]); 4];
        let mut force = vec![Lanes::default(); 4];
        triangle.multiply(&translation, &mut force);
        let force: Vec<f64> = force.into_iter().flat_map(Lanes::node).collect();
        let error = |relaxation: f64| {
            let mut factor = IncompleteCholesky::new(&triangle);
            assert!(factor.eliminate(&triangle, &Attempt { relaxation, shift: 0.0 }));
            let mut x = vec![0.0; 12];
            factor.solve(&force, &mut x);
            x.iter().enumerate().map(|(i, x)| (x - (i % SIZE + 1) as f64).abs()).fold(0.0, f64::max)
        };
        assert!(error(1.0) < 1e-6 && error(0.0) > 0.1, "{:e} {:e}", error(1.0), error(0.0));
    }

    /// A block that is not positive definite is found out, also where only elimination makes it so; a shift cures it, and the diagonal alone
    /// serves where nothing does.
    #[test]
    fn an_indefinite_block_is_told() {
        for (block, shift, is_definite) in [(0, 0.0, false), (2, 0.0, false), (2, 10.0, true)] {
            let mut triangle = chain();
            triangle.diagonal[block] = if block == 0 { IDENTITY.map(|value| -value) } else { IDENTITY };
            let mut factor = IncompleteCholesky::new(&chain());
            let attempt = Attempt { relaxation: 0.0, shift };
            assert_eq!(factor.eliminate(&triangle, &attempt), is_definite, "{block} {shift}");
            let mut x = vec![f64::NAN; 9];
            IncompleteCholesky::new(&triangle).solve(&[1.0; 9], &mut x);
            assert!(x.iter().all(|x| x.is_finite() && *x != 0.0));
        }
        assert_eq!(inverse(&[f64::NAN; 9]), None);
    }
}
