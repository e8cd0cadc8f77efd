//! A box of tensor-product splines, as an elastic body in three dimensions.
//!
//! Each displacement component has splines of one degree less along its own axis than along the other axes. So the two
//! parts of a shear strain, ∂u_x/∂z and ∂u_z/∂x, lie in the same space and can cancel in a bent plate (as in Beirão da
//! Veiga, Buffa, Lovadina, Martinelli & Sangalli, An isogeometric method for the Reissner–Mindlin plate bending
//! problem, Comput. Methods Appl. Mech. Eng. 209–212, 2012). This halves the error with fewer unknowns.

mod cells;
mod clamps;
mod geometry;
mod layer;
mod patch;
mod points;

use super::grid::{GridField, GridSpace, count_cells};
use super::{SurfaceTerms, rung_below};
use crate::body::{BodyTerms, ContactPort, Relaxation, StressReadings, System};
use crate::description::{Description, Part, Portion};
use crate::error::Result;
use crate::form::elastic::{VOLUME, elastic, elastic_with, mass, projected_lambda};
use crate::form::tensor::{Along, Integrals, Square, Tensor};
use crate::form::{Lame, Parity, Spline};
use crate::material::Maxwell;
use crate::scene::{Fault, Scene, Vec3};

pub use points::Points;

use clamps::held;
use geometry::BoxGeometry;
use patch::PatchModel;

/// Degree p of the splines, which have p − 1 continuous derivatives. Among the degrees 3 to 5, it takes the least time
/// for an error of 0.1% to 0.5% of the time history of an impact.
const DEGREE: usize = 4;

/// Options of a spline model that are not part of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Factor on the size of all cells; 1 is the default size.
    pub cell_size_factor: f64,
    /// Factor on the size of the cells at parts of faces with supports or loads.
    pub part_cell_factor: f64,
}

/// Factor on the size of all cells at the default tolerance.
const OF_DEFAULT_TOLERANCE: f64 = 1.35;

impl Settings {
    /// Settings for an error of less than half of a tolerance, as measured on plates.
    pub fn new(tolerance: f64) -> Self {
        let factor = rung_below((tolerance / 1e-2).powf(0.22));
        Self { cell_size_factor: (OF_DEFAULT_TOLERANCE * factor).clamp(0.3, 2.0), part_cell_factor: factor.min(1.0) }
    }

    /// Settings for a scene's tolerance and factor on cells, with cells of a `size` relative to that.
    pub fn of(scene: &Scene, size: f64) -> Self {
        let Self { cell_size_factor, part_cell_factor } = Self::new(scene.tolerance);
        let factor = size * scene.cell_factor;
        Self { cell_size_factor: factor * cell_size_factor, part_cell_factor: factor * part_cell_factor }
    }
}

/// A box's linear system and the data from which it was made.
#[derive(Debug, Clone)]
pub struct SplineSolid {
    /// System of M ü + C u̇ + K u = a F + f. The unknowns are spline coefficients (m), component by component, with the
    /// last axis fastest.
    pub system: System,
    /// Number of cells along each axis of the modelled part.
    pub cells: [usize; 3],
    /// Evaluator of displacements and stresses at points of the box.
    pub points: Points,
}

/// Checks whether splines on a box can model a scene's body.
///
/// # Errors
/// The reason why they cannot: a clause.
pub fn admits(scene: &Scene) -> std::result::Result<(), String> {
    let geometry = BoxGeometry::new(scene)?;
    match PatchModel::new(&geometry, scene) {
        Ok(patch) => cells::lines(&geometry, scene, &patch, &Settings::of(scene, 1.0)).map(|_| ()),
        // A fault of the patch applies to any mesh too, so it is no reason against splines.
        Err(_) => Ok(()),
    }
}

/// Estimated number of unknowns of [`SplineSolid::new`] for a scene; `None` if it would refuse the scene.
pub fn unknowns(scene: &Scene, settings: &Settings) -> Option<f64> {
    let geometry = BoxGeometry::new(scene).ok()?;
    let patch = PatchModel::new(&geometry, scene).ok()?;
    Some(cells::unknowns(&geometry, scene, &patch, settings))
}

/// Numbers of cells of [`SplineSolid::new`] for a scene along the axes; `None` if it would refuse the scene.
pub fn cells(scene: &Scene, settings: &Settings) -> Option<[usize; 3]> {
    let geometry = BoxGeometry::new(scene).ok()?;
    let patch = PatchModel::new(&geometry, scene).ok()?;
    let lines = cells::lines(&geometry, scene, &patch, settings).ok()?;
    Some(lines.each_ref().map(|lines| count_cells(lines)))
}

