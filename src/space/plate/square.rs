//! Plates whose two axes may be exchanged: squares that are hit at their centre.

use super::Points;
use crate::form::layerwise::exchanged_field;

/// The number of each unknown where the axes are exchanged, of a quarter of a plate with the same cells along both; whether that leaves
/// its supports and loads as they are is not looked at.
pub(super) fn exchange(points: &Points) -> Option<Vec<usize>> {
    let [x, y] = points.lines_in_plane();
    if !points.geometry.is_quarter || x != y {
        return None;
    }
    let tensor = &points.tensor;
    let mut partners = Vec::with_capacity(tensor.unknowns());
    for field in 0..tensor.fields() {
        let [along, across] = tensor.splines(field).each_ref().map(|spline| spline.functions());
        let of_field = (0..along).flat_map(|i| (0..across).map(move |j| [j, i]));
        partners.extend(of_field.map(|functions| tensor.unknown(exchanged_field(field), functions)));
    }
    Some(partners)
}
