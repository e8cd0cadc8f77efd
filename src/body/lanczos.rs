//! Long Krylov bases of a small symmetric body: Lanczos' recurrence, made orthogonal in blocks.
//!
//! In exact arithmetic S⁻¹M q_j has a part along the last two vectors alone, and only rounding brings back the others. So a vector is made
//! orthogonal to those two and to its own block at once, and to all earlier vectors when the block is full, by products of dense
//! matrices: twice, which is enough (L. Giraud, J. Langou & M. Rozložník, The loss of orthogonality in the Gram–Schmidt orthogonalization
//! process, Comput. Math. Appl. 50, 2005). What it had along earlier vectors is in the basis already, so that nothing is lost with it, as
//! long as it is small (H. D. Simon, The Lanczos algorithm with partial reorthogonalization, Math. Comput. 42, 1984). (Images S q by
//! the same recurrence grow out of all bounds: zero is no eigenvalue.)

use nalgebra::DMatrix;
use petsc_wrap::Vector;

use super::Body;
use super::columns::{Columns, SparseRows};
use super::direct::Direct;
use crate::error::Result;

/// The parts of a vector along earlier ones, at most, before it is corrected.
const SEMI_ORTHOGONAL: f64 = 1e-4;

/// Vectors of the first block, and of any at most.
const FIRST_BLOCK: usize = 8;
const LARGEST_BLOCK: usize = 32;

/// A basis that grows.
pub struct Lanczos {
    /// Orthonormal in M.
    vectors: Columns,
    mass: SparseRows,
    elastic: SparseRows,
    support: Option<SparseRows>,
    /// Unknowns that are held.
    held: Vec<usize>,
    /// Whether the first one is the translation.
    has_translation: bool,
    /// Those that the next vector has a part along in exact arithmetic: the translation, if it is one, and the last two.
    near: Block,
    /// What the next vector is the answer to.
    force: Columns,
    /// Vectors of the next block.
    block: usize,
    is_exhausted: bool,
}

/// Some vectors with their momenta M q.
#[derive(Clone)]
struct Block {
    vectors: Columns,
    momenta: Columns,
}

impl Block {
    fn new(rows: usize) -> Self {
        let none = Columns::new(rows);
        Self { vectors: none.clone(), momenta: none }
    }

    fn count(&self) -> usize {
        self.vectors.count()
    }

    fn range(&self, begin: usize, end: usize) -> Self {
        Self { vectors: self.vectors.range(begin, end), momenta: self.momenta.range(begin, end) }
    }

    fn push(&mut self, vector: &Columns, momentum: &Columns) {
        self.vectors.push(vector.get(0));
        self.momenta.push(momentum.get(0));
    }
}

/// Factors of a body's S, and the ratio of lengths below which a new vector is rounding.
pub struct Solver<'a> {
    /// The factor.
    pub factor: &'a Direct,
    /// That ratio.
    pub exhausted: f64,
}

