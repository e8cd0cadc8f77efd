//! One theory's body of a scene.

use petsc_wrap::Comm;

use crate::body::{Assembled, Body, LocalBody, ModalBody, Modes, System};
use crate::contact::zener;
use crate::error::Result;
use crate::impact::settle;
use crate::mesh::{Measures, Mesh};
use crate::scene::{Contact, Fault, Geometry, Initial, Model, Scene};
use crate::space::evaluate::{Evaluator, PointEvaluator};
use crate::space::plate::{self, Plate, PlateTheory};
use crate::space::spline::{self, SplineSolid};

use super::long_waves::LongWaves;
use super::reduce::MOST;
use super::watch::{Stage, Watch};

/// Size of the largest cells of a plate whose basis knows its long waves alone, over that for all waves: such cells carry these. On a pane of
/// 8 mm the force was off by 0.2% with 1.3, as much as its difference from cells 0.77 of these, and by 0.4% with 1.45.
const OF_LONG_WAVES: f64 = 1.3;

/// What the scene calls the theory.
pub fn name(model: Model) -> &'static str {
    match model {
        Model::Auto => "auto",
        Model::HalfSpace => "half-space",
        Model::InfinitePlate => "infinite-plate",
        Model::Kirchhoff => "kirchhoff",
        Model::Mindlin => "mindlin",
        Model::Layerwise => "layerwise",
        Model::Solid => "solid",
    }
}

/// A body as a theory has it.
pub enum Built {
    /// Modes from a formula.
    Given(ModalBody),
    /// Operators.
    Operators(Operators),
}

/// A body's operators, with what they were made of.
pub struct Operators {
    /// The body.
    pub body: Assembled,
    /// What its unknowns are of.
    pub words: String,
    /// Cells along the axes, where these are of splines and the program chooses them; one across a plate.
    pub cells: Option<[usize; 3]>,
    /// Of Mindlin's plate, the longest cell at the hit over the radius of the disc that is pressed ([`Plate::cell_over_disc`]).
    pub cell_over_disc: Option<f64>,
    /// What reads the body at its points, where the scene wants that; of a distributed mesh rank 0 has it.
    pub evaluator: Option<Evaluator>,
    /// Measures of a mesh from a file.
    pub measures: Option<Measures>,
}

/// Why a theory does not stand for a scene: a clause.
///
/// # Errors
/// That clause.
pub fn admits(scene: &Scene, theory: Model) -> std::result::Result<(), String> {
    if scene.contact == Contact::Point
        && matches!(theory, Model::HalfSpace | Model::InfinitePlate | Model::Mindlin | Model::Layerwise)
    {
        return Err("a force at a point is for kirchhoff and solid: the others have the contact's own field".into());
    }
    if scene.output.has_points() && matches!(theory, Model::HalfSpace | Model::InfinitePlate) {
        return Err("probes and fields are not available for closed-form models".into());
    }
    if matches!(theory, Model::InfinitePlate | Model::Kirchhoff | Model::Mindlin)
        && scene.body.composition.uniform().is_none()
    {
        let reason = match scene.body.composition.is_of_one_material() {
            true => "its material relaxes, and this theory is elastic",
            false => "its layers are of different materials, and this theory has one",
        };
        return Err(reason.into());
    }
    match theory {
        Model::HalfSpace => Ok(()),
        Model::InfinitePlate => thickness(scene).map(|_| ()),
        Model::Kirchhoff => plate::admits(scene, PlateTheory::Kirchhoff),
        Model::Mindlin => plate::admits(scene, PlateTheory::Mindlin),
        Model::Layerwise => plate::admits(scene, layerwise(scene)),
        Model::Auto | Model::Solid => Ok(()),
    }
}

