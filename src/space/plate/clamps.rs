//! Unknowns that clamps (2) and planes of symmetry hold.

use super::PlateTheory;
use super::geometry::PlateGeometry;
use crate::description::Clamp;
use crate::form::plate::DEFLECTION;
use crate::form::tensor::Tensor;
use crate::space::grid::Face;

/// Unknowns of clamped sides, the last clamp's value for each, and those of planes of symmetry; ascending.
pub(super) fn held(
    tensor: &Tensor<2>,
    geometry: &PlateGeometry,
    theory: PlateTheory,
    clamps: &[Clamp],
) -> Vec<(usize, f64)> {
    let one = tensor.one(DEFLECTION);
    let mut values = vec![None; tensor.unknowns()];
    let mut hold = |(field, depth): (usize, usize), axis: usize, is_upper: bool, value: f64| {
        let splines = tensor.splines(field);
        let last = splines[axis].functions() - 1;
        for along in 0..splines[1 - axis].functions() {
            let mut functions = [along; 2];
            functions[axis] = if is_upper { last - depth } else { depth };
            let unknown = tensor.unknown(field, functions);
            values[unknown] = Some(if value == 0.0 { 0.0 } else { value * one[unknown] });
        }
    };
    let mirrors = geometry.mirrors();
    for clamp in clamps {
        for Face { axis, is_upper } in Face::of_surface(&clamp.surface, &mirrors) {
            // The check of the scene leaves no clamp to a face.
            let Some(side) = geometry.axes.iter().position(|other| *other == axis) else { continue };
            if clamp.components[geometry.normal] {
                hold((DEFLECTION, 0), side, is_upper, geometry.across(clamp.displacement));
            }
            for rotation in (0..2).filter(|&i| clamp.components[geometry.axes[i]]) {
                if let Some(place) = theory.rotation_at_end(rotation, side) {
                    hold(place, side, is_upper, 0.0);
                }
            }
        }
    }
    if geometry.is_quarter {
        for axis in 0..2 {
            if let Some(place) = theory.rotation_at_end(axis, axis) {
                hold(place, axis, false, 0.0);
            }
        }
    }
    values.into_iter().enumerate().filter_map(|(unknown, value)| Some((unknown, value?))).collect()
}
