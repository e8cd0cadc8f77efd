//! Waves of an infinite plate under the impactor, which describe a finite plate before its first echo.

use std::f64::consts::PI;

use crate::body::{
    BendingWaves, EdgeSprings, InfinitePlate, LayeredWaves, ModeCount, PlateWaves, RectangularPlate, VECTORS_PER_MODE,
    Wavenumbers,
};
use crate::contact::zener;
use crate::description::Description;
use crate::error::Result;
use crate::form::Material;
use crate::form::plate::Section;
use crate::material::Maxwell;
use crate::scene::{Load, Measure, Scene, SupportKind, faces};

use super::geometry::PlateGeometry;
use super::laminate::LayerwiseWaves;
use super::{Laminate, Local, PlateTheory, Points, Settings};

/// Ratio of successive wavenumbers at which waves are evaluated.
const STEP: f64 = 1.05;

/// Largest wavenumber times the radius of the disc. Shorter waves hardly change the mean displacement over the disc.
const SHORTEST: f64 = 40.0;

/// Fraction of the largest modal density below which the density is neglected.
const NEGLECTED_DENSITY: f64 = 1e-4;

/// Rate at which the moduli of viscoelastic layers are taken for short waves, times the contact time on a half-space: the
/// shift of a basis for a tolerance of 1e-2.
const RATE_TIMES_CONTACT: f64 = 15.0;

/// First estimate of the infinite plate's response to a force at a point, by thin-plate theory. A laminate is replaced
/// by a single layer of its mass, and of its rigidity at the wavelength of the contact; only its modes in closed form are
/// those of its layers.
///
/// # Errors
/// A fault of `body.model` if the theory cannot model the scene.
pub fn infinite_plate(scene: &Scene, theory: PlateTheory, settings: &Settings) -> Result<InfinitePlate> {
    let fault = |reason: String| super::fault(theory, &reason);
    let geometry = super::geometry(scene, theory).map_err(fault)?;
    if theory != PlateTheory::Layerwise {
        let section = Section::new(geometry.thickness, &scene.body.struck());
        let rectangle = rectangle(scene, &geometry, &section, None, theory);
        return Ok(of_section(&geometry, &section, &WavesOfTheory::Thin).with_echoes(rectangle));
    }
    let description = Description::new(scene);
    let laminate = Laminate::without_local(scene, &geometry, &description.parts, settings);
    let laminate = laminate.map_err(fault)?;
    let section = laminate.section(scene);
    let rectangle = rectangle(scene, &geometry, &section, Some(&laminate), theory).and_then(|rectangle| {
        let (relaxations, rate) = (description.relaxations(), rate(scene));
        let waves = LayerwiseWaves::new(&laminate, &geometry, &relaxations, rate);
        with_layered_waves(rectangle, &geometry, &section, &waves, &laminate, &relaxations, rate)
    });
    Ok(of_section(&geometry, &section, &WavesOfTheory::Thin).with_echoes(rectangle))
}

/// Number of uncoupled symmetry classes of a scene's plate.
///
/// # Errors
/// A fault of `body.model` if the theory cannot model the scene.
pub fn classes_of_motions(scene: &Scene, theory: PlateTheory) -> Result<usize> {
    Ok(super::geometry(scene, theory).map_err(|reason| super::fault(theory, &reason))?.classes.len())
}

/// Response of the infinite plate for a discretised plate. The moduli of viscoelastic layers are those at `rate` (1/s).
pub(super) fn of_points(points: &Points, relaxations: &[(&Maxwell, Vec<usize>)], rate: f64) -> InfinitePlate {
    let Points { geometry, section, local, laminate, rectangle, .. } = points;
    let waves = match (laminate, local) {
        (Some(laminate), _) => WavesOfTheory::Layerwise(LayerwiseWaves::new(laminate, geometry, relaxations, rate)),
        (None, Some(local)) => WavesOfTheory::Mindlin(section, local),
        (None, None) => WavesOfTheory::Thin,
    };
    let rectangle = rectangle.clone().and_then(|rectangle| match &waves {
        WavesOfTheory::Layerwise(waves) => {
            with_layered_waves(rectangle, geometry, section, waves, laminate.as_ref()?, relaxations, rate)
        }
        _ => Some(rectangle),
    });
    of_section(geometry, section, &waves).with_echoes(rectangle)
}

