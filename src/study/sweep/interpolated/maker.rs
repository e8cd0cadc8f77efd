//! How the bodies are made between which a sweep interpolates.

use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use super::Node;
use super::between;
use crate::body::{
    Assembled, Columns, Exchange, Interpolant, ModalBody, Response, excited, main_directions, orthonormal_basis,
    project, snapshots,
};
use crate::error::{Error, Result};
use crate::impact::{Errors, ModalImpact, Readout, Steps, Trace};
use crate::model::watch::Watch;
use crate::model::{Built, CellSize, Gauges, Operators, build, cell_size, rate, reduce_from};
use crate::scene::{Body, Scene};

/// Weight of the directions of the basis, over the tolerance, down to which they are taken.
const DEPTH: f64 = 0.03;

/// How bodies are built: all on the same cells, by one rank for itself.
#[derive(Clone)]
pub struct Cells {
    /// This rank alone.
    pub comm: Comm,
    /// The shortest waves of all, m.
    pub wavelength: f64,
    /// Of the cells over those by the rule of thumb.
    pub size: f64,
    /// Numbers of vectors with which bases begin to grow, where they are known.
    pub vectors: Option<[usize; 2]>,
}

/// A body by which the basis is made or tested.
pub struct Sample {
    scene: Scene,
    body: Assembled,
    /// On its own basis.
    own: ModalBody,
    vibrations: Columns,
    error: Errors,
}

/// What other ranks need of a sample.
#[derive(Serialize, Deserialize)]
pub struct SampleNumbers {
    /// Of its body.
    pub unknowns: usize,
    /// Its vibrations, one after the other.
    pub vibrations: Vec<f64>,
    /// Of its own basis.
    pub error: Errors,
}

/// The basis that all bodies share.
pub struct SharedBasis {
    pub cells: Cells,
    /// Its vectors, of the part of the bodies that the force excites.
    pub basis: Columns,
    /// How that is part of the whole, where it is not all of it.
    exchange: Option<Exchange>,
    /// Unknowns of the whole bodies.
    pub unknowns: usize,
    /// In which all forces are compared.
    pub steps: Steps,
}

/// A new body on the basis, with how far others are off its force.
#[derive(Serialize, Deserialize)]
pub struct Made {
    /// What it answers.
    pub response: Response,
    /// Of what the response leaves out ([`Response::new`]).
    pub of_response: Errors,
    /// Of the interpolation between earlier bodies.
    pub of_interpolation: Errors,
}

impl Cells {
    /// A scene on these cells.
    pub fn on(&self, scene: Scene) -> Scene {
        Scene { body: Body { wavelength: Some(self.wavelength), ..scene.body }, ..scene }
    }

    fn built(&self, scene: &Scene, watch: &dyn Watch) -> Result<Operators> {
        match build(&self.comm, scene, scene.body.model, self.size, watch)? {
            Built::Operators(built) => Ok(built),
            Built::Given(_) => Err(Error::Solve("a plate has unknowns".into())),
        }
    }

    /// The size of the cells that a scene asks for, with the error that they leave.
    pub fn asked_by(&self, scene: &Scene, watch: &dyn Watch) -> Result<CellSize> {
        cell_size(&self.comm, scene, scene.body.model, self.built(scene, watch)?, watch)
    }

    /// A scene's body with a basis of its own.
    pub fn sample(&self, scene: Scene, watch: &dyn Watch) -> Result<Sample> {
        let body = self.built(&scene, watch)?.body;
        let mut reduced = reduce_from(&self.comm, body.linear(), &scene, self.vectors, watch)?;
        let larger = reduced.larger().clone();
        let vibrations = snapshots(reduced.krylov.excited(), &larger, rate(&scene));
        Ok(Sample { own: reduced.take_larger_modal(), error: reduced.error, scene, body, vibrations })
    }

    /// What is read of the faces of a scene's body on some vectors.
    pub fn readout(&self, scene: &Scene, vectors: Vec<Vec<f64>>, watch: &dyn Watch) -> Result<Readout> {
        let Operators { evaluator, body, .. } = self.built(scene, watch)?;
        Ok(Gauges::new(&self.comm, scene, evaluator, body.linear().unknowns(), Some(vectors))?.readout)
    }
}

