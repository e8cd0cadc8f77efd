//! Long Krylov bases of a small symmetric body: Lanczos' recurrence, made orthogonal in blocks.
//!
//! In exact arithmetic S⁻¹M q_j has a part along the last two vectors alone, and only rounding brings back the others. So a vector is made
//! orthogonal to those two and to its own block at once, and to all earlier vectors when the block is full, by products of dense
//! matrices. Vectors of the block that are orthogonal but for a small part are accepted: for them one such correction leaves rounding (H. D.
//! Simon, The Lanczos algorithm with partial reorthogonalization, Math. Comput. 42, 1984). (Images S q by the same recurrence grow out of all bounds: zero is no eigenvalue.)

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::DMatrix;
use petsc_wrap::Vector;

use super::Body;
use super::direct::Direct;
use crate::error::Result;

/// The parts of a vector along earlier ones, at most, before it is corrected. Below √ε one correction leaves rounding; smaller ones keep
/// what rounding adds to the later vectors of a block small.
const SEMI_ORTHOGONAL: f64 = 1e-10;

/// Vectors of the first block, and of any at most.
const FIRST_BLOCK: usize = 8;
const LARGEST_BLOCK: usize = 32;

/// Columns that are projected at a time.
const PROJECTED: usize = 64;

/// Vectors of a length, one after the other.
#[derive(Debug, Clone, Default)]
pub struct Columns {
    rows: usize,
    entries: Vec<f64>,
}

impl Columns {
    /// None yet, of a length.
    pub fn new(rows: usize) -> Self {
        Self { rows, entries: Vec::new() }
    }

    /// One of them.
    fn of(entries: Vec<f64>) -> Self {
        Self { rows: entries.len(), entries }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.entries.len() / self.rows.max(1)
    }

    /// One of them.
    pub fn get(&self, number: usize) -> &[f64] {
        &self.entries[number * self.rows..(number + 1) * self.rows]
    }

    /// Adds one.
    pub fn push(&mut self, column: &[f64]) {
        self.entries.extend_from_slice(column);
    }

    /// Some of them, from one to before another.
    fn range(&self, begin: usize, end: usize) -> Self {
        Self { rows: self.rows, entries: self.entries[begin * self.rows..end * self.rows].to_vec() }
    }

    fn append(&mut self, mut other: Self) {
        self.entries.append(&mut other.entries);
    }

    fn matrix(&self) -> MatRef<'_, f64> {
        self.leading(self.count())
    }

    fn leading(&self, count: usize) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.entries[..count * self.rows], self.rows, count)
    }

    fn matrix_mut(&mut self) -> MatMut<'_, f64> {
        let count = self.count();
        MatMut::from_column_major_slice_mut(&mut self.entries, self.rows, count)
    }

    /// selfᵀ other.
    fn products(&self, other: MatRef<'_, f64>) -> DMatrix<f64> {
        self.leading_products(self.count(), other)
    }

    /// The same of the first ones alone.
    fn leading_products(&self, count: usize, other: MatRef<'_, f64>) -> DMatrix<f64> {
        let mut products = DMatrix::zeros(count, other.ncols());
        let into = MatMut::from_column_major_slice_mut(products.as_mut_slice(), count, other.ncols());
        matmul(into, Accum::Replace, self.leading(count).transpose(), other, 1.0, Par::Seq);
        products
    }

    /// self ← self − others · parts.
    fn subtract(&mut self, others: &Self, parts: &DMatrix<f64>) {
        let parts = MatRef::from_column_major_slice(parts.as_slice(), parts.nrows(), parts.ncols());
        matmul(self.matrix_mut(), Accum::Add, others.matrix(), parts, -1.0, Par::Seq);
    }

    /// Inner products with a vector, a row each.
    pub fn along(&self, vector: &[f64]) -> DMatrix<f64> {
        self.products(MatRef::from_column_major_slice(vector, self.rows, 1))
    }

    /// selfᵀ A self of a symmetric operator; the first rows and columns are known. Entries where all images are zero, as of supports, are
    /// passed over.
    ///
    /// # Errors
    /// The operator's.
    pub fn project(
        &self,
        known: &DMatrix<f64>,
        mut apply: impl FnMut(&[f64]) -> Result<Vec<f64>>,
    ) -> Result<DMatrix<f64>> {
        let (first, count) = (known.nrows(), self.count());
        let mut gram = known.clone().resize(count, count, 0.0);
        for begin in (first..count).step_by(PROJECTED) {
            let end = count.min(begin + PROJECTED);
            let mut images = Self::new(self.rows);
            for number in begin..end {
                images.push(&apply(self.get(number))?);
            }
            let entries: Vec<usize> = (0..self.rows)
                .filter(|&i| images.entries[i..].iter().step_by(self.rows).any(|entry| *entry != 0.0))
                .collect();
            let products = if 2 * entries.len() > self.rows {
                self.leading_products(end, images.matrix())
            } else {
                let of = |columns: &Self, count: usize| Self {
                    rows: entries.len(),
                    entries: (0..count).flat_map(|n| entries.iter().map(move |&i| columns.get(n)[i])).collect(),
                };
                of(self, end).products(of(&images, end - begin).matrix())
            };
            for (j, column) in (begin..end).zip(products.column_iter()) {
                for i in 0..=j {
                    gram[(i, j)] = column[i];
                    gram[(j, i)] = column[i];
                }
            }
        }
        Ok(gram)
    }
}

