//! Long Krylov bases of a small symmetric body: Lanczos' recurrence, made orthogonal in blocks.
//!
//! In exact arithmetic S⁻¹M q_j has a part along the last two vectors alone, and only rounding brings back the others. So a vector is made
//! orthogonal to those two and to its own block at once, and to all earlier vectors when the block is full, by products of dense
//! matrices. What it had along earlier vectors is in the basis already, so that nothing is lost with it, as long as it is small
//! (H. D. Simon, The Lanczos algorithm with partial reorthogonalization, Math. Comput. 42, 1984). Then once is enough, too: what is left
//! of small parts is rounding. (Images S q by the same recurrence grow out of all bounds: zero is no eigenvalue.)

use super::columns::Columns;
use super::linear::{LinearBody, Operator, Properties};
use super::shift::Solver;
use crate::error::Result;

/// The parts of a vector along earlier ones, at most, before it is corrected.
const SEMI_ORTHOGONAL: f64 = 1e-4;

/// Vectors of the first block, and of any at most.
const FIRST_BLOCK: usize = 8;
const LARGEST_BLOCK: usize = 32;

/// How a basis grows.
pub struct Lanczos {
    /// Unknowns that are held.
    held: Vec<usize>,
    /// Whether the first vector is the translation.
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
    fn count(&self) -> usize {
        self.vectors.count()
    }

    fn leading(&self, count: usize) -> Self {
        Self { vectors: self.vectors.range(0..count), momenta: self.momenta.range(0..count) }
    }
}

/// A body, its S, and the ratio of lengths below which a new vector is rounding.
pub struct Growing<'a> {
    /// The body.
    pub body: &'a dyn LinearBody,
    /// Solves with S.
    pub solver: &'a mut Solver,
    /// That ratio.
    pub exhausted: f64,
}

impl Growing<'_> {
    fn momenta(&self, vectors: &Columns) -> Result<Columns> {
        self.body.apply(Operator::Mass, vectors)
    }
}

impl Lanczos {
    /// From a body's force, with the held unknowns zero; its translation, a unit in M, is the first of the basis where nothing holds it.
    ///
    /// # Errors
    /// PETSc's.
    pub fn new(body: &dyn LinearBody, properties: &Properties, force: &Columns, translation: &Columns) -> Result<Self> {
        Ok(Self {
            held: properties.held.clone(),
            has_translation: translation.count() > 0,
            near: Block { vectors: translation.clone(), momenta: body.apply(Operator::Mass, translation)? },
            force: force.clone(),
            block: FIRST_BLOCK,
            is_exhausted: false,
        })
    }

    /// Whether the basis holds all that the force can reach, to rounding.
    pub fn is_exhausted(&self) -> bool {
        self.is_exhausted
    }

    /// Adds vectors to a basis, orthonormal in M, up to a number.
    ///
    /// # Errors
    /// PETSc's.
    pub fn grow(&mut self, growing: &mut Growing, basis: &mut Columns, count: usize) -> Result<()> {
        while basis.count() < count && !self.is_exhausted {
            let wanted = self.block.min(count - basis.count());
            let (mut block, has_ended) = self.block(growing, wanted)?;
            let parts = basis.products(&block.momenta);
            let is_kept = |column: &usize| parts.column(*column).iter().all(|part| part.abs() <= SEMI_ORTHOGONAL);
            let kept = (0..block.count()).take_while(is_kept).count();
            if kept == 0 {
                self.one(growing, basis)?;
                continue;
            }
            // What comes after vectors that are not orthogonal is no sign of an end.
            self.is_exhausted = has_ended && kept == block.count();
            let parts = parts.columns(0, kept).into_owned();
            block = block.leading(kept);
            block.vectors.subtract(basis, &parts);
            self.accept(growing, basis, block.vectors)?;
            self.block = if kept < wanted { kept } else { (2 * kept).clamp(self.block, LARGEST_BLOCK) };
        }
        Ok(())
    }

    /// New vectors, orthogonal to each other and to those that they have a part along in exact arithmetic; and whether no more come.
    fn block(&self, growing: &mut Growing, count: usize) -> Result<(Block, bool)> {
        let (mut block, mut vector) = (self.near.clone(), self.force.clone());
        let first = block.count();
        let mut has_ended = false;
        while block.count() < first + count {
            growing.solver.solve_in_place(vector.get_mut(0))?;
            let parts = block.momenta.products(&vector);
            vector.subtract(&block.vectors, &parts);
            let mut momentum = growing.momenta(&vector)?;
            let square = momentum.dot(&vector).max(0.0);
            let Some(scale) = length_left(square, square + parts.norm_squared(), growing.exhausted) else {
                has_ended = true;
                break;
            };
            [&mut vector, &mut momentum].into_iter().for_each(|columns| columns.scale(1.0 / scale));
            block.vectors.push(vector.get(0));
            block.momenta.push(momentum.get(0));
            vector = momentum;
            vector.zero_rows(&self.held);
        }
        let new = first..block.count();
        Ok((Block { vectors: block.vectors.range(new.clone()), momenta: block.momenta.range(new) }, has_ended))
    }

    /// A vector that is made orthogonal to all others by itself.
    fn one(&mut self, growing: &mut Growing, basis: &mut Columns) -> Result<()> {
        let mut vector = self.force.clone();
        growing.solver.solve_in_place(vector.get_mut(0))?;
        let mut before = 0.0_f64;
        for _ in 0..2 {
            let momentum = growing.momenta(&vector)?;
            before = before.max(momentum.dot(&vector));
            let parts = basis.products(&momentum);
            vector.subtract(basis, &parts);
        }
        let square = growing.momenta(&vector)?.dot(&vector);
        let Some(scale) = length_left(square, before, growing.exhausted) else {
            self.is_exhausted = true;
            return Ok(());
        };
        vector.scale(1.0 / scale);
        self.accept(growing, basis, vector)
    }

    /// Adds vectors that are orthogonal to all others, and orthonormal among themselves but for a small part, which is taken away.
    fn accept(&mut self, growing: &Growing, basis: &mut Columns, mut block: Columns) -> Result<()> {
        let gram = block.products(&growing.momenta(&block)?);
        // Near one, so that it has a factor.
        if let Some(factor) = gram.cholesky() {
            block.divide_by_triangle(&factor.unpack());
        }
        basis.append(block);
        let (first, count) = (usize::from(self.has_translation), basis.count());
        let last = basis.range(count.saturating_sub(2).max(first)..count);
        let momenta = growing.momenta(&last)?;
        self.force = momenta.range(momenta.count() - 1..momenta.count());
        self.force.zero_rows(&self.held);
        self.near = self.near.leading(first);
        self.near.vectors.append(last);
        self.near.momenta.append(momenta);
        Ok(())
    }
}

/// The length of what is left of a vector; `None` where that is rounding. Squares.
fn length_left(square: f64, before: f64, exhausted: f64) -> Option<f64> {
    (square > exhausted * exhausted * before).then(|| square.sqrt())
}