/// Builds a theory's body; cells of splines are larger by `size` than by the rule for the scene's tolerance. Collective.
///
/// # Errors
/// A fault of `body.model` where the theory does not stand for the scene; those of meshes; PETSc's.
pub fn build(comm: &Comm, scene: &Scene, theory: Model, size: f64, watch: &dyn Watch) -> Result<Built> {
    watch.at(Stage::Assembly(theory))?;
    admits(scene, theory).map_err(|reason| {
        Fault::new(
            "body.model",
            format!("\"{}\" cannot model this scene: {reason}", name(theory)),
            "\"solid\", or \"auto\"",
        )
    })?;
    let built = match theory {
        Model::HalfSpace => Built::Given(ModalBody::given(Modes::none())),
        Model::InfinitePlate => {
            let body = &scene.body;
            let thickness = thickness(scene).unwrap_or_default();
            let impedance = zener::impedance(&body.struck(), thickness);
            Built::Given(ModalBody::given(Modes::dashpot(impedance)))
        }
        Model::Kirchhoff => of_plate(comm, scene, PlateTheory::Kirchhoff, size)?,
        Model::Mindlin => of_plate(comm, scene, PlateTheory::Mindlin, size)?,
        Model::Layerwise => of_plate(comm, scene, layerwise(scene), size)?,
        Model::Auto | Model::Solid if is_of_splines(scene) => {
            let mut settings = spline::Settings::new(scene.tolerance);
            settings.cell_size_factor *= size;
            let SplineSolid { system, cells: [x, y, z], points } = SplineSolid::new(scene, &settings)?;
            let words = format!("{x} × {y} × {z} cells of splines");
            Built::Operators(of_grid(comm, scene, (system, points), [x, y, z], words)?)
        }
        Model::Auto | Model::Solid => {
            let mesh = Mesh::new(comm, &scene.body)?;
            let body = Body::solid(scene, &mesh)?;
            let words = format!("{} cells of order {}", mesh.total_cells, scene.body.order);
            let measures = matches!(scene.body.geometry, Geometry::Gmsh(_)).then(|| mesh.measures());
            let patch = body.localization.patch;
            let whole = if scene.output.is_read() { mesh.gather() } else { None };
            drop(mesh);
            comm.collect_garbage()?;
            let evaluator = whole.map(|whole| Evaluator::of_mesh(scene, whole, patch.as_ref()));
            Built::Operators(Operators {
                body: Assembled::InPetsc(Box::new(body)),
                words,
                cells: None,
                cell_over_disc: None,
                evaluator,
                measures,
            })
        }
    };
    match built {
        Built::Operators(operators) => Ok(Built::Operators(loaded(scene, operators)?)),
        given => Ok(given),
    }
}

/// A layerwise plate whose layers neither shear nor have a local field, by which the theory is judged. Collective.
///
/// # Errors
/// As [`build`].
pub(super) fn build_thin(comm: &Comm, scene: &Scene) -> Result<Operators> {
    let settings = plate::Settings { is_thin: true, ..plate::Settings::new(scene.tolerance, PlateTheory::Layerwise) };
    let Plate { system, cells: [x, y], points, .. } = Plate::new(scene, PlateTheory::Layerwise, &settings)?;
    loaded(scene, of_grid(comm, scene, (system, points), [x, y, 1], String::new())?)
}

/// Bases are made of what the loads have done, and of pads as springs. (A body that keeps its pads is put into equilibrium before it
/// moves.)
fn loaded(scene: &Scene, mut operators: Operators) -> Result<Operators> {
    let Assembled::InPetsc(body) = &mut operators.body else { return Ok(operators) };
    if body.pads.is_none() || scene.is_reduced() {
        settle(scene, body)?;
        body.classes.iter_mut().try_for_each(|class| settle(scene, class))?;
        body.take_pads_as_springs()?;
    }
    Ok(operators)
}

/// The layerwise theory of a scene's plate: of one layer that is Mindlin's.
fn layerwise(scene: &Scene) -> PlateTheory {
    if scene.body.composition.uniform().is_some() { PlateTheory::Mindlin } else { PlateTheory::Layerwise }
}

