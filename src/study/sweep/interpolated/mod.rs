//! Interpolates, between a few bodies, the response of members that differ only in the relaxation of interlayers.
//!
//! All bodies have one mesh, made for the shortest waves of all members, and one basis, made of the vibrations of three
//! bodies. Bodies are made at a few values, each with its own relaxation and its own local field under the impactor.
//! The response ([`Response`]) at other values follows by cubic interpolation, and so do the largest tensions on faces
//! ([`FaceInterpolation`]). Where the interpolated response at the
//! middle of an interval differs too much from the body there, the interval is halved. Each body is made by one rank,
//! with the same numbers on any rank, and all ranks receive it.

mod maker;

use std::cell::OnceCell;
use std::collections::BTreeMap;

use petsc_wrap::Comm;

use super::spread::spread;
use crate::agree::{agree, decided};
use crate::body::{Interpolant, ModalBody, Response};
use crate::error::Result;
use crate::impact::{Errors, Readout};
use crate::model::watch::Watch;
use crate::model::{
    BASIS_SHARE, LARGE_ERROR_OF_DEFLECTION, is_quickly_reduced_again, layerwise_evaluator, local_field_errors,
};
use crate::scene::{Initial, Load, Model, Scene};
use crate::space::evaluate::{FaceInterpolation, WeightedFaces};
use crate::space::plate::contact_wavelength;
use maker::{Cells, Made, Sample, SampleNumbers, SharedBasis};

/// Initial number of intervals between values.
const FIRST_INTERVALS: usize = 4;

/// Largest number of bodies.
const MAX_BODIES: usize = 65;

/// Weights below which directions are left out of the basis, relative to the tolerance. They are tried in this order until
/// the basis is accurate. The slower the contact, the fewer directions have large weights.
const SMALLEST_WEIGHTS: [f64; 3] = [0.03, 0.01, 0.003];

/// Number of values, equally spaced by their places, at which the error of the local field is estimated.
const LOCAL_FIELDS: usize = 9;

/// Share of the tolerance for the interpolation error.
const INTERPOLATION_SHARE: f64 = 0.3;

/// Largest number of bodies that are made for the deflection alone.
const MAX_BODIES_FOR_DEFLECTION: usize = 33;

/// Interpolation error of the deflection up to which no more bodies are made for it. It may be larger if the error by the
/// basis is: this share of that error.
const ERROR_OF_DEFLECTION: f64 = INTERPOLATION_SHARE * LARGE_ERROR_OF_DEFLECTION;

/// Share of the tolerance for the error of the simplifications in each response.
const RESPONSE_SHARE: f64 = 0.1;

/// Smallest assumed ratio of the error of cubic interpolation to the error with intervals twice as long. For short
/// intervals it is 1/16. Where a term of the chain starts or ceases to be followed, bodies change at once and errors
/// hardly fall.
const ERROR_RATIO_ON_HALVING: f64 = 0.25;

/// Number of bodies in an interpolation.
const STENCIL: usize = 4;

/// Bodies and errors that all members share.
pub struct Interpolated {
    shared: SharedBasis,
    nodes: Vec<Node>,
    /// Interpolation error in each interval, by the interval's upper end.
    errors: Vec<(f64, Errors)>,
    /// Discretisation error and error of the basis.
    of_model: Errors,
    /// Error of the basis.
    of_basis: Errors,
    /// Interpolants of neighbouring bodies, by the index of the first body. Each is made when a member first needs it.
    interpolants: Vec<OnceCell<Interpolant>>,
    is_geometric: bool,
}

/// A body at one value.
struct Node {
    value: f64,
    response: Response,
    scene: Scene,
    /// Readout of the stresses on faces, made when a member first needs it.
    readout: OnceCell<Readout>,
}

/// The basis that all bodies of an interpolation share, with its errors.
pub struct Start {
    shared: SharedBasis,
    /// Errors of discretisation, averaging and local field.
    of_cells: Errors,
    /// Error of the basis.
    of_basis: Errors,
}