/// Smallest tolerance for which short waves are computed in closed form. With smaller ones, the waves that corners
/// scatter need about as many vectors as all echoes: on a pane on springs, 704 instead of 1037 at 3e-3, on finer cells.
const LEAST_TOLERANCE: f64 = 4e-3;

/// Least stiffness of the springs along an edge, over the stiffness D (π/L)³ of the plate against its longest wave, for
/// which short waves are computed in closed form. Corners between free edges scatter more: late in the contact on a free
/// pane the error was 1.5 times the difference by which it is estimated. There, bases with all echoes meet the tolerance
/// in the same time.
const LEAST_EDGE_STIFFNESS: f64 = 3.0;

/// A scene's plate with the springs along its edges, for the waves of a theory with shear. For a laminate, the waves
/// are those of its plies ([`Laminate::plies`]), which [`with_layered_waves`] replaces by a table.
///
/// `None` if its waves are not computed in closed form. This needs edges that are clamped or on stiff springs, supports
/// along whole edges only, and no dampers or foundation pads. It also needs a large tolerance, which applies to the
/// acceleration; no strengths; no other points to read than the hit; and no loads or moving supports.
pub(super) fn rectangle(
    scene: &Scene,
    geometry: &PlateGeometry,
    section: &Section,
    laminate: Option<&Laminate>,
    theory: PlateTheory,
) -> Option<RectangularPlate> {
    let is_tolerance_large = scene.measure == Measure::Acceleration && scene.tolerance >= LEAST_TOLERANCE;
    let are_others_read = scene.strength.is_given() || scene.output.has_points();
    let is_loaded =
        scene.load != Load::default() || scene.supports.iter().any(|support| support.displacement != [0.0; 3]);
    if !theory.shears() || !is_tolerance_large || is_loaded || are_others_read {
        return None;
    }
    let mut edges = [[EdgeSprings::default(); 2]; 2];
    for support in &scene.supports {
        if support.within.is_some() || support.damping != [0.0; 3] {
            return None;
        }
        let stiffness = match support.kind {
            SupportKind::Elastic { stiffness } => stiffness,
            SupportKind::Clamped { components } => components.map(|held| if held { f64::INFINITY } else { 0.0 }),
            SupportKind::Pad { .. } => return None,
        };
        for (axis, is_upper) in faces(&support.surface) {
            let across = geometry.axes.iter().position(|of| of == axis)?;
            // Springs in the plane resist rotations of the whole thickness: ∫ k ζ² dζ = k h³/12. On plies that turn
            // separately this is an approximation.
            let [area, inertia] = [section.thickness, section.inertia()];
            let springs = &mut edges[across][usize::from(*is_upper)];
            springs.deflection += stiffness[geometry.normal] * area;
            springs.rotation += stiffness[*axis] * inertia;
            springs.twist += stiffness[geometry.axes[1 - across]] * inertia;
        }
    }
    let is_soft = |axis: usize| {
        let rigidity = laminate.map_or_else(|| section.rigidity(), Laminate::rigidity);
        let least = LEAST_EDGE_STIFFNESS * rigidity * (PI / geometry.edges[axis]).powi(3);
        edges[axis].iter().any(|edge: &EdgeSprings| edge.deflection < least)
    };
    if is_soft(0) || is_soft(1) {
        return None;
    }
    Some(RectangularPlate {
        lengths: geometry.edges,
        hit: [0, 1].map(|axis| 0.5 * geometry.edges[axis] + geometry.hit[axis]),
        is_symmetric: [0, 1].map(|axis| geometry.halved[axis] && geometry.hit[axis] == 0.0),
        edges,
        waves: PlateWaves::Mindlin(match laminate {
            None => bending_waves(section, super::shear_factor(section.poisson)),
            Some(laminate) => laminate.plies(section),
        }),
    })
}

