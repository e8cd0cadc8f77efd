//! Members that differ in the relaxation of interlayers alone: what a few bodies answer to the force, interpolated.
//!
//! All have one mesh, for the shortest waves of them all, and one basis, of the vibrations of three of them. Bodies are made at values
//! from which the answers between follow by cubic interpolation ([`Response`]): at each the relaxation, and the local field under the hit,
//! are its own. Wherever the answers at the middle between two values are not those of the body there, there are more values.

use std::collections::BTreeMap;

use petsc_wrap::Comm;

use crate::body::{
    Assembled, Columns, Interpolant, ModalBody, Projection, Response, main_directions, orthonormal_basis, project,
    snapshots,
};
use crate::error::{Error, Result};
use crate::impact::{Errors, ModalImpact, Readout, Steps, Trace};
use crate::model::watch::Watch;
use crate::model::{Built, Fitted, Gauges, OF_BASIS, Operators, Reduced, build, fit, rate, reduce};
use crate::scene::{Body, Initial, Load, Model, Scene};
use crate::space::evaluate::Evaluator;
use crate::space::plate::contact_wavelength;

/// Intervals between values at first.
const FIRST_INTERVALS: usize = 4;

/// Bodies at most.
const MAX_BODIES: usize = 65;

/// Weight of the directions of the basis, over the tolerance, down to which they are taken.
const DEPTH: f64 = 0.03;

/// Part of the tolerance that the interpolation may take.
const INTERPOLATION_SHARE: f64 = 0.3;

/// The error of cubic interpolation over that with intervals twice as long, by which it is judged: a sixteenth where these are short.
const ERROR_RATIO_ON_HALVING: f64 = 0.25;

/// Amplitudes of the directions along which bodies are read over the largest, down to which they are taken, over the tolerance.
const OF_MOTIONS: f64 = 0.2;

/// Bodies by which one interpolates.
const STENCIL: usize = 4;

/// What all members share.
pub struct Interpolated {
    nodes: Vec<Node>,
    /// The interpolation's error in each interval, by its upper end.
    errors: Vec<(f64, Errors)>,
    /// That of the cells and the basis.
    of_model: Errors,
    /// Of bodies that lie side by side, by the number of the first.
    between: Vec<Interpolant>,
    is_geometric: bool,
    /// Unknowns of the bodies.
    pub unknowns: usize,
}

/// A body at one value.
struct Node {
    value: f64,
    response: Response,
    reader: Option<Evaluator>,
    readout: Option<Readout>,
    scene: Scene,
}

/// What one value's body is made of.
struct BuiltBody {
    scene: Scene,
    built: Operators,
}

/// One by which the basis is made.
struct Sample {
    scene: Scene,
    body: Assembled,
    own: Projection,
    snapshots: Columns,
    error: Errors,
}

/// How bodies are made.
struct Maker<'a> {
    comm: &'a Comm,
    values: &'a [f64],
    scene_of: &'a dyn Fn(f64) -> Result<Scene>,
    watch: &'a dyn Watch,
    wavelength: f64,
    size: f64,
}

/// Whether bodies of a scene may be interpolated: layerwise plates that start at rest, without loads, in chosen steps, whose energies nobody wants.
pub fn admits(scene: &Scene) -> bool {
    let is_moved = scene.load != Load::default() || scene.supports.iter().any(|one| one.displacement != [0.0; 3]);
    let is_layerwise = scene.body.model == Model::Layerwise && scene.body.composition.uniform().is_none();
    let is_free = scene.time.initial == Initial::Rest && scene.time.step.is_none() && !is_moved;
    // These bodies have no energies.
    let is_gated = scene.solver.energy_gate.is_some();
    is_layerwise && is_free && !is_gated && !scene.is_on_pads()
}

