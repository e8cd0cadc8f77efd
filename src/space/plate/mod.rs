//! A box hit on a face, as a thin plate: small linear systems of Kirchhoff's theory, of Reissner's and Mindlin's, or of the latter for
//! each of its layers.

mod boundary;
mod cells;
mod clamps;
mod edges;
mod face;
mod geometry;
mod laminate;
pub mod layer;
mod location;
mod points;
mod square;
mod theory;
mod waves;

pub use cells::crossing;
pub(super) use cells::{contact_time, wavelength};
pub use laminate::{Laminate, OF_CONTACT, contact_wavelength, mismatch};
pub use points::Points;
pub use theory::PlateTheory;
pub use waves::{classes_of_motions, infinite_plate};

use clamps::held;
use geometry::PlateGeometry;
use layer::Layer;

use std::rc::Rc;

use nalgebra_sparse::CsrMatrix;

use super::SurfaceTerms;
use super::grid::GridSpace;
use super::parity::repeated;
use crate::body::{Operator, System};
use crate::description::Description;
use crate::error::Result;
use crate::form::Spread;
use crate::form::plate::{DEFLECTION, Section};
use crate::form::tensor::Square;
use crate::scene::{Fault, Scene};

/// Choices that a scene does not make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Size of all cells over the default's.
    pub cell_size_factor: f64,
    /// Size of the largest cells over that.
    pub largest_cell_factor: f64,
    /// κ of Mindlin's theory; left out, 5/(6 − ν).
    pub shear_factor: Option<f64>,
    /// Radius of Mindlin's disc over the thickness, where it has room.
    pub disc: f64,
    /// The same in m, in the place of that: what a scene gives.
    pub disc_radius: Option<f64>,
    /// Whether the layers of the layerwise theory that bend do not shear, and have no local field under the impactor: as Kirchhoff's
    /// theory has one layer.
    pub is_thin: bool,
}

/// κ = 5/(6 − ν), which gives the speed of long waves to one order more than Reissner's static 5/6 (Stephen, Mindlin plate theory: best
/// shear coefficient and higher spectra validity, J. Sound Vib. 202, 1997).
fn shear_factor(poisson: f64) -> f64 {
    5.0 / (6.0 - poisson)
}

impl Settings {
    /// Cells for an error of less than half of a tolerance, as measured on plates.
    pub fn new(tolerance: f64, theory: PlateTheory) -> Self {
        let parts = tolerance / 1e-2;
        let of_mindlin = 1.2 * if parts > 1.0 { parts.cbrt() } else { parts.powf(0.25) };
        // w alone is smoother than what presses it: no shear.
        let cell_size_factor = if theory == PlateTheory::Kirchhoff { 1.4 * of_mindlin } else { of_mindlin };
        Self { cell_size_factor: cell_size_factor.clamp(0.3, 2.4), ..Self::default() }
    }

    /// Radius of the disc over a thickness (m) where it has room.
    pub(super) fn disc_over(&self, thickness: f64) -> f64 {
        self.disc_radius.map_or(self.disc, |radius| radius / thickness)
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            cell_size_factor: 1.0,
            largest_cell_factor: 1.0,
            shear_factor: None,
            disc: 2.0,
            disc_radius: None,
            is_thin: false,
        }
    }
}

/// Entries of a matrix for each multiplication along the axes from which on its products are made along these. An entry of a matrix that is larger
/// than the cache takes about as long as one of these.
const LEAST_SAVING: usize = 2;

/// Entries of a matrix that is larger than the cache.
const LARGE: usize = 100_000;

/// Radius of Mindlin's disc over the thickness, at least.
const LEAST_DISC: f64 = 0.5;

