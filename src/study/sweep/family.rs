//! Makes one basis for all members that differ only in the stiffness or damping of one support, or in the relaxation of
//! interlayers. It is merged from bodies made at a few values.

use crate::body::{Assembled, Columns, CommonBasis, ModalBody, Projection, snapshots};
use crate::error::{Error, Result};
use crate::impact::{Errors, ModalImpact, Readout};
use crate::material::Maxwell;
use crate::model::{
    BASIS_SHARE, Built, CellSize, Gauges, LARGE_ERROR_OF_DEFLECTION, ModelContext, Operators, build, cell_size,
    is_quickly_reduced_again, rate, reduce,
};
use crate::scene::Scene;

/// Least number of values for which a merged basis is made. Fewer are computed one by one.
pub const MIN_VALUES: usize = 20;

/// Largest number of values at which bodies are made.
const MAX_BODIES: usize = 33;

/// Least number of values per body made: merging costs about as much as making one more body.
const VALUES_PER_BODY: usize = 4;

/// Smallest weight of the directions kept in the basis, relative to the tolerance.
const DEPTH: f64 = 0.03;

/// Error of a merged basis over its difference from one that keeps directions down to a tenth of the least weight. An
/// estimate.
pub const ERROR_FACTOR_OF_MERGED: f64 = 2.2;

/// A merged basis with its tested errors.
pub struct Family {
    merged: CommonBasis,
    /// Pairs (upper end of an interval of values, errors). The merged basis is tested at the middle of the interval; the
    /// discretisation error and the errors of the bodies' own bases are added.
    errors: Vec<(f64, Errors)>,
    /// Number of unknowns of the bodies before reduction.
    pub unknowns: usize,
    /// Number of vectors of the merged basis.
    vectors: usize,
    /// Readout of the stresses on faces.
    pub readout: Option<Readout>,
}

/// A body made at one value.
struct Sample {
    body: Assembled,
    snapshots: Columns,
    own: Projection,
    /// Errors of its own basis.
    errors: Errors,
    scene: Scene,
}

