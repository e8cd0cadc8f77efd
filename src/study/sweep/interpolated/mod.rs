//! Members that differ in the relaxation of interlayers alone: what a few bodies answer to the force, interpolated.
//!
//! All have one mesh, for the shortest waves of them all, and one basis, of the vibrations of three of them. Bodies are made at values
//! from which the answers between follow by cubic interpolation ([`Response`]): at each the relaxation, and the local field under the hit,
//! are its own. Wherever the answers at the middle between two values are not those of the body there, there are more values. Bodies are made
//! each by one rank, with the same numbers whichever it is, and all ranks get them.

mod maker;

use std::cell::OnceCell;
use std::collections::BTreeMap;

use nalgebra::DMatrix;
use petsc_wrap::Comm;

use super::spread::spread;
use crate::agree::{agree, decided};
use crate::body::{Directions, Interpolant, ModalBody, Response};
use crate::error::Result;
use crate::impact::{Errors, Readout};
use crate::model::OF_BASIS;
use crate::model::watch::Watch;
use crate::scene::{Initial, Load, Model, Scene};
use crate::space::evaluate::FaceStresses;
use crate::space::plate::contact_wavelength;
use maker::{Cells, Made, Sample, SampleNumbers, SharedBasis};

/// Intervals between values at first.
const FIRST_INTERVALS: usize = 4;

/// Bodies at most.
const MAX_BODIES: usize = 65;

/// Part of the tolerance that the interpolation may take.
const INTERPOLATION_SHARE: f64 = 0.3;

/// The error of cubic interpolation over that with intervals twice as long, at least, by which it is judged: a sixteenth where these are short.
/// (Where a term of the chain comes to be followed, or left out, bodies change at once, and errors hardly fall.)
const ERROR_RATIO_ON_HALVING: f64 = 0.25;

/// Stresses of the directions along which bodies are read over the largest, down to which they are taken, over the tolerance.
const OF_MOTIONS: f64 = 0.2;

/// Bodies by which one interpolates.
const STENCIL: usize = 4;

/// What all members share.
pub struct Interpolated {
    shared: SharedBasis,
    nodes: Vec<Node>,
    /// The interpolation's error in each interval, by its upper end.
    errors: Vec<(f64, Errors)>,
    /// That of the cells and the basis.
    of_model: Errors,
    /// Of bodies that lie side by side, by the number of the first, made when a member first asks for it.
    between: Vec<OnceCell<Interpolant>>,
    is_geometric: bool,
    /// The directions along which faces are read, as vectors of the bodies.
    vectors: Vec<Vec<f64>>,
}

/// A body at one value.
struct Node {
    value: f64,
    response: Response,
    scene: Scene,
    /// What is read of its faces, made when a member first asks for it.
    readout: OnceCell<Readout>,
}