impl Lanczos {
    /// From a force, with the held unknowns zero; and the translation of a body that nothing holds, a unit in M.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(body: &Body, force: &Vector, translation: Option<&Vector>) -> Result<Self> {
        let rows = force.len();
        let of = |matrix| SparseRows::new(matrix, rows);
        let column = |vector: &Vector| Ok::<_, crate::Error>(Columns::of(vector.read()?.to_vec()));
        let mut lanczos = Self {
            vectors: Columns::new(rows),
            mass: of(&body.mass)?,
            elastic: of(&body.elastic)?,
            support: body.support.as_ref().map(of).transpose()?,
            held: body.clamps.rows.iter().map(|row| *row as usize).collect(),
            has_translation: translation.is_some(),
            near: Block::new(rows),
            force: column(force)?,
            block: FIRST_BLOCK,
            is_exhausted: false,
        };
        if let Some(translation) = translation {
            let translation = column(translation)?;
            lanczos.near.push(&translation, &lanczos.mass.multiply(&translation));
            lanczos.vectors.append(translation);
        }
        Ok(lanczos)
    }

    /// The vectors.
    pub fn vectors(&self) -> &Columns {
        &self.vectors
    }

    /// Whether the basis holds all that the force can reach, to rounding.
    pub fn is_exhausted(&self) -> bool {
        self.is_exhausted
    }

    /// K of the body, K of its supports and no C on the vectors, of which the first are known.
    pub fn project(&self, known: &[DMatrix<f64>; 3]) -> [DMatrix<f64>; 3] {
        let count = self.vectors.count();
        let none = DMatrix::zeros(count, count);
        let support = self.support.as_ref().map(|support| support.project(&self.vectors, &known[1]));
        [self.elastic.project(&self.vectors, &known[0]), support.unwrap_or_else(|| none.clone()), none]
    }

    /// Adds vectors up to a number.
    pub fn grow(&mut self, solver: &Solver, count: usize) {
        while self.vectors.count() < count && !self.is_exhausted {
            let wanted = self.block.min(count - self.vectors.count());
            let (mut block, has_ended) = self.block(solver, wanted);
            let parts = self.vectors.products(&block.momenta);
            let is_kept = |column: &usize| parts.column(*column).iter().all(|part| part.abs() <= SEMI_ORTHOGONAL);
            let kept = (0..block.count()).take_while(is_kept).count();
            if kept == 0 {
                self.one(solver);
                continue;
            }
            // What comes after vectors that are not orthogonal is no sign of an end.
            self.is_exhausted = has_ended && kept == block.count();
            let parts = parts.columns(0, kept).into_owned();
            block = block.range(0, kept);
            block.vectors.subtract(&self.vectors, &parts);
            self.accept(block.vectors);
            self.block = if kept < wanted { kept } else { (2 * kept).clamp(self.block, LARGEST_BLOCK) };
        }
    }

    /// New vectors, orthogonal to each other and to those that they have a part along in exact arithmetic; and whether no more come.
    fn block(&self, solver: &Solver, count: usize) -> (Block, bool) {
        let (mut block, mut vector) = (self.near.clone(), self.force.clone());
        let first = block.count();
        while block.count() < first + count {
            solver.factor.solve_in_place(vector.get_mut(0));
            let parts = block.momenta.products(&vector);
            vector.subtract(&block.vectors, &parts);
            let mut momentum = self.mass.multiply(&vector);
            let square = momentum.products(&vector)[(0, 0)].max(0.0);
            let Some(scale) = length_left(square, square + parts.norm_squared(), solver.exhausted) else {
                return (block.range(first, block.count()), true);
            };
            [&mut vector, &mut momentum].into_iter().for_each(|columns| columns.divide(scale));
            block.push(&vector, &momentum);
            vector = momentum;
            vector.zero_rows(&self.held);
        }
        (block.range(first, block.count()), false)
    }

    /// A vector that is made orthogonal to all others by itself.
    fn one(&mut self, solver: &Solver) {
        let mut vector = self.force.clone();
        solver.factor.solve_in_place(vector.get_mut(0));
        let mut before = 0.0_f64;
        for _ in 0..2 {
            let momentum = self.mass.multiply(&vector);
            before = before.max(momentum.products(&vector)[(0, 0)]);
            let parts = self.vectors.products(&momentum);
            vector.subtract(&self.vectors, &parts);
        }
        let square = self.mass.multiply(&vector).products(&vector)[(0, 0)];
        let Some(scale) = length_left(square, before, solver.exhausted) else {
            self.is_exhausted = true;
            return;
        };
        vector.divide(scale);
        self.accept(vector);
    }

    /// Adds vectors that are orthonormal but for a small part: once more orthogonal to all others, and among themselves.
    fn accept(&mut self, mut block: Columns) {
        let momenta = self.mass.multiply(&block);
        let parts = self.vectors.products(&momenta);
        let mut gram = block.products(&momenta);
        // By Pythagoras' theorem.
        gram.gemm_tr(-1.0, &parts, &parts, 1.0);
        block.subtract(&self.vectors, &parts);
        // Near one, so that it has a factor.
        if let Some(factor) = gram.cholesky() {
            block.divide_by_triangle(&factor.unpack());
        }
        let first = usize::from(self.has_translation);
        self.vectors.append(block);
        let count = self.vectors.count();
        let last = self.vectors.range(count.saturating_sub(2).max(first), count);
        let momenta = self.mass.multiply(&last);
        self.force = momenta.range(momenta.count() - 1, momenta.count());
        self.force.zero_rows(&self.held);
        let mut near = self.near.range(0, first);
        near.vectors.append(last);
        near.momenta.append(momenta);
        self.near = near;
    }
}

/// The length of what is left of a vector; `None` where that is rounding. Squares.
fn length_left(square: f64, before: f64, exhausted: f64) -> Option<f64> {
    (square > exhausted * exhausted * before).then(|| square.sqrt())
}
