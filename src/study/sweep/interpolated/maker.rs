//! Makes the bodies between which a sweep interpolates.

use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use super::Node;
use super::between;
use crate::body::{
    Assembled, Columns, DiagonalSymmetry, Interpolant, ModalBody, Noticeable, Response, excited, main_directions,
    orthonormal_basis, project, snapshots,
};
use crate::error::{Error, Result};
use crate::impact::{Errors, ModalImpact, Readout, Steps, Trace};
use crate::model::watch::Watch;
use crate::model::{
    Built, CellSize, Gauges, Operators, build, cell_size, evaluator_of_layers, layers_for_products, rate, reduce_from,
};
use crate::scene::{Body, Scene};

/// Part of the motion of the impact point that vibrations which are left out may have, relative to the tolerance. An
/// estimate.
const LEFT_OUT_PER_TOLERANCE: f64 = 5e-3;

/// Settings for building bodies: all have the same cells, and each is built by one rank alone.
#[derive(Clone)]
pub struct Cells {
    /// Communicator of this rank alone.
    pub comm: Comm,
    /// Shortest wavelength of all members, m.
    pub wavelength: f64,
    /// Cell size relative to the rule of thumb.
    pub size: f64,
    /// Numbers of vectors, of a smaller and a larger basis, with which bases begin to grow, if known.
    pub vectors: Option<[usize; 2]>,
}

/// A body that is used to make or to test the basis.
pub struct Sample {
    scene: Scene,
    body: Assembled,
    /// The body reduced to its own basis.
    own: ModalBody,
    vibrations: Columns,
    error: Errors,
}

/// Data of a sample that other ranks need.
#[derive(Serialize, Deserialize)]
pub struct SampleNumbers {
    /// Number of unknowns of the sample's excited part.
    pub unknowns: usize,
    /// Vibration vectors, one after another.
    pub vibrations: Vec<f64>,
    /// Errors of the sample's own basis.
    pub error: Errors,
}

/// The basis that all bodies share.
pub struct SharedBasis {
    pub cells: Cells,
    /// Basis vectors, in the unknowns of the part of the body that the force excites.
    pub basis: Columns,
    /// Map from that part to the whole body, if the part is not the whole.
    exchange: Option<DiagonalSymmetry>,
    /// Basis vectors of the whole body.
    whole: Columns,
    /// Number of unknowns of the whole bodies.
    pub unknowns: usize,
    /// Time steps in which all forces are compared.
    pub steps: Steps,
}

/// A new body on the shared basis, with the differences of other bodies' forces from its force.
#[derive(Serialize, Deserialize)]
pub struct Made {
    /// Response of the body to the force.
    pub response: Response,
    /// Error of the simplifications in the response ([`Response::new`]).
    pub of_response: Errors,
    /// Error of the interpolation between earlier bodies at this value.
    pub of_interpolation: Errors,
}

impl Cells {
    /// A scene with these cells.
    pub fn on(&self, scene: Scene) -> Scene {
        Scene { body: Body { wavelength: Some(self.wavelength), ..scene.body }, ..scene }
    }

    fn built(&self, scene: &Scene, watch: &dyn Watch) -> Result<Operators> {
        match build(&self.comm, scene, scene.body.model, self.size, watch)? {
            Built::Operators(built) => Ok(built),
            Built::Given(_) => Err(Error::Solve("a plate has unknowns".into())),
        }
    }

    /// The cell size that a scene needs, with its discretisation error.
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
}

impl Sample {
    /// Data of the sample that other ranks need.
    pub fn numbers(&self) -> SampleNumbers {
        let vibrations = self.vibrations.iter().flatten().copied().collect();
        SampleNumbers { unknowns: excited(self.body.linear()).unknowns(), vibrations, error: self.error }
    }

    /// Time steps that the sample's own force takes.
    pub fn steps(&self) -> Result<Steps> {
        Ok(ModalImpact::new(&self.scene, &self.own).trace(None)?.1)
    }

    /// The main vibration vectors of several samples, orthonormal in this body's mass matrix, one after another. They
    /// are kept down to a weight of `depth` relative to the largest.
    pub fn common_basis(&self, all: &[SampleNumbers], depth: f64) -> Result<Vec<f64>> {
        let body = excited(self.body.linear());
        let unknowns = body.unknowns();
        let pool = columns(unknowns, all.iter().flat_map(|sample| sample.vibrations.chunks_exact(unknowns)));
        let (directions, vectors) = main_directions(body, &pool, depth)?;
        Ok(orthonormal_basis(body, &directions.range(0..vectors))?.iter().flatten().copied().collect())
    }