/// Values between two numbers of which the bodies are known.
struct Interval {
    from: usize,
    to: usize,
    /// The difference in the middle of the interval of which this is a half; 0 of the first ones.
    before: f64,
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
    /// Of ascending values with their scenes; each rank is watched by itself. `None` where it takes too many bodies, or these have no basis in common.
    /// Collective.
    ///
    /// # Errors
    /// Those of a model.
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
        let Some((shared, of_basis)) = shared_basis(ranks, last, &cells, &scene, watch)? else { return Ok(None) };
        let middle = values[last / 2];
        let is_geometric = values[0] > 0.0
            && (middle / (values[0] * values[last]).sqrt()).ln().abs()
                < (2.0 * middle / (values[0] + values[last])).ln().abs();
        let of_model = of_cells.joined(of_basis);
        let (errors, between, vectors) = (Vec::new(), Vec::new(), Vec::new());
        let mut all = Self { shared, nodes: Vec::new(), errors, of_model, between, is_geometric, vectors };
        let mut nodes: BTreeMap<usize, Node> = BTreeMap::new();
        // Intervals whose middles are not known yet; at first there are only their ends.
        let mut open: Vec<Interval> = Vec::new();
        let mut places: Vec<usize> = (0..=FIRST_INTERVALS).map(|k| k * last / FIRST_INTERVALS).collect();
        loop {
            let near: Vec<&Node> = nodes.values().collect();
            let make = |k: usize| {
                let place = places[k];
                all.shared.node(&scene(place)?, values[place], &near, is_geometric, watch)
            };
            let made = spread(ranks, places.len(), make)?;
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
                true => places.windows(2).map(|ends| Interval { from: ends[0], to: ends[1], before: 0.0 }).collect(),
                false => all.judged(&open, &places, &found, values, &scene(0)?),
            };
            // (Neighbours have nothing between them.)
            let closed = open.extract_if(.., |interval| interval.to - interval.from < 2);
            all.errors.extend(closed.map(|interval| (values[interval.to], Errors::default())));
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
        all.read_along_main_motions(ranks, watch)?;
        all.between = all.nodes.windows(STENCIL).map(|_| OnceCell::new()).collect();
        Ok(Some(all))
    }

    /// Keeps the errors of the intervals that are good enough, by the differences that were found at their middles; the halves of the others are open.
    fn judged(
        &mut self,
        intervals: &[Interval],
        middles: &[usize],
        found: &[Errors],
        values: &[f64],
        scene: &Scene,
    ) -> Vec<Interval> {
        let mut open = Vec::new();
        for ((&Interval { from, to, before }, &middle), difference) in intervals.iter().zip(middles).zip(found) {
            let size = difference.of(scene.measure);
            // As it has fallen from the interval before this was half of it.
            let ratio = if before > 0.0 { (size / before).clamp(ERROR_RATIO_ON_HALVING, 1.0) } else { 1.0 };
            let ends = [from, middle, to].map(|place| coordinate(values[place], self.is_geometric));
            let error = on_halving(*difference, ratio * unevenness(ends), scene.tolerance);
            if error.of(scene.measure) <= INTERPOLATION_SHARE * scene.tolerance {
                self.errors.push((values[to], error));
            } else {
                open.extend([(from, middle), (middle, to)].map(|(from, to)| Interval { from, to, before: size }));
            }
        }
        open
    }

    /// Takes the bodies to the directions that make stresses, along which they are read. Collective.
    fn read_along_main_motions(&mut self, ranks: &Comm, watch: &dyn Watch) -> Result<()> {
        let (nodes, shared) = (&self.nodes, &self.shared);
        let scene = &nodes[nodes.len() / 2].scene;
        let count = shared.basis.count();
        let (shapes, parts) = decided(ranks, || {
            let vectors = shared.whole(&shared.basis);
            let stresses = match scene.output.stress {
                true => shared.cells.readout(scene, vectors, watch)?.faces.and_then(|faces| squares(&faces)),
                false => None,
            };
            let responses: Vec<&Response> = nodes.iter().map(|node| &node.response).collect();
            let stresses = stresses.unwrap_or_else(|| DMatrix::identity(count, count));
            let depth = OF_MOTIONS * scene.tolerance;
            let contact = scene.impactor.contact_time();
            let Directions { shapes, parts } = Response::main_motions(&responses, stresses, contact, depth);
            Ok((shapes.as_slice().to_vec(), parts.as_slice().to_vec()))
        })?;
        let directions = shapes.len() / count;
        let directions = Directions {
            shapes: DMatrix::from_vec(count, directions, shapes),
            parts: DMatrix::from_vec(directions, count, parts),
        };
        tracing::info!(directions = directions.parts.nrows(), nodes = self.nodes.len(), "main motions");
        self.vectors = self.shared.whole(&self.shared.basis.combined(&directions.shapes));
        self.nodes.iter_mut().for_each(|node| node.response = node.response.along(&directions));
        Ok(())
    }

    /// Unknowns of the bodies.
    pub fn unknowns(&self) -> usize {
        self.shared.unknowns
    }

    /// The body at a value for a member's run, with its errors and what is read of it: the faces of the nearest body. `None` for another impact than
    /// that for which the errors are estimated.
    ///
    /// # Errors
    /// Those of a model.
    pub fn at(
        &self,
        value: f64,
        scene: &Scene,
        watch: &dyn Watch,
    ) -> Result<Option<(ModalBody, Errors, Option<Readout>)>> {
        let is_alike = self.nodes.first().is_some_and(|node| {
            let of_all = &node.scene;
            scene.impactor == of_all.impactor && scene.time == of_all.time
        });
        let (true, Some(of_interpolation)) = (is_alike, self.error_at(value)) else { return Ok(None) };
        let near: Vec<&Node> = self.nodes.iter().collect();
        let nearest = near.iter().min_by(|a, b| (a.value - value).abs().total_cmp(&(b.value - value).abs()));
        let readout = match nearest.filter(|node| node.scene.output.is_read()) {
            Some(node) => Some(self.readout(node, watch)?.clone()),
            None => None,
        };
        let errors = Errors { stress: f64::NAN, ..self.of_model.joined(of_interpolation) };
        let Some(between) = between(&near, value, self.is_geometric) else { return Ok(None) };
        let known = self.between.get(between.begin);
        let known = known.map(|known| known.get_or_init(|| Interpolant::new(&between.bodies)));
        Ok(Some((between.body(known), errors, readout)))
    }

    /// What is read of a body's faces.
    fn readout<'a>(&self, node: &'a Node, watch: &dyn Watch) -> Result<&'a Readout> {
        if let Some(readout) = node.readout.get() {
            return Ok(readout);
        }
        let readout = self.shared.cells.readout(&node.scene, self.vectors.clone(), watch)?;
        Ok(node.readout.get_or_init(|| readout))
    }

    /// The estimated error of the interpolation at a value; `None` above all.
    pub fn error_at(&self, value: f64) -> Option<Errors> {
        self.errors.iter().find(|(to, _)| value <= *to).map(|(_, error)| *error)
    }

    /// How far the interpolated body's force is off that of the body which a scene has at a value, on the same basis in the same steps.
    ///
    /// # Errors
    /// Those of a model.
    pub fn difference_at(&self, value: f64, scene: &Scene, watch: &dyn Watch) -> Result<Errors> {
        let scene = self.shared.cells.on(scene.clone());
        let near: Vec<&Node> = self.nodes.iter().collect();
        Ok(self.shared.node(&scene, value, &near, self.is_geometric, watch)?.of_interpolation)
    }
}

