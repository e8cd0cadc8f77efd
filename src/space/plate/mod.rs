//! A box impacted on a face, modelled as a thin plate: small linear systems of Kirchhoff's theory, Reissner–Mindlin
//! theory, or the layerwise theory (Reissner–Mindlin theory in each layer).

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

pub(super) use cells::{contact_time, wavelength};
pub use cells::{crossing, local_vibrations};
pub use laminate::{FrequencyRatios, Laminate, contact_wavelength, frequency_ratios};
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
use crate::contact::Footprint;
use crate::description::Description;
use crate::error::Result;
use crate::form::Spread;
use crate::form::plate::{DEFLECTION, Section};
use crate::form::tensor::{Integrals, Square};
use crate::scene::{Fault, Scene};

/// Options of a plate model that are not part of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Factor on the size of all cells; 1 is the default size.
    pub cell_size_factor: f64,
    /// Additional factor on the size of the largest cells alone.
    pub largest_cell_factor: f64,
    /// Whether short waves of several layers may be treated separately, for which [`InfinitePlate`] is computed. It is
    /// always known for one layer.
    ///
    /// [`InfinitePlate`]: crate::body::InfinitePlate
    pub separates_short_waves: bool,
    /// Whether the echoes of short waves are computed in closed form, if the plate admits that. A cell as wide as the
    /// thickness then lies along each edge: it resolves the boundary layer of Mindlin's theory, as closed forms do.
    pub has_echoes_in_closed_form: bool,
    /// Shear factor κ of Mindlin's theory. Default: 5/(6 − ν).
    pub shear_factor: Option<f64>,
    /// Radius of Mindlin's disc divided by the thickness, if the disc fits within the plate.
    pub disc: f64,
    /// Radius of the disc in m, as prescribed by a scene. It takes precedence over `disc`.
    pub disc_radius: Option<f64>,
    /// Whether the stiff layers of the layerwise theory are rigid in shear and the local field under the impactor is
    /// neglected. These are the assumptions of Kirchhoff's theory for a single layer.
    pub is_thin: bool,
}

/// Default shear factor κ = 5/(6 − ν), which gives the speed of long waves to one order more than Reissner's static 5/6
/// (Stephen, Mindlin plate theory: best shear coefficient and higher spectra validity, J. Sound Vib. 202, 1997).
fn shear_factor(poisson: f64) -> f64 {
    5.0 / (6.0 - poisson)
}

impl Settings {
    /// Settings with a cell size for an error of less than half of a tolerance, as measured on plates.
    pub fn new(tolerance: f64, theory: PlateTheory) -> Self {
        let parts = tolerance / 1e-2;
        let of_mindlin = 1.2 * if parts > 1.0 { parts.cbrt() } else { parts.powf(0.25) };
        // Kirchhoff's theory has no shear: its deflection w is smoother than the load, so larger cells suffice.
        let cell_size_factor = if theory == PlateTheory::Kirchhoff { 1.4 * of_mindlin } else { of_mindlin };
        Self { cell_size_factor: cell_size_factor.clamp(0.3, 2.4), ..Self::default() }
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
            largest_cell_factor: 1.0,
            separates_short_waves: false,
            has_echoes_in_closed_form: false,
            shear_factor: None,
            disc: 2.0,
            disc_radius: None,
            is_thin: false,
        }
    }
}

/// Smallest ratio of the stored entries of a matrix to the multiplications of its sum-factorised form for which the
/// latter is used. For a matrix larger than the cache, a stored entry takes about as long as one of these
/// multiplications.
const LEAST_SAVING: usize = 2;

/// Number of entries from which a matrix counts as larger than the cache.
const LARGE: usize = 100_000;

/// Smallest radius of Mindlin's disc divided by the thickness.
const LEAST_DISC: f64 = 0.5;