    /// Difference of the force on the shared basis from the force on the body's own basis.
    pub fn off(&self, shared: &SharedBasis) -> Result<Errors> {
        let projection = project(excited(self.body.linear()), &shared.basis, rate(&self.scene))?;
        let (own, _) = ModalImpact::new(&self.scene, &self.own).trace(Some(shared.steps))?;
        Ok(shared.difference(&own, &self.scene, &ModalBody::of(&projection)))
    }
}

/// Columns of a given length.
fn columns<'a>(length: usize, vectors: impl Iterator<Item = &'a [f64]>) -> Columns {
    let mut all = Columns::new(length, None);
    vectors.for_each(|vector| all.push(vector));
    all
}

/// Maps vectors of the excited part of a body to the whole.
fn whole(vectors: &Columns, exchange: Option<&DiagonalSymmetry>) -> Vec<Vec<f64>> {
    vectors.iter().map(|vector| exchange.map_or_else(|| vector.to_vec(), |exchange| exchange.whole(vector))).collect()
}

impl SharedBasis {
    /// Makes the basis from vectors that are stored one after another, for bodies like a scene's.
    pub fn new(cells: Cells, vectors: &[f64], scene: &Scene, steps: Steps, watch: &dyn Watch) -> Result<Self> {
        let body = cells.built(scene, watch)?.body;
        let length = excited(body.linear()).unknowns();
        let basis = columns(length, vectors.chunks_exact(length));
        let (exchange, unknowns) = (body.linear().exchange().cloned(), body.linear().unknowns());
        let whole = columns(unknowns, whole(&basis, exchange.as_ref()).iter().map(Vec::as_slice));
        Ok(Self { cells, basis, exchange, whole, unknowns, steps })
    }

    /// Maps vectors of the excited part to the whole body.
    pub fn whole(&self, vectors: &Columns) -> Vec<Vec<f64>> {
        whole(vectors, self.exchange.as_ref())
    }

    /// Readout of the stresses on faces of a scene's body, in the coordinates of the given vectors.
    pub fn readout(&self, scene: &Scene, vectors: Vec<Vec<f64>>) -> Result<Readout> {
        let evaluator = evaluator_of_layers(scene, self.cells.size)?;
        Ok(Gauges::new(&self.cells.comm, scene, Some(evaluator), self.unknowns, Some(vectors))?.readout)
    }

    /// Makes a scene's body, and compares its force with the interpolation between `others`.
    pub fn node(
        &self,
        scene: &Scene,
        value: f64,
        others: &[&Node],
        is_geometric: bool,
        watch: &dyn Watch,
    ) -> Result<Made> {
        let body = layers_for_products(&self.cells.comm, scene, self.cells.size, watch)?;
        if body.linear().unknowns() != self.unknowns {
            return Err(Error::Solve("the body has other cells than the others".into()));
        }
        let projection = project(body.linear(), &self.whole, rate(scene))?;
        let modal = ModalBody::of(&projection);
        let mut impact = ModalImpact::new(scene, &modal).without_energies();
        let (exact, _) = impact.trace(Some(self.steps))?;
        let noticeable = Noticeable {
            contact: scene.impactor.contact_time(),
            end: scene.time.end,
            left_out: LEFT_OUT_PER_TOLERANCE * scene.tolerance,
        };
        let response = Response::new(&projection, &*impact.modes(&self.steps)?, noticeable);
        let alone = Interpolant::new(&[&response]).sum(&[&response], &[1.0]);
        let of_response = self.difference(&exact, scene, &alone);
        let of_interpolation = match between(others, value, is_geometric) {
            Some(between) => self.difference(&exact, scene, &between.body(None)),
            None => Errors::default(),
        };
        Ok(Made { response, of_response, of_interpolation })
    }

    /// Difference of a body's force from an exact one; infinite if the body's run fails.
    fn difference(&self, exact: &Trace, scene: &Scene, body: &ModalBody) -> Errors {
        match ModalImpact::new(scene, body).trace(Some(self.steps)) {
            Ok((trace, _)) => exact.difference(&trace),
            Err(_) => Errors::throughout(f64::INFINITY),
        }
    }
}