/// A plate's system, and how it was made.
///
/// The unknowns are coefficients of splines: of w along the impactor's direction (m), then of Mindlin's rotations θ along the two
/// axes of the plane, ascending (rad), of several layers one after the other. At its ends Kirchhoff's w has slopes among its coefficients. The compliance is −c_M times the
/// copies, or 0 for Kirchhoff's theory.
#[derive(Debug, Clone)]
pub struct Plate {
    /// The body's side of M ü + C u̇ + K u = a F + f.
    pub system: System,
    /// Cells along both axes of the modelled part.
    pub cells: [usize; 2],
    /// How Mindlin's plate is hit.
    pub local: Option<Local>,
    /// The layers of a plate that has several, and how it is hit.
    pub laminate: Option<Laminate>,
    /// What its points do.
    pub points: Points,
}

/// What a plate is before its matrices.
struct Outline {
    geometry: PlateGeometry,
    laminate: Option<Laminate>,
    section: Section,
    local: Option<Local>,
    /// The ends of the cells along both axes, m.
    in_plane: [Vec<f64>; 2],
}

/// What stands for the local field on a Reissner–Mindlin plate; see [`layer`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Local {
    /// κ.
    pub shear_factor: f64,
    /// The pressure on the disc.
    pub spread: Spread,
    /// The disc's radius, m.
    pub radius: f64,
    /// s: the surface is read as w + s h² ∇·θ.
    pub reading: f64,
    /// c_M of the whole plate, m/N: α = δ − c_M F.
    pub compliance: f64,
}

/// Why a plate theory does not stand for a scene: one clause.
///
/// # Errors
/// That clause.
pub fn admits(scene: &Scene, theory: PlateTheory) -> std::result::Result<(), String> {
    let geometry = geometry(scene, theory)?;
    if theory == PlateTheory::Layerwise {
        Laminate::new(scene, &geometry, &Description::new(scene).parts, &Settings::default())?;
    }
    Ok(())
}

/// That a theory does not stand for a scene.
fn fault(theory: PlateTheory, reason: &str) -> Fault {
    let message = format!("{} cannot model this scene: {reason}", theory.plate());
    Fault::new("body.model", message, "model = \"solid\"")
}

fn geometry(scene: &Scene, theory: PlateTheory) -> std::result::Result<PlateGeometry, String> {
    let geometry = PlateGeometry::new(scene)?;
    boundary::check(scene, &geometry, theory)?;
    let layer = if theory == PlateTheory::Layerwise {
        laminate::struck_thickness(scene, geometry.thickness)
    } else {
        geometry.thickness
    };
    let least = LEAST_DISC * layer;
    if theory.shears() && least > geometry.distance_to_edge() * (1.0 + 1e-9) {
        return Err(format!(
            "the hit is {:.3e} m from an edge, and the disc that it spreads over has a radius of at least {least:.3e} m",
            geometry.distance_to_edge()
        ));
    }
    Ok(geometry)
}

impl Outline {
    /// Of a scene and its description.
    fn new(scene: &Scene, description: &Description, theory: PlateTheory, settings: &Settings) -> Result<Self> {
        let fault = |reason: String| fault(theory, &reason);
        let geometry = geometry(scene, theory).map_err(fault)?;
        let parts = &description.parts;
        let laminate = (theory == PlateTheory::Layerwise)
            .then(|| Laminate::new(scene, &geometry, parts, settings))
            .transpose()
            .map_err(fault)?;
        let section = match &laminate {
            None => Section::new(geometry.thickness, &scene.body.struck()),
            Some(laminate) => laminate.section(scene),
        };
        let is_mindlin = theory == PlateTheory::Mindlin;
        let local = is_mindlin.then(|| Local::new(&section, settings, geometry.distance_to_edge()));
        let disc = laminate.as_ref().map(|laminate| laminate.radius).or(local.map(|local| local.radius));
        let own_wave = || wavelength(&section, contact_time(&section, &scene.impactor));
        let wave = scene.body.wavelength.filter(|_| laminate.is_some()).unwrap_or_else(own_wave);
        let in_plane = cells::lines(&geometry, &section, wave, disc, settings)
            .map_err(|cells| fault(format!("it would take {cells:.0} cells along an edge")))?;
        Ok(Self { geometry, laminate, section, local, in_plane })
    }
}