impl Family {
    /// Makes bodies at the first and the last value, and between them wherever the merged basis is not accurate enough
    /// at the middle. Collective.
    ///
    /// # Errors
    /// [`Error::Solve`] if that takes too many bodies or they cannot share a basis; same as making a model.
    pub fn new(context: &ModelContext, values: &[f64], scene_of: &dyn Fn(f64) -> Result<Scene>) -> Result<Self> {
        let not_shared = |why: &str| Err(Error::Solve(format!("no basis is shared: {why}")));
        let last = values.len() - 1;
        let operators = |place: usize, size: f64| {
            let scene = scene_of(values[place])?;
            match build(context, &scene, scene.body.model, size)? {
                Built::Operators(built) => Ok((built, scene)),
                Built::Given(_) => Err(Error::Solve("the theory has no supports".into())),
            }
        };
        // All bodies have the finer of the cells of the two end values.
        let (mut size, mut of_cells) = (1.0_f64, Errors::default());
        for place in [0, last] {
            let (built, scene) = operators(place, 1.0)?;
            let CellSize { size: own, error, local_field, .. } = cell_size(context, &scene, scene.body.model, built)?;
            size = size.min(own);
            of_cells = of_cells.max(error.joined(local_field));
        }
        let make = |place: usize| -> Result<Sample> {
            let (built, scene) = operators(place, size)?;
            let body = built.body;
            let mut reduced = reduce(context, body.linear(), &scene)?;
            // The larger of the two bases is there already, and its error is less than that of the smaller one.
            let own = reduced.larger().clone();
            let snapshots = snapshots(reduced.krylov.basis(), &own, rate(&scene));
            Ok(Sample { body, snapshots, own, errors: reduced.error, scene })
        };
        let mut ends = [make(0)?, make(last)?];
        // The end values of a layer's modulus may lead to different cells, whose basis vectors cannot be merged.
        let unknowns = ends[0].body.linear().unknowns();
        if ends[1].body.linear().unknowns() != unknowns {
            return not_shared("the end values have different cells");
        }
        let [mut pool, others] = ends.each_mut().map(|end| {
            let none = end.snapshots.zeros(0);
            std::mem::replace(&mut end.snapshots, none)
        });
        pool.append(others);
        let merge = |pool: &Columns| {
            let depth = DEPTH * ends[0].scene.tolerance;
            let bodies = [(values[0], ends[0].body.linear()), (values[last], ends[1].body.linear())];
            CommonBasis::new(bodies, pool, depth, rate(&ends[0].scene))
        };
        let mut of_basis = ends[0].errors.max(ends[1].errors);
        let mut merged = merge(&pool)?;
        // The local contact constants are those of the first end. If they are not accurate enough for the last end,
        // each member gets its own body.
        let of_last = off(&merged, values[last], &ends[1])?;
        if of_last.of(ends[1].scene.measure) > BASIS_SHARE * ends[1].scene.tolerance {
            return not_shared("the local field of the first value does not serve the last one");
        }
        let (mut open, mut errors, mut made) = (vec![(0, last)], Vec::new(), 2);
        while let Some((from, to)) = open.pop() {
            if to - from < 2 {
                errors.push((values[to], Errors::default()));
                continue;
            }
            if made == MAX_BODIES.min(values.len() / VALUES_PER_BODY) {
                return not_shared("it takes too many bodies");
            }
            let middle = from.midpoint(to);
            let sample = make(middle)?;
            if sample.body.linear().unknowns() != unknowns {
                return not_shared("a value between has different cells");
            }
            let tolerance = BASIS_SHARE * sample.scene.tolerance;
            let found = off(&merged, values[middle], &sample)?;
            let (first, all) = (found.of(sample.scene.measure), found.history);
            of_basis = of_basis.max(sample.errors);
            tracing::info!(value = values[middle], first, all, "merged basis tested");
            pool = merged.directions;
            pool.append(sample.snapshots);
            made += 1;
            merged = merge(&pool)?;
            if first <= tolerance {
                errors.push((values[to], found));
            } else {
                open.extend([(from, middle), (middle, to)]);
            }
        }
        errors.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (_, error) in &mut errors {
            // Errors of later contacts may add up.
            let history = (*error + of_cells + of_basis).history;
            *error = Errors { history, ..error.joined(of_cells).joined(of_basis) };
        }
        let basis = merged.basis();
        let vectors = basis.len();
        let (Operators { evaluator, .. }, scene) = operators(0, size)?;
        let is_read = scene.output.is_read() && !basis.is_empty();
        let gauges = is_read.then(|| Gauges::new(context.comm, &scene, evaluator, unknowns, Some(basis)));
        let readout = gauges.transpose()?.map(|gauges| gauges.readout);
        Ok(Self { merged, errors, unknowns, vectors, readout })
    }

    /// Whether the error of the deflection is large, and a family of bases with a low shift is made quickly.
    pub fn needs_low_shift(&self, scene: &Scene) -> bool {
        let error = self.errors.iter().map(|(_, errors)| errors.deflection).fold(0.0, f64::max);
        error > LARGE_ERROR_OF_DEFLECTION
            && is_quickly_reduced_again(scene, scene.body.model, self.unknowns, self.vectors)
    }

    /// The body at a value with the given chains, on the basis and on the larger one, with the errors of the interval
    /// that contains the value.
    pub fn at(&self, value: f64, chains: &[Maxwell]) -> ([ModalBody; 2], Errors) {
        let near = self.errors.iter().find(|(to, _)| value <= *to).map_or(Errors::default(), |(_, error)| *error);
        (self.merged.at(value).map(|body| ModalBody::of(&body.with_chains(chains))), near)
    }
}

/// Difference of the force on the merged basis from the force on the body's own basis.
fn off(merged: &CommonBasis, value: f64, sample: &Sample) -> Result<Errors> {
    let chains: Vec<Maxwell> = sample.body.linear().chains().into_iter().cloned().collect();
    let [basis, _] = merged.at(value).map(|body| body.with_chains(&chains));
    let (own, steps) = ModalImpact::new(&sample.scene, &ModalBody::of(&sample.own)).trace(None)?;
    match ModalImpact::new(&sample.scene, &ModalBody::of(&basis)).trace(Some(steps)) {
        Ok((merged, _)) => Ok(own.difference(&merged)),
        Err(_) => Ok(Errors::throughout(f64::INFINITY)),
    }
}
