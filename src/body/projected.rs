//! Projection of a body's operators onto a growing basis.

use nalgebra::{DMatrix, DVector};

use super::columns::Columns;
use super::linear::{LinearBody, Operator, Properties};
use super::{FoundationPoints, Projection};
use crate::error::Result;

/// Number of vectors multiplied by an operator at a time.
const BLOCK: usize = 64;

/// VᵀAV of each operator except M, for the vectors known at the last call of `extend`.
pub struct Projected(Vec<(Operator, DMatrix<f64>)>);

impl Projected {
    /// Selects the operators that a body has, for an empty basis.
    pub fn new(body: &dyn LinearBody) -> Self {
        let relaxations = (0..body.chains().len()).map(Operator::Distortion);
        let all = [Operator::Elastic, Operator::Support, Operator::Damping].into_iter().chain(relaxations);
        Self(all.filter(|operator| body.has(*operator)).map(|operator| (operator, DMatrix::zeros(0, 0))).collect())
    }

    /// Projects the operators onto the new vectors. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn extend(&mut self, body: &dyn LinearBody, basis: &Columns) -> Result<()> {
        let count = basis.count();
        for (operator, known) in &mut self.0 {
            let first = known.nrows();
            let mut all = std::mem::replace(known, DMatrix::zeros(0, 0)).resize(count, count, 0.0);
            for begin in (first..count).step_by(BLOCK) {
                let end = count.min(begin + BLOCK);
                let images = body.apply(*operator, &basis.range(begin..end))?;
                let products = basis.products_with_few_rows(end, &images);
                for (j, column) in (begin..end).zip(products.column_iter()) {
                    // Entries below the diagonal follow from symmetry.
                    for i in 0..=j {
                        all[(i, j)] = column[i];
                        all[(j, i)] = column[i];
                    }
                }
            }
            *known = all;
        }
        Ok(())
    }

    /// Sets the rows and columns of the first vector to zero. For the translation of an unsupported body, they are zero
    /// except for rounding, which would make a large body oscillate.
    pub fn release_first(&mut self) {
        for (_, matrix) in self.0.iter_mut().filter(|(_, matrix)| !matrix.is_empty()) {
            matrix.row_mut(0).fill(0.0);
            matrix.column_mut(0).fill(0.0);
        }
    }

    /// Returns the body projected onto a basis made at a shift (1/s), without the infinite plate. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails.
    pub fn projection(
        &self,
        body: &dyn LinearBody,
        properties: &Properties,
        basis: &Columns,
        rate: f64,
    ) -> Result<Projection> {
        let Properties { terms, readings, is_free, .. } = properties;
        let matrix = |wanted: Operator, (): &()| {
            let known = self.0.iter().find(|(operator, _)| *operator == wanted);
            let mut matrix = known.map_or_else(|| DMatrix::zeros(basis.count(), basis.count()), |(_, of)| of.clone());
            basis.agree(matrix.as_mut_slice());
            matrix
        };
        let agreed = |mut vector: DVector<f64>| {
            basis.agree(vector.as_mut_slice());
            vector
        };
        let mut terms = terms.map(matrix, |vector| agreed(basis.along(vector)));
        // Only the basis of a free body contains the translation, which K maps to zero.
        terms.translation = match is_free {
            true => {
                let momentum = body.apply(Operator::Mass, &basis.one(properties.terms.translation.clone()))?;
                agreed(basis.along(momentum.get(0)))
            }
            false => DVector::zeros(basis.count()),
        };
        let forms = basis.along_sparse(&readings.forms);
        terms.readings.forms = forms.row_iter().map(|form| agreed(form.transpose())).collect();
        terms.readings.local_per_newton = readings.local_per_newton;
        for number in [&mut terms.support_offset, &mut terms.contact.compliance] {
            basis.agree(std::slice::from_mut(number));
        }
        basis.agree(&mut terms.readings.local_per_newton);
        terms.infinite_plate = None;
        let mut foundation = body.foundation(basis)?;
        foundation.iter_mut().flat_map(FoundationPoints::numbers).for_each(|numbers| basis.agree(numbers));
        Ok(Projection { terms, rate, mode_acceleration: None, foundation })
    }
}