/// An interval between two indices of values with known bodies.
struct Interval {
    from: usize,
    to: usize,
    /// Difference at the middle of the interval whose half this is; 0 for the initial intervals.
    before: Errors,
    /// Estimated error in the interval without more bodies; infinite for the initial intervals.
    error: Errors,
}

impl Interval {
    fn initial(ends: &[usize]) -> Self {
        let error = Errors::throughout(f64::INFINITY);
        Self { from: ends[0], to: ends[1], before: Errors::default(), error }
    }

    /// Whether a body at the middle is needed for the quantity that the tolerance applies to.
    fn is_poor(&self, first: &Scene) -> bool {
        // (NaN is poor, too.)
        let error = self.error.of(first.measure);
        error.is_nan() || error > INTERPOLATION_SHARE * first.tolerance
    }
}

/// Whether bodies of a scene may be interpolated: layerwise plates of several layers that start at rest, without loads,
/// pads and energy gate, in modal coordinates and adaptive time steps.
pub fn admits(scene: &Scene) -> bool {
    let is_moved = scene.load != Load::default() || scene.supports.iter().any(|one| one.displacement != [0.0; 3]);
    let is_layerwise = scene.body.model == Model::Layerwise && scene.body.composition.uniform().is_none();
    let is_free = scene.time.initial == Initial::Rest && scene.time.step.is_none() && !is_moved;
    let is_modal = scene.time.modal && scene.is_reduced();
    // These bodies have no energies.
    let is_gated = scene.solver.energy_gate.is_some();
    is_layerwise && is_free && is_modal && !is_gated && !scene.is_on_pads()
}

impl Start {
    /// Makes the basis for ascending values; `scene_of` returns the scene of a value. Each rank's interruption is
    /// watched separately. Returns `None` if bodies at these values cannot share a basis. Collective.
    ///
    /// # Errors
    /// Same as making a model.
    pub fn new(
        ranks: &Comm,
        values: &[f64],
        scene_of: &dyn Fn(f64) -> Result<Scene>,
        watch: &dyn Watch,
    ) -> Result<Option<Self>> {
        let last = values.len() - 1;
        let mut cells = Cells { comm: ranks.session().alone(), wavelength: f64::INFINITY, size: 1.0, vectors: None };
        for place in [0, last] {
            cells.wavelength = cells.wavelength.min(contact_wavelength(&scene_of(values[place])?)?);
        }
        let asked = spread(ranks, 2, |k| cells.asked_by(&cells.on(scene_of(values[k * last])?), watch))?;
        let of_cells = asked.iter().fold(Errors::default(), |most, end| most.max(end.error));
        cells.size = asked.iter().fold(cells.size, |size, end| size.min(end.size));
        cells.vectors = asked.iter().filter_map(|end| end.vectors).reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1])]);
        let scene = |place: usize| Ok::<_, crate::Error>(cells.on(scene_of(values[place])?));
        // The error of the local field is the largest where layers relax within the contact: seldom at the ends.
        let local_fields = spread(ranks, LOCAL_FIELDS, |k| {
            let scene = scene(k * last / (LOCAL_FIELDS - 1))?;
            let evaluator = scene.output.is_read().then(|| layerwise_evaluator(&scene, cells.size)).transpose()?;
            Ok(local_field_errors(&scene, scene.body.model, evaluator.as_ref(), None))
        })?;
        let of_cells = of_cells.joined(local_fields.into_iter().fold(Errors::default(), Errors::max));
        let found = shared_basis(ranks, last, &cells, &scene, watch)?;
        Ok(found.map(|(shared, of_basis)| Self { shared, of_cells, of_basis }))
    }

    /// Whether the error of the deflection is large, and a basis with a low shift is made quickly.
    pub fn needs_low_shift(&self, scene: &Scene) -> bool {
        let Self { shared, of_basis, .. } = self;
        of_basis.deflection > LARGE_ERROR_OF_DEFLECTION
            && is_quickly_reduced_again(scene, scene.body.model, shared.unknowns, shared.basis.count())
    }
}

