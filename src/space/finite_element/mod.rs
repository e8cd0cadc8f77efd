//! Finite elements on a mesh, with three unknowns for each node, distributed over the ranks.
//!
//! Elements P1, P2, Q1 and Q2 on DMPlex: the discretisation of the paper.

mod assembly;
mod clamps;
mod facets;
mod location;
mod lumped;
mod patch;
mod point;
mod points;
mod recovery;
mod volume;

pub use assembly::{Stopped, assemble, into_matrix, into_vector, zeros};
pub use clamps::held;
pub use facets::{FacetRule, FiniteElements};
pub use points::Nodes;
pub use recovery::Recovery;

use petsc_wrap::{Insert, Int, NullSpace, Vector};

use super::{Space, SurfaceTerms};
use crate::body::{Body, BodyTerms, ContactPort, Lumped, Pads, Relaxation, StressReadings, deviates, memory};
use crate::contact::Localization;
use crate::description::{Description, region};
use crate::error::{Error, Result};
use crate::material::Maxwell;
use crate::mesh::Mesh;
use crate::scene::{Contact, Fault, Geometry, Scene, Scheme, Vec3};
use crate::solve::Method;

use assembly::{Components, node_graph};
use volume::{distortion, mass_by_node, stiffness};

impl Body {
    /// Assembles a scene's body of solid elements, with three unknowns for each node. Collective.
    ///
    /// # Errors
    /// A fault of the scene that can only be detected on the mesh: a missing surface, a tangled (inverted) cell, or an
    /// impact point off the surface. If a PETSc call fails.
    pub fn solid(scene: &Scene, mesh: &Mesh) -> Result<Self> {
        check_surfaces(scene, mesh)?;
        let Localization { vector: force, entries, compliance, footprint } = match scene.contact {
            Contact::Patch { disc: Some(_), .. } => {
                let message = "meshes carry the patch itself, on no wider disc".to_owned();
                return Err(Fault::new(
                    "contact.disc_radius",
                    message,
                    "take it out; `contact.patch_radius` is the patch",
                )
                .into());
            }
            Contact::Patch { radius, disc: None } => {
                Localization::patch(mesh, scene, radius).map_err(|error| with_number_of_parts(error, mesh))?
            }
            Contact::Area(area) => Localization::area(mesh, scene, &area)?,
            Contact::Point => Localization::point(mesh, &scene.impactor)?,
        };
        let description = Description::new(scene);
        let graph = node_graph(&mesh.comm, mesh.owned_nodes, &mesh.cells, 0..mesh.cells.len())?;
        let of_nodes = mass_by_node(&description.parts, mesh, graph)?;
        // K, M and S: nine entries for each pair of nodes, with their column numbers.
        let bytes = 3.0 * 9.0 * of_nodes.entries()? as f64 * (size_of::<f64>() + size_of::<Int>()) as f64;
        let what = format!("the matrices of {} unknowns", 3 * mesh.nodes);
        let help = "a coarser mesh; a box without `cells` is tried as a plate and as a solid of splines";
        let bytes = bytes / mesh.comm.size() as f64;
        memory::check(Some(&mesh.comm), memory::Need { bytes, what: &what, key: "body.mesh", help })?;
        let of_components = Components::new(&of_nodes)?;
        let elastic = stiffness(&description.parts, mesh, of_components.zeros()?)?;
        let mass = of_components.like(&elastic)?;
        drop(of_components);
        let products = Some([of_nodes.by_component(3)?, elastic.upper_triangle(3)?]);
        let space = FiniteElements::new(mesh);
        check_parts(scene, &space)?;
        let SurfaceTerms { support, damping, load, support_load, support_offset, pads } =
            SurfaceTerms::new(&space, &description)?;
        let is_explicit = matches!(scene.time.scheme, Scheme::CentralDifference { .. });
        let clamps = held(mesh, &description.clamps, |clamp, _| clamp.displacement)?;
        let pads = (!description.pads.is_empty()).then(|| Pads::new(&mesh.comm, pads, &clamps)).transpose()?;
        let nodes = mesh.positions();
        let followed = description.relaxations().into_iter().filter(|(chain, _)| !chain.terms.is_empty());
        let relaxation = |(chain, of): (&Maxwell, Vec<usize>)| {
            Ok(Relaxation { distortion: distortion(mesh, |part| of.contains(&part))?, chain: chain.clone() })
        };
        let relaxations = followed.map(relaxation).collect::<Result<Vec<_>>>()?;
        Ok(Self {
            mass,
            terms: BodyTerms {
                elastic,
                relaxations,
                support,
                damping,
                load,
                support_load,
                support_offset,
                contact: ContactPort { force, compliance, footprint },
                translation: translation(mesh, description.direction)?,
                readings: StressReadings::default(),
                infinite_plate: None,
                multiplicity: mesh.multiplicity as f64,
            },
            contact_entries: entries,
            products,
            lumped: is_explicit.then(|| Lumped::new(&description, mesh)).transpose()?,
            pads,
            unilateral: None,
            rigid_motions: Some(rigid_motions(mesh, &nodes)?),
            method: method(scene, 3 * mesh.nodes),
            nodes: Some(nodes),
            deviates: deviates_of_nodes(mesh)?,
            clamps,
            equilibrium: None,
            classes: Vec::new(),
        })
    }
}

/// Number of unknowns from which a Cholesky factor needs more memory and time than iterations.
const LARGE: usize = 300_000;

