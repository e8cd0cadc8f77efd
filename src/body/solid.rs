//! A 3D elastic body, assembled over a mesh.

use petsc_wrap::{Insert, Int, Matrix, NullSpace, Vector};

use crate::agree::agree;
use crate::contact::{Localization, hertz};
use crate::error::{Error, Result};
use crate::form::{Material, SolidForms, SurfaceForms};
use crate::mesh::Mesh;
use crate::scene::{Contact, Fault, Scene, Scheme, SupportKind, Vec3};
use crate::solve::Method;

use super::assembly::{Components, Stopped, assemble, into_matrix, into_vector, node_graph, zeros};
use super::deviates::{normal, place};
use super::{Body, Clamps, Lumped, Pads};

impl Body {
    /// Assembles a scene's body of solid elements, three unknowns a node. Collective.
    ///
    /// # Errors
    /// A fault of the scene that shows only on the mesh: a surface that is not there, a tangled cell, an impact point
    /// off the body. PETSc's.
    pub fn solid(scene: &Scene, mesh: &Mesh) -> Result<Self> {
        check_surfaces(scene, mesh)?;
        let localization = match scene.contact {
            Contact::Patch { radius } => Localization::patch(mesh, scene, radius)?,
            Contact::Point => Localization::point(mesh, &scene.impactor)?,
        };
        let graph = node_graph(&mesh.comm, mesh.owned_nodes, &mesh.cells, 0..mesh.cells.len())?;
        let of_nodes = mass_by_node(scene, mesh, graph)?;
        let of_components = Components::new(&of_nodes)?;
        let elastic = over_cells(scene, mesh, of_components.zeros()?)?;
        let mass = of_components.like(&elastic)?;
        drop(of_components);
        let stiffness = |kind: &SupportKind| match kind {
            SupportKind::Elastic { stiffness } => *stiffness,
            _ => [0.0; 3],
        };
        let products = Some([of_nodes.by_component(3)?, elastic.upper_triangle(3)?]);
        let springs: Vec<(&str, Vec3, Vec3)> =
            scene.supports.iter().map(|s| (s.surface.as_str(), stiffness(&s.kind), s.displacement)).collect();
        let dampers: Vec<(&str, Vec3, Vec3)> =
            scene.supports.iter().map(|s| (s.surface.as_str(), s.damping, [0.0; 3])).collect();
        let explicit = matches!(scene.time.scheme, Scheme::CentralDifference { .. });
        let clamps = Clamps::new(mesh, &scene.supports)?;
        let (support_load, support_offset) = support_load(mesh, &springs)?;
        let nodes = mesh.positions();
        Ok(Self {
            mass,
            elastic,
            products,
            support: over_facets(mesh, &springs)?,
            damping: over_facets(mesh, &dampers)?,
            lumped: explicit.then(|| Lumped::new(scene, mesh)).transpose()?,
            pads: Pads::new(mesh, &scene.supports, &clamps)?,
            load: load(scene, mesh)?,
            support_load,
            support_offset,
            translation: translation(mesh, scene.impactor.direction)?,
            localization,
            rigid_motions: Some(rigid_motions(mesh, &nodes)?),
            method: method(scene, 3 * mesh.nodes),
            nodes: Some(nodes),
            deviates: deviates(mesh)?,
            clamps,
            copies: mesh.copies as f64,
        })
    }
}

/// Unknowns from which on a factor takes more memory and time than iterations do.
const LARGE: usize = 300_000;

/// Where iterations stop, as a part of the tolerance, in steps of a hundredth of a contact or larger.
const OF_TOLERANCE: f64 = 1e-4;

/// How a body of so many unknowns is solved.
fn method(scene: &Scene, unknowns: usize) -> Method {
    if unknowns < LARGE { Method::Cholesky } else { by_iterations(scene) }
}

/// How a body too large for a factor is solved. What iterations leave is a part of what a step moves, and adds up over a contact's steps:
/// the more there are, the less may be left.
pub fn by_iterations(scene: &Scene) -> Method {
    let impactor = &scene.impactor;
    let contact = hertz::contact_time(impactor.stiffness, impactor.mass, impactor.speed);
    let part = scene.time.step.map_or(1.0, |step| (100.0 * step / contact).min(1.0));
    Method::Multigrid { tolerance: OF_TOLERANCE * part * scene.tolerance }
}