impl Interpolated {
    /// Makes the bodies for the values of the basis. Returns `None` if too many bodies would be needed, or if their
    /// responses are not accurate enough. Collective.
    ///
    /// # Errors
    /// Same as making a model.
    pub fn new(
        ranks: &Comm,
        values: &[f64],
        scene_of: &dyn Fn(f64) -> Result<Scene>,
        start: Start,
        watch: &dyn Watch,
    ) -> Result<Option<Self>> {
        let (last, Start { shared, of_cells, of_basis }) = (values.len() - 1, start);
        let cells = shared.cells.clone();
        let scene = |place: usize| Ok::<_, crate::Error>(cells.on(scene_of(values[place])?));
        let middle = values[last / 2];
        let is_geometric = values[0] > 0.0
            && (middle / (values[0] * values[last]).sqrt()).ln().abs()
                < (2.0 * middle / (values[0] + values[last])).ln().abs();
        let of_model = of_cells.joined(of_basis);
        // All members have the same tolerance, for the same quantity.
        let first = scene(0)?;
        let (nodes, errors, interpolants) = (Vec::new(), Vec::new(), Vec::new());
        let mut all = Self { shared, nodes, errors, of_model, of_basis, interpolants, is_geometric };
        let mut nodes: BTreeMap<usize, Node> = BTreeMap::new();
        // Intervals whose middle is not known yet. Initially only the ends of intervals are computed.
        let mut open: Vec<Interval> = Vec::new();
        let mut places: Vec<usize> = (0..=FIRST_INTERVALS).map(|k| k * last / FIRST_INTERVALS).collect();
        loop {
            let near: Vec<&Node> = nodes.values().collect();
            let make = |k: usize| {
                let place = places[k];
                all.shared.node(&scene(place)?, values[place], &near, is_geometric, watch)
            };
            let made = spread(ranks, places.len(), make)?;
            let is_poor = |made: &Made| made.of_response.of(first.measure) > RESPONSE_SHARE * first.tolerance;
            if made.iter().any(is_poor) {
                return Ok(None);
            }
            let mut found = Vec::new();
            for (&place, Made { response, of_response, of_interpolation }) in places.iter().zip(made) {
                all.of_model = all.of_model.max(of_model.joined(of_response));
                found.push(of_interpolation);
                let (value, coordinates) = (values[place], response.coordinates());
                let Errors { first_contact, history, .. } = of_interpolation;
                let response_error = of_response.first_contact;
                tracing::info!(value, coordinates, first = first_contact, history, response_error, "body made");
                nodes.insert(place, Node { value, response, scene: scene(place)?, readout: OnceCell::new() });
            }
            open = match open.is_empty() {
                true => places.windows(2).map(Interval::initial).collect(),
                false => all.judged(&open, &places, &found, values, &first),
            };
            // Intervals between neighbouring values have no value inside.
            let closed = open.extract_if(.., |interval| interval.to - interval.from < 2);
            all.errors.extend(closed.map(|interval| (values[interval.to], Errors::default())));
            if open.is_empty() {
                break;
            }
            if nodes.len() + open.len() > MAX_BODIES_FOR_DEFLECTION {
                let closed = open.extract_if(.., |interval| !interval.is_poor(&first));
                all.errors.extend(closed.map(|interval| (values[interval.to], interval.error)));
            }
            if open.is_empty() {
                break;
            }
            if nodes.len() + open.len() > MAX_BODIES {
                return Ok(None);
            }
            places = open.iter().map(|interval| interval.from.midpoint(interval.to)).collect();
        }
        all.errors.sort_by(|a, b| a.0.total_cmp(&b.0));
        all.nodes = nodes.into_values().collect();
        tracing::info!(bodies = all.nodes.len(), "interpolation bodies");
        all.interpolants = all.nodes.windows(STENCIL).map(|_| OnceCell::new()).collect();
        Ok(Some(all))
    }

