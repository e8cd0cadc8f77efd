//! Unknowns constrained by clamps (2) and planes of symmetry.

use super::PlateTheory;
use super::geometry::PlateGeometry;
use crate::description::Clamp;
use crate::form::Parity;
use crate::form::plate::DEFLECTION;
use crate::form::tensor::Tensor;
use crate::space::grid::Face;
use crate::space::parity::ParityClass;

/// Constrained unknowns of clamped sides, with the value of the last clamp for each, and of planes of symmetry. For all
/// symmetry classes, ascending.
pub(super) fn held(
    tensor: &Tensor<2>,
    geometry: &PlateGeometry,
    theory: PlateTheory,
    clamps: &[Clamp],
) -> Vec<(usize, f64)> {
    let of_class = |(number, class): (usize, &ParityClass)| {
        let first = number * tensor.unknowns();
        let held = held_in_class(tensor, geometry, (theory, *class), clamps);
        held.into_iter().map(move |(unknown, value)| (first + unknown, value)).collect::<Vec<_>>()
    };
    geometry.classes.iter().enumerate().flat_map(of_class).collect()
}

fn held_in_class(
    tensor: &Tensor<2>,
    geometry: &PlateGeometry,
    (theory, class): (PlateTheory, ParityClass),
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
    // Rotations of all layers that rotate independently.
    let rotations = |axis: usize, of_end: usize| {
        let each = (0..(tensor.fields() / 2).max(1)).map(|k| 2 * k);
        let first = theory.rotation_at_end(axis, of_end);
        each.filter_map(move |beyond| first.map(|(field, depth)| (field + beyond, depth)))
    };
    let mirrors = geometry.mirrors();
    // A prescribed displacement applies to the mirror image too, and so is even.
    let given = if class == [Parity::Even; 2] { 1.0 } else { 0.0 };
    for clamp in clamps {
        for Face { axis, is_upper } in Face::of_surface(&clamp.surface, &mirrors) {
            // The check of the scene excludes clamps on a face.
            let Some(side) = geometry.axes.iter().position(|other| *other == axis) else { continue };
            if clamp.components[geometry.normal] {
                hold((DEFLECTION, 0), side, is_upper, given * geometry.across(clamp.displacement));
            }
            for rotation in (0..2).filter(|&i| clamp.components[geometry.axes[i]]) {
                rotations(rotation, side).for_each(|place| hold(place, side, is_upper, 0.0));
            }
        }
    }
    for axis in (0..2).filter(|&axis| geometry.halved[axis]) {
        // An even deflection has no slope across the plane. An odd one is zero on the plane, and so is the slope along
        // it.
        match class[axis] {
            Parity::Even => rotations(axis, axis).for_each(|place| hold(place, axis, false, 0.0)),
            Parity::Odd => {
                let along = rotations(1 - axis, axis);
                std::iter::once((DEFLECTION, 0)).chain(along).for_each(|place| hold(place, axis, false, 0.0));
            }
        }
    }
    values.into_iter().enumerate().filter_map(|(unknown, value)| Some((unknown, value?))).collect()
}