impl Interpolated {
    /// Of ascending values with their scenes. `None` where it takes too many bodies, or these have no basis in common. Collective.
    ///
    /// # Errors
    /// Those of a model.
    pub fn new(
        comm: &Comm,
        values: &[f64],
        scene_of: &dyn Fn(f64) -> Result<Scene>,
        watch: &dyn Watch,
    ) -> Result<Option<Self>> {
        let last = values.len() - 1;
        let mut maker = Maker { comm, values, scene_of, watch, wavelength: f64::INFINITY, size: 1.0 };
        for place in [0, last] {
            maker.wavelength = maker.wavelength.min(contact_wavelength(&scene_of(values[place])?)?);
        }
        let Some((samples, of_cells)) = maker.samples()? else { return Ok(None) };
        let Some(basis) = common_basis(&samples)? else { return Ok(None) };
        let mut steps = None;
        let mut of_basis = samples.iter().fold(Errors::default(), |most, sample| most.max(sample.error));
        let mut of_merging = Errors::default();
        for place in [last / 4, 3 * last / 4] {
            let sample = maker.sample(place)?;
            of_basis = of_basis.max(sample.error);
            of_merging = of_merging.max(off(&sample, &basis, &mut steps)?);
        }
        let tolerance = samples[0].scene.tolerance;
        tracing::info!(
            vectors = basis.count(),
            first = of_merging.first_contact,
            all = of_merging.history,
            "common basis"
        );
        if of_merging.of(samples[0].scene.measure) > OF_BASIS * tolerance {
            return Ok(None);
        }
        let Some(steps) = steps else { return Ok(None) };
        let unknowns = samples[0].body.linear().unknowns();
        drop(samples);
        let middle = values[last / 2];
        let is_geometric = values[0] > 0.0
            && (middle / (values[0] * values[last]).sqrt()).ln().abs()
                < (2.0 * middle / (values[0] + values[last])).ln().abs();
        let of_model = of_cells.joined(of_basis).joined(of_merging);
        let mut all =
            Self { nodes: Vec::new(), errors: Vec::new(), of_model, between: Vec::new(), is_geometric, unknowns };
        let mut nodes = BTreeMap::new();
        for k in 0..=FIRST_INTERVALS {
            let place = k * last / FIRST_INTERVALS;
            let (exact, node) = maker.node(place, &basis, steps)?;
            all.of_model = all.of_model.max(of_model.joined(node.error_alone(&exact, steps)));
            nodes.insert(place, node);
        }
        let places: Vec<usize> = nodes.keys().copied().collect();
        let mut open: Vec<(usize, usize)> = places.windows(2).map(|ends| (ends[0], ends[1])).collect();
        while let Some((from, to)) = open.pop() {
            if to - from < 2 {
                all.errors.push((values[to], Errors::default()));
                continue;
            }
            if nodes.len() == MAX_BODIES {
                return Ok(None);
            }
            let place = from.midpoint(to);
            let (exact, node) = maker.node(place, &basis, steps)?;
            let near: Vec<&Node> = nodes.values().collect();
            let scene = maker.scene(place)?;
            let body = all.interpolated(&near, values[place]);
            let difference = match ModalImpact::new(&scene, &body).trace(Some(steps)) {
                Ok((trace, _)) => exact.difference(&trace),
                Err(_) => Errors::throughout(f64::INFINITY),
            };
            let error = on_halving(difference, scene.tolerance);
            all.of_model = all.of_model.max(of_model.joined(node.error_alone(&exact, steps)));
            let (value, first, history) = (values[place], error.first_contact, error.history);
            tracing::info!(value, coordinates = node.response.coordinates(), first, history, "interpolated");
            nodes.insert(place, node);
            if error.of(scene.measure) <= INTERPOLATION_SHARE * tolerance {
                all.errors.push((values[to], error));
            } else {
                open.extend([(from, place), (place, to)]);
            }
        }
        all.errors.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.nodes = nodes.into_values().collect();
        all.read_along_main_motions(comm, &basis)?;
        let responses: Vec<&Response> = all.nodes.iter().map(|node| &node.response).collect();
        all.between = responses.windows(STENCIL).map(Interpolant::new).collect();
        Ok(Some(all))
    }

