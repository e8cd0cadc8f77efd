//! Plates whose two axes may be exchanged: squares impacted at the centre.

use super::Points;
use super::layers::profile::exchanged_field;

/// Number of each unknown after an exchange of the axes, for a quarter of a plate with the same cells along both axes;
/// else `None`. Does not check whether the supports and loads have this symmetry.
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
