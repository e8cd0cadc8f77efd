//! Builds the body of a scene in one theory.

use petsc_wrap::Comm;

use crate::body::{Assembled, Body, LocalBody, ModalBody, Modes, System};
use crate::contact::zener;
use crate::error::Result;
use crate::impact::settle;
use crate::mesh::{Measures, Mesh};
use crate::scene::{Contact, Fault, Geometry, Initial, Load, Model, Scene};
use crate::space::evaluate::{Evaluator, PointEvaluator};
use crate::space::plate::{self, Plate, PlateTheory};
use crate::space::spline::{self, SplineSolid};

use super::context::ModelContext;
use super::long_waves::LongWaves;
use super::reduce::MAX_VECTORS_PER_CLASS;
use super::watch::Stage;

/// Factor on the size of the largest cells of a plate if its basis resolves long waves only: such cells still carry
/// these. On a pane of 8 mm the error of the force was 0.2% with a factor of 1.3, equal to its difference from cells
/// 0.77 times as large, and 0.4% with 1.45.
const LONG_WAVE_CELL_FACTOR: f64 = 1.3;

/// Time in which a solid of splines is assembled and factorised, per unknown, s. Measured with 7,000 to 29,000 unknowns
/// on one core: 1.7e-4 to 2.7e-4.
const SPLINE_SECONDS: f64 = 2.2e-4;

/// Time in which a box of finite elements is assembled, per unknown, s. Measured with 750,000 unknowns on one core:
/// 2.2e-5 to 2.7e-5.
const GRID_SECONDS: f64 = 2e-5;

/// Name of the theory in a scene.
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

/// A body in a theory.
pub enum Built {
    /// Modes from a closed form.
    Given(ModalBody),
    /// Assembled operators.
    Operators(Operators),
}

/// A body's operators, with their discretisation.
pub struct Operators {
    /// The assembled body.
    pub body: Assembled,
    /// Description of its unknowns, for results.
    pub discretisation: String,
    /// Numbers of cells along the axes, for splines whose cells the program chooses; 1 across a plate.
    pub cells: Option<[usize; 3]>,
    /// Evaluates displacements and stresses at points, if the scene asks for them; for a distributed mesh only on rank
    /// 0.
    pub evaluator: Option<Evaluator>,
    /// Measures of the mesh, if it is from a file.
    pub measures: Option<Measures>,
}

/// Checks whether a theory admits a scene.
///
/// # Errors
/// The reason why it does not, as a clause.
pub fn admits(scene: &Scene, theory: Model) -> std::result::Result<(), String> {
    if scene.contact == Contact::Point
        && matches!(theory, Model::HalfSpace | Model::InfinitePlate | Model::Mindlin | Model::Layerwise)
    {
        return Err("a force at a point is for kirchhoff and solid: the others have the contact's own field".into());
    }
    if scene.contact.area().is_some() && matches!(theory, Model::HalfSpace | Model::InfinitePlate) {
        return Err("contact.area is given, and these formulas have no area on which a contact presses".into());
    }
    if scene.output.has_points() && matches!(theory, Model::HalfSpace | Model::InfinitePlate) {
        return Err("probes and fields are not available for closed-form models".into());
    }
    if matches!(theory, Model::InfinitePlate | Model::Kirchhoff | Model::Mindlin)
        && scene.body.composition.uniform().is_none()
    {
        let reason = match scene.body.composition.is_of_one_material() {
            true => "its material is viscoelastic, and this theory is for elastic materials",
            false => "its layers are of different materials, and this theory has one",
        };
        return Err(reason.into());
    }
    match theory {
        Model::HalfSpace => Ok(()),
        Model::InfinitePlate => thickness(scene).map(|_| ()),
        Model::Kirchhoff => plate::admits(scene, PlateTheory::Kirchhoff),
        Model::Mindlin | Model::Layerwise => plate::admits(scene, PlateTheory::Layerwise),
        Model::Auto | Model::Solid => Ok(()),
    }
}