impl Plate {
    /// How many cells a scene's plate would have along both axes of the modelled part.
    ///
    /// # Errors
    /// As [`Plate::new`].
    pub fn cells(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<[usize; 2]> {
        let outline = Outline::new(scene, &Description::new(scene), theory, settings)?;
        Ok(outline.in_plane.each_ref().map(|lines| lines.len() - 1))
    }

    /// Builds a scene's plate.
    ///
    /// # Errors
    /// A fault of `body.model` where the theory does not stand for the scene, or where the plate would take very many cells.
    pub fn new(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<Self> {
        let description = Description::new(scene);
        let Outline { geometry, laminate, section, local, in_plane } =
            Outline::new(scene, &description, theory, settings)?;
        let cells = in_plane.each_ref().map(|lines| lines.len() - 1);
        let tensor = theory.tensor(&in_plane, laminate.as_ref().map_or(1, |laminate| laminate.profile.len()));
        let half = 0.5 * geometry.thickness;
        let mut lines: [Vec<f64>; 3] = std::array::from_fn(|_| vec![-half, half]);
        if let Some(laminate) = &laminate {
            lines[geometry.normal] = geometry.across_plate(&laminate.profile.heights);
        }
        geometry.axes.into_iter().zip(in_plane).for_each(|(axis, of_axis)| lines[axis] = of_axis);
        let points = Points { geometry, section, lines, tensor, theory, local, laminate };
        let mirrors = points.geometry.mirrors();
        let terms = SurfaceTerms::new(&GridSpace { field: &points, mirrors: &mirrors }, &description)?;
        let (copies, classes) = (points.geometry.copies(), points.geometry.classes.len());
        let (mut elastic, mass) = match &points.laminate {
            None => {
                let shear_factor = local.map_or(0.0, |local| local.shear_factor);
                (theory.elastic(&section, shear_factor), theory.mass(&section))
            }
            Some(laminate) => (laminate.elastic(), laminate.inertia()),
        };
        if let Some(local) = &local {
            elastic.extend(edges::forms(&points, local.shear_factor, &description.clamps));
        }
        // Loads, and a motion of the whole along the impact, are even.
        let even = |mut vector: Vec<f64>| {
            vector.resize(points.all_unknowns(), 0.0);
            vector
        };
        let of_classes = |matrix: CsrMatrix<f64>| repeated(matrix, classes);
        let exchange = square::exchange(&points);
        let mut factorised = Vec::new();
        let mut of_forms = |operator: Operator, forms: &[Square<2>]| {
            let matrix = points.tensor.matrix(forms);
            // (The half of the unknowns of a square that is symmetric about its diagonal has no such axes; whether its supports are, too, is not known yet.)
            if exchange.is_none() || matrix.nnz() > LARGE {
                let along_axes = points.tensor.factorised(forms);
                if along_axes.multiplications() < matrix.nnz() / LEAST_SAVING {
                    factorised.push((operator, Rc::new(along_axes)));
                }
            }
            of_classes(matrix)
        };
        let (mass, elastic) = (of_forms(Operator::Mass, &mass), of_forms(Operator::Elastic, &elastic));
        let mut relaxations = Vec::new();
        if let Some(laminate) = &points.laminate {
            for (number, (chain, relaxing)) in description.relaxations().into_iter().enumerate() {
                let forms = laminate.distortion(&points.geometry, &relaxing);
                relaxations.push((of_forms(Operator::Distortion(number), &forms), chain.clone()));
            }
        }
        let compliance = points.laminate.as_ref().map(|laminate| laminate.compliance);
        let compliance = compliance.or(local.map(|local| local.compliance)).unwrap_or_default();
        let system = System {
            mass,
            elastic,
            relaxations,
            support: terms.support.map(of_classes),
            damping: terms.damping.map(of_classes),
            pads: terms.pads,
            held: held(&points.tensor, &points.geometry, theory, &description.clamps),
            load: even(terms.load),
            support_load: even(terms.support_load),
            support_offset: terms.support_offset,
            localization: location::localization(&points),
            compliance: if compliance == 0.0 { 0.0 } else { -compliance * copies },
            patch: None,
            hit_stress: Vec::new(),
            hit_local: [0.0; 3],
            infinite_plate: waves::of_points(&points),
            exchange,
            factorised,
            translation: even(points.tensor.one(DEFLECTION)),
            copies,
            classes,
        };
        Ok(Self { system, cells, local, laminate: points.laminate.clone(), points })
    }
}

impl Plate {
    /// The longest cell at the hit over the radius of Mindlin's disc; twice that where splines are smooth across the hit, which resolve it
    /// half as well as those that end there.
    pub fn cell_over_disc(&self) -> Option<f64> {
        let (radius, geometry) = (self.local?.radius, &self.points.geometry);
        let hit = geometry.hit_in_part();
        let longest = |i: usize| {
            let holds = |ends: &&[f64]| ends[0] <= hit[i] && hit[i] <= ends[1];
            let cells = self.points.lines[geometry.axes[i]].windows(2).filter(holds).map(|ends| ends[1] - ends[0]);
            cells.fold(0.0, f64::max) * if hit[i] == geometry.ends(i)[0] { 1.0 } else { 2.0 }
        };
        Some(longest(0).max(longest(1)) / radius)
    }
}

impl Local {
    fn new(section: &Section, settings: &Settings, distance_to_edge: f64) -> Self {
        let h = section.thickness;
        let disc = settings.disc_over(h).min(distance_to_edge / h);
        let spread = Spread::new(0.0);
        let shear_factor = settings.shear_factor.unwrap_or(shear_factor(section.poisson));
        let layer = Layer { poisson: section.poisson, shear_factor, spread, disc };
        let compliance = layer.compliance() / (section.young * h);
        Self { shear_factor, spread, radius: disc * h, reading: layer.reading(), compliance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::plate::rotation;

    /// The same springs against a rotation of all layers, which is their sum; the mass, and the instantaneous stiffness of layers that relax.
    #[test]
    fn layers_have_the_sums_of_their_parts() {
        let scene = |interlayer: &str, layers: [f64; 3]| {
            let layer = |(thickness, material): (f64, &str)| {
                format!("[[body.layer]]\nthickness = {thickness}\nmaterial = \"{material}\"\n")
            };
            let layers: String = layers.into_iter().zip(["glass", "soft", "glass"]).map(layer).collect();
            let text = format!(
                "[body]\nsize = [0.6, 0.4]\nsymmetry = \"none\"\n{layers}\
                 [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n[material.soft]\ndensity = 1100.0\nbulk = 2e9\n{interlayer}\n\
                 [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\n[time]\nend = 1e-3\n\
                 [[support]]\nsurface = \"x-min\"\nkind = \"elastic\"\nstiffness = [2e9, 3e9, 0]\n"
            );
            Scene::parse("test", &text, &[]).expect("a scene").0
        };
        let settings = Settings { cell_size_factor: 2.4, ..Settings::default() };
        let plate = |scene: &Scene| Plate::new(scene, PlateTheory::Layerwise, &settings).expect("a plate");
        let energy = |matrix: &CsrMatrix<f64>, u: &[f64]| -> f64 {
            matrix.triplet_iter().map(|(i, j, value)| u[i] * value * u[j]).sum()
        };
        for layers in [[0.013, 0.004, 0.013], [0.018, 0.004, 0.008]] {
            let chain = "shear = 1e6\nprony = [{ modulus = 4e7, time = 1e-4 }, { modulus = 6e7, time = 2e-4 }]";
            let relaxing = plate(&scene(chain, layers));
            let [(distortion, chain)] = &relaxing.system.relaxations[..] else { panic!("one relaxation") };
            let laminate = relaxing.laminate.as_ref().expect("layers");
            // Shear factors are those of the contact's modulus.
            let [stiff, soft] = [chain.instantaneous(), chain.equilibrium].map(|shear| {
                let elastic = plate(&scene(&format!("shear = {shear:e}"), layers)).laminate.expect("layers");
                relaxing.points.tensor.matrix(&elastic.with_shear_factors_of(laminate).elastic())
            });
            let profile = &laminate.profile;
            let tensor = &relaxing.points.tensor;
            for axis in 0..2 {
                let mut turned = vec![0.0; tensor.unknowns()];
                for layer in 0..3 {
                    let field = crate::form::layerwise::rotation(profile.group_of(layer), axis, [0, 0]).field;
                    turned.iter_mut().zip(tensor.one(field)).for_each(|(u, one)| *u = f64::max(*u, one));
                }
                let k = [2e9, 3e9][axis];
                let sum = energy(relaxing.system.support.as_ref().expect("springs"), &turned);
                let exact = k * 0.03_f64.powi(3) / 12.0 * 0.4;
                // Rounding of some hundred points.
                assert!((sum / exact - 1.0).abs() < 1e-12, "{layers:?} {axis}: {sum} {exact}");
            }
            let translation = &relaxing.system.translation;
            let mass = energy(&relaxing.system.mass, translation);
            let exact = 0.6 * 0.4 * (2500.0 * 0.026 + 1100.0 * 0.004);
            assert!((mass / exact - 1.0).abs() < 1e-12 && energy(distortion, translation).abs() < 1e-12);
            let u: Vec<f64> = (0..translation.len()).map(|i| ((i * 7919) % 101) as f64 / 50.0 - 1.0).collect();
            let relaxed = energy(&relaxing.system.elastic, &u);
            // Rounding of E and ν to G and K.
            assert!((relaxed / energy(&soft, &u) - 1.0).abs() < 1e-9, "{relaxed} {}", energy(&soft, &u));
            let whole = relaxed + (chain.instantaneous() - chain.equilibrium) * energy(distortion, &u);
            assert!((whole / energy(&stiff, &u) - 1.0).abs() < 1e-9, "{whole} {}", energy(&stiff, &u));
        }
    }

    /// Springs along the sides against a rotation of all of Mindlin's plate along one axis: k h³/12 a unit of length.
    #[test]
    fn springs_resist_rotations() {
        let text = "[body]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\nsize = [0.6, 0.4, 0.03]\nsymmetry = \"none\"\n\
                    [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e10\nspeed = 1.0\n[time]\nend = 1e-3\n\
                    [[support]]\nsurface = \"x-min\"\nkind = \"elastic\"\nstiffness = [2e9, 3e9, 0]\n\
                    [[support]]\nsurface = \"y-max\"\nkind = \"elastic\"\nstiffness = [2e9, 3e9, 0]\n";
        let scene = Scene::parse("test", text, &[]).expect("a scene").0;
        let plate = Plate::new(&scene, PlateTheory::Mindlin, &Settings::default()).expect("a plate");
        let support = plate.system.support.expect("springs");
        for (axis, k) in [2e9, 3e9].into_iter().enumerate() {
            let one = plate.points.tensor.one(rotation(axis, [0, 0]).field);
            let sum: f64 = support.triplet_iter().map(|(i, j, value)| one[i] * value * one[j]).sum();
            let exact = k * 0.03_f64.powi(3) / 12.0 * (0.4 + 0.6);
            // Rounding of some hundred points.
            assert!((sum / exact - 1.0).abs() < 1e-12, "{sum} {exact}");
        }
    }
}