impl SplineSolid {
    /// Builds the spline model of a scene's box.
    ///
    /// # Errors
    /// A fault of `body.model` if splines cannot model the scene's body, or of the patch or impact point if there is no
    /// valid patch.
    pub fn new(scene: &Scene, settings: &Settings) -> Result<Self> {
        let fault = |reason: String| {
            let message = format!("splines on a box cannot model this scene: {reason}");
            Fault::new("body.model", message, "body.cells, for a mesh")
        };
        let geometry = BoxGeometry::new(scene).map_err(fault)?;
        let patch = PatchModel::new(&geometry, scene)?;
        let lines = cells::lines(&geometry, scene, &patch, settings).map_err(fault)?;
        let cells = lines.each_ref().map(|lines| count_cells(lines));
        let description = Description::new(scene);
        let tensor = tensor(&lines, &inner(&geometry.interfaces), patch.bends.then_some(geometry.struck));
        let parts = &description.parts;
        let mut integrals = Integrals::default();
        let mut of_parts = |forms: &dyn Fn(&Part) -> Vec<Square<3>>| {
            tensor.matrix_sharing(&parts.iter().flat_map(forms).collect::<Vec<_>>(), &mut integrals)
        };
        let mass = of_parts(&|part| mass(part.material.instantaneous.density, place(part)));
        let stiffness = of_parts(&|part| elastic_with(part.material.relaxed(), projected(part), place(part)));
        let relaxation = |(chain, of): (&Maxwell, Vec<usize>)| {
            let forms: Vec<_> = of.iter().flat_map(|part| elastic(Lame::DEVIATORIC, place(&parts[*part]))).collect();
            Relaxation { distortion: tensor.matrix_sharing(&forms, &mut integrals), chain: chain.clone() }
        };
        let relaxations = description.relaxations().into_iter().map(relaxation).collect();
        let points = Points::new(tensor, lines, parts, (&geometry, &patch), scene.impactor.moduli_time());
        let terms = SurfaceTerms::new(&GridSpace { field: &points, mirrors: &geometry.mirrors }, &description)?;
        let multiplicity = geometry.multiplicity();
        let system = System {
            mass,
            terms: BodyTerms {
                elastic: stiffness,
                relaxations,
                support: terms.support,
                damping: terms.damping,
                load: terms.load,
                support_load: terms.support_load,
                support_offset: terms.support_offset,
                contact: ContactPort {
                    force: patch.localization(&geometry, &points, description.direction),
                    compliance: multiplicity * patch.compliance,
                    footprint: patch.footprint,
                },
                translation: translation(&points.tensor, description.direction),
                readings: StressReadings::default(),
                infinite_plate: None,
                multiplicity,
            },
            pads: terms.pads,
            held: held(&points.tensor, &geometry.mirrors, &description.clamps),
            exchange: may_exchange(&geometry, &points).then(|| exchange(&points.tensor, geometry.plane())),
            is_nearly_incompressible: parts.iter().any(|part| projected(part) > 0.0),
            classes: 1,
        };
        Ok(Self { system, cells, points })
    }
}

/// Whether a box has planes of symmetry normal to both axes of the impacted face, and the same cells along both. Does
/// not check whether its supports and loads are unchanged by an exchange of these axes.
fn may_exchange(geometry: &BoxGeometry, points: &Points) -> bool {
    let [first, second] = geometry.plane();
    let lines = GridField::lines(points);
    geometry.mirrors.len() == 2 && lines[first] == lines[second]
}

/// Number of each unknown after an exchange of two axes with the same splines.
fn exchange(tensor: &Tensor<3>, [first, second]: [usize; 2]) -> Vec<usize> {
    let mut partners = Vec::with_capacity(tensor.unknowns());
    for component in 0..3 {
        let other = match component {
            _ if component == first => second,
            _ if component == second => first,
            _ => component,
        };
        let [x, y, z] = tensor.splines(component).each_ref().map(Spline::functions);
        for mut functions in (0..x * y * z).map(|n| [n / (y * z), n / z % y, n % z]) {
            functions.swap(first, second);
            partners.push(tensor.unknown(other, functions));
        }
    }
    partners
}

/// Unknowns of a unit translation of the whole body in a direction.
fn translation(tensor: &Tensor<3>, direction: Vec3) -> Vec<f64> {
    let mut sum = vec![0.0; tensor.unknowns()];
    for (component, d) in direction.into_iter().enumerate() {
        sum.iter_mut().zip(tensor.one(component)).for_each(|(sum, one)| *sum += d * one);
    }
    sum
}