/// The rate at which viscoelastic layers have their moduli in a scene's waves, 1/s.
pub(super) fn rate(scene: &Scene) -> f64 {
    RATE_TIMES_CONTACT / scene.impactor.contact_time()
}

/// The rectangle with a table of its laminate's waves; `None` if the table would have too few entries.
fn with_layered_waves(
    rectangle: RectangularPlate,
    geometry: &PlateGeometry,
    section: &Section,
    waves: &LayerwiseWaves,
    laminate: &Laminate,
    relaxations: &[(&Maxwell, Vec<usize>)],
    rate: f64,
) -> Option<RectangularPlate> {
    let wavenumbers = Wavenumbers { first: first_wavenumber(section), ratio: STEP };
    let excited = (0..).map(|i| wavenumbers.at(i)).take_while(|wavenumber| wavenumber * waves.radius() <= SHORTEST);
    let of_layers = excited.map(|wavenumber| waves.matrices(wavenumber, geometry.multiplicity()));
    let chains: Vec<&Maxwell> = relaxations.iter().map(|(chain, _)| *chain).collect();
    let layered = LayeredWaves::new(of_layers.collect(), wavenumbers, laminate.plies(section), &chains, rate);
    if layered.is_none() {
        tracing::debug!("the slowest waves do not bend the laminate: no modes in closed form");
    }
    layered.map(|waves| RectangularPlate { waves: PlateWaves::Layered(waves), ..rectangle })
}

/// Bending waves of a section with a shear factor κ.
fn bending_waves(section: &Section, shear_factor: f64) -> BendingWaves {
    BendingWaves {
        poisson: section.poisson,
        mass: section.density * section.thickness,
        rigidity: section.rigidity(),
        shear: shear_factor * section.shear(),
        rotary: section.density * section.inertia(),
    }
}

/// Response of the infinite plate for the modelled part of a plate, with all its symmetry classes.
fn of_section(geometry: &PlateGeometry, section: &Section, waves: &WavesOfTheory) -> InfinitePlate {
    let (edges, multiplicity) = (geometry.edges, geometry.multiplicity());
    let classes = geometry.classes.len() as f64;
    let material = Material { young: section.young, poisson: section.poisson, density: section.density };
    // ξ² = ω √(ρh/D) for long waves.
    let slowness = (section.density * section.thickness / section.rigidity()).sqrt();
    let thin = multiplicity * slowness / (4.0 * PI * section.density * section.thickness);
    let over_square = classes * edges[0] * edges[1] / (4.0 * PI * multiplicity);
    let mut modes = ModeCount::of_thin_plate(over_square, slowness);
    let Spectrum { density, fast_wave_compliances } = match waves {
        WavesOfTheory::Thin => Spectrum { density: vec![(0.0, thin)], fast_wave_compliances: Vec::new() },
        WavesOfTheory::Mindlin(..) => spectrum(section, waves, multiplicity, Some(thin)),
        WavesOfTheory::Layerwise(_) => {
            modes.dispersion = dispersion(section, waves);
            spectrum(section, waves, multiplicity, None)
        }
    };
    InfinitePlate {
        density,
        fast_wave_compliances,
        modes,
        impedance: zener::impedance(&material, section.thickness),
        distance_to_edge: geometry.distance_to_edge(),
        rectangle: None,
        vectors_per_mode: VECTORS_PER_MODE,
    }
}

/// A wave of a plate with one wavenumber.
pub(super) struct Wave {
    /// Circular frequency ω, rad/s.
    pub frequency: f64,
    /// r² P², m²/kg: square of the displacement read on the disc for a unit amplitude of w, divided by the moving mass
    /// per unit of area.
    pub of_force: f64,
}

