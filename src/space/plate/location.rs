//! Where a plate is hit.

use super::{Local, Points};
use crate::form::plate::{deflection, rotation};

/// a: a point for Kirchhoff's theory, a disc for Mindlin's.
pub(super) fn localization(points: &Points, copies: f64) -> Vec<f64> {
    let Points { geometry, section, tensor, local, .. } = points;
    let mut a = vec![0.0; tensor.unknowns()];
    let Some(Local { spread, radius, reading, .. }) = local else {
        tensor.add_point(deflection([0, 0]), geometry.hit, 1.0, &mut a);
        return a;
    };
    let of_stretch = reading * section.thickness.powi(2);
    let parts = [(deflection([0, 0]), 1.0), (rotation(0, [1, 0]), of_stretch), (rotation(1, [0, 1]), of_stretch)];
    for (x, line) in spread.strips(geometry.hit, *radius, points.lines_in_plane()) {
        for (part, factor) in parts {
            tensor.add_line((part, copies * factor), ([x, 0.0], 1), &line, &mut a);
        }
    }
    a
}
