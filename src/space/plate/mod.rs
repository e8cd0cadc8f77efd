//! A box impacted on a face, modelled as a plate: small linear systems of the layerwise theory (Reissner–Mindlin theory in
//! each layer), or of Kirchhoff's theory for a thin plate of one layer.

mod boundary;
mod cells;
mod clamps;
mod edges;
mod face;
mod geometry;
mod layers;
mod location;
mod points;
mod square;
mod theory;
mod waves;

pub use cells::{LocalVibrations, ShearTravelTimes, crossing, phase};
pub(super) use cells::{contact_time, wavelength};
pub use layers::{Disc, FrequencyRatios, LEAST_LAYER, Layers, frequency_ratios};
pub use points::Points;
pub use theory::PlateTheory;
pub use waves::{classes_of_motions, infinite_plate};

use clamps::held;
use geometry::PlateGeometry;

use nalgebra_sparse::CsrMatrix;

use super::grid::{GridSpace, count_cells};
use super::parity::repeated;
use super::parts;
use super::{SurfaceTerms, rung_below};
use crate::body::{BodyTerms, ContactPort, Relaxation, StressReadings, System};
use crate::contact::Footprint;
use crate::description::Description;
use crate::error::Result;
use crate::form::plate::{DEFLECTION, Section};
use crate::form::tensor::{Integrals, Square};
use crate::scene::{Fault, Scene};

/// Options of a plate model that are not part of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Factor on the size of all cells; 1 is the default size.
    pub cell_size_factor: f64,
    /// Factor on the size of the cells at parts of faces with supports or loads.
    pub part_cell_factor: f64,
    /// Additional factor on the size of the largest cells alone.
    pub largest_cell_factor: f64,
    /// Whether short waves of several layers may be treated separately, for which [`InfinitePlate`] is computed. It is
    /// always known for one layer.
    ///
    /// [`InfinitePlate`]: crate::body::InfinitePlate
    pub separates_short_waves: bool,
    /// Radius of the loaded disc divided by the thickness of the impacted layer, if the disc fits within the plate.
    pub disc: f64,
    /// Radius of the disc in m, as prescribed by a scene. It takes precedence over `disc`.
    pub disc_radius: Option<f64>,
    /// Whether the stiff layers of the layerwise theory are rigid in shear and the local field under the impactor is
    /// neglected. These are the assumptions of Kirchhoff's theory for a single layer.
    pub is_thin: bool,
}

/// Factor on the size of all cells at the default tolerance.
const OF_DEFAULT_TOLERANCE: f64 = 1.2;

impl Settings {
    /// Settings with a cell size for an error of less than half of a tolerance, as measured on plates.
    pub fn new(tolerance: f64, theory: PlateTheory) -> Self {
        let parts = tolerance / 1e-2;
        let factor = rung_below(if parts > 1.0 { parts.cbrt() } else { parts.powf(0.25) });
        // Kirchhoff's theory has no shear: its deflection w is smoother than the load, so larger cells suffice.
        let cell_size_factor = OF_DEFAULT_TOLERANCE * factor * if theory == PlateTheory::Kirchhoff { 1.4 } else { 1.0 };
        Self {
            cell_size_factor: cell_size_factor.clamp(0.3, 2.4),
            part_cell_factor: factor.min(1.0),
            ..Self::default()
        }
    }

    /// Radius of the disc divided by a thickness (m), if the disc fits within the plate.
    pub(super) fn disc_over(&self, thickness: f64) -> f64 {
        self.disc_radius.map_or(self.disc, |radius| radius / thickness)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            cell_size_factor: 1.0,
            part_cell_factor: 1.0,
            largest_cell_factor: 1.0,
            separates_short_waves: false,
            disc: 2.0,
            disc_radius: None,
            is_thin: false,
        }
    }
}

/// Smallest radius of the loaded disc divided by the thickness of the impacted layer.
const LEAST_DISC: f64 = 0.5;

