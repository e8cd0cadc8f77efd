//! Which theory stands for a plate of several layers: the layerwise one where its estimated error allows, otherwise the solid.
//!
//! The error is estimated as that of Mindlin's theory for one layer: a part of the difference from what each layer's own shear and the
//! local field under the impactor change ([`super::mindlin_error`]), here between the layerwise plate and one whose layers have neither.
//! To it comes what the static response of the infinite plate is off by at the length of the contact's waves. A body that relaxes is
//! compared with the moduli of half the contact's time. It is an estimate, not a bound.
//!
//! A solid that is too large for splines would be a mesh, which is read on its outer faces alone, while the largest tension of a laminate
//! is often on a face between layers. There the layerwise plate stays, with its estimate.

use petsc_wrap::Comm;

use super::cells::OF_CELLS;
use super::climb::{IN_PLACE_OF_MESH, OF_THEORY, pressed, rougher};
use super::elastic_cells;
use super::mindlin_error::mindlin_error_over_difference;
use super::reduce::{OF_BASIS, larger};
use super::theory::build_thin;
use super::watch::Watch;
use super::{Built, Model, build, reduce, refine, unrefined};
use crate::description::Description;
use crate::error::{Error, Result};
use crate::impact::{Cause, Errors, joined, rest};
use crate::scene::{Model as Theory, Scene, Time};
use crate::space::plate;
use crate::space::spline;

/// The layerwise plate; `None` where the solid is needed. Collective.
pub(super) fn layered(
    comm: &Comm,
    scene: &Scene,
    passed: &mut Vec<String>,
    watch: &dyn Watch,
) -> Result<Option<Model>> {
    let elastic = elastic_cells::elastic(scene);
    let elastic = Scene { time: Time { modal: true, ..scene.time.clone() }, ..elastic };
    let rough = rougher(&elastic);
    // That of a body that relaxes is made for the difference alone.
    let relaxes = !Description::new(scene).relaxations().is_empty();
    let elastic = if relaxes { rough.clone() } else { elastic };
    let Built::Operators(operators) = build(comm, &elastic, Theory::Layerwise, 1.0, watch)? else {
        return Err(Error::Solve("a plate has unknowns".into()));
    };
    // Cells and basis are not judged yet: their part of the difference is small, and so is what it changes in the estimate.
    let thick = unrefined(comm, &elastic, operators, watch)?;
    let thin = reduce(comm, build_thin(comm, &rough)?.body.linear(), &rough, watch)?;
    let difference = thick.reduced.force.0.difference(&thin.force.0);
    let mismatch = plate::mismatch(&elastic)?;
    let of_theory = mindlin_error_over_difference(&elastic) * difference + Errors::throughout(mismatch);
    let (differ, error) = (difference.of(scene.measure), of_theory.of(scene.measure));
    let of_what = scene.measure.of_what();
    let judged = format!(
        "shear of the stiff layers and the local field change layerwise by {differ:.1e}{of_what} in the first contact; estimated error of layerwise relative to solid: {error:.1e}"
    );
    let tolerance = scene.tolerance;
    let (over, share) = (watch.agreed(error / tolerance), OF_THEORY * tolerance);
    // Cells and basis get what the theory leaves of the tolerance, where it leaves a part.
    let mut left =
        Scene { tolerance: (rest(1.0, over) / joined(OF_CELLS, OF_BASIS)).min(1.0) * tolerance, ..scene.clone() };
    if over > OF_THEORY {
        let splines = if scene.is_reduced() { spline::admits(scene) } else { Err("it is not reduced".to_owned()) };
        match splines {
            Err(reason) if over * tolerance <= IN_PLACE_OF_MESH => {
                left.tolerance = tolerance;
                passed.push(format!(
                    "{judged}, above {share:.1e}, the theory's part of the tolerance, and yet taken: splines do not stand for its solid ({reason}), and a mesh has no stresses on faces between layers"
                ));
            }
            _ => {
                passed.push(format!(
                    "{judged}, above {share:.1e}, the theory's part of the tolerance, so the solid is taken"
                ));
                return Ok(None);
            }
        }
    } else {
        passed.push(judged);
    }
    let model = if elastic_cells::serves(scene, Theory::Layerwise) {
        let Built::Operators(operators) = build(comm, &left, Theory::Layerwise, 1.0, watch)? else {
            return Err(Error::Solve("a plate has unknowns".into()));
        };
        let [_, vectors] = thick.reduced.counts();
        let vectors = Some([vectors, larger(vectors)]);
        drop(thick);
        let fitted = elastic_cells::fit(comm, &left, Theory::Layerwise, operators, vectors, watch)?;
        Model::on_basis(comm, scene, Theory::Layerwise, fitted)?
    } else if scene.time.modal {
        let is_whole = left.tolerance == tolerance && !relaxes;
        let coarse = if is_whole {
            thick
        } else {
            let Built::Operators(operators) = build(comm, &left, Theory::Layerwise, 1.0, watch)? else {
                return Err(Error::Solve("a plate has unknowns".into()));
            };
            unrefined(comm, &left, operators, watch)?
        };
        Model::on_basis(
            comm,
            scene,
            Theory::Layerwise,
            refine(comm, &left, Theory::Layerwise, coarse, Errors::default(), watch)?,
        )?
    } else {
        Model::of(comm, &left, Theory::Layerwise, watch)?
    };
    Ok(Some(model.with_error(Cause::Theory, of_theory.joined(pressed(scene)))))
}
