//! A linear body that one process stores completely, without PETSc.

use std::cell::RefCell;
use std::rc::Rc;

use nalgebra_sparse::CsrMatrix;

use crate::error::Result;
use crate::material::Maxwell;

use super::columns::Columns;
use super::direct::{Direct, Precision};
use super::linear::{LinearBody, Operator, Properties};
use super::run_length_matrix::RunLengthMatrix;
use super::shift::Solver;
use super::{DiagonalSymmetry, FoundationPoints, InfinitePlate, System};

/// Linear body made from a [`System`]. With several ranks, each has a copy.
pub struct LocalBody {
    system: System,
    /// Matrices in run format. Filled at first use.
    products: RefCell<Vec<(Operator, Rc<RunLengthMatrix>)>>,
    /// Symmetry classes that the force excites. Empty if there is only one class, the whole body.
    classes: Vec<Self>,
    /// Map from the only class to the whole body, if that class is the part symmetric about the diagonal.
    exchange: Option<DiagonalSymmetry>,
}

impl LocalBody {
    /// Creates the body of a system. Pads are nonlinear and are left out.
    pub fn new(system: System) -> Self {
        if let Some((exchange, symmetric)) = DiagonalSymmetry::of(&system) {
            return Self { exchange: Some(exchange), ..Self::of(system, vec![Self::of(symmetric, Vec::new())]) };
        }
        let count = if system.classes > 1 { system.classes } else { 0 };
        let classes = (0..count).map(|class| Self::of(system.class(class), Vec::new())).collect();
        Self::of(system, classes)
    }

    fn of(system: System, classes: Vec<Self>) -> Self {
        Self { system, products: RefCell::default(), classes, exchange: None }
    }

    /// The matrices and vectors of the body.
    pub fn system(&self) -> &System {
        &self.system
    }

    fn matrix(&self, operator: Operator) -> Option<&CsrMatrix<f64>> {
        match operator {
            Operator::Mass => Some(&self.system.mass),
            other => self.system.terms.operator(other),
        }
    }

    /// Returns an operator in run format, made at first use.
    fn runs(&self, operator: Operator) -> Option<Rc<RunLengthMatrix>> {
        let mut products = self.products.borrow_mut();
        if let Some((_, known)) = products.iter().find(|(known, _)| *known == operator) {
            return Some(known.clone());
        }
        let runs = Rc::new(RunLengthMatrix::new(self.matrix(operator)?));
        products.push((operator, runs.clone()));
        Some(runs)
    }

    fn held(&self) -> Vec<usize> {
        self.system.held.iter().map(|(unknown, _)| *unknown).collect()
    }
}

impl LinearBody for LocalBody {
    fn unknowns(&self) -> usize {
        self.system.unknowns()
    }

    fn properties(&self) -> Result<Properties> {
        let System { terms, is_nearly_incompressible, .. } = &self.system;
        let held = self.held();
        let is_held = held.iter().any(|unknown| terms.translation[*unknown] != 0.0);
        let mut terms = terms.map(|_, _| (), Vec::clone);
        Ok(Properties {
            layout: Columns::new(self.unknowns(), None),
            held,
            equilibrium: None,
            pushed: Vec::new(),
            is_free: terms.support.is_none() && !is_held,
            is_nearly_incompressible: *is_nearly_incompressible,
            readings: std::mem::take(&mut terms.readings),
            terms,
        })
    }

    fn has(&self, operator: Operator) -> bool {
        self.matrix(operator).is_some()
    }

    fn apply(&self, operator: Operator, vectors: &Columns) -> Result<Columns> {
        let none = || vectors.zeros(vectors.count());
        Ok(self.runs(operator).map_or_else(none, |runs| vectors.mapped(|entries| runs.multiply(entries))))
    }

    fn solver(&self, rate: f64, precision: Precision) -> Result<Solver> {
        let relaxing = self.system.terms.relaxations.iter();
        let relaxing = relaxing.map(|part| (part.chain.transformed_terms(rate), &part.distortion));
        let factor = |operator: Operator, factor: f64| self.matrix(operator).map(|matrix| (factor, matrix));
        let terms = [
            factor(Operator::Elastic, 1.0),
            factor(Operator::Mass, rate * rate),
            factor(Operator::Support, 1.0),
            factor(Operator::Damping, rate),
        ];
        let terms: Vec<_> = terms.into_iter().flatten().chain(relaxing).collect();
        Ok(Solver::Direct(Direct::new(&terms, &self.held(), precision)?))
    }

    fn chains(&self) -> Vec<&Maxwell> {
        self.system.terms.relaxations.iter().map(|part| &part.chain).collect()
    }

    fn infinite_plate(&self) -> Option<&InfinitePlate> {
        self.system.terms.infinite_plate.as_ref()
    }

    fn is_on_foundations(&self) -> bool {
        false
    }

    fn foundation(&self, _: &Columns) -> Result<Option<FoundationPoints>> {
        Ok(None)
    }

    fn is_meshed(&self) -> bool {
        false
    }

    fn classes(&self) -> Vec<&dyn LinearBody> {
        if self.classes.is_empty() { vec![self] } else { self.classes.iter().map(|class| class as _).collect() }
    }

    fn exchange(&self) -> Option<&DiagonalSymmetry> {
        self.exchange.as_ref()
    }
}