/// Thickness of a box under the impact point, m, where the hit is along its normal.
fn thickness(scene: &Scene) -> std::result::Result<f64, String> {
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else {
        return Err("the body is a mesh file, not a box".into());
    };
    let impactor = &scene.impactor;
    if (impactor.direction[axis].abs() - 1.0).abs() > 1e-9 {
        return Err("the hit is oblique".into());
    }
    Ok(size[axis])
}

/// Whether a solid is a box of splines, with a tenth of the unknowns: where it is to be reduced, and the scene does not ask for cells.
fn is_of_splines(scene: &Scene) -> bool {
    scene.is_reduced()
        && matches!(scene.body.geometry, Geometry::Box { is_given: false, .. })
        && spline::admits(scene).is_ok()
}

fn of_plate(comm: &Comm, scene: &Scene, theory: PlateTheory, size: f64) -> Result<Built> {
    let plate = Plate::new(scene, theory, &plate_settings(scene, theory, size)?)?;
    let cell_over_disc = plate.cell_over_disc();
    let Plate { system, cells: [x, y], points, .. } = plate;
    let words = format!("{x} × {y} cells of splines");
    let operators = of_grid(comm, scene, (system, points), [x, y, 1], words)?;
    Ok(Built::Operators(Operators { cell_over_disc, ..operators }))
}

fn plate_settings(scene: &Scene, theory: PlateTheory, size: f64) -> Result<plate::Settings> {
    let mut settings = plate::Settings::new(scene.tolerance, theory);
    settings.cell_size_factor *= size;
    if let Contact::Patch { disc: Some(disc), .. } = scene.contact {
        settings.disc_radius = Some(disc);
    }
    if theory == PlateTheory::Mindlin {
        let plate = plate::infinite_plate(scene, theory)?;
        let most = MOST * plate::classes_of_motions(scene, theory)?;
        if LongWaves::of(scene, &plate, most).is_some() {
            settings.largest_cell_factor = OF_LONG_WAVES;
        }
    }
    Ok(settings)
}

/// The cells that [`build`] would give a plate, as [`Operators::cells`]; `None` of other theories, and where it would refuse.
pub(super) fn cells_of_plate(scene: &Scene, theory: Model, size: f64) -> Option<[usize; 3]> {
    let theory = match theory {
        Model::Kirchhoff => PlateTheory::Kirchhoff,
        Model::Mindlin => PlateTheory::Mindlin,
        Model::Layerwise => layerwise(scene),
        Model::Auto | Model::Solid | Model::HalfSpace | Model::InfinitePlate => return None,
    };
    let [x, y] = Plate::cells(scene, theory, &plate_settings(scene, theory, size).ok()?).ok()?;
    Some([x, y, 1])
}

/// Every rank has all of it.
fn of_grid(
    comm: &Comm,
    scene: &Scene,
    (mut system, points): (System, impl PointEvaluator + 'static),
    cells: [usize; 3],
    words: String,
) -> Result<Operators> {
    let evaluator = scene.output.is_read().then(|| Evaluator::of_grid(scene, points));
    let read = evaluator.as_ref().filter(|_| scene.output.stress).and_then(|evaluator| evaluator.hit_stress(scene));
    if let Some(read) = read {
        (system.hit_stress, system.hit_local) = read;
    }
    // What is not linear, and finding an equilibrium, is PETSc's.
    let is_linear = system.pads.is_empty() && scene.time.initial == Initial::Rest;
    let body = if scene.is_reduced() && is_linear {
        Assembled::Local(Box::new(LocalBody::new(system)))
    } else {
        Assembled::InPetsc(Box::new(Body::of(&comm.session().alone(), &system)?))
    };
    Ok(Operators { body, words, cells: Some(cells), cell_over_disc: None, evaluator, measures: None })
}