/// Part of λ (Pa) of a part on the projected change of volume. Layers have none: stiff plies confine the volume of a thin
/// interlayer. With it, the tension on the faces of a soft interlayer was 22% above that of the layerwise plate.
fn projected(part: &Part) -> f64 {
    match part.portion {
        Portion::Layer(_) => 0.0,
        Portion::All | Portion::Volume(_) => projected_lambda(part.material.relaxed()),
    }
}

/// Portion of the domain that a part occupies, for integrals along the axes.
fn place(part: &Part) -> [Along; 3] {
    match part.portion {
        Portion::Layer(ends) => [Along::All, Along::All, Along::Within(ends)],
        Portion::All | Portion::Volume(_) => VOLUME,
    }
}

/// Interfaces without the ends of the box.
fn inner(interfaces: &[f64]) -> Vec<f64> {
    interfaces.iter().skip(1).take(interfaces.len().saturating_sub(2)).copied().collect()
}

/// Spline spaces of the three components between the lines. For a body in pure bending across the axis `bends`, they
/// have the parities of bending. Strains jump across interfaces (heights along z that are lines). There the lines are
/// repeated until the splines are only continuous.
fn tensor(lines: &[Vec<f64>; 3], interfaces: &[f64], bends: Option<usize>) -> Tensor<3> {
    let spline = |component: usize, axis: usize| {
        let degree = if axis == component { DEGREE - 1 } else { DEGREE };
        let times = |x: &f64| if axis == 2 && interfaces.contains(x) { degree } else { 1 };
        let lines: Vec<f64> = lines[axis].iter().flat_map(|x| std::iter::repeat_n(*x, times(x))).collect();
        let spline = Spline::new(&lines, degree, degree - 1);
        match bends {
            Some(across) if across == axis => spline.folded(if axis == component { Parity::Even } else { Parity::Odd }),
            _ => spline,
        }
    };
    Tensor::new((0..3).map(|component| std::array::from_fn(|axis| spline(component, axis))).collect())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::form::Material;

    const EDGES: [f64; 3] = [0.3, 0.24, 0.05];
    const COMPRESSIBLE: Material = Material { young: 70e9, poisson: 0.4, density: 2500.0 };

    /// Lowest squared frequency of a box between frictionless walls, with `cells` cells along two axes, by inverse
    /// iteration.
    fn square(material: &Material, cells: usize) -> f64 {
        let lines = |axis: usize, cells: usize| (0..=cells).map(|i| EDGES[axis] * i as f64 / cells as f64).collect();
        let tensor = tensor(&[lines(0, cells), lines(1, cells), lines(2, 1)], &[], None);
        let mut free = Vec::new();
        for component in 0..3 {
            let [x, y, z] = tensor.splines(component).each_ref().map(Spline::functions);
            let last = [x, y, z][component] - 1;
            for (i, j, k) in (0..x * y * z).map(|n| (n / (y * z), n / z % y, n % z)) {
                if ![0, last].contains(&[i, j, k][component]) {
                    free.push(tensor.unknown(component, [i, j, k]));
                }
            }
        }
        let of_free = |forms: Vec<_>| DMatrix::from(&tensor.matrix(&forms)).select_rows(&free).select_columns(&free);
        let (mass, elastic) = (of_free(mass(material.density, VOLUME)), of_free(elastic(material.lame(), VOLUME)));
        let factor = elastic.clone().cholesky().expect("a box that is held");
        let mut u = DVector::from_fn(free.len(), |i, _| 1.0 + (i % 7) as f64);
        for _ in 0..30 {
            u = factor.solve(&(&mass * u)).normalize();
        }
        u.dot(&(&elastic * &u)) / u.dot(&(&mass * &u))
    }

    /// For splines of degree p − 1 along one axis, strains have the order p − 1, and squared frequencies twice that
    /// order: in a nearly incompressible body too, although the wave keeps its volume. There the error is that of ν = 0.45,
    /// twice as large as the first; without the projection it is 12% on any of these cells.
    #[test]
    fn order_of_frequencies() {
        let incompressible = Material { poisson: 0.499_999_99, ..COMPRESSIBLE };
        for (material, largest) in [(COMPRESSIBLE, 1e-5), (incompressible, 2e-5)] {
            // A shear wave along the two longer axes.
            let wavenumber = (PI / EDGES[0]).powi(2) + (PI / EDGES[1]).powi(2);
            let exact = material.lame().mu / material.density * wavenumber;
            let errors = [3, 5].map(|cells| square(&material, cells) / exact - 1.0);
            let order = (errors[0] / errors[1]).ln() / (5.0_f64 / 3.0).ln();
            assert!(order > 5.5 && errors[1] < largest && errors[1] > 0.0, "order {order}, {errors:?}");
        }
    }
}
