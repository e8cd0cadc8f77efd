//! Projection of a body's operators onto a growing basis.

use nalgebra::DMatrix;

use super::columns::Columns;
use super::linear::{LinearBody, Operator, Properties};
use super::{ProjectedRelaxation, Projection};
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
        let get = |wanted: Operator| self.0.iter().find(|(operator, _)| *operator == wanted).map(|(_, of)| of.clone());
        let none = || DMatrix::zeros(basis.count(), basis.count());
        let relaxing = body.chains().into_iter().enumerate().map(|(number, chain)| ProjectedRelaxation {
            distortion: get(Operator::Distortion(number)).unwrap_or_else(none),
            chain: chain.clone(),
        });
        // Only the basis of a free body contains the translation, which K maps to zero.
        let momentum = if properties.is_free {
            body.apply(Operator::Mass, &basis.one(properties.translation.clone()))?
        } else {
            basis.zeros(1)
        };
        let hit_stress = basis.along_sparse(&properties.hit_stress);
        let mut projection = Projection {
            elastic: get(Operator::Elastic).unwrap_or_else(none),
            relaxations: relaxing.collect(),
            rate,
            mode_acceleration: None,
            support: get(Operator::Support).unwrap_or_else(none),
            damping: get(Operator::Damping),
            force: basis.along(&properties.force),
            translation: basis.along(momentum.get(0)),
            hit_stress,
            local_stress_per_newton: properties.local_stress_per_newton,
            load: basis.along(&properties.load),
            support_load: basis.along(&properties.support_load),
            support_offset: properties.support_offset,
            compliance: properties.compliance,
            multiplicity: properties.multiplicity,
            footprint: properties.footprint,
            foundation: body.foundation(basis)?,
            infinite_plate: None,
        };
        projection.numbers().for_each(|numbers| basis.agree(numbers));
        Ok(projection)
    }
}