/// A basis that grows.
pub struct Lanczos {
    /// Orthonormal in M.
    vectors: Columns,
    /// Whether the first one is the translation.
    has_translation: bool,
    /// Those that the next vector has a part along in exact arithmetic: the translation, if it is one, and the last two.
    near: Block,
    /// What the next vector is the answer to.
    force: Vec<f64>,
    /// Vectors of the next block.
    block: usize,
    is_exhausted: bool,
    work: [Vector; 2],
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

    fn push(&mut self, vector: &[f64], momentum: &[f64]) {
        self.vectors.push(vector);
        self.momenta.push(momentum);
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
        let mut lanczos = Self {
            vectors: Columns::new(rows),
            has_translation: translation.is_some(),
            near: Block::new(rows),
            force: force.read()?.to_vec(),
            block: FIRST_BLOCK,
            is_exhausted: false,
            work: [force.duplicate()?, force.duplicate()?],
        };
        if let Some(translation) = translation {
            let translation = translation.read()?.to_vec();
            let momentum = lanczos.momentum(body, &translation)?;
            lanczos.vectors.push(&translation);
            lanczos.near.push(&translation, &momentum);
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
    ///
    /// # Errors
    /// PETSc's.
    pub fn project(&mut self, body: &Body, known: &[DMatrix<f64>; 3]) -> Result<[DMatrix<f64>; 3]> {
        let (count, [of, image]) = (self.vectors.count(), &mut self.work);
        let none = DMatrix::zeros(count, count);
        let mut on = |known: &DMatrix<f64>, apply: &dyn Fn(&Vector, &mut Vector) -> Result<()>| {
            self.vectors.project(known, |entries| {
                of.write()?.copy_from_slice(entries);
                apply(of, image)?;
                Ok(image.read()?.to_vec())
            })
        };
        let elastic = on(&known[0], &|v, out| body.apply_elastic(v, out))?;
        let support = match &body.support {
            Some(matrix) => on(&known[1], &|v, out| Ok(matrix.mult(v, out)?))?,
            None => none.clone(),
        };
        Ok([elastic, support, none])
    }

    /// Adds vectors up to a number.
    ///
    /// # Errors
    /// PETSc's.
    pub fn grow(&mut self, body: &Body, solver: &Solver, count: usize) -> Result<()> {
        while self.vectors.count() < count && !self.is_exhausted {
            let wanted = self.block.min(count - self.vectors.count());
            let mut block = self.block(body, solver, wanted)?;
            let parts = self.vectors.products(block.momenta.matrix());
            let is_kept = |column: &usize| parts.column(*column).iter().all(|part| part.abs() <= SEMI_ORTHOGONAL);
            let kept = (0..block.count()).take_while(is_kept).count();
            if kept == 0 {
                self.is_exhausted = false;
                self.one(body, solver)?;
                continue;
            }
            // What comes after vectors that are not orthogonal is no sign of an end.
            self.is_exhausted &= kept == block.count();
            let parts = parts.columns(0, kept).into_owned();
            block = block.range(0, kept);
            block.vectors.subtract(&self.vectors, &parts);
            self.accept(body, block)?;
            self.block = if kept < wanted { kept } else { (2 * kept).clamp(self.block, LARGEST_BLOCK) };
        }
        Ok(())
    }

    /// New vectors, orthogonal to each other and to those that they have a part along in exact arithmetic.
    fn block(&mut self, body: &Body, solver: &Solver, count: usize) -> Result<Block> {
        let (mut block, mut force) = (self.near.clone(), self.force.clone());
        let first = block.count();
        while block.count() < first + count {
            let mut vector = Columns::of(force.clone());
            solver.factor.solve_in_place(&mut vector.entries);
            let parts = block.momenta.along(&vector.entries);
            vector.subtract(&block.vectors, &parts);
            let mut momentum = self.momentum(body, &vector.entries)?;
            let square = product(&momentum, &vector.entries).max(0.0);
            let Some(scale) = length_left(square, square + parts.norm_squared(), solver.exhausted) else {
                self.is_exhausted = true;
                break;
            };
            [&mut vector.entries, &mut momentum].into_iter().for_each(|entries| divide(entries, scale));
            force = without_held(body, momentum.clone());
            block.push(&vector.entries, &momentum);
        }
        Ok(block.range(first, block.count()))
    }

    /// A vector that is made orthogonal to all others, twice.
    fn one(&mut self, body: &Body, solver: &Solver) -> Result<()> {
        let mut vector = Columns::of(self.force.clone());
        solver.factor.solve_in_place(&mut vector.entries);
        let mut before = 0.0_f64;
        for _ in 0..2 {
            let momentum = self.momentum(body, &vector.entries)?;
            before = before.max(product(&momentum, &vector.entries));
            let parts = self.vectors.along(&momentum);
            vector.subtract(&self.vectors, &parts);
        }
        let mut momentum = self.momentum(body, &vector.entries)?;
        let Some(scale) = length_left(product(&momentum, &vector.entries), before, solver.exhausted) else {
            self.is_exhausted = true;
            return Ok(());
        };
        [&mut vector.entries, &mut momentum].into_iter().for_each(|entries| divide(entries, scale));
        let mut block = Block::new(self.force.len());
        block.push(&vector.entries, &momentum);
        self.accept(body, block)
    }

    /// Adds the vectors of a block, which are orthogonal to all others.
    fn accept(&mut self, body: &Body, block: Block) -> Result<()> {
        let first = usize::from(self.has_translation);
        let mut all = self.near.clone();
        let count = all.count() + block.count();
        all.vectors.append(block.vectors.clone());
        // The momenta of the corrected vectors.
        all.momenta.append(block.momenta);
        let mut near = all.range(0, first);
        for number in count.saturating_sub(2).max(first)..count {
            let momentum = self.momentum(body, all.vectors.get(number))?;
            near.push(all.vectors.get(number), &momentum);
        }
        self.force = without_held(body, near.momenta.get(near.count() - 1).to_vec());
        self.near = near;
        self.vectors.append(block.vectors);
        Ok(())
    }

    /// M q.
    fn momentum(&mut self, body: &Body, vector: &[f64]) -> Result<Vec<f64>> {
        let [of, momentum] = &mut self.work;
        of.write()?.copy_from_slice(vector);
        body.apply_mass(of, momentum)?;
        Ok(momentum.read()?.to_vec())
    }
}

/// The length of what is left of a vector; `None` where that is rounding. Squares.
fn length_left(square: f64, before: f64, exhausted: f64) -> Option<f64> {
    (square > exhausted * exhausted * before).then(|| square.sqrt())
}

fn without_held(body: &Body, mut vector: Vec<f64>) -> Vec<f64> {
    body.clamps.rows.iter().for_each(|row| vector[*row as usize] = 0.0);
    vector
}

fn divide(entries: &mut [f64], divisor: f64) {
    entries.iter_mut().for_each(|entry| *entry /= divisor);
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (MatRef::from_row_major_slice(a, 1, a.len()), MatRef::from_column_major_slice(b, b.len(), 1));
    (a * b)[(0, 0)]
}