impl Sample {
    /// What other ranks need of it.
    pub fn numbers(&self) -> SampleNumbers {
        let vibrations = self.vibrations.iter().flatten().copied().collect();
        SampleNumbers { unknowns: excited(self.body.linear()).unknowns(), vibrations, error: self.error }
    }

    /// The steps that its force takes.
    pub fn steps(&self) -> Result<Steps> {
        Ok(ModalImpact::new(&self.scene, &self.own).trace(None)?.1)
    }

    /// The vectors of the vibrations of some bodies like this, orthonormal in its mass, one after the other.
    pub fn common_basis(&self, all: &[SampleNumbers]) -> Result<Vec<f64>> {
        let body = excited(self.body.linear());
        let unknowns = body.unknowns();
        let pool = columns(unknowns, all.iter().flat_map(|sample| sample.vibrations.chunks_exact(unknowns)));
        let (directions, vectors) = main_directions(body, &pool, DEPTH * self.scene.tolerance)?;
        Ok(orthonormal_basis(body, &directions.range(0..vectors))?.iter().flatten().copied().collect())
    }

    /// How far the basis is off this body's own one.
    pub fn off(&self, shared: &SharedBasis) -> Result<Errors> {
        let projection = project(excited(self.body.linear()), &shared.basis, rate(&self.scene))?;
        let (own, _) = ModalImpact::new(&self.scene, &self.own).trace(Some(shared.steps))?;
        Ok(shared.difference(&own, &self.scene, &ModalBody::of(&projection)))
    }
}

/// Vectors of a length.
fn columns<'a>(length: usize, vectors: impl Iterator<Item = &'a [f64]>) -> Columns {
    let mut all = Columns::new(length, None);
    vectors.for_each(|vector| all.push(vector));
    all
}

impl SharedBasis {
    /// Of vectors one after the other, of bodies like a scene's.
    pub fn new(cells: Cells, vectors: &[f64], scene: &Scene, steps: Steps, watch: &dyn Watch) -> Result<Self> {
        let body = cells.built(scene, watch)?.body;
        let length = excited(body.linear()).unknowns();
        let basis = columns(length, vectors.chunks_exact(length));
        let (exchange, unknowns) = (body.linear().exchange().cloned(), body.linear().unknowns());
        Ok(Self { cells, basis, exchange, unknowns, steps })
    }

    /// Vectors as those of the whole bodies.
    pub fn whole(&self, vectors: &Columns) -> Vec<Vec<f64>> {
        let whole = |vector: &[f64]| match &self.exchange {
            Some(exchange) => exchange.whole(vector),
            None => vector.to_vec(),
        };
        vectors.iter().map(whole).collect()
    }

    /// A scene's body, whose force is compared with that between others.
    pub fn node(
        &self,
        scene: &Scene,
        value: f64,
        others: &[&Node],
        is_geometric: bool,
        watch: &dyn Watch,
    ) -> Result<Made> {
        let body = self.cells.built(scene, watch)?.body;
        let body = excited(body.linear());
        if body.unknowns() != self.basis.rows() {
            return Err(Error::Solve("the body is not as symmetric as the others".into()));
        }
        let projection = project(body, &self.basis, rate(scene))?;
        let modal = ModalBody::of(&projection);
        let mut impact = ModalImpact::new(scene, &modal).without_energies();
        let (exact, _) = impact.trace(Some(self.steps))?;
        let response = Response::new(&projection, &*impact.modes(&self.steps)?, scene.time.end);
        let alone = Interpolant::new(&[&response]).sum(&[&response], &[1.0]);
        let of_response = self.difference(&exact, scene, &alone);
        let of_interpolation = match between(others, value, is_geometric) {
            Some(between) => self.difference(&exact, scene, &between.body(None)),
            None => Errors::default(),
        };
        Ok(Made { response, of_response, of_interpolation })
    }

    /// How far a body's force is off another one's.
    fn difference(&self, exact: &Trace, scene: &Scene, body: &ModalBody) -> Errors {
        match ModalImpact::new(scene, body).trace(Some(self.steps)) {
            Ok((trace, _)) => exact.difference(&trace),
            Err(_) => Errors::throughout(f64::INFINITY),
        }
    }
}