    /// Keeps the errors of the accurate intervals, estimated from the differences at their middles. Returns the halves
    /// of the others.
    fn judged(
        &mut self,
        intervals: &[Interval],
        middles: &[usize],
        found: &[Errors],
        values: &[f64],
        first: &Scene,
    ) -> Vec<Interval> {
        let mut open = Vec::new();
        let of_deflection = ERROR_OF_DEFLECTION.max(INTERPOLATION_SHARE * self.of_basis.deflection);
        for ((&Interval { from, to, before, .. }, &middle), &difference) in intervals.iter().zip(middles).zip(found) {
            let ends = [from, middle, to].map(|place| coordinate(values[place], self.is_geometric));
            let error = on_halving(difference, before, unevenness(ends), first);
            let halves =
                [(from, middle), (middle, to)].map(|(from, to)| Interval { from, to, before: difference, error });
            if halves[0].is_poor(first) || error.deflection > of_deflection {
                open.extend(halves);
            } else {
                self.errors.push((values[to], error));
            }
        }
        open
    }

    /// Number of unknowns of the whole bodies.
    pub fn unknowns(&self) -> usize {
        self.shared.unknowns
    }

    /// The interpolated body at a value for a member's run, with its errors and the readout of the stresses on faces.
    /// Returns `None` if the member's impact differs from the one for which the errors are estimated.
    ///
    /// # Errors
    /// Same as making a model.
    pub fn at(&self, value: f64, scene: &Scene) -> Result<Option<(ModalBody, Errors, Option<Readout>)>> {
        let is_alike = self.nodes.first().is_some_and(|node| {
            let of_all = &node.scene;
            scene.impactor.is_like(&of_all.impactor) && scene.time == of_all.time
        });
        let (true, Some(of_interpolation)) = (is_alike, self.error_at(value)) else { return Ok(None) };
        let near: Vec<&Node> = self.nodes.iter().collect();
        let errors = self.of_model.joined(of_interpolation);
        let Some(between) = between(&near, value, self.is_geometric) else { return Ok(None) };
        let readout = match scene.output.is_read() {
            true => self.readout_at(&between, value)?,
            false => None,
        };
        let known = self.interpolants.get(between.begin);
        let known = known.map(|known| known.get_or_init(|| Interpolant::new(&between.bodies)));
        Ok(Some((between.body(known), errors, readout)))
    }

    /// Readout of the nearest body at a value. It also contains the faces of all bodies of the interpolation, with their
    /// weights.
    fn readout_at(&self, between: &Between, value: f64) -> Result<Option<Readout>> {
        let nodes = &self.nodes[between.begin..between.begin + between.weights.len()];
        let readouts = nodes.iter().map(|node| self.readout(node)).collect::<Result<Vec<_>>>()?;
        let linear_weights = linear_weights(nodes, value, self.is_geometric);
        let nearest = (0..nodes.len()).max_by(|&a, &b| linear_weights[a].total_cmp(&linear_weights[b]));
        let weighted = readouts.iter().zip(&between.weights).zip(&linear_weights);
        let bodies = weighted.filter_map(|((readout, &weight), &linear_weight)| {
            Some(WeightedFaces { faces: readout.faces.clone()?, weight, linear_weight })
        });
        let all = FaceInterpolation { bodies: bodies.collect() };
        Ok(nearest.map(|nearest| Readout { face_interpolation: Some(all), ..readouts[nearest].clone() }))
    }