/// Waves of a plate in each theory.
enum WavesOfTheory<'a> {
    /// Bending waves of a thin plate, loaded at a point.
    Thin,
    /// Waves of Mindlin's plate.
    Mindlin(&'a Section, &'a Local),
    /// Waves of a plate of several layers.
    Layerwise(LayerwiseWaves<'a>),
}

impl WavesOfTheory<'_> {
    /// The waves of a wavenumber (1/m): the bending wave, and those of higher frequencies. None for a thin plate, whose
    /// density of modes is known in closed form.
    fn at(&self, wavenumber: f64) -> Vec<Wave> {
        match self {
            Self::Thin => Vec::new(),
            Self::Mindlin(section, local) => mindlin_waves(section, local, wavenumber).into(),
            Self::Layerwise(waves) => waves.at(wavenumber),
        }
    }

    /// Radius of the loaded disc, m.
    fn radius(&self) -> f64 {
        match self {
            Self::Thin => 0.0,
            Self::Mindlin(_, local) => local.radius,
            Self::Layerwise(waves) => waves.radius(),
        }
    }
}

/// Bending wave and thickness-shear wave of a wavenumber ξ (1/m).
///
/// For w and θ = ∇ψ of a wave: M = diag(ρh, ρh³ξ²/12) and K = [[S, S], [S, Dξ⁴ + S]], S = κμhξ². The displacement read
/// is w − s h² ξ² ψ.
fn mindlin_waves(section: &Section, local: &Local, wavenumber: f64) -> [Wave; 2] {
    let waves = bending_waves(section, local.shear_factor);
    let square = wavenumber * wavenumber;
    let spread = local.spread.transform(wavenumber * local.radius);
    waves.frequencies(wavenumber).map(|frequency| {
        // (S − ω² ρh) w + S ψ = 0.
        let turned = frequency * frequency * waves.mass / (waves.shear * square) - 1.0;
        let read = 1.0 - local.reading * section.thickness.powi(2) * square * turned;
        let of_force = (read * spread).powi(2) / (waves.mass + waves.rotary * square * turned * turned);
        Wave { frequency, of_force }
    })
}

/// Response of the waves of all wavenumbers, by frequency.
struct Spectrum {
    /// Pairs of ω (rad/s), ascending, and the modal density ν (s/kg).
    density: Vec<(f64, f64)>,
    /// Pairs of ω (rad/s) and the static compliance (m/N) of waves that are faster than any contact.
    fast_wave_compliances: Vec<(f64, f64)>,
}

/// Spectrum of a plate. The bending waves have the density ν = (1/2π) ξ dξ/dω r² P². The other waves, and the bending
/// waves beyond the last ω, are springs with the compliance (1/2π) r² P²/ω² ξ dξ. `longest` is ν of the longest waves,
/// s/kg, if it is known; `multiplicity` is the number of modelled parts in the whole plate.
fn spectrum(section: &Section, waves: &WavesOfTheory, multiplicity: f64, longest: Option<f64>) -> Spectrum {
    let first = first_wavenumber(section);
    // ν of a bending wave.
    let density_of = |wavenumber: f64, wave: &Wave| {
        let ends = [1e-3, -1e-3].map(|part| wavenumber * (1.0 + part));
        let frequencies = ends.map(|end| waves.at(end)[0].frequency);
        let slope = (ends[0] - ends[1]) / (frequencies[0] - frequencies[1]);
        multiplicity * wavenumber * slope * wave.of_force / (2.0 * PI)
    };
    let bending = &waves.at(first)[0];
    let longest = longest.unwrap_or_else(|| density_of(first, bending));
    let mut density = vec![(bending.frequency, longest)];
    let (mut largest, mut is_complete, mut fast_wave_compliances) = (longest, false, Vec::new());
    for wavenumber in (1..).map(|i| first * STEP.powi(i)) {
        if wavenumber * waves.radius() > SHORTEST {
            break;
        }
        let all = waves.at(wavenumber);
        let (bending, faster) = (&all[0], &all[1..]);
        // ξ dξ = ξ² d ln ξ.
        let part = multiplicity * wavenumber * wavenumber * STEP.ln() / (2.0 * PI);
        let spring = |wave: &Wave| (wave.frequency, part * wave.of_force / wave.frequency.powi(2));
        fast_wave_compliances.extend(faster.iter().map(spring));
        if is_complete {
            fast_wave_compliances.push(spring(bending));
            continue;
        }
        let value = density_of(wavenumber, bending);
        density.push((bending.frequency, value));
        largest = largest.max(value);
        is_complete = value < NEGLECTED_DENSITY * largest && wavenumber * waves.radius() > PI;
    }
    Spectrum { density, fast_wave_compliances }
}

