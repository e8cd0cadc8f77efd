//! [`LinearBody`] for a body in PETSc storage.

use nalgebra::DMatrix;
use nalgebra_sparse::CsrMatrix;
use petsc_wrap::{Int, Matrix, Row, Vector, estimate_cholesky};

use crate::error::Result;
use crate::material::Maxwell;
use crate::solve::linear::{Method, solver};

use super::columns::Columns;
use super::direct::{Direct, Precision};
use super::linear::{LinearBody, Operator, Properties};
use super::shift::Solver;
use super::{Body, FoundationPoints, InfinitePlate};

impl Body {
    /// Returns the form of an operator that is fastest in products.
    fn matrix(&self, operator: Operator) -> Option<&Matrix> {
        let products = self.products.as_ref();
        match operator {
            Operator::Mass => Some(products.map_or(&self.mass, |[mass, _]| mass)),
            Operator::Elastic => Some(products.map_or(&self.terms.elastic, |[_, elastic]| elastic)),
            other => self.terms.operator(other),
        }
    }

    /// Passes each column to a function, as a PETSc vector.
    fn each(&self, columns: &Columns, mut take: impl FnMut(&Vector) -> Result<()>) -> Result<()> {
        let mut vector = self.terms.load.duplicate()?;
        columns.iter().try_for_each(|column| {
            vector.write()?.copy_from_slice(column);
            take(&vector)
        })
    }

    /// Factorises S at a shift (1/s) without PETSc, if this process has the whole body.
    fn factor(&self, rate: f64, held: &[usize], precision: Precision) -> Result<Direct> {
        let relaxing = self.terms.relaxations.iter();
        let relaxing = relaxing.map(|part| (part.chain.transformed_terms(rate), &part.distortion));
        let terms = [(1.0, &self.terms.elastic), (rate * rate, &self.mass)].into_iter();
        let supports = self.terms.support.iter().map(|support| (1.0, support));
        let terms =
            terms.chain(supports).chain(self.terms.damping.iter().map(|damping| (rate, damping))).chain(relaxing);
        let numbers = |(factor, matrix)| Ok::<_, crate::Error>((factor, numbers_of(matrix, self.unknowns())?));
        let terms = terms.map(numbers).collect::<Result<Vec<_>>>()?;
        let terms: Vec<_> = terms.iter().map(|(factor, matrix)| (*factor, matrix)).collect();
        Direct::new(&terms, held, precision)
    }

    /// Rows of the constrained unknowns on this rank.
    fn held_here(&self) -> Vec<usize> {
        let first = self.terms.load.range().start;
        self.clamps.rows.iter().map(|row| (row - first) as usize).collect()
    }
}

/// Copies a matrix that this process stores completely.
fn numbers_of(matrix: &Matrix, rows: usize) -> Result<CsrMatrix<f64>> {
    let (mut offsets, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    let mut row = Row::default();
    for i in 0..rows {
        matrix.row_into(i as Int, &mut row)?;
        columns.extend(row.columns.iter().map(|column| *column as usize));
        values.extend_from_slice(&row.values);
        offsets.push(values.len());
    }
    Ok(CsrMatrix::try_from_csr_data(rows, rows, offsets, columns, values).expect("rows of PETSc's, in order"))
}

impl LinearBody for Body {
    fn unknowns(&self) -> usize {
        Self::unknowns(self)
    }

    fn properties(&self) -> Result<Properties> {
        let entries = |vector: &Vector| Ok::<_, crate::Error>(vector.read()?.to_vec());
        let pushed = self.unilateral.iter().flat_map(|foundation| &foundation.loads);
        let mut terms = self.terms.try_map(|_, _| Ok(()), entries)?;
        Ok(Properties {
            layout: Columns::new(terms.load.len(), Some(self.comm())),
            held: self.held_here(),
            equilibrium: self.equilibrium.as_ref().map(entries).transpose()?,
            pushed: pushed.map(entries).collect::<Result<_>>()?,
            is_free: self.is_free()?,
            is_nearly_incompressible: false,
            readings: std::mem::take(&mut terms.readings),
            terms,
        })
    }

    fn has(&self, operator: Operator) -> bool {
        self.matrix(operator).is_some()
    }

    fn apply(&self, operator: Operator, vectors: &Columns) -> Result<Columns> {
        let mut products = vectors.zeros(0);
        let mut product = self.terms.load.duplicate()?;
        self.each(vectors, |vector| {
            match (operator, self.matrix(operator)) {
                (Operator::Mass, _) => self.apply_mass(vector, &mut product)?,
                (_, Some(matrix)) => matrix.mult(vector, &mut product)?,
                (_, None) => product.fill(0.0)?,
            }
            products.push(&product.read()?);
            Ok(())
        })?;
        Ok(products)
    }

    fn solver(&self, rate: f64, precision: Precision) -> Result<Solver> {
        // Every rank stores the whole of a body without a mesh.
        if let (Method::Cholesky, None) = (self.method, &self.nodes) {
            return Ok(Solver::Direct(self.factor(rate, &self.held_here(), precision)?));
        }
        let vectors = [self.terms.load.duplicate()?, self.terms.load.duplicate()?];
        let operator = self.operator_at_rate(rate)?;
        let is_large = matches!(self.method, Method::Multigrid { .. });
        let expected = if is_large { estimate_cholesky(&operator)? } else { None };
        let solver = solver(self.comm(), "", &operator, self.method.for_basis(expected))?;
        Ok(Solver::Distributed(Box::new((solver, vectors))))
    }

    fn chains(&self) -> Vec<&Maxwell> {
        self.terms.relaxations.iter().map(|relaxation| &relaxation.chain).collect()
    }

    fn infinite_plate(&self) -> Option<&InfinitePlate> {
        self.terms.infinite_plate.as_ref()
    }

    fn is_on_foundations(&self) -> bool {
        self.unilateral.is_some()
    }

    fn foundation(&self, basis: &Columns) -> Result<Option<FoundationPoints>> {
        let Some(foundation) = &self.unilateral else { return Ok(None) };
        let mut moved = Vec::new();
        self.each(basis, |vector| {
            moved.extend(foundation.moved(vector)?);
            Ok(())
        })?;
        Ok(Some(foundation.on(DMatrix::from_vec(foundation.points(), basis.count(), moved))))
    }

    fn is_meshed(&self) -> bool {
        self.nodes.is_some()
    }

    fn classes(&self) -> Vec<&dyn LinearBody> {
        if self.classes.is_empty() { vec![self] } else { self.classes.iter().map(|class| class as _).collect() }
    }
}
