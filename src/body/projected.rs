//! A body's operators on a basis that grows.

use nalgebra::DMatrix;

use super::columns::Columns;
use super::linear::{LinearBody, Operator, Properties};
use super::{ProjectedRelaxation, Projection};
use crate::error::Result;

/// Vectors that are multiplied by an operator at a time.
const BLOCK: usize = 64;

/// VᵀAV of each operator but M, of the vectors that there were when they were last asked for.
pub struct Projected(Vec<(Operator, DMatrix<f64>)>);

impl Projected {
    /// Of the operators that a body has, without vectors.
    pub fn new(body: &dyn LinearBody) -> Self {
        let relaxations = (0..body.chains().len()).map(Operator::Distortion);
        let all = [Operator::Elastic, Operator::Support, Operator::Damping].into_iter().chain(relaxations);
        Self(all.filter(|operator| body.has(*operator)).map(|operator| (operator, DMatrix::zeros(0, 0))).collect())
    }

    /// Projects the operators onto the vectors that are new. Collective.
    ///
    /// # Errors
    /// PETSc's.
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
                    // The lower triangle is that of the later vectors.
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

    /// All operators map the first vector, the translation of a body that nothing holds, to nothing, but for rounding that a large body would
    /// oscillate by.
    pub fn release_first(&mut self) {
        for (_, matrix) in self.0.iter_mut().filter(|(_, matrix)| !matrix.is_empty()) {
            matrix.row_mut(0).fill(0.0);
            matrix.column_mut(0).fill(0.0);
        }
    }

    /// The body on the basis, made at a rate (1/s), without its infinite plate. Collective.
    ///
    /// # Errors
    /// PETSc's.
    pub fn projection(
        &self,
        body: &dyn LinearBody,
        properties: &Properties,
        basis: &Columns,
        rate: f64,
    ) -> Result<Projection> {
        let get = |wanted: Operator| self.0.iter().find(|(operator, _)| *operator == wanted).map(|(_, of)| of.clone());
        let none = || DMatrix::zeros(basis.count(), basis.count());
        let relaxing = body.chains().into_iter().enumerate().map(|(number, chain)| ProjectedRelaxation {
            distortion: get(Operator::Distortion(number)).unwrap_or_else(none),
            chain: chain.clone(),
        });
        // Of a body that is held the basis has no translation, which K would map to nothing.
        let momentum = if properties.is_free {
            body.apply(Operator::Mass, &basis.one(properties.translation.clone()))?
        } else {
            basis.zeros(1)
        };
        let mut hit_stress = DMatrix::zeros(properties.hit_stress.len(), basis.count());
        for (mut row, form) in hit_stress.row_iter_mut().zip(&properties.hit_stress) {
            row.tr_copy_from(&basis.along(form));
        }
        let mut projection = Projection {
            elastic: get(Operator::Elastic).unwrap_or_else(none),
            relaxations: relaxing.collect(),
            rate,
            support: get(Operator::Support).unwrap_or_else(none),
            damping: get(Operator::Damping),
            force: basis.along(&properties.force),
            translation: basis.along(momentum.get(0)),
            hit_stress,
            hit_local: properties.hit_local,
            load: basis.along(&properties.load),
            support_load: basis.along(&properties.support_load),
            support_offset: properties.support_offset,
            compliance: properties.compliance,
            copies: properties.copies,
            patch: properties.patch,
            foundation: body.foundation(basis)?,
            infinite_plate: None,
        };
        projection.numbers().for_each(|numbers| basis.agree(numbers));
        Ok(projection)
    }
}
