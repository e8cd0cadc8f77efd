//! Cells of a plate: small at the impact point, growing to the size that resolves the flexural waves of the contact.

use std::f64::consts::TAU;

use crate::contact::zener;
use crate::form::plate::Section;
use crate::form::{self, Lame};
use crate::material::Material;
use crate::scene::{Geometry, Impactor, Scene};

use super::Settings;
use super::geometry::PlateGeometry;
use crate::space::grading::{Side, Sizes};
use crate::space::grid::count_cells;
use crate::space::parts::{self, FacePart};
use crate::stack::interlayers;

/// Cell size divided by the distance from the impact point, between the smallest and the largest cells.
const CELL_GROWTH: f64 = 1.0;

/// Size of the cells at the impact point divided by the radius of the loaded disc.
const CELL_OVER_DISC: f64 = 0.75;

/// Size of the largest cell divided by the length of the flexural wave at the frequency of the contact.
///
/// Splines carry waves down to a length of two cells. The force lacks the echoes of shorter waves. With largest cells
/// of 0.20, 0.26 and 0.34 of the wavelength, the error was 0.7%, 1.6% to 1.9% and 3% of the peak force on a pane of 8
/// mm, and 0.2%, 0.7% and 0.8% on a plate of 40 mm. The errors are the same for splines of degree 4 and 5, and for
/// cells at the impact point of 0.4 to 0.75 of the disc.
const CELL_OVER_WAVELENGTH: f64 = 0.14;

/// Smallest number of cells along an edge.
const MIN_CELLS: f64 = 7.0;

/// Largest number of cells along an edge, so that the system remains small.
const MAX_CELLS: f64 = 100.0;

/// Lines of the grid along both axes of the modelled part. The cells are small at the loaded disc of radius `disc` (m),
/// or at the loaded point if it is `None`, at `parts` of the faces, and larger elsewhere for waves of the length `wave` (m).
///
/// # Errors
/// The number of cells along an edge, if the system would not be small.
pub(super) fn lines(
    geometry: &PlateGeometry,
    section: &Section,
    (wave, parts): (f64, &[FacePart]),
    disc: Option<f64>,
    settings: &Settings,
) -> Result<[Vec<f64>; 2], f64> {
    let Settings { cell_size_factor, largest_cell_factor, .. } = *settings;
    let hit_in_part = geometry.hit_in_part();
    let along = |axis: usize| {
        let (edge, hit, [low, high]) = (geometry.edges[axis], hit_in_part[axis], geometry.ends(axis));
        let largest = cell_size_factor * (largest_cell_factor * CELL_OVER_WAVELENGTH * wave).min(edge / MIN_CELLS);
        // The error of the deflection under a point load is proportional to F c²/D for a cell size c. A small fraction
        // of the wavelength suffices.
        let at_hit =
            disc.map_or(section.thickness.max(largest / cell_size_factor / 8.0), |radius| CELL_OVER_DISC * radius);
        // Splines that are smooth across the impact point resolve it half as well as splines that end there.
        let at_hit = cell_size_factor * if hit == low { at_hit } else { 0.5 * at_hit };
        let sizes = Sizes { hit: at_hit, largest, growth: cell_size_factor * CELL_GROWTH };
        let edges = parts::edges(parts, geometry.axes[axis], geometry.halved[axis], [low, high]);
        if !edges.is_empty() {
            let size = |x: f64| sizes.at(x - hit);
            let lines = parts::lines([low, high], (hit, 1), &edges, settings.part_cell_factor, size);
            let cells = count_cells(&lines) as f64;
            return if cells <= MAX_CELLS { Ok(lines) } else { Err(cells) };
        }
        let sides = [hit - low, high - hit].map(|length| Side { length, sizes });
        let cells = sides.iter().map(Side::cells).sum::<f64>();
        if !(largest > 0.0 && cells <= MAX_CELLS) {
            return Err(cells);
        }
        let [below, above] = sides.map(|side| side.lines());
        let mut lines: Vec<f64> = below.iter().rev().map(|d| hit - d).chain([hit]).collect();
        lines.extend(above.iter().map(|d| hit + d));
        // Sets the ends exactly. This removes the rounding of a difference, and includes the piece between the impact
        // point and an edge that is too short for a cell.
        let last = lines.len() - 1;
        [lines[0], lines[last]] = [low, high];
        Ok(lines)
    };
    Ok([along(0)?, along(1)?])
}

/// Characteristic duration of a contact with a plate, s: the duration on a half-space, or six times t if that is
/// shorter. The force on a half-space rises to the value due to the impedance Z of the plate, k0 (v t)^{3/2} = Z v,
/// within t.
pub(in crate::space) fn contact_time(section: &Section, impactor: &Impactor) -> f64 {
    let impedance = zener::impedance(&section.material(), section.thickness);
    let rise = (impedance / impactor.stiffness).powf(2.0 / 3.0) / impactor.contact_speed().cbrt();
    impactor.contact_time().min(6.0 * rise)
}

/// Length of the flexural wave with a given period (s), m.
pub(in crate::space) fn wavelength(section: &Section, period: f64) -> f64 {
    let wavenumber = (section.density * section.thickness / section.rigidity()).sqrt() * TAU / period;
    TAU / wavenumber.sqrt()
}