/// Translations and rotations: what K maps to nothing, or to little where supports are soft or clamped parts few. Collective.
fn rigid_motions(mesh: &Mesh, nodes: &[Vec3]) -> Result<NullSpace> {
    let mut coordinates = Vector::new(&mesh.comm, 3 * nodes.len())?;
    coordinates.write()?.copy_from_slice(nodes.as_flattened());
    let motions = NullSpace::rigid_body(&mut coordinates)?;
    coordinates.destroy()?;
    Ok(motions)
}

/// By where the nodes lie, not by their numbers.
fn deviates(mesh: &Mesh) -> Result<Vector> {
    let mut deviates = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
    for cell in 0..mesh.cells.len() {
        for (&node, position) in mesh.cells.nodes(cell).iter().zip(mesh.cells.node_positions(cell)) {
            let key = place(position, mesh.diameter);
            let values = [0, 1, 2].map(|component| normal(key.wrapping_add(component)));
            deviates.set_values(&[3 * node, 3 * node + 1, 3 * node + 2], &values, Insert::Replace)?;
        }
    }
    deviates.assemble()?;
    Ok(deviates)
}

/// Every surface that the scene names must be one of the mesh.
fn check_surfaces(scene: &Scene, mesh: &Mesh) -> Result<()> {
    let supports = scene.supports.iter().enumerate().map(|(i, s)| (format!("support.{i}.surface"), &s.surface));
    let tractions =
        scene.load.traction.iter().enumerate().map(|(i, t)| (format!("load.traction.{i}.surface"), &t.surface));
    for (key, name) in supports.chain(tractions) {
        if !mesh.surfaces.contains_key(name) {
            let known: Vec<String> = mesh.surfaces.keys().map(|name| format!("{name:?}")).collect();
            let help = match known.as_slice() {
                [] => "the mesh names no surface: give it physical surfaces in Gmsh".to_owned(),
                known => format!("the mesh names {}", known.join(", ")),
            };
            return Err(Fault::new(key, format!("the mesh has no surface {name:?}"), help).into());
        }
    }
    Ok(())
}

/// K summed over all cells into a matrix of zeros.
fn over_cells(scene: &Scene, mesh: &Mesh, mut matrix: Matrix) -> Result<Matrix> {
    let mut forms = forms(scene, mesh);
    let size = (3 * mesh.cells.nodes_each()).pow(2);
    let kernel = |_: usize, x: &[Vec3], block: &mut [f64]| forms.stiffness(x, block);
    everywhere(mesh, assemble(&mesh.cells, 0..mesh.cells.len(), size, kernel, into_matrix(&mut matrix)))?;
    matrix.assemble()?;
    Ok(matrix)
}

/// M, alike in all three components, summed with one entry for a pair of nodes into a matrix of zeros.
fn mass_by_node(scene: &Scene, mesh: &Mesh, mut matrix: Matrix) -> Result<Matrix> {
    let cells = &mesh.cells;
    let mut forms = forms(scene, mesh);
    let mut numbers = vec![0; cells.nodes_each()];
    let sink = |indices: &[Int], block: &[f64]| {
        numbers.iter_mut().zip(indices.iter().step_by(3)).for_each(|(node, unknown)| *node = unknown / 3);
        matrix.set_values(&numbers, &numbers, block, Insert::Add)
    };
    let size = cells.nodes_each().pow(2);
    everywhere(mesh, assemble(cells, 0..cells.len(), size, |_, x, block| forms.mass_by_node(x, block), sink))?;
    matrix.assemble()?;
    Ok(matrix)
}

/// The kernels of the scene's material on the mesh's cells.
pub(super) fn forms(scene: &Scene, mesh: &Mesh) -> SolidForms {
    let body = &scene.body;
    let material = Material { young: body.young, poisson: body.poisson, density: body.density };
    SolidForms::new(mesh.cells.shape, mesh.cells.order, material)
}