/// A plate's linear system and the data from which it was made.
///
/// The unknowns are spline coefficients: first of the deflection w along the impactor's direction (m), then of
/// Mindlin's rotations θ along the two axes of the plane, ascending (rad). With several layers, the pairs of rotations
/// follow one another. In Kirchhoff's theory the coefficients of w include its slopes at the ends. The compliance of
/// the system is −c_M times the symmetry multiplicity, or 0 for Kirchhoff's theory.
#[derive(Debug, Clone)]
pub struct Plate {
    /// System of M ü + C u̇ + K u = a F + f.
    pub system: System,
    /// Number of cells along both axes of the modelled part.
    pub cells: [usize; 2],
    /// Local contact model of Mindlin's plate.
    pub local: Option<Local>,
    /// Layers and local contact model of a plate with several layers.
    pub laminate: Option<Laminate>,
    /// Evaluator of displacements and stresses at points of the plate.
    pub points: Points,
}

/// How the mass and the stiffness of a plate are stored.
#[derive(Clone, Copy, PartialEq)]
enum Storage {
    /// As matrices, and also as products along the axes where these are quicker.
    Matrices,
    /// Only as products along the axes.
    Products,
}

/// Data of a plate from which its matrices are made.
struct Outline {
    geometry: PlateGeometry,
    laminate: Option<Laminate>,
    section: Section,
    local: Option<Local>,
    /// Ends of the cells along both axes, m.
    in_plane: [Vec<f64>; 2],
}

/// Model of the local field under the impactor on a Reissner–Mindlin plate; see [`layer`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Local {
    /// Shear factor κ.
    pub shear_factor: f64,
    /// Pressure on the disc.
    pub spread: Spread,
    /// Radius of the disc, m.
    pub radius: f64,
    /// Dimensionless s: the displacement of the surface is evaluated as w + s h² ∇·θ.
    pub reading: f64,
    /// Local compliance c_M of the whole plate, m/N: α = δ − c_M F.
    pub compliance: f64,
}

/// Checks whether a plate theory can model a scene.
///
/// # Errors
/// The reason why it cannot: one clause.
pub fn admits(scene: &Scene, theory: PlateTheory) -> std::result::Result<(), String> {
    let geometry = geometry(scene, theory)?;
    if theory == PlateTheory::Layerwise {
        Laminate::without_local(scene, &geometry, &Description::new(scene).parts, &Settings::default())?;
    }
    Ok(())
}

/// Fault for a scene that a theory cannot model.
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
    /// Outline of the plate of a scene and its description.
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

    /// Evaluator of the plate's displacements and stresses.
    fn points(self, scene: &Scene, theory: PlateTheory, settings: &Settings) -> Points {
        let Self { geometry, laminate, section, local, in_plane } = self;
        let tensor = theory.tensor(&in_plane, laminate.as_ref().map_or(1, |laminate| laminate.profile.len()));
        let half = 0.5 * geometry.thickness;
        let mut lines: [Vec<f64>; 3] = std::array::from_fn(|_| vec![-half, half]);
        if let Some(laminate) = &laminate {
            lines[geometry.normal] = geometry.across_plate(&laminate.profile.heights);
        }
        geometry.axes.into_iter().zip(in_plane).for_each(|(axis, of_axis)| lines[axis] = of_axis);
        let rectangle = waves::rectangle(scene, &geometry, &section, laminate.as_ref(), theory);
        let rectangle = rectangle.filter(|_| settings.has_echoes_in_closed_form);
        Points { geometry, section, lines, tensor, theory, local, laminate, rectangle }
    }
}