    /// Takes the bodies to the directions in which they move at all, along which they are read.
    fn read_along_main_motions(&mut self, comm: &Comm, basis: &Columns) -> Result<()> {
        let responses: Vec<&Response> = self.nodes.iter().map(|node| &node.response).collect();
        let scene = &self.nodes[0].scene;
        let directions = Response::main_motions(&responses, rate(scene), OF_MOTIONS * scene.tolerance);
        let whole = basis.combined(&directions).whole(directions.ncols());
        tracing::info!(directions = directions.ncols(), nodes = self.nodes.len(), "main motions");
        for node in &mut self.nodes {
            node.response = node.response.along(&directions);
            if let Some(reader) = node.reader.take() {
                let gauges = Gauges::new(comm, &node.scene, Some(reader), self.unknowns, Some(whole.clone()))?;
                node.readout = Some(gauges.readout);
            }
        }
        Ok(())
    }

    /// The body at a value for a member's run, with its errors and what is read of it: the faces of the nearest body. `None` for another impact than
    /// that for which the errors are estimated.
    pub fn at(&self, value: f64, scene: &Scene) -> Option<(ModalBody, Errors, Option<Readout>)> {
        let of_all = &self.nodes.first()?.scene;
        if scene.impactor != of_all.impactor || scene.time != of_all.time {
            return None;
        }
        let near: Vec<&Node> = self.nodes.iter().collect();
        let (_, error) = self.errors.iter().find(|(to, _)| value <= *to)?;
        let nearest = near.iter().min_by(|a, b| (a.value - value).abs().total_cmp(&(b.value - value).abs()))?;
        let readout = nearest.readout.clone();
        let errors = Errors { stress: f64::NAN, ..self.of_model.joined(*error) };
        Some((self.interpolated(&near, value), errors, readout))
    }

    /// The body at a value, by the nearest of some bodies.
    fn interpolated(&self, nodes: &[&Node], value: f64) -> ModalBody {
        let above = nodes.partition_point(|node| node.value < value);
        let begin = above.saturating_sub(STENCIL / 2).min(nodes.len().saturating_sub(STENCIL));
        let near = &nodes[begin..nodes.len().min(begin + STENCIL)];
        let at = |value: f64| if self.is_geometric { value.ln() } else { value };
        let weight = |node: &&Node| -> f64 {
            let others = near.iter().filter(|other| other.value != node.value);
            others.map(|other| (at(value) - at(other.value)) / (at(node.value) - at(other.value))).product()
        };
        let weights: Vec<f64> = near.iter().map(weight).collect();
        let responses: Vec<&Response> = near.iter().map(|node| &node.response).collect();
        match self.between.get(begin) {
            Some(between) => between.sum(&responses, &weights),
            None => Interpolant::new(&responses).sum(&responses, &weights),
        }
    }
}

impl Node {
    /// What the response leaves out of its own body ([`Response::new`]), by the force in some steps.
    fn error_alone(&self, exact: &Trace, steps: Steps) -> Errors {
        let body = Interpolant::new(&[&self.response]).sum(&[&self.response], &[1.0]);
        match ModalImpact::new(&self.scene, &body).trace(Some(steps)) {
            Ok((trace, _)) => exact.difference(&trace),
            Err(_) => Errors::throughout(f64::INFINITY),
        }
    }
}

/// The error of interpolation between intervals of which the answers in the middle differ so much. Over the whole history it is only less than that where the
/// difference is small: contacts come and go with the value.
fn on_halving(difference: Errors, tolerance: f64) -> Errors {
    let smaller = ERROR_RATIO_ON_HALVING * difference;
    if difference.history <= tolerance { smaller } else { Errors { history: difference.history, ..smaller } }
}