/// A plate's linear system and the data from which it was made.
///
/// The unknowns are spline coefficients: first of the deflection w along the impactor's direction (m), then of the
/// rotations θ along the two axes of the plane, ascending (rad). With several layers, the pairs of rotations follow one
/// another. In Kirchhoff's theory the coefficients of w include its slopes at the ends. The compliance of the system is
/// −c times the symmetry multiplicity, with the local compliance c of the layers.
#[derive(Debug, Clone)]
pub struct Plate {
    /// System of M ü + C u̇ + K u = a F + f.
    pub system: System,
    /// Number of cells along both axes of the modelled part.
    pub cells: [usize; 2],
    /// Evaluator of displacements and stresses at points of the plate.
    pub points: Points,
}

/// Data of a plate from which its matrices are made.
struct Outline {
    geometry: PlateGeometry,
    layers: Layers,
    section: Section,
    /// Ends of the cells along both axes, m.
    in_plane: [Vec<f64>; 2],
}

/// Checks whether a plate theory can model a scene.
///
/// # Errors
/// The reason why it cannot: one clause.
pub fn admits(scene: &Scene, theory: PlateTheory) -> std::result::Result<(), String> {
    let geometry = geometry(scene, theory)?;
    Layers::without_local(scene, &geometry, &Description::new(scene).parts, theory, &Settings::default())?;
    Ok(())
}

/// Fault for a scene that a plate cannot model.
fn fault(reason: String) -> Fault {
    Fault::new("body.model", format!("a plate cannot model this scene: {reason}"), "model = \"solid\"")
}

fn geometry(scene: &Scene, theory: PlateTheory) -> std::result::Result<PlateGeometry, String> {
    let geometry = PlateGeometry::new(scene)?;
    boundary::check(scene, &geometry, theory)?;
    let least = LEAST_DISC * layers::struck_thickness(scene, geometry.thickness);
    if theory == PlateTheory::Layerwise && least > geometry.distance_to_edge() * (1.0 + 1e-9) {
        return Err(format!(
            "the hit is {:.3e} m from an edge, and the disc that it spreads over has a radius of at least {least:.3e} m",
            geometry.distance_to_edge()
        ));
    }
    Ok(geometry)
}

impl Outline {
    /// Outline of the plate of a scene and its description.
    fn new(scene: &Scene, description: &Description, theory: PlateTheory, settings: &Settings) -> Result<Self> {
        let geometry = geometry(scene, theory).map_err(fault)?;
        let layers = Layers::new(scene, &geometry, &description.parts, theory, settings).map_err(fault)?;
        let section = layers.section(scene);
        let radius = layers.disc.map(|disc| disc.radius);
        let wave = wavelength(&section, contact_time(&section, &scene.impactor));
        let in_plane = cells::lines(&geometry, &section, (wave, &parts::parts(scene)), radius, settings)
            .map_err(|cells| fault(format!("it would take {cells:.0} cells along an edge")))?;
        Ok(Self { geometry, layers, section, in_plane })
    }

    /// Evaluator of the plate's displacements and stresses.
    fn points(self, theory: PlateTheory) -> Points {
        let Self { geometry, layers, section, in_plane } = self;
        let tensor = theory.tensor(&in_plane, layers.profile.functions());
        let mut lines: [Vec<f64>; 3] = Default::default();
        lines[geometry.normal] = geometry.across_plate(&layers.profile.heights);
        geometry.axes.into_iter().zip(in_plane).for_each(|(axis, of_axis)| lines[axis] = of_axis);
        Points { geometry, section, lines, tensor, layers }
    }
}

