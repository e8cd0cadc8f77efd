//! A basis of a body whose motions split into uncoupled symmetry classes: the union of one basis for each class.
//!
//! Each class is a smaller body with an individual basis, so that vectors are orthogonalised only within their class.
//! The classes add vectors in turn, which keeps the bases nested ([`Projection::leading`]).

use std::convert::Infallible;

use nalgebra::{DMatrix, DVector};

use super::columns::Columns;
use super::{BodyTerms, DiagonalSymmetry, Krylov, LinearBody, Projection, Start};
use crate::error::Result;

/// A growing basis, with the projection of the body onto it.
pub struct DirectSum {
    /// One basis for each class.
    parts: Vec<Krylov>,
    /// Class of each basis vector.
    class_of: Vec<usize>,
    /// Class that adds the next vector.
    turn: usize,
    /// Map from the only class to the whole body, if that class is the part symmetric about the diagonal.
    exchange: Option<DiagonalSymmetry>,
    /// Basis vectors in the unknowns of the whole body, if these differ from the unknowns of the classes. Filled on
    /// request.
    whole: Columns,
}

impl DirectSum {
    /// Factorises S of each class. Collective.
    ///
    /// # Errors
    /// Same as [`Krylov::new`].
    pub fn new(body: &dyn LinearBody, start: impl Into<Start>) -> Result<Self> {
        let start = start.into();
        let parts = body.classes().into_iter().map(|class| Krylov::new(class, start)).collect::<Result<Vec<_>>>()?;
        let class_of = parts.iter().enumerate().flat_map(|(class, part)| vec![class; part.vectors()]).collect();
        let exchange = body.exchange().cloned();
        let of_parts = || parts.iter().map(|part| part.basis().rows()).sum();
        let rows = exchange.as_ref().map_or_else(of_parts, DiagonalSymmetry::unknowns);
        Ok(Self { parts, class_of, turn: 0, exchange, whole: Columns::new(rows, None) })
    }

    /// Number of vectors so far.
    pub fn vectors(&self) -> usize {
        self.class_of.len()
    }

    /// Whether the basis spans all motions that the force can excite, to rounding.
    pub fn is_exhausted(&self) -> bool {
        self.parts.iter().all(Krylov::is_exhausted)
    }

    /// Extends the basis up to `vectors` vectors. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn grow(&mut self, body: &dyn LinearBody, vectors: usize) -> Result<()> {
        let of_class = body.classes();
        if let [part] = &mut self.parts[..] {
            part.grow(of_class[0], vectors)?;
            self.class_of.resize(part.vectors(), 0);
            return Ok(());
        }
        // Each class adds its part of the missing vectors at once. Vectors that exhausted classes cannot add are added by
        // the others, in further rounds.
        while self.vectors() < vectors && !self.is_exhausted() {
            let missing = vectors - self.vectors();
            let mut made: Vec<usize> = self.parts.iter().map(Krylov::vectors).collect();
            let able: Vec<usize> = (0..self.parts.len()).filter(|class| !self.parts[*class].is_exhausted()).collect();
            // The classes add vectors in turn, beginning with the one whose turn it is.
            let first = able.iter().position(|class| *class >= self.turn).unwrap_or(0);
            for (place, &class) in able.iter().enumerate() {
                let turns = (able.len() + place - first) % able.len();
                let more = (missing + able.len() - 1 - turns) / able.len();
                self.parts[class].grow(of_class[class], made[class] + more)?;
            }
            while self.parts.iter().zip(&made).any(|(part, made)| part.vectors() > *made) {
                if self.parts[self.turn].vectors() > made[self.turn] {
                    self.class_of.push(self.turn);
                    made[self.turn] += 1;
                }
                self.turn = (self.turn + 1) % self.parts.len();
            }
        }
        Ok(())
    }

    /// Returns the body projected onto the basis. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn projection(&mut self, body: &dyn LinearBody) -> Result<Projection> {
        if let [part] = &mut self.parts[..] {
            return part.projection(body.classes()[0]);
        }
        let parts = self.parts.iter_mut().zip(body.classes());
        let projections = parts.map(|(part, class)| part.projection(class)).collect::<Result<Vec<_>>>()?;
        Ok(sum(&projections, &self.class_of))
    }

    /// Returns all rows of the first vectors on the first rank. On other ranks, distributed vectors are returned
    /// without rows. Collective.
    pub fn whole(&self, count: usize) -> Vec<Vec<f64>> {
        if let [part] = &self.parts[..] {
            return match &self.exchange {
                None => part.basis().whole(count),
                Some(exchange) => part.basis().iter().take(count).map(|own| exchange.whole(own)).collect(),
            };
        }
        let mut next = vec![0; self.parts.len()];
        let vector = |&class: &usize| {
            let own = self.parts[class].basis().get(next[class]);
            next[class] += 1;
            let mut whole = vec![0.0; self.whole.rows()];
            whole[class * own.len()..(class + 1) * own.len()].copy_from_slice(own);
            whole
        };
        self.class_of.iter().take(count).map(vector).collect()
    }

    /// Returns the vectors in the unknowns of the whole body, orthonormal in M.
    pub fn basis(&mut self) -> &Columns {
        if let [part] = &self.parts[..] {
            let Some(exchange) = &self.exchange else { return part.basis() };
            part.basis().iter().skip(self.whole.count()).for_each(|own| self.whole.push(&exchange.whole(own)));
            return &self.whole;
        }
        let known = self.whole.count();
        self.whole(self.vectors()).iter().skip(known).for_each(|vector| self.whole.push(vector));
        &self.whole
    }
}

/// Combines the projections of all classes into the projection of the body. `class_of` lists the class of each vector.
fn sum(parts: &[Projection], class_of: &[usize]) -> Projection {
    let mut numbers = vec![Vec::new(); parts.len()];
    class_of.iter().enumerate().for_each(|(number, &class)| numbers[class].push(number));
    let count = class_of.len();
    let matrix = |_, of_parts: &[Option<&DMatrix<f64>>]| {
        let mut sum = DMatrix::zeros(count, count);
        for (part, numbers) in of_parts.iter().zip(&numbers).filter_map(|(part, numbers)| Some(((*part)?, numbers))) {
            for (j, &column) in numbers.iter().enumerate() {
                numbers.iter().enumerate().for_each(|(i, &row)| sum[(row, column)] = part[(i, j)]);
            }
        }
        Ok::<_, Infallible>(sum)
    };
    let vector = |of_parts: &[&DVector<f64>]| {
        let mut sum = DVector::zeros(count);
        for (part, numbers) in of_parts.iter().zip(&numbers) {
            numbers.iter().zip(part.iter()).for_each(|(&number, value)| sum[number] = *value);
        }
        Ok(sum)
    };
    let terms: Vec<_> = parts.iter().map(|part| &part.terms).collect();
    let Ok(terms) = BodyTerms::try_combine(&terms, matrix, vector, |numbers| numbers.iter().sum());
    Projection { terms, rate: parts[0].rate, mode_acceleration: parts[0].mode_acceleration, foundation: None }
}