impl Maker<'_> {
    /// A value's scene, on the cells of all.
    fn scene(&self, place: usize) -> Result<Scene> {
        let scene = (self.scene_of)(self.values[place])?;
        Ok(Scene { body: Body { wavelength: Some(self.wavelength), ..scene.body }, ..scene })
    }

    fn operated(&self, place: usize) -> Result<BuiltBody> {
        let scene = self.scene(place)?;
        match build(self.comm, &scene, scene.body.model, self.size, self.watch)? {
            Built::Operators(built) => Ok(BuiltBody { scene, built }),
            Built::Given(_) => Err(Error::Solve("a plate has unknowns".into())),
        }
    }

    /// Bodies at both ends and in the middle, on the finer cells of the two ends; with the error of these. `None` where they are not alike.
    fn samples(&mut self) -> Result<Option<(Vec<Sample>, Errors)>> {
        let last = self.values.len() - 1;
        let mut of_cells = Errors::default();
        for place in [0, last] {
            let BuiltBody { scene, built } = Self { size: 1.0, ..*self }.operated(place)?;
            let Fitted { size, error, .. } = fit(self.comm, &scene, scene.body.model, built, self.watch)?;
            self.size = self.size.min(size);
            of_cells = of_cells.max(error.unwrap_or_default());
        }
        let samples = [0, last / 2, last].map(|place| self.sample(place)).into_iter().collect::<Result<Vec<_>>>()?;
        let unknowns = |sample: &Sample| sample.body.linear().unknowns();
        let are_alike = samples.iter().all(|sample| unknowns(sample) == unknowns(&samples[0]));
        Ok(are_alike.then_some((samples, of_cells)))
    }

    /// A body with a basis of its own.
    fn sample(&self, place: usize) -> Result<Sample> {
        let BuiltBody { scene, built } = self.operated(place)?;
        let body = built.body;
        let reduced = reduce(self.comm, body.linear(), &scene, self.watch)?;
        let own = reduced.larger().clone();
        let Reduced { mut krylov, error, .. } = reduced;
        let snapshots = snapshots(krylov.basis(), &own, rate(&scene));
        Ok(Sample { scene, body, own, snapshots, error })
    }

    /// A body on the basis, with its force in some steps.
    fn node(&self, place: usize, basis: &Columns, steps: Steps) -> Result<(Trace, Node)> {
        let BuiltBody { scene, built } = self.operated(place)?;
        let Operators { body, evaluator, .. } = built;
        let projection = project(body.linear(), basis, rate(&scene))?;
        let modal = ModalBody::of(&projection);
        let mut impact = ModalImpact::new(&scene, &modal).without_energies();
        let (trace, _) = impact.trace(Some(steps))?;
        let response = Response::new(&projection, &*impact.modes(&steps)?, scene.time.end);
        let reader = evaluator.filter(|_| scene.output.is_read());
        Ok((trace, Node { value: self.values[place], response, reader, readout: None, scene }))
    }
}

/// What holds the vibrations of all samples.
fn common_basis(samples: &[Sample]) -> Result<Option<Columns>> {
    let Some(first) = samples.first() else { return Ok(None) };
    let mut pool = first.snapshots.zeros(0);
    samples.iter().for_each(|sample| pool.append(sample.snapshots.clone()));
    let body = first.body.linear();
    let (directions, vectors) = main_directions(body, &pool, DEPTH * first.scene.tolerance)?;
    Ok(Some(orthonormal_basis(body, &directions.range(0..vectors))?))
}

/// How far a basis is off a body's own one, in steps that are chosen where there are none yet.
fn off(sample: &Sample, basis: &Columns, steps: &mut Option<Steps>) -> Result<Errors> {
    let scene = &sample.scene;
    let projection = project(sample.body.linear(), basis, rate(scene))?;
    let (own, taken) = ModalImpact::new(scene, &ModalBody::of(&sample.own)).trace(*steps)?;
    steps.get_or_insert(taken);
    match ModalImpact::new(scene, &ModalBody::of(&projection)).trace(Some(taken)) {
        Ok((merged, _)) => Ok(own.difference(&merged)),
        Err(_) => Ok(Errors::throughout(f64::INFINITY)),
    }
}