    /// Readout of the stresses on a body's faces.
    fn readout<'a>(&self, node: &'a Node) -> Result<&'a Readout> {
        if let Some(readout) = node.readout.get() {
            return Ok(readout);
        }
        let readout = self.shared.readout(&node.scene)?;
        Ok(node.readout.get_or_init(|| readout))
    }

    /// Estimated interpolation error at a value; `None` above the largest value.
    pub fn error_at(&self, value: f64) -> Option<Errors> {
        self.errors.iter().find(|(to, _)| value <= *to).map(|(_, error)| *error)
    }

    /// Difference of the interpolated body's force from the force of a scene's actual body at a value, on the same
    /// basis and in the same steps.
    ///
    /// # Errors
    /// Same as making a model.
    pub fn difference_at(&self, value: f64, scene: &Scene, watch: &dyn Watch) -> Result<Errors> {
        let scene = self.shared.cells.on(scene.clone());
        let near: Vec<&Node> = self.nodes.iter().collect();
        Ok(self.shared.node(&scene, value, &near, self.is_geometric, watch)?.of_interpolation)
    }
}

/// Makes the basis from the vibrations of three bodies, at the first, middle and last of the places 0 to `last`. It is
/// tested on two more bodies halfway between these. Returns the basis with its error; `None` if the bodies have
/// different unknowns or the basis is not accurate enough. Collective.
fn shared_basis(
    ranks: &Comm,
    last: usize,
    cells: &Cells,
    scene: &dyn Fn(usize) -> Result<Scene>,
    watch: &dyn Watch,
) -> Result<Option<(SharedBasis, Errors)>> {
    const BASIS: usize = 3;
    let places = [0, last / 2, last, last / 4, 3 * last / 4];
    let mut samples: [Option<Sample>; 5] = Default::default();
    let mut numbers: Vec<SampleNumbers> = spread(ranks, places.len(), |k| {
        let sample = samples[k].insert(cells.sample(scene(places[k])?, watch)?);
        let numbers = sample.numbers();
        Ok(if k < BASIS { numbers } else { SampleNumbers { vibrations: Vec::new(), ..numbers } })
    })?;
    if numbers.iter().any(|sample| sample.unknowns != numbers[0].unknowns) {
        return Ok(None);
    }
    let of_bases = numbers.iter().fold(Errors::default(), |most, sample| most.max(sample.error));
    numbers.truncate(BASIS);
    let steps = spread(ranks, places.len(), |k| match &samples[k] {
        Some(sample) if k == BASIS => Ok(Some(sample.steps()?)),
        _ => Ok(None),
    })?;
    let Some(steps) = steps[BASIS] else { return Ok(None) };
    let scene = scene(0)?;
    // Sample 0 is on rank 0.
    let weights = SMALLEST_WEIGHTS.map(|weight| weight * scene.tolerance);
    let mut directions = None;
    let counts = decided(ranks, || {
        let Some(sample) = &samples[0] else { return Ok(None) };
        let (columns, counts) = sample.main_directions(&numbers, weights)?;
        directions = Some(columns);
        Ok(Some(counts))
    })?;
    let shared = SharedBasis::new(cells.clone(), &scene, steps, watch);
    // One rank may be interrupted before the others.
    let mut shared = agree(ranks, shared.map_err(|error| error.of_all_ranks().as_told()))?;
    for count in counts.into_iter().flatten() {
        if count == shared.basis.count() {
            continue;
        }
        let more = decided(ranks, || match (&samples[0], &directions) {
            (Some(sample), Some(all)) => sample.extension(&shared.basis, &all.range(shared.basis.count()..count)),
            _ => Ok(Vec::new()),
        })?;
        shared.extend(&more);
        let off = spread(ranks, places.len(), |k| match &samples[k] {
            Some(sample) if k >= BASIS => sample.off(&shared),
            _ => Ok(Errors::default()),
        })?;
        let of_merging = off.into_iter().fold(Errors::default(), Errors::max);
        let (vectors, first, all) = (shared.basis.count(), of_merging.first_contact, of_merging.history);
        tracing::info!(vectors, first, all, "common basis");
        if of_merging.of(scene.measure) <= BASIS_SHARE * scene.tolerance {
            return Ok(Some((shared, of_bases.joined(of_merging))));
        }
    }
    Ok(None)
}