impl Plate {
    /// Number of cells that a scene's plate would have along both axes of the modelled part.
    ///
    /// # Errors
    /// Same as [`Plate::new`].
    pub fn cells(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<[usize; 2]> {
        let outline = Outline::new(scene, &Description::new(scene), theory, settings)?;
        Ok(outline.in_plane.each_ref().map(|lines| lines.len() - 1))
    }

    /// Evaluator of the displacements and stresses of a scene's plate, without its matrices.
    ///
    /// # Errors
    /// Same as [`Plate::new`].
    pub fn points(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<Points> {
        Ok(Outline::new(scene, &Description::new(scene), theory, settings)?.points(scene, theory, settings))
    }

    /// Builds a scene's plate.
    ///
    /// # Errors
    /// A fault of `body.model` if the theory cannot model the scene, or if the plate would need too many cells.
    pub fn new(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<Self> {
        Self::with_storage(scene, theory, settings, Storage::Matrices)
    }

    /// Builds a scene's plate with mass, stiffness and relaxation stored only as products along the axes, which is much
    /// quicker. Their matrices are empty.
    ///
    /// # Errors
    /// Same as [`Plate::new`].
    pub fn for_products(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<Self> {
        Self::with_storage(scene, theory, settings, Storage::Products)
    }

    fn with_storage(scene: &Scene, theory: PlateTheory, settings: &Settings, storage: Storage) -> Result<Self> {
        let description = Description::new(scene);
        let points = Outline::new(scene, &description, theory, settings)?.points(scene, theory, settings);
        let (cells, local) = (points.lines_in_plane().map(|lines| lines.len() - 1), points.local);
        let mirrors = points.geometry.mirrors();
        let terms = SurfaceTerms::new(&GridSpace { field: &points, mirrors: &mirrors }, &description)?;
        let (multiplicity, classes) = (points.geometry.multiplicity(), points.geometry.classes.len());
        let (mut elastic, mass) = match &points.laminate {
            None => {
                let shear_factor = local.map_or(0.0, |local| local.shear_factor);
                (theory.elastic(&points.section, shear_factor), theory.mass(&points.section))
            }
            Some(laminate) => (laminate.elastic(), laminate.inertia()),
        };
        if let Some(local) = &local {
            elastic.extend(edges::forms(&points, local.shear_factor, &description.clamps));
        }
        // Loads and the translation along the impact direction are even.
        let even = |mut vector: Vec<f64>| {
            vector.resize(points.all_unknowns(), 0.0);
            vector
        };
        let of_classes = |matrix: CsrMatrix<f64>| repeated(matrix, classes);
        let exchange = square::exchange(&points).filter(|_| storage == Storage::Matrices);
        let (mut factorised, mut integrals) = (Vec::new(), Integrals::default());
        let mut of_forms = |operator: Operator, forms: &[Square<2>]| {
            if storage == Storage::Products {
                factorised.push((operator, Rc::new(points.tensor.factorised(forms, &mut integrals))));
                return CsrMatrix::zeros(points.all_unknowns(), points.all_unknowns());
            }
            let matrix = points.tensor.matrix_sharing(forms, &mut integrals);
            // A square that is symmetric about its diagonal is reduced to half of its unknowns, which have no product
            // form along the axes. Whether its supports are symmetric too is not known yet.
            if exchange.is_none() || matrix.nnz() > LARGE {
                let along_axes = points.tensor.factorised(forms, &mut integrals);
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
        let is_known =
            points.laminate.is_none() || settings.separates_short_waves || settings.has_echoes_in_closed_form;
        let rate = waves::rate(scene);
        let infinite_plate = is_known.then(|| waves::of_points(&points, &description.relaxations(), rate));
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
            compliance: if compliance == 0.0 { 0.0 } else { -compliance * multiplicity },
            footprint: if compliance == 0.0 { Footprint::Point } else { Footprint::Disc },
            hit_stress: Vec::new(),
            local_stress_per_newton: [0.0; 3],
            infinite_plate,
            exchange,
            factorised,
            translation: even(points.tensor.one(DEFLECTION)),
            multiplicity,
            classes,
        };
        Ok(Self { system, cells, local, laminate: points.laminate.clone(), points })
    }
}

impl Plate {
    /// Length of the longest cell at the impact point divided by the radius of Mindlin's disc. The length is doubled
    /// where the splines are smooth across the impact point: they resolve it half as well as splines that end there.
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
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::form::plate::rotation;

    /// Checks the stiffness of springs against a rotation of all layers, which is the sum over the layers; the mass;
    /// and the instantaneous stiffness of viscoelastic layers.
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
            // The shear strains must be those for the modulus at the contact time.
            let [stiff, soft] = [chain.instantaneous(), chain.equilibrium].map(|shear| {
                let elastic = plate(&scene(&format!("shear = {shear:e}"), layers)).laminate.expect("layers");
                relaxing.points.tensor.matrix(&elastic.with_theory_of(laminate).elastic())
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
                // Rounding error of some hundred points.
                assert!((sum / exact - 1.0).abs() < 1e-12, "{layers:?} {axis}: {sum} {exact}");
            }
            let translation = &relaxing.system.translation;
            let mass = energy(&relaxing.system.mass, translation);
            let exact = 0.6 * 0.4 * (2500.0 * 0.026 + 1100.0 * 0.004);
            assert!((mass / exact - 1.0).abs() < 1e-12 && energy(distortion, translation).abs() < 1e-12);
            let u: Vec<f64> = (0..translation.len()).map(|i| ((i * 7919) % 101) as f64 / 50.0 - 1.0).collect();
            let relaxed = energy(&relaxing.system.elastic, &u);
            // Rounding error of converting E and ν to G and K.
            assert!((relaxed / energy(&soft, &u) - 1.0).abs() < 1e-9, "{relaxed} {}", energy(&soft, &u));
            let whole = relaxed + (chain.instantaneous() - chain.equilibrium) * energy(distortion, &u);
            assert!((whole / energy(&stiff, &u) - 1.0).abs() < 1e-9, "{whole} {}", energy(&stiff, &u));
        }
    }

    /// A plate stored as products has the same operators as one stored as matrices.
    #[test]
    fn products_match_the_matrices() {
        // A quarter, a square, and four classes of motions.
        for (width, point) in [(0.2, [0.0; 2]), (0.3, [0.0; 2]), (0.2, [0.04, 0.02])] {
            let text = format!(
                "[body]\nsize = [0.3, {width}]\n[[body.layer]]\nthickness = 0.004\nmaterial = \"glass\"\n\
             [[body.layer]]\nthickness = 0.001\nmaterial = \"soft\"\n[[body.layer]]\nthickness = 0.006\nmaterial = \"glass\"\n\
             [material.glass]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n\
             [material.soft]\ndensity = 1100.0\nbulk = 2e9\nshear = 1e6\nprony = [{{ modulus = 4e7, time = 1e-4 }}]\n\
             [impactor]\nmass = 1.0\nradius = 0.05\nstiffness = 1e8\nspeed = 1.0\npoint = {point:?}\n[time]\nend = 1e-3\n"
            );
            let (scene, _) = Scene::parse("test", &text, &[]).expect("a scene");
            let settings = Settings { cell_size_factor: 2.4, ..Settings::default() };
            let system = |plate: Result<Plate>| plate.expect("a plate").system;
            let whole = system(Plate::new(&scene, PlateTheory::Layerwise, &settings));
            let products = system(Plate::for_products(&scene, PlateTheory::Layerwise, &settings));
            let matrices = [
                (Operator::Mass, &whole.mass),
                (Operator::Elastic, &whole.elastic),
                (Operator::Distortion(0), &whole.relaxations[0].0),
            ];
            assert_eq!(products.factorised.len(), matrices.len());
            let u: Vec<f64> = (0..whole.load.len()).map(|i| ((i * 7919) % 101) as f64 / 50.0 - 1.0).collect();
            for (operator, matrix) in matrices {
                let factorised = products.factorised.iter().find(|(of, _)| *of == operator).expect("a product");
                let (all, product) = (matrix * DMatrix::from_column_slice(u.len(), 1, &u), factorised.1.multiply(&u));
                let off = (all.column(0) - DVector::from_column_slice(&product)).amax();
                // Rounding errors of some hundred terms, of which the largest exceed the sums.
                assert!(off <= 1e-11 * all.amax(), "{operator:?}: {off:e} of {:e}", all.amax());
            }
            assert_eq!(products.mass.nnz() + products.elastic.nnz() + products.relaxations[0].0.nnz(), 0);
        }
    }

    /// Stiffness of springs along the sides against a rotation of Mindlin's whole plate along one axis: k h³/12 per
    /// unit of length.
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
            // Rounding error of some hundred points.
            assert!((sum / exact - 1.0).abs() < 1e-12, "{sum} {exact}");
        }
    }
}