/// Product of the radius (m) of a disc and the wavenumber of flexural waves at the frequency π/T, with the duration T of the
/// contact; `None` for a mesh file, or layers that are not hit across.
pub fn phase(scene: &Scene, radius: f64) -> Option<f64> {
    let (Geometry::Box { size, .. }, Some(axis)) = (&scene.body.geometry, scene.struck_axis()) else { return None };
    let section = match scene.body.composition.uniform() {
        Some(material) => Section::new(size[axis], material),
        None => super::layers::whole_section(scene).ok()?,
    };
    Some(radius * TAU / wavelength(&section, 2.0 * contact_time(&section, &scene.impactor)))
}

/// Ratio of the time in which a shear wave crosses the thickness of a box to the duration of a contact with a
/// half-space. The wave crosses all layers, with their moduli at t → 0. Infinite for a mesh file.
pub fn crossing(scene: &Scene) -> f64 {
    let instantaneous = |material: &Material| material.instantaneous;
    times_over_contact(scene, instantaneous, |layers, layer| layers[layer].crossing())
}

/// Travel times of a shear wave through the layers of a box, divided by the contact time on a half-space.
pub struct ShearTravelTimes {
    /// Sum over all layers but soft interlayers.
    pub plies: f64,
    /// Sum over the soft interlayers: layers between stiff ones, much softer than these.
    pub interlayers: f64,
}

impl ShearTravelTimes {
    /// Travel times with the secant moduli at half the contact time. Infinite for a mesh file.
    pub fn of(scene: &Scene) -> Self {
        let secant = |material: &Material| material.secant(scene.impactor.moduli_time());
        let sum = |of_interlayers: bool| {
            times_over_contact(scene, secant, |layers, layer| {
                if is_soft_interlayer(layers, layer) == of_interlayers { layers[layer].crossing() } else { 0.0 }
            })
        };
        Self { plies: sum(false), interlayers: sum(true) }
    }
}

/// Times of vibrations near the impact point, divided by the contact time on a half-space.
pub struct LocalVibrations {
    /// Travel time of a shear wave through the plies.
    pub plies: f64,
    /// Sum over the [interlayers], each with the longer one of two periods: that of the vibration in which its neighbours
    /// squeeze it, and that of the shear wave between its faces, 2h/c_s.
    pub interlayers: f64,
}

impl LocalVibrations {
    /// Vibrations with the moduli at t → 0. Infinite for a mesh file.
    pub fn of(scene: &Scene) -> Self {
        let instantaneous = |material: &Material| material.instantaneous;
        let plies = times_over_contact(scene, instantaneous, |layers, layer| {
            if are_interlayers(layers)[layer] { 0.0 } else { layers[layer].crossing() }
        });
        let interlayers = times_over_contact(scene, instantaneous, |layers, layer| {
            if are_interlayers(layers)[layer] { longest_period(layers, layer) } else { 0.0 }
        });
        Self { plies, interlayers }
    }
}

/// Longer one of the two periods of an interlayer, s.
fn longest_period(layers: &[Crossed], interlayer: usize) -> f64 {
    let Crossed { thickness, density, constants: Lame { lambda, mu } } = layers[interlayer];
    let [above, below] = [interlayer - 1, interlayer + 1].map(|ply| layers[ply].thickness * layers[ply].density);
    let reduced = above * below / (above + below);
    let of_squeezing = TAU * (reduced * thickness / (lambda + 2.0 * mu)).sqrt();
    let of_shear = 2.0 * thickness / (mu / density).sqrt();
    of_squeezing.max(of_shear)
}

/// A layer that waves cross.
struct Crossed {
    thickness: f64,
    density: f64,
    constants: Lame,
}

impl Crossed {
    /// Time in which a shear wave crosses the layer, s.
    fn crossing(&self) -> f64 {
        self.thickness / (self.constants.mu / self.density).sqrt()
    }
}

/// Largest ratio of the shear modulus of a soft interlayer to that of the stiffest layer. The error of the tension next to
/// interlayers was measured at ratios up to 7e-4.
const SOFT: f64 = 1e-2;

/// Whether a layer is soft and lies between stiff ones.
fn is_soft_interlayer(layers: &[Crossed], layer: usize) -> bool {
    let stiffest = layers.iter().map(|layer| layer.constants.mu).fold(0.0, f64::max);
    let is_stiff = |layer: &Crossed| layer.constants.mu > SOFT * stiffest;
    let (above, below) = layers.split_at(layer);
    !is_stiff(&layers[layer]) && above.iter().any(is_stiff) && below.iter().any(is_stiff)
}

/// Whether each layer is one of the [interlayers].
fn are_interlayers(layers: &[Crossed]) -> Vec<bool> {
    let moduli: Vec<f64> = layers.iter().map(|layer| layer.constants.mu).collect();
    interlayers(&moduli)
}

/// Sum of a time (s) of each layer over the duration of a contact with a half-space. The layers have some elastic
/// constants of their materials. Infinite for a mesh file.
fn times_over_contact(
    scene: &Scene,
    constants: impl Fn(&Material) -> form::Material,
    time: impl Fn(&[Crossed], usize) -> f64,
) -> f64 {
    let (body, impactor) = (&scene.body, &scene.impactor);
    let (Geometry::Box { size, .. }, Some(axis)) = (&body.geometry, scene.struck_axis()) else { return f64::INFINITY };
    let crossed = |(thickness, material): (f64, Material)| {
        let constants = constants(&material);
        Crossed { thickness, density: constants.density, constants: constants.lame() }
    };
    let layers: Vec<Crossed> = body.composition.across(axis, size[axis]).into_iter().map(crossed).collect();
    (0..layers.len()).map(|layer| time(&layers, layer)).sum::<f64>() / impactor.contact_time()
}