/// Bodies next to a value, with the weights of Lagrange's interpolation.
struct Between<'a> {
    /// Index of the first of these bodies.
    begin: usize,
    bodies: Vec<&'a Response>,
    weights: Vec<f64>,
}

/// The coordinate of interpolation: the value or its logarithm.
fn coordinate(value: f64, is_geometric: bool) -> f64 {
    if is_geometric { value.ln() } else { value }
}

/// Factor on the interpolation error of an interval's halves for a value that is not exactly in the middle. The error
/// grows with the fourth power of the longer half. The difference was measured where the product of the distances to
/// the ends is smaller than at the middle.
fn unevenness([from, middle, to]: [f64; 3]) -> f64 {
    let (below, above, half) = (middle - from, to - middle, 0.5 * (to - from));
    (below.max(above) / half).powi(4) * half * half / (below * above)
}

/// The bodies next to a value; `None` if there are none.
fn between<'a>(nodes: &[&'a Node], value: f64, is_geometric: bool) -> Option<Between<'a>> {
    let above = nodes.partition_point(|node| node.value < value);
    let begin = above.saturating_sub(STENCIL / 2).min(nodes.len().saturating_sub(STENCIL));
    let near = &nodes[begin..nodes.len().min(begin + STENCIL)];
    let at = |value: f64| coordinate(value, is_geometric);
    let weight = |node: &&Node| -> f64 {
        let others = near.iter().filter(|other| other.value != node.value);
        others.map(|other| (at(value) - at(other.value)) / (at(node.value) - at(other.value))).product()
    };
    let weights = near.iter().map(weight).collect();
    let bodies: Vec<&Response> = near.iter().map(|node| &node.response).collect();
    (!bodies.is_empty()).then_some(Between { begin, bodies, weights })
}

/// Weights of bodies, in ascending order of values, in the linear interpolation between the two that enclose a value.
fn linear_weights(nodes: &[Node], value: f64, is_geometric: bool) -> Vec<f64> {
    let mut weights = vec![0.0; nodes.len()];
    let above = nodes.partition_point(|node| node.value < value).clamp(1, nodes.len().max(2) - 1);
    let below = above - 1;
    match nodes.get(above) {
        Some(end) => {
            let [from, at, to] = [nodes[below].value, value, end.value].map(|value| coordinate(value, is_geometric));
            weights[above] = (at - from) / (to - from);
            weights[below] = 1.0 - weights[above];
        }
        None => weights.fill(1.0),
    }
    weights
}

impl Between<'_> {
    /// The interpolated body. `known` is the correspondence of the bodies' coordinates, if it was computed before.
    fn body(&self, known: Option<&Interpolant>) -> ModalBody {
        match known {
            Some(known) => known.sum(&self.bodies, &self.weights),
            None => Interpolant::new(&self.bodies).sum(&self.bodies, &self.weights),
        }
    }
}

/// Estimated interpolation error of an interval's halves, from the differences at its middle (`difference`) and at the
/// middle of the previous, longer interval (`before`; 0 if there is none). `unevenness` is a factor for a value that is
/// not exactly in the middle. Over the whole history the acceleration's error is reduced only if the difference is
/// within the tolerance, because with larger differences contacts appear and vanish with the value.
fn on_halving(difference: Errors, before: Errors, unevenness: f64, first: &Scene) -> Errors {
    let ratio = |difference: f64, before: f64| {
        let is_known = before > 0.0 && before.is_finite();
        let ratio = if is_known { (difference / before).clamp(ERROR_RATIO_ON_HALVING, 1.0) } else { 1.0 };
        ratio * unevenness
    };
    let smaller = ratio(difference.of(first.measure), before.of(first.measure)) * difference;
    let history = if difference.history <= first.tolerance { smaller.history } else { difference.history };
    let deflection = ratio(difference.deflection, before.deflection) * difference.deflection;
    let stress = ratio(difference.stress, before.stress) * difference.stress;
    Errors { history, deflection, stress, ..smaller }
}
