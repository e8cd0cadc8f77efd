//! Where a plate is hit.

use super::{Local, Points};
use crate::form::plate::{deflection, rotation};

/// a of all classes: a point for Kirchhoff's theory, a disc for Mindlin's.
pub(super) fn localization(points: &Points) -> Vec<f64> {
    let Points { geometry, section, local, .. } = points;
    let mut a = vec![0.0; points.all_unknowns()];
    let Some(Local { spread, radius, reading, .. }) = local else {
        points.add_point(deflection([0, 0]), geometry.hit, 1.0, &mut a);
        return a;
    };
    // What a quarter has of the disc, as often as there are quarters; else all of it.
    let copies = if geometry.is_quarter { geometry.copies() } else { 1.0 };
    let of_stretch = reading * section.thickness.powi(2);
    let parts = [(deflection([0, 0]), 1.0), (rotation(0, [1, 0]), of_stretch), (rotation(1, [0, 1]), of_stretch)];
    let lines = points.lines_of_whole();
    for (x, line) in spread.strips(geometry.hit, *radius, [0, 1].map(|i| &lines[geometry.axes[i]][..])) {
        for (part, factor) in parts {
            points.add_line((part, copies * factor), x, &line, &mut a);
        }
    }
    a
}
