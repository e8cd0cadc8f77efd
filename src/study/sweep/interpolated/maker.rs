//! Makes the bodies between which a sweep interpolates.

use petsc_wrap::Comm;
use serde::{Deserialize, Serialize};

use super::Node;
use super::between;
use crate::body::{
    Assembled, Columns, DiagonalSymmetry, Interpolant, LinearBody as _, ModalBody, Noticeable, Response, excited,
    extend_orthonormal, main_directions, project, snapshots,
};
use crate::error::{Error, Result};
use crate::impact::{Errors, ModalImpact, Readout, Steps, Trace};
use crate::model::watch::Watch;
use crate::model::{
    Built, CellSize, Gauges, Operators, build, cell_size, layerwise_evaluator, layerwise_for_products, rate,
    reduce_from,
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
    pub whole_basis: Columns,
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

    /// The main vibration vectors of several samples, in descending order of their weights in this body's mass matrix.
    /// `weights` are relative to the largest, in descending order: also returns the number of vectors down to each.
    pub fn main_directions<const N: usize>(
        &self,
        all: &[SampleNumbers],
        weights: [f64; N],
    ) -> Result<(Columns, [usize; N])> {
        let body = excited(self.body.linear());
        let unknowns = body.unknowns();
        let pool = columns(unknowns, all.iter().flat_map(|sample| sample.vibrations.chunks_exact(unknowns)));
        main_directions(body, &pool, weights)
    }

    /// Vectors, one after another, by which some directions extend a basis that is orthonormal in this body's mass
    /// matrix.
    pub fn extension(&self, basis: &Columns, directions: &Columns) -> Result<Vec<f64>> {
        let mut extended = basis.range(0..basis.count());
        extend_orthonormal(excited(self.body.linear()), &mut extended, directions)?;
        Ok(extended.iter().skip(basis.count()).flatten().copied().collect())
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

impl SharedBasis {
    /// An empty basis for bodies like a scene's.
    pub fn new(cells: Cells, scene: &Scene, steps: Steps, watch: &dyn Watch) -> Result<Self> {
        let body = cells.built(scene, watch)?.body;
        let body = body.linear();
        Ok(Self {
            cells,
            basis: Columns::new(excited(body).unknowns(), None),
            exchange: body.exchange().cloned(),
            whole_basis: Columns::new(body.unknowns(), None),
            unknowns: body.unknowns(),
            steps,
        })
    }

    /// Adds vectors of the excited part, which are stored one after another.
    pub fn extend(&mut self, vectors: &[f64]) {
        let more = columns(self.basis.rows(), vectors.chunks_exact(self.basis.rows()));
        self.whole_basis.append(columns(self.unknowns, self.whole(&more).iter().map(Vec::as_slice)));
        self.basis.append(more);
    }

    /// Maps vectors of the excited part to the whole body.
    pub fn whole(&self, vectors: &Columns) -> Vec<Vec<f64>> {
        let whole = |vector: &[f64]| match &self.exchange {
            Some(exchange) => exchange.whole(vector),
            None => vector.to_vec(),
        };
        vectors.iter().map(whole).collect()
    }

    /// Readout of the stresses on faces of a scene's body, in the coordinates of the basis.
    pub fn readout(&self, scene: &Scene) -> Result<Readout> {
        let vectors = self.whole_basis.whole(self.whole_basis.count());
        let evaluator = layerwise_evaluator(scene, self.cells.size)?;
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
        let body = layerwise_for_products(scene, self.cells.size, watch)?;
        if body.unknowns() != self.unknowns {
            return Err(Error::Solve("the meshes of the bodies differ".into()));
        }
        let projection = project(&body, &self.whole_basis, rate(scene))?;
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