/// The basis of the vibrations of three bodies, at the ends and in the middle of so many places, tested at the middles between these; with its
/// error. `None` where the bodies are not alike, or the basis is not good enough. Collective.
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
    // (The first rank has the first sample.)
    let first = |sample: &Option<Sample>| sample.as_ref().map(|sample| sample.common_basis(&numbers)).transpose();
    let Some(vectors) = decided(ranks, || first(&samples[0]))? else { return Ok(None) };
    let steps = spread(ranks, places.len(), |k| match &samples[k] {
        Some(sample) if k == BASIS => Ok(Some(sample.steps()?)),
        _ => Ok(None),
    })?;
    let Some(steps) = steps[BASIS] else { return Ok(None) };
    let scene = scene(0)?;
    let shared = SharedBasis::new(cells.clone(), &vectors, &scene, steps, watch);
    // (One rank may be interrupted before the others.)
    let shared = agree(ranks, shared.map_err(|error| error.of_all_ranks().as_told()))?;
    let off = spread(ranks, places.len(), |k| match &samples[k] {
        Some(sample) if k >= BASIS => sample.off(&shared),
        _ => Ok(Errors::default()),
    })?;
    let of_merging = off.into_iter().fold(Errors::default(), Errors::max);
    let (vectors, first, all) = (shared.basis.count(), of_merging.first_contact, of_merging.history);
    tracing::info!(vectors, first, all, "common basis");
    let is_good = of_merging.of(scene.measure) <= OF_BASIS * scene.tolerance;
    Ok(is_good.then(|| (shared, of_bases.joined(of_merging))))
}

/// RᵀR of the rows R of all stresses on faces, as far as they are read on a basis.
fn squares(faces: &FaceStresses) -> Option<DMatrix<f64>> {
    let (count, rows) = faces.dense()?;
    let columns = DMatrix::from_row_slice(rows.len() / count.max(1), count, rows);
    Some(columns.tr_mul(&columns))
}

/// Bodies next to a value, with the weights of Lagrange's interpolation.
struct Between<'a> {
    /// The number of the first of them.
    begin: usize,
    bodies: Vec<&'a Response>,
    weights: Vec<f64>,
}

/// That in which answers are interpolated.
fn coordinate(value: f64, is_geometric: bool) -> f64 {
    if is_geometric { value.ln() } else { value }
}

/// The largest error of cubic interpolation in the halves of an interval, over what the difference at its middle tells of halves of one length. Members
/// may have no value in the very middle: the error goes with the fourth power of the longer half, and the difference was seen where the distances to
/// the ends have a smaller product.
fn unevenness([from, middle, to]: [f64; 3]) -> f64 {
    let (below, above, half) = (middle - from, to - middle, 0.5 * (to - from));
    (below.max(above) / half).powi(4) * half * half / (below * above)
}

/// The bodies next to a value; `None` where there are none.
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

impl Between<'_> {
    /// The body between them, by what they have to do with each other where that is known.
    fn body(&self, known: Option<&Interpolant>) -> ModalBody {
        match known {
            Some(known) => known.sum(&self.bodies, &self.weights),
            None => Interpolant::new(&self.bodies).sum(&self.bodies, &self.weights),
        }
    }
}

/// The error of interpolation between intervals of which the answers in the middle differ so much, where it falls by a ratio on halving. Over the
/// whole history it is only less than that where the difference is small: contacts come and go with the value.
fn on_halving(difference: Errors, ratio: f64, tolerance: f64) -> Errors {
    let smaller = ratio * difference;
    if difference.history <= tolerance { smaller } else { Errors { history: difference.history, ..smaller } }
}