/// Pairs of ω (rad/s) and ξ² (1/m²) of bending waves, from the longest to the shortest that the disc excites.
fn dispersion(section: &Section, waves: &WavesOfTheory) -> Vec<(f64, f64)> {
    let wavenumbers = (0..).map(|i| first_wavenumber(section) * STEP.powi(i));
    let excited = wavenumbers.take_while(|wavenumber| wavenumber * waves.radius() <= SHORTEST);
    let of_waves = excited.map(|wavenumber| (waves.at(wavenumber)[0].frequency, wavenumber * wavenumber));
    std::iter::once((0.0, 0.0)).chain(of_waves).collect()
}

/// Wavenumber (1/m) of the longest waves that are evaluated.
fn first_wavenumber(section: &Section) -> f64 {
    0.01 / section.thickness
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed forms are used for edges that are clamped or on stiff springs only, and where nothing else needs the short
    /// waves.
    #[test]
    fn closed_forms_are_used_where_they_hold() {
        let is_known = |text: &str| {
            let of_body = "[body]\nsize = [1.0, 1.5, 0.008]\nyoung = 70e9\npoisson = 0.23\ndensity = 2500.0\n";
            let rest = "[impactor]\nmass = 1.0\nradius = 0.05\nyoung = 210e9\npoisson = 0.3\nspeed = 2.0\n[time]\nend = 1e-3\n";
            let scene = Scene::parse("test", &format!("{of_body}{rest}{text}"), &[]).expect("a scene").0;
            infinite_plate(&scene, PlateTheory::Mindlin, &Settings::default()).expect("a plate").rectangle.is_some()
        };
        let support = |keys: &str| is_known(&format!("[[support]]\nsurface = \"side\"\n{keys}"));
        assert!(!is_known(""));
        assert!(!support("kind = \"elastic\"\nstiffness = [0.0, 0.0, 1e7]"));
        assert!(support("kind = \"clamped\""));
        assert!(support("kind = \"elastic\"\nstiffness = [0.0, 0.0, 5e8]"));
        assert!(!support("kind = \"elastic\"\nstiffness = 5e8\ndamping = 1e4"));
        assert!(!support("kind = \"elastic\"\nstiffness = 5e8\nwithin = { box = [[-0.1, -2, -1], [0.1, 2, 1]] }"));
        assert!(!support("kind = \"elastic\"\nstiffness = 5e8\ndisplacement = [0.0, 0.0, 1e-3]"));
        assert!(!support(
            "kind = \"clamped\"\n[[support]]\nsurface = \"bottom\"\nkind = \"elastic\"\nstiffness = [0, 0, 1e8]"
        ));
        assert!(!support("kind = \"clamped\"\n[load]\ngravity = [0.0, 0.0, -9.81]"));
        assert!(!support("kind = \"clamped\"\n[accuracy]\ntolerance = 1e-3"));
        assert!(!support("kind = \"clamped\"\n[accuracy]\nquantity = \"stress\""));
        assert!(!support("kind = \"clamped\"\n[strength]\ntension = 45e6"));
        assert!(!support("kind = \"clamped\"\n[output]\nprobes = [{ name = \"edge\", point = [0.4, 0.1, 0.0] }]"));
    }
}
