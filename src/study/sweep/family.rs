//! Members that differ in the stiffness or the damping of one support, or in the relaxation of interlayers: one basis, made at a few values,
//! for all of them.

use petsc_wrap::Comm;

use crate::body::{Assembled, Columns, Merged, ModalBody, Projection, snapshots};
use crate::error::Result;
use crate::impact::{Errors, ModalImpact, Readout};
use crate::material::Maxwell;
use crate::model::watch::Watch;
use crate::model::{Built, CellSize, Gauges, OF_BASIS, Operators, build, cell_size, rate, reduce};
use crate::scene::Scene;

/// Fewer values than this are computed one by one.
pub const LEAST: usize = 20;

/// Values at which bodies are made, at most.
const MOST: usize = 33;

/// Values over those at which bodies are made, at least: merging costs about as much as making one more.
const OF_VALUES: usize = 4;

/// Weight of the directions of a basis, over the tolerance, down to which they are taken.
const DEPTH: f64 = 0.03;

/// A merged basis with what was found of its errors.
pub struct Family {
    merged: Merged,
    /// Up to a value, the error over the whole history at the middle of the values around it, where the basis was tested; with those of
    /// the cells and of the bodies' own bases.
    errors: Vec<(f64, f64)>,
    /// Unknowns of the bodies.
    pub unknowns: usize,
    /// What is read of the bodies: the faces.
    pub readout: Option<Readout>,
}

/// A body made at one value.
struct Sample {
    body: Assembled,
    snapshots: Columns,
    own: Projection,
    /// Of that, over the whole history.
    error: f64,
    scene: Scene,
}

impl Family {
    /// Makes bodies at the first and the last value, and between them wherever the basis does not serve at the middle. `None` where
    /// that takes too many. Collective.
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
        let operators = |place: usize, size: f64| {
            let scene = scene_of(values[place])?;
            Ok::<_, crate::Error>(match build(comm, &scene, scene.body.model, size, watch)? {
                Built::Operators(built) => Some((built, scene)),
                Built::Given(_) => None,
            })
        };
        // The cells of all are the finer ones of the two ends.
        let (mut size, mut of_cells) = (1.0_f64, 0.0_f64);
        for place in [0, last] {
            let Some((built, scene)) = operators(place, 1.0)? else { return Ok(None) };
            let CellSize { size: own, error, .. } = cell_size(comm, &scene, scene.body.model, built, watch)?;
            size = size.min(own);
            of_cells = of_cells.max(error.history);
        }
        let make = |place: usize| -> Result<Sample> {
            let Some((built, scene)) = operators(place, size)? else {
                return Err(crate::Error::Solve("the theory has no supports".into()));
            };
            let body = built.body;
            let mut reduced = reduce(comm, body.linear(), &scene, watch)?;
            let own = reduced.larger().clone();
            let snapshots = snapshots(reduced.krylov.basis(), &own, rate(&scene));
            Ok(Sample { body, snapshots, own, error: reduced.error.history, scene })
        };
        let mut ends = [make(0)?, make(last)?];
        // A layer's modulus may ask for other cells, whose vectors have no common basis.
        let unknowns = ends[0].body.linear().unknowns();
        if ends[1].body.linear().unknowns() != unknowns {
            return Ok(None);
        }
        let [mut pool, others] = ends.each_mut().map(|end| {
            let none = end.snapshots.zeros(0);
            std::mem::replace(&mut end.snapshots, none)
        });
        pool.append(others);
        let merge = |pool: &Columns| {
            let depth = DEPTH * ends[0].scene.tolerance;
            let bodies = [(values[0], ends[0].body.linear()), (values[last], ends[1].body.linear())];
            Merged::new(bodies, pool, depth, rate(&ends[0].scene))
        };
        let mut of_basis = ends[0].error.max(ends[1].error);
        let mut merged = merge(&pool)?;
        // Local constants are those of the first end: where the other one asks for others, each body has its own.
        let of_last = off(&merged, values[last], &ends[1])?;
        if of_last.of(ends[1].scene.measure) > OF_BASIS * ends[1].scene.tolerance {
            return Ok(None);
        }
        let (mut open, mut errors, mut made) = (vec![(0, last)], Vec::new(), 2);
        while let Some((from, to)) = open.pop() {
            if to - from < 2 {
                errors.push((values[to], 0.0));
                continue;
            }
            if made == MOST.min(values.len() / OF_VALUES) {
                return Ok(None);
            }
            let middle = from.midpoint(to);
            let sample = make(middle)?;
            if sample.body.linear().unknowns() != unknowns {
                return Ok(None);
            }
            let tolerance = OF_BASIS * sample.scene.tolerance;
            let found = off(&merged, values[middle], &sample)?;
            let (first, all) = (found.of(sample.scene.measure), found.history);
            of_basis = of_basis.max(sample.error);
            tracing::info!(value = values[middle], first, all, "merged basis tested");
            pool = merged.directions;
            pool.append(sample.snapshots);
            made += 1;
            merged = merge(&pool)?;
            if first <= tolerance {
                errors.push((values[to], all));
            } else {
                open.extend([(from, middle), (middle, to)]);
            }
        }
        errors.sort_by(|a, b| a.0.total_cmp(&b.0));
        errors.iter_mut().for_each(|(_, error)| *error += of_cells + of_basis);
        let basis = merged.basis();
        let readout = match operators(0, size)? {
            Some((Operators { evaluator, .. }, scene)) if scene.output.is_read() && !basis.is_empty() => {
                Some(Gauges::new(comm, &scene, evaluator, unknowns, Some(basis))?.readout)
            }
            _ => None,
        };
        Ok(Some(Self { merged, errors, unknowns, readout }))
    }

    /// The body at a value and with the chains there, on the basis and on the larger one, with the error found near that value.
    pub fn at(&self, value: f64, chains: &[Maxwell]) -> ([ModalBody; 2], f64) {
        let near = self.errors.iter().find(|(to, _)| value <= *to).map_or(0.0, |(_, error)| *error);
        (self.merged.at(value).map(|body| ModalBody::of(&body.with_chains(chains))), near)
    }
}

/// How far the merged basis is off a body's own one, which was not among those it was made of.
fn off(merged: &Merged, value: f64, sample: &Sample) -> Result<Errors> {
    let chains: Vec<Maxwell> = sample.body.linear().chains().into_iter().cloned().collect();
    let [basis, _] = merged.at(value).map(|body| body.with_chains(&chains));
    let (own, steps) = ModalImpact::new(&sample.scene, &ModalBody::of(&sample.own)).trace(None)?;
    match ModalImpact::new(&sample.scene, &ModalBody::of(&basis)).trace(Some(steps)) {
        Ok((merged, _)) => Ok(own.difference(&merged)),
        Err(_) => Ok(Errors::throughout(f64::INFINITY)),
    }
}
