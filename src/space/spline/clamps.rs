//! Unknowns constrained by clamps (2) and planes of symmetry.

use crate::description::Clamp;
use crate::form::Spline;
use crate::form::tensor::Tensor;
use crate::scene::faces;
use crate::space::grid::Face;

/// Constrained unknowns of clamped faces, with the value of the last clamp for each, and of planes of symmetry;
/// ascending.
pub fn held(tensor: &Tensor<3>, mirrors: &[usize], clamps: &[Clamp]) -> Vec<(usize, f64)> {
    let mut values = vec![None; tensor.unknowns()];
    // At an end of an axis only one function is non-zero, and the functions sum to one.
    let mut hold = |component: usize, face: Face, value: f64| {
        let counts = tensor.splines(component).each_ref().map(Spline::functions);
        let [first, second] = faces::along(face.axis);
        for (i, j) in (0..counts[first]).flat_map(|i| (0..counts[second]).map(move |j| (i, j))) {
            let mut functions = [0; 3];
            functions[face.axis] = if face.is_upper { counts[face.axis] - 1 } else { 0 };
            (functions[first], functions[second]) = (i, j);
            values[tensor.unknown(component, functions)] = Some(value);
        }
    };
    for clamp in clamps {
        for face in Face::of_surface(&clamp.surface, mirrors) {
            (0..3).filter(|i| clamp.components[*i]).for_each(|i| hold(i, face, clamp.displacement[i]));
        }
    }
    mirrors.iter().for_each(|&axis| hold(axis, Face { axis, is_upper: false }, 0.0));
    values.into_iter().enumerate().filter_map(|(unknown, value)| Some((unknown, value?))).collect()
}