/// ∫ k u·v dS summed over surfaces, each with its k; `None` where every k is zero.
fn over_facets(mesh: &Mesh, terms: &[(&str, Vec3, Vec3)]) -> Result<Option<Matrix>> {
    let terms: Vec<_> = terms.iter().filter(|(_, k, _)| k.iter().any(|k| *k != 0.0)).collect();
    if terms.is_empty() {
        return Ok(None);
    }
    let facets = &mesh.facets;
    let chosen = || terms.iter().flat_map(|(name, _, _)| mesh.surfaces[*name].iter().copied());
    let mut matrix = zeros(&mesh.comm, mesh.owned_nodes, facets, chosen())?;
    let mut forms = SurfaceForms::new(facets.shape, facets.order);
    let size = (3 * facets.nodes_each()).pow(2);
    for (name, k, _) in &terms {
        let kernel = |_: usize, x: &[Vec3], block: &mut [f64]| {
            forms.spring(x, *k, block);
            Ok(())
        };
        everywhere(
            mesh,
            assemble(facets, mesh.surfaces[*name].iter().copied(), size, kernel, into_matrix(&mut matrix)),
        )?;
    }
    matrix.assemble()?;
    Ok(Some(matrix))
}

/// d at every node.
fn translation(mesh: &Mesh, direction: Vec3) -> Result<Vector> {
    let mut vector = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
    for node in vector.write()?.chunks_exact_mut(3) {
        node.copy_from_slice(&direction);
    }
    Ok(vector)
}

/// ∫ k ū·v dS and ½ ∫ k ū·ū dS of elastic supports.
fn support_load(mesh: &Mesh, springs: &[(&str, Vec3, Vec3)]) -> Result<(Vector, f64)> {
    let mut load = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
    let mut twice_offset = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
    for (name, k, u) in springs {
        let traction = [0, 1, 2].map(|i| k[i] * u[i]);
        if traction == [0.0; 3] {
            continue;
        }
        let density = (0..3).map(|i| traction[i] * u[i]).sum::<f64>();
        add_traction(mesh, name, traction, &mut load)?;
        add_traction(mesh, name, [density, 0.0, 0.0], &mut twice_offset)?;
    }
    load.assemble()?;
    twice_offset.assemble()?;
    // The shape functions sum to one, so that the entries sum to the integral.
    let mut ones = load.duplicate()?;
    ones.fill(0.5)?;
    let offset = twice_offset.dot(&ones)?;
    Ok((load, offset))
}

/// Body force (1) and tractions (3).
fn load(scene: &Scene, mesh: &Mesh) -> Result<Vector> {
    let mut load = Vector::new(&mesh.comm, 3 * mesh.owned_nodes)?;
    let force = scene.load.body_force;
    if force != [0.0; 3] {
        let forms = forms(scene, mesh);
        let size = 3 * mesh.cells.nodes_each();
        let kernel = |_: usize, x: &[Vec3], block: &mut [f64]| forms.load(x, |_| force, block);
        everywhere(mesh, assemble(&mesh.cells, 0..mesh.cells.len(), size, kernel, into_vector(&mut load)))?;
    }
    for traction in &scene.load.traction {
        add_traction(mesh, &traction.surface, traction.value, &mut load)?;
    }
    load.assemble()?;
    Ok(load)
}

/// Adds ∫ f·v dS over a surface; the vector must be assembled afterwards.
fn add_traction(mesh: &Mesh, surface: &str, f: Vec3, load: &mut Vector) -> Result<()> {
    let facets = &mesh.facets;
    let forms = SurfaceForms::new(facets.shape, facets.order);
    let kernel = |_: usize, x: &[Vec3], block: &mut [f64]| {
        forms.traction(x, |_| f, block);
        Ok(())
    };
    let chosen = mesh.surfaces[surface].iter().copied();
    everywhere(mesh, assemble(facets, chosen, 3 * facets.nodes_each(), kernel, into_vector(load)))
}

/// A tangled cell on one rank made a fault on all of them. Collective.
pub(super) fn everywhere(mesh: &Mesh, done: std::result::Result<(), Stopped>) -> Result<()> {
    let done = match done {
        Err(Stopped::Sink(error)) => return Err(Error::Petsc(error)),
        Err(Stopped::Tangled([x, y, z])) => {
            Err(format!("the mesh has a tangled cell at [{x:.6}, {y:.6}, {z:.6}]: its volume is not positive"))
        }
        Ok(()) => Ok(()),
    };
    agree(&mesh.comm, done).map_err(|message| Fault::new("body.mesh", message, "mend or remake the mesh").into())
}
