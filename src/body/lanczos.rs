//! Long Krylov bases of a small symmetric body: Lanczos recurrence with orthogonalisation in blocks.
//!
//! In exact arithmetic, S⁻¹M q_j has components along the last two vectors only; components along earlier vectors come
//! from rounding. A new vector is therefore orthogonalised at once against these two and its block. When the block is
//! full, it is orthogonalised against all earlier vectors by products of dense matrices. The removed components lie in
//! the basis already, so that nothing is lost as long as they are small (H. D. Simon, The Lanczos algorithm with
//! partial reorthogonalization, Math. Comput. 42, 1984). One pass is then enough, because only rounding remains of
//! small components. (The images S q must not be computed by the same recurrence: they grow without bound, because zero
//! is not an eigenvalue.)

use super::columns::Columns;
use super::linear::{LinearBody, Operator, Properties};
use super::shift::Solver;
use crate::error::Result;

/// Largest component of a new vector along earlier ones before the correction. Vectors with larger components are
/// discarded.
const SEMI_ORTHOGONAL: f64 = 1e-4;

/// Number of vectors of the first block, and largest number of vectors of any block.
const FIRST_BLOCK: usize = 8;
const LARGEST_BLOCK: usize = 32;

/// State of the recurrence.
pub struct Lanczos {
    /// Constrained unknowns.
    held: Vec<usize>,
    /// Whether the first basis vector is the translation.
    has_translation: bool,
    /// Vectors along which the next vector has a component in exact arithmetic: the translation, if it is in the basis,
    /// and the last two.
    near: Block,
    /// Right-hand side of the solution for the next vector.
    force: Columns,
    /// Number of vectors of the next block.
    block: usize,
    is_exhausted: bool,
}

/// Vectors with their momenta M q.
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

/// Data for extending a basis.
pub struct Growing<'a> {
    /// Body whose basis is extended.
    pub body: &'a dyn LinearBody,
    /// Solver with S.
    pub solver: &'a mut Solver,
    /// Ratio of the lengths after and before orthogonalisation below which a new vector is only rounding.
    pub exhausted: f64,
}

impl Growing<'_> {
    fn momenta(&self, vectors: &Columns) -> Result<Columns> {
        self.body.apply(Operator::Mass, vectors)
    }
}

impl Lanczos {
    /// Starts the recurrence from the contact force vector, with zeros at the constrained unknowns. `translation` is
    /// the first basis vector of an unsupported body, of unit length in M; empty for other bodies.
    ///
    /// # Errors
    /// If a PETSc call fails.
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

    /// Whether the basis spans all motions that the force can excite, to rounding.
    pub fn is_exhausted(&self) -> bool {
        self.is_exhausted
    }

    /// Extends a basis, orthonormal in M, up to `count` vectors.
    ///
    /// # Errors
    /// If a PETSc call fails.
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
            // After vectors that were not orthogonal, a short vector does not prove that the basis is complete.
            self.is_exhausted = has_ended && kept == block.count();
            let parts = parts.columns(0, kept).into_owned();
            block = block.leading(kept);
            block.vectors.subtract(basis, &parts);
            self.accept(growing, basis, block.vectors)?;
            self.block = if kept < wanted { kept } else { (2 * kept).clamp(self.block, LARGEST_BLOCK) };
        }
        Ok(())
    }

    /// Returns new vectors, orthogonal to each other and to the vectors in `near`, and whether the recurrence has
    /// ended.
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

    /// Adds a single vector, orthogonalised twice against the whole basis.
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

    /// Appends vectors that are orthogonal to the basis. They are nearly orthonormal to each other; the remaining error
    /// is removed here.
    fn accept(&mut self, growing: &Growing, basis: &mut Columns, mut block: Columns) -> Result<()> {
        let gram = block.products(&growing.momenta(&block)?);
        // The Gram matrix is close to the identity, so that it has a factor.
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

/// Returns the remaining length of a vector after orthogonalisation; `None` if it is only rounding. `square` and
/// `before` are squared lengths.
fn length_left(square: f64, before: f64, exhausted: f64) -> Option<f64> {
    (square > exhausted * exhausted * before).then(|| square.sqrt())
}