/// Relative tolerance of the iterations divided by the tolerance of the scene, for time steps of at least a hundredth
/// of the contact duration.
const SOLVER_TOLERANCE_FACTOR: f64 = 1e-4;

/// Solution method for a body with a given number of unknowns.
fn method(scene: &Scene, unknowns: usize) -> Method {
    if unknowns < LARGE { Method::Cholesky } else { by_iterations(scene) }
}

/// Solution method of a body too large for a factor. The iteration error of a step is a fraction of the displacement in
/// the step, and accumulates over the steps of a contact. With more steps, the tolerance must therefore be smaller.
pub fn by_iterations(scene: &Scene) -> Method {
    let impactor = &scene.impactor;
    let contact = impactor.contact_time();
    let part = scene.time.step.map_or(1.0, |step| (100.0 * step / contact).min(1.0));
    Method::Multigrid { tolerance: SOLVER_TOLERANCE_FACTOR * part * scene.tolerance }
}

/// Translations and rotations: the null space of K, or near null space if supports are soft or clamped parts small.
/// Collective.
fn rigid_motions(mesh: &Mesh, nodes: &[Vec3]) -> Result<NullSpace> {
    let mut coordinates = Vector::new(&mesh.comm, 3 * nodes.len())?;
    coordinates.write()?.copy_from_slice(nodes.as_flattened());
    let motions = NullSpace::rigid_body(&mut coordinates)?;
    coordinates.destroy()?;
    Ok(motions)
}

/// Random normal deviates for each unknown, which depend on the position of the node, not on its number.
fn deviates_of_nodes(mesh: &Mesh) -> Result<Vector> {
    let mut deviates = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
    for cell in 0..mesh.cells.len() {
        for (&node, position) in mesh.cells.nodes(cell).iter().zip(mesh.cells.node_positions(cell)) {
            let key = deviates::place(position, mesh.diameter);
            let values = [0, 1, 2].map(|component| deviates::normal(key.wrapping_add(component)));
            deviates.set_values(&[3 * node, 3 * node + 1, 3 * node + 2], &values, Insert::Replace)?;
        }
    }
    deviates.assemble()?;
    Ok(deviates)
}

/// Checks that the mesh has every surface that the scene names.
fn check_surfaces(scene: &Scene, mesh: &Mesh) -> Result<()> {
    let supports = scene.supports.iter().enumerate().map(|(i, s)| (format!("support.{i}.surface"), &s.surface));
    let tractions =
        scene.load.traction.iter().enumerate().map(|(i, t)| (format!("load.traction.{i}.surface"), &t.surface));
    // On a box, strengths are checked with its theory.
    let is_read = matches!(scene.body.geometry, Geometry::Gmsh(_));
    let strengths = scene.strength.by_face.keys().filter(|_| is_read);
    let strengths = strengths.map(|name| (format!("strength.face.{name}"), name));
    for (key, name) in supports.chain(tractions).chain(strengths) {
        if !mesh.surfaces.contains_key(name) {
            let known: Vec<String> = mesh.surfaces.keys().map(|name| format!("{name:?}")).collect();
            let help = match known.as_slice() {
                [] => "the mesh names no surface: give it physical surfaces in Gmsh".to_owned(),
                known => format!("the mesh names {}", known.join(", ")),
            };
            let file = match &scene.body.geometry {
                Geometry::Gmsh(path) => format!(" {}", path.display()),
                Geometry::Box { .. } => String::new(),
            };
            let message = match mesh.unusable_surfaces.get(name) {
                Some(reason) => format!("the surface {name:?} of the mesh{file} {reason}"),
                None => format!("the mesh{file} has no surface {name:?}"),
            };
            return Err(Fault::new(key, message, help).into());
        }
    }
    Ok(())
}

/// Adds to a fault of the contact that the mesh has several parts, which may be its cause.
fn with_number_of_parts(error: Error, mesh: &Mesh) -> Error {
    match error {
        Error::Fault(fault) if mesh.parts > 1 => {
            let message = format!("{} (the mesh has {} parts that share no node)", fault.message, mesh.parts);
            Error::Fault(Box::new(Fault { message, ..*fault }))
        }
        other => other,
    }
}

/// Checks that every part of a surface that the scene names has a non-zero area. On a box, this is known from its size; a
/// part may lie outside the quarter that is modelled. Collective.
fn check_parts(scene: &Scene, space: &FiniteElements) -> Result<()> {
    if matches!(scene.body.geometry, Geometry::Box { .. }) {
        return Ok(());
    }
    let supports = scene.supports.iter().enumerate().map(|(i, s)| (format!("support.{i}"), &s.surface, s.within));
    let tractions = scene.load.traction.iter().enumerate();
    let tractions = tractions.map(|(i, t)| (format!("load.traction.{i}"), &t.surface, t.within));
    for (key, surface, within) in supports.chain(tractions).filter(|(_, _, within)| within.is_some()) {
        let mut area = 0.0;
        for place in &region(scene, surface, within) {
            space.visit(place, &mut |_, element| {
                area += element.area();
                Ok(())
            })?;
        }
        if space.sum(area) == 0.0 {
            let message = format!("nothing of the surface {surface:?} lies within");
            return Err(Fault::new(format!("{key}.within"), message, "a part that meets the surface").into());
        }
    }
    Ok(())
}

/// Vector with the direction d at every node.
fn translation(mesh: &Mesh, direction: Vec3) -> Result<Vector> {
    let mut vector = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
    for node in vector.write()?.chunks_exact_mut(3) {
        node.copy_from_slice(&direction);
    }
    Ok(vector)
}