/// Builds the body of a scene in a theory. The cells of splines are larger by the factor `size` than the rule for the
/// scene's tolerance. Collective.
///
/// # Errors
/// A fault of `body.model` if the theory does not admit the scene; the errors of meshes; or if a PETSc call fails.
pub fn build(
    &ModelContext { comm, watch, .. }: &ModelContext,
    scene: &Scene,
    theory: Model,
    size: f64,
) -> Result<Built> {
    let spline_settings = spline::Settings::of(scene, size);
    let is_of_splines = matches!(theory, Model::Auto | Model::Solid) && is_of_splines(scene);
    let seconds = match theory {
        _ if is_of_splines => SPLINE_SECONDS * spline::unknowns(scene, &spline_settings).unwrap_or_default(),
        Model::Auto | Model::Solid => GRID_SECONDS * scene.body.grid_unknowns().unwrap_or_default(),
        _ => 0.0,
    };
    watch.at(Stage::Assembly { theory, seconds })?;
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
        Model::Mindlin | Model::Layerwise => of_plate(comm, scene, PlateTheory::Layerwise, size)?,
        Model::Auto | Model::Solid if is_of_splines => {
            let SplineSolid { system, cells: [x, y, z], points } = SplineSolid::new(scene, &spline_settings)?;
            let discretisation = format!("{x} × {y} × {z} cells of splines");
            Built::Operators(of_grid(comm, scene, (system, points), [x, y, z], discretisation)?)
        }
        Model::Auto | Model::Solid => {
            let mesh = Mesh::new(comm, &scene.body)?;
            let body = Body::solid(scene, &mesh)?;
            let discretisation = format!("{} cells of order {}", mesh.total_cells, scene.body.order);
            let measures = matches!(scene.body.geometry, Geometry::Gmsh(_)).then(|| mesh.measures(&scene.impactor));
            let patch = body.terms.contact.footprint.patch();
            let whole = if scene.output.is_read() { mesh.gather() } else { None };
            drop(mesh);
            comm.collect_garbage()?;
            let evaluator = whole.map(|whole| Evaluator::of_mesh(scene, whole, patch.as_ref()));
            Built::Operators(Operators {
                body: Assembled::InPetsc(Box::new(body)),
                discretisation,
                cells: None,
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

/// A plate that has neither shear in its stiff layers nor a local field, for estimating the error of the theory:
/// Kirchhoff's for one layer. Collective.
///
/// # Errors
/// Same as [`build`].
pub(super) fn build_thin(comm: &Comm, scene: &Scene) -> Result<Operators> {
    let is_one = scene.body.composition.uniform().is_some();
    let theory = if is_one { PlateTheory::Kirchhoff } else { PlateTheory::Layerwise };
    let settings = plate::Settings { is_thin: true, ..plate_settings(scene, theory, 1.0)? };
    let Plate { system, cells: [x, y], points, .. } = Plate::new(scene, theory, &settings)?;
    loaded(scene, of_grid(comm, scene, (system, points), [x, y, 1], String::new())?)
}

/// Brings a body into the equilibrium from which the scene starts, and replaces foundation pads by springs for the
/// basis. A body that keeps its pads is brought into equilibrium when its run begins.
fn loaded(scene: &Scene, mut operators: Operators) -> Result<Operators> {
    let Assembled::InPetsc(body) = &mut operators.body else { return Ok(operators) };
    if body.pads.is_none() || scene.is_reduced() {
        settle(scene, body)?;
        body.classes.iter_mut().try_for_each(|class| settle(scene, class))?;
        body.take_pads_as_springs()?;
    }
    Ok(operators)
}

/// Thickness of a box under the impact point, m, if the impact is normal to the face.
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

/// Whether a solid is a box of splines, which needs a tenth of the unknowns: if it is to be reduced and the scene does
/// not specify cells.
fn is_of_splines(scene: &Scene) -> bool {
    scene.is_reduced()
        && matches!(scene.body.geometry, Geometry::Box { is_given: false, .. })
        // With a factor on cells, another discretisation would not serve for a study of convergence.
        && spline::admits(&Scene { cell_factor: 1.0, ..scene.clone() }).is_ok()
}

fn of_plate(comm: &Comm, scene: &Scene, theory: PlateTheory, size: f64) -> Result<Built> {
    let Plate { system, cells: [x, y], points } = Plate::new(scene, theory, &plate_settings(scene, theory, size)?)?;
    let discretisation = format!("{x} × {y} cells of splines");
    Ok(Built::Operators(of_grid(comm, scene, (system, points), [x, y, 1], discretisation)?))
}

fn plate_settings(scene: &Scene, theory: PlateTheory, size: f64) -> Result<plate::Settings> {
    let mut settings = plate::Settings::new(scene.tolerance, theory);
    settings.cell_size_factor *= size * scene.cell_factor;
    settings.part_cell_factor *= size * scene.cell_factor;
    if let Contact::Patch { disc: Some(disc), .. } = scene.contact {
        settings.disc_radius = Some(disc);
    }
    if theory == PlateTheory::Layerwise {
        // A basis with all waves needs cells for all of them.
        if scene.body.composition.uniform().is_none() && !may_leave_short_waves(scene) {
            return Ok(settings);
        }
        let plate = plate::infinite_plate(scene, theory, &settings)?;
        let most = MAX_VECTORS_PER_CLASS * plate::classes_of_motions(scene, theory)?;
        let long_waves = LongWaves::of(scene, &plate, most);
        tracing::debug!(vectors = long_waves.map(|waves| waves.vectors), "long waves");
        if long_waves.is_some() {
            settings.largest_cell_factor = LONG_WAVE_CELL_FACTOR;
            settings.separates_short_waves = true;
        }
    }
    Ok(settings)
}

/// Whether a laminate's basis may leave out short waves: not if loads excite waves too.
fn may_leave_short_waves(scene: &Scene) -> bool {
    let is_loaded =
        scene.load != Load::default() || scene.supports.iter().any(|support| support.displacement != [0.0; 3]);
    !(is_loaded && scene.time.initial == Initial::Rest)
}

/// The numbers of cells that [`build`] would give a body on a grid, as [`Operators::cells`]; `None` for other theories
/// and meshes, and if it would fail.
pub(super) fn cells_of_grid(scene: &Scene, theory: Model, size: f64) -> Option<[usize; 3]> {
    let theory = match theory {
        Model::Kirchhoff => PlateTheory::Kirchhoff,
        Model::Mindlin | Model::Layerwise => PlateTheory::Layerwise,
        Model::Solid if is_of_splines(scene) => return spline::cells(scene, &spline::Settings::of(scene, size)),
        Model::Auto | Model::Solid | Model::HalfSpace | Model::InfinitePlate => return None,
    };
    let [x, y] = Plate::cells(scene, theory, &plate_settings(scene, theory, size).ok()?).ok()?;
    Some([x, y, 1])
}

/// Makes the operators of a spline grid. Every rank has the whole body.
fn of_grid(
    comm: &Comm,
    scene: &Scene,
    (mut system, points): (System, impl PointEvaluator + 'static),
    cells: [usize; 3],
    discretisation: String,
) -> Result<Operators> {
    let evaluator = evaluator_of_grid(scene, points, &mut system);
    // Nonlinear bodies, and the search for an equilibrium, use PETSc.
    let is_linear = system.pads.is_empty() && scene.time.initial == Initial::Rest;
    let body = if scene.is_reduced() && is_linear {
        Assembled::Local(Box::new(LocalBody::new(system)))
    } else {
        Assembled::InPetsc(Box::new(Body::of(&comm.session().alone(), &system)?))
    };
    Ok(Operators { body, discretisation, cells: Some(cells), evaluator, measures: None })
}

/// Evaluator of a spline grid, if the scene asks for it. The stresses opposite the impact point are added to the system.
fn evaluator_of_grid(scene: &Scene, points: impl PointEvaluator + 'static, system: &mut System) -> Option<Evaluator> {
    let evaluator = scene.output.is_read().then(|| Evaluator::of_grid(scene, points));
    let read = evaluator.as_ref().filter(|_| scene.output.stress).and_then(|evaluator| evaluator.hit_stress(scene));
    if let (Some((mut forms, local)), Some(evaluator)) = (read, &evaluator) {
        forms.extend(evaluator.watched_stresses(scene));
        (system.terms.readings.forms, system.terms.readings.local_per_newton) = (forms, local);
    }
    evaluator
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Layers of one viscoelastic material are not called different, and an elastic theory does not admit them.
    #[test]
    fn an_elastic_theory_does_not_admit_a_viscoelastic_material() {
        let text = "[body]\nsize = [0.5, 0.5]\n[[body.layer]]\nthickness = 0.01\nmaterial = \"soft\"\n\
             [material.soft]\ndensity = 1100.0\nbulk = 2e9\nshear = 1e6\nprony = [{ modulus = 4e7, time = 1e-4 }]\n\
             [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e8\nspeed = 1.0\n[time]\nend = 1e-3\n";
        let (scene, _) = Scene::parse("scene", text, &[]).unwrap();
        for theory in [Model::InfinitePlate, Model::Kirchhoff, Model::Mindlin] {
            let reason = admits(&scene, theory).unwrap_err();
            assert_eq!(reason, "its material is viscoelastic, and this theory is for elastic materials");
        }
    }
}