impl Plate {
    /// Number of cells that a scene's plate would have along both axes of the modelled part.
    ///
    /// # Errors
    /// Same as [`Plate::new`].
    pub fn cells(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<[usize; 2]> {
        let outline = Outline::new(scene, &Description::new(scene), theory, settings)?;
        Ok(outline.in_plane.each_ref().map(|lines| count_cells(lines)))
    }

    /// Evaluator of the displacements and stresses of a scene's plate, without its matrices.
    ///
    /// # Errors
    /// Same as [`Plate::new`].
    pub fn points(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<Points> {
        Ok(Outline::new(scene, &Description::new(scene), theory, settings)?.points(theory))
    }

    /// Builds a scene's plate.
    ///
    /// # Errors
    /// A fault of `body.model` if the theory cannot model the scene, or if the plate would need too many cells.
    pub fn new(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<Self> {
        let description = Description::new(scene);
        let points = Outline::new(scene, &description, theory, settings)?.points(theory);
        let PlateGeometry { normal, thickness, .. } = points.geometry;
        let compliance = 0.5 * scene.body.composition.compliance_across(normal, thickness);
        let description = description.on_plate(normal, compliance);
        let cells = points.lines_in_plane().map(count_cells);
        let mirrors = points.geometry.mirrors();
        let terms = SurfaceTerms::new(&GridSpace { field: &points, mirrors: &mirrors }, &description)?;
        let (multiplicity, classes) = (points.geometry.multiplicity(), points.geometry.classes.len());
        // Loads and the translation along the impact direction are even.
        let even = |mut vector: Vec<f64>| {
            vector.resize(points.all_unknowns(), 0.0);
            vector
        };
        let of_classes = |matrix: CsrMatrix<f64>| repeated(matrix, classes);
        let exchange = square::exchange(&points);
        let mut integrals = Integrals::default();
        let mut of_forms = |forms: &[Square<2>]| of_classes(points.tensor.matrix_sharing(forms, &mut integrals));
        let layers = &points.layers;
        let elastic = [layers.elastic(), edges::forms(&points, &description.clamps)].concat();
        let (mass, elastic) = (of_forms(&layers.inertia()), of_forms(&elastic));
        let mut relaxations = Vec::new();
        for (chain, relaxing) in description.relaxations() {
            let forms = layers.distortion(&points.geometry, &relaxing);
            relaxations.push(Relaxation { distortion: of_forms(&forms), chain: chain.clone() });
        }
        let Layers { compliance, disc, .. } = *layers;
        let footprint = match disc {
            Some(Disc { radius, .. }) if points.geometry.area.is_some() => Footprint::Area { radius },
            Some(Disc { radius, .. }) if compliance != 0.0 => Footprint::Disc { radius },
            _ => Footprint::Point,
        };
        // The short waves of a thin plate are known for a force at a point only.
        let is_known = match layers.is_one() {
            true => disc.is_some() || points.geometry.wide_area().is_none(),
            false => settings.separates_short_waves,
        };
        let rate = waves::rate(scene);
        let infinite_plate = is_known.then(|| waves::of_points(&points, &description.relaxations(), rate));
        let system = System {
            mass,
            terms: BodyTerms {
                elastic,
                relaxations,
                support: terms.support.map(of_classes),
                damping: terms.damping.map(of_classes),
                load: even(terms.load),
                support_load: even(terms.support_load),
                support_offset: terms.support_offset,
                contact: ContactPort {
                    force: location::localization(&points),
                    compliance: if compliance == 0.0 { 0.0 } else { -compliance * multiplicity },
                    footprint,
                },
                translation: even(points.tensor.one(DEFLECTION)),
                readings: StressReadings::default(),
                infinite_plate,
                multiplicity,
            },
            pads: terms.pads,
            held: held(&points.tensor, &points.geometry, theory, &description.clamps),
            exchange,
            is_nearly_incompressible: false,
            classes,
        };
        Ok(Self { system, cells, points })
    }

    /// Layers of the plate, and its local contact model.
    pub fn layers(&self) -> &Layers {
        &self.points.layers
    }
}

#[cfg(test)]
mod tests;
